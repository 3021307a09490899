//! An element's mesh as a file holds it: faces cut to triangles or polygons, turned over, doubled, taken apart.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::super::building::{Element, Face};
use super::Style;
use super::dice::{Dice, Random};
use super::place::length;

/// How far a noisy corner is from its place at most, along each axis, metres.
const NOISE: f64 = 1e-6;

/// What faces are cut into.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Triangles.
    Triangles,
    /// Polygons without holes: faces that have none stay as they are.
    Polygons,
}

/// Closed chains of corners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rings {
    corners: Vec<u32>,
    /// Where each ends.
    ends: Vec<usize>,
}

impl Rings {
    fn push(&mut self, ring: impl Iterator<Item = u32>) {
        self.corners.extend(ring);
        self.ends.push(self.corners.len());
    }

    /// The corners of all, one ring after the other.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Each ring.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.corners[start..end])
    }
}

/// A mesh, whole or of one material.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// Corners, metres.
    pub points: Cow<'a, [[f64; 3]]>,
    /// Rings by material, materials rising; counter-clockwise seen from the front.
    pub faces: Vec<(u32, Rings)>,
}

/// What is done to an element's mesh when it is cut.
#[derive(Clone, Debug)]
pub struct Finish {
    winding: Winding,
    doubled: Option<(f64, Random)>,
    corners: Corners,
    by_material: bool,
}

#[derive(Clone, Copy, Debug)]
enum Winding {
    Outward,
    Inward,
    Mixed(Random),
}

#[derive(Clone, Copy, Debug)]
enum Corners {
    Shared,
    Own,
    /// Off by so much at most, along each axis, metres.
    Noisy(Random, f64),
}

impl Finish {
    /// The finish of the element `id`.
    pub fn of(style: &Style, dice: &Dice, id: &str) -> Finish {
        let winding = if dice.hits(style.inside_out, "inside-out", id) {
            Winding::Inward
        } else if dice.hits(style.mixed_winding, "mixed-winding", id) {
            Winding::Mixed(dice.draw("which look inward", id))
        } else {
            Winding::Outward
        };
        let noise = length(style.noise)
            + if dice.hits(style.noisy_corners, "noisy-corners", id) { NOISE } else { 0.0 };
        let corners = if noise > 0.0 {
            Corners::Noisy(dice.draw("noise", id), noise)
        } else if dice.hits(style.unwelded, "unwelded", id) {
            Corners::Own
        } else {
            Corners::Shared
        };
        let share = style.doubled_faces;
        let doubled = (share > 0.0).then(|| (share, dice.draw("doubled-faces", id)));
        Finish {
            winding,
            doubled,
            corners,
            by_material: dice.hits(style.split_by_material, "split-by-material", id),
        }
    }

    /// The mesh of an element with corners at `points`, in one part or in one for each material.
    pub fn parts<'a>(&self, element: &Element, points: &'a [[f64; 3]], cut: Cut) -> Vec<Part<'a>> {
        let faces = self.faces(element, cut);
        let mut parts = if self.by_material && faces.len() > 1 {
            faces.into_iter().map(|faces| compact(points, faces)).collect()
        } else {
            vec![Part { points: Cow::Borrowed(points), faces }]
        };
        let mut noise = match self.corners {
            Corners::Shared => return parts,
            Corners::Own => None,
            Corners::Noisy(random, most) => Some((random, most)),
        };
        parts.iter_mut().for_each(|part| take_apart(part, &mut noise));
        parts
    }

    /// The faces by material.
    fn faces(&self, element: &Element, cut: Cut) -> Vec<(u32, Rings)> {
        let mut winding = self.winding;
        let mut doubled = self.doubled;
        let mut by_material: BTreeMap<u32, Rings> = BTreeMap::new();
        for face in &element.faces {
            let rings = by_material.entry(face.material).or_default();
            let mut add = |ring: &[u32]| {
                let is_turned = match &mut winding {
                    Winding::Outward => false,
                    Winding::Inward => true,
                    Winding::Mixed(random) => random.fraction() < 0.5,
                };
                let is_twice = doubled.as_mut().is_some_and(|(share, random)| random.fraction() < *share);
                for _ in 0..=usize::from(is_twice) {
                    if is_turned {
                        // The first corner stays the first.
                        rings.push(ring.iter().take(1).chain(ring.iter().skip(1).rev()).copied());
                    } else {
                        rings.push(ring.iter().copied());
                    }
                }
            };
            cut_face(element, face, cut, &mut add);
        }
        by_material.into_iter().collect()
    }
}

fn cut_face(element: &Element, face: &Face, cut: Cut, add: &mut dyn FnMut(&[u32])) {
    match cut {
        Cut::Triangles => element.triangles(face).iter().for_each(|ring| add(ring)),
        Cut::Polygons => element.polygons(face).iter().for_each(|ring| add(ring)),
    }
}

