//! From closed meshes that fit each other to a map: the same as from cells, for volumes whose faces were made for each other
//! by whoever made them, as in the paper's modeller.

use std::collections::BTreeMap;

use enfilade_importers::{Element, ElementId, MaterialId, Model};

use crate::gmap::{Dart, GMap};

/// The map of the elements of a model, each a volume of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumeMap {
    /// The map. Every triangle of every element is one side of a face.
    pub map: GMap,
    /// By dart: the element.
    pub element_of: Vec<ElementId>,
    /// By dart: the triangle, as index in the element's mesh.
    pub triangle_of: Vec<u32>,
    /// By dart: the place of its vertex, metres in the internal frame.
    pub point_of: Vec<[f64; 3]>,
}

/// Meshes that are no volumes, or do not fit each other.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VolumesError {
    /// An edge of an element has one triangle, or more than two of which not two and two are of one material.
    #[error("element {element}: the edge from {from:?} to {to:?} has {triangles} triangles")]
    Edge {
        /// Its path.
        element: String,
        /// One end, metres in the internal frame.
        from: [f64; 3],
        /// The other.
        to: [f64; 3],
        /// Of how many triangles it is an edge.
        triangles: usize,
    },
    /// Several triangles have the same corners, and do not face each other, or it is not clear which do.
    #[error("element {element}: the triangle at {at:?} is there {times} times")]
    Crowded {
        /// The path of one that has it.
        element: String,
        /// One of its corners, metres in the internal frame.
        at: [f64; 3],
        /// How often it is there.
        times: usize,
    },
}

/// A point by its bits.
type Key = [u64; 3];

fn key(p: [f64; 3]) -> Key {
    p.map(|c| (c + 0.0).to_bits())
}

/// Builds the map of a model whose elements are closed meshes: edges of one element with the same ends are linked by alpha 2,
/// triangles of two elements with the same corners by alpha 3. Points are the same if all their bits are.
///
/// Where four or six triangles of an element meet in an edge, those of one material are linked. Where an element has no height, two of
/// its triangles have the same corners, and each is linked to the one that faces it.
///
/// Such are the models of [`Building::to_model`](crate::building::Building::to_model). Others fit each other hardly ever: they are for
/// [`partition`](crate::partition::partition) and [`sew`](super::sew).
///
/// # Errors
/// [`VolumesError`].
pub fn sew_volumes(model: &Model) -> Result<VolumeMap, VolumesError> {
    let mut draft = Draft::default();
    for (element, index) in model.elements.iter().zip(0..) {
        draft.add(element, ElementId(index))?;
    }
    draft.face_each_other(model)?;
    Ok(draft.made)
}

#[derive(Default)]
struct Draft {
    made: VolumeMap,
    /// By corners in order: the first darts of the triangles.
    faces: BTreeMap<[Key; 3], Vec<Dart>>,
}

impl Draft {
    fn add(&mut self, element: &Element, id: ElementId) -> Result<(), VolumesError> {
        let VolumeMap { map, element_of, triangle_of, point_of } = &mut self.made;
        let mut edges: BTreeMap<[u32; 2], Vec<(MaterialId, Dart)>> = BTreeMap::new();
        for (number, triangle) in element.mesh.triangles.iter().enumerate() {
            let (corners, material) = (element.mesh.corners(number), element.mesh.materials[number]);
            let first = map.add_face(3);
            let mut start = first;
            for side in 0..3 {
                let (a, b) = (side, (side + 1) % 3);
                element_of.extend([id; 2]);
                triangle_of.extend([number as u32; 2]);
                point_of.extend([corners[a], corners[b]]);
                let [from, to] = [triangle[a], triangle[b]];
                let dart = if from < to { start } else { map.alpha(0, start) };
                edges.entry([from.min(to), from.max(to)]).or_default().push((material, dart));
                start = map.walk(start, &[0, 1]);
            }
            let mut keys = corners.map(key);
            keys.sort_unstable();
            self.faces.entry(keys).or_default().push(first);
        }
        for (ends, wings) in edges {
            let count = wings.len();
            let pairs = match wings[..] {
                [(_, a), (_, b)] => Some(vec![[a, b]]),
                _ => of_one_material(wings),
            };
            let [from, to] = ends.map(|v| element.mesh.positions[v as usize]);
            let pairs = pairs.ok_or_else(|| VolumesError::Edge {
                element: element.path.clone(),
                from,
                to,
                triangles: count,
            })?;
            for [a, b] in pairs {
                map.link(2, a, b);
                map.link(2, map.alpha(0, a), map.alpha(0, b));
            }
        }
        Ok(())
    }

    /// Links triangles of the same corners.
    fn face_each_other(&mut self, model: &Model) -> Result<(), VolumesError> {
        let VolumeMap { map, element_of, point_of, .. } = &mut self.made;
        let darts_of = |map: &GMap, face: Dart| -> Vec<Dart> {
            map.around_face(face).flat_map(|dart| [dart, map.alpha(0, dart)]).collect()
        };
        let ends = |map: &GMap, dart: Dart| [dart, map.alpha(0, dart)].map(|d| key(point_of[d.index()]));
        for (corners, faces) in &self.faces {
            let of = |face: Dart| element_of[face.index()];
            // From the lowest corner to the next, or the other way round.
            let is_even = |face: Dart| {
                let around = darts_of(map, face);
                (0..3).any(|side| ends(map, around[2 * side]) == [corners[0], corners[1]])
            };
            let pairs: Option<Vec<[Dart; 2]>> = match faces[..] {
                [_] => Some(Vec::new()),
                [one, other] if is_even(one) != is_even(other) => Some(vec![[one, other]]),
                _ => {
                    let (even, odd): (Vec<Dart>, Vec<Dart>) = faces.iter().partition(|&&face| is_even(face));
                    match (&even[..], &odd[..]) {
                        (&[a, b], &[c, d]) => {
                            let fits = |[a, b]: [Dart; 2]| of(a) != of(b);
                            let ways = [[[a, c], [b, d]], [[a, d], [b, c]]];
                            match ways.map(|way| way.into_iter().all(fits)) {
                                [true, false] => Some(ways[0].to_vec()),
                                [false, true] => Some(ways[1].to_vec()),
                                _ => None,
                            }
                        }
                        _ => None,
                    }
                }
            };
            let pairs = pairs.ok_or_else(|| VolumesError::Crowded {
                element: model.elements[of(faces[0]).0 as usize].path.clone(),
                at: point_of[faces[0].index()],
                times: faces.len(),
            })?;
            for [one, other] in pairs {
                let there = darts_of(map, other);
                for dart in darts_of(map, one) {
                    if let Some(&beyond) = there.iter().find(|&&beyond| ends(map, beyond) == ends(map, dart))
                    {
                        map.link(3, dart, beyond);
                    }
                }
            }
        }
        Ok(())
    }
}

/// The triangles at an edge in pairs of one material; `None` if they are not two of each.
fn of_one_material(mut wings: Vec<(MaterialId, Dart)>) -> Option<Vec<[Dart; 2]>> {
    wings.sort_unstable();
    let pairs = wings.chunk_by(|a, b| a.0 == b.0).map(|run| match *run {
        [(_, a), (_, b)] => Some([a, b]),
        _ => None,
    });
    pairs.collect()
}
