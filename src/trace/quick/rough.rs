//! What a ray meets where it comes to matter behind a face that is not plain: the source's own triangles, as the careful walk tests them.

use super::{Exit, Way};
use crate::format::Views;
use crate::trace::NONE;
use crate::trace::cost::Count;
use crate::trace::kernel::{Ask, Probe};
use crate::trace::lanes::Portable;
use crate::trace::meet::{Surfaces, runs_along};
use crate::trace::path::Prisms;
use crate::trace::ray::Ray;
use crate::trace::step::Step;
use crate::trace::walk::{Found, Query, Surface, Walk, walk};

/// Walks the hierarchies of large sources, on any machine, and counts.
struct Counted<'c, C>(&'c mut C);

impl<C: Count> Count for Counted<'_, C> {
    fn test(&mut self) {
        self.0.test();
    }
}

impl<C: Count> Probe for Counted<'_, C> {
    fn nearest(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        walk::<Portable>(Ask::First, tables, query, None, self.0)
    }
    fn first(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        self.nearest(tables, query)
    }
}

/// What the ray meets where it leaves a cell at `exit`, by a link that is [`Step::ROUGH`]; `None` in doubt, with any other link, and where the
/// plane that it leaves through is not known.
#[cold]
#[inline(never)]
pub(super) fn rough(
    tables: &Views,
    ray: &Ray,
    surface: Option<&Surface>,
    cell: u32,
    exit: &Exit,
    count: &mut impl Count,
) -> Option<Found> {
    let source = exit.link & !Step::ROUGH;
    if !(Step::ROUGH..Step::AROUND).contains(&exit.link) || source as usize >= tables.sources.len() {
        return None;
    }
    let (way, prisms) = (Way::new(tables, ray)?, Prisms::new(tables));
    let outward = prisms.turned_back(way.outward(exit, cell)?);
    if runs_along(&prisms, tables.scene[0].tolerance, outward, way.direction) {
        return None;
    }
    let walk = Walk::new(tables);
    let range = (-surface.map_or(0.0, Surface::behind), f64::INFINITY);
    let mut query = Query::new(way.origin, way.direction, range, 0.0, walk.scene, NONE, surface);
    let face = (way.exact(exit, cell), outward);
    Surfaces::new(tables).behind(source, face, &walk, &mut query, &mut Counted(count))
}
