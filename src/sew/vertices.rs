//! The vertices of the map: where faces have corners. Two corners are one vertex if they are equal exactly, or by
//! [`Heights`].

use std::collections::HashMap;

use super::heights::Heights;
use crate::lattice::{FINE, Site};
use crate::partition::cells::Partition;

/// The vertices met so far.
pub(super) struct Vertices<'a> {
    partition: &'a Partition,
    heights: &'a Heights,
    /// All places that have vertices.
    pub(super) sites: Vec<Site>,
    number: HashMap<Site, u32>,
    /// By site: its vertices.
    over: Vec<Vec<Over>>,
    /// By vertex: its site.
    site_of: Vec<u32>,
    points: Vec<[f64; 3]>,
}

/// A vertex over a site.
struct Over {
    vertex: u32,
    /// Its height, as [`Heights`] has it.
    height: i128,
    /// Planes that pass it there, and may be off by what was joined at the ends of an edge.
    planes: Vec<u32>,
}

impl<'a> Vertices<'a> {
    pub(super) fn new(partition: &'a Partition, heights: &'a Heights) -> Vertices<'a> {
        Vertices {
            partition,
            heights,
            sites: Vec::new(),
            number: HashMap::new(),
            over: Vec::new(),
            site_of: Vec::new(),
            points: Vec::new(),
        }
    }

    /// The vertex where some planes pass a site.
    pub(super) fn at(&mut self, site: Site, planes: &[u32]) -> u32 {
        let number = *self.number.entry(site).or_insert_with(|| {
            self.sites.push(site);
            self.over.push(Vec::new());
            self.sites.len() as u32 - 1
        });
        if let Some(vertex) = planes.iter().find_map(|&plane| self.find(number, plane)) {
            if let Some(over) = self.over[number as usize].iter_mut().find(|over| over.vertex == vertex) {
                let new = planes.iter().filter(|plane| !over.planes.contains(plane)).copied();
                let new: Vec<u32> = new.collect();
                over.planes.extend(new);
            }
            return vertex;
        }
        let vertex = self.points.len() as u32;
        let height = planes.first().map_or(0, |&plane| self.height(&site, plane));
        let z = height as f64 / (FINE as f64 * site.scale() as f64);
        self.over[number as usize].push(Over { vertex, height, planes: planes.to_vec() });
        self.site_of.push(number);
        self.points.push([site.along(0), site.along(1), z]);
        vertex
    }

    /// The vertex where a plane passes a site, if there is one.
    pub(super) fn find(&self, site: u32, plane: u32) -> Option<u32> {
        let height = self.height(&self.sites[site as usize], plane);
        let over = &self.over[site as usize];
        let by_height = || over.iter().find(|over| over.height == height);
        over.iter().find(|over| over.planes.contains(&plane)).or_else(by_height).map(|over| over.vertex)
    }

    /// The height of a plane over a site, as vertices have it.
    fn height(&self, site: &Site, plane: u32) -> i128 {
        self.heights.at(site, site.height(&self.partition.planes[plane as usize]))
    }

    /// The site of a vertex.
    pub(super) fn site_of(&self, vertex: u32) -> u32 {
        self.site_of[vertex as usize]
    }

    /// The vertices over the site of two others strictly between them, from the first to the second.
    pub(super) fn between(&self, from: u32, to: u32) -> Vec<u32> {
        let over = &self.over[self.site_of(from) as usize];
        let height = |vertex: u32| over.iter().find(|over| over.vertex == vertex).map(|over| over.height);
        let (Some(start), Some(end)) = (height(from), height(to)) else { return Vec::new() };
        let (low, high) = (start.min(end), start.max(end));
        let mut found: Vec<&Over> = over.iter().filter(|o| low < o.height && o.height < high).collect();
        found.sort_unstable_by_key(|over| if start < end { over.height } else { -over.height });
        found.into_iter().map(|over| over.vertex).collect()
    }

    /// Where all vertices are, lattice units.
    pub(super) fn points(self) -> Vec<[f64; 3]> {
        self.points
    }
}
