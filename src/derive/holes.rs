//! The hole around a door or a window: which wall, slab or roof it is in, how deep that is, and how far the hole reaches.
//!
//! A door's mesh tells where it is; neither its box (frames lap over the wall, leaves stand open) nor its pivot tells the hole. The hole is
//! found in the matter around: lines just outside of the door's outline, across a wall's own faces, tell where the wall begins and ends; lines
//! from the middle of the door outward, within that depth, tell where the hole ends.

use enfilade_importers::ElementId;
use glam::DVec3;

use super::matter::{Bounds, Near, Solids, united};

/// A hole: a box.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hole {
    /// What has the hole: the element that most lines find.
    pub(super) host: ElementId,
    /// Axes: along the wall, through it, up along it.
    pub(super) axes: [DVec3; 3],
    /// From where to where along each.
    pub(super) range: [[f64; 2]; 3],
    /// The share of the lines around the door that find the wall.
    pub(super) found: f64,
}

/// No wall is thicker, metres.
const THICKEST: f64 = 1.2;
/// Layers of a wall are no farther from each other, metres.
const BETWEEN_LAYERS: f64 = 0.12;
/// A hole is no farther from its door on each side, metres.
const AROUND: f64 = 0.3;
/// The wall may be so far beside what fills the hole, metres.
const BESIDE: f64 = 0.15;
/// So many lines around must find the wall.
const ENOUGH: f64 = 0.3;

impl Hole {
    /// The hole around a mesh, if it is in one.
    pub(super) fn around(corners: &[DVec3], solids: &Solids) -> Option<Hole> {
        let bounds = Bounds::of(corners.iter().copied());
        if bounds.is_empty() {
            return None;
        }
        let near = solids.near(&bounds.grown(AROUND + BESIDE));
        let mut best: Option<(f64, Hole)> = None;
        for through in directions(&near, &bounds.grown(BESIDE)) {
            let frame = Frame::new(through, corners);
            let Some((hole, score)) = frame.hole(&near) else { continue };
            if best.as_ref().is_none_or(|best| score > best.0 + 1e-9) {
                best = Some((score, hole));
            }
        }
        best.map(|best| best.1)
    }
}

/// Directions nearer to each other than this (cosine) are one.
const ALIKE: f64 = 0.98;
/// Of the directions that surfaces near a door look in, so many are tried.
const TRIED: usize = 8;

/// The directions that the surfaces near a box look in, those of most area first; of large triangles only so much area counts as may be near.
fn directions(near: &Near, bounds: &Bounds) -> Vec<DVec3> {
    let size = bounds.hi - bounds.lo;
    let most = size.max_element() * size.max_element();
    let mut groups: Vec<(DVec3, f64)> = Vec::new();
    for [a, b, c] in near.within(bounds) {
        let normal = (b - a).cross(c - a);
        let area = (normal.length() / 2.0).min(most);
        let Some(mut direction) = normal.try_normalize() else { continue };
        // One of both ways.
        let leading = if direction.x.abs() > 1e-6 {
            direction.x
        } else if direction.y.abs() > 1e-6 {
            direction.y
        } else {
            direction.z
        };
        if leading < 0.0 {
            direction = -direction;
        }
        match groups.iter_mut().find(|group| group.0.dot(direction).abs() > ALIKE) {
            Some(group) => group.1 += area,
            None => groups.push((direction, area)),
        }
    }
    groups.sort_by(|a, b| b.1.total_cmp(&a.1));
    groups.into_iter().map(|group| group.0).take(TRIED).collect()
}

/// A door's extent along and across a wall.
struct Frame {
    axes: [DVec3; 3],
    range: [[f64; 2]; 3],
}

const ALONG: usize = 0;
const THROUGH: usize = 1;
const UP: usize = 2;

