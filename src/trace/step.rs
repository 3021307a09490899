//! What makes a cell simple: its record of the section `steps`, read off the other sections.

use super::NONE;
use super::path::Prisms;
use crate::format::records::{CellRecord, LANES, PLAIN, StepRecord};

/// The step of a cell: that of the file and that which opening it expects.
pub(crate) fn step_of(prisms: &Prisms<'_>, cell: &CellRecord) -> StepRecord {
    let sides = prisms.sides_of(cell);
    let count = sides.len();
    if cell.kind != CellRecord::AIR || count < 3 || count > usize::from(u8::MAX) {
        return StepRecord::NONE;
    }
    let link = |cell: u32, source: u32, flags: u16| match prisms.cells.get(cell as usize) {
        Some(next)
            if next.kind == CellRecord::SOLID
                && flags == PLAIN
                && (source | StepRecord::PLATE) < StepRecord::AROUND =>
        {
            StepRecord::PLATE | source
        }
        Some(next) if source == NONE && next.kind == CellRecord::AIR && cell < StepRecord::PLATE => cell,
        Some(next) if source == NONE && next.kind == CellRecord::AROUND => StepRecord::AROUND,
        _ => StepRecord::OTHER,
    };
    let mut step = StepRecord { root: cell.root, flags: cell.flags.into(), ..StepRecord::NONE };
    let mut corners = 0;
    for (index, side) in sides.iter().enumerate() {
        let before = sides[(index + count - 1) % count].start.map(f64::from);
        let here = side.start.map(f64::from);
        let after = sides[(index + 1) % count].start.map(f64::from);
        // Exact: coordinates on the lattice have 25 bits.
        let turns =
            (here[0] - before[0]) * (after[1] - here[1]) != (here[1] - before[1]) * (after[0] - here[0]);
        if !turns {
            if corners == 0 {
                return StepRecord::NONE;
            }
            step.next[corners - 1] = StepRecord::PARTS;
            continue;
        }
        if corners == LANES {
            return StepRecord::NONE;
        }
        [step.x[corners], step.y[corners]] = side.start;
        step.side[corners] = index as u8;
        step.next[corners] = match prisms.faces_of(side) {
            [only] => link(only.cell, only.source, only.flags),
            _ => StepRecord::PARTS,
        };
        corners += 1;
    }
    for lane in corners..LANES {
        (step.x[lane], step.y[lane], step.side[lane]) = (step.x[0], step.y[0], count as u8);
    }
    let (below, above) = prisms.covers_of(cell);
    for (end, plane, covers) in [(0, cell.floor, below), (1, cell.ceiling, above)] {
        step.vertical[end] = match covers {
            [only] => link(only.cell, only.source, only.flags),
            _ => StepRecord::PARTS,
        };
        // On the lattice where it is level: exact in f32.
        step.height[end] = match prisms.level(plane) {
            Some(height) if f64::from(height as f32) == height => height as f32,
            _ => f32::NAN,
        };
    }
    step
}
