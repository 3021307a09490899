//! A compiled scene: what rays are traced through.

use std::path::Path;

use enfilade_importers::{Frame, Role, Semantic, UpAxis};

use crate::format::records::{
    CameraRecord, CellRecord, ElementRecord, LightRecord, MaterialRecord, RoomRecord, Text, Traits,
};
use crate::format::{FormatError, Pages, Storage, Views, pages_read};

/// A compiled building. Share it among threads by reference or `Arc`: nothing but [`Scene::set_open`] changes it.
///
/// Everything is in the internal frame: metres, Z up, offset taken off. [`Scene::frame`] leads to the source's own.
pub struct Scene {
    pub(crate) tables: Views,
    pub(crate) kernel: crate::trace::Kernel,
    pub(crate) closing: crate::closing::Closing,
    pub(crate) columns: crate::trace::Columns,
}

/// A file could not be opened as a scene.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {kind}")]
pub struct OpenError {
    /// The file's name as it was given.
    pub file: String,
    /// Why.
    #[source]
    pub kind: OpenErrorKind,
}

/// Why a file could not be opened as a scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenErrorKind {
    /// It could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// It is no scene, or a damaged one.
    #[error("{0}")]
    Format(#[from] FormatError),
}

impl Scene {
    /// Opens the `.enf` file at `path`: by memory map with the feature `mmap`, else by reading it. Checksums, indices,
    /// counts and numbers are all checked; those of the building's map when it is asked for (`Scene::building`).
    ///
    /// While a mapped scene is open, no other program may truncate the file or change it in place (replacing it by
    /// renaming another over it is fine, and is what this crate does).
    ///
    /// # Errors
    /// [`OpenError`] for a file that cannot be read or is no scene; no bytes make it panic.
    pub fn open(path: &Path) -> Result<Scene, OpenError> {
        let load = || -> Result<Scene, OpenErrorKind> {
            let storage = Storage::open(&std::fs::File::open(path)?)?;
            Ok(Scene::from_views(Views::open(storage, true)?))
        };
        load().map_err(|kind| OpenError { file: path.display().to_string(), kind })
    }

    /// A scene from the bytes of an `.enf` file, which are copied and checked as by [`Scene::open`].
    ///
    /// # Errors
    /// [`FormatError`]; no bytes make it panic.
    pub fn from_bytes(bytes: &[u8]) -> Result<Scene, FormatError> {
        Ok(Scene::from_views(Views::open(Storage::copy(bytes), true)?))
    }

    /// As [`Scene::from_bytes`], without checking checksums, indices and numbers: faster (what rays need of each cell is still worked
    /// out), for bytes that this version of the crate has just written or already checked.
    ///
    /// # Safety
    /// Bytes that [`Scene::from_bytes`] would refuse make this or tracing panic, answer wrongly or never end.
    #[allow(unsafe_code)]
    pub unsafe fn from_bytes_unchecked(bytes: &[u8]) -> Result<Scene, FormatError> {
        Ok(Scene::from_views(Views::open(Storage::copy(bytes), false)?))
    }

    /// Checks the building's map in the file, if there is one: what opening leaves out, since no ray needs it. What gives the building does so, too.
    ///
    /// # Errors
    /// [`FormatError`] if its sections are damaged.
    pub fn check_map(&self) -> Result<(), FormatError> {
        self.tables.check_map()
    }

    /// The pages of the mapped file of which `work`, which is done once, reads some: what it touches of the scene, if no other thread uses that meanwhile.
    /// `None` where nothing is mapped, or the operating system does not tell: only Linux does.
    pub fn pages_read(&self, work: impl FnOnce()) -> Option<Pages> {
        pages_read(self.tables.file.as_ptr() as usize, work)
    }

    pub(crate) fn from_views(tables: Views) -> Scene {
        let columns = crate::trace::Columns::new(&tables);
        Scene { tables, kernel: crate::trace::Kernel::best(), closing: Default::default(), columns }
    }

    /// The same scene, traced by another kernel: all give the same answers.
    pub fn with_kernel(mut self, kernel: crate::trace::Kernel) -> Scene {
        self.kernel = kernel;
        self
    }

    /// From the source's frame to the internal one.
    pub fn frame(&self) -> Frame {
        let scene = &self.tables.scene[0];
        Frame {
            unit: scene.unit,
            up: if scene.up == 1 { UpAxis::Y } else { UpAxis::Z },
            offset: scene.offset,
        }
    }

    /// The hull: lower and upper corner of the box that holds everything.
    pub fn hull(&self) -> [[f64; 3]; 2] {
        self.tables.scene[0].hull
    }

    /// The tolerance in force, metres.
    pub fn tolerance(&self) -> f64 {
        self.tables.scene[0].tolerance
    }

    /// What the scene holds.
    pub fn traits(&self) -> Traits {
        Traits(self.tables.scene[0].traits)
    }

    /// How the scene was made: JSON with tool, version, options, the source's hash and counts.
    pub fn provenance(&self) -> &str {
        std::str::from_utf8(&self.tables.provenance).unwrap_or("")
    }

    /// A text of the scene.
    pub fn text(&self, text: Text) -> &str {
        let bytes = self.tables.strings.get(text.start as usize..(text.start as usize + text.len as usize));
        bytes.and_then(|b| std::str::from_utf8(b).ok()).unwrap_or("")
    }

