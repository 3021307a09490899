//! Removing cells, which merges those on their two sides, and inserting them, which splits: after Damiand and Lienhardt,
//! "Combinatorial Maps" (2014), chapter 6. Both keep the map valid.

use std::collections::{HashMap, HashSet};

use super::dart::{Dart, GMap};
use super::orbit::Orbit;

/// Why a cell cannot be removed or inserted. The map is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A dart is not of this map.
    #[error("{0} is not of this map")]
    Unknown(Dart),
    /// Only vertices, edges and faces can be removed.
    #[error("cells of dimension {0} cannot be removed: only vertices, edges and faces")]
    Dimension(usize),
    /// More than two cells meet at the one to be removed: at `dart`, alpha `first` and `second` do not commute.
    #[error("at {dart} alpha {first} and alpha {second} do not commute: more than two cells meet there")]
    Crowded {
        /// Where.
        dart: Dart,
        /// One involution.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A dart of the cell is free where it must not be.
    #[error("{dart} is free by alpha {involution}")]
    Free {
        /// The dart.
        dart: Dart,
        /// The involution.
        involution: usize,
    },
    /// The two darts are not two corners of one face.
    #[error("{0} and {1} are not at two corners of one face")]
    NotCorners(Dart, Dart),
    /// From the end of the first dart's edge the second is not reached on its side of the path.
    #[error("the path does not go on from {0} to {1}")]
    NotAPath(Dart, Dart),
    /// The path comes by an edge again.
    #[error("the path comes by the edge of {0} twice")]
    Twice(Dart),
    /// The path is empty.
    #[error("a face needs a path of edges around it")]
    NoPath,
}

impl GMap {
    /// Removes the cell of dimension `i` (0 a vertex, 1 an edge, 2 a face) that `dart` is of. What lies on its two sides
    /// becomes one: two edges, two faces, two volumes. Returns how many darts are gone.
    ///
    /// No more than two edges may meet at the vertex, and no more than two faces at the edge, of all volumes together; a face
    /// can always be removed. Where both sides are one cell already, as on both sides of a face within a volume, what is left
    /// may have a hole or fall in two.
    ///
    /// # Errors
    /// [`EditError`].
    pub fn remove(&mut self, i: usize, dart: Dart) -> Result<usize, EditError> {
        if i > 2 {
            return Err(EditError::Dimension(i));
        }
        self.known(&[dart])?;
        let cell = self.orbit(Orbit::CELLS[i], dart);
        if i < 2 {
            let (first, second) = (i + 1, i + 2);
            for &dart in &cell {
                if self.walk(dart, &[first, second]) != self.walk(dart, &[second, first]) {
                    return Err(EditError::Crowded { dart, first, second });
                }
            }
        }
        let inside: HashSet<Dart> = cell.iter().copied().collect();
        // Beyond the cell by alpha i, and what alpha i will lead to from there.
        let mut links = Vec::new();
        for &dart in &cell {
            let outside = self.alpha(i, dart);
            if inside.contains(&outside) {
                continue;
            }
            let mut other = dart;
            while inside.contains(&other) {
                other = self.walk(other, &[i + 1, i]);
            }
            links.push([outside, other]);
        }
        for &dart in &cell {
            self.take_out(dart);
        }
        for [a, b] in links {
            self.link(i, a, b);
        }
        Ok(cell.len())
    }

    /// Puts a vertex on the edge of `dart`, which becomes two. Returns the new dart on the side of `dart`: alpha 0 of it.
    ///
    /// # Errors
    /// [`EditError::Free`] if an end of the edge is missing, [`EditError::Unknown`].
    pub fn insert_vertex(&mut self, dart: Dart) -> Result<Dart, EditError> {
        self.known(&[dart])?;
        let edge = self.orbit(Orbit::Edge, dart);
        if let Some(&dart) = edge.iter().find(|&&d| self.is_free(0, d)) {
            return Err(EditError::Free { dart, involution: 0 });
        }
        let new: HashMap<Dart, Dart> = edge.iter().map(|&old| (old, self.add_dart())).collect();
        let across: Vec<[Dart; 2]> = edge.iter().map(|&old| [old, self.alpha(0, old)]).collect();
        for [old, other] in across {
            self.link(1, new[&old], new[&other]);
            for i in [2, 3] {
                if !self.is_free(i, old) {
                    self.link(i, new[&old], new[&self.alpha(i, old)]);
                }
            }
            self.link(0, old, new[&old]);
        }
        Ok(new[&dart])
    }

