//! Rounds: links led through the vertices whose pixels they meet.

use super::sites::{Sites, pair_key, unique};
use super::tree::Tree;
use super::{Budget, SnapError, Snapped, Step};
use crate::lattice::{Point, orient};

/// Links of one round and what the next makes of them.
struct Round {
    /// The smaller vertex first, ascending, once each.
    pairs: Vec<[u32; 2]>,
    /// Where each pair's steps start in `steps`, and the end of the last.
    starts: Vec<u32>,
    /// Pairs of the next round, from a pair's first vertex to its second; none if it stays as it is.
    steps: Vec<Step>,
}

impl Round {
    fn steps(&self, pair: u32) -> &[Step] {
        &self.steps[self.starts[pair as usize] as usize..self.starts[pair as usize + 1] as usize]
    }
}

/// All rounds.
pub(super) struct Routes {
    rounds: Vec<Round>,
    settled: bool,
}

/// Leads the segments, and then the links that this makes, through the vertices until that changes nothing.
pub(super) fn route(sites: &Sites, budget: &mut Budget) -> Result<Routes, SnapError> {
    let tree = Tree::new(&sites.points);
    let mut routes = Routes { rounds: Vec::new(), settled: false };
    let mut pairs = sites.pairs.clone();
    for _ in 0..budget.limits.rounds.max(1) {
        let (round, next) = lead(&sites.points, &tree, pairs, budget)?;
        routes.rounds.push(round);
        pairs = next;
        if pairs.is_empty() {
            routes.settled = true;
            break;
        }
    }
    if !routes.settled {
        let starts = vec![0; pairs.len() + 1];
        routes.rounds.push(Round { pairs, starts, steps: Vec::new() });
    }
    routes.count(sites, budget)?;
    Ok(routes)
}

/// One round, and the links that it makes.
fn lead(
    points: &[Point],
    tree: &Tree,
    pairs: Vec<[u32; 2]>,
    budget: &mut Budget,
) -> Result<(Round, Vec<[u32; 2]>), SnapError> {
    let limit = budget.limits.steps.min(u64::from(u32::MAX / 2));
    let mut starts = Vec::with_capacity(pairs.len() + 1);
    starts.push(0);
    // Pairs of vertices in the order of the ways.
    let mut legs: Vec<[u32; 2]> = Vec::new();
    let mut met = Vec::new();
    for &[u, v] in &pairs {
        let (a, b) = (points[u as usize], points[v as usize]);
        met.clear();
        tree.met(a, b, budget, &mut met)?;
        if !met.is_empty() {
            // Vertices are in order of x and then y: on a way that rises that is the order along it.
            if a.y <= b.y {
                met.sort_unstable();
            } else {
                met.sort_unstable_by_key(|&m| (points[m as usize].x, -points[m as usize].y));
            }
            let mut from = u;
            for &to in met.iter().chain([&v]) {
                legs.push([from, to]);
                from = to;
            }
            if legs.len() as u64 > limit {
                return Err(SnapError::Steps(budget.limits.steps));
            }
        }
        starts.push(legs.len() as u32);
    }
    let sorted: Vec<[u32; 2]> = legs.iter().map(|&[u, v]| [u.min(v), u.max(v)]).collect();
    let (next, index) = unique(&sorted, pair_key);
    let steps = legs.iter().zip(index).map(|(leg, i)| Step::new(i, leg[0] < leg[1])).collect();
    Ok((Round { pairs, starts, steps }, next))
}

impl Routes {
    /// Checks the number of steps of all ways against the limit.
    fn count(&self, sites: &Sites, budget: &Budget) -> Result<(), SnapError> {
        let limit = budget.limits.steps.min(u64::from(u32::MAX / 2));
        // Steps at the end for each pair of a round, last round first.
        let mut after: Vec<u64> = Vec::new();
        for round in self.rounds.iter().rev() {
            after = (0..round.pairs.len() as u32)
                .map(|pair| match round.steps(pair) {
                    [] => 1,
                    steps => steps.iter().fold(0u64, |sum, s| sum.saturating_add(after[s.link()])),
                })
                .collect();
        }
        let total = sites
            .given
            .iter()
            .flatten()
            .fold(0u64, |sum, &(pair, _)| sum.saturating_add(after[pair as usize]));
        if total > limit { Err(SnapError::Steps(budget.limits.steps)) } else { Ok(()) }
    }

    /// The links that stay, and the ways of all segments along them.
    pub(super) fn finish(self, sites: Sites, crossings: u64, added: usize) -> Snapped {
        let lasting: Vec<[u32; 2]> = self
            .rounds
            .iter()
            .flat_map(|round| (0u32..).zip(&round.pairs).filter(|&(i, _)| round.steps(i).is_empty()))
            .map(|(_, &pair)| pair)
            .collect();
        let (links, index) = unique(&lasting, pair_key);
        let mut index = index.into_iter();
        // For each pair of each round the link that it is, if it stays.
        let named: Vec<Vec<u32>> = self
            .rounds
            .iter()
            .map(|round| {
                (0..round.pairs.len() as u32)
                    .map(|i| if round.steps(i).is_empty() { index.next().unwrap_or_default() } else { 0 })
                    .collect()
            })
            .collect();
        let mut starts = Vec::with_capacity(sites.given.len() + 1);
        starts.push(0);
        let mut steps = Vec::with_capacity(sites.given.len());
        let (mut displacement, mut rerouted) = (0.0f64, 0);
        let mut open: Vec<(usize, Step)> = Vec::new();
        for given in &sites.given {
            if let Some((pair, forward)) = *given {
                let start = steps.len();
                open.push((0, Step::new(pair, forward)));
                while let Some((round, step)) = open.pop() {
                    let parts = self.rounds[round].steps(step.link() as u32);
                    if parts.is_empty() {
                        steps.push(Step::new(named[round][step.link()], step.forward()));
                    } else if step.forward() {
                        open.extend(parts.iter().rev().map(|&s| (round + 1, s)));
                    } else {
                        open.extend(parts.iter().map(|s| (round + 1, s.back())));
                    }
                }
                if steps.len() > start + 1 {
                    rerouted += 1;
                    let ends = sites.pairs[pair as usize].map(|v| sites.points[v as usize]);
                    let on_way = steps[start..].iter().flat_map(|s: &Step| links[s.link()]);
                    displacement = displacement.max(off(ends, on_way.map(|v| sites.points[v as usize])));
                }
            }
            starts.push(steps.len() as u32);
        }
        let rounds = self.rounds.len() as u32 - 1;
        Snapped {
            vertices: sites.points,
            links,
            starts,
            steps,
            rounds,
            settled: self.settled,
            displacement,
            crossings,
            added,
            rerouted,
        }
    }
}

/// The largest distance of points in the box about a segment's ends from it. For a way from end to end through these
/// that is the distance between way and segment, both ways: no point between two vertices is farther than they, and the
/// way passes beside every point of the segment.
fn off([a, b]: [Point; 2], points: impl Iterator<Item = Point>) -> f64 {
    let area = points.map(|p| orient(a, b, p).abs()).max().unwrap_or(0);
    let (dx, dy) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
    // Both are below 2^53.
    area as f64 / (dx * dx + dy * dy).sqrt()
}
