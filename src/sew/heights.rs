//! The heights of planes over sites, so that no ceiling lies below its floor.
//!
//! Planes and points are rounded by themselves, so that over a point the order of two planes that nearly meet there may not
//! be that of the cells between them. All heights from the one to the other are then one.

use std::collections::HashMap;

use super::split::Grid;
use crate::lattice::{FINE, Point, Site};
use crate::partition::cells::Partition;

/// Heights over sites, as [`Site::height`] has them.
#[derive(Debug)]
pub(super) struct Heights {
    /// All places where faces have corners.
    sites: Vec<Site>,
    grid: Grid,
    /// By site: ranges of heights that are one, ascending, apart from each other.
    joined: HashMap<Site, Vec<[i128; 2]>>,
    /// The sites that have such, and where they are.
    bent: Vec<Site>,
    bent_grid: Grid,
}

impl Heights {
    /// Looks at all cells, over the corners of their footprints and all `sites` in these. Among the sites must be all places
    /// where the planes of cells beside each other cross over their border, so that planes keep their order from one site to the next.
    pub(super) fn of(partition: &Partition, sites: Vec<Site>) -> Heights {
        let mut joined: HashMap<Site, Vec<[i128; 2]>> = HashMap::new();
        let grid = Grid::new(&sites);
        for cell in &partition.cells {
            let corners: Vec<Point> = partition.footprint(cell).collect();
            let [floor, ceiling] = [cell.floor, cell.ceiling].map(|plane| &partition.planes[plane as usize]);
            // The box of the part that has its ceiling below its floor, which ends at corners or between them.
            let rise = |corner: &Point| ceiling.height(*corner) - floor.height(*corner);
            let rises: Vec<i64> = corners.iter().map(rise).collect();
            let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
            for (i, (&here, &from)) in corners.iter().zip(&rises).enumerate() {
                let next = (i + 1) % corners.len();
                let (there, to) = (corners[next], rises[next]);
                // The corner itself, if it lies on both planes.
                let crosses = (from < 0) != (to < 0);
                let share = if crosses { from as f64 / (from as f64 - to as f64) } else { 0.0 };
                let at =
                    |start: i32, end: i32| f64::from(start) + share * (f64::from(end) - f64::from(start));
                let crossing = [at(here.x, there.x), at(here.y, there.y)];
                let corner = [f64::from(here.x), f64::from(here.y)];
                let ends = [(from < 0).then_some(corner), crosses.then_some(crossing)];
                for point in ends.into_iter().flatten() {
                    for axis in 0..2 {
                        bounds[0][axis] = bounds[0][axis].min(point[axis] - 1.0);
                        bounds[1][axis] = bounds[1][axis].max(point[axis] + 1.0);
                    }
                }
            }
            if rises.iter().all(|&rise| rise >= 0) {
                continue;
            }
            let is_inside = |site: &Site| {
                (0..corners.len()).all(|i| site.side([corners[i], corners[(i + 1) % corners.len()]]) >= 0)
            };
            for site in grid.within(bounds).map(|site| sites[site as usize]).filter(is_inside) {
                let [floor, ceiling] = [floor, ceiling].map(|plane| site.height(plane));
                if ceiling < floor {
                    joined.entry(site).or_default().push([ceiling, floor]);
                }
            }
        }
        for ranges in joined.values_mut() {
            ranges.sort_unstable();
            let mut apart: Vec<[i128; 2]> = Vec::with_capacity(ranges.len());
            for &[low, high] in ranges.iter() {
                match apart.last_mut() {
                    Some(last) if low <= last[1] => last[1] = last[1].max(high),
                    _ => apart.push([low, high]),
                }
            }
            *ranges = apart;
        }
        // In an order that is always the same.
        let mut bent: Vec<Site> = joined.keys().copied().collect();
        bent.sort_unstable_by(Site::compare);
        let bent_grid = Grid::new(&bent);
        Heights { sites, grid, joined, bent, bent_grid }
    }

    /// The sites on an edge of the plan, ends included, from its start to its end, if heights were made one over any of them:
    /// planes are straight only from each of these to the next.
    pub(super) fn bends(&self, line: [Point; 2]) -> Option<Vec<Site>> {
        let [start, end] = line.map(Site::from);
        let is_bent = [start, end].iter().any(|site| self.joined.contains_key(site))
            || !self.bent_grid.between(&self.bent, line, &start, &end).is_empty();
        is_bent.then(|| {
            let between = self.grid.between(&self.sites, line, &start, &end);
            let between = between.into_iter().map(|site| self.sites[site as usize]);
            [start].into_iter().chain(between).chain([end]).collect()
        })
    }

    /// What a height over a site counts as.
    pub(super) fn at(&self, site: &Site, height: i128) -> i128 {
        let Some(ranges) = self.joined.get(site) else { return height };
        let range = ranges.iter().find(|[low, high]| (*low..=*high).contains(&height));
        range.map_or(height, |range| range[0])
    }

    /// How many ranges of heights are one, and the longest, lattice units.
    pub(super) fn joined(&self) -> (u64, f64) {
        let length = |(site, ranges): (&Site, &Vec<[i128; 2]>)| {
            let longest = ranges.iter().map(|[low, high]| high - low).max().unwrap_or(0);
            longest as f64 / (FINE as f64 * site.scale() as f64)
        };
        let count = self.joined.values().map(Vec::len).sum::<usize>();
        (count as u64, self.joined.iter().map(length).fold(0.0, f64::max))
    }
}
