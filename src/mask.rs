//! What rays are not to meet: a scene without its glass, without its furniture, without an element.

use enfilade_importers::Role;

use crate::format::Views;
use crate::format::records::{CellRecord, PLAIN, SourceRecord};
use crate::scene::Scene;
use crate::trace::NONE;

impl Scene {
    /// The same scene without the triangles that `is_hidden`, which gets the indices of an element and of a material: rays pass them, and an
    /// element that lacks any of them is no solid that a ray could start in. All else of the scene stays as it is: cells, rooms, openings,
    /// and how these stand ([`Scene::set_open`]).
    ///
    /// What rays meet, and how far away, is what they meet in a scene compiled without these triangles. Inside of hidden matter there are no cells of
    /// air and no rooms, and hits there tell none. Sheets that close openings are met, even where the door is hidden that they stand for; the
    /// graph of rooms knows what is left of surfaces. Of triangles that an element has twice one is in the scene, and its material counts.
    ///
    /// The two scenes share what is alike; making one takes about as long as
    /// opening the file. Hiding furniture and the like costs rays nothing. Rays that pass what cells were cut around (walls, slabs) are answered by
    /// the hierarchy of all triangles, so that hiding much of that makes them slower.
    ///
    /// ```no_run
    /// use enfilade::Scene;
    /// use enfilade::importers::Semantic;
    ///
    /// let scene = Scene::open("house.enf".as_ref())?;
    /// let bare = scene.without(|element, _| scene.element(element).semantic() == Semantic::Furniture);
    /// let no_glass = scene.without(|_, material| scene.materials()[material as usize].transmission > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn without(&self, is_hidden: impl Fn(u32, u32) -> bool) -> Scene {
        let mut tables = self.closing.modelled(&self.tables);
        let met = tables.scene[0].detail_triangles;
        let runs: Vec<bool> =
            tables.runs.iter().map(|run| run.first < met && is_hidden(run.element, run.material)).collect();
        hide(&mut tables, &runs);
        let mut scene = Scene::from_views(tables).with_kernel(self.kernel);
        scene.closing = self.closing.of_hidden(&self.tables);
        let stands = self.closing.stands();
        if !stands.is_empty() {
            // They stood so before: sheets hang on cells and elements, of which masks change nothing.
            let _ = scene.set_stands_where_possible(&stands);
        }
        scene
    }
}

