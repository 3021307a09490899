//! The plain records that a compiled scene is made of, byte for byte as `docs/FORMAT.md` lays them out.
//!
//! All are `#[repr(C)]` without padding, little-endian. Indices that stand for none are `u32::MAX`.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// A text: bytes `start..start + len` of the section `strings`, UTF-8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Text {
    /// First byte.
    pub start: u32,
    /// Bytes.
    pub len: u32,
}

/// Section `scene`: one record about the whole.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SceneRecord {
    /// Metres in one unit of the source.
    pub unit: f64,
    /// What was taken off the internal coordinates, metres.
    pub offset: [f64; 3],
    /// The hull's lower and upper corner, internal frame, metres.
    pub hull: [[f64; 3]; 2],
    /// What is taken off coordinates before they are rounded to f32 (boxes, blocks).
    pub center: [f64; 3],
    /// The tolerance in force, metres.
    pub tolerance: f64,
    /// The locator's lower corner, metres.
    pub locator_origin: [f64; 3],
    /// Edge of the locator's cubes, metres.
    pub locator_step: f64,
    /// Cubes of the locator along x, y and z.
    pub locator_dims: [u32; 3],
    /// 1 if the source's Y points up, 2 if its Z does.
    pub up: u32,
    /// What the scene holds, see [`Traits`].
    pub traits: u32,
    /// Triangles that rays can meet: the first so many.
    pub detail_triangles: u32,
    /// Slack of the f32 kernels, metres: boxes are inflated by it, triangles nearer to a ray are tested in f64.
    pub slack: f32,
    /// Steps of the lattice in a metre are 2 to this power.
    pub lattice_bits: u32,
    /// The lattice's origin, internal frame: whole metres.
    pub lattice_origin: [f64; 3],
    /// The direction of the lattice's first axis in the internal frame's plan: cosine and sine.
    pub lattice_turn: [f64; 2],
    /// The box that the prisms fill, metres along the lattice's axes from its origin; both corners alike if there are none.
    pub zone: [[f64; 3]; 2],
    /// Edges of the cubes of the grid over the zone, metres.
    pub grid_step: [f64; 3],
    /// Cubes of that grid along x, y and z.
    pub grid_dims: [u32; 3],
    /// Zero.
    pub reserved: u32,
}

impl SceneRecord {
    /// The step of the lattice that cells are rounded to, metres.
    pub fn lattice_step(&self) -> f64 {
        (-f64::from(self.lattice_bits)).exp2()
    }
}

/// What a scene holds, so that what it lacks can be skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traits(pub u32);

impl Traits {
    /// Cells with sloped floors or ceilings.
    pub const SLOPED: u32 = 1;
    /// Detail triangles.
    pub const DETAIL: u32 = 2;
    /// Materials that mirror (metals with little roughness).
    pub const MIRRORS: u32 = 4;
    /// Materials that light goes through.
    pub const GLASS: u32 = 8;
    /// Light sources.
    pub const LIGHTS: u32 = 16;
    /// Textures.
    pub const TEXTURES: u32 = 32;
    /// At most one storey.
    pub const SINGLE_STOREY: u32 = 64;
    /// Every bit that this version knows.
    pub const ALL: u32 = 127;

    /// Whether the scene holds all of `bits`.
    pub const fn has(self, bits: u32) -> bool {
        self.0 & bits == bits
    }

    /// The words for the bits that are set.
    pub fn names(self) -> Vec<&'static str> {
        const NAMES: [(u32, &str); 7] = [
            (Traits::SLOPED, "sloped"),
            (Traits::DETAIL, "detail"),
            (Traits::MIRRORS, "mirrors"),
            (Traits::GLASS, "glass"),
            (Traits::LIGHTS, "lights"),
            (Traits::TEXTURES, "textures"),
            (Traits::SINGLE_STOREY, "single storey"),
        ];
        NAMES.iter().filter(|(bit, _)| self.has(*bit)).map(|(_, name)| *name).collect()
    }
}

