//! A map without what depends on how its faces were cut into pieces.

use std::collections::{BTreeMap, HashMap};

use enfilade::gmap::{Dart, GMap, Orbit};

/// A map whose volumes have numbers.
pub struct Outline {
    map: GMap,
    /// By dart: the number of its volume.
    number: Vec<u32>,
}

/// A side of the box, or that opposite to it: no convex volume has an edge between two such.
#[derive(Clone, Copy, Debug)]
pub enum Side {
    AcrossX,
    AcrossY,
    Below,
    Above,
}

impl Side {
    /// That on which a face lies that is neither below nor above: of one x or of one y.
    pub fn upright(corners: impl Iterator<Item = [f64; 3]> + Clone) -> Side {
        let spread = |axis: usize| {
            let along = corners.clone().map(|p| p[axis]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        };
        if spread(0) < spread(1) { Side::AcrossX } else { Side::AcrossY }
    }
}

/// What a face is between, the lesser first.
type Between = [i64; 2];

impl Outline {
    /// Of a map of convex volumes in a box: faces between the same two volumes, or between a volume and the same side of the box, become
    /// one, and edges between the same faces. `number` is that of a dart's volume, `side` that of the side of the box on which a free face
    /// lies, told by the darts at its corners.
    pub fn of(mut map: GMap, number: impl Fn(Dart) -> u32, side: impl Fn(&[Dart]) -> Side) -> Outline {
        let darts: Vec<Dart> = map.darts().collect();
        let numbers: Vec<u32> = darts.iter().map(|&dart| number(dart)).collect();
        let mut between: Vec<Option<Between>> = vec![None; map.table_len()];
        for &first in &darts {
            if between[first.index()].is_none() {
                let beyond = map.alpha(3, first);
                let other = if beyond == first {
                    -1 - side(&map.around_face(first).collect::<Vec<Dart>>()) as i64
                } else {
                    i64::from(number(beyond))
                };
                let own = i64::from(number(first));
                for dart in map.orbit(Orbit::HalfFace, first) {
                    between[dart.index()] = Some([own.min(other), own.max(other)]);
                }
            }
        }
        for &dart in &darts {
            if map.contains(dart) && between[dart.index()] == between[map.alpha(2, dart).index()] {
                // More than two faces meet at some, which stay.
                let _ = map.remove(1, dart);
            }
        }
        for &dart in &darts {
            if map.contains(dart) {
                // The same of edges.
                let _ = map.remove(0, dart);
            }
        }
        Outline { map, number: numbers }
    }

    /// The darts of each volume.
    fn volumes(&self) -> BTreeMap<u32, Vec<Dart>> {
        let mut volumes = BTreeMap::<u32, Vec<Dart>>::new();
        for dart in self.map.darts() {
            volumes.entry(self.number[dart.index()]).or_default().push(dart);
        }
        volumes
    }

    /// Whether a bijection of the darts keeps all involutions and the volumes' numbers.
    ///
    /// # Errors
    /// What is different, in words.
    pub fn is_isomorphic(&self, other: &Outline) -> Result<(), String> {
        let (own, there) = (self.volumes(), other.volumes());
        let counts = |volumes: &BTreeMap<u32, Vec<Dart>>| -> Vec<(u32, usize)> {
            volumes.iter().map(|(number, darts)| (*number, darts.len())).collect()
        };
        if let Some((a, b)) = counts(&own).into_iter().zip(counts(&there)).find(|(a, b)| a != b) {
            return Err(format!("(volume, darts) {a:?} is {b:?}"));
        }
        if own.len() != there.len() {
            return Err(format!("{} volumes are {}", own.len(), there.len()));
        }
        let Some((first, darts)) = own.iter().min_by_key(|(_, darts)| darts.len()) else { return Ok(()) };
        if there[first].iter().any(|&to| self.is_same_from(darts[0], other, to)) {
            return Ok(());
        }
        Err("no bijection keeps all involutions".to_owned())
    }

    fn is_same_from(&self, one: Dart, other: &Outline, to: Dart) -> bool {
        let (mut known, mut back) = (HashMap::from([(one, to)]), HashMap::from([(to, one)]));
        let mut waiting = vec![(one, to)];
        while let Some((a, b)) = waiting.pop() {
            if self.number[a.index()] != other.number[b.index()] {
                return false;
            }
            for i in 0..4 {
                let (a, b) = (self.map.alpha(i, a), other.map.alpha(i, b));
                match (known.get(&a), back.get(&b)) {
                    (None, None) => {
                        known.insert(a, b);
                        back.insert(b, a);
                        waiting.push((a, b));
                    }
                    (Some(&to), Some(&from)) if to == b && from == a => {}
                    _ => return false,
                }
            }
        }
        known.len() == self.map.len()
    }
}
