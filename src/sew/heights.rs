//! The heights of planes over sites, so that no ceiling lies below its floor.
//!
//! Planes and points are rounded by themselves, so that over a point the order of two planes that nearly meet there may not
//! be that of the cells between them. All heights from the one to the other are then one.

use std::collections::HashMap;

use super::split::Grid;
use crate::lattice::{FINE, Point, Site};
use crate::partition::cells::Partition;

/// Heights over sites, as [`Site::height`] has them.
#[derive(Debug, Default)]
pub(super) struct Heights {
    /// By site: ranges of heights that are one, ascending, apart from each other.
    joined: HashMap<Site, Vec<[i128; 2]>>,
}

impl Heights {
    /// Looks at all cells over the edges of their footprints: at the ends of these and at all `sites` on them.
    pub(super) fn of(partition: &Partition, sites: &[Site]) -> Heights {
        let mut joined: HashMap<Site, Vec<[i128; 2]>> = HashMap::new();
        let grid = Grid::new(sites);
        for cell in &partition.cells {
            let corners: Vec<Point> = partition.footprint(cell).collect();
            for (i, &from) in corners.iter().enumerate() {
                let line = [from, corners[(i + 1) % corners.len()]];
                let [start, end] = line.map(Site::from);
                let between = grid.between(sites, line, &start, &end);
                for site in [start].into_iter().chain(between.into_iter().map(|site| sites[site as usize])) {
                    let height = |plane: u32| site.height(&partition.planes[plane as usize]);
                    let (floor, ceiling) = (height(cell.floor), height(cell.ceiling));
                    if ceiling < floor {
                        joined.entry(site).or_default().push([ceiling, floor]);
                    }
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
        Heights { joined }
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
