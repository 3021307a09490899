//! Edges end at every vertex that lies on them, so that all faces around an edge have the same.

use std::cmp::Ordering;
use std::collections::HashMap;

use super::faces::{Corner, Polygon};
use super::vertices::Vertices;
use crate::lattice::{Point, Site};

/// Puts the vertices that lie on the edges of faces between their corners.
pub(super) fn split(faces: &mut [Polygon], vertices: &Vertices<'_>) {
    let grid = Grid::new(&vertices.sites);
    // By line, and the sites of the ends: the sites between.
    let mut known: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    for face in faces.iter_mut() {
        let mut corners = Vec::with_capacity(face.corners.len());
        for (k, &corner) in face.corners.iter().enumerate() {
            corners.push(corner);
            let next = face.corners[(k + 1) % face.corners.len()].vertex;
            let Some((line, plane)) = corner.edge else {
                let between = vertices.between(corner.vertex, next);
                corners.extend(between.into_iter().map(|vertex| Corner { vertex, edge: None }));
                continue;
            };
            let ends = [corner.vertex, next].map(|vertex| vertices.site_of(vertex));
            let between = known.entry(ends).or_insert_with(|| {
                let [a, b] = ends.map(|end| &vertices.sites[end as usize]);
                grid.between(&vertices.sites, line, a, b)
            });
            corners.extend(between.iter().filter_map(|&site| {
                let vertex = vertices.find(site, plane)?;
                Some(Corner { vertex, edge: corner.edge })
            }));
        }
        face.corners = corners;
    }
}

/// Sites in square buckets.
#[derive(Debug)]
pub(super) struct Grid {
    lo: [f64; 2],
    size: f64,
    across: [usize; 2],
    /// By bucket: where its sites start in `items`; and where the last one's end.
    starts: Vec<u32>,
    items: Vec<u32>,
    /// By site: where it is, lattice units, rounded.
    places: Vec<[f64; 2]>,
}

/// Buckets along an axis, at most. Storeys that are nearly alike have very many sites beside each other.
const MOST: f64 = 2048.0;
/// A site that lies on a line is no farther from it than this when both are rounded to f64, lattice units: those have 24 bits before the
/// point, and are off by some 2^-29, and so is what is computed from them by some 2^-26.
const ROUNDED: f64 = 1e-6;

impl Grid {
    pub(super) fn new(sites: &[Site]) -> Grid {
        let places: Vec<[f64; 2]> = sites.iter().map(|site| [0, 1].map(|axis| site.along(axis))).collect();
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in &places {
            for axis in 0..2 {
                lo[axis] = lo[axis].min(place[axis]);
                hi[axis] = hi[axis].max(place[axis]);
            }
        }
        let extent = (0..2).map(|axis| hi[axis] - lo[axis]).fold(1.0, f64::max);
        let most = (sites.len() as f64).sqrt().clamp(1.0, MOST);
        let size = extent / most;
        let across = [0, 1].map(|axis| ((hi[axis] - lo[axis]).max(0.0) / size) as usize + 1);
        let starts = vec![0; across[0] * across[1] + 1];
        let mut grid = Grid { lo, size, across, starts, items: vec![0; sites.len()], places };
        let buckets: Vec<usize> = grid
            .places
            .iter()
            .map(|place| {
                let [x, y] = [0, 1].map(|axis| grid.bucket(place[axis], axis));
                y * across[0] + x
            })
            .collect();
        // Counted, then each put where its bucket's next one goes.
        buckets.iter().for_each(|&bucket| grid.starts[bucket + 1] += 1);
        for bucket in 0..across[0] * across[1] {
            grid.starts[bucket + 1] += grid.starts[bucket];
        }
        let mut next = grid.starts.clone();
        for (&bucket, number) in buckets.iter().zip(0..) {
            grid.items[next[bucket] as usize] = number;
            next[bucket] += 1;
        }
        grid
    }

    fn sites(&self, bucket: usize) -> &[u32] {
        &self.items[self.starts[bucket] as usize..self.starts[bucket + 1] as usize]
    }

    fn bucket(&self, at: f64, axis: usize) -> usize {
        (((at - self.lo[axis]) / self.size).max(0.0) as usize).min(self.across[axis] - 1)
    }

    /// The sites in a box, and some beside it.
    pub(super) fn within(&self, [lo, hi]: [[f64; 2]; 2]) -> impl Iterator<Item = u32> + '_ {
        let [columns, rows] = [0, 1].map(|axis| self.bucket(lo[axis], axis)..=self.bucket(hi[axis], axis));
        rows.flat_map(move |y| columns.clone().map(move |x| y * self.across[0] + x))
            .flat_map(|bucket| self.sites(bucket).iter().copied())
    }

    /// The sites strictly between two on a line, from the first to the second.
    pub(super) fn between(&self, sites: &[Site], line: [Point; 2], a: &Site, b: &Site) -> Vec<u32> {
        let order = a.compare(b);
        let mut found = Vec::new();
        let [from, to] = [a, b].map(|end| [0, 1].map(|axis| end.along(axis)));
        let way = [to[0] - from[0], to[1] - from[1]];
        let near = ROUNDED * way[0].hypot(way[1]);
        let is_near = |number: u32| {
            let [x, y] = self.places[number as usize];
            (way[0] * (y - from[1]) - way[1] * (x - from[0])).abs() <= near
        };
        let rows = [self.bucket(from[1].min(to[1]), 1), self.bucket(from[1].max(to[1]), 1)];
        for y in rows[0]..=rows[1] {
            // What of the edge is in this row of buckets, and a little more.
            let low = self.lo[1] + y as f64 * self.size;
            let share = |height: f64| {
                let rise = to[1] - from[1];
                if rise == 0.0 { None } else { Some(((height - from[1]) / rise).clamp(0.0, 1.0)) }
            };
            let at = |share: f64| from[0] + share * (to[0] - from[0]);
            let (one, other) = match (share(low - 1.0), share(low + self.size + 1.0)) {
                (Some(one), Some(other)) => (at(one), at(other)),
                _ => (from[0], to[0]),
            };
            let columns = [self.bucket(one.min(other) - 1.0, 0), self.bucket(one.max(other) + 1.0, 0)];
            for x in columns[0]..=columns[1] {
                let all = self.sites(y * self.across[0] + x).iter().copied();
                found.extend(all.filter(|&number| is_near(number)).filter(|&number| {
                    let site = &sites[number as usize];
                    let is_between = a.compare(site) == order && site.compare(b) == order;
                    is_between && site.side(line) == 0
                }));
            }
        }
        found.sort_by(|&p, &q| {
            let along = sites[p as usize].compare(&sites[q as usize]);
            if order == Ordering::Less { along } else { along.reverse() }
        });
        found
    }
}