/// Takes the triangles of some runs out of all that rays look at.
fn hide(tables: &mut Views, runs: &[bool]) {
    let run_of = tables.run_of.clone();
    let is_hidden = |triangle: u32| triangle != NONE && runs[run_of[triangle as usize] as usize];
    tables.leaves.edit(|leaves| {
        leaves.iter_mut().filter(|triangle| is_hidden(**triangle)).for_each(|triangle| *triangle = NONE);
    });
    // Sources keep what is left of them, and are none that could be told without a look at their triangles.
    let mut lacks = vec![false; tables.sources.len()];
    let old = tables.surfaces.clone();
    let mut surfaces = Vec::with_capacity(old.len());
    tables.sources.edit(|sources| {
        for (source, lacks) in sources.iter_mut().zip(&mut lacks) {
            let own = &old[source.first as usize..(source.first + source.count) as usize];
            let first = surfaces.len() as u32;
            surfaces.extend(own.iter().copied().filter(|&triangle| !is_hidden(triangle)));
            let count = surfaces.len() as u32 - first;
            *lacks = count < source.count;
            let plane = if *lacks { NONE } else { source.plane };
            *source = SourceRecord { first, count, plane, ..*source };
        }
    });
    tables.surfaces.edit(|all| *all = surfaces);
    let lacks = |source: u32| lacks.get(source as usize).is_some_and(|&lacks| lacks);
    tables.faces.edit(|faces| {
        faces.iter_mut().filter(|face| lacks(face.source)).for_each(|face| face.flags &= !PLAIN);
    });
    tables.covers.edit(|covers| {
        covers.iter_mut().filter(|cover| lacks(cover.source)).for_each(|cover| cover.flags &= !PLAIN);
    });
    let mut is_whole = vec![true; tables.elements.len()];
    for (run, _) in tables.runs.iter().zip(runs).filter(|(_, hidden)| **hidden) {
        is_whole[run.element as usize] = false;
    }
    tables.volumes.edit(|volumes| {
        let solid = volumes.iter_mut().filter(|volume| volume.role == Role::Solid as u32);
        solid
            .filter(|volume| !is_whole[volume.element as usize])
            .for_each(|volume| volume.role = Role::Detail as u32);
    });
    tables.cells.edit(|cells| {
        let matter = cells.iter_mut().filter(|cell| cell.kind == CellRecord::SOLID);
        matter
            .filter(|cell| is_whole.get(cell.element as usize) == Some(&false))
            .for_each(|cell| cell.flags |= CellRecord::HIDDEN);
    });
    tables.derive();
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use enfilade_importers::{Model, Semantic, Untagged};

    use super::*;
    use crate::closing::{Leaf, Stand};
    use crate::roles::roles;
    use crate::verify::without;
    use crate::{CompileOptions, Hit, Ray, VerifyOptions, compile, verify};

    fn check(model: &Model, scene: &Scene, is_hidden: impl Fn(u32, u32) -> bool + Copy) {
        let hidden = scene.without(is_hidden);
        let (truth, lacking) = without(model.clone(), is_hidden);
        let mut roles = roles(&truth, Untagged::default());
        lacking.into_iter().for_each(|element| roles[element as usize] = Role::Detail);
        let trace = |rays: &[Ray], hits: &mut [Hit]| hidden.trace_many(rays, hits, Default::default());
        let occluded = |rays: &[Ray]| crate::verify::sees(&hidden, rays);
        let mut options = VerifyOptions::default().with_rays(3000).with_grid_rays(1000);
        (options.solid_rays, options.hard_rays) = (1000, 3000);
        let report = verify(&truth, |e| roles[e.0 as usize], &(trace, occluded), &options).unwrap();
        assert!(report.passed(), "{:#?} {:?}", report.wrong, report.sight);
        // Single rays say the same.
        let mut random = crate::splitmix::SplitMix64::new(9);
        let [lo, hi] = scene.hull();
        for _ in 0..2000 {
            let point = || [0, 1, 2].map(|i| (lo[i], hi[i]));
            let from = point().map(|(lo, hi)| random.between(lo, hi));
            let to = point().map(|(lo, hi)| random.between(lo, hi));
            let ray = Ray::segment(from, [0, 1, 2].map(|i| to[i] - from[i]), 0.0, 3.0);
            let mut hits = [Hit::ESCAPED];
            hidden.trace_many(&[ray], &mut hits, Default::default());
            assert_eq!(
                hidden.trace_from(crate::Start::Anywhere, &ray, Default::default()).t.to_bits(),
                hits[0].t.to_bits()
            );
            let meets = hits[0].answer() != crate::Answer::Escaped;
            assert_eq!(hidden.occluded(&ray), meets);
            if meets && !hits[0].t.is_nan() {
                assert!(!is_hidden(hits[0].element, hits[0].material));
            }
        }
    }

    #[test]
    fn what_is_hidden_is_not_met_and_all_else_is() {
        let house = crate::generate::house(&Default::default()).to_model().unwrap();
        let scene = compile(&house, &CompileOptions::default()).unwrap().scene();
        let is = |element: u32, semantic: Semantic| house.elements[element as usize].semantic == semantic;
        check(&house, &scene, |_, _| false);
        check(&house, &scene, |element, _| is(element, Semantic::Furniture));
        check(&house, &scene, |element, _| is(element, Semantic::Wall));
        check(&house, &scene, |element, _| is(element, Semantic::Roof) || is(element, Semantic::Ground));
        check(&house, &scene, |_, material| material % 3 == 1);
        check(&house, &scene, |element, material| (element * 7 + material * 5) % 4 == 0);
        check(&house, &scene, |_, _| true);
    }

    /// Distances, and those of rays that go on from hits, are those of a scene without cells that was compiled without what is hidden.
    #[test]
    fn rays_go_on_from_hits_as_in_a_scene_that_has_nothing_hidden() {
        let house = crate::generate::house(&Default::default()).to_model().unwrap();
        let scene = compile(&house, &CompileOptions::default()).unwrap().scene();
        for semantics in [&[Semantic::Furniture][..], &[Semantic::Wall], &[Semantic::Roof, Semantic::Ground]]
        {
            let is_hidden = |e: u32, _: u32| semantics.contains(&house.elements[e as usize].semantic);
            // In two steps, of which the second is the mask of a mask.
            let hidden = scene.without(|e, m| is_hidden(e, m) && e % 2 == 0).without(is_hidden);
            let options = CompileOptions { cells: false, ..CompileOptions::default() };
            let other = compile(&without(house.clone(), is_hidden).0, &options).unwrap().scene();
            let [lo, hi] = scene.hull();
            let mut random = crate::splitmix::SplitMix64::new(12);
            let (mut met, mut unlike) = (0, 0);
            // Planes behind faces and their triangles round apart.
            let is_alike = |a: f64, b: f64| a == b || (a - b).abs() < 1e-9 || (a.is_nan() && b.is_nan());
            for _ in 0..6000 {
                let from = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
                let ray = Ray::new(from, [0; 3].map(|_| random.between(-1.0, 1.0)));
                let trace =
                    |scene: &Scene, start, ray: &Ray| scene.trace_from(start, ray, Default::default());
                let (one, two) = (
                    trace(&hidden, crate::Start::Anywhere, &ray),
                    trace(&other, crate::Start::Anywhere, &ray),
                );
                assert!(is_alike(one.t, two.t), "{ray:?} {one:?} {two:?}");
                if one.triangle == NONE || one.t.is_nan() {
                    continue;
                }
                met += 1;
                let on = Ray::new(one.point, [0; 3].map(|_| random.between(-1.0, 1.0)));
                let (one, two) = (
                    trace(&hidden, crate::Start::Hit(&one), &on),
                    trace(&other, crate::Start::Hit(&two), &on),
                );
                unlike += u32::from(!is_alike(one.t, two.t));
            }
            // Restarts near edges may tell apart surfaces that touch.
            assert!(met > 1500 && unlike <= met / 500, "{unlike} of {met}");
        }
    }

    /// A leaf that cells were cut around cannot be taken out, whether some of it is hidden or not.
    #[test]
    fn what_carves_in_the_file_carves_when_some_of_it_is_hidden() {
        let mut house = crate::generate::house(&Default::default()).to_model().unwrap();
        let leaf = house.elements.iter().position(|e| e.class.as_deref() == Some("IfcDoor")).unwrap();
        house.elements[leaf].semantic = Semantic::Wall;
        let last = house.elements[leaf].mesh.materials.last_mut().unwrap();
        last.0 = if last.0 == 0 { 1 } else { 0 };
        let material = last.0;
        let mut scene = compile(&house, &CompileOptions::default()).unwrap().scene();
        assert!(scene.set_open(leaf as u32, true, Leaf::Out).is_err());
        let mut hidden = scene.without(|element, m| element == leaf as u32 && m == material);
        assert!(hidden.set_open(leaf as u32, true, Leaf::Out).is_err());
        let mut twice = hidden.without(|element, _| element == leaf as u32);
        assert!(twice.set_open(leaf as u32, true, Leaf::Out).is_err());
    }

    #[test]
    fn doors_stand_as_they_stood_and_open_on() {
        let house = crate::generate::house(&Default::default()).to_model().unwrap();
        let mut scene = compile(&house, &CompileOptions::default()).unwrap().scene();
        let door = scene.elements().find(|e| e.class() == "IfcDoor").unwrap().index();
        scene.set_open(door, false, Leaf::Out).unwrap();
        let furniture = |e: u32, _: u32| house.elements[e as usize].semantic == Semantic::Furniture;
        let mut bare = scene.without(furniture);
        assert_eq!(bare.stand(door), Stand::SEALED);
        assert_eq!(bare.closures().len(), 1);
        bare.set_open(door, true, Leaf::In).unwrap();
        let fresh = compile(&house, &CompileOptions::default()).unwrap().scene().without(furniture);
        let mut random = crate::splitmix::SplitMix64::new(10);
        let [lo, hi] = scene.hull();
        for _ in 0..5000 {
            let from = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
            let ray = Ray::new(from, [0; 3].map(|_| random.between(-1.0, 1.0)));
            let (one, other) = (
                bare.trace_from(crate::Start::Anywhere, &ray, Default::default()),
                fresh.trace_from(crate::Start::Anywhere, &ray, Default::default()),
            );
            assert_eq!((one.t.to_bits(), one.triangle), (other.t.to_bits(), other.triangle));
        }
    }
}
