//! A scene as tables: owned while it is compiled, viewed in place once it is opened. Opening checks every index,
//! count and number that a reader relies on, so that later code need not; but for those of the building's map, which are checked when it is asked for.

use std::convert::Infallible;
use std::sync::Arc;

use arrayvec::ArrayVec;
use bytemuck::Pod;
use enfilade_importers::{Role, Semantic};
use glam::DVec3;

use super::FormatError;
#[cfg(feature = "compile")]
use super::container::NewSection;
use super::container::{self, SectionEntry};
use super::map::{DartRecord, MapFaceRecord, MapRecord, MapSourceRecord, MapTriangle, MapVolumeRecord};
use super::records::{
    BlockRecord, CameraRecord, CellRecord, CoverRecord, ElementRecord, FaceRecord, Facing, LANES, Leaf,
    LightRecord, MaterialRecord, NodeRecord, PlaneRecord, RoomRecord, RunRecord, SceneRecord, SideRecord,
    SourceRecord, Text, Traits, TriangleRecord, VolumeRecord,
};
use super::storage::{Storage, View};
use crate::parallel;
use crate::trace::{
    AirGrid, Finder, Guess, NONE, Part, Plate, Prisms, Shape, Split, Splits, Step, Tiles, step_of,
};

/// Deepest hierarchy of boxes that a kernel's stack is made for.
pub(crate) const MAX_DEPTH: u32 = 20;

/// The finest lattice's steps in a metre are 2 to this power.
const MOST_BITS: u32 = 24;

/// Groups of triangles that one thread makes before it asks for more.
const BLOCKS: usize = 1 << 10;

/// Coordinates beyond this, metres, are no building.
const FARTHEST: f64 = 1e13;

/// In the place of the room of a cell that is not of air.
const NO_AIR: u32 = NONE - 1;

/// What stands for the room of outer air.
const OUTER: u32 = NONE - 2;

