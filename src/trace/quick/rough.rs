//! What a ray meets where it comes to matter behind a face that is not plain: the source's own triangles, as the careful walk tests them.

use glam::DVec3;

use super::{DOWN, Exit, UP, Way};
use crate::format::Views;
use crate::format::records::LANES;
use crate::trace::NONE;
use crate::trace::meet::{Surfaces, is_near};
use crate::trace::path::{Prisms, outward};
use crate::trace::ray::Ray;
use crate::trace::step::Step;
use crate::trace::walk::{Found, Query, Surface, Walk};

/// What the ray meets where it leaves a cell at `exit`, by a link that is [`Step::ROUGH`]; `None` in doubt, and with any other link.
#[cold]
#[inline(never)]
pub(super) fn rough(
    tables: &Views,
    ray: &Ray,
    surface: Option<&Surface>,
    cell: u32,
    exit: &Exit,
) -> Option<Found> {
    let source = exit.link & !Step::ROUGH;
    if exit.link < Step::ROUGH || source as usize >= tables.sources.len() {
        return None;
    }
    let (way, prisms) = (Way::new(tables, ray)?, Prisms::new(tables));
    let (by, step, record) = (exit.by()?, &tables.steps[cell as usize], &tables.cells[cell as usize]);
    let outward = match by {
        DOWN => -prisms.upward(record.floor),
        UP => prisms.upward(record.ceiling),
        corner => {
            let next = (corner + 1) % LANES;
            outward([step.x[corner], step.y[corner]], [step.x[next], step.y[next]])
        }
    };
    let outward: DVec3 = prisms.turned_back(outward);
    let (t, walk) = (way.exact(exit, cell), Walk::new(tables));
    let range = (-surface.map_or(0.0, Surface::behind), f64::INFINITY);
    let mut query = Query::new(way.origin, way.direction, range, 0.0, walk.scene, NONE, surface);
    let mut best = Found { t: f64::INFINITY, triangle: NONE };
    // From the other side comes only a ray that rounding has put into the matter.
    let takes = |found: &Found, query: &Query<'_>| {
        is_near(found, t, walk.scene.tolerance, &walk, query)
            && walk.enters(found.triangle, outward, query.direction)
    };
    Surfaces::new(tables).meet(source, &walk, &mut query, &mut best, &mut (), takes);
    (best.triangle != NONE).then_some(best)
}
