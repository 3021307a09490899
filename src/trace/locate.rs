//! Where a point lies: in which room, or inside which solid.
//!
//! A grid of cubes names, for each, the closed volumes whose inside may reach into it. A point is tested against those
//! only, by the crossings of a vertical line through it with the volume's triangles: the plan side of an edge is
//! computed from the edge alone, its lower corner first, so that the two triangles of an edge agree and no crossing
//! is counted twice or lost.

use enfilade_importers::{Role, Semantic};
use glam::DVec3;

use super::NONE;
#[cfg(feature = "render")]
use super::batch::Starts;
use super::begin::aside;
use super::free::local;
use super::path::{BLURRED, Prisms};
use super::walk::each;
use crate::format::records::{CellRecord, SceneRecord, VolumeRecord};
use crate::format::{Views, WHOLE_BIT};
use crate::scene::Scene;

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the air of a cell.
    Air {
        /// Index of the cell.
        cell: u32,
        /// What labels the air there: as the cell has it; around the prisms [`Semantic::Unknown`] where nothing does.
        label: Semantic,
        /// Index of the room, if the point lies in one: the cell's; around the prisms the smallest that holds it.
        room: Option<u32>,
    },
    /// Inside this solid element, the smallest one that holds the point.
    InSolid(u32),
    /// Outside the hull.
    Outside,
}

impl Scene {
    /// Where `point` (internal frame, metres) lies.
    pub fn locate(&self, point: [f64; 3]) -> Place {
        self.locate_near(point, NONE)
    }

    /// The same, quicker for a point in the air of cell `hint`: where a camera or a robot is that was in this cell a step ago. Any number
    /// is a hint.
    ///
    /// The paper casts a short ray along the movement (Maria, Horna and Aveneau 2014, section 4.1); to ask the cell, and the grid over all
    /// cells where the point left it, is as quick, and does not care what was between.
    pub fn locate_near(&self, point: [f64; 3], hint: u32) -> Place {
        if !self.is_in_hull(point) {
            return Place::Outside;
        }
        match self.kernel.free(&self.tables, point, hint) {
            Some((cell, true)) => self.place_in(cell),
            Some((cell, false)) => match self.solid_at(point) {
                Some(element) => Place::InSolid(element),
                None => self.place_in(cell),
            },
            None => self.place_in_doubt(point),
        }
    }

    /// Where a point lies that is in the air of `cell`, if that is one.
    #[inline]
    pub(super) fn place_of(&self, point: [f64; 3], cell: u32) -> Place {
        if !self.is_in_hull(point) {
            Place::Outside
        } else if cell == NONE {
            self.place_in_doubt(point)
        } else {
            self.place_in(cell)
        }
    }

    #[inline(always)]
    fn is_in_hull(&self, point: [f64; 3]) -> bool {
        let [lo, hi] = self.hull();
        (0..3).all(|axis| point[axis] >= lo[axis] && point[axis] <= hi[axis])
    }

    /// Where a point of the hull lies that is in the air of no prism for sure.
    #[inline(never)]
    fn place_in_doubt(&self, point: [f64; 3]) -> Place {
        if let Some(volume) = smallest(self, point, Role::Solid) {
            return Place::InSolid(volume.element);
        }
        let mut cell = 0;
        if self.tables.cells.len() > 1 {
            let prisms = Prisms::new(&self.tables);
            cell = prisms.place(prisms.local(DVec3::from(point)), self.tolerance()).unwrap_or(0);
            if prisms.cells[cell as usize].kind == CellRecord::AIR {
                return self.place_in(cell);
            }
            // Air between matter that cells take for a part of it.
            cell = 0;
        }
        let label = smallest(self, point, Role::Air);
        let semantic = label.map_or(Semantic::Unknown, |volume| {
            let element = &self.tables.elements[volume.element as usize];
            Semantic::from_number(element.semantic).unwrap_or_default()
        });
        Place::Air { cell, label: semantic, room: self.room_at(point) }
    }

