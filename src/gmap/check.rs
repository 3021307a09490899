//! Whether a map is one, and what its cells are like.

use super::dart::{Dart, GMap};
use super::marks::Marks;
use super::orbit::Orbit;
use crate::parallel;

/// What is wrong with a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Defect {
    /// An involution is none: twice by it does not lead back.
    #[error("{dart}: alpha {involution} leads to {to}, and from there to {back}")]
    NotAnInvolution {
        /// From where.
        dart: Dart,
        /// Which.
        involution: usize,
        /// Where it leads.
        to: Dart,
        /// Where it leads from there.
        back: Dart,
    },
    /// What is glued is not glued along a whole cell: alpha `first` alpha `second` is no involution there.
    #[error("{dart}: alpha {first} alpha {second} twice leads to {back}")]
    NotGlued {
        /// From where.
        dart: Dart,
        /// The first involution.
        first: usize,
        /// The second.
        second: usize,
        /// Where the two lead, taken twice.
        back: Dart,
    },
}

/// What the surface of a volume is like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Its vertices.
    pub vertices: usize,
    /// Its edges.
    pub edges: usize,
    /// Its faces.
    pub faces: usize,
    /// Whether no dart of it is free by alpha 0, 1 or 2.
    pub is_closed: bool,
    /// Whether its surface has two sides.
    pub is_orientable: bool,
}

impl Shape {
    /// Vertices less edges plus faces: 2 for a sphere, 0 for a torus.
    pub const fn euler(&self) -> i64 {
        self.vertices as i64 - self.edges as i64 + self.faces as i64
    }

    /// Whether the surface is a sphere, so that the volume is a ball.
    pub const fn is_ball(&self) -> bool {
        self.is_closed && self.is_orientable && self.euler() == 2
    }
}

impl Defect {
    /// The dart at which something is wrong.
    pub fn dart(&self) -> Dart {
        match *self {
            Defect::NotAnInvolution { dart, .. } | Defect::NotGlued { dart, .. } => dart,
        }
    }
}

/// Products that must be involutions.
const PRODUCTS: [[usize; 2]; 3] = [[0, 2], [0, 3], [1, 3]];

impl GMap {
    /// Whether all four alphas are involutions, and the products that must be.
    ///
    /// # Errors
    /// The defect at the lowest dart.
    pub fn check(&self) -> Result<(), Defect> {
        self.defects().next().map_or(Ok(()), Err)
    }

