//! Export styles: each oddity is really in the file, as large as promised, and does not keep anyone from reading,
//! compiling and tracing it.
#![cfg(all(feature = "gltf", feature = "obj", feature = "compile", feature = "cli"))]

use crate::common;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

use common::Folder;
use enfilade::components::{Component, Orientation, components};
use enfilade::generate::{Building, Export, HouseOptions, Style, Unit, house};
use enfilade::importers::{Element, ImportOptions, Mesh, Model, Semantic, Untagged, UpAxis, import};
use enfilade::roles::roles;
use enfilade::{CompileOptions, Place, Scene, VerifyOptions, compile, verify};

static HOUSE: LazyLock<Building> = LazyLock::new(|| house(&HouseOptions::default()));
static EXACT: LazyLock<Model> = LazyLock::new(|| HOUSE.to_model().unwrap());

/// Rounding of the coordinates of a file in f32, metres: the house with its garden is within 20 m of the origin.
const FLOAT: f64 = 2e-6;

fn styled(change: impl Fn(&mut Style)) -> Style {
    let mut style = Style::exact();
    style.seed = 1;
    change(&mut style);
    style
}

/// The model of the house in a style.
fn model(change: impl Fn(&mut Style)) -> Model {
    HOUSE.export(&styled(change)).to_model().unwrap()
}

/// Every option alone, at its most; and some at once.
fn all_styles() -> Vec<(String, Style)> {
    let mut all = vec![("exact".to_owned(), Style::exact())];
    for (name, _) in Style::exact().shares_mut() {
        let with = styled(|style| {
            let found = style.shares_mut().into_iter().find(|(other, _)| *other == name);
            *found.unwrap().1 = 1.0;
        });
        all.push((name.to_owned(), with));
    }
    all.push(("storey-spaces".to_owned(), styled(|s| s.storey_spaces = true)));
    all.push(("off-grid".to_owned(), styled(|s| s.off_grid = true)));
    all.push(("turned".to_owned(), styled(|s| s.turned = true)));
    all.push(("far".to_owned(), styled(|s| s.far = true)));
    all.push(("cm".to_owned(), styled(|s| s.unit = Unit::Centimetre)));
    all.push(("mm".to_owned(), styled(|s| s.unit = Unit::Millimetre)));
    all.push(("cad".to_owned(), Style::cad(1)));
    for (p, seed) in [(0.1, 1), (0.3, 2), (0.6, 3)] {
        all.push((format!("damage {p}"), Style::damage(p, seed)));
    }
    all
}

/// Writes the file and reads it as any other.
fn read(export: &Export<'_>, style: &Style, name: &str) -> Model {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    export.write(&path).unwrap();
    let mut options = ImportOptions::default();
    if name.ends_with(".obj") {
        options.unit = Some(style.unit.metres());
        options.up = Some(UpAxis::Y);
    }
    import(&path, &options).unwrap()
}

fn parts(element: &Element) -> Vec<Component> {
    components(&element.mesh)
}

fn is_closed(element: &Element) -> bool {
    parts(element).iter().all(|part| part.closed)
}

fn volume(element: &Element) -> f64 {
    parts(element).iter().map(|part| part.signed_volume).sum()
}

fn area(element: &Element) -> f64 {
    let of = |t: usize| {
        let [a, b, c] = element.mesh.corners(t);
        let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
        let w = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        w.iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0
    };
    (0..element.mesh.triangles.len()).map(of).sum()
}

