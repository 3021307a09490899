//! The prism of air that holds a point, where that is in no doubt: of one, and of many points at once.
//!
//! Many take a few instructions each: they are turned to the lattice and led to their cubes in lanes, and what is read for one hangs on nothing that is
//! read for another, so that a processor waits for many at a time. The answers are the same.

use super::NONE;
use super::guess::Guess;
use super::lanes::{Lanes, Wide};
use super::locate::may_be_in_solid;
use super::path::{BLURRED, Prisms, to_lattice};
use super::step::Step;
use crate::format::Views;
use crate::format::records::{CellRecord, LANES};
use glam::DVec3;

/// So many points are led to their cubes before the first is looked at there.
const AHEAD: usize = 64;

/// A point of the internal frame along the lattice's axes from its origin.
#[inline(always)]
pub(super) fn local(tables: &Views, point: [f64; 3]) -> [f64; 3] {
    let scene = &tables.scene[0];
    to_lattice(point, scene.lattice_origin, scene.lattice_turn)
}

/// The prism of air that holds a point, farther from its border than cells differ from the model, and whether no closed solid may hold the
/// point, too. It is perhaps `hint`; any number is a hint.
#[inline(always)]
pub(super) fn free<L: Lanes>(tables: &Views, point: [f64; 3], hint: u32) -> Option<(u32, bool)> {
    let at = local(tables, point);
    let grid = &tables.airgrid[0];
    // What rounding may do is known in the zone.
    if !grid.holds(at) {
        return None;
    }
    let rounding = grid.rounding;
    let mut found = hint;
    if hint as usize >= tables.steps.len() || !holds::<L>(tables, hint, at, rounding) {
        let cube = grid.cube(at)?;
        // Also where that is certain: whether it is, nobody can foresee, and that costs as much as to look.
        found = tables.airguess.get(cube)?.of(at) & Guess::NUMBER;
        if found as usize >= tables.steps.len() || !holds::<L>(tables, found, at, rounding) {
            found = other::<L>(tables, cube, at, found)?;
        }
    }
    Some((found, is_free(tables, found, point)))
}

/// The prisms of air that hold points, of which the first three numbers count, as [`free`] tells them; [`NONE`] for none, and where a solid
/// may hold the point.
#[inline(always)]
pub(super) fn free_many<L: Lanes>(tables: &Views, points: &[[f64; 4]], cells: &mut [u32]) {
    let (scene, grid) = (&tables.scene[0], &tables.airgrid[0]);
    let ([cos, sin], [x0, y0, z0]) = (scene.lattice_turn, scene.lattice_origin);
    let (cos, sin) = (L::Wide::splat(cos), L::Wide::splat(sin));
    let (x0, y0, z0) = (L::Wide::splat(x0), L::Wide::splat(y0), L::Wide::splat(z0));
    let mut places = [[[0.0; LANES]; 3]; AHEAD / LANES];
    for (points, cells) in points.chunks(AHEAD).zip(cells.chunks_mut(AHEAD)) {
        // The numbers of those whose prisms have to be looked at.
        let (mut doubtful, mut doubts) = ([0u8; AHEAD], 0);
        let groups = points.chunks(LANES).zip(cells.chunks_mut(LANES)).zip(&mut places);
        for (group, ((points, cells), place)) in groups.enumerate() {
            let mut rows = [&points[0]; LANES];
            for (row, point) in rows.iter_mut().zip(points) {
                *row = point;
            }
            let [x, y, z, _] = L::Wide::columns(rows);
            let (mut x, mut y, z) = (x.sub(x0), y.sub(y0), z.sub(z0));
            if scene.lattice_turn[1] != 0.0 {
                (x, y) = (x.mul(cos).add(y.mul(sin)), y.mul(cos).sub(x.mul(sin)));
            }
            let (cubes, there) = grid.cubes::<L::Wide>([x, y, z]);
            *place = [x.store(), y.store(), z.store()];
            for (lane, (cell, cube)) in cells.iter_mut().zip(cubes).enumerate() {
                let at = [place[0][lane], place[1][lane], place[2][lane]];
                let guess = match tables.airguess.get(cube as usize) {
                    Some(guess) if there >> lane & 1 != 0 => guess.of(at),
                    _ => NONE,
                };
                // Of none it is set, too.
                let is_certain = guess & Guess::CERTAIN != 0;
                *cell = if guess == NONE { NONE } else { guess & Guess::NUMBER };
                doubtful[doubts % AHEAD] = (group * LANES + lane) as u8;
                doubts += usize::from(!is_certain);
            }
        }
        for &index in &doubtful[..doubts] {
            let index = usize::from(index) % AHEAD;
            let ([x, y, z], lane) = (&places[index / LANES], index % LANES);
            let (at, guess) = ([x[lane], y[lane], z[lane]], cells[index]);
            let mut found = guess;
            if guess as usize >= tables.steps.len() || !holds::<L>(tables, guess, at, grid.rounding) {
                let cube = grid.cube(at).unwrap_or(usize::MAX);
                found = other::<L>(tables, cube, at, guess).unwrap_or(NONE);
            }
            let [x, y, z, _] = points[index];
            cells[index] = if found != NONE && is_free(tables, found, [x, y, z]) { found } else { NONE };
        }
    }
}