macro_rules! sections {
    (
        $(#[$about:meta])* $tables:ident, $(#[$in_place:meta])* $views:ident, required: $required:literal
        $(, also $also:ident: $more:ident, $more_views:ident)?
        $(, derived $derived:ident: $made:ident)*;
        $($(#[$doc:meta])* $field:ident: $item:ty;)*
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $tables {
            $($(#[$doc])* pub $field: Vec<$item>,)*
            $(/// Optional sections, all or none.
            pub $also: Option<$more>,)?
        }

        $(#[$in_place])*
        #[derive(Clone)]
        pub(crate) struct $views {
            $(pub $field: View<$item>,)*
            $(/// Optional sections, all or none.
            pub $also: Option<$more_views>,)?
            $(/// In no file: made by what opens it.
            pub $derived: View<$made>,)*
        }

        #[cfg(feature = "compile")]
        impl $tables {
            fn sections(&self) -> Vec<NewSection<'_>> {
                let own = [$(NewSection {
                    name: stringify!($field),
                    required: $required,
                    item_size: size_of::<$item>(),
                    bytes: bytemuck::cast_slice(&self.$field),
                    packed: None,
                },)*];
                let own = own.into_iter();
                $(let own = own.chain(self.$also.iter().flat_map($more::sections));)?
                own.collect()
            }
        }

        impl $views {
            const NAMES: &'static [&'static str] = &[$(stringify!($field),)*];

            fn find(storage: &Arc<Storage>, table: &[SectionEntry]) -> Result<$views, FormatError> {
                Ok($views {
                    $($field: view(storage, table, stringify!($field))?,)*
                    $($also: $more_views::find_all_or_none(storage, table)?,)?
                    $($derived: View::own(Vec::new()),)*
                })
            }
        }
    };
}

sections! {
    /// The tables of a scene that is being compiled.
    Tables,
    /// The tables of an opened scene, in place.
    Views, required: true, also map: MapTables, MapViews, derived run_of: u32, derived semantics: u8, derived airs: u32,
    derived blocks: BlockRecord, derived steps: Step, derived plates: Plate, derived splits: Split,
    derived parts: Part, derived tiles: Tiles, derived shapes: Shape,
    derived airgrid: AirGrid, derived airguess: Guess, derived aircells: u32, derived map_unchecked: SectionEntry,
    derived file: u8;
    /// One record about the whole.
    scene: SceneRecord;
    /// UTF-8.
    strings: u8;
    /// JSON: tool, version, options, hash of the source, counts.
    provenance: u8;
    /// Elements.
    elements: ElementRecord;
    /// Rooms.
    rooms: RoomRecord;
    /// Cells.
    cells: CellRecord;
    /// Sides of cells.
    sides: SideRecord;
    /// Faces of sides.
    faces: FaceRecord;
    /// What lies below floors and above ceilings.
    covers: CoverRecord;
    /// Planes of floors, ceilings and faces' upper edges.
    planes: PlaneRecord;
    /// What rays meet at faces and covers.
    sources: SourceRecord;
    /// Their triangles.
    surfaces: u32;
    /// For each cube of the grid over the prisms (x fastest) the first of its items, and the end of the last.
    cellgrid: u32;
    /// Prisms that reach into a cube.
    gridcells: u32;
    /// Materials.
    materials: MaterialRecord;
    /// Lights.
    lights: LightRecord;
    /// Cameras.
    cameras: CameraRecord;
    /// Vertices, internal frame, metres.
    vertices: [f64; 3];
    /// Corners of triangles.
    triangles: [u32; 3];
    /// What else is known of triangles.
    runs: RunRecord;
    /// Inner nodes of the hierarchies of boxes.
    nodes: NodeRecord;
    /// Triangles of their leaves, or none.
    leaves: u32;
    /// Closed components.
    volumes: VolumeRecord;
    /// For each cube of the locator (x fastest) the first of its items, and the end of the last.
    locator: u32;
    /// Volumes that may hold points of a cube; with the top bit set, that hold all of them.
    located: u32;
}

sections! {
    /// The map of the building.
    MapTables,
    /// The map of the building in an opened scene.
    MapViews, required: false;
    /// One record about the whole.
    map: MapRecord;
    /// Darts.
    darts: DartRecord;
    /// Where the map's vertices are, lattice units.
    mapvertices: [f64; 3];
    /// Its volumes.
    mapvolumes: MapVolumeRecord;
    /// Corners of their footprints, lattice units.
    mapcorners: [i32; 2];
    /// Their planes: slope along x, along y, height over the origin, in parts of a lattice unit.
    mapplanes: [i64; 3];
    /// Its faces.
    mapfaces: MapFaceRecord;
    /// Surfaces behind faces.
    mapsources: MapSourceRecord;
    /// Their triangles.
    maptriangles: MapTriangle;
    /// Triangles that no face stands for.
    mapdetail: MapTriangle;
}

impl MapViews {
    fn find_all_or_none(
        storage: &Arc<Storage>,
        table: &[SectionEntry],
    ) -> Result<Option<MapViews>, FormatError> {
        let has = |name: &&&str| table.iter().any(|entry| entry.name() == **name);
        match MapViews::NAMES.iter().filter(has).count() {
            0 => Ok(None),
            _ => MapViews::find(storage, table).map(Some),
        }
    }
}

/// The bit of an item of the section `located` that marks a volume that holds the whole cube.
pub(crate) const WHOLE_BIT: u32 = 1 << 31;

/// Sections that opening reads whole, whatever is asked then: to pack them costs a scene nothing that it would not read.
#[cfg(feature = "compile")]
const READ_WHOLE: [&str; 3] = ["vertices", "triangles", "leaves"];

impl Tables {
    /// The file. Of the sections that opening reads whole those are packed that have so many bytes.
    #[cfg(feature = "compile")]
    pub fn to_bytes(&self, pack_from: u64) -> Vec<u8> {
        let mut sections = self.sections();
        for section in &mut sections {
            if READ_WHOLE.contains(&section.name) && section.bytes.len() as u64 >= pack_from {
                section.packed = super::packed::pack(section.bytes, section.item_size);
            }
        }
        container::write(&sections)
    }

    /// A triangle.
    #[inline]
    pub fn record(&self, triangle: u32) -> TriangleRecord {
        let after = self.runs.partition_point(|run| run.first <= triangle);
        self.runs[after - 1].of(self.triangles[triangle as usize])
    }

    /// Adds a triangle.
    pub fn push(&mut self, triangle: TriangleRecord) {
        let run = RunRecord::from(self.triangles.len() as u32, &triangle);
        if self.runs.last().is_none_or(|last| RunRecord { first: last.first, ..run } != *last) {
            self.runs.push(run);
        }
        self.triangles.push(triangle.vertices);
    }

    /// Adds leaves of these triangles, one to eight each, and returns their links. A leaf goes into the fullest group of eight among the last few that
    /// has room for it: those that hang from one node stay together.
    pub fn add_leaves<T: ExactSizeIterator<Item = u32>>(
        &mut self,
        leaves: impl IntoIterator<Item = T>,
    ) -> Vec<u32> {
        /// Groups that wait to be filled.
        const OPEN: usize = 8;
        let last = self.leaves.len();
        self.leaves.resize(last.next_multiple_of(LANES), NONE);
        // Of each: its first place that is free, and how many are.
        let mut open = ArrayVec::<(usize, usize), OPEN>::new();
        if last < self.leaves.len() {
            open.push((last, self.leaves.len() - last));
        }
        let mut links = Vec::new();
        for leaf in leaves {
            let count = leaf.len();
            let fits = open.iter().enumerate().filter(|(_, (_, room))| *room >= count);
            let place = match fits.min_by_key(|(_, (_, room))| *room) {
                Some((place, _)) => place,
                None => {
                    if open.is_full() {
                        // The one with the least room.
                        let fullest = (0..OPEN).min_by_key(|&place| open[place].1).unwrap_or(0);
                        open.remove(fullest);
                    }
                    open.push((self.leaves.len(), LANES));
                    self.leaves.resize(self.leaves.len() + LANES, NONE);
                    open.len() - 1
                }
            };
            let (first, room) = &mut open[place];
            for (to, triangle) in self.leaves[*first..].iter_mut().zip(leaf) {
                *to = triangle;
            }
            links.push(Leaf::link(*first, count));
            (*first, *room) = (*first + count, *room - count);
            if *room == 0 {
                open.remove(place);
            }
        }
        // What follows may go on where the last group ends.
        while self.leaves.last() == Some(&NONE) {
            self.leaves.pop();
        }
        links
    }

    /// Adds a text to the section `strings`.
    pub fn text(&mut self, text: &str) -> Text {
        let start = self.strings.len() as u32;
        self.strings.extend_from_slice(text.as_bytes());
        Text { start, len: text.len() as u32 }
    }
}

fn view<T: Pod>(
    storage: &Arc<Storage>,
    table: &[SectionEntry],
    name: &'static str,
) -> Result<View<T>, FormatError> {
    let entry = table.iter().find(|e| e.name() == name).ok_or(FormatError::Missing(name))?;
    if entry.item_size != size_of::<T>() as u64 {
        let text = format!("section '{name}' has items of {} bytes, not {}", entry.item_size, size_of::<T>());
        return Err(FormatError::Table(text));
    }
    if entry.is_packed() {
        let stored = &storage.bytes()[entry.range()];
        let items = Arc::new(super::packed::unpack(name, stored, entry.unpacked, entry.item_size)?);
        return View::new(&items, 0..items.bytes().len());
    }
    View::new(storage, entry.range())
}

impl Views {
    /// The tables in `storage`. With `checked`, checksums, indices and numbers are checked; without, only what keeps
    /// memory safe by construction (the table itself) is. The map's own are always checked, when they are asked for ([`Views::check_map`]): rays do
    /// not read them.
    pub(crate) fn open(storage: Storage, checked: bool) -> Result<Views, FormatError> {
        let storage = Arc::new(storage);
        let table = container::read_table(storage.bytes())?;
        for entry in &table {
            let name = entry.name();
            let known = [Views::NAMES, MapViews::NAMES].iter().any(|names| names.contains(&name.as_str()));
            if !known && entry.flags & SectionEntry::REQUIRED != 0 {
                return Err(FormatError::Unknown(entry.name()));
            }
        }
        if checked {
            let mut own = table.iter().filter(|entry| Views::NAMES.contains(&entry.name().as_str()));
            own.try_for_each(|entry| container::check(&storage.bytes()[entry.range()], entry))?;
        }
        let mut views = Views::find(&storage, &table)?;
        views.file = View::new(&storage, 0..storage.bytes().len())?;
        if views.scene.len() != 1 {
            return Err(FormatError::Table(format!("{} scene records", views.scene.len())));
        }
        if checked {
            Check::new(&views)?.all()?;
        }
        let of_map = |entry: &SectionEntry| MapViews::NAMES.contains(&entry.name().as_str());
        views.map_unchecked = View::own(table.iter().copied().filter(of_map).collect());
        views.derive();
        Ok(views)
    }

    /// Checks the sections of the map as [`Views::open`] does the others.
    pub(crate) fn check_map(&self) -> Result<(), FormatError> {
        for entry in &*self.map_unchecked {
            container::check(&self.file[entry.range()], entry)?;
        }
        super::map::check(self)
    }

    /// How many sections rays have.
    #[cfg(all(feature = "compile", feature = "render"))]
    pub(crate) fn ray_sections() -> u64 {
        Views::NAMES.len() as u64
    }

    /// How many sections the map has, and how many bytes these.
    #[cfg(all(feature = "compile", feature = "render"))]
    pub(crate) fn map_sections(&self) -> (u64, u64) {
        (self.map_unchecked.len() as u64, self.map_unchecked.iter().map(|entry| entry.len).sum())
    }

    /// Works out what is in no file: what rays need of triangles, of each cell and of each source, side by side.
    pub(crate) fn derive(&mut self) {
        self.run_of = View::own(self.runs_by_triangle());
        // Beside each other: the records that they are of are large.
        self.semantics = View::own(self.elements.iter().map(|element| element.semantic as u8).collect());
        let air = |cell: &CellRecord| match (cell.kind, cell.room) {
            (CellRecord::AIR, NONE) if cell.semantic == Semantic::Exterior as u16 => OUTER,
            (CellRecord::AIR, room) => room,
            _ => NO_AIR,
        };
        self.airs = View::own(self.cells.iter().map(air).collect());
        self.blocks = View::own(self.groups());
        let prisms = Prisms::new(self);
        let mut splits = Splits::default();
        let steps: Vec<Step> = self.cells.iter().map(|cell| step_of(&prisms, cell, &mut splits)).collect();
        let plates: Vec<Plate> = self.sources.iter().map(|source| Plate::of(self, source)).collect();
        let finder = Finder::new(&self.scene[0], &self.cells, &steps);
        (self.steps, self.plates) = (View::own(steps), View::own(plates));
        (self.splits, self.parts) = (View::own(splits.splits), View::own(splits.parts));
        (self.tiles, self.shapes) = (View::own(splits.tiles), View::own(splits.shapes));
        self.airgrid = View::own(vec![finder.grid]);
        (self.airguess, self.aircells) = (View::own(finder.guesses), View::own(finder.cells));
    }
}

impl Views {
    /// Whether there is such a cell, and it is a prism of air.
    #[inline(always)]
    pub(crate) fn is_air(&self, cell: u32) -> bool {
        // What kernels read of it first, in most cases.
        self.steps.get(cell as usize).is_some_and(Step::is_some)
            || self.cells.get(cell as usize).is_some_and(|cell| cell.kind == CellRecord::AIR)
    }

    /// The room of a cell of air, or [`NONE`]; `None` of others.
    #[inline(always)]
    pub(crate) fn room_of(&self, cell: u32) -> Option<u32> {
        let room = self.airs.get(cell as usize).copied().filter(|&room| room != NO_AIR);
        room.map(|room| if room == OUTER { NONE } else { room })
    }

    /// Whether a cell is one of outer air.
    #[inline(always)]
    pub(crate) fn is_outer(&self, cell: u32) -> bool {
        self.airs.get(cell as usize).is_some_and(|&room| room == OUTER)
    }

    /// A triangle.
    #[inline]
    pub(crate) fn record(&self, triangle: u32) -> TriangleRecord {
        let triangle = triangle as usize;
        self.runs[self.run_of[triangle] as usize].of(self.triangles[triangle])
    }

    /// The run of each triangle.
    fn runs_by_triangle(&self) -> Vec<u32> {
        let mut run_of = Vec::with_capacity(self.triangles.len());
        let ends = self.runs.iter().skip(1).map(|run| run.first as usize).chain([self.triangles.len()]);
        for (run, end) in (0..).zip(ends) {
            run_of.resize(end, run);
        }
        run_of
    }

    /// Items of the section `leaves` by eights, as kernels read them.
    fn groups(&self) -> Vec<BlockRecord> {
        let center = DVec3::from(self.scene[0].center);
        let group = |items: &[u32], block: &mut BlockRecord| {
            for (lane, &triangle) in items.iter().enumerate().filter(|(_, triangle)| **triangle != NONE) {
                let corners =
                    self.triangles[triangle as usize].map(|v| DVec3::from(self.vertices[v as usize]));
                block.put(lane, triangle, corners, center);
            }
        };
        let items = |number: usize| &self.leaves[LANES * number..self.leaves.len().min(LANES * (number + 1))];
        // In place: of the tables this is one of the largest.
        let mut blocks = vec![BlockRecord::EMPTY; self.leaves.len().div_ceil(LANES)];
        let Ok(()) =
            parallel::try_for_chunks(&mut blocks, BLOCKS, |chunk, blocks| -> Result<(), Infallible> {
                (BLOCKS * chunk..).zip(blocks).for_each(|(number, block)| group(items(number), block));
                Ok(())
            });
        blocks
    }
}

/// Checks that every table keeps what the format promises.
struct Check<'a> {
    views: &'a Views,
    strings: &'a str,
}

impl<'a> Check<'a> {
    /// The section `strings` is read as a whole, once: many texts may lie over each other.
    fn new(views: &'a Views) -> Result<Check<'a>, FormatError> {
        match std::str::from_utf8(&views.strings) {
            Ok(strings) => Ok(Check { views, strings }),
            Err(error) => Err(FormatError::Invalid {
                section: "strings",
                item: error.valid_up_to() as u64,
                what: "no UTF-8".to_owned(),
            }),
        }
    }

    fn all(&self) -> Result<(), FormatError> {
        self.scene()?;
        self.building()?;
        super::prisms::check(self.views)?;
        self.looks()?;
        self.triangles()?;
        self.volumes()?;
        self.locator()?;
        self.hierarchy()
    }

    fn text(&self, section: &'static str, item: usize, text: Text) -> Result<(), FormatError> {
        let end = u64::from(text.start) + u64::from(text.len);
        ensure(self.strings.get(text.start as usize..end as usize).is_some(), section, item, || {
            format!("text {}..{end} is no text", text.start)
        })
    }

    fn scene(&self) -> Result<(), FormatError> {
        let scene = &self.views.scene[0];
        let check = |ok: bool, what: &str| ensure(ok, "scene", 0, || what.to_owned());
        check(scene.unit.is_finite() && scene.unit > 0.0, "the unit is no positive number")?;
        check(scene.up == 1 || scene.up == 2, "the up axis is neither Y nor Z")?;
        check(scene.offset.iter().all(|c| within(*c)), "the offset is no number")?;
        check(is_box(scene.hull), "the hull is no box")?;
        check(scene.center.iter().all(|c| within(*c)), "the center is no number")?;
        check(scene.tolerance >= 0.0 && within(scene.tolerance), "the tolerance is no number")?;
        check(scene.slack >= 0.0 && scene.slack.is_finite(), "the slack is no number")?;
        check(scene.lattice_origin.iter().all(|c| within(*c)), "the lattice's origin is no number")?;
        let [cos, sin] = scene.lattice_turn;
        // Where it is not turned nothing is.
        let is_turned = sin != 0.0 || cos == 1.0;
        let is_angle = (cos * cos + sin * sin - 1.0).abs() <= 1e-9 && is_turned;
        check(is_angle, "the lattice is turned by no angle")?;
        check(scene.lattice_bits <= MOST_BITS, "the lattice is too fine")?;
        check(is_box(scene.zone), "the zone of the prisms is no box")?;
        check(scene.traits & !Traits::ALL == 0, "unknown traits")
    }

    fn building(&self) -> Result<(), FormatError> {
        let v = self.views;
        let elements = v.elements.len();
        let optional = |index: u32, count: usize| index == NONE || (index as usize) < count;
        for (i, e) in v.elements.iter().enumerate() {
            for text in [e.id, e.name, e.path, e.class, e.storey] {
                self.text("elements", i, text)?;
            }
            let end = u64::from(e.first_triangle) + u64::from(e.triangle_count);
            ensure(end <= v.triangles.len() as u64, "elements", i, || format!("triangles up to {end}"))?;
            ensure(Semantic::from_number(e.semantic).is_some(), "elements", i, || {
                format!("semantic {}", e.semantic)
            })?;
            ensure(Role::from_number(e.role).is_some(), "elements", i, || format!("role {}", e.role))?;
            ensure(e.flags <= ElementRecord::DERIVED, "elements", i, || format!("flags {}", e.flags))?;
            for other in [e.host, e.filling, e.opening] {
                ensure(optional(other, elements), "elements", i, || format!("element {other}"))?;
            }
        }
        for (i, r) in v.rooms.iter().enumerate() {
            ensure((r.element as usize) < elements, "rooms", i, || format!("element {}", r.element))?;
            ensure(is_box(r.bounds), "rooms", i, || "the bounds are no box".to_owned())?;
            ensure(r.volume.is_finite() && r.floor_area.is_finite(), "rooms", i, || "not finite".to_owned())?;
        }
        Ok(())
    }

    fn looks(&self) -> Result<(), FormatError> {
        let v = self.views;
        for (i, m) in v.materials.iter().enumerate() {
            self.text("materials", i, m.name)?;
            let numbers = [m.alpha, m.metallic, m.roughness, m.ior, m.transmission];
            let ok = m.base_color.iter().chain(&m.emissive).chain(&numbers).all(|c| c.is_finite());
            ensure(ok, "materials", i, || "not finite".to_owned())?;
        }
        for (i, l) in v.lights.iter().enumerate() {
            self.text("lights", i, l.name)?;
            let ok =
                l.position.iter().chain(&l.direction).all(|c| within(*c)) && !l.range.is_nan() && l.kind <= 2;
            ensure(ok, "lights", i, || "not a light".to_owned())?;
        }
        for (i, c) in v.cameras.iter().enumerate() {
            self.text("cameras", i, c.name)?;
            let ok = c.eye.iter().chain(&c.direction).chain(&c.up).all(|c| within(*c))
                && c.vfov > 0.0
                && c.vfov < 180.0;
            ensure(ok, "cameras", i, || "not a camera".to_owned())?;
        }
        Ok(())
    }

    fn triangles(&self) -> Result<(), FormatError> {
        let v = self.views;
        if let Some(i) = v.vertices.iter().position(|p| !p.iter().all(|c| within(*c))) {
            return invalid("vertices", i, "not finite".to_owned());
        }
        for (i, corners) in v.triangles.iter().enumerate() {
            let ok = corners.iter().all(|&p| (p as usize) < v.vertices.len());
            ensure(ok, "triangles", i, || format!("{corners:?} are no vertices"))?;
        }
        let starts = v.runs.first().map(|run| run.first);
        ensure(starts == v.triangles.first().map(|_| 0), "runs", 0, || format!("starts at {starts:?}"))?;
        for (i, run) in v.runs.iter().enumerate() {
            let end = v.runs.get(i + 1).map_or(v.triangles.len(), |next| next.first as usize);
            let ok = (run.first as usize) < end
                && (run.element as usize) < v.elements.len()
                && (run.material as usize) < v.materials.len()
                && (run.volume == NONE || (run.volume as usize) < v.volumes.len())
                && Facing::of(run.facing).is_some();
            ensure(ok, "runs", i, || format!("{run:?} refers to what is not there"))?;
        }
        let detail = v.scene[0].detail_triangles as usize;
        ensure(detail <= v.triangles.len(), "scene", 0, || format!("{detail} detail triangles"))
    }

    /// No triangle is of two volumes, so that a look-up goes through each triangle at most once.
    fn volumes(&self) -> Result<(), FormatError> {
        let v = self.views;
        let mut free = 0;
        for (i, volume) in v.volumes.iter().enumerate() {
            let start = u64::from(volume.first_triangle);
            let end = start + u64::from(volume.triangle_count);
            let apart = start >= std::mem::replace(&mut free, end);
            ensure(apart, "volumes", i, || "it shares triangles with one before".to_owned())?;
            let ok = end <= v.triangles.len() as u64
                && (volume.element as usize) < v.elements.len()
                && (volume.room == NONE || (volume.room as usize) < v.rooms.len())
                && matches!(Role::from_number(volume.role), Some(Role::Solid | Role::Air))
                && volume.by_winding <= 1
                && is_box(volume.bounds)
                && volume.measure.is_finite();
            ensure(ok, "volumes", i, || format!("{volume:?} refers to what is not there"))?;
        }
        Ok(())
    }

    fn locator(&self) -> Result<(), FormatError> {
        let v = self.views;
        let scene = &v.scene[0];
        let ok = scene.locator_origin.iter().all(|c| within(*c))
            && scene.locator_step > 0.0
            && scene.locator_step.is_finite();
        ensure(ok, "scene", 0, || "the locator is no grid".to_owned())?;
        let cubes = scene.locator_dims.iter().try_fold(1u64, |n, &d| n.checked_mul(u64::from(d)));
        let starts = v.locator.len() as u64;
        ensure(cubes.is_some_and(|n| n < u64::from(u32::MAX) && n + 1 == starts), "locator", 0, || {
            format!("{starts} starts for {:?} cubes", scene.locator_dims)
        })?;
        let ordered = v.locator.windows(2).all(|w| w[0] <= w[1])
            && v.locator[0] == 0
            && v.locator[v.locator.len() - 1] as usize == v.located.len();
        ensure(ordered, "locator", 0, || "the starts do not ascend".to_owned())?;
        for cube in v.locator.windows(2) {
            let (start, end) = (cube[0] as usize, cube[1] as usize);
            let ascending = v.located[start..end].windows(2).all(|items| items[0] < items[1]);
            ensure(ascending, "located", start, || "the volumes of a cube do not ascend".to_owned())?;
        }
        match v.located.iter().position(|&item| (item & !WHOLE_BIT) as usize >= v.volumes.len()) {
            Some(i) => invalid("located", i, format!("volume {}", v.located[i] & !WHOLE_BIT)),
            None => Ok(()),
        }
    }

    /// Whether the items of a leaf are there, all in one group of eight.
    fn is_leaf(&self, link: u32) -> bool {
        let leaf = Leaf::new(link);
        leaf.first() % LANES + leaf.count() <= LANES && leaf.first() + leaf.count() <= self.views.leaves.len()
    }

    /// Every node is the child of at most one node, before it, and is that or the root of a cell or source, or both; no chain is longer than
    /// the kernels' stacks allow: so every walk ends.
    fn hierarchy(&self) -> Result<(), FormatError> {
        let v = self.views;
        let (mut depth, mut links) = (vec![0u32; v.nodes.len()], 0);
        let mut is_child = vec![false; v.nodes.len()];
        let cells = v.cells.iter().map(|c| c.root).enumerate().map(|(i, root)| ("cells", i, root));
        let sources = v.sources.iter().map(|s| s.root).enumerate().map(|(i, root)| ("sources", i, root));
        for (section, i, root) in cells.chain(sources).filter(|&(_, _, root)| root != NONE) {
            let fresh = if root & Leaf::BIT != 0 {
                links += 1;
                self.is_leaf(root)
            } else {
                depth.get_mut(root as usize).is_some_and(|d| std::mem::replace(d, 1) == 0)
            };
            ensure(fresh, section, i, || format!("root {root:#x} is not there, or not its own"))?;
        }
        for (i, node) in v.nodes.iter().enumerate() {
            ensure(depth[i] > 0, "nodes", i, || "no earlier node, cell or source refers to it".to_owned())?;
            ensure(depth[i] <= MAX_DEPTH, "nodes", i, || "nested too deeply".to_owned())?;
            for lane in 0..LANES {
                let child = node.child[lane];
                let bounds = |axis: usize| (node.lo[axis][lane], node.hi[axis][lane]);
                let empty = (0..3).all(|axis| bounds(axis) == (f32::INFINITY, f32::NEG_INFINITY));
                let full =
                    (0..3).all(|axis| matches!(bounds(axis), (lo, hi) if lo <= hi && (hi - lo).is_finite()));
                let ok = if child == NONE { empty } else { full };
                ensure(ok, "nodes", i, || format!("the box of lane {lane} is none"))?;
                if child == NONE {
                    continue;
                }
                if child & Leaf::BIT != 0 {
                    links += 1;
                    ensure(self.is_leaf(child), "nodes", i, || format!("leaf {child:#x} is not there"))?;
                } else {
                    let fresh = child as usize > i
                        && is_child.get_mut(child as usize).is_some_and(|is| !std::mem::replace(is, true));
                    ensure(fresh, "nodes", i, || format!("child {child} is not there, or not its own"))?;
                    depth[child as usize] = depth[child as usize].max(depth[i] + 1);
                }
            }
        }
        let detail = v.scene[0].detail_triangles;
        ensure(v.leaves.len() <= Leaf::MOST, "leaves", Leaf::MOST, || {
            "more than links can count".to_owned()
        })?;
        // What opening makes of them is ten times as large: none are there that nothing refers to.
        ensure(v.leaves.len() <= LANES * links, "leaves", LANES * links, || {
            "no leaf refers to it".to_owned()
        })?;
        match v.leaves.iter().position(|&triangle| triangle != NONE && triangle >= detail) {
            Some(i) => invalid("leaves", i, format!("triangle {}", v.leaves[i])),
            None => Ok(()),
        }
    }
}

pub(super) fn within(c: f64) -> bool {
    c.abs() <= FARTHEST
}

pub(super) fn is_box(bounds: [[f64; 3]; 2]) -> bool {
    (0..3)
        .all(|axis| within(bounds[0][axis]) && within(bounds[1][axis]) && bounds[0][axis] <= bounds[1][axis])
}

pub(super) fn invalid(section: &'static str, item: usize, what: String) -> Result<(), FormatError> {
    Err(FormatError::Invalid { section, item: item as u64, what })
}

pub(super) fn ensure(
    ok: bool,
    section: &'static str,
    item: usize,
    what: impl FnOnce() -> String,
) -> Result<(), FormatError> {
    if ok { Ok(()) } else { invalid(section, item, what()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::splitmix::SplitMix64;

    /// Each leaf is found whole at its link, in one group; no place is of two; and few places are left empty.
    #[test]
    fn leaves_fill_their_groups() {
        let mut random = SplitMix64::new(5);
        let (mut tables, mut next) = (Tables::default(), 0);
        let (mut links, mut leaves) = (Vec::new(), Vec::new());
        // Of hierarchies with none, one, few and many.
        for count in [0, 1, 2, 5, 0, 1000, 3, 1, 400] {
            let own: Vec<Vec<u32>> = (0..count)
                .map(|_| {
                    let first = next;
                    next += 1 + random.below(LANES as u64) as u32;
                    (first..next).collect()
                })
                .collect();
            links.extend(tables.add_leaves(own.iter().map(|leaf| leaf.iter().copied())));
            leaves.extend(own);
        }
        assert_eq!(links.len(), leaves.len());
        for (&link, leaf) in links.iter().zip(&leaves) {
            let place = Leaf::new(link);
            assert_eq!(tables.leaves[place.first()..place.first() + place.count()], leaf[..]);
            assert!(place.first() % LANES + place.count() <= LANES);
        }
        let filled = tables.leaves.iter().filter(|&&triangle| triangle != NONE).count();
        assert_eq!(filled, next as usize);
        assert!(tables.leaves.len() * 19 < filled * 20, "{filled} of {}", tables.leaves.len());
    }
}
