//! Reading accessors safely: everything that the crate's iterators take for granted is checked first.

use gltf::Document;
use gltf::accessor::util::ItemIter;
use gltf::accessor::{Item, Iter};
use gltf::json;
use gltf::json::accessor::{ComponentType, Type, sparse};
use gltf::json::validation::Checked;

use super::buffers::Buffers;
use super::{fault, malformed};
use crate::error::ImportError;
use crate::limits::Budget;

/// A file's accessors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accessors<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
}

/// An accessor's items: points, rotations...
#[derive(Debug)]
pub(super) enum Vectors<const N: usize> {
    /// So many times zero: an accessor without a view takes no memory, whatever its count.
    Zeros(u32),
    /// One by one.
    Given(Vec<[f64; N]>),
}

impl<const N: usize> Vectors<N> {
    /// How many.
    pub fn len(&self) -> u32 {
        match self {
            Vectors::Zeros(count) => *count,
            // Counts were checked to fit 32 bits.
            Vectors::Given(items) => items.len() as u32,
        }
    }

    /// Item `index`, if there are so many.
    pub fn get(&self, index: u32) -> Option<[f64; N]> {
        match self {
            Vectors::Zeros(count) => (index < *count).then_some([0.0; N]),
            Vectors::Given(items) => items.get(index as usize).copied(),
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> u64 {
        match self {
            Vectors::Zeros(_) => 0,
            Vectors::Given(items) => (items.len() * size_of::<[f64; N]>()) as u64,
        }
    }
}

/// A stream of vertex indices.
pub(super) enum Indices<'a> {
    /// 0, 1, 2...: a primitive without indices.
    Counting(std::ops::Range<u32>),
    /// So many times 0: an accessor without a view.
    Zeros(std::ops::Range<u32>),
    /// 8-bit indices.
    U8(Iter<'a, u8>),
    /// 16-bit indices.
    U16(Iter<'a, u16>),
    /// 32-bit indices.
    U32(Iter<'a, u32>),
}

impl Iterator for Indices<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        match self {
            Indices::Counting(range) => range.next(),
            Indices::Zeros(range) => range.next().map(|_| 0),
            Indices::U8(iter) => iter.next().map(u32::from),
            Indices::U16(iter) => iter.next().map(u32::from),
            Indices::U32(iter) => iter.next(),
        }
    }
}

/// A component that stands for a number, as it is or as a share of its type's largest.
trait Component: Item + Copy {
    fn plain(self) -> f64;
    fn normalized(self) -> f64;
}

macro_rules! component {
    ($($type:ty: $largest:expr),*) => {$(
        impl Component for $type {
            fn plain(self) -> f64 {
                f64::from(self)
            }

            fn normalized(self) -> f64 {
                // The signed types' smallest value is one below -1, and counts as -1.
                (f64::from(self) / $largest).max(-1.0)
            }
        }
    )*};
}

component!(u8: 255.0, i8: 127.0, u16: 65535.0, i16: 32767.0);

impl Component for f32 {
    fn plain(self) -> f64 {
        f64::from(self)
    }

    fn normalized(self) -> f64 {
        f64::from(self)
    }
}

impl<'a> Accessors<'a> {
    /// The accessors of a document whose indices are in range ([`super::document::parse`]).
    pub fn new(document: &'a Document, buffers: &'a Buffers<'a>) -> Accessors<'a> {
        Accessors { document, buffers }
    }

    /// How many items accessor `index` says it has.
    ///
    /// # Errors
    /// There is no such accessor, or the count passes what 32-bit indices reach.
    pub fn count(&self, index: usize) -> Result<u32, ImportError> {
        let count = self.json(index)?.count.0;
        u32::try_from(count).map_err(|_| {
            malformed(format!("accessors[{index}].count"), format!("{count} items are more than 2^32"))
        })
    }

    /// Whether accessor `index` has no bytes of its own: all zeros.
    pub fn is_zeros(&self, index: usize) -> bool {
        self.json(index).is_ok_and(|accessor| accessor.buffer_view.is_none() && accessor.sparse.is_none())
    }

    /// The indices in accessor `index`.
    ///
    /// # Errors
    /// It holds no indices (scalars of an unsigned type), or its bytes are not all there.
    pub fn indices(&self, index: usize) -> Result<Indices<'a>, ImportError> {
        let (component, kind) = self.types(index)?;
        if kind != Type::Scalar {
            return Err(malformed(format!("accessors[{index}].type"), "indices must be SCALAR"));
        }
        let count = self.count(index)?;
        Ok(match component {
            ComponentType::U8 => self.open(index)?.map(Indices::U8),
            ComponentType::U16 => self.open(index)?.map(Indices::U16),
            ComponentType::U32 => self.open(index)?.map(Indices::U32),
            _ => {
                let text = "indices must be unsigned bytes, shorts or ints";
                return Err(malformed(format!("accessors[{index}].componentType"), text));
            }
        }
        .unwrap_or(Indices::Zeros(0..count)))
    }

    /// The points in accessor `index`: floats, or 8- and 16-bit integers (KHR_mesh_quantization).
    ///
    /// # Errors
    /// It holds none, its bytes are not all there, or over the budget.
    pub fn points(&self, index: usize, budget: &mut Budget) -> Result<Vectors<3>, ImportError> {
        self.vectors(index, Type::Vec3, budget)
    }

    /// The quaternions in accessor `index`.
    ///
    /// # Errors
    /// As [`Accessors::points`].
    pub fn rotations(&self, index: usize, budget: &mut Budget) -> Result<Vectors<4>, ImportError> {
        self.vectors(index, Type::Vec4, budget)
    }

    fn vectors<const N: usize>(
        &self,
        index: usize,
        wanted: Type,
        budget: &mut Budget,
    ) -> Result<Vectors<N>, ImportError>
    where
        [u8; N]: Item,
        [i8; N]: Item,
        [u16; N]: Item,
        [i16; N]: Item,
        [f32; N]: Item,
    {
        let (component, kind) = self.types(index)?;
        if kind != wanted {
            return Err(malformed(format!("accessors[{index}].type"), format!("must be VEC{N}")));
        }
        match component {
            ComponentType::I8 => self.collect::<i8, N>(index, budget),
            ComponentType::U8 => self.collect::<u8, N>(index, budget),
            ComponentType::I16 => self.collect::<i16, N>(index, budget),
            ComponentType::U16 => self.collect::<u16, N>(index, budget),
            ComponentType::F32 => self.collect::<f32, N>(index, budget),
            ComponentType::U32 => {
                Err(malformed(format!("accessors[{index}].componentType"), "vectors of 32-bit integers"))
            }
        }
    }

    fn collect<T: Component, const N: usize>(
        &self,
        index: usize,
        budget: &mut Budget,
    ) -> Result<Vectors<N>, ImportError>
    where
        [T; N]: Item,
    {
        let count = self.count(index)?;
        let Some(items) = self.open::<[T; N]>(index)? else { return Ok(Vectors::Zeros(count)) };
        budget
            .take_items(u64::from(count), size_of::<[f64; N]>(), "vertices")
            .map_err(|e| fault(format!("accessors[{index}]"), e.into()))?;
        let mut all = Vec::with_capacity(count as usize);
        if self.json(index)?.normalized {
            all.extend(items.map(|item| item.map(T::normalized)));
        } else {
            all.extend(items.map(|item| item.map(T::plain)));
        }
        Ok(Vectors::Given(all))
    }

    fn json(&self, index: usize) -> Result<&'a json::Accessor, ImportError> {
        let missing = || malformed(format!("accessors[{index}]"), "no such accessor");
        self.document.as_json().accessors.get(index).ok_or_else(missing)
    }

    fn types(&self, index: usize) -> Result<(ComponentType, Type), ImportError> {
        let accessor = self.json(index)?;
        match (&accessor.component_type, &accessor.type_) {
            (Checked::Valid(component), Checked::Valid(kind)) => Ok((component.0, *kind)),
            _ => Err(malformed(format!("accessors[{index}]"), "unknown type or componentType")),
        }
    }

    /// The crate's iterator over the items of accessor `index`; `None` if all are zeros (also if there are none).
    ///
    /// The checks are those without which it panics, or ends too early: sizes that match, a count of at least one
    /// where it subtracts one, a stride not under the item's size, ends within views, sparse indices that rise and
    /// stay below the count.
    fn open<T: Item>(&self, index: usize) -> Result<Option<Iter<'a, T>>, ImportError> {
        let (component, kind) = self.types(index)?;
        let accessor = self.json(index)?;
        let place = || format!("accessors[{index}]");
        let size = component.size() * kind.multiplicity();
        if size != size_of::<T>() {
            return Err(malformed(place(), "wrong type for its use"));
        }
        let count = self.count(index)?;
        if count == 0 || (accessor.buffer_view.is_none() && accessor.sparse.is_none()) {
            return Ok(None);
        }
        if let Some(view) = accessor.buffer_view {
            let offset = accessor.byte_offset.unwrap_or_default().0;
            self.items(view.value(), offset, u64::from(count), size, place)?;
        }
        if let Some(sparse) = &accessor.sparse {
            self.check_sparse(sparse, size, count, index)?;
        }
        // In range: the document was parsed, and `json` found it.
        let Some(handle) = self.document.accessors().nth(index) else {
            return Err(malformed(place(), "no such accessor"));
        };
        let buffers = self.buffers;
        let iter = Iter::new(handle, move |buffer: gltf::Buffer<'a>| buffers.get(buffer.index()));
        iter.map(Some).ok_or_else(|| malformed(place(), "its bytes are not all there"))
    }

    fn check_sparse(
        &self,
        sparse: &sparse::Sparse,
        size: usize,
        count: u32,
        index: usize,
    ) -> Result<(), ImportError> {
        let place = |part: &str| format!("accessors[{index}].sparse{part}");
        let replaced = sparse.count.0;
        if replaced == 0 || replaced > u64::from(count) {
            return Err(malformed(place(".count"), format!("{replaced} of {count} items")));
        }
        let Checked::Valid(json::accessor::IndexComponentType(component)) = sparse.indices.component_type
        else {
            return Err(malformed(place(".indices.componentType"), "not an unsigned type"));
        };
        let (bytes, stride) = self.items(
            sparse.indices.buffer_view.value(),
            sparse.indices.byte_offset.0,
            replaced,
            component.size(),
            || place(".indices"),
        )?;
        let rising = match component {
            ComponentType::U8 => check_rising(ItemIter::<u8>::new(bytes, stride).map(u32::from), count),
            ComponentType::U16 => check_rising(ItemIter::<u16>::new(bytes, stride).map(u32::from), count),
            ComponentType::U32 => check_rising(ItemIter::<u32>::new(bytes, stride), count),
            _ => Err("not an unsigned type".to_owned()),
        };
        rising.map_err(|text| malformed(place(".indices"), text))?;
        self.items(sparse.values.buffer_view.value(), sparse.values.byte_offset.0, replaced, size, || {
            place(".values")
        })?;
        Ok(())
    }

    /// The bytes of `count` (at least one) items of `size` bytes in a view, and their stride.
    fn items(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
        place: impl Fn() -> String,
    ) -> Result<(&'a [u8], usize), ImportError> {
        let root = self.document.as_json();
        let bytes = self.buffers.view(root, view)?;
        let stated = root.buffer_views[view].byte_stride.map_or(0, |stride| stride.0);
        let stride = if stated == 0 { size } else { stated };
        if stride < size {
            let text = format!("byteStride {stride} is less than the {size} bytes of an item");
            return Err(malformed(format!("bufferViews[{view}].byteStride"), text));
        }
        let end = (count - 1)
            .checked_mul(stride as u64)
            .and_then(|last| last.checked_add(size as u64)?.checked_add(offset))
            .filter(|&end| end <= bytes.len() as u64);
        match end {
            Some(end) => Ok((&bytes[offset as usize..end as usize], stride)),
            None => {
                let text = format!(
                    "{count} items of {size} bytes, stride {stride}, from byte {offset} on go over the end of \
                     bufferViews[{view}] at {}",
                    bytes.len()
                );
                Err(malformed(place(), text))
            }
        }
    }
}

fn check_rising(indices: impl Iterator<Item = u32>, count: u32) -> Result<(), String> {
    let mut last = None;
    for index in indices {
        if index >= count {
            return Err(format!("index {index} is out of range: {count} items"));
        }
        if last.is_some_and(|last| index <= last) {
            return Err(format!("index {index} does not rise"));
        }
        last = Some(index);
    }
    Ok(())
}
