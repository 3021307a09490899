//! When an answer is right.
//!
//! The *exact answer* to a ray is what [`Truth::answer`] says: `InSolid` if it starts (at its `tmin`) inside a carving
//! solid, else the nearest hit within `tmin..=tmax`, else `Escaped`.
//!
//! An answer to a ray is **right** if it is the exact answer to some parallel ray, the *witness*, that is at most the
//! tolerance away. In full, for a ray with origin `o`, unit direction `d` and its `tmin`, `tmax`: there is a shift
//! `w` across the ray and a shift `s` along it, such that for the ray from `o + w + s d` with the same direction,
//! `tmin` and `tmax`
//!
//! - the start is inside no carving solid (a start *on* the surface of a solid is not inside it, and the ray does not
//!   hit the surface through which it leaves the solid, or along which it runs),
//! - *for an answer `Hit` on element `e` at `t`*: the exact hit is at the point `o + w + (t + r) d`. Element `e` is
//!   the one that is hit there, or is hit at most the tolerance behind it (*flush* surfaces count as equal; `r` is
//!   then measured to the surface of `e`, and the nearest one must be within the tolerance of `t` too);
//! - *for an answer `Escaped`*: nothing is hit before the end, which is at `o + w + (tmax + r) d`, and not before the start;
//!
//! and the displacement `sqrt(|w|^2 + max(|s|, |r|)^2)` is at most the tolerance: both the start and the hit point, or the end,
//! move by no more than that. With `s = r` this is a witness whose `t` is the answer's. That the two may differ
//! serves rays that start within the tolerance of a surface: they count as on the air side that the direction enters, while
//! `t` goes on counting from the ray's own origin. So a segment that ends in the solid in which it starts, within the tolerance of the air, has
//! nothing in its way.
//!
//! A start within the tolerance of surfaces that enclose nothing counts as on the side of them that the direction leads to, so that the ray
//! need not meet them, however far off it comes through them: the displacement is then the start's distance from them.
//!
//! An answer `InSolid` is right if the start, or a point within the tolerance of it, is inside that solid.
//!
//! A right answer other than an exact one is only ever granted with a witness that was traced (or, where surfaces at the start are left
//! out, with the ray itself), so no wrong answer is
//! called right. The search finds a witness beside every edge, and around every corner and crossing of edges, as
//! seen along the ray: one for each set of parallel rays that meet the same surfaces in the same order, down to sets
//! narrower than some picometres. What of a triangle lies that near to a ray, which no ray of f64 can be aimed at, is met
//! by that ray too: be it the whole depth of a triangle that is seen from the side. Of hundreds of edges within the
//! tolerance of one ray it tries the nearest 64, and, if none of that will do, 192 places spread over all the tolerance.

use super::leave;
use super::soup::first_t;
use super::triangle::Corners;
use super::witness::{Search, Sought, inside_near};
use super::{TrueAnswer, Truth};
use crate::trace::{Answer, Hit, Ray};
use enfilade_importers::ElementId;

/// A `t` is exact if it is off by at most this times `1 + t`.
const EXACT: f64 = 1e-9;

/// What an answer is worth.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case", tag = "class")]
#[non_exhaustive]
pub enum Verdict {
    /// The exact answer: the same surface (or one at the same `t`) at the same `t`, to 1e-9 of `1 + t`; or both escape.
    Exact,
    /// The same surface on the ray itself, with a `t` that is off by more than that, but within the tolerance.
    Close {
        /// By how much `t` is off, metres.
        delta: f64,
    },
    /// Another element's surface on the ray itself, flush with the true one, with a `t` within the tolerance.
    Flush {
        /// How far behind the true surface it lies, metres along the ray.
        gap: f64,
    },
    /// The exact answer to a parallel ray beside this one, but not to this one.
    Edge {
        /// The smallest displacement that was found, metres.
        delta: f64,
    },
    /// Both say that the ray starts inside this solid.
    InSolidAgreed,
    /// They disagree about a solid whose surface is within the tolerance of the start.
    InSolidEdge {
        /// The smallest displacement that was found, metres.
        delta: f64,
    },
    /// Not right.
    Wrong {
        /// In which way.
        why: Why,
    },
}

/// What is wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Why {
    /// Escaped, but there is something to hit.
    Missed,
    /// A hit, but there is nothing to hit.
    Phantom,
    /// A hit behind the nearest surface.
    WentThrough,
    /// A hit before the nearest surface.
    TooEarly,
    /// The right distance, but another element.
    OtherElement,
    /// In a solid, but the ray does not start inside that solid.
    NotInSolid,
    /// A hit or an escape, but the ray starts inside a solid.
    StartsInSolid,
    /// A hit before `tmin`, after `tmax`, or of what is no ray.
    OutsideSegment,
    /// The record contradicts itself: no such element, a point that is not at `t`, a normal that is not of unit
    /// length or looks along the ray.
    BadRecord,
}

/// A verdict and what it was measured against.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The verdict.
    pub verdict: Verdict,
    /// The exact answer to the ray.
    pub truth: TrueAnswer,
    /// The forward error: by how much the answer's `t` differs from the exact one, metres; if both are hits.
    pub forward: Option<f64>,
}

