//! The common part of the sides of two cells: over both floors and under both ceilings.
//!
//! *Stations* cut a border so that the planes of both cells keep their order from each to the next: the places where they cross, and
//! where [`Heights`] bends them all sites. Heights over the ends of a border are within the hull, below 2^50 parts of a
//! lattice unit; products of three of them do not occur.

use super::Way;
use super::faces::{Border, Corner, Polygon, polygon};
use super::heights::Heights;
use super::vertices::Vertices;
use crate::lattice::Site;
use crate::partition::cells::{NONE, Partition};

/// The planes of the cells on both sides of a border.
struct Planes {
    floors: Vec<u32>,
    ceilings: Vec<u32>,
}

impl Planes {
    fn of(partition: &Partition, border: &Border) -> Planes {
        let cells = [border.one, border.other].into_iter().filter(|&cell| cell != NONE);
        let cells = cells.map(|cell| &partition.cells[cell as usize]);
        let (floors, ceilings) = cells.map(|cell| (cell.floor, cell.ceiling)).unzip();
        Planes { floors, ceilings }
    }
}

/// Where planes of two cells cross over their border, strictly between its ends; in no order.
pub(super) fn crossings(partition: &Partition, border: &Border) -> Vec<Site> {
    let Planes { mut floors, ceilings } = Planes::of(partition, border);
    floors.extend(ceilings);
    let ends = border.ends.map(Site::from);
    let mut found = Vec::new();
    for (i, &a) in floors.iter().enumerate() {
        for &b in floors[..i].iter().filter(|&&b| a != b) {
            let [a, b] = [a, b].map(|plane| &partition.planes[plane as usize]);
            let [start, end] = [0, 1].map(|k| ends[k].height(a) - ends[k].height(b));
            if (start > 0 && end < 0) || (start < 0 && end > 0) {
                found.push(Site::between(border.ends, start.abs(), (start - end).abs()));
            }
        }
    }
    found
}

/// What is at a station.
struct Station {
    site: Site,
    /// The planes that pass the upper of the floors there, and the lower of the ceilings.
    low: Vec<u32>,
    high: Vec<u32>,
    /// Whether that ceiling is over that floor.
    is_open: bool,
    /// Whether it is on it.
    is_closed: bool,
}

/// The common parts of two upright sides; more than one where they meet in between.
pub(super) fn upright(
    partition: &Partition,
    border: &Border,
    heights: &Heights,
    vertices: &mut Vertices<'_>,
    faces: &mut Vec<Polygon>,
) {
    let planes = Planes::of(partition, border);
    let bends = heights.bends(border.ends);
    let is_bent = bends.is_some();
    let sites = bends.unwrap_or_else(|| {
        let [start, end] = border.ends.map(Site::from);
        let mut between = crossings(partition, border);
        between
            .sort_unstable_by(|a, b| if start.compare(&end).is_lt() { a.compare(b) } else { b.compare(a) });
        between.dedup();
        [start].into_iter().chain(between).chain([end]).collect()
    });
    let station = |site: Site| {
        let of = |planes: &[u32], extreme: fn(i128, i128) -> i128| {
            let heights: Vec<i128> = planes.iter().map(|&plane| vertices.height(&site, plane)).collect();
            let best = heights.iter().copied().reduce(extreme).unwrap_or(0);
            let through = planes.iter().zip(&heights).filter(|(_, height)| **height == best);
            (best, through.map(|(&plane, _)| plane).collect::<Vec<u32>>())
        };
        let (floor, low) = of(&planes.floors, i128::max);
        let (ceiling, high) = of(&planes.ceilings, i128::min);
        Station { site, low, high, is_open: floor < ceiling, is_closed: floor == ceiling }
    };
    let stations: Vec<Station> = sites.into_iter().map(station).collect();
    let mut from = 0;
    while from + 1 < stations.len() {
        // From one station at which the sides meet, or end, to the next.
        let opens = |k: usize| {
            let (here, there) = (&stations[k], &stations[k + 1]);
            (here.is_open && (there.is_open || there.is_closed)) || (here.is_closed && there.is_open)
        };
        if !opens(from) {
            from += 1;
            continue;
        }
        let mut to = from + 1;
        while to + 1 < stations.len() && stations[to].is_open && opens(to) {
            to += 1;
        }
        let part = &stations[from..=to];
        let low: Vec<(Site, &[u32])> = part.iter().map(|s| (s.site, &s.low[..])).collect();
        let high: Vec<(Site, &[u32])> = part.iter().rev().map(|s| (s.site, &s.high[..])).collect();
        let mut corners = chain(&low, is_bent, border, vertices);
        corners.extend(chain(&high, is_bent, border, vertices));
        faces.extend(polygon([border.one, border.other], Way::Upright(border.ends), border.sources, corners));
        from = to;
    }
}

/// The lower or upper edge of a side, from its first station to its last; not the upright edge that follows. Where planes
/// are straight, only stations at which it changes planes are corners.
fn chain(
    stations: &[(Site, &[u32])],
    is_bent: bool,
    border: &Border,
    vertices: &mut Vertices<'_>,
) -> Vec<Corner> {
    let mut corners = Vec::with_capacity(stations.len());
    // What the edge so far lies in.
    let mut along: Vec<u32> = Vec::new();
    for (k, &(site, planes)) in stations.iter().enumerate() {
        let goes_on = |plane: &&u32| stations.get(k + 1).is_some_and(|next| next.1.contains(*plane));
        let still: Vec<u32> = along.iter().filter(goes_on).copied().collect();
        let is_last = k + 1 == stations.len();
        if !is_last && !is_bent && !still.is_empty() {
            along = still;
            continue;
        }
        along = planes.iter().filter(goes_on).copied().collect();
        let edge = along.first().map(|&plane| (border.ends, plane));
        if let Some(&plane) = planes.first() {
            corners.push(Corner { vertex: vertices.at(site, plane), edge });
        }
    }
    corners
}
