//! What an answer is worth: first by what costs little, then by the whole search for a ray beside.
//!
//! Of rays that start on surfaces, end there, or run along them, hundreds of triangles come within the tolerance, and the search of
//! [`crate::oracle::right`] looks at them all. Most such answers are right by less: exactly, or for one choice among what lies within [`ROUNDING`] of
//! where the ray starts and ends.

use super::report::Counts;
use crate::oracle::{Judgement, TrueAnswer, Truth, Verdict};
use crate::scene::Scene;
use crate::trace::{Answer, Hit, Ray};

/// How far, metres for each metre and one, places along a ray are one place by rounding.
const ROUNDING: f64 = 1e-9;

/// What an answer is worth.
#[derive(Debug)]
pub(super) enum Worth {
    /// Exactly what the ray meets.
    Exact,
    /// That, by exact arithmetic, though not by the truth in f64.
    ExactOnly,
    /// One of several exact answers, or the exact one to a ray that rounding hardly tells from it.
    Tie,
    /// The same surface, off by less than the tolerance.
    Close,
    /// A surface flush with what it meets.
    Flush,
    /// The exact answer to a ray beside.
    Beside,
    /// In a solid, as it should say.
    InSolid,
    /// Wrong, and how.
    Wrong(Judgement),
}

/// What judges.
pub(super) struct Judge<'a> {
    pub(super) scene: &'a Scene,
    pub(super) truth: &'a Truth,
}

