//! A ray that goes on through what it meets: through glass to what is behind it, or through walls, all of them.
//!
//! It stays one ray. Each surface is where this ray meets the source's triangle, the same wherever one begins to look: so what comes next is the next
//! by distance, those at the same distance one after the other, and none is lost for lying on what was passed. A new ray from there
//! ([`Start::Hit`]) could not tell these from its own surface.

use arrayvec::ArrayVec;

use super::NONE;
use super::cells::Ended;
use super::kernel::Ask;
use super::line::{Line, is_away, surface, surface_of};
use super::ray::{Hit, Ray};
use super::single::{Start, Want};
use super::walk::Walk;
use crate::scene::Scene;

/// Surfaces at one place that are told apart by what they are.
const MOST_AT_ONCE: usize = 16;

/// What was met: a ray along the edge of two triangles meets both, and that is one surface.
#[derive(Clone, Copy, PartialEq)]
struct Skin {
    element: u32,
    material: u32,
    /// The ray goes in, not out, as the surface is wound.
    inward: bool,
}

impl Scene {
    /// What a ray meets, one after the other, as long as it `passes` what it is told of; returned is what it does not pass.
    ///
    /// Of a pane with a thickness it meets two surfaces. Surfaces on each other, an element's on another's, it meets one after the other, which one
    /// first is not said. Where it meets several triangles of an element at one place, as on their edge, that is one surface, if their material is one
    /// and they are wound alike. A ray that starts inside a solid ends there, as that of [`Scene::trace`] does, and is not told of it.
    ///
    /// The first is found as fast as by [`Scene::trace_from`], each that follows in the time that a ray through all triangles takes.
    ///
    /// ```no_run
    /// use enfilade::{Ray, Scene, Start, Want};
    ///
    /// let scene = Scene::open("house.enf".as_ref())?;
    /// // What a radio wave would have to go through, up to ten surfaces.
    /// let (ray, mut met) = (Ray::segment([2.0, 3.0, 1.6], [1.0, 0.2, 0.0], 0.0, 8.0), Vec::new());
    /// scene.trace_through(Start::Anywhere, &ray, Want::default(), |hit| {
    ///     met.push((hit.t, scene.element(hit.element).id().to_string()));
    ///     met.len() < 10
    /// });
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn trace_through(
        &self,
        start: Start<'_>,
        ray: &Ray,
        want: Want,
        mut passes: impl FnMut(&Hit) -> bool,
    ) -> Hit {
        let first = self.trace_from(start, ray, want);
        if first.triangle == NONE || !passes(&first) {
            return first;
        }
        self.trace_beyond(start, ray, want, &first, passes)
    }