    /// Puts an edge across a face, between the corners at `a` and `b`, which must lie on one side of it. The face becomes two.
    /// Returns the new dart at `a`'s corner, on `a`'s side of the new edge: alpha 1 of it.
    ///
    /// # Errors
    /// [`EditError::NotCorners`], [`EditError::Free`] if the face is open between the corners, [`EditError::Unknown`].
    pub fn insert_edge(&mut self, a: Dart, b: Dart) -> Result<Dart, EditError> {
        self.known(&[a, b])?;
        let free = |dart: &Dart| self.is_free(1, *dart);
        if let Some(dart) = [a, b].into_iter().find(free) {
            return Err(EditError::Free { dart, involution: 1 });
        }
        // From a's edge on around the face: b's corner is met from one of its two sides.
        let mut here = a;
        let near_b = loop {
            let end = self.alpha(0, here);
            let beyond = self.alpha(1, end);
            for (from, to, involution) in [(here, end, 0), (end, beyond, 1)] {
                if from == to {
                    return Err(EditError::Free { dart: from, involution });
                }
            }
            if beyond == a {
                return Err(EditError::NotCorners(a, b));
            }
            if end == b || beyond == b {
                break end;
            }
            here = beyond;
        };
        let sides = if self.is_free(3, a) {
            vec![[a, near_b]]
        } else {
            vec![[a, near_b], [self.alpha(3, a), self.alpha(3, near_b)]]
        };
        let mut made: Vec<[Dart; 4]> = Vec::new();
        for [a, b] in sides {
            let (beyond_a, beyond_b) = (self.alpha(1, a), self.alpha(1, b));
            let [e, f, g, h] = std::array::from_fn(|_| self.add_dart());
            self.link(0, e, f);
            self.link(0, g, h);
            self.link(2, e, g);
            self.link(2, f, h);
            self.link(1, a, e);
            self.link(1, b, f);
            self.link(1, beyond_a, g);
            self.link(1, beyond_b, h);
            made.push([e, f, g, h]);
        }
        if let [one, two] = made[..] {
            one.into_iter().zip(two).for_each(|(a, b)| self.link(3, a, b));
        }
        Ok(made[0][0])
    }

    /// Puts a face into a volume, along a closed path of its edges, and so splits it. The path has one dart for each edge, at
    /// its start, all of one side: from the other end of each edge the next dart is reached through the faces of that side.
    /// Returns the new dart beside the first of the path: alpha 2 of it.
    ///
    /// # Errors
    /// [`EditError::NoPath`], [`EditError::NotAPath`], [`EditError::Twice`], [`EditError::Free`] if a face beside the path is
    /// missing or has an open edge, [`EditError::Unknown`].
    pub fn insert_face(&mut self, path: &[Dart]) -> Result<Dart, EditError> {
        self.known(path)?;
        let Some(&first) = path.first() else { return Err(EditError::NoPath) };
        let mut on_path = HashSet::new();
        for &dart in path {
            for d in [dart, self.alpha(0, dart)] {
                for i in [0, 2] {
                    if self.is_free(i, d) {
                        return Err(EditError::Free { dart: d, involution: i });
                    }
                }
                if !on_path.insert(d) || on_path.contains(&self.alpha(2, d)) {
                    return Err(EditError::Twice(d));
                }
            }
        }
        for (k, &dart) in path.iter().enumerate() {
            let next = path[(k + 1) % path.len()];
            let mut here = self.walk(dart, &[0, 1]);
            while here != next {
                let beyond = self.alpha(2, here);
                // Around the vertex, as far as the path's next edge, or all around and back to this one.
                if on_path.contains(&here)
                    || on_path.contains(&beyond)
                    || beyond == here
                    || self.is_free(1, beyond)
                {
                    return Err(EditError::NotAPath(dart, next));
                }
                here = self.alpha(1, beyond);
            }
        }
        // Two new darts for each end of each edge: beside the path's side, and beside the other.
        let ends: Vec<[Dart; 2]> = path.iter().map(|&dart| [dart, self.alpha(0, dart)]).collect();
        let mut made: Vec<[[Dart; 2]; 2]> = Vec::with_capacity(path.len());
        for &[start, end] in &ends {
            let near = [self.add_dart(), self.add_dart()];
            let far = [self.add_dart(), self.add_dart()];
            for (k, dart) in [start, end].into_iter().enumerate() {
                let beyond = self.alpha(2, dart);
                self.link(3, near[k], far[k]);
                self.link(2, dart, near[k]);
                self.link(2, beyond, far[k]);
            }
            self.link(0, near[0], near[1]);
            self.link(0, far[0], far[1]);
            made.push([near, far]);
        }
        for k in 0..made.len() {
            let next = (k + 1) % made.len();
            for side in 0..2 {
                let (end, start) = (made[k][side][1], made[next][side][0]);
                self.link(1, end, start);
            }
        }
        Ok(self.alpha(2, first))
    }

    fn known(&self, darts: &[Dart]) -> Result<(), EditError> {
        match darts.iter().find(|dart| !self.contains(**dart)) {
            Some(&dart) => Err(EditError::Unknown(dart)),
            None => Ok(()),
        }
    }
}