/// The prism of air in a cube that holds a point and is not the one that was guessed.
#[inline(always)]
fn other<L: Lanes>(tables: &Views, cube: usize, at: [f64; 3], guess: u32) -> Option<u32> {
    let &[Guess { start, .. }, Guess { start: end, .. }] = tables.airguess.get(cube..)?.first_chunk()?;
    let mut found = None;
    // No closures: those are not compiled for the kernel's instructions.
    for &cell in &tables.aircells[start as usize..end as usize] {
        if cell != guess && holds::<L>(tables, cell, at, tables.airgrid[0].rounding) {
            found = Some(cell);
            break;
        }
    }
    found
}

/// Whether no closed solid may hold a point of a prism of air, or one near it.
#[inline(always)]
fn is_free(tables: &Views, cell: u32, point: [f64; 3]) -> bool {
    let step = &tables.steps[cell as usize];
    let flags = if step.is_some() { step.flags } else { tables.cells[cell as usize].flags };
    flags == CellRecord::FREE || !may_be_in_solid(tables, point, tables.scene[0].tolerance)
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
    // How far it is within in height, and in the plan, decided on at once: which of the two fails nobody can foresee. NaN is not above or below.
    let over = (z - floor).min(ceiling - z);
    let is_off = L::splat(f32::MIN_POSITIVE).le(L::splat((BLURRED - over) as f32));
    let (inward, size) = step.inward::<L>([x, y]);
    let rounding = f64::from(rounding);
    let surely = size.mul(L::splat((BLURRED + rounding) as f32)).le(inward);
    if L::bits(L::and_not(is_off, surely)) != 0xff {
        let perhaps = size.mul(L::splat((BLURRED - rounding) as f32)).le(inward);
        // Only where f32 cannot tell.
        if L::bits(L::and_not(is_off, perhaps)) != 0xff || !is_well_within(step, [x, y]) {
            return false;
        }
    }
    !step.is_sloped()
        || Prisms::new(tables).nearly_holds(&tables.cells[cell as usize], DVec3::new(x, y, z), -BLURRED)
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

#[cfg(all(test, feature = "compile"))]
mod scene_tests {
    use super::*;
    use crate::generate::{
        HouseOptions, OfficeOptions, RoundRoomOptions, Style, build2, house, random, round_room,
    };
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
            // Its walls are around rooms, and so are the boxes of those.
            (round_room(&RoundRoomOptions::default()), Style::damage(0.5, 1)),
        ];
        let mut at_borders = 0;
        for (building, style) in scenes {
            let model = building.export(&style).to_model().unwrap();
            let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
            let tables = &scene.tables;
            let prisms = Prisms::new(tables);
            let mut numbers = SplitMix64::new(4);
            let [lo, hi] = scene.hull();
            let (mut quick, mut in_solids) = (0, 0);
            let (mut points, mut cells) = (Vec::new(), Vec::new());
            for _ in 0..40_000 {
                let point = [0, 1, 2].map(|axis| numbers.between(lo[axis], hi[axis]));
                let found = scene.free_cell(point);
                let solid = scene.solid_at(point);
                points.push([point[0], point[1], point[2], numbers.unit()]);
                let quickly = Kernel::PORTABLE.free(tables, point, NONE);
                for kernel in Kernel::available() {
                    assert_eq!(kernel.free(tables, point, NONE), quickly, "{point:?}");
                    assert_eq!(kernel.free(tables, point, numbers.below(99) as u32), quickly, "{point:?}");
                }
                match quickly {
                    Some((cell, true)) => assert_eq!(found, Some(cell), "{point:?}"),
                    // It may be in a solid, and mostly is not.
                    Some((cell, false)) if found.is_some() => {
                        assert_eq!(found, Some(cell), "{point:?}");
                    }
                    Some((_, false)) => assert!(solid.is_some(), "{point:?}"),
                    None if found.is_some() => at_borders += 1,
                    None => {}
                }
                let clear = quickly.filter(|&(_, is_clear)| is_clear);
                cells.push(clear.map_or(NONE, |(cell, _)| cell));
                in_solids += u32::from(solid.is_some());
                let Some(cell) = found else { continue };
                assert!(solid.is_none(), "{point:?}");
                let record = &tables.cells[cell as usize];
                assert_eq!(record.kind, CellRecord::AIR);
                assert!(
                    prisms.nearly_holds(
                        record,
                        prisms.local(point.into()),
                        if quickly.is_some() { -BLURRED } else { prisms.rounding() }
                    ),
                    "{point:?}"
                );
                assert_eq!(scene.locate(point), scene.place_in(cell));
                assert_eq!(scene.locate(point), scene.place_of(point, NONE));
                quick += 1;
            }
            for kernel in Kernel::available() {
                for count in [0, 1, 7, 8, 9, AHEAD - 1, AHEAD, AHEAD + 1, points.len()] {
                    let mut many = vec![7; count];
                    kernel.free_many(tables, &points[..count], &mut many);
                    assert_eq!(many, cells[..count], "{}, {count} points", kernel.name());
                }
            }
            assert!(quick > 10_000 && in_solids > 100, "{quick} {in_solids}");
        }
        assert!(at_borders > 50, "{at_borders}");
    }
}