fn bounds(element: &Element) -> [[f64; 3]; 2] {
    let all = &element.mesh.positions;
    all.iter().fold([all[0]; 2], |[lo, hi], p| {
        [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
    })
}

/// The elements of both models with the same identity: as it was, and as it is now.
fn pairs(model: &Model) -> Vec<(&'static Element, &Element)> {
    let now: BTreeMap<&str, &Element> = model.elements.iter().map(|e| (e.id.as_str(), e)).collect();
    EXACT.elements.iter().filter_map(|old| Some((old, *now.get(old.id.as_str())?))).collect()
}

fn of_class<'m>(model: &'m Model, class: &'static str) -> impl Iterator<Item = &'m Element> {
    model.elements.iter().filter(move |e| e.class.as_deref() == Some(class))
}

/// The triangles by the bits of their corners, each from its least corner on, in order.
fn triangles(mesh: &Mesh) -> Vec<[[u64; 3]; 3]> {
    let mut all: Vec<_> = (0..mesh.triangles.len())
        .map(|t| {
            let mut corners = mesh.corners(t).map(|p| p.map(f64::to_bits));
            let least = (0..3).min_by_key(|&i| corners[i]).unwrap();
            corners.rotate_left(least);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

fn verify_scene(model: &Model, scene: &Scene, what: &str) {
    let roles = roles(model, Untagged::default());
    let options = VerifyOptions::default().with_rays(2000).with_grid_rays(200);
    let report = verify(model, |e| roles[e.0 as usize], scene, &options).unwrap();
    assert_eq!(report.total.wrong, 0, "{what}: {:?}", report.wrong);
    assert!(report.sight.different == 0 && report.sight.rays > 0, "{what}: {:?}", report.sight);
    assert_eq!(report.grid.different, 0, "{what}");
}

#[test]
fn exact_is_the_building() {
    let export = HOUSE.export(&Style::exact());
    assert_eq!(export.to_glb(), HOUSE.to_glb());
    assert_eq!(export.to_obj("x.mtl"), HOUSE.to_obj("x.mtl"));
    // A seed alone, and shares of nothing, change nothing.
    let nothing = HOUSE.export(&Style::damage(0.0, 7));
    assert_eq!(nothing.to_glb(), HOUSE.to_glb());
    assert_eq!(nothing.to_obj("x.mtl"), HOUSE.to_obj("x.mtl"));
}

#[test]
fn every_style_is_read_compiled_and_traced() {
    for (name, style) in all_styles() {
        let model = read(&HOUSE.export(&style), &style, "house.glb");
        let compiled = compile(&model, &CompileOptions::default()).unwrap();
        let out: u64 = compiled.report.triangles_out.iter().map(|row| row.count).sum();
        assert_eq!(compiled.report.triangles_in, out, "{name}");
        verify_scene(&model, &compiled.scene(), &name);
    }
}

#[test]
fn every_style_makes_the_same_bytes_again() {
    for (name, style) in all_styles() {
        let (one, two) = (HOUSE.export(&style), house(&HouseOptions::default()));
        let two = two.export(&style);
        assert!(one.to_glb() == two.to_glb(), "{name}");
        assert!(one.to_obj("house.mtl") == two.to_obj("house.mtl"), "{name}");
        if name != "exact" {
            assert!(one.to_glb() != HOUSE.to_glb(), "{name} changes nothing");
        }
    }
}

/// What the importer makes of the GLB is what the export calls its model; and the OBJ is the same building.
#[test]
fn files_and_models_agree() {
    for (name, style) in all_styles() {
        let export = HOUSE.export(&style);
        let (made, glb) = (export.to_model().unwrap(), read(&export, &style, "house.glb"));
        assert_eq!(made.elements.len(), glb.elements.len(), "{name}");
        assert_eq!(made.frame, glb.frame, "{name}");
        for (a, b) in made.elements.iter().zip(&glb.elements) {
            assert_eq!(a.mesh, b.mesh, "{name}: {}", b.path);
            assert_eq!(
                (&a.storey, &a.host, &a.filling, &a.opening),
                (&b.storey, &b.host, &b.filling, &b.opening)
            );
            assert_eq!((&a.class, &a.source_name, &a.name), (&b.class, &b.source_name, &b.name), "{name}");
            assert_eq!((&a.extras, &a.inherited, &a.place), (&b.extras, &b.inherited, &b.place), "{name}");
            assert_eq!(a.other_names, b.other_names, "{name}");
            if style.doubled_names == 0.0 {
                assert_eq!((&a.id, &a.path), (&b.id, &b.path), "{name}");
            }
        }
        for (a, b) in made.lights.iter().zip(&glb.lights) {
            assert_eq!((&a.name, a.position), (&b.name, b.position), "{name}");
        }
        for (a, b) in made.cameras.iter().zip(&glb.cameras) {
            assert_eq!(a.eye, b.eye, "{name}");
            assert!((0..3).all(|i| (a.direction[i] - b.direction[i]).abs() < 1e-12), "{name}");
        }
        let lights = (glb.lights.len(), glb.cameras.len());
        assert_eq!(lights, (HOUSE.lights.len(), HOUSE.cameras.len()), "{name}");

        let obj = read(&export, &style, "house.obj");
        // There, parts have names and no identity: only those that close each other are surely one element's.
        if style.split_by_material > 0.0 {
            continue;
        }
        assert_eq!(obj.elements.len(), glb.elements.len(), "{name}");
        // Rooms of a storey are below its space in glTF; here all is in one row.
        let sorted = |model: &Model| {
            let mut all: Vec<(String, f64)> =
                model.elements.iter().map(|e| (e.class.clone().unwrap_or_default(), area(e))).collect();
            all.sort_by(|a, b| (&a.0, a.1).partial_cmp(&(&b.0, b.1)).unwrap());
            all
        };
        // Of some faces that are doubled, others are if they are polygons.
        if style.doubled_faces == 0.0 || style.doubled_faces == 1.0 {
            for (a, b) in sorted(&obj).iter().zip(sorted(&glb)) {
                assert!(a.0 == b.0 && (a.1 - b.1).abs() <= 1e-4 * b.1, "{name}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn options_do_not_change_each_other() {
    let alone = model(|s| s.wall_ends = 0.5);
    let together = model(|s| {
        (s.wall_ends, s.nameless, s.rooms_smaller, s.floors) = (0.5, 0.5, 1.0, 1.0);
    });
    let (mut moved, mut stayed) = (0, 0);
    for (old, now) in pairs(&together).into_iter().filter(|(old, _)| old.semantic == Semantic::Wall) {
        let alone = alone.elements.iter().find(|e| e.id == old.id).unwrap();
        assert_eq!(now.mesh, alone.mesh);
        *(if now.mesh == old.mesh { &mut stayed } else { &mut moved }) += 1;
    }
    assert!(moved >= 3 && stayed >= 3, "a share of a half: {moved} moved, {stayed} stayed");
    let other = HOUSE.export(&{
        let mut style = styled(|s| s.wall_ends = 0.5);
        style.seed = 2;
        style
    });
    assert!(other.to_model().unwrap().elements != alone.elements, "the seed decides");
}

#[test]
fn walls_run_on_within_other_solids() {
    let changed = model(|s| s.wall_ends = 1.0);
    let scene = compile(&EXACT, &CompileOptions::default()).unwrap().scene();
    let mut moved = 0;
    for (old, now) in pairs(&changed) {
        assert!(is_closed(now), "{}", old.name);
        if old.mesh == now.mesh {
            continue;
        }
        assert_eq!(old.semantic, Semantic::Wall);
        let ([lo, hi], [new_lo, new_hi]) = (bounds(old), bounds(now));
        let size = [hi[0] - lo[0], hi[1] - lo[1]];
        let (long, thickness) = if size[0] > size[1] { (0, size[1]) } else { (1, size[0]) };
        assert_eq!((new_lo[1 - long], new_hi[1 - long]), (lo[1 - long], hi[1 - long]));
        for (from, to) in [(new_lo[long], lo[long]), (hi[long], new_hi[long])] {
            let by = to - from;
            if by < FLOAT {
                assert!(by.abs() < FLOAT);
                continue;
            }
            moved += 1;
            // A thing of at least 0.12 m is met.
            assert!(by <= thickness + FLOAT && by >= 0.25 * 0.119, "{} by {by}", old.name);
            // What is new of it lies in what was solid before.
            for step in 0..200 {
                let share = |k: u32| f64::from(step * k % 199 + 1) / 201.0;
                let mut p = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * share(i as u32 * 17 + 5));
                p[long] = from + by * share(11);
                let place = scene.locate(p);
                assert!(matches!(place, Place::InSolid(_)), "{}: {p:?} was {place:?}", old.name);
            }
        }
    }
    assert!(moved >= 12, "{moved} ends");
}

#[test]
fn walls_have_two_bodies() {
    let (touching, lapped, inner) = (
        model(|s| s.walls_touching = 1.0),
        model(|s| s.walls_lapped = 1.0),
        model(|s| s.walls_inner_face = 1.0),
    );
    let walls = |model: &Model| -> Vec<Element> { of_class(model, "IfcWallStandardCase").cloned().collect() };
    assert_eq!(walls(&touching).len(), 14);
    for (((old, touching), lapped), inner) in
        walls(&EXACT).iter().zip(walls(&touching)).zip(walls(&lapped)).zip(walls(&inner))
    {
        assert_eq!((parts(old).len(), old.id.as_str()), (1, touching.id.as_str()));
        // Both sides of the cut: triangles that are there in both directions.
        let all: BTreeSet<_> = triangles(&touching.mesh).into_iter().collect();
        let doubled = all.iter().filter(|[a, b, c]| all.contains(&[*a, *c, *b])).count();
        assert!(doubled >= 4 && doubled % 4 == 0, "{}: {doubled}", old.name);
        assert!(is_closed(&touching) && (volume(&touching) - volume(old)).abs() < 1e-9, "{}", old.name);

        let bodies = parts(&lapped);
        assert!(bodies.len() == 2 && is_closed(&lapped) && bodies.iter().all(|b| b.signed_volume > 0.0));
        let ([_, hi], [lo, _]) = (bodies[0].bounds, bodies[1].bounds);
        let laps: Vec<f64> = (0..2).map(|i| hi[i] - lo[i]).collect();
        assert!(laps.iter().any(|lap| (lap - 0.02).abs() < 1e-3), "{}: {laps:?}", old.name);
        // The overlap is 20 mm of the wall's section.
        let section = (volume(&lapped) - volume(old)) / 0.0195;
        assert!(section > 0.05 && section < 0.38 * 2.7, "{}: {section} m2", old.name);

        let body = &parts(&inner)[0];
        assert!(!body.closed && body.open_edges >= 4, "{}", old.name);
        assert_eq!(inner.mesh.triangles.len(), touching.mesh.triangles.len() - doubled / 2);
    }
}

#[test]
fn openings_stick_out_or_fall_short() {
    let ends = |model: &Model| -> Vec<f64> {
        let mut steps = Vec::new();
        for (old, now) in
            pairs(model).into_iter().filter(|(old, _)| old.class.as_deref() == Some("IfcOpeningElement"))
        {
            assert!(is_closed(now), "{}", old.name);
            // Through the wall, which is where an opening is as thick as its host.
            let host = EXACT.elements.iter().find(|e| Some(&e.id) == old.host.as_ref()).unwrap();
            let ([lo, hi], [wall_lo, wall_hi], [new_lo, new_hi]) = (bounds(old), bounds(host), bounds(now));
            let through = (0..2).find(|&i| lo[i] == wall_lo[i] && hi[i] == wall_hi[i]).unwrap();
            for axis in 0..3 {
                let (low, high) = (lo[axis] - new_lo[axis], new_hi[axis] - hi[axis]);
                if axis == through {
                    steps.extend([low, high]);
                    assert!((-low).max(-high) <= 0.25 * (hi[axis] - lo[axis]) + FLOAT);
                } else {
                    assert_eq!((low, high), (0.0, 0.0), "{}", old.name);
                }
            }
        }
        assert_eq!(steps.len(), 46);
        steps
    };
    let out = ends(&model(|s| s.openings_protruding = 1.0));
    assert!(out.iter().all(|step| (0.01 - FLOAT..=0.15 + FLOAT).contains(step)), "{out:?}");
    let short = ends(&model(|s| s.openings_shallow = 1.0));
    assert!(short.iter().all(|&step| step == 0.0 || -step >= 0.005 - FLOAT), "{short:?}");
    let kept = short.iter().filter(|&&step| step == 0.0).count();
    assert!((4..=20).contains(&kept), "one end or both: {kept} of 46 stay");
}

#[test]
fn rooms_keep_off_their_walls() {
    for (sign, changed) in [(-1.0, model(|s| s.rooms_smaller = 1.0)), (1.0, model(|s| s.rooms_larger = 1.0))]
    {
        let mut steps = Vec::new();
        for (old, now) in pairs(&changed) {
            if old.semantic != Semantic::Room {
                assert_eq!(old.mesh, now.mesh);
                continue;
            }
            assert!(is_closed(now));
            assert_eq!(old.mesh.positions.len(), now.mesh.positions.len());
            // Walls, floors and ceilings of the house lie along the axes: each corner moves on each axis by that face's
            // step.
            for (p, q) in old.mesh.positions.iter().zip(&now.mesh.positions) {
                steps.extend((0..3).map(|i| (q[i] - p[i]).abs()).filter(|step| *step > FLOAT));
            }
            let ([lo, hi], [new_lo, new_hi]) = (bounds(old), bounds(now));
            for i in 0..3 {
                assert!(
                    sign * (lo[i] - new_lo[i]) > 9e-5 && sign * (new_hi[i] - hi[i]) > 9e-5,
                    "{}",
                    old.name
                );
            }
            assert!(sign * (volume(now) - volume(old)) > 0.0);
        }
        assert!(steps.iter().all(|step| (1e-4 - FLOAT..=1e-2 + FLOAT).contains(step)));
        assert!(steps.iter().any(|&step| step < 1e-3) && steps.iter().any(|&step| step > 2e-3));
    }
}

#[test]
fn finish_floors_lie_in_rooms_or_below_them() {
    for below in [false, true] {
        let changed = model(|s| *(if below { &mut s.floors_below } else { &mut s.floors }) = 1.0);
        let floors: Vec<&Element> = of_class(&changed, "IfcCovering").collect();
        assert_eq!((floors.len(), changed.elements.len()), (8, EXACT.elements.len() + 8));
        for (old, now) in pairs(&changed).into_iter().filter(|(old, _)| old.semantic == Semantic::Room) {
            let floor = floors.iter().find(|f| f.name == format!("{} floor", old.name)).unwrap();
            assert_eq!(
                (floor.semantic, floor.extras["predefined_type"].as_str()),
                (Semantic::Ground, "FLOORING")
            );
            assert!(is_closed(floor) && floor.storey == old.storey);
            let ([lo, hi], [floor_lo, floor_hi]) = (bounds(old), bounds(floor));
            let thickness = floor_hi[2] - floor_lo[2];
            assert!((0.01..=0.03).contains(&thickness) && floor_lo[2] == lo[2]);
            assert_eq!([floor_lo[0], floor_lo[1], floor_hi[0], floor_hi[1]], [lo[0], lo[1], hi[0], hi[1]]);
            // The house's rooms are prisms of 2.6 m, but for a hearth.
            let area = volume(floor) / thickness;
            assert!((area / (volume(old) / 2.599_609_375) - 1.0).abs() < 0.01, "{}: {area} m2", old.name);
            assert_eq!(bounds(now)[0][2], if below { floor_hi[2] } else { lo[2] });
            assert!(is_closed(now) && bounds(now)[1] == hi);
        }
    }
    // The tag is found in the file, too.
    let style = styled(|s| s.floors = 1.0);
    let read = read(&HOUSE.export(&style), &style, "house.glb");
    assert!(of_class(&read, "IfcCovering").all(|e| e.semantic == Semantic::Ground));
}

#[test]
fn names_and_identities_are_missing_or_doubled() {
    for file in ["house.glb", "house.obj"] {
        let imported = |style: Style| read(&HOUSE.export(&style), &style, file);
        let nameless = imported(styled(|s| s.nameless = 0.5));
        let without = nameless.elements.iter().filter(|e| e.name.is_empty() || e.name == e.id).count();
        assert!((40..80).contains(&without), "{file}: {without} of 120");
        assert!(nameless.elements.iter().all(|e| e.class.is_some() && !e.id.is_empty()));

        let doubled = imported(styled(|s| s.doubled_names = 1.0));
        let names: BTreeSet<_> = doubled.elements.iter().map(|e| (&e.class, &e.name)).collect();
        let classes: BTreeSet<_> = doubled.elements.iter().map(|e| &e.class).collect();
        assert_eq!(names.len(), classes.len(), "{file}: one name a class");
        assert_eq!(pairs(&doubled).len(), 120, "{file}: identities stay");

        let doubled = imported(styled(|s| s.doubled_ids = 0.5));
        let renamed = doubled.elements.iter().filter(|e| e.id.contains('~')).count();
        assert!(renamed > 20, "{file}: {renamed} identities were there before");
        assert_eq!((doubled.elements.len(), doubled.warnings.len()), (120, 1), "{file}");
    }
}

#[test]
fn openings_and_rooms_are_left_out() {
    let bare = model(|s| s.openings_missing = 1.0);
    assert_eq!(of_class(&bare, "IfcOpeningElement").count(), 0);
    assert_eq!((bare.elements.len(), of_class(&bare, "IfcDoor").count()), (120 - 23, 9));
    assert!(bare.elements.iter().all(|e| e.opening.is_none()));
    let bare = model(|s| s.rooms_missing = 1.0);
    assert_eq!((of_class(&bare, "IfcSpace").count(), bare.elements.len()), (0, 112));
    let some = model(|s| s.openings_missing = 0.5);
    assert!((4..20).contains(&of_class(&some, "IfcOpeningElement").count()));
    let open = some.elements.iter().filter(|e| e.opening.is_some());
    assert!(open.clone().count() > 0);
    assert!(open.into_iter().all(|e| some.elements.iter().any(|o| Some(&o.id) == e.opening.as_ref())));
}

#[test]
fn rooms_are_below_a_space_of_their_storey() {
    let style = styled(|s| s.storey_spaces = true);
    let model = read(&HOUSE.export(&style), &style, "house.glb");
    let spaces: Vec<&Element> = of_class(&model, "IfcSpace").collect();
    assert!(spaces.len() == 9 && spaces.iter().all(|e| e.semantic == Semantic::Room && is_closed(e)));
    let storey = spaces.iter().find(|e| e.name == "Ground floor").unwrap();
    let rooms = || spaces.iter().filter(|e| e.name != storey.name);
    assert!(rooms().all(|room| room.path == format!("{}/{}", storey.path, room.source_name)));
    let sum: f64 = rooms().map(|room| volume(room)).sum();
    assert!((volume(storey) - sum).abs() < 1e-6 * sum);
}

#[test]
fn faces_are_doubled_and_turned() {
    for (old, now) in pairs(&model(|s| s.doubled_faces = 1.0)) {
        let (one, two) = (triangles(&old.mesh), triangles(&now.mesh));
        assert!(two.len() == 2 * one.len() && two.chunks(2).zip(&one).all(|(pair, t)| pair == [*t, *t]));
    }
    let some = model(|s| s.doubled_faces = 0.1);
    let (more, all) = (some.triangle_count() - EXACT.triangle_count(), EXACT.triangle_count());
    assert!(more * 20 > all && more * 20 < all * 3, "{more} of {all}");

    for (old, now) in pairs(&model(|s| s.inside_out = 1.0)) {
        assert!((volume(now) + volume(old)).abs() < 1e-9 * volume(old).max(1.0), "{}", old.name);
        assert!(parts(now).iter().all(|p| p.closed && p.orientation == Orientation::Consistent));
    }
    let inward =
        pairs(&model(|s| s.inside_out = 0.2)).into_iter().filter(|(_, now)| volume(now) < 0.0).count();
    assert!((12..40).contains(&inward), "{inward} of 120 elements");

    for (old, now) in pairs(&model(|s| s.mixed_winding = 1.0)) {
        let parts = parts(now);
        assert!(parts.iter().all(|p| p.closed), "{}", old.name);
        assert!(parts.iter().any(|p| p.orientation == Orientation::Mixed), "{}", old.name);
    }
}

#[test]
fn vertices_are_taken_apart() {
    let style = styled(|s| s.unwelded = 1.0);
    let glb = HOUSE.export(&style).to_glb();
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let count = |kind: &str| -> u64 {
        let of_kind = json["accessors"].as_array().unwrap().iter().filter(|a| a["type"] == kind);
        of_kind.map(|a| a["count"].as_u64().unwrap()).sum()
    };
    assert_eq!((count("VEC3"), count("SCALAR")), (3 * EXACT.triangle_count(), 3 * EXACT.triangle_count()));
    for (old, now) in pairs(&read(&HOUSE.export(&style), &style, "house.glb")) {
        assert_eq!(old.mesh, now.mesh, "equal corners are one again");
    }

    for (old, now) in pairs(&model(|s| s.noisy_corners = 1.0)) {
        assert!(!is_closed(now), "{}", old.name);
        assert_eq!(old.mesh.triangles.len(), now.mesh.triangles.len());
        for t in 0..old.mesh.triangles.len() {
            let (a, b) = (old.mesh.corners(t), now.mesh.corners(t));
            assert!((0..9).all(|i| (a[i / 3][i % 3] - b[i / 3][i % 3]).abs() <= 1e-6 + FLOAT));
        }
    }
}

#[test]
fn materials_are_nodes_of_their_own_and_read_as_one_element() {
    let style = styled(|s| s.split_by_material = 1.0);
    let export = HOUSE.export(&style);
    let glb = export.to_glb();
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let meshes = json["meshes"].as_array().unwrap();
    assert!(meshes.len() > EXACT.elements.len());
    assert!(meshes.iter().all(|mesh| mesh["primitives"].as_array().unwrap().len() == 1));
    let part = json["nodes"].as_array().unwrap().iter().find(|n| n["name"] == "IfcWindow:Living south_1");
    assert!(part.unwrap().get("extras").is_none(), "parts have no metadata");
    let obj = export.to_obj("house.mtl").0;
    assert!(obj.lines().any(|line| line == "o IfcWindow:Living south_1"));

    let exact = Style::exact();
    for file in ["house.glb", "house.obj"] {
        let model = read(&export, &style, file);
        let exact = read(&HOUSE.export(&exact), &exact, file);
        let by_path: BTreeMap<&str, &Element> = model.elements.iter().map(|e| (e.path.as_str(), e)).collect();
        let mut apart = 0;
        for old in &exact.elements {
            let Some(now) = by_path.get(old.path.as_str()) else {
                // In OBJ, a leaf and its handle, each closed, stay two things.
                let part = by_path[format!("{}_1", old.path).as_str()];
                assert!(file.ends_with("obj") && is_closed(part), "{file}: {}", old.path);
                apart += 1;
                continue;
            };
            assert_eq!((&old.name, &old.class, &old.storey), (&now.name, &now.class, &now.storey), "{file}");
            assert_eq!((old.semantic, &old.extras), (now.semantic, &now.extras), "{file}: {}", old.name);
            assert_eq!(triangles(&old.mesh), triangles(&now.mesh), "{file}: {}", old.name);
            assert!(is_closed(now), "{file}: {}", old.name);
        }
        let most = if file.ends_with("obj") { 20 } else { 0 };
        assert!(apart <= most && model.elements.len() <= exact.elements.len() + 2 * most, "{file}: {apart}");
    }
    // The identity is in the metadata, which OBJ parts do not have.
    let ids = |model: &Model| model.elements.iter().map(|e| e.id.clone()).collect::<Vec<_>>();
    assert_eq!(ids(&read(&export, &style, "house.glb")), ids(&EXACT));
}

#[test]
fn coordinates_are_off_any_grid() {
    let changed = model(|s| s.off_grid = true);
    let shift = [1.0 / 3.0, -1.0 / 7.0, 1.0 / 11.0];
    let (mut on_grid, mut all, mut farthest) = (0, 0, 0.0f64);
    for (old, now) in pairs(&changed) {
        assert!(is_closed(now), "{}", old.name);
        for (p, q) in old.mesh.positions.iter().zip(&now.mesh.positions) {
            for i in 0..3 {
                let off = (q[i] - p[i] - shift[i]).abs();
                farthest = farthest.max(off);
                all += 1;
                on_grid += u32::from((q[i] * 1024.0).fract() == 0.0);
            }
        }
    }
    assert!(farthest <= 5e-6 + FLOAT && farthest > 4e-6, "{farthest}");
    assert!(on_grid * 100 < all, "{on_grid} of {all}");
    let ([x, y, z], [a, b, c]) = (EXACT.lights[0].position, changed.lights[0].position);
    assert_eq!([a, b, c], [x + shift[0], y + shift[1], z + shift[2]]);
}

#[test]
fn the_house_is_turned() {
    let changed = model(|s| s.turned = true);
    let (sine, cosine) = 23.7f64.to_radians().sin_cos();
    let turned = |[x, y, z]: [f64; 3]| [cosine * x - sine * y, sine * x + cosine * y, z];
    let near = |p: [f64; 3], q: [f64; 3], most: f64| (0..3).all(|i| (p[i] - q[i]).abs() <= most);
    for (old, now) in pairs(&changed) {
        assert!(is_closed(now));
        let all = old.mesh.positions.iter().zip(&now.mesh.positions);
        assert!(all.into_iter().all(|(p, q)| near(turned(*p), *q, FLOAT)), "{}", old.name);
    }
    for (old, now) in EXACT.lights.iter().zip(&changed.lights) {
        assert!(near(turned(old.position), now.position, 1e-12));
    }
    for (old, now) in EXACT.cameras.iter().zip(&changed.cameras) {
        assert!(near(turned(old.eye), now.eye, 1e-12) && near(turned(old.direction), now.direction, 1e-12));
    }
    // The garden's corners are the box's: 26 x 25.5 m, now turned.
    let [lo, hi] = changed.bounds().unwrap();
    let [old_lo, old_hi] = EXACT.bounds().unwrap();
    let size = [0, 1].map(|i| old_hi[i] - old_lo[i]);
    assert!((hi[0] - lo[0] - (cosine * size[0] + sine * size[1])).abs() < FLOAT);
    assert!((hi[1] - lo[1] - (sine * size[0] + cosine * size[1])).abs() < FLOAT);
}

#[test]
fn far_away_and_in_other_units_it_is_the_same_house() {
    for (unit, far) in
        [(Unit::Metre, true), (Unit::Centimetre, false), (Unit::Millimetre, false), (Unit::Millimetre, true)]
    {
        let style = styled(|s| (s.unit, s.far) = (unit, far));
        let export = HOUSE.export(&style);
        for file in ["house.glb", "house.obj"] {
            let model = read(&export, &style, file);
            let offset = model.frame.offset;
            assert_eq!(model.frame.has_offset(), far, "{file}");
            assert!(!far || (offset[1] > 5.4e6 && offset[0] > 4.5e5), "{offset:?}");
            // In whole metres from where the house stands, and 0.4, 0.7 and 0.3 m more.
            let shift = if far { [458_123.4, 5_427_891.7, 112.3] } else { [0.0; 3] };
            let shift = [0, 1, 2].map(|i| shift[i] - offset[i]);
            let pairs = pairs(&model);
            assert_eq!(pairs.len(), 120);
            for (old, now) in pairs {
                let count = old.mesh.positions.len();
                assert_eq!((now.mesh.positions.len(), is_closed(now)), (count, true), "{file}: {}", old.name);
                let find = |p: &[f64; 3]| {
                    now.mesh.positions.iter().any(|q| (0..3).all(|i| (q[i] - p[i] - shift[i]).abs() <= FLOAT))
                };
                assert!(old.mesh.positions.iter().all(find), "{file}: {}", old.name);
            }
        }
        // The numbers in the file are of that unit, and near the origin whatever the place.
        let glb = export.to_glb();
        let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
        let widest = json["accessors"][0]["max"][0].as_f64().unwrap();
        assert!((widest * unit.metres() - 19.0).abs() < 1e-3, "{widest}");
        let root = &json["nodes"][json["scenes"][0]["nodes"][0].as_u64().unwrap() as usize];
        assert_eq!(root["matrix"][0].as_f64().unwrap(), unit.metres());
        assert_eq!(root["matrix"][14].as_f64().unwrap(), if far { -5_427_891.7 } else { 0.0 });
    }
}

#[test]
fn damage_grows_with_its_probability() {
    let count = |p: f64| {
        let mut on = [0; 5];
        for seed in 0..200 {
            let style = Style::damage(p, seed);
            let options =
                [style.storey_spaces, style.off_grid, style.turned, style.far, style.unit != Unit::Metre];
            on.iter_mut().zip(options).for_each(|(sum, is_on)| *sum += u32::from(is_on));
            assert!(style.clone().shares_mut().iter().all(|(_, share)| **share == p));
        }
        on
    };
    assert_eq!((count(0.0), count(1.0)), ([0; 5], [200; 5]));
    assert!(count(0.3).iter().all(|on| (40..=80).contains(on)), "{:?}", count(0.3));
}

#[test]
fn the_command_writes_the_same() {
    let folder = Folder::new();
    let run = |arguments: &[&str]| folder.run(&[&["generate", "house"], arguments].concat());
    run(&["--style", "cad", "--style-seed", "4", "--far", "-o", "a.glb"]).expect(0);
    let mut style = Style::cad(4);
    style.far = true;
    assert!(folder.read("a.glb") == HOUSE.export(&style).to_glb());
    run(&["--rooms-smaller", "--nameless=0.25", "--written-in", "mm", "-o", "b.obj"]).expect(0);
    let mut style = Style::exact();
    (style.rooms_smaller, style.nameless, style.unit) = (1.0, 0.25, Unit::Millimetre);
    assert!(folder.read("b.obj") == HOUSE.export(&style).to_obj("b.mtl").0.into_bytes());
    run(&["--damage", "0.4", "-o", "c.glb"]).expect(0);
    assert!(folder.read("c.glb") == HOUSE.export(&Style::damage(0.4, 0)).to_glb());
    assert_eq!(run(&["--damage", "1.5", "-o", "d.glb"]).code, 2);
}
