//! The planes behind faces.

use crate::format::Views;
use crate::format::records::LANES;
use crate::trace::NONE;
use crate::trace::lanes::Wide;
use crate::trace::quick::GRAZING;

/// a . b, rounded as `DVec3::dot`.
#[inline(always)]
pub(super) fn dot<W: Wide>(a: &[W; 3], b: &[W; 3]) -> W {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

/// The planes behind faces that end the ways of some rays.
pub(super) struct Plates {
    /// Of which.
    pub(super) lanes: u32,
    pub(super) normal: [[f64; LANES]; 3],
    pub(super) offset: [f64; LANES],
    pub(super) triangle: [u32; LANES],
    pub(super) source: [u32; LANES],
}

impl Plates {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Plates {
            lanes: 0,
            normal: [[0.0; LANES]; 3],
            offset: [0.0; LANES],
            triangle: [NONE; LANES],
            source: [NONE; LANES],
        }
    }

    /// That of a source; whether there is such a source.
    #[inline(always)]
    pub(super) fn add(&mut self, tables: &Views, lane: usize, source: u32) -> bool {
        let Some(plate) = tables.plates.get(source as usize) else { return false };
        for axis in 0..3 {
            self.normal[axis][lane] = plate.normal[axis];
        }
        self.offset[lane] = plate.offset;
        (self.triangle[lane], self.source[lane]) = (plate.triangle, source);
        self.lanes |= 1 << lane;
        true
    }

    /// Where the rays meet them, and where that is in no doubt: as `Way::plate` has it. Elsewhere NaN or infinite.
    #[inline(always)]
    pub(super) fn meet<W: Wide>(&self, origin: &[W; 3], direction: &[W; 3]) -> (u32, W) {
        let normal = [W::load(&self.normal[0]), W::load(&self.normal[1]), W::load(&self.normal[2])];
        let toward = dot(&normal, direction);
        let t = W::load(&self.offset).sub(dot(&normal, origin)).div(toward);
        (W::splat(GRAZING).le(toward.abs()) & W::splat(0.0).le(t), t)
    }
}