    /// The air of a prism.
    pub(super) fn place_in(&self, cell: u32) -> Place {
        let CellRecord { semantic, room, .. } = self.tables.cells[cell as usize];
        let label = Semantic::from_number(semantic.into()).unwrap_or_default();
        Place::Air { cell, label, room: (room != NONE).then_some(room) }
    }

    /// The prism of air that holds a point, where that is in no doubt: a ray from there begins nowhere else.
    #[inline]
    pub(super) fn free_cell(&self, point: [f64; 3]) -> Option<u32> {
        self.free_cell_near(point, NONE)
    }

    /// Whether a point is in the box of the prisms.
    #[inline(always)]
    pub(super) fn is_in_zone(&self, point: [f64; 3]) -> bool {
        self.tables.airgrid[0].holds(local(&self.tables, point))
    }

    /// The cube of the grid over cells of air that holds a point, if it is in their zone.
    #[inline]
    pub(super) fn cube(&self, point: [f64; 3]) -> Option<usize> {
        self.tables.airgrid[0].cube(local(&self.tables, point))
    }

    /// The same as [`Scene::free_cell`]; the cell is perhaps `hint`.
    #[inline]
    pub(crate) fn free_cell_near(&self, point: [f64; 3], hint: u32) -> Option<u32> {
        match self.kernel.free(&self.tables, point, hint) {
            Some((cell, true)) => Some(cell),
            Some((cell, false)) => self.is_beside_solids(point.into()).then_some(cell),
            None => self.free_cell_at_border(point),
        }
    }

    /// How rays start at an eye, whose cell is perhaps `hint`: in a cell where that is in no doubt. On a surface or within a solid each must see for
    /// itself where it begins.
    #[cfg(feature = "render")]
    pub(crate) fn starts_at(&self, eye: [f64; 3], hint: u32) -> Starts<'static> {
        self.free_cell_near(eye, hint).map_or(Starts::Anywhere, Starts::Cell)
    }

    /// The same of a point that may be at the border of cells: the one in which a ray from there starts that knows of none.
    #[cold]
    #[inline(never)]
    fn free_cell_at_border(&self, point: [f64; 3]) -> Option<u32> {
        if self.is_one_cell() || !self.is_in_zone(point) {
            return None;
        }
        let (prisms, middle) = (Prisms::new(&self.tables), DVec3::from(point));
        let local = prisms.local(middle);
        let cell = prisms.place(local, prisms.rounding().min(self.tolerance()))?;
        let record = &prisms.cells[cell as usize];
        let is_free =
            || !self.may_be_in_solid(point, 2.0 * aside(middle)) || self.is_beside_solids(point.into());
        let is_air = record.kind == CellRecord::AIR;
        let is_clear = !prisms.is_beside_rough(record, local, BLURRED)
            && !prisms.is_beside_matter(record, local, prisms.rounding());
        (is_air && is_clear && is_free()).then_some(cell)
    }

    /// The smallest room that holds `point`.
    pub(crate) fn room_at(&self, point: [f64; 3]) -> Option<u32> {
        best(self, point, |volume| volume.room != NONE).map(|volume| volume.room)
    }

    /// The smallest solid that holds `point`.
    pub(crate) fn solid_at(&self, point: [f64; 3]) -> Option<u32> {
        smallest(self, point, Role::Solid).map(|volume| volume.element)
    }

    /// Whether any solid may hold `point`, or another within `margin` of it along each axis: quick, and never wrongly no.
    pub(crate) fn may_be_in_solid(&self, point: [f64; 3], margin: f64) -> bool {
        may_be_in_solid(&self.tables, point, margin)
    }
}