/// Section `elements`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct ElementRecord {
    /// Identity.
    pub id: Text,
    /// Name.
    pub name: Text,
    /// Path in the source.
    pub path: Text,
    /// Class; empty if none.
    pub class: Text,
    /// Storey; empty if none.
    pub storey: Text,
    /// Number of its semantic.
    pub semantic: u32,
    /// Number of the role of its first component.
    pub role: u32,
    /// First of its triangles.
    pub first_triangle: u32,
    /// How many.
    pub triangle_count: u32,
    /// The element that it pierces or sits in, or none.
    pub host: u32,
    /// The element that fills it, or none.
    pub filling: u32,
    /// The opening that it fills, or none.
    pub opening: u32,
    /// [`ElementRecord::DERIVED`] or 0.
    pub flags: u32,
}

impl ElementRecord {
    /// It is not in the source: an opening or a room that was found in the building.
    pub const DERIVED: u32 = 1;
}

/// Section `rooms`: air labels of class ROOM, in the order of their elements.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RoomRecord {
    /// Lower and upper corner of its label's mesh, metres.
    pub bounds: [[f64; 3]; 2],
    /// Volume, m3, its triangles turned outward beforehand; 0 if its mesh is not closed.
    pub volume: f64,
    /// Area of its floor in the plan, m2; 0 if its mesh is not closed.
    pub floor_area: f64,
    /// The element that labels it.
    pub element: u32,
    /// 1 if its label's mesh is closed, so that points can be told to lie in it.
    pub closed: u32,
}

/// Section `cells`. The first is what lies around the prisms, each of the others a prism: the points over a convex
/// footprint, above one plane and below another.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellRecord {
    /// Lower and upper corner, metres along the lattice's axes from its origin; of the cell around the prisms the
    /// hull, in the internal frame.
    pub bounds: [[f64; 3]; 2],
    /// What it is: [`CellRecord::AROUND`], [`CellRecord::AIR`], [`CellRecord::SOLID`].
    pub kind: u32,
    /// Number of the semantic of what fills it.
    pub semantic: u16,
    /// [`CellRecord::FREE`] or 0.
    pub flags: u16,
    /// The element that fills or labels it, or none.
    pub element: u32,
    /// Its room, or none.
    pub room: u32,
    /// The root of its detail: a node of the section `nodes` or a [`Leaf`]; or none.
    pub root: u32,
    /// The plane of its floor, or none.
    pub floor: u32,
    /// The plane of its ceiling, or none.
    pub ceiling: u32,
    /// First of its sides, which go counter-clockwise around its footprint.
    pub first_side: u32,
    /// How many.
    pub sides: u32,
    /// First of its covers: those below its floor, then those above its ceiling.
    pub first_cover: u32,
    /// How many lie below.
    pub below: u32,
    /// How many lie above.
    pub above: u32,
}

impl CellRecord {
    /// All of the hull that is no prism: no convex cell, and the only one of its kind.
    pub const AROUND: u32 = 0;
    /// A prism of air.
    pub const AIR: u32 = 1;
    /// A prism of matter.
    pub const SOLID: u32 = 2;
    /// The flag of a prism of air into which the inside of no closed solid reaches, farther than cells differ from the model.
    pub const FREE: u16 = 1;
    /// The flag of a prism of matter that rays are not to meet: at run time only, in no file.
    pub(crate) const HIDDEN: u16 = 2;
}

/// Section `sides`: a vertical side of a prism, over the edge of its footprint from here to the next side's start.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SideRecord {
    /// Where it starts, metres from the lattice's origin: on the lattice, and exact.
    pub start: [f32; 2],
    /// First of its faces, from the floor up.
    pub first_face: u32,
    /// How many: at least one.
    pub faces: u32,
}

/// Section `faces`: a part of a side between two planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct FaceRecord {
    /// The plane at its upper edge; none for the last, which reaches up to the ceiling.
    pub top: u32,
    /// The cell beyond.
    pub cell: u32,
    /// Between air and matter: what rays meet there, or none.
    pub source: u32,
    /// Number of its kind, from 64 on.
    pub kind: u16,
    /// [`PLAIN`] or 0.
    pub flags: u16,
}

/// The bit of a face's or cover's flags that says: wherever a ray passes it, no nearer to its border than half a millimetre,
/// triangles of its source are there, all in one plane, that of its source's [`SourceRecord::plane`]; of one element and material.
pub const PLAIN: u16 = 1;

