//! Faces and volumes to start from.

use super::dart::{Dart, GMap};

impl GMap {
    /// Adds a closed face of `sides` edges, one side of it: 2 darts for each edge. The first dart is at the start of the first
    /// edge; alpha 0 then alpha 1 leads from edge to edge. [`Dart::index`] counts on: start and end of the first edge,
    /// start and end of the second...
    ///
    /// # Panics
    /// If there would be too many darts, or `sides` is 0.
    pub fn add_face(&mut self, sides: usize) -> Dart {
        assert!(sides > 0, "a face has edges");
        let first = self.add_dart();
        let mut start = first;
        for side in 0..sides {
            let end = self.add_dart();
            self.link(0, start, end);
            if side + 1 == sides {
                self.link(1, end, first);
            } else {
                let next = self.add_dart();
                self.link(1, end, next);
                start = next;
            }
        }
        first
    }

    /// Adds a prism over a footprint of `sides` edges: two faces of `sides` edges, and four-sided ones between them. Returns
    /// the first dart of the lower face, then those of the sides' at their lower edges' starts, then that of the upper face at
    /// its edge over the lower face's first.
    ///
    /// # Panics
    /// As [`GMap::add_face`].
    pub fn add_prism(&mut self, sides: usize) -> Vec<Dart> {
        let lower = self.add_face(sides);
        let walls: Vec<Dart> = (0..sides).map(|_| self.add_face(4)).collect();
        let upper = self.add_face(sides);
        let (mut low, mut high) = (lower, upper);
        for k in 0..sides {
            let wall = walls[k];
            let next = walls[(k + 1) % sides];
            let below = [low, self.alpha(0, low)];
            let bottom = [wall, self.alpha(0, wall)];
            let above = [high, self.alpha(0, high)];
            // Around a wall: its lower edge from start to end, up, back along the upper edge, down.
            let top = [self.walk(wall, &[1, 0, 1]), self.walk(wall, &[0, 1, 0, 1])];
            for end in 0..2 {
                self.link(2, below[end], bottom[end]);
                self.link(2, above[end], top[end]);
            }
            let rising = [self.walk(wall, &[0, 1]), self.walk(wall, &[0, 1, 0])];
            let beside = [self.alpha(1, next), self.walk(next, &[1, 0])];
            self.link(2, rising[0], beside[0]);
            self.link(2, rising[1], beside[1]);
            low = self.walk(low, &[0, 1]);
            high = self.walk(high, &[0, 1]);
        }
        [vec![lower], walls, vec![upper]].concat()
    }
}