/// As [`Scene::may_be_in_solid`].
pub(super) fn may_be_in_solid(tables: &Views, point: [f64; 3], margin: f64) -> bool {
    let is_in = |item: &u32| {
        let volume = &tables.volumes[(item & !WHOLE_BIT) as usize];
        volume.role == Role::Solid as u32 && (item & WHOLE_BIT != 0 || in_box(volume, point, margin))
    };
    // All cubes that a point within the margin may lie in: at the border of the grid that may be none of the point's own.
    let Some([xs, ys, zs]) = cubes_near(&tables.scene[0], point, margin) else { return false };
    if [&xs, &ys, &zs].iter().any(|cubes| cubes.end() - cubes.start() > MOST_CUBES) {
        return true;
    }
    let [width, depth, _] = tables.scene[0].locator_dims.map(u64::from);
    zs.into_iter().any(|z| {
        let mut rows = ys.clone();
        rows.any(|y| {
            let mut cubes = xs.clone();
            cubes.any(|x| located_in(tables, (z * depth + y) * width + x).iter().any(is_in))
        })
    })
}

/// Beside the first along an axis no more cubes are looked at: a margin as wide comes with points far away only.
const MOST_CUBES: u64 = 4;

/// Along each axis the cubes of the grid no farther than `margin` from a point; `None` if there are none.
#[inline]
fn cubes_near(
    scene: &SceneRecord,
    point: [f64; 3],
    margin: f64,
) -> Option<[std::ops::RangeInclusive<u64>; 3]> {
    let mut near = [const { 0..=0 }; 3];
    for axis in 0..3 {
        let most = f64::from(scene.locator_dims[axis]);
        let cube = |at: f64| (at - scene.locator_origin[axis]) / scene.locator_step;
        let (first, last) = (cube(point[axis] - margin), cube(point[axis] + margin));
        // Written so that a NaN is in none; and a grid may have no cubes.
        if !(last >= 0.0 && first < most && most >= 1.0) {
            return None;
        }
        near[axis] = first.max(0.0) as u64..=last.min(most - 1.0).max(0.0) as u64;
    }
    Some(near)
}

fn smallest(scene: &Scene, point: [f64; 3], role: Role) -> Option<&VolumeRecord> {
    best(scene, point, |volume| volume.role == role as u32)
}

/// The smallest volume, among those that `wanted` takes, that holds `point`; the first of equals.
fn best(scene: &Scene, point: [f64; 3], wanted: impl Fn(&VolumeRecord) -> bool) -> Option<&VolumeRecord> {
    let tables = &scene.tables;
    let mut found: Option<&VolumeRecord> = None;
    for &item in located(tables, point) {
        let index = (item & !WHOLE_BIT) as usize;
        let volume = &tables.volumes[index];
        if !wanted(volume) || found.is_some_and(|f| f.measure <= volume.measure) {
            continue;
        }
        if item & WHOLE_BIT != 0 || encloses(scene, index, point) {
            found = Some(volume);
        }
    }
    found
}

/// The volumes that may hold `point`, by the grid.
fn located(tables: &Views, point: [f64; 3]) -> &[u32] {
    let scene = &tables.scene[0];
    let mut index = 0u64;
    for axis in (0..3).rev() {
        let cube = (point[axis] - scene.locator_origin[axis]) / scene.locator_step;
        if !(cube >= 0.0 && cube < f64::from(scene.locator_dims[axis])) {
            return &[];
        }
        index = index * u64::from(scene.locator_dims[axis]) + cube as u64;
    }
    located_in(tables, index)
}

/// The volumes that may hold a point of a cube of the grid.
#[inline]
fn located_in(tables: &Views, cube: u64) -> &[u32] {
    let (start, end) = (tables.locator[cube as usize], tables.locator[cube as usize + 1]);
    &tables.located[start as usize..end as usize]
}

/// Whether `point` is no farther than `margin` from the volume's box, along each axis.
#[inline]
fn in_box(volume: &VolumeRecord, point: [f64; 3], margin: f64) -> bool {
    let [lo, hi] = volume.bounds;
    (0..3).all(|axis| point[axis] >= lo[axis] - margin && point[axis] <= hi[axis] + margin)
}

