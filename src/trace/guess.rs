//! In which prism a point of a cube of the grid is, mostly: without a look at the prisms, and often for certain.
//!
//! Walls stand across cubes: of most that more than one prism reaches into a plane parts the two that have the most of it. Where a cube's part on
//! one side of the plane is within one prism, a point there needs no test.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};

use super::finder::{AirGrid, MARGIN};
use super::path::BLURRED;
use super::step::Step;
use crate::format::records::CellRecord;

/// Which prism holds the points of a cube, mostly: one those below a plane, another those above.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Guess {
    /// Where the one ends and where the other starts along the plane's axis, from the lattice's origin, metres.
    ends: [f32; 2],
    /// The prism below, in [`Guess::NUMBER`], whether that is certain, and above those bits the axis.
    below: u32,
    /// The prism above, and whether that is certain.
    above: u32,
    /// The first of the prisms that reach into the cube; the next cube's follow.
    pub(super) start: u32,
}

impl Guess {
    /// The bits of a guess that are the number of a cell; perhaps there is none of it.
    pub(super) const NUMBER: u32 = Guess::CERTAIN - 1;
    /// The bit of a guess that needs no look at the prism: it holds the point, and no solid may hold it, too.
    pub(super) const CERTAIN: u32 = 1 << 29;
    const AXIS: u32 = 30;
    /// No prism.
    pub(super) const NOWHERE: Guess =
        Guess { ends: [f32::INFINITY; 2], below: Guess::NUMBER, above: Guess::NUMBER, start: 0 };

    /// The same of a cube whose prisms are listed from there on.
    pub(super) fn with_start(self, start: u32) -> Guess {
        Guess { start, ..self }
    }

    /// The prism that holds a point of the cube, if any does, and whether that is certain.
    #[inline(always)]
    pub(super) fn of(&self, at: [f64; 3]) -> u32 {
        // Of three, and no fourth.
        let at = at[(self.below >> Guess::AXIS) as usize % 3];
        // On which side nobody can foresee: chosen without a branch.
        let (is_below, is_above) = (at <= f64::from(self.ends[0]), at >= f64::from(self.ends[1]));
        let guess = std::hint::select_unpredictable(is_above, self.above, self.below);
        let known = Guess::NUMBER | (u32::from(is_below | is_above) * Guess::CERTAIN);
        guess & known
    }
}

/// So many prisms of a cube are thought of, those that have the most of it, and planes of so many of them are tried.
const PRISMS: usize = 4;
const TRIED: usize = 2;

/// So far within a prism, metres, a box is certain to be in it: twice as far as is asked for.
const WITHIN: f64 = 2.0 * BLURRED;

/// Of a cube of which a prism has this share no plane is looked for.
const ALL: f64 = 0.999;

/// A box: its least corner, and its greatest.
type Box3 = [[f64; 3]; 2];

/// The guess for a cube, into which these prisms reach: the plane among those of their boxes' sides that leaves the fewest points
/// to others than the prism that has the most on their side.
pub(super) fn guess(
    grid: &AirGrid,
    cube: usize,
    found: &[u32],
    cells: &[CellRecord],
    steps: &[Step],
) -> Guess {
    let found = &found[..found.len().min(PRISMS)];
    let Some(&first) = found.first().filter(|_| cells.len() < Guess::NUMBER as usize) else {
        return Guess::NOWHERE;
    };
    let cube = grid.bounds(cube);
    // Their boxes in the cube.
    let boxes: ArrayVec<Box3, PRISMS> = found
        .iter()
        .map(|&cell| {
            let [lo, hi] = cells[cell as usize].bounds;
            [[0, 1, 2].map(|i| lo[i].max(cube[0][i])), [0, 1, 2].map(|i| hi[i].min(cube[1][i]))]
        })
        .collect();
    // Which has the most between two places along an axis, and how much.
    let most = |axis: usize, from: f64, to: f64| {
        let share = |[lo, hi]: &Box3| {
            let along = |i: usize| if i == axis { hi[i].min(to) - lo[i].max(from) } else { hi[i] - lo[i] };
            (0..3).map(|i| along(i).max(0.0)).product::<f64>()
        };
        let shares = boxes.iter().map(share).enumerate();
        // The first of equals.
        shares.fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best })
    };
    let mut best = (most(0, cube[0][0], cube[1][0]).1, [first; 2], 0, cube[1][0]);
    let whole: f64 = (0..3).map(|i| cube[1][i] - cube[0][i]).product();
    if found.len() > 1 && best.0 < ALL * whole {
        for axis in 0..3 {
            for at in boxes.iter().take(TRIED).flat_map(|ends| [ends[0][axis], ends[1][axis]]) {
                if at > cube[0][axis] && at < cube[1][axis] {
                    let (below, above) = (most(axis, cube[0][axis], at), most(axis, at, cube[1][axis]));
                    if below.1 + above.1 > best.0 {
                        best = (below.1 + above.1, [found[below.0], found[above.0]], axis, at);
                    }
                }
            }
        }
    }
    let (_, [below, above], axis, at) = best;
    let mut guess =
        Guess { ends: [at as f32; 2], below: below | (axis as u32) << Guess::AXIS, above, start: 0 };
    // As far as either is certain; a little less, for what f32 makes of it.
    let end = at.min(cells[below as usize].bounds[1][axis] - 1.5 * WITHIN);
    let mut part = cube;
    part[1][axis] = end + 0.25 * WITHIN;
    if is_within(grid, &part, &steps[below as usize]) {
        (guess.ends[0], guess.below) = (end as f32, guess.below | Guess::CERTAIN);
    }
    let start = at.max(cells[above as usize].bounds[0][axis] + 1.5 * WITHIN);
    let mut part = cube;
    part[0][axis] = start - 0.25 * WITHIN;
    if is_within(grid, &part, &steps[above as usize]) {
        (guess.ends[1], guess.above) = (start as f32, guess.above | Guess::CERTAIN);
    }
    guess
}