impl Verdict {
    /// Whether the answer is right.
    pub fn is_right(&self) -> bool {
        !matches!(self, Verdict::Wrong { .. })
    }

    /// An upper bound of the backward error, metres: the displacement of the witness; infinite for a wrong answer.
    pub fn backward(&self) -> f64 {
        match *self {
            Verdict::Exact | Verdict::Flush { .. } | Verdict::InSolidAgreed => 0.0,
            Verdict::Close { delta } | Verdict::Edge { delta } | Verdict::InSolidEdge { delta } => delta,
            Verdict::Wrong { .. } => f64::INFINITY,
        }
    }
}

impl Truth {
    /// Judges an answer to `ray`.
    pub fn judge(&self, ray: &Ray, answer: &Answer) -> Judgement {
        self.judge_met(ray, answer, None)
    }

    /// The same of an answer that is known to be about a triangle with these corners: a witness through that is sought first, in exact arithmetic
    /// ([`Truth::witness_at`]), so that it is found where the triangle is too narrow for rays of f64. It need not be the nearest.
    pub fn judge_met(&self, ray: &Ray, answer: &Answer, met: Option<&Corners>) -> Judgement {
        let truth = self.answer(ray);
        let forward = match (answer, &truth) {
            (Answer::Hit(hit), TrueAnswer::Hit(nearest)) => Some((hit.t - nearest.t).abs()),
            _ => None,
        };
        Judgement { verdict: self.verdict(ray, answer, &truth, met), truth, forward }
    }

    fn verdict(&self, ray: &Ray, answer: &Answer, exact: &TrueAnswer, met: Option<&Corners>) -> Verdict {
        match *answer {
            Answer::InSolid(element) => self.verdict_in_solid(ray, ElementId(element), exact),
            Answer::Escaped => match exact {
                TrueAnswer::Escaped => Verdict::Exact,
                _ => self.by_witness(ray, Sought::Escaped, exact, Why::Missed),
            },
            Answer::Hit(hit) => self.verdict_hit(ray, &hit, exact, met),
        }
    }

    fn verdict_in_solid(&self, ray: &Ray, element: ElementId, exact: &TrueAnswer) -> Verdict {
        let agreed = matches!(exact, TrueAnswer::InSolid(solids) if solids.contains(&element));
        if agreed {
            return Verdict::InSolidAgreed;
        }
        match inside_near(self, ray, element) {
            Some(delta) => Verdict::InSolidEdge { delta },
            None => Verdict::Wrong { why: Why::NotInSolid },
        }
    }

    fn verdict_hit(&self, ray: &Ray, hit: &Hit, exact: &TrueAnswer, met: Option<&Corners>) -> Verdict {
        let (t, element) = (hit.t, ElementId(hit.element));
        let rounding = EXACT * (1.0 + t.abs());
        // Written so that a NaN is outside.
        let in_segment = t >= first_t(ray) - rounding && t <= ray.tmax + rounding && t.is_finite();
        if !ray.is_valid() || !in_segment {
            return Verdict::Wrong { why: Why::OutsideSegment };
        }
        let why = match exact {
            TrueAnswer::Hit(nearest) => {
                let off = (t - nearest.t).abs();
                if off <= self.tolerance.max(rounding) {
                    if element == nearest.element {
                        return if off <= rounding { Verdict::Exact } else { Verdict::Close { delta: off } };
                    }
                    if let Some(gap) = self.flush_gap(ray, nearest.t, element) {
                        let exact = off <= rounding && gap <= rounding;
                        return if exact { Verdict::Exact } else { Verdict::Flush { gap } };
                    }
                    Why::OtherElement
                } else if t > nearest.t {
                    Why::WentThrough
                } else {
                    Why::TooEarly
                }
            }
            _ => Why::Phantom,
        };
        if let Some(delta) = met.and_then(|corners| self.witness_at(ray, corners, element, t)) {
            let in_solid = matches!(exact, TrueAnswer::InSolid(_));
            return if in_solid { Verdict::InSolidEdge { delta } } else { Verdict::Edge { delta } };
        }
        self.by_witness(ray, Sought::Hit { t, element }, exact, why)
    }

    /// How far behind `t` the ray meets `element`, if that is within the tolerance.
    fn flush_gap(&self, ray: &Ray, t: f64, element: ElementId) -> Option<f64> {
        let behind = self.hits_between(ray, t, t + self.tolerance);
        behind.iter().find(|hit| hit.element == element).map(|hit| hit.t - t)
    }

    fn by_witness(&self, ray: &Ray, sought: Sought, exact: &TrueAnswer, why: Why) -> Verdict {
        let in_solid = matches!(exact, TrueAnswer::InSolid(_));
        match Search::new(self, ray, sought, exact).and_then(|search| search.smallest()) {
            Some(delta) if in_solid => Verdict::InSolidEdge { delta },
            Some(delta) => Verdict::Edge { delta },
            None if in_solid => Verdict::Wrong { why: Why::StartsInSolid },
            None => {
                let t = if let Sought::Hit { t, .. } = sought { t } else { 0.0 };
                let left = leave::from_surface(self, ray, sought, EXACT * (1.0 + t));
                left.map_or(Verdict::Wrong { why }, |delta| Verdict::Edge { delta })
            }
        }
    }
}