impl Frame {
    fn new(through: DVec3, corners: &[DVec3]) -> Frame {
        let along = if through.z.abs() < 0.99 {
            through.cross(DVec3::Z).normalize()
        } else {
            // Level: along the longest of what is seen from above, its edges.
            longest_level(corners)
        };
        let axes = [along, through, along.cross(through)];
        let range = axes.map(|axis| {
            corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], p| {
                [lo.min(p.dot(axis)), hi.max(p.dot(axis))]
            })
        });
        Frame { axes, range }
    }

    fn point(&self, at: [f64; 3]) -> DVec3 {
        self.axes[0] * at[0] + self.axes[1] * at[1] + self.axes[2] * at[2]
    }

    fn at(&self, axis: usize, share: f64) -> f64 {
        let [lo, hi] = self.range[axis];
        lo + (hi - lo) * share
    }

    /// Points just outside of the outline, seen along the way through: beside it, and above and below.
    fn around(&self) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        for beside in [0.03, 0.08, BESIDE] {
            for share in [0.15, 0.4, 0.6, 0.85] {
                let [left, right] = self.range[ALONG];
                let [low, high] = self.range[UP];
                points.push([left - beside, self.at(UP, share)]);
                points.push([right + beside, self.at(UP, share)]);
                points.push([self.at(ALONG, share), high + beside]);
                points.push([self.at(ALONG, share), low - beside]);
            }
        }
        points
    }

    /// The wall on a line through a point beside or within the outline: its two surfaces, and its elements.
    fn wall(&self, near: &Near, [along, up]: [f64; 2]) -> Option<([f64; 2], ElementId)> {
        let start = self.point([along, 0.0, up]);
        let [from, to] = self.range[THROUGH];
        let walls = united(near.spans(start, self.axes[THROUGH]), BETWEEN_LAYERS);
        let overlap = |range: &[f64; 2]| range[1].min(to) - range[0].max(from);
        // A skylight stands on its roof, a sliding door before its wall.
        let is_in = |range: &[f64; 2]| range[1] - range[0] <= THICKEST && overlap(range) > -BESIDE;
        let found = walls.into_iter().filter(|(range, _)| is_in(range));
        let (range, elements) = found.max_by(|a, b| overlap(&a.0).total_cmp(&overlap(&b.0)))?;
        let most = elements.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        Some((range, most.0))
    }

    fn hole(&self, near: &Near) -> Option<(Hole, f64)> {
        let around = self.around();
        let found: Vec<([f64; 2], ElementId)> = around.iter().filter_map(|&at| self.wall(near, at)).collect();
        let share = found.len() as f64 / around.len() as f64;
        if share < ENOUGH {
            return None;
        }
        let depth = [0, 1].map(|end| median(found.iter().map(|(range, _)| range[end]).collect()));
        let [from, to] = [depth[0]?, depth[1]?];
        let mut counts = std::collections::BTreeMap::new();
        found.iter().for_each(|(_, element)| *counts.entry(*element).or_insert(0) += 1);
        let host = counts.into_iter().max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(&a.0)))?.0;
        let mut range = self.range;
        range[THROUGH] = [from, to];
        // Where the wall goes on behind the door, there is no hole but what the door says.
        let within = [0.25, 0.5, 0.75];
        let filled =
            within.iter().flat_map(|&along| within.map(|up| [self.at(ALONG, along), self.at(UP, up)]));
        let filled = filled
            .filter(|&at| self.wall(near, at).is_some_and(|(own, _)| own[1] - own[0] > 0.5 * (to - from)));
        let is_open = filled.count() < 5;
        let overlap = self.range[THROUGH][1].min(to) - self.range[THROUGH][0].max(from);
        // What only stands before a wall is not in it.
        if !is_open && overlap < 0.25 * (to - from).min(self.range[THROUGH][1] - self.range[THROUGH][0]) {
            return None;
        }
        if is_open {
            range[ALONG] = self.reach(near, ALONG, UP, [from, to]);
            range[UP] = self.reach(near, UP, ALONG, [from, to]);
        }
        // A wall's own way through is the shorter one, and its lines agree.
        let size = |axis: usize| self.range[axis][1] - self.range[axis][0];
        let flat = size(THROUGH) / size(ALONG).max(size(UP)).max(1e-9);
        let spread = found
            .iter()
            .filter(|(own, _)| (own[0] - from).abs() < 0.02 && (own[1] - to).abs() < 0.02)
            .count();
        let agree = spread as f64 / found.len() as f64;
        // By how much of it, or of the wall, the door lies in the wall.
        let [near_side, far_side] = self.range[THROUGH];
        let least = (to - from).min(far_side - near_side).max(1e-3);
        let inside = ((to.min(far_side) - from.max(near_side)) / least).clamp(0.0, 1.0);
        let score = share + 0.5 * agree + 0.5 * inside - 0.3 * flat.min(1.0);
        Some((Hole { host, axes: self.axes, range, found: share }, score))
    }

    /// How far the hole reaches along an axis, on both sides: what most lines from the middle find, those spread along `other`.
    fn reach(&self, near: &Near, axis: usize, other: usize, [from, to]: [f64; 2]) -> [f64; 2] {
        let mut reach = self.range[axis];
        let middle = self.at(axis, 0.5);
        for (end, way) in [(0, -1.0), (1, 1.0)] {
            let own = (self.range[axis][end] - middle).abs();
            let mut found = Vec::new();
            for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
                for deep in [0.2, 0.5, 0.8] {
                    let mut at = [0.0; 3];
                    at[axis] = middle;
                    at[other] = self.at(other, share);
                    at[THROUGH] = from + (to - from) * deep;
                    let first = near.first(self.point(at), self.axes[axis] * way);
                    // Nearer than half of the way is no jamb, but something in the hole.
                    found.push(first.filter(|t| *t <= own + AROUND && *t >= 0.5 * own).unwrap_or(f64::NAN));
                }
            }
            let known: Vec<f64> = found.iter().copied().filter(|t| !t.is_nan()).collect();
            if known.len() * 3 >= found.len()
                && let Some(t) = farthest_of_most(known)
            {
                reach[end] = middle + way * t;
            }
        }
        reach
    }
}

/// A high one of some numbers that is no outlier: an arch's top rather than its feet.
fn farthest_of_most(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() * 4 / 5).or(numbers.last()).copied()
}

fn median(mut numbers: Vec<f64>) -> Option<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied()
}

/// The level direction between those two of some points, one after the other, that are farthest from each other in the plan.
fn longest_level(corners: &[DVec3]) -> DVec3 {
    let level = corners.windows(2).map(|pair| DVec3::new(pair[1].x - pair[0].x, pair[1].y - pair[0].y, 0.0));
    let longest = level.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    longest.and_then(DVec3::try_normalize).unwrap_or(DVec3::X)
}
