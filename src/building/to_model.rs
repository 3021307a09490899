//! The volumes of a building as a model.

use enfilade_importers::{Frame, ImportError, Material, Model, ModelBuilder, NewElement, Semantic};
use glam::DVec3;

use super::{Building, normal};
use crate::partition::cells::NONE;
use crate::sew::{Part, Sewn, Way};

/// What faces are of a volume, and what their material is called.
const PARTS: [(Part, &str); 3] = [(Part::Floor, "floor"), (Part::Side, "side"), (Part::Ceiling, "ceiling")];

impl Building {
    /// The volumes as a model in the internal frame, in their order: each an element of its own, a closed mesh of the map's faces with
    /// what fills it as its tag; `EXTERIOR` for voids, too, as no tag says `VOID`. Its id is the volume's number. Materials are called
    /// `floor`, `side` and `ceiling`, after what a face is of its volume.
    ///
    /// Neighbours have the same triangles, the other way round, with corners equal to the last bit:
    /// [`sew_volumes`](crate::sew::sew_volumes) makes the same map of them again, its faces cut into triangles. Where rounding has left
    /// a volume without a height over a part, or a face narrower than the digits of an f64, which then has no triangles, it may not.
    ///
    /// # Errors
    /// [`ImportError`]: there are more volumes than a model may have elements, or they take more memory than one may.
    pub fn to_model(&self) -> Result<Model, ImportError> {
        let mut own: Vec<Vec<(u32, bool)>> = vec![Vec::new(); self.volumes.len()];
        for (face, number) in self.topology.faces.iter().zip(0..) {
            own[face.one as usize].push((number, true));
            if face.other != NONE {
                own[face.other as usize].push((number, false));
            }
        }
        let mut builder = ModelBuilder::new("volumes", Frame::default());
        let materials = PARTS.map(|(_, name)| {
            let own = Material { name: name.to_owned(), ..Material::default() };
            builder.material(own)
        });
        for (faces, number) in own.iter().zip(0u32..) {
            let volume = &self.volumes[number as usize];
            let semantic = match self.semantic(volume.label) {
                Semantic::Void => Semantic::Exterior,
                semantic => semantic,
            };
            let name = format!("{} {number}", semantic.name());
            let new = NewElement { id: number.to_string(), name, ..NewElement::default() };
            let element = builder.element(new)?;
            builder.semantic(element, semantic);
            for &(face, is_first) in faces {
                let part = self.topology.faces[face as usize].way.part(is_first);
                let material = PARTS.iter().zip(materials).find(|((own, _), _)| *own == part);
                let Some((_, material)) = material else { continue };
                for [a, b, c] in self.triangles(face) {
                    let corners = if is_first { [a, b, c] } else { [a, c, b] };
                    builder.triangle(element, corners, material)?;
                }
            }
        }
        builder.finish()
    }

    /// A face cut into triangles, metres, counter-clockwise seen from outside its first volume.
    fn triangles(&self, face: u32) -> Vec<[[f64; 3]; 3]> {
        let mut corners: Vec<DVec3> = self.corners(face).map(DVec3::from).collect();
        let outward = self.outward(&self.topology.faces[face as usize]);
        if normal(&corners).dot(outward) < 0.0 {
            corners.reverse();
        }
        fans(&corners, outward).into_iter().map(|t| t.map(|p| p.to_array())).collect()
    }

    /// Out of the first volume of a face, metres along the axes of the internal frame; of any length.
    fn outward(&self, sewn: &Sewn) -> DVec3 {
        match sewn.way {
            Way::Ceiling(_) => DVec3::Z,
            Way::Floor(_) => DVec3::NEG_Z,
            Way::Upright(ends) => {
                let [a, b] = ends.map(|p| self.lattice.metres([f64::from(p.x), f64::from(p.y), 0.0]));
                DVec3::new(b[1] - a[1], a[0] - b[0], 0.0).normalize_or_zero()
            }
        }
    }
}

/// A convex polygon, some of whose corners may lie between others, cut into triangles that all have an area, if that can be. Counter-clockwise
/// if looked at against `outward`.
fn fans(corners: &[DVec3], outward: DVec3) -> Vec<[DVec3; 3]> {
    let mut left = corners.to_vec();
    let mut triangles = Vec::new();
    let whole = normal(corners).dot(outward);
    while left.len() > 3 {
        let n = left.len();
        let left_area = normal(&left).dot(outward);
        let ear = |i: usize| [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
        // Of all ears that leave something, the one that is least of a sliver.
        let height = |i: usize| {
            let longest = |[a, b, c]: [DVec3; 3]| {
                a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a))
            };
            let area = normal(&ear(i)).dot(outward);
            let height = (area / longest(ear(i))).min((left_area - area) / whole);
            if height.is_nan() { f64::NEG_INFINITY } else { height }
        };
        let heights: Vec<f64> = (0..n).map(height).collect();
        let best = (0..n).max_by(|&i, &j| heights[i].total_cmp(&heights[j])).unwrap_or(0);
        triangles.push(ear(best));
        left.remove(best);
    }
    if let [a, b, c] = left[..] {
        triangles.push([a, b, c]);
    }
    triangles
}