    /// How many elements there are.
    pub fn element_count(&self) -> u32 {
        self.tables.elements.len() as u32
    }

    /// The element with this index.
    ///
    /// # Panics
    /// If there is none.
    pub fn element(&self, index: u32) -> ElementView<'_> {
        ElementView { scene: self, record: &self.tables.elements[index as usize], index }
    }

    /// All elements, in the order of their indices.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = ElementView<'_>> {
        (0..self.element_count()).map(|index| self.element(index))
    }

    /// All rooms, in the order of their indices.
    pub fn rooms(&self) -> impl ExactSizeIterator<Item = RoomView<'_>> {
        self.tables.rooms.iter().map(|record| RoomView { scene: self, record })
    }

    /// The room with this index.
    ///
    /// # Panics
    /// If there is none.
    pub fn room(&self, index: u32) -> RoomView<'_> {
        RoomView { scene: self, record: &self.tables.rooms[index as usize] }
    }

    /// Cells.
    pub fn cells(&self) -> &[CellRecord] {
        &self.tables.cells
    }

    /// Materials.
    pub fn materials(&self) -> &[MaterialRecord] {
        &self.tables.materials
    }

    /// Lights.
    pub fn lights(&self) -> &[LightRecord] {
        &self.tables.lights
    }

    /// Cameras.
    pub fn cameras(&self) -> &[CameraRecord] {
        &self.tables.cameras
    }

    /// How many triangles rays can meet as detail.
    pub fn detail_triangle_count(&self) -> u32 {
        self.tables.scene[0].detail_triangles
    }

    /// The corners of a triangle, internal frame, f64 as the source has them; after the model's own come those of the sheets that close
    /// openings ([`Scene::closures`]).
    ///
    /// # Panics
    /// If there is no triangle `index`.
    pub fn triangle(&self, index: u32) -> [[f64; 3]; 3] {
        self.tables.triangles[index as usize].map(|v| self.tables.vertices[v as usize])
    }

    /// The index of the element that a triangle is part of.
    ///
    /// # Panics
    /// If there is no triangle `index`.
    pub fn triangle_element(&self, index: u32) -> u32 {
        self.tables.record(index).element
    }
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scene")
            .field("elements", &self.element_count())
            .field("rooms", &self.tables.rooms.len())
            .field("detail_triangles", &self.detail_triangle_count())
            .field("hull", &self.hull())
            .finish()
    }
}

/// An element of a scene.
#[derive(Clone, Copy)]
pub struct ElementView<'a> {
    scene: &'a Scene,
    record: &'a ElementRecord,
    index: u32,
}

impl<'a> ElementView<'a> {
    /// Its index.
    pub fn index(&self) -> u32 {
        self.index
    }

    /// Its identity.
    pub fn id(&self) -> &'a str {
        self.scene.text(self.record.id)
    }

    /// Its name; may be empty.
    pub fn name(&self) -> &'a str {
        self.scene.text(self.record.name)
    }

    /// Its path in the source.
    pub fn path(&self) -> &'a str {
        self.scene.text(self.record.path)
    }

    /// Its class, or an empty text.
    pub fn class(&self) -> &'a str {
        self.scene.text(self.record.class)
    }

    /// Its storey, or an empty text.
    pub fn storey(&self) -> &'a str {
        self.scene.text(self.record.storey)
    }

    /// Its meaning.
    pub fn semantic(&self) -> Semantic {
        Semantic::from_number(self.record.semantic).unwrap_or_default()
    }

    /// The role of its first component.
    pub fn role(&self) -> Role {
        Role::from_number(self.record.role).unwrap_or(Role::Detail)
    }

    /// Whether it is an opening or a room that was found in the building, and is not in the source.
    pub fn is_derived(&self) -> bool {
        self.record.flags & ElementRecord::DERIVED != 0
    }

    /// How many triangles it has in the scene.
    pub fn triangle_count(&self) -> u32 {
        self.record.triangle_count
    }

    /// Index of the element that it pierces or sits in.
    pub fn host(&self) -> Option<u32> {
        some(self.record.host)
    }

    /// Index of the element that fills it.
    pub fn filling(&self) -> Option<u32> {
        some(self.record.filling)
    }

    /// Index of the opening that it fills.
    pub fn opening(&self) -> Option<u32> {
        some(self.record.opening)
    }
}

fn some(index: u32) -> Option<u32> {
    (index != crate::trace::NONE).then_some(index)
}

/// A room of a scene.
#[derive(Clone, Copy)]
pub struct RoomView<'a> {
    scene: &'a Scene,
    record: &'a RoomRecord,
}

impl<'a> RoomView<'a> {
    /// The element that labels it.
    pub fn element(&self) -> ElementView<'a> {
        self.scene.element(self.record.element)
    }

    /// Lower and upper corner, metres.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        self.record.bounds
    }

    /// Its volume, m3; `None` if its label's mesh is not closed.
    pub fn volume(&self) -> Option<f64> {
        self.is_closed().then_some(self.record.volume)
    }

    /// Area of its floor in the plan, m2; `None` if its label's mesh is not closed.
    pub fn floor_area(&self) -> Option<f64> {
        self.is_closed().then_some(self.record.floor_area)
    }

    /// Whether its label's mesh is closed, so that points can be told to lie in it.
    pub fn is_closed(&self) -> bool {
        self.record.closed == 1
    }
}
