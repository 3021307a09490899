//! Where a point lies: in which room, or inside which solid.
//!
//! A grid of cubes names, for each, the closed volumes whose inside may reach into it. A point is tested against those
//! only, by the crossings of a vertical line through it with the volume's triangles: the plan side of an edge is
//! computed from the edge alone, its lower corner first, so that the two triangles of an edge agree and no crossing
//! is counted twice or lost.

use enfilade_importers::{Role, Semantic};
use glam::DVec3;

use super::NONE;
use super::lanes::Lanes;
use super::path::{BLURRED, Prisms, to_lattice};
use super::step::Step;
use crate::format::records::{CellRecord, LANES, VolumeRecord};
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
        let [lo, hi] = self.hull();
        if !(0..3).all(|axis| point[axis] >= lo[axis] && point[axis] <= hi[axis]) {
            return Place::Outside;
        }
        if let Some(cell) = self.free_cell_near(point, hint) {
            return self.place_in(cell);
        }
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
    fn place_in(&self, cell: u32) -> Place {
        let CellRecord { semantic, room, .. } = self.tables.cells[cell as usize];
        let label = Semantic::from_number(semantic.into()).unwrap_or_default();
        Place::Air { cell, label, room: (room != NONE).then_some(room) }
    }

    /// The prism of air that holds a point, where that is in no doubt.
    #[inline]
    pub(super) fn free_cell(&self, point: [f64; 3]) -> Option<u32> {
        self.free_cell_near(point, NONE)
    }

    /// The cube of the grid over cells of air that holds a point, if it is in their zone.
    #[inline]
    pub(super) fn cube(&self, point: [f64; 3]) -> Option<usize> {
        self.tables.airgrid[0].cube(local(&self.tables, point))
    }

    /// The same as [`Scene::free_cell`]; the cell is perhaps `hint`.
    #[inline]
    pub(super) fn free_cell_near(&self, point: [f64; 3], hint: u32) -> Option<u32> {
        self.kernel.free(&self.tables, point, hint)
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
fn may_be_in_solid(tables: &Views, point: [f64; 3], margin: f64) -> bool {
    located(tables, point).iter().any(|item| {
        let volume = &tables.volumes[(item & !WHOLE_BIT) as usize];
        volume.role == Role::Solid as u32 && (item & WHOLE_BIT != 0 || in_box(volume, point, margin))
    })
}

/// A point of the internal frame along the lattice's axes from its origin.
#[inline(always)]
fn local(tables: &Views, point: [f64; 3]) -> [f64; 3] {
    let scene = &tables.scene[0];
    to_lattice(point, scene.lattice_origin, scene.lattice_turn)
}

/// The prism of air that holds a point, farther from its border than cells differ from the model, if no closed solid may hold the
/// point too. It is perhaps `hint`; any number is a hint.
#[inline(always)]
pub(super) fn free<L: Lanes>(tables: &Views, point: [f64; 3], hint: u32) -> Option<u32> {
    let at = local(tables, point);
    let grid = &tables.airgrid[0];
    // What rounding may do is known in the zone.
    if !grid.holds(at) {
        return None;
    }
    let rounding = grid.rounding;
    let mut found = hint;
    if hint as usize >= tables.steps.len() || !holds::<L>(tables, hint, at, rounding) {
        found = NONE;
        let cube = grid.cube(at)?;
        let (start, end) = (*tables.airstarts.get(cube)?, *tables.airstarts.get(cube + 1)?);
        for &cell in &tables.aircells[start as usize..end as usize] {
            if holds::<L>(tables, cell, at, rounding) {
                found = cell;
                break;
            }
        }
    }
    // None: no such cell.
    let step = tables.steps.get(found as usize)?;
    let flags = if step.is_some() { step.flags } else { tables.cells[found as usize].flags };
    let margin = tables.scene[0].tolerance;
    (flags == CellRecord::FREE || !may_be_in_solid(tables, point, margin)).then_some(found)
}

/// Whether a cell is a prism of air that holds a point (from the lattice's origin), farther from its border than cells differ from the
/// model.
#[inline(always)]
fn holds<L: Lanes>(tables: &Views, cell: u32, [x, y, z]: [f64; 3], rounding: f32) -> bool {
    let step = &tables.steps[cell as usize];
    let [floor, ceiling] = [f64::from(step.height[0]), f64::from(step.height[1])];
    if !step.is_some() {
        let record = &tables.cells[cell as usize];
        return record.kind == CellRecord::AIR
            && Prisms::new(tables).nearly_holds(record, DVec3::new(x, y, z), -BLURRED);
    }
    // Not `||`: this and what follows are decided on at once. NaN is not above or below.
    let is_off = (z < floor + BLURRED) | (z > ceiling - BLURRED);
    let is_sloped = floor.is_nan() || ceiling.is_nan();
    let (inward, size) = step.inward::<L>([x, y]);
    let rounding = f64::from(rounding);
    if is_off | (beyond(inward, size, BLURRED - rounding) != 0xff) {
        return false;
    }
    // Only where f32 cannot tell.
    let is_in_doubt = beyond(inward, size, BLURRED + rounding) != 0xff;
    if is_in_doubt && !is_well_within(step, [x, y]) {
        return false;
    }
    !is_sloped
        || Prisms::new(tables).nearly_holds(&tables.cells[cell as usize], DVec3::new(x, y, z), -BLURRED)
}

/// The edges (lane i is bit i) that a point is farther within than a margin: `inward` by each, times its `size`, from one end to the other
/// along each axis. No closure, which may not be compiled for the kernel's instructions.
#[inline(always)]
pub(super) fn beyond<L: Lanes>(inward: L, size: L, margin: f64) -> u32 {
    L::bits(size.mul(L::splat(margin as f32)).le(inward))
}

/// Whether a point is in the footprint of a step, farther from its border than cells differ from the model.
#[cold]
fn is_well_within(step: &Step, [x, y]: [f64; 2]) -> bool {
    let mut a = [f64::from(step.x[LANES - 1]), f64::from(step.y[LANES - 1])];
    for lane in 0..LANES {
        let b = [f64::from(step.x[lane]), f64::from(step.y[lane])];
        let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
        if ex * (y - a[1]) - ey * (x - a[0]) < BLURRED * (ex.abs() + ey.abs()) {
            return false;
        }
        a = b;
    }
    true
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
    let (start, end) = (tables.locator[index as usize], tables.locator[index as usize + 1]);
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
        // Turns of the plan triangle around the point: its edges beyond the point, each half-open in y.
        let mut turns = 0i32;
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            if (a[1] <= point[1]) != (b[1] <= point[1]) && crosses_right_of(a, b, point) {
                turns += if a[1] <= point[1] { 1 } else { -1 };
            }
        }
        if turns != 0 && height(corners, point) > point[2] {
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

#[cfg(all(test, feature = "compile"))]
mod scene_tests {
    use super::*;
    use crate::generate::{HouseOptions, OfficeOptions, Style, build2, house, random};
    use crate::splitmix::SplitMix64;
    use crate::{CompileOptions, Kernel, compile};

    /// Cells found quickly are those that hold the point, and no solid does; where solids lie in each other, too, and on all kernels.
    #[test]
    fn what_is_found_quickly_holds_the_point_and_no_solid_does() {
        let office = OfficeOptions::default();
        let scenes = [
            (house(&HouseOptions::default()), Style::exact()),
            (build2(&office), Style::exact()),
            (random(&office), Style::cad(3)),
        ];
        for (building, style) in scenes {
            let model = building.export(&style).to_model().unwrap();
            let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
            let tables = &scene.tables;
            let prisms = Prisms::new(tables);
            let mut numbers = SplitMix64::new(4);
            let [lo, hi] = scene.hull();
            let (mut quick, mut in_solids) = (0, 0);
            for _ in 0..40_000 {
                let point = [0, 1, 2].map(|axis| numbers.between(lo[axis], hi[axis]));
                let found = scene.free_cell(point);
                let solid = smallest(&scene, point, Role::Solid);
                for kernel in Kernel::available() {
                    assert_eq!(kernel.free(tables, point, NONE), found, "{point:?}");
                    assert_eq!(kernel.free(tables, point, numbers.below(99) as u32), found, "{point:?}");
                }
                in_solids += u32::from(solid.is_some());
                let Some(cell) = found else { continue };
                assert!(solid.is_none(), "{point:?}");
                let record = &tables.cells[cell as usize];
                assert_eq!(record.kind, CellRecord::AIR);
                assert!(prisms.nearly_holds(record, prisms.local(point.into()), -BLURRED), "{point:?}");
                assert_eq!(scene.locate(point), scene.place_in(cell));
                quick += 1;
            }
            assert!(quick > 10_000 && in_solids > 100, "{quick} {in_solids}");
        }
    }
}