/// Whether all points of a box that lies in a cube of the grid are in a prism of air for sure, in which no solid stands.
fn is_within(grid: &AirGrid, [lo, hi]: &Box3, step: &Step) -> bool {
    // Sixteen roundings.
    if !step.is_some() || step.flags != CellRecord::FREE || f64::from(grid.rounding) > 4.0 * WITHIN {
        return false;
    }
    let [floor, ceiling] = step.height.map(f64::from);
    let margin = |axis: usize| WITHIN + MARGIN / grid.per[axis];
    // False of NaN.
    let is_between = lo[2] - margin(2) >= floor && hi[2] + margin(2) <= ceiling;
    let corners = usize::from(step.corners);
    let [x, y] = [0, 1].map(|axis| [lo[axis] - margin(axis), hi[axis] + margin(axis)]);
    is_between
        && hi[0] >= lo[0]
        && hi[1] >= lo[1]
        && (0..corners).all(|corner| {
            let next = (corner + 1) % corners;
            let [ax, ay] = [f64::from(step.x[corner]), f64::from(step.y[corner])];
            let (ex, ey) = (f64::from(step.x[next]) - ax, f64::from(step.y[next]) - ay);
            // By the corner that is the least within.
            let (px, py) = (if ey > 0.0 { x[1] } else { x[0] }, if ex > 0.0 { y[0] } else { y[1] });
            ex * (py - ay) - ey * (px - ax) >= 0.0
        })
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::super::Finder;
    use super::*;
    use crate::generate::{OfficeOptions, Style, build2, random};
    use crate::splitmix::SplitMix64;
    use crate::{CompileOptions, compile};

    /// Points all over cubes, and beside the planes of their guesses.
    #[test]
    fn what_is_certain_is_so_and_most_guesses_are_right() {
        let office = OfficeOptions { seed: 5, ..OfficeOptions::default() };
        for (building, style) in [(build2(&office), Style::exact()), (random(&office), Style::cad(4))] {
            let model = building.export(&style).to_model().unwrap();
            let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
            let tables = &scene.tables;
            let finder = Finder::new(&tables.scene[0], &tables.cells, &tables.steps);
            let prisms = super::super::Prisms::new(tables);
            let mut random = SplitMix64::new(9);
            let (mut found, mut certain, mut right) = (0u32, 0u32, 0u32);
            for _ in 0..60_000 {
                let cube = random.below(finder.guesses.len() as u64 - 1) as usize;
                let (guess, [lo, hi]) = (finder.guesses[cube], finder.grid.bounds(cube));
                let mut at = [0, 1, 2].map(|axis| random.between(lo[axis], hi[axis]));
                let axis = (guess.below >> Guess::AXIS) as usize;
                if random.below(2) == 0 && guess.ends[0].is_finite() {
                    let end = f64::from(guess.ends[random.below(2) as usize]);
                    at[axis] = (end + random.between(-2e-3, 2e-3)).clamp(lo[axis], hi[axis]);
                }
                let told = guess.of(at);
                let holds = |cell: u32| {
                    let record = &tables.cells[cell as usize];
                    record.kind == CellRecord::AIR && prisms.nearly_holds(record, at.into(), -BLURRED)
                };
                let number = told & Guess::NUMBER;
                if told & Guess::CERTAIN != 0 {
                    assert!(holds(number), "{at:?} in {number}");
                    assert_eq!(tables.cells[number as usize].flags, CellRecord::FREE);
                    certain += 1;
                }
                if (0..tables.cells.len() as u32).any(holds) {
                    found += 1;
                    right += u32::from((number as usize) < tables.cells.len() && holds(number));
                }
            }
            assert!(found > 20_000 && certain * 4 > found, "{certain} of {found} certain");
            assert!(right * 10 > found * 8, "{right} of {found}");
        }
    }
}