/// The faces of one material with the corners that they use, in the order of their first use.
fn compact(points: &[[f64; 3]], (material, rings): (u32, Rings)) -> Part<'static> {
    let mut index = vec![u32::MAX; points.len()];
    let mut used = Vec::new();
    let mut own = Rings { corners: Vec::with_capacity(rings.corners.len()), ends: rings.ends };
    for corner in rings.corners {
        let known = &mut index[corner as usize];
        if *known == u32::MAX {
            *known = used.len() as u32;
            used.push(points[corner as usize]);
        }
        own.corners.push(*known);
    }
    Part { points: Cow::Owned(used), faces: vec![(material, own)] }
}

/// Gives every face its own corners, and shakes them.
fn take_apart(part: &mut Part<'_>, noise: &mut Option<(Random, f64)>) {
    let mut own = Vec::new();
    for (_, rings) in &mut part.faces {
        for corner in &mut rings.corners {
            let p = part.points[*corner as usize];
            let off = noise.as_mut().map_or([0.0; 3], |(random, most)| random.around(*most));
            *corner = own.len() as u32;
            own.push([0, 1, 2].map(|i| p[i] + off[i]));
        }
    }
    part.points = Cow::Owned(own);
}

#[cfg(test)]
mod tests {
    use super::super::super::lattice::point_metres;
    use super::super::super::{HouseOptions, house};
    use super::*;

    fn part(change: impl Fn(&mut Style), cut: Cut) -> Vec<Part<'static>> {
        let building = house(&HouseOptions::default());
        let window = building.elements.iter().find(|e| e.class == "IfcWindow").unwrap();
        let points: Vec<_> = window.points.iter().map(|&p| point_metres(p)).collect();
        let mut style = Style::exact();
        change(&mut style);
        let parts = Finish::of(&style, &Dice::new(1), &window.global_id).parts(window, &points, cut);
        parts
            .into_iter()
            .map(|p| Part { points: Cow::Owned(p.points.into_owned()), faces: p.faces })
            .collect()
    }

    fn corners(part: &Part<'_>) -> Vec<Vec<[u64; 3]>> {
        let at = |&i: &u32| part.points[i as usize].map(f64::to_bits);
        part.faces
            .iter()
            .flat_map(|(_, rings)| rings.iter().map(move |ring| ring.iter().map(at).collect()))
            .collect()
    }

    #[test]
    fn faces_are_turned_and_doubled() {
        for cut in [Cut::Triangles, Cut::Polygons] {
            let plain = corners(&part(|_| (), cut)[0]);
            let inward = corners(&part(|s| s.inside_out = 1.0, cut)[0]);
            let back = |ring: &Vec<[u64; 3]>| {
                let mut ring = ring.clone();
                ring[1..].reverse();
                ring
            };
            assert_eq!(inward.iter().map(back).collect::<Vec<_>>(), plain);
            let mixed = corners(&part(|s| s.mixed_winding = 1.0, cut)[0]);
            let turned = mixed.iter().zip(&plain).filter(|(a, b)| a != b).count();
            assert!(turned * 4 > plain.len() && turned * 4 < plain.len() * 3, "{turned} of {}", plain.len());
            let doubled = corners(&part(|s| s.doubled_faces = 1.0, cut)[0]);
            assert_eq!(doubled.len(), 2 * plain.len());
            assert!(doubled.chunks(2).zip(&plain).all(|(pair, ring)| pair[0] == *ring && pair[1] == *ring));
        }
    }

    #[test]
    fn corners_are_taken_apart() {
        let plain = &part(|_| (), Cut::Triangles)[0];
        let own = &part(|s| s.unwelded = 1.0, Cut::Triangles)[0];
        assert_eq!(corners(own), corners(plain));
        let count: usize = own.faces.iter().map(|(_, rings)| rings.corners().len()).sum();
        assert_eq!(own.points.len(), count);
        let noisy = &part(|s| s.noisy_corners = 1.0, Cut::Triangles)[0];
        let off = |i: usize, axis: usize| (noisy.points[i][axis] - own.points[i][axis]).abs();
        assert!((0..count).all(|i| (0..3).all(|axis| off(i, axis) <= 1.000_001e-6)));
        assert!((0..count).filter(|&i| off(i, 0) > 1e-7).count() > count / 2);
    }

    #[test]
    fn materials_become_parts() {
        let whole = &part(|_| (), Cut::Polygons)[0];
        let parts = part(|s| s.split_by_material = 1.0, Cut::Polygons);
        assert_eq!((whole.faces.len(), parts.len()), (2, 2), "paint and glass");
        assert_eq!(parts.iter().flat_map(corners).collect::<Vec<_>>(), corners(whole));
        assert_eq!(parts.iter().map(|p| p.points.len()).sum::<usize>(), whole.points.len());
    }
}