    /// The same, from the first on, which it passes. The start matters only if that is a surface.
    pub(crate) fn trace_beyond(
        &self,
        start: Start<'_>,
        ray: &Ray,
        want: Want,
        first: &Hit,
        mut passes: impl FnMut(&Hit) -> bool,
    ) -> Hit {
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let Some(line) = Line::new(tables, ray) else { return Hit::ESCAPED };
        let surface = surface(start, &line);
        let line = self.in_front(surface.as_ref().filter(|surface| is_away(surface, &line)), &line);
        let near = surface_of(first, line.origin, first.t).near;
        let skin = |triangle: u32| {
            let ([a, b, c], record) = (walk.corners(triangle), tables.record(triangle));
            let inward = (b - a).cross(c - a).dot(line.direction) < 0.0;
            Skin { element: record.element, material: record.material, inward }
        };
        let mut here = ArrayVec::<(f64, Skin), MOST_AT_ONCE>::new();
        here.push((first.t, skin(first.triangle)));
        let mut own = NONE;
        if let Start::Hit(hit) = start
            && (hit.triangle as usize) < tables.triangles.len()
        {
            own = hit.triangle;
            here.push((line.tmin, skin(own)));
        }
        let mut query = line.query(tables, None);
        query.aim(tables.cells[0].root, line.tmax);
        query.follow((first.t - near).max(line.tmin), 0);
        loop {
            let found = self.kernel.run(Ask::First, &walk, &query);
            if found.triangle == NONE {
                return Hit::ESCAPED;
            }
            query.follow(found.t, found.triangle + 1);
            let met = skin(found.triangle);
            here.retain(|(t, _)| found.t - *t <= near);
            if found.triangle == own || here.iter().any(|(_, skin)| *skin == met) {
                continue;
            }
            if here.is_full() {
                here.remove(0);
            }
            here.push((found.t, met));
            let hit = self.describe(&line, Ended { found, cell: 0, in_matter: false }, want);
            if !passes(&hit) {
                return hit;
            }
        }
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use enfilade_importers::{Material, MaterialId, Semantic};
    use glam::DVec3;

    use super::*;
    use crate::oracle::fixtures::{Shape, house, model};
    use crate::splitmix::SplitMix64;
    use crate::{CompileOptions, Kernel, Scene, compile};

    /// All that a ray meets, of all triangles: where, which element, whether it goes in there; `None` if it passes an edge too near to tell.
    fn all(scene: &Scene, ray: &Ray) -> Option<Vec<(f64, u32, bool)>> {
        let (origin, way) = (DVec3::from(ray.origin), DVec3::from(ray.direction).normalize());
        let mut met = Vec::new();
        for triangle in 0..scene.detail_triangle_count() {
            let [a, b, c] = scene.triangle(triangle).map(DVec3::from);
            let normal = (b - a).cross(c - a);
            let t = normal.dot(a - origin) / normal.dot(way);
            let sides = [[a, b], [b, c], [c, a]].map(|[p, q]| way.dot((p - origin).cross(q - origin)));
            let least = sides.into_iter().fold(f64::INFINITY, f64::min);
            let most = sides.into_iter().fold(f64::NEG_INFINITY, f64::max);
            if !(least <= 1e-7 && most >= -1e-7) && t >= 0.0 {
                met.push((t, scene.tables.record(triangle).element, normal.dot(way) < 0.0));
            } else if (least.abs() <= 1e-7 || most.abs() <= 1e-7) && (least >= -1e-7 || most <= 1e-7) {
                return None;
            }
        }
        met.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(met)
    }

    #[test]
    fn all_that_a_ray_crosses_is_met_once_and_in_order() {
        let bytes = compile(&house(), &CompileOptions::default()).unwrap().bytes;
        let scenes: Vec<Scene> = Kernel::available()
            .into_iter()
            .map(|kernel| Scene::from_bytes(&bytes).unwrap().with_kernel(kernel))
            .collect();
        let scene = &scenes[0];
        let [lo, hi] = scene.tables.scene[0].hull;
        let (mut random, mut surfaces, mut told) = (SplitMix64::new(3), 0, 0);
        for i in 0..400 {
            let mut within = |axis: usize| random.between(lo[axis], hi[axis]);
            let origin = [within(0), within(1), within(2)];
            let to = [within(0), within(1), within(2)];
            let direction = [0, 1, 2].map(|axis| to[axis] - origin[axis]);
            let ray = Ray::new(origin, direction);
            let Some(expected) = all(scene, &ray) else { continue };
            if scene.trace(&ray).record().t.is_nan() {
                continue;
            }
            told += 1;
            for scene in &scenes {
                let mut met = Vec::new();
                let last = scene.trace_through(Start::Anywhere, &ray, Want::default(), |hit| {
                    met.push(*hit);
                    true
                });
                assert_eq!(last.element, NONE);
                assert!(met.windows(2).all(|pair| pair[0].t <= pair[1].t + 1e-9));
                // What lies on each other comes in any order.
                let key = |t: f64, element: u32, inward: bool| ((t * 1e6).round() as i64, element, inward);
                let inward = |hit: &Hit| skin_of(scene, hit.triangle, ray.direction);
                let mut met: Vec<_> = met.iter().map(|hit| key(hit.t, hit.element, inward(hit))).collect();
                let mut expected: Vec<_> =
                    expected.iter().map(|&(t, element, inward)| key(t, element, inward)).collect();
                met.sort_unstable();
                expected.sort_unstable();
                expected.dedup();
                assert_eq!(met, expected, "ray {i} {ray:?}");
                surfaces += met.len();
            }
        }
        assert!(told > 200 && surfaces > 5 * told, "{told} rays, {surfaces} surfaces");
    }

    fn skin_of(scene: &Scene, triangle: u32, way: [f64; 3]) -> bool {
        let [a, b, c] = scene.triangle(triangle).map(DVec3::from);
        (b - a).cross(c - a).dot(DVec3::from(way)) < 0.0
    }

    /// A plate of glass in a block, flush with its top, and another on that: a ray through the glass meets the block.
    #[test]
    fn what_is_opaque_in_the_plane_of_glass_is_met() {
        let mut model = model(&[
            (Semantic::Room, Shape::cuboid([0.0; 3], [4.0, 3.0, 2.5])),
            (Semantic::Furniture, Shape::cuboid([1.0, 1.0, 0.2], [2.0, 2.0, 1.0])),
            (Semantic::Furniture, Shape::cuboid([1.1, 1.1, 0.9], [1.9, 1.9, 1.0])),
            (Semantic::Furniture, Shape::cuboid([1.0, 1.0, 1.0], [1.8, 1.8, 1.1])),
        ]);
        let glass = MaterialId(model.materials.len() as u32);
        model.materials.push(Material { alpha: 0.3, ..Material::default() });
        for element in [2, 3] {
            let mesh = &mut model.elements[element].mesh;
            mesh.materials = vec![glass; mesh.triangles.len()];
        }
        let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        let mut random = SplitMix64::new(5);
        for _ in 0..500 {
            let on = [1.15 + 0.6 * random.unit(), 1.15 + 0.6 * random.unit(), 1.0];
            let eye = [4.0 * random.unit(), 3.0 * random.unit(), 1.3 + random.unit()];
            let ray = Ray::new(eye, [0, 1, 2].map(|axis| on[axis] - eye[axis]));
            let mut met = Vec::new();
            let last = scene.trace_through(Start::Anywhere, &ray, Want::default(), |hit| {
                let is_glass = scene.materials()[hit.material as usize].alpha < 1.0;
                met.push(hit.element);
                is_glass
            });
            let element = |index: u32| scene.element(index).id().to_string();
            assert_eq!(element(last.element), model.elements[1].id, "{ray:?}");
            assert!((last.point[2] - 1.0).abs() < 1e-9, "{ray:?} {last:?}");
            let plate = met.iter().filter(|&&met| element(met) == model.elements[3].id).count();
            assert!(met.len() <= 4 && (1..=2).contains(&plate), "{ray:?} {met:?}");
        }
    }
}