/// Whether the closed volume of this index holds `point`.
fn encloses(scene: &Scene, index: usize, point: [f64; 3]) -> bool {
    let volume = &scene.tables.volumes[index];
    if !in_box(volume, point, 0.0) {
        return false;
    }
    let crossings = crossings(scene.columns.over(&scene.tables, index, point), point);
    if volume.by_winding == 1 { crossings.winding != 0 } else { crossings.count % 2 == 1 }
}

/// What the upward vertical line from a point meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Crossings {
    /// Triangles crossed.
    pub(crate) count: u32,
    /// Triangles crossed from below less those crossed from above, by their orientation.
    pub(crate) winding: i32,
}

/// The triangles that the upward vertical line from `point` crosses.
pub(crate) fn crossings(triangles: impl Iterator<Item = [[f64; 3]; 3]>, point: [f64; 3]) -> Crossings {
    let mut found = Crossings::default();
    for corners in triangles {
        let are_over = each(corners, |corner| corner[2] > point[2]);
        if are_over == [false; 3] {
            continue;
        }
        // Turns of the plan triangle around the point: its edges beyond the point, each half-open in y.
        let mut turns = 0i32;
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if (a[1] <= point[1]) != (b[1] <= point[1]) && crosses_right_of(a, b, point) {
                turns += if a[1] <= point[1] { 1 } else { -1 };
            }
        }
        if turns != 0 && (are_over == [true; 3] || height(corners, point) > point[2]) {
            found.count += 1;
            found.winding += turns;
        }
    }
    found
}

/// Whether, in the plan, the edge meets the line through the point along x at a greater x than the point. Computed from the
/// lower end of the edge, whichever way it is given.
fn crosses_right_of(a: [f64; 3], b: [f64; 3], point: [f64; 3]) -> bool {
    let (a, b) = if (a[1], a[0], a[2]) <= (b[1], b[0], b[2]) { (a, b) } else { (b, a) };
    (b[0] - a[0]) * (point[1] - a[1]) > (point[0] - a[0]) * (b[1] - a[1])
}

/// Height of the triangle's plane over the point, held between its lowest and highest corner.
pub(crate) fn height([a, b, c]: [[f64; 3]; 3], point: [f64; 3]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]);
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let (lowest, highest) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
    let z = a[2] - (normal[0] * (point[0] - a[0]) + normal[1] * (point[1] - a[1])) / normal[2];
    // Not `clamp`: a division by zero may have made it NaN.
    if z > highest {
        highest
    } else if z >= lowest {
        z
    } else {
        lowest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box whose top is cut by a diagonal, all triangles outward.
    fn unit_box() -> Vec<[[f64; 3]; 3]> {
        let p: Vec<[f64; 3]> =
            (0..8).map(|i| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)]).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        quads.iter().flat_map(|&[a, b, c, d]| [[p[a], p[b], p[c]], [p[a], p[c], p[d]]]).collect()
    }

    #[test]
    fn lines_through_edges_and_corners_cross_once() {
        let triangles = unit_box();
        let count = |point: [f64; 3]| crossings(triangles.iter().copied(), point);
        // On the diagonal of the top, in the middle, and near the sides.
        for (x, y) in [(0.5, 0.5), (0.25, 0.25), (0.7, 0.2), (0.1, 0.9)] {
            assert_eq!(count([x, y, 0.5]), Crossings { count: 1, winding: 1 }, "{x} {y}");
            assert_eq!(count([x, y, -0.5]), Crossings { count: 2, winding: 0 });
            assert_eq!(count([x, y, 1.5]).count, 0);
        }
        assert_eq!(count([1.5, 0.5, 0.5]).count, 0);
        // On the walls themselves a line is on one side or the other, but never half inside.
        for (x, y) in [(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let below = count([x, y, -1.0]);
            assert!(below.winding == 0 && below.count % 2 == 0, "{x} {y}");
        }
    }
}