impl Judge<'_> {
    /// What `answer` to `ray` is worth.
    pub(super) fn worth(&self, ray: &Ray, answer: &Answer) -> Worth {
        let exact = self.truth.answer(ray);
        if let Answer::Hit(Hit { t, .. }) = answer
            && !(*t >= ray.tmin.max(0.0) - rounding(*t) && *t <= ray.tmax + rounding(*t))
        {
            // Outside of the ray, or no number.
            return Worth::Wrong(self.truth.judge(ray, answer));
        }
        let is_same = match (answer, &exact) {
            (Answer::Hit(hit), TrueAnswer::Hit(nearest)) if hit.element == nearest.element.0 => {
                let off = (hit.t - nearest.t).abs();
                if off > rounding(nearest.t) && off <= self.truth.tolerance() {
                    return Worth::Close;
                }
                off <= rounding(nearest.t)
            }
            (Answer::Escaped, TrueAnswer::Escaped) => true,
            (Answer::InSolid(element), TrueAnswer::InSolid(solids)) => {
                if solids.iter().any(|solid| solid.0 == *element) {
                    return Worth::InSolid;
                }
                false
            }
            _ => false,
        };
        if is_same {
            return Worth::Exact;
        }
        if let (TrueAnswer::InSolid(_), Answer::Hit(_) | Answer::Escaped) = (&exact, answer) {
            // On its surface, and out of it at once: on a surface either may be said.
            let least = ray.tmin.max(0.0);
            let later = Ray { tmin: least + rounding(least), ..*ray };
            if !matches!(self.truth.answer(&later), TrueAnswer::InSolid(_))
                && !matches!(self.worth(&later, answer), Worth::Wrong(_))
            {
                return Worth::Tie;
            }
        }
        if let Some(worth) = self.is_exact_beside(ray, answer) {
            return worth;
        }
        if let (Answer::Hit(hit), Some(first), false) =
            (answer, self.truth.first(ray), matches!(exact, TrueAnswer::InSolid(_)))
            && hit.t.is_finite()
            && first.met.iter().any(|(met, _)| met.element.0 == hit.element)
            && first.off(hit.t).abs() <= rounding(first.t)
        {
            return if first.is_tie() { Worth::Tie } else { Worth::ExactOnly };
        }
        if self.is_limit(ray, answer, |_| true, &[*ray]) {
            return Worth::Tie;
        }
        let met = match answer {
            Answer::Hit(hit) if hit.triangle < self.scene.detail_triangle_count() => {
                Some(self.scene.triangle(hit.triangle))
            }
            _ => None,
        };
        let judgement = self.truth.judge_met(ray, answer, met.as_ref());
        let is_tie = || self.truth.first(ray).is_some_and(|first| first.is_tie());
        match judgement.verdict {
            Verdict::Exact => Worth::Exact,
            Verdict::Close { .. } => Worth::Close,
            Verdict::Flush { .. } => Worth::Flush,
            Verdict::InSolidAgreed => Worth::InSolid,
            Verdict::Edge { .. } | Verdict::InSolidEdge { .. } if is_tie() => Worth::Tie,
            Verdict::Edge { .. } | Verdict::InSolidEdge { .. } => Worth::Beside,
            Verdict::Wrong { .. } => Worth::Wrong(judgement),
        }
    }

    /// What an answer is worth that is the exact one to one of some rays beside: by a billionth of the tolerance it is as good as a tie, by a
    /// millionth it is beside.
    fn is_exact_beside(&self, ray: &Ray, answer: &Answer) -> Option<Worth> {
        /// If so many do not say it, it is less likely that the next one does than that it hangs on where the ray starts and ends.
        const FEW: usize = 4;
        let tolerance = self.truth.tolerance();
        let fine = 8.0 * f64::EPSILON * ray.origin.iter().fold(0.0f64, |most, c| most.max(c.abs()));
        let is_answer = |truth: &TrueAnswer| match (answer, truth) {
            (Answer::Hit(hit), TrueAnswer::Hit(nearest)) => {
                hit.element == nearest.element.0 && (hit.t - nearest.t).abs() <= tolerance
            }
            (Answer::Escaped, TrueAnswer::Escaped) => true,
            (Answer::InSolid(element), TrueAnswer::InSolid(solids)) => {
                solids.iter().any(|solid| solid.0 == *element)
            }
            _ => false,
        };
        // To a cube's corners, its edges and the middles of its sides.
        let ways = |axes: usize| {
            let all = (0..27).map(|way| [way % 3, way / 3 % 3, way / 9].map(|step| f64::from(step - 1)));
            all.filter(move |way| way.iter().filter(|step| **step != 0.0).count() == axes)
        };
        let beside = |far: f64| {
            ways(3).chain(ways(2)).chain(ways(1)).map(move |way| {
                let origin = [0, 1, 2].map(|i| ray.origin[i] + far * way[i]);
                Ray { origin, ..*ray }
            })
        };
        let (near, far) = (fine.max(1e-9 * tolerance), fine.max(1e-6 * tolerance));
        let mut truths = Vec::with_capacity(26);
        for beside in beside(near) {
            if truths.len() == FEW
                && self.is_limit(ray, answer, |between| self.truth.nearest(between).is_none(), &[*ray])
            {
                return Some(Worth::Tie);
            }
            let truth = self.truth.answer(&beside);
            if is_answer(&truth) {
                return Some(Worth::Tie);
            }
            truths.push(truth);
        }
        // Along an edge it touches one corner after the other: on the way it may be on one side of them, and on the other where it ends.
        if let Answer::Hit(Hit { t, element, .. }) = answer {
            let is_free = |truth: &TrueAnswer| match truth {
                TrueAnswer::Hit(nearest) => nearest.t >= t - rounding(*t),
                TrueAnswer::Escaped => true,
                TrueAnswer::InSolid(_) => false,
            };
            let from = (t - rounding(*t)).max(ray.tmin.max(0.0));
            let is_met = |ray: &Ray| self.truth.meets(ray, *element, from, t + rounding(*t));
            if truths.iter().any(is_free) && beside(near).any(|ray| is_met(&ray)) {
                return Some(Worth::Tie);
            }
        }
        if beside(far).any(|ray| is_answer(&self.truth.answer(&ray))) {
            return Some(Worth::Beside);
        }
        // From a surface on, those beside may begin in what it leaves.
        let all: Vec<Ray> = beside(far).collect();
        self.is_limit(ray, answer, |_| true, &all).then_some(Worth::Beside)
    }

    /// Whether an answer is exact but for what is met within rounding of where the ray starts and ends: what it says is there, and nothing
    /// between; and the way there is air. `may_be_free` tells soon which rays meet something. That it is there one of the rays `beside` may tell.
    fn is_limit(
        &self,
        ray: &Ray,
        answer: &Answer,
        may_be_free: impl Fn(&Ray) -> bool,
        beside: &[Ray],
    ) -> bool {
        let (least, most) = (ray.tmin.max(0.0), ray.tmax);
        let near = rounding(least);
        let (end, element) = match answer {
            Answer::Hit(Hit { t, element, .. })
                if t.is_finite() && *t >= least - rounding(*t) && *t <= most + rounding(*t) =>
            {
                (*t, Some(*element))
            }
            Answer::Escaped => (most, None),
            _ => return false,
        };
        let (from, to) = (least + near, end - if end.is_finite() { rounding(end) } else { 0.0 });
        let between = Ray { tmin: from, tmax: to, ..*ray };
        let is_short = to <= from;
        let (before, after) = (end - rounding(end), end + rounding(end));
        // Halfway: it may start within a surface.
        let is_air = |t: f64| self.truth.solids_at(at(ray, t)).is_empty();
        let far = if to.is_finite() { to } else { from + 1.0 };
        (is_short || may_be_free(&between))
            && element
                .is_none_or(|element| beside.iter().any(|ray| self.truth.meets(ray, element, before, after)))
            && (is_short || (self.truth.first(&between).is_none() && is_air(from + 0.5 * (far - from))))
    }
}

fn rounding(t: f64) -> f64 {
    ROUNDING * (1.0 + t.abs())
}

/// The point at `t` along a ray of any length.
fn at(ray: &Ray, t: f64) -> [f64; 3] {
    let largest = ray.direction.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    let direction = ray.direction.map(|c| c / largest);
    let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
    [0, 1, 2].map(|i| ray.origin[i] + t * (direction[i] / length))
}

impl Worth {
    /// Counts it.
    pub(super) fn count(&self, counts: &mut Counts) {
        let count = match self {
            Worth::Exact => &mut counts.exact,
            Worth::ExactOnly => &mut counts.oracle,
            Worth::Tie => &mut counts.ties,
            Worth::Close => &mut counts.close,
            Worth::Flush => &mut counts.flush,
            Worth::Beside => &mut counts.beside,
            Worth::InSolid => &mut counts.in_solid,
            Worth::Wrong(_) => &mut counts.wrong,
        };
        *count += 1;
    }
}
