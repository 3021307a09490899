//! The bytes of an opened file, and typed views of them. One of the crate's few modules with `unsafe`: a view keeps
//! the bytes alive by reference count and points into them, which the borrow checker cannot follow.
#![allow(unsafe_code)]

use std::fs::File;
use std::ops::{Deref, Range};
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};

use super::FormatError;

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// Immutable bytes, from a 64-byte boundary on.
pub enum Storage {
    /// In memory.
    Owned {
        /// The bytes, then zeros up to a multiple of 64.
        lines: Lines,
        /// How many count.
        len: usize,
    },
    /// A mapped file.
    #[cfg(feature = "mmap")]
    Map(memmap2::Mmap),
}

/// Aligned memory.
pub struct Lines(Vec<Line>);

impl Storage {
    /// A copy of `bytes`.
    pub fn copy(bytes: &[u8]) -> Storage {
        let mut lines = vec![Line([0; 64]); bytes.len().div_ceil(64)];
        bytemuck::cast_slice_mut(&mut lines)[..bytes.len()].copy_from_slice(bytes);
        Storage::Owned { lines: Lines(lines), len: bytes.len() }
    }

    /// Zeros that `fill` makes `len` bytes of.
    ///
    /// # Errors
    /// Those of `fill`.
    pub fn made<E>(len: usize, fill: impl FnOnce(&mut [u8]) -> Result<(), E>) -> Result<Storage, E> {
        let mut lines = vec![Line([0; 64]); len.div_ceil(64)];
        fill(&mut bytemuck::cast_slice_mut(&mut lines)[..len])?;
        Ok(Storage::Owned { lines: Lines(lines), len })
    }

    /// The file's bytes: mapped with the feature `mmap`, else read.
    ///
    /// # Errors
    /// Those of the operating system.
    pub fn open(file: &File) -> std::io::Result<Storage> {
        #[cfg(feature = "mmap")]
        {
            // SAFETY: a map is undefined behaviour if another process truncates or rewrites the file meanwhile. Every
            // writer of this crate replaces files by renaming and never in place; `Scene::open` documents that
            // others must not either, and `Scene::from_bytes` is there for files that cannot be trusted to stay.
            unsafe { memmap2::Mmap::map(file) }.map(Storage::Map)
        }
        #[cfg(not(feature = "mmap"))]
        {
            use std::io::Read;
            let mut bytes = Vec::new();
            let mut file = file;
            file.read_to_end(&mut bytes)?;
            Ok(Storage::copy(&bytes))
        }
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Storage::Owned { lines, len } => &bytemuck::cast_slice(&lines.0)[..*len],
            #[cfg(feature = "mmap")]
            Storage::Map(map) => map,
        }
    }
}

/// A typed view of a part of a [`Storage`], or of items of its own once it was edited.
pub struct View<T> {
    items: *const T,
    len: usize,
    // Keeps the items alive; never read.
    keeper: Keeper<T>,
}

#[derive(Clone)]
enum Keeper<T> {
    Storage(#[allow(dead_code)] Arc<Storage>),
    Own(Arc<Vec<T>>),
}

impl<T: Pod> View<T> {
    /// The items in `range` of the bytes of `storage`.
    ///
    /// # Errors
    /// [`FormatError::Table`] if the range is no whole number of items or not aligned for `T`.
    ///
    /// # Panics
    /// If `range` does not lie within the bytes.
    pub fn new(storage: &Arc<Storage>, range: Range<usize>) -> Result<View<T>, FormatError> {
        let items: &[T] = bytemuck::try_cast_slice(&storage.bytes()[range])
            .map_err(|e| FormatError::Table(format!("a section does not fit its items: {e}")))?;
        Ok(View { items: items.as_ptr(), len: items.len(), keeper: Keeper::Storage(Arc::clone(storage)) })
    }

    /// Items of its own: the others stay as they are in the storage.
    pub fn own(items: Vec<T>) -> View<T> {
        // Moving a vector does not move its items.
        View { items: items.as_ptr(), len: items.len(), keeper: Keeper::Own(Arc::new(items)) }
    }

    /// Changes the items, which are copied out of the storage beforehand.
    pub fn edit<R>(&mut self, change: impl FnOnce(&mut Vec<T>) -> R) -> R {
        let empty = View::own(Vec::new());
        let mut items = match std::mem::replace(self, empty) {
            View { keeper: Keeper::Own(items), .. } => {
                Arc::try_unwrap(items).unwrap_or_else(|shared| shared.to_vec())
            }
            stored => stored.to_vec(),
        };
        let result = change(&mut items);
        *self = View::own(items);
        result
    }
}

impl<T: Pod> Clone for View<T> {
    fn clone(&self) -> View<T> {
        View { items: self.items, len: self.len, keeper: self.keeper.clone() }
    }
}

impl<T> Deref for View<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        // SAFETY: `items` and `len` are those of a slice that `keeper` keeps: into the bytes of a storage, which are never
        // moved, changed or freed while the reference count that `self` holds is alive; or of a vector, of which the same is
        // true: only who holds the last reference takes it out. The slice's lifetime is that of `&self`.
        unsafe { std::slice::from_raw_parts(self.items, self.len) }
    }
}

// SAFETY: a `View` is a shared reference to immutable memory that it owns a share of, as `Arc<[T]>` is, or all of, as
// `Vec<T>` does.
unsafe impl<T: Send + Sync> Send for View<T> {}
// SAFETY: as above; no method gives out anything but shared references.
unsafe impl<T: Send + Sync> Sync for View<T> {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_outlive_the_handle() {
        let storage = Arc::new(Storage::copy(&[1, 0, 0, 0, 2, 0, 0, 0, 9]));
        let view: View<u32> = View::new(&storage, 0..8).unwrap();
        assert!(View::<u32>::new(&storage, 0..9).is_err());
        assert!(View::<u32>::new(&storage, 1..5).is_err());
        drop(storage);
        assert_eq!(*view, [1, 2]);
    }

    #[test]
    fn edits_leave_the_storage_and_other_views_as_they_are() {
        let storage = Arc::new(Storage::copy(&[1, 0, 0, 0, 2, 0, 0, 0]));
        let mut view: View<u32> = View::new(&storage, 0..8).unwrap();
        let before = view.clone();
        assert_eq!(view.edit(|items| (items.push(3), items.len()).1), 3);
        let between = view.clone();
        view.edit(|items| items[0] = 7);
        let moved = Box::new(view);
        assert_eq!((&**moved, &*between, &*before), (&[7, 2, 3][..], &[1, 2, 3][..], &[1, 2][..]));
        drop(between);
        assert_eq!(**moved, [7, 2, 3]);
    }
}
