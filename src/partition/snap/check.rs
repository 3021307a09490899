//! The exact proof that links meet only at common ends.

use super::{Budget, SnapError, Snapped, Span, pairs};
use crate::lattice::{Point, is_between, orient};

/// What is wrong with links.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Flaw {
    /// Vertices are not in strictly ascending order from here.
    #[error("vertices are out of order at {0}")]
    Vertices(usize),
    /// Links are not in strictly ascending order from here, or do not name two vertices, the smaller first.
    #[error("links are out of order at {0}")]
    Links(usize),
    /// Two links meet elsewhere than at a common end.
    #[error("links {0} and {1} meet")]
    Meet(u32, u32),
    /// A vertex lies on a link.
    #[error("vertex {vertex} lies on link {link}")]
    OnLink {
        /// The vertex, which no link ends at.
        vertex: u32,
        /// The link.
        link: u32,
    },
}

impl Snapped {
    /// Proves, in integers, that vertices and links are in order, that no two links meet but at common ends, and that no
    /// vertex lies on a link. Takes about as long as finding the crossings did.
    ///
    /// # Errors
    ///
    /// With the first flaw found.
    pub fn check(&self) -> Result<(), Flaw> {
        if let Some(i) = self.vertices.windows(2).position(|w| w[0] >= w[1]) {
            return Err(Flaw::Vertices(i + 1));
        }
        let count = self.vertices.len();
        let good = |&[u, v]: &[u32; 2]| u < v && (v as usize) < count;
        if let Some(i) = self.links.iter().position(|link| !good(link)) {
            return Err(Flaw::Links(i));
        }
        if let Some(i) = self.links.windows(2).position(|w| w[0] >= w[1]) {
            return Err(Flaw::Links(i + 1));
        }
        let mut spans: Vec<Span> =
            self.links.iter().map(|link| link.map(|v| self.vertices[v as usize])).collect();
        let lone = self.lone();
        spans.extend(lone.iter().map(|&v| [self.vertices[v as usize]; 2]));
        let links = self.links.len() as u32;
        let mut flaw = None;
        // The error only ends the search: there is no limit.
        let _ = pairs::visit(&spans, &mut Budget::unlimited(), |_, s, t| {
            if !meet(&spans[s as usize], &spans[t as usize]) {
                return Ok(());
            }
            let (first, last) = (s.min(t), s.max(t));
            flaw = Some(match last.checked_sub(links) {
                Some(i) => Flaw::OnLink { vertex: lone[i as usize], link: first },
                None => Flaw::Meet(first, last),
            });
            Err(SnapError::Tests(0))
        });
        flaw.map_or(Ok(()), Err)
    }

    /// Vertices at which no link ends.
    fn lone(&self) -> Vec<u32> {
        let mut ended = vec![false; self.vertices.len()];
        for &v in self.links.iter().flatten() {
            ended[v as usize] = true;
        }
        (0..self.vertices.len() as u32).filter(|&v| !ended[v as usize]).collect()
    }
}

/// Whether two different segments, of which one may be a point, meet elsewhere than at a common end.
fn meet(&[a, b]: &Span, &[c, d]: &Span) -> bool {
    if pairs::are_apart(&[a, b], &[c, d]) {
        return false;
    }
    let (from, to) = (orient(a, b, c), orient(a, b, d));
    if from > 0 && to > 0 || from < 0 && to < 0 {
        return false;
    }
    let (left, right) = (orient(c, d, a), orient(c, d, b));
    if left > 0 && right > 0 || left < 0 && right < 0 {
        return false;
    }
    if from != 0 && to != 0 && left != 0 && right != 0 {
        return true;
    }
    // An end of one lies on the other's line. They meet at that end or, on one line, also at another.
    let inside = |a: Point, b: Point, p: Point, side: i64| side == 0 && is_between(a, b, p);
    inside(a, b, c, from) || inside(a, b, d, to) || inside(c, d, a, left) || inside(c, d, b, right)
}