/// Section `covers`: a part of a floor or a ceiling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct CoverRecord {
    /// The cell beyond.
    pub cell: u32,
    /// Between air and matter: what rays meet there, or none.
    pub source: u32,
    /// Number of its kind, from 64 on.
    pub kind: u16,
    /// [`PLAIN`] or 0.
    pub flags: u16,
}

/// Section `planes`: z = slope . (x, y) + height, metres from the lattice's origin.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PlaneRecord {
    /// Along x and y.
    pub slope: [f64; 2],
    /// Over the lattice's origin, metres.
    pub height: f64,
}

/// Section `sources`: the source's own triangles behind faces of prisms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SourceRecord {
    /// First of its items in the section `surfaces`, which ascend.
    pub first: u32,
    /// How many: at least one.
    pub count: u32,
    /// The root of a hierarchy over them, as [`CellRecord::root`]; none if they are [`SourceRecord::FEW`] at most.
    pub root: u32,
    /// The triangle in whose plane all of them lie, to a micrometre; or none.
    pub plane: u32,
}

impl SourceRecord {
    /// Up to so many triangles are tested one by one.
    pub const FEW: u32 = 16;
}

/// Section `materials`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialRecord {
    /// Name.
    pub name: Text,
    /// Linear RGB.
    pub base_color: [f32; 3],
    /// Opacity.
    pub alpha: f32,
    /// Emitted radiance, linear RGB.
    pub emissive: [f32; 3],
    /// 0 to 1.
    pub metallic: f32,
    /// 0 to 1.
    pub roughness: f32,
    /// Index of refraction.
    pub ior: f32,
    /// 0 to 1.
    pub transmission: f32,
    /// Zero.
    pub reserved: u32,
}

/// Section `lights`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LightRecord {
    /// Metres.
    pub position: [f64; 3],
    /// Unit length.
    pub direction: [f64; 3],
    /// Metres; may be infinite.
    pub range: f64,
    /// Name.
    pub name: Text,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Candela or lux.
    pub intensity: f32,
    /// 0 point, 1 directional, 2 spot.
    pub kind: u32,
    /// Half angle of the full-intensity cone, radians.
    pub inner: f32,
    /// Half angle of the whole cone, radians.
    pub outer: f32,
    /// Zero.
    pub reserved: u32,
}

/// Section `cameras`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CameraRecord {
    /// Metres.
    pub eye: [f64; 3],
    /// Unit length.
    pub direction: [f64; 3],
    /// Unit length.
    pub up: [f64; 3],
    /// Vertical field of view, degrees.
    pub vfov: f64,
    /// Name.
    pub name: Text,
}

/// A triangle: its corners from the section `triangles`, all else from the section `runs`. In that order come first those that
/// rays can meet, then those of air labels; each group in the order of its elements, of an element its closed components first.
/// Triangles of closed components that disagree about the outside are turned outward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TriangleRecord {
    /// Indices into the section `vertices`.
    pub vertices: [u32; 3],
    /// Its element.
    pub element: u32,
    /// Its material.
    pub material: u32,
    /// The volume whose boundary it is, as index into the section `volumes`, or none.
    pub volume: u32,
    /// Number of its [`Facing`].
    pub facing: u32,
}

/// Which side of a triangle hides the other, seen from outside of the closed surface that it is part of: such a surface does not cross itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facing {
    /// That is not told.
    Any = 0,
    /// The front: seen from there its corners go around to the left.
    Outward = 1,
    /// The back.
    Inward = 2,
}

impl Facing {
    /// That with this number; none if there is none.
    pub fn of(number: u32) -> Option<Facing> {
        [Facing::Any, Facing::Outward, Facing::Inward].into_iter().find(|&facing| facing as u32 == number)
    }

    /// That of the same triangles turned over.
    pub fn turned(self) -> Facing {
        match self {
            Facing::Any => Facing::Any,
            Facing::Outward => Facing::Inward,
            Facing::Inward => Facing::Outward,
        }
    }
}

/// Section `runs`: triangles that follow each other, up to the next run's first, of one element, material, volume and facing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct RunRecord {
    /// Its first triangle; 0 in the first run.
    pub first: u32,
    /// As [`TriangleRecord::element`].
    pub element: u32,
    /// As [`TriangleRecord::material`].
    pub material: u32,
    /// As [`TriangleRecord::volume`].
    pub volume: u32,
    /// As [`TriangleRecord::facing`].
    pub facing: u32,
}

