//! A straight line through the prisms of a scene: which it crosses, from where to where.

use glam::DVec3;

use crate::trace::Prisms;

/// What a line crosses of one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// From where to where, along the line.
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) cell: u32,
}

/// Shorter stretches are what rounding makes of a corner, metres.
const LEAST: f64 = 1e-4;

/// The cells between `start` (internal frame) and the point `length` farther along `direction` (of unit length), in turn.
pub(super) fn crossed(prisms: &Prisms<'_>, start: DVec3, direction: DVec3, length: f64) -> Vec<Stretch> {
    let (origin, along) = (prisms.local(start), prisms.turned(direction));
    let mut cells = prisms.listed_along(origin, origin + along * length);
    cells.sort_unstable();
    cells.dedup();
    let stretch = |cell: u32| {
        let [from, to] = prisms.span(&prisms.cells[cell as usize], origin, along)?;
        let (from, to) = (from.max(0.0), to.min(length));
        (to - from > LEAST).then_some(Stretch { from, to, cell })
    };
    let mut crossed: Vec<Stretch> = cells.into_iter().filter_map(stretch).collect();
    crossed.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.cell.cmp(&b.cell)));
    crossed
}
