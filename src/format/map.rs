//! The optional sections that hold the map of the building, and their checks: every index is there, and alphas are
//! involutions, so that every walk through the map ends.

use bytemuck::{Pod, Zeroable};

use super::tables::{Views, ensure, within};
use super::{FaceKind, FormatError};
use crate::trace::NONE;

/// No lattice coordinate is larger: what f32 counts exactly.
const LARGEST: u32 = 1 << 24;

/// Parts of a lattice unit in which planes count: 2 to this power.
const FINE_BITS: u32 = 24;

/// No plane is steeper along either axis, or farther over the origin, in parts of a lattice unit.
const STEEPEST: u64 = 4096 << FINE_BITS;
const FARTHEST: u64 = 1 << 61;

/// Section `map`: one record about the whole.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MapRecord {
    /// Lower and upper corner of the box that the volumes fill, lattice units.
    pub hull: [[i32; 3]; 2],
    /// How many ranges of heights were made one.
    pub joined: u64,
    /// The longest of them, lattice units.
    pub longest: f64,
}

/// Section `darts`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct DartRecord {
    /// Alpha 0 to 3. Of a dart that was removed all are [`NONE`].
    pub alpha: [u32; 4],
    /// Its vertex, in `mapvertices`.
    pub vertex: u32,
    /// The volume that it was made for.
    pub volume: u32,
}

/// Section `mapvolumes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MapVolumeRecord {
    /// [`MapVolumeRecord::SOLID`], `AIR`, `EXTERIOR`, `VOID`.
    pub kind: u32,
    /// The element that labels it, or none.
    pub element: u32,
    /// Its planes, in `mapplanes`.
    pub floor: u32,
    /// As `floor`.
    pub ceiling: u32,
    /// Its footprint, in `mapcorners`.
    pub first_corner: u32,
    /// How many corners.
    pub corners: u32,
    /// One of its darts.
    pub dart: u32,
    /// Zero.
    pub reserved: u32,
}

impl MapVolumeRecord {
    /// Matter.
    pub const SOLID: u32 = 0;
    /// Air that an element labels.
    pub const AIR: u32 = 1;
    /// Unlabelled air that reaches the hull.
    pub const EXTERIOR: u32 = 2;
    /// Unlabelled air that does not.
    pub const VOID: u32 = 3;
}

/// Section `mapfaces`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MapFaceRecord {
    /// Square metres.
    pub area: f64,
    /// The volume on its first side.
    pub one: u32,
    /// The volume on its other side; [`NONE`] for the hull's outside.
    pub other: u32,
    /// A dart of it on its first side.
    pub dart: u32,
    /// [`MapFaceRecord::CEILING`], `FLOOR`, `UPRIGHT`.
    pub way: u32,
    /// The plane, in `mapplanes`, and zeros; of an upright face two points of the plan, lattice units.
    pub place: [i32; 4],
    /// The surface there as found from either side, in `mapsources`, or none.
    pub sources: [u32; 2],
    /// Number of its kind, from 64 on.
    pub kind: u32,
    /// The element whose surface it is, or none.
    pub element: u32,
    /// Its material, or none.
    pub material: u32,
    /// Zero.
    pub reserved: u32,
}

impl MapFaceRecord {
    /// The first volume's ceiling, the other's floor.
    pub const CEILING: u32 = 0;
    /// The first volume's floor, on the ground of the hull.
    pub const FLOOR: u32 = 1;
    /// Upright.
    pub const UPRIGHT: u32 = 2;
}

/// Section `mapsources`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct MapSourceRecord {
    /// First of its triangles in `maptriangles`.
    pub first: u32,
    /// How many.
    pub count: u32,
    /// Which of them has the plane of all, counted from `first`; or none.
    pub plane: u32,
}

/// A triangle of the source: the element, and its number in the element's mesh as it was read.
pub type MapTriangle = [u32; 2];