    /// All that is wrong, in the order of the darts.
    pub fn defects(&self) -> impl Iterator<Item = Defect> + '_ {
        self.darts().flat_map(|dart| self.defects_at(dart))
    }

    fn defects_at(&self, dart: Dart) -> impl Iterator<Item = Defect> + '_ {
        let alone = (0..4).filter_map(move |involution| {
            let to = self.alpha(involution, dart);
            let back = self.alpha(involution, to);
            (back != dart).then_some(Defect::NotAnInvolution { dart, involution, to, back })
        });
        let products = PRODUCTS.into_iter().filter_map(move |[first, second]| {
            let back = self.walk(dart, &[first, second, first, second]);
            (back != dart).then_some(Defect::NotGlued { dart, first, second, back })
        });
        alone.chain(products)
    }

    /// The darts that are free by alpha `i`, ascending: where something is open.
    ///
    /// # Panics
    /// If `i` is over 3.
    pub fn free(&self, i: usize) -> impl Iterator<Item = Dart> + '_ {
        self.darts().filter(move |&dart| self.is_free(i, dart))
    }

    /// One of the two senses of rotation of what hangs together with `dart` by an orbit's involutions: of every two darts
    /// that one of them links, one is in the set. `None` if there is no such set: the thing is not orientable.
    ///
    /// # Panics
    /// If the map never had such a dart.
    pub fn orientation(&self, orbit: Orbit, dart: Dart) -> Option<Marks> {
        let (mut even, mut odd) = (Marks::new(self), Marks::new(self));
        self.colour(orbit, dart, &mut even, &mut odd).then_some(even)
    }

    /// Whether the orbit has two sides. Adds its darts to one of the sets each.
    fn colour(&self, orbit: Orbit, dart: Dart, even: &mut Marks, odd: &mut Marks) -> bool {
        even.insert(dart);
        let mut waiting = vec![(dart, false)];
        while let Some((dart, is_odd)) = waiting.pop() {
            for &i in orbit.involutions() {
                let next = self.alpha(i, dart);
                if next == dart {
                    continue;
                }
                let (own, other) = if is_odd { (&*odd, &mut *even) } else { (&*even, &mut *odd) };
                if own.contains(next) {
                    return false;
                }
                if other.insert(next) {
                    waiting.push((next, !is_odd));
                }
            }
        }
        true
    }

    /// What the surface of the volume of `dart` is like.
    ///
    /// # Panics
    /// If the map never had such a dart.
    pub fn shape(&self, dart: Dart) -> Shape {
        let darts = self.orbit(Orbit::Volume, dart);
        let count = |orbit: Orbit| {
            let mut seen = std::collections::HashSet::with_capacity(darts.len());
            let mut count = 0;
            for &dart in &darts {
                if seen.insert(dart) {
                    count += 1;
                    seen.extend(self.orbit(orbit, dart));
                }
            }
            count
        };
        // Small volumes of a large map must not cost its size.
        let mut side = std::collections::HashMap::with_capacity(darts.len());
        let mut is_orientable = true;
        let mut waiting = vec![dart];
        side.insert(dart, false);
        while let Some(dart) = waiting.pop() {
            let own = side[&dart];
            for i in 0..3 {
                let next = self.alpha(i, dart);
                match side.get(&next) {
                    _ if next == dart => {}
                    Some(&other) => is_orientable &= other != own,
                    None => {
                        side.insert(next, !own);
                        waiting.push(next);
                    }
                }
            }
        }
        Shape {
            vertices: count(Orbit::VertexOfVolume),
            edges: count(Orbit::EdgeOfVolume),
            faces: count(Orbit::HalfFace),
            is_closed: darts.iter().all(|&dart| (0..3).all(|i| !self.is_free(i, dart))),
            is_orientable,
        }
    }

    /// The shapes of all volumes, each with its lowest dart: in time by the size of the map.
    pub fn shapes(&self) -> Vec<(Dart, Shape)> {
        let orbits = [Orbit::VertexOfVolume, Orbit::EdgeOfVolume, Orbit::HalfFace, Orbit::Volume];
        let cells = parallel::map(orbits.len(), |i| self.index(orbits[i]));
        let volumes = &cells[3];
        let whole = Shape { vertices: 0, edges: 0, faces: 0, is_closed: true, is_orientable: true };
        let mut shapes: Vec<(Dart, Shape)> = volumes.darts().iter().map(|&dart| (dart, whole)).collect();
        for (orbit, cells) in orbits.into_iter().zip(&cells[..3]) {
            for &dart in cells.darts() {
                let shape = &mut shapes[volumes.of(dart) as usize].1;
                *match orbit {
                    Orbit::VertexOfVolume => &mut shape.vertices,
                    Orbit::EdgeOfVolume => &mut shape.edges,
                    _ => &mut shape.faces,
                } += 1;
            }
        }
        for dart in self.darts() {
            shapes[volumes.of(dart) as usize].1.is_closed &= (0..3).all(|i| !self.is_free(i, dart));
        }
        let (mut even, mut odd) = (Marks::new(self), Marks::new(self));
        for (dart, shape) in &mut shapes {
            shape.is_orientable = self.colour(Orbit::Volume, *dart, &mut even, &mut odd);
        }
        shapes
    }

    /// Vertices less edges plus faces less volumes of the whole map.
    pub fn euler(&self) -> i64 {
        let count = parallel::map(Orbit::CELLS.len(), |i| self.count(Orbit::CELLS[i]) as i64);
        count[0] - count[1] + count[2] - count[3]
    }
}
