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
    /// By site: the heights of its vertices, as [`Heights`] has them, and the vertices.
    over: Vec<Vec<(i128, u32)>>,
    /// By vertex: its site and its height.
    place: Vec<(u32, i128)>,
}

impl<'a> Vertices<'a> {
    pub(super) fn new(partition: &'a Partition, heights: &'a Heights) -> Vertices<'a> {
        Vertices {
            partition,
            heights,
            sites: Vec::new(),
            number: HashMap::new(),
            over: Vec::new(),
            place: Vec::new(),
        }
    }

    /// The vertex where a plane passes a site.
    pub(super) fn at(&mut self, site: Site, plane: u32) -> u32 {
        let number = *self.number.entry(site).or_insert_with(|| {
            self.sites.push(site);
            self.over.push(Vec::new());
            self.sites.len() as u32 - 1
        });
        self.find(number, plane).unwrap_or_else(|| {
            let (vertex, height) = (self.place.len() as u32, self.height(&site, plane));
            self.over[number as usize].push((height, vertex));
            self.place.push((number, height));
            vertex
        })
    }

    /// The vertex where a plane passes a site, if there is one.
    pub(super) fn find(&self, site: u32, plane: u32) -> Option<u32> {
        let height = self.height(&self.sites[site as usize], plane);
        self.over[site as usize].iter().find(|over| over.0 == height).map(|over| over.1)
    }

    /// The height of a plane over a site, as vertices have it.
    pub(super) fn height(&self, site: &Site, plane: u32) -> i128 {
        self.heights.at(site, site.height(&self.partition.planes[plane as usize]))
    }

    /// The site of a vertex.
    pub(super) fn site_of(&self, vertex: u32) -> u32 {
        self.place[vertex as usize].0
    }

    /// The vertices over the site of two others strictly between them, from the first to the second.
    pub(super) fn between(&self, from: u32, to: u32) -> Vec<u32> {
        let [(site, start), (_, end)] = [from, to].map(|vertex| self.place[vertex as usize]);
        let (low, high) = (start.min(end), start.max(end));
        let over = self.over[site as usize].iter().copied();
        let mut found: Vec<(i128, u32)> = over.filter(|&(height, _)| low < height && height < high).collect();
        found.sort_unstable();
        if end < start {
            found.reverse();
        }
        found.into_iter().map(|(_, vertex)| vertex).collect()
    }

    /// Where all vertices are, lattice units.
    pub(super) fn points(&self) -> Vec<[f64; 3]> {
        let point = |&(site, height): &(u32, i128)| {
            let site = &self.sites[site as usize];
            [site.along(0), site.along(1), height as f64 / (FINE as f64 * site.scale() as f64)]
        };
        self.place.iter().map(point).collect()
    }
}