impl RunRecord {
    /// The run that begins with a triangle.
    pub(crate) fn from(first: u32, triangle: &TriangleRecord) -> RunRecord {
        let TriangleRecord { element, material, volume, facing, .. } = *triangle;
        RunRecord { first, element, material, volume, facing }
    }

    /// One of its triangles.
    #[inline(always)]
    pub(crate) fn of(self, vertices: [u32; 3]) -> TriangleRecord {
        let RunRecord { element, material, volume, facing, .. } = self;
        TriangleRecord { vertices, element, material, volume, facing }
    }
}

/// Section `volumes`: what closed shells of an element bound, that carves (solids) or labels air. All shells whose
/// triangles agree about the outside are one volume; each other shell is one by itself.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct VolumeRecord {
    /// Lower and upper corner, metres.
    pub bounds: [[f64; 3]; 2],
    /// Volume, m3.
    pub measure: f64,
    /// First of its triangles.
    pub first_triangle: u32,
    /// How many.
    pub triangle_count: u32,
    /// Its element.
    pub element: u32,
    /// Number of its role: solid or air.
    pub role: u32,
    /// 1 if a point's winding number decides (triangles look out of the matter), 0 if the parity of crossings does.
    pub by_winding: u32,
    /// Its room, or none.
    pub room: u32,
}

/// Lanes of a node, and the most triangles of a leaf.
pub const LANES: usize = 8;

/// Section `nodes`: an inner node of the hierarchy of boxes, eight children wide, coordinates relative to the
/// scene's center.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct NodeRecord {
    /// Lower bounds of the children: x, y, z.
    pub lo: [[f32; LANES]; 3],
    /// Upper bounds of the children: x, y, z.
    pub hi: [[f32; LANES]; 3],
    /// A node (after this one) or a [`Leaf`]; `u32::MAX` for no child, whose box is inside out.
    pub child: [u32; LANES],
}

impl NodeRecord {
    /// Without children.
    pub(crate) const EMPTY: NodeRecord = NodeRecord {
        lo: [[f32::INFINITY; LANES]; 3],
        hi: [[f32::NEG_INFINITY; LANES]; 3],
        child: [u32::MAX; LANES],
    };

    /// Makes `child` the child in `lane`; `bounds` are the box around its triangles, whose corners were rounded to f32.
    pub(crate) fn put(&mut self, lane: usize, child: u32, [lo, hi]: [[f32; 3]; 2], slack: f32) {
        self.child[lane] = child;
        for axis in 0..3 {
            self.lo[axis][lane] = (lo[axis] - slack).next_down();
            self.hi[axis][lane] = (hi[axis] + slack).next_up();
        }
    }
}

/// Some items of the section `leaves`, one to eight, all of them in one group of eight: what a [`NodeRecord::child`] or root with
/// [`Leaf::BIT`] stands for. The next three bits are how many, less one; the others the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf(u32);

impl Leaf {
    /// The bit of a link that marks a leaf.
    pub const BIT: u32 = 1 << 31;
    const COUNT: u32 = 28;
    /// No more items than this are in the section `leaves`: half of what links can count, the other half is for what is added at
    /// run time.
    pub(crate) const MOST: usize = 1 << 27;

    /// What `link` stands for, which has [`Leaf::BIT`].
    #[inline(always)]
    pub(crate) fn new(link: u32) -> Leaf {
        debug_assert!(link & Leaf::BIT != 0);
        Leaf(link)
    }

    /// The link of `count` items from `first` on.
    #[inline(always)]
    pub(crate) fn link(first: usize, count: usize) -> u32 {
        debug_assert!(count > 0 && first % LANES + count <= LANES && first >> Leaf::COUNT == 0);
        Leaf::BIT | (count as u32 - 1) << Leaf::COUNT | first as u32
    }

    /// Its first item.
    #[inline(always)]
    pub fn first(self) -> usize {
        (self.0 & ((1 << Leaf::COUNT) - 1)) as usize
    }

    /// How many items.
    #[inline(always)]
    pub fn count(self) -> usize {
        (self.0 >> Leaf::COUNT & 7) as usize + 1
    }

