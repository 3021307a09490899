//! The chains of a planar map: links strung together at vertices that may go.

use super::Step;
use crate::lattice::Point;

/// Chains, one after another.
#[derive(Default)]
pub(super) struct Chains {
    /// The vertices of all chains; a chain has one more than links.
    vertices: Vec<u32>,
    /// Old links of all chains, and whether they run along their chain.
    links: Vec<Step>,
    /// Where each chain starts in `links`, and the end. In `vertices` it starts later by its own number.
    starts: Vec<u32>,
}

/// One chain.
#[derive(Clone, Copy)]
pub(super) struct Chain<'a> {
    /// Its vertices; the last is the first again if it is closed.
    pub vertices: &'a [u32],
    /// The old links between them.
    pub links: &'a [Step],
}

impl Chain<'_> {
    pub fn is_closed(&self) -> bool {
        self.vertices.first() == self.vertices.last()
    }
}

impl Chains {
    /// Strings the links to be kept together. Chains end at junctions; a closed chain without a junction starts at an
    /// outermost vertex.
    pub fn trace(vertices: &[Point], links: &[[u32; 2]], class: &[u32], keep: &[bool]) -> Chains {
        // Kept links by vertex.
        let kept = || (0..links.len()).filter(|&k| keep[k] && links[k][0] != links[k][1]);
        let mut start = vec![0u32; vertices.len() + 1];
        for k in kept() {
            for v in links[k] {
                start[v as usize + 1] += 1;
            }
        }
        for v in 0..vertices.len() {
            start[v + 1] += start[v];
        }
        let mut place = start.clone();
        let mut at = vec![0u32; 2 * kept().count()];
        for k in kept() {
            for v in links[k] {
                at[place[v as usize] as usize] = k as u32;
                place[v as usize] += 1;
            }
        }
        let about = |v: u32| &at[start[v as usize] as usize..start[v as usize + 1] as usize];
        // The other link where a chain passes.
        let onward = |v: u32, link: u32| match *about(v) {
            [a, b] if class[a as usize] == class[b as usize] => Some(if a == link { b } else { a }),
            _ => None,
        };

        let mut chains = Chains { starts: vec![0], ..Chains::default() };
        let mut seen = vec![false; links.len()];
        let string = |chains: &mut Chains, seen: &mut [bool], mut v: u32, mut link: u32| {
            chains.vertices.push(v);
            loop {
                seen[link as usize] = true;
                let [a, b] = links[link as usize];
                chains.links.push(Step { link, forward: a == v });
                v = if a == v { b } else { a };
                chains.vertices.push(v);
                match onward(v, link) {
                    Some(next) if !seen[next as usize] => link = next,
                    _ => break,
                }
            }
            chains.starts.push(chains.links.len() as u32);
        };
        for v in 0..vertices.len() as u32 {
            for &link in about(v) {
                if !seen[link as usize] && onward(v, link).is_none() {
                    string(&mut chains, &mut seen, v, link);
                }
            }
        }
        for link in kept() {
            if !seen[link] {
                string(&mut chains, &mut seen, links[link][0], link as u32);
                chains.turn_last(vertices);
            }
        }
        chains
    }

    /// Lets the last chain, which is closed, start at its vertex farthest from the one where it starts.
    fn turn_last(&mut self, vertices: &[Point]) {
        let from = self.starts[self.starts.len() - 2] as usize;
        let own = from + self.starts.len() - 2;
        let chain = &mut self.vertices[own..];
        let last = chain.len() - 1;
        let first = farthest_from(vertices, chain, 0);
        chain[..last].rotate_left(first);
        chain[last] = chain[0];
        self.links[from..].rotate_left(first);
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn get(&self, k: usize) -> Chain<'_> {
        let (from, to) = (self.starts[k] as usize, self.starts[k + 1] as usize);
        Chain { vertices: &self.vertices[from + k..=to + k], links: &self.links[from..to] }
    }

    pub fn iter(&self) -> impl Iterator<Item = Chain<'_>> {
        (0..self.len()).map(|k| self.get(k))
    }
}

/// The place in `chain` of the first vertex that is farthest from the one at place `from`.
pub(super) fn farthest_from(vertices: &[Point], chain: &[u32], from: usize) -> usize {
    let at = |k: usize| vertices[chain[k] as usize];
    let mut farthest = (0, from);
    for k in 0..chain.len() {
        let square = squared(at(from), at(k));
        if square > farthest.0 {
            farthest = (square, k);
        }
    }
    farthest.1
}

/// The squared distance.
pub(super) fn squared(a: Point, b: Point) -> i64 {
    let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
    dx * dx + dy * dy
}
