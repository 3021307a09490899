//! What hangs together by some of the involutions: cells, and parts of cells.

use super::dart::{Dart, GMap};
use super::marks::Marks;

/// Which darts belong together: those that the named involutions lead to from one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Orbit {
    /// A vertex: alpha 1, 2, 3.
    Vertex,
    /// An edge: alpha 0, 2, 3.
    Edge,
    /// A face, both sides of it: alpha 0, 1, 3.
    Face,
    /// A volume: alpha 0, 1, 2.
    Volume,
    /// All that hangs together.
    Component,
    /// A face as one volume has it: alpha 0, 1.
    HalfFace,
    /// A vertex as one volume has it: alpha 1, 2.
    VertexOfVolume,
    /// An edge as one volume has it: alpha 0, 2.
    EdgeOfVolume,
    /// An edge as one face has it, both sides: alpha 0, 3.
    EdgeOfFace,
}

impl Orbit {
    /// The cells of dimension 0 to 3.
    pub const CELLS: [Orbit; 4] = [Orbit::Vertex, Orbit::Edge, Orbit::Face, Orbit::Volume];

    /// The involutions.
    pub const fn involutions(self) -> &'static [usize] {
        match self {
            Orbit::Vertex => &[1, 2, 3],
            Orbit::Edge => &[0, 2, 3],
            Orbit::Face => &[0, 1, 3],
            Orbit::Volume => &[0, 1, 2],
            Orbit::Component => &[0, 1, 2, 3],
            Orbit::HalfFace => &[0, 1],
            Orbit::VertexOfVolume => &[1, 2],
            Orbit::EdgeOfVolume => &[0, 2],
            Orbit::EdgeOfFace => &[0, 3],
        }
    }
}

/// The cells of one kind, numbered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellIndex {
    /// By dart: the number of its cell; [`CellIndex::NONE`] for darts that were removed.
    of: Vec<u32>,
    /// By cell: its lowest dart. Ascending.
    first: Vec<Dart>,
}

impl CellIndex {
    /// What stands for no cell.
    pub const NONE: u32 = u32::MAX;

    /// The number of a dart's cell.
    ///
    /// # Panics
    /// If the map had no such dart when it was numbered; what was removed before has the number [`CellIndex::NONE`].
    pub fn of(&self, dart: Dart) -> u32 {
        self.of[dart.index()]
    }

    /// The lowest dart of each cell.
    pub fn darts(&self) -> &[Dart] {
        &self.first
    }

    /// How many cells there are.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }
}

impl GMap {
    /// The darts of an orbit, `dart` first. Marks all of them; those that are marked already, and what only they lead
    /// to, are left out: with one set of marks each of many orbits is walked once.
    ///
    /// # Panics
    /// If the map never had such a dart.
    pub fn orbit_once<'a>(
        &'a self,
        orbit: Orbit,
        dart: Dart,
        marks: &'a mut Marks,
    ) -> impl Iterator<Item = Dart> + 'a {
        let involutions = orbit.involutions();
        let mut waiting = Vec::new();
        if marks.insert(dart) {
            waiting.push(dart);
        }
        std::iter::from_fn(move || {
            let dart = waiting.pop()?;
            for &i in involutions {
                let next = self.alpha(i, dart);
                if marks.insert(next) {
                    waiting.push(next);
                }
            }
            Some(dart)
        })
    }

    /// The darts of an orbit, `dart` first. Takes time and memory by the size of the orbit, not of the map.
    ///
    /// # Panics
    /// If the map never had such a dart.
    pub fn orbit(&self, orbit: Orbit, dart: Dart) -> Vec<Dart> {
        let mut seen = std::collections::HashSet::from([dart]);
        let mut all = vec![dart];
        let mut next = 0;
        while let Some(&dart) = all.get(next) {
            for &i in orbit.involutions() {
                let other = self.alpha(i, dart);
                if seen.insert(other) {
                    all.push(other);
                }
            }
            next += 1;
        }
        all
    }

    /// Numbers all orbits of one kind, in the order of their lowest darts.
    pub fn index(&self, orbit: Orbit) -> CellIndex {
        let mut index = CellIndex { of: vec![CellIndex::NONE; self.table_len()], first: Vec::new() };
        let mut waiting = Vec::new();
        for dart in self.darts() {
            if index.of[dart.index()] != CellIndex::NONE {
                continue;
            }
            let cell = index.first.len() as u32;
            index.first.push(dart);
            index.of[dart.index()] = cell;
            waiting.push(dart);
            while let Some(dart) = waiting.pop() {
                for &i in orbit.involutions() {
                    let next = self.alpha(i, dart);
                    if index.of[next.index()] == CellIndex::NONE {
                        index.of[next.index()] = cell;
                        waiting.push(next);
                    }
                }
            }
        }
        index
    }

    /// How many orbits of one kind there are.
    pub fn count(&self, orbit: Orbit) -> usize {
        self.index(orbit).len()
    }

    /// The darts of a face around it as one volume has it, `dart` first, every other one: the first ends of its edges
    /// in turn. Stops where alpha 0 or 1 is free.
    ///
    /// # Panics
    /// If the map never had such a dart.
    pub fn around_face(&self, dart: Dart) -> impl Iterator<Item = Dart> + '_ {
        let mut next = Some(dart);
        std::iter::from_fn(move || {
            let here = next?;
            let end = self.alpha(0, here);
            let after = self.alpha(1, end);
            next = (end != here && after != end && after != dart).then_some(after);
            Some(here)
        })
    }
}
