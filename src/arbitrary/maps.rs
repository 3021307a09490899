//! Generalized maps by whatever is done to one.

use proptest::prelude::*;

use crate::gmap::{Dart, GMap};

/// What is done to a map. Numbers become its darts, round and round; involutions and dimensions are what they say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// [`GMap::add_prism`] of so many sides.
    Prism(usize),
    /// [`GMap::sew`] by an involution.
    Sew(usize, usize, usize),
    /// [`GMap::unsew`] by an involution.
    Unsew(usize, usize),
    /// [`GMap::remove`] of a vertex, edge or face: 0 to 2.
    Remove(usize, usize),
    /// [`GMap::insert_vertex`].
    Vertex(usize),
    /// [`GMap::insert_edge`].
    Edge(usize, usize),
    /// [`GMap::insert_face`] along a path around two faces with an edge in common.
    Face(usize),
}

/// What came of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The map is as it was.
    Refused,
    /// It is another.
    Done,
    /// Something was inserted, of this dimension, at this dart: [`GMap::remove`] takes it out again.
    Inserted(usize, Dart),
}

impl Step {
    /// Does it to `map`, which has darts.
    ///
    /// # Panics
    /// If `map` has no dart.
    pub fn apply(self, map: &mut GMap) -> Outcome {
        let all: Vec<Dart> = map.darts().collect();
        assert!(!all.is_empty(), "a step needs a dart to be done at");
        let pick = |number: usize| all[number % all.len()];
        let done = |is_done: bool| if is_done { Outcome::Done } else { Outcome::Refused };
        let inserted =
            |i: usize, at: Option<Dart>| at.map_or(Outcome::Refused, |dart| Outcome::Inserted(i, dart));
        match self {
            Step::Prism(sides) => {
                map.add_prism(sides);
                Outcome::Done
            }
            Step::Sew(i, a, b) => done(map.sew(i, pick(a), pick(b)).is_ok()),
            Step::Unsew(i, dart) => done(map.unsew(i, pick(dart)).is_ok()),
            Step::Remove(i, dart) => done(map.remove(i, pick(dart)).is_ok()),
            Step::Vertex(dart) => inserted(0, map.insert_vertex(pick(dart)).ok()),
            Step::Edge(a, b) => inserted(1, map.insert_edge(pick(a), pick(b)).ok()),
            Step::Face(dart) => {
                let path = path_around(map, pick(dart));
                inserted(2, map.insert_face(&path).ok())
            }
        }
    }
}

/// One step.
pub fn steps() -> impl Strategy<Value = Step> {
    let dart = 0usize..1 << 20;
    prop_oneof![
        2 => (3usize..6).prop_map(Step::Prism),
        3 => (dart.clone(), dart.clone()).prop_map(|(a, b)| Step::Sew(3, a, b)),
        2 => (0usize..3, dart.clone(), dart.clone()).prop_map(|(i, a, b)| Step::Sew(i, a, b)),
        1 => (0usize..4, dart.clone()).prop_map(|(i, d)| Step::Unsew(i, d)),
        3 => (0usize..3, dart.clone()).prop_map(|(i, d)| Step::Remove(i, d)),
        2 => dart.clone().prop_map(Step::Vertex),
        2 => (dart.clone(), dart.clone()).prop_map(|(a, b)| Step::Edge(a, b)),
        2 => dart.prop_map(Step::Face),
    ]
}

/// Valid maps: a box, and what up to forty [`steps`] make of it. It may have come apart, be open, or be gone.
pub fn maps() -> impl Strategy<Value = GMap> {
    prop::collection::vec(steps(), 0..40).prop_map(|steps| {
        let mut map = GMap::new();
        map.add_prism(4);
        for step in steps {
            if map.is_empty() {
                break;
            }
            step.apply(&mut map);
        }
        map
    })
}

/// A closed path around two faces that have an edge in common, or, where there is no second one, around one.
fn path_around(map: &GMap, dart: Dart) -> Vec<Dart> {
    let beyond = map.alpha(2, dart);
    let other: Vec<Dart> = map.around_face(map.alpha(0, beyond)).skip(1).collect();
    let own: Vec<Dart> = map.around_face(dart).collect();
    if beyond == dart || own.contains(&map.alpha(0, beyond)) || other.is_empty() {
        return own;
    }
    // From the far end of the common edge around the one, then around the other.
    own.into_iter().skip(1).chain(other).collect()
}