    /// Its group of eight.
    #[inline(always)]
    pub(crate) fn block(self) -> usize {
        self.first() / LANES
    }

    /// Its items' places in their group.
    #[inline(always)]
    pub(crate) fn lanes(self) -> std::ops::Range<usize> {
        let start = self.first() % LANES;
        start..start + self.count()
    }

    /// The same, place i as bit i.
    #[inline(always)]
    pub(crate) fn mask(self) -> u32 {
        ((2 << (self.0 >> Leaf::COUNT & 7)) - 1) << (self.0 & (LANES as u32 - 1))
    }
}

/// Eight items of the section `leaves`: triangles in f32, relative to the scene's center; lanes without one hold NaN. Made when a
/// scene is opened.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BlockRecord {
    /// First corners: x, y, z.
    pub corner: [[f32; LANES]; 3],
    /// Second corners less the first.
    pub edge1: [[f32; LANES]; 3],
    /// Third corners less the first.
    pub edge2: [[f32; LANES]; 3],
    /// Triangles, or none.
    pub triangle: [u32; LANES],
}

impl BlockRecord {
    /// Without triangles: every comparison with NaN is false.
    pub(crate) const EMPTY: BlockRecord = BlockRecord {
        corner: [[f32::NAN; LANES]; 3],
        edge1: [[f32::NAN; LANES]; 3],
        edge2: [[f32::NAN; LANES]; 3],
        triangle: [u32::MAX; LANES],
    };

    /// Puts a triangle with these corners into `lane`; `center` is the scene's.
    pub(crate) fn put(&mut self, lane: usize, triangle: u32, [a, b, c]: [DVec3; 3], center: DVec3) {
        let [corner, edge1, edge2] = [a - center, b - a, c - a].map(|v| v.as_vec3());
        for axis in 0..3 {
            self.corner[axis][lane] = corner[axis];
            self.edge1[axis][lane] = edge1[axis];
            self.edge2[axis][lane] = edge2[axis];
        }
        self.triangle[lane] = triangle;
    }

    /// Makes `lane` that of `other`.
    pub(crate) fn take(&mut self, lane: usize, other: &BlockRecord) {
        for axis in 0..3 {
            self.corner[axis][lane] = other.corner[axis][lane];
            self.edge1[axis][lane] = other.edge1[axis][lane];
            self.edge2[axis][lane] = other.edge2[axis][lane];
        }
        self.triangle[lane] = other.triangle[lane];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::size_of;

    #[test]
    fn sizes_are_those_of_the_format() {
        assert_eq!(size_of::<SceneRecord>(), 176 + 24 + 16 + 48 + 24 + 12 + 4);
        assert_eq!(size_of::<ElementRecord>(), 72);
        assert_eq!(size_of::<RoomRecord>(), 72);
        assert_eq!(size_of::<CellRecord>(), 96);
        assert_eq!(size_of::<SideRecord>(), 16);
        assert_eq!(size_of::<FaceRecord>(), 16);
        assert_eq!(size_of::<CoverRecord>(), 12);
        assert_eq!(size_of::<PlaneRecord>(), 24);
        assert_eq!(size_of::<SourceRecord>(), 16);
        assert_eq!(size_of::<MaterialRecord>(), 56);
        assert_eq!(size_of::<LightRecord>(), 96);
        assert_eq!(size_of::<CameraRecord>(), 88);
        assert_eq!(size_of::<RunRecord>(), 20);
        assert_eq!(size_of::<VolumeRecord>(), 80);
        assert_eq!(size_of::<NodeRecord>(), 224);
    }

    #[test]
    fn leaves_are_told_by_their_links() {
        for (first, count) in [(0, 1), (0, 8), (5, 3), (8, 8), (Leaf::MOST * 2 - 8, 8), (Leaf::MOST - 1, 1)] {
            let link = Leaf::link(first, count);
            assert!(link & Leaf::BIT != 0 && link != u32::MAX);
            let leaf = Leaf::new(link);
            assert_eq!((leaf.first(), leaf.count(), leaf.block()), (first, count, first / 8));
            assert_eq!(leaf.lanes(), first % 8..first % 8 + count);
            assert_eq!(leaf.mask(), leaf.lanes().map(|lane| 1 << lane).sum::<u32>());
        }
    }
}