pub(super) fn check(v: &Views) -> Result<(), FormatError> {
    let Some(map) = &v.map else { return Ok(()) };
    let optional = |index: u32, count: usize| index == NONE || (index as usize) < count;
    ensure(map.map.len() == 1, "map", 0, || format!("{} records", map.map.len()))?;
    let [lo, hi] = map.map[0].hull;
    let fits = |c: i32| c.unsigned_abs() <= LARGEST;
    let is_box = (0..3).all(|axis| fits(lo[axis]) && fits(hi[axis]) && lo[axis] < hi[axis]);
    let is_number = map.map[0].longest >= 0.0 && map.map[0].longest.is_finite();
    ensure(is_box && is_number, "map", 0, || "its hull is no box".to_owned())?;

    let is_dart = |dart: u32| map.darts.get(dart as usize).is_some_and(|dart| dart.alpha != [NONE; 4]);
    for (i, dart) in map.darts.iter().enumerate() {
        let known =
            (dart.vertex as usize) < map.mapvertices.len() && (dart.volume as usize) < map.mapvolumes.len();
        ensure(known, "darts", i, || "its vertex or its volume is not there".to_owned())?;
        if dart.alpha == [NONE; 4] {
            continue;
        }
        for (k, &to) in dart.alpha.iter().enumerate() {
            let back = map.darts.get(to as usize).map(|dart| dart.alpha[k]);
            ensure(back == Some(i as u32), "darts", i, || format!("alpha {k} is no involution: T01"))?;
        }
    }
    if let Some(i) = map.mapvertices.iter().position(|p| !p.iter().all(|c| within(*c))) {
        ensure(false, "mapvertices", i, || "not finite".to_owned())?;
    }
    let planes = map.mapplanes.len();
    for (i, [p, q, r]) in map.mapplanes.iter().enumerate() {
        let ok = p.unsigned_abs() <= STEEPEST && q.unsigned_abs() <= STEEPEST && r.unsigned_abs() <= FARTHEST;
        ensure(ok, "mapplanes", i, || "too steep, or too far".to_owned())?;
    }
    if let Some(i) = map.mapcorners.iter().position(|p| !p.iter().all(|&c| fits(c))) {
        ensure(false, "mapcorners", i, || "beyond the lattice".to_owned())?;
    }
    let mut corners = 0u64;
    for (i, volume) in map.mapvolumes.iter().enumerate() {
        let labelled = matches!(volume.kind, MapVolumeRecord::SOLID | MapVolumeRecord::AIR);
        let of = (volume.element as usize) < v.elements.len();
        let ok = if labelled { of } else { volume.element == NONE && volume.kind <= MapVolumeRecord::VOID };
        ensure(ok, "mapvolumes", i, || "what fills it is not known".to_owned())?;
        let ok = (volume.floor as usize) < planes && (volume.ceiling as usize) < planes;
        ensure(ok && is_dart(volume.dart), "mapvolumes", i, || {
            "a plane or its dart is not there".to_owned()
        })?;
        let follows = u64::from(volume.first_corner) == corners;
        corners += u64::from(volume.corners);
        let ok = follows && corners <= map.mapcorners.len() as u64;
        ensure(ok, "mapvolumes", i, || "its corners do not follow those of the one before".to_owned())?;
    }
    for (i, face) in map.mapfaces.iter().enumerate() {
        let volumes = map.mapvolumes.len();
        let ok = (face.one as usize) < volumes && optional(face.other, volumes) && is_dart(face.dart);
        ensure(ok, "mapfaces", i, || "a volume or its dart is not there".to_owned())?;
        let ok = match face.way {
            MapFaceRecord::CEILING | MapFaceRecord::FLOOR => {
                usize::try_from(face.place[0]).is_ok_and(|plane| plane < planes) && face.place[1..] == [0; 3]
            }
            MapFaceRecord::UPRIGHT => face.place.iter().all(|&c| fits(c)),
            _ => false,
        };
        ensure(ok, "mapfaces", i, || "it does not lie as a face can".to_owned())?;
        let ok = face.sources.iter().all(|&source| optional(source, map.mapsources.len()))
            && FaceKind::from_number(face.kind).is_some()
            && optional(face.element, v.elements.len())
            && optional(face.material, v.materials.len())
            && face.area >= 0.0
            && face.area.is_finite();
        ensure(ok, "mapfaces", i, || format!("{face:?} refers to what is not there"))?;
    }
    ensure(corners == map.mapcorners.len() as u64, "mapcorners", 0, || "corners are left over".to_owned())?;
    let mut first = 0u64;
    for (i, source) in map.mapsources.iter().enumerate() {
        let follows = u64::from(source.first) == first;
        first += u64::from(source.count);
        let ok = follows
            && source.count > 0
            && first <= map.maptriangles.len() as u64
            && (source.plane == NONE || source.plane < source.count);
        ensure(ok, "mapsources", i, || "its triangles are not there".to_owned())?;
    }
    let all = first == map.maptriangles.len() as u64;
    ensure(all, "maptriangles", 0, || "triangles are left over".to_owned())?;
    for (section, triangles) in [("maptriangles", &map.maptriangles), ("mapdetail", &map.mapdetail)] {
        if let Some(i) = triangles.iter().position(|[element, _]| *element as usize >= v.elements.len()) {
            ensure(false, section, i, || "its element is not there".to_owned())?;
        }
    }
    Ok(())
}
