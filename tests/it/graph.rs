//! The graph of a building: what openings join, and what surrounds rooms, against the truth of generated buildings.
#![cfg(feature = "compile")]

use std::collections::{BTreeMap, BTreeSet};

use enfilade::generate::{
    Building, HouseOptions, OfficeOptions, Style, TowerOptions, Unit, build1, house, random, tower,
};
use enfilade::graph::Side;
use enfilade::importers::{Model, Semantic};
use enfilade::{CompileOptions, Place, Scene, compile};

fn scene(model: &Model) -> Scene {
    compile(model, &CompileOptions::default()).unwrap().scene()
}

/// Every option alone, at its most; and some at once.
fn all_styles() -> Vec<(String, Style)> {
    let styled = |change: &dyn Fn(&mut Style)| {
        let mut style = Style::exact();
        style.seed = 1;
        change(&mut style);
        style
    };
    let mut all = vec![("exact".to_owned(), Style::exact())];
    for (name, _) in Style::exact().shares_mut() {
        let most = |style: &mut Style| {
            let found = style.shares_mut().into_iter().find(|(other, _)| *other == name);
            *found.unwrap().1 = 1.0;
        };
        all.push((name.to_owned(), styled(&most)));
    }
    all.push(("storey-spaces".to_owned(), styled(&|s| s.storey_spaces = true)));
    all.push(("off-grid".to_owned(), styled(&|s| s.off_grid = true)));
    all.push(("turned".to_owned(), styled(&|s| s.turned = true)));
    all.push(("far".to_owned(), styled(&|s| s.far = true)));
    all.push(("mm".to_owned(), styled(&|s| s.unit = Unit::Millimetre)));
    all.push(("cad".to_owned(), Style::cad(1)));
    all
}

/// Buildings in styles: one in all of them, the others as they are and as drawn by hand; a random one in some more of them, others for each test.
fn cases(first: usize) -> Vec<(Building, Vec<(String, Style)>)> {
    let few = || vec![("exact".to_owned(), Style::exact()), ("cad".to_owned(), Style::cad(2))];
    // Furniture stands in the first alone: what is joined does not hang on it.
    let bare = |seed| {
        let mut options = OfficeOptions::default();
        (options.seed, options.furniture) = (seed, false);
        options
    };
    let mut few_storeys = TowerOptions::default();
    (few_storeys.storeys, few_storeys.office.furniture) = (4, false);
    vec![
        (house(&HouseOptions::default()), all_styles()),
        (random(&bare(1)), all_styles().into_iter().skip(first).step_by(7).collect()),
        (random(&bare(2)), few()),
        (build1(&bare(OfficeOptions::default().seed)), few()),
        (tower(&few_storeys), few()),
    ]
}

/// The elements of the model with one of some meanings, and the ids that the truth has for them: both are in the order of the building. Where
/// identities stay, other elements may be between them.
fn named<'t>(
    scene: &Scene,
    is_meant: impl Fn(Semantic) -> bool,
    truth: impl Iterator<Item = &'t str> + Clone,
) -> BTreeMap<u32, &'t str> {
    let elements = || scene.elements().filter(|e| is_meant(e.semantic()));
    if elements().count() == truth.clone().count() {
        return elements().map(|e| e.index()).zip(truth).collect();
    }
    elements().filter_map(|e| Some((e.index(), truth.clone().find(|id| *id == e.id())?))).collect()
}

#[test]
fn openings_join_what_they_join_in_truth() {
    for (building, styles) in cases(3) {
        let truth = building.truth();
        for (name, style) in styles {
            if style.openings_missing > 0.0 || style.rooms_missing > 0.0 {
                continue;
            }
            let scene = scene(&building.export(&style).to_model().unwrap());
            let graph = scene.graph();
            let rooms =
                named(&scene, |s| s == Semantic::Room, truth.rooms.iter().map(|room| room.air.id.as_str()));
            let is_opening = |s| matches!(s, Semantic::Door | Semantic::Window | Semantic::Opening);
            let openings =
                named(&scene, is_opening, truth.openings.iter().map(|opening| opening.air.id.as_str()));
            assert_eq!(openings.len(), truth.openings.len(), "{} {name}", truth.name);
            assert_eq!(graph.openings.len(), truth.openings.len(), "{} {name}", truth.name);
            let joins: BTreeMap<&str, BTreeSet<&str>> = truth
                .openings
                .iter()
                .map(|o| (o.air.id.as_str(), o.joins.iter().map(|join| join.id.as_str()).collect()))
                .collect();
            for opening in &graph.openings {
                let id = openings[&opening.element];
                let side = |own| side(&scene, &rooms, &truth.exterior.id, own);
                let sides: BTreeSet<&str> = opening.sides.into_iter().map(side).collect();
                assert_eq!(
                    sides,
                    joins[id],
                    "{} {name}: {id} {}",
                    truth.name,
                    scene.element(opening.element).path()
                );
            }
        }
    }
}

/// The truth's own words for a side.
fn side<'a>(scene: &'a Scene, rooms: &BTreeMap<u32, &'a str>, exterior: &'a str, side: Side) -> &'a str {
    match side {
        Side::Room(room) => {
            let room = scene.room(room).element();
            rooms.get(&room.index()).copied().unwrap_or(room.path())
        }
        Side::Exterior => exterior,
        Side::Void => "VOID",
    }
}

#[test]
fn openings_are_found_where_none_are_tagged() {
    let is_filling = |class: &str| matches!(class, "IfcDoor" | "IfcWindow");
    for (building, styles) in cases(4) {
        let truth = building.truth();
        for (name, mut style) in styles {
            if style.rooms_missing > 0.0 {
                continue;
            }
            style.openings_missing = 1.0;
            let scene = scene(&building.export(&style).to_model().unwrap());
            let graph = scene.graph();
            let rooms =
                named(&scene, |s| s == Semantic::Room, truth.rooms.iter().map(|room| room.air.id.as_str()));
            let ids = building.elements.iter().filter(|e| is_filling(&e.class)).map(|e| e.global_id.as_str());
            let fillings: BTreeMap<&str, u32> =
                ids.zip(scene.elements().filter(|e| is_filling(e.class())).map(|e| e.index())).collect();
            let (mut all, mut right) = (0, 0);
            for opening in &truth.openings {
                let Some(filling) = &opening.filling else { continue };
                all += 1;
                let filling = fillings[filling.as_str()];
                let found =
                    graph.openings.iter().find(|o| scene.element(o.element).filling() == Some(filling));
                let sides: BTreeSet<&str> = found
                    .iter()
                    .flat_map(|o| o.sides)
                    .map(|own| side(&scene, &rooms, &truth.exterior.id, own))
                    .collect();
                let joins: BTreeSet<&str> = opening.joins.iter().map(|join| join.id.as_str()).collect();
                if sides == joins {
                    right += 1;
                } else {
                    println!(
                        "{} {name}: {} {:?} {sides:?} {joins:?}",
                        truth.name,
                        opening.air.name,
                        found.map(|o| o.direction)
                    );
                }
            }
            println!("{} {name}: {right} of {all}", truth.name);
            assert!(right * 100 >= all * 99, "{} {name}: {right} of {all}", truth.name);
        }
    }
}

/// Points at which rooms are compared.
const POINTS: usize = 60_000;

/// The share of the floor area of one scene's rooms that another scene has rooms for, each of which shares 90 % with it: what both hold by what
/// either does, of points of the plan at a height of 1.2 m over each floor.
fn found_again(truth: &Scene, scene: &Scene) -> f64 {
    let room = |scene: &Scene, point| match scene.locate(point) {
        Place::Air { room, .. } => room,
        _ => None,
    };
    let mut heights: Vec<f64> = truth.rooms().map(|room| room.bounds()[0][2] + 1.2).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|a, b| (*a - *b).abs() < 0.3);
    let [lo, hi] = truth.hull();
    let (mut both, mut sizes) = (BTreeMap::new(), [BTreeMap::new(), BTreeMap::new()]);
    // The points of the additive recurrence by the plastic number fill a square evenly.
    for (i, z) in (0..POINTS).map(|i| (i as f64 + 0.5, heights[i % heights.len()])) {
        let [u, v] = [0.754_877_666_246_693 * i % 1.0, 0.569_840_290_998_053 * i % 1.0];
        let point = [lo[0] + (hi[0] - lo[0]) * u, lo[1] + (hi[1] - lo[1]) * v, z];
        let rooms = [room(truth, point), room(scene, point)];
        for (size, room) in sizes.iter_mut().zip(rooms) {
            *size.entry(room).or_insert(0) += 1;
        }
        if let [Some(one), Some(other)] = rooms {
            *both.entry((one, other)).or_insert(0) += 1;
        }
    }
    let (mut all, mut found) = (0.0, 0.0);
    for (room, number) in truth.rooms().zip(0..) {
        let area = room.floor_area().unwrap_or(0.0);
        all += area;
        let again = both.iter().any(|(&(one, other), &count)| {
            let either = sizes[0][&Some(number)] + sizes[1][&Some(other)] - count;
            one == number && count * 10 >= either * 9
        });
        if again {
            found += area;
        } else {
            println!("not found again: {} {area:.1} m2", room.element().path());
        }
    }
    found / all
}

#[test]
fn rooms_are_found_where_none_are_tagged() {
    for (building, styles) in cases(5) {
        for (number, (name, mut style)) in styles.into_iter().enumerate() {
            if style.rooms_missing > 0.0 || style.openings_missing > 0.0 || style.storey_spaces {
                continue;
            }
            // Of corners that do not meet no room is closed.
            let noise = std::mem::take(&mut style.noisy_corners);
            let truth = scene(&building.export(&style).to_model().unwrap());
            style.noisy_corners = noise;
            let missing: &[f64] = if number == 0 { &[0.0, 1.0] } else { &[1.0] };
            for &openings_missing in missing {
                style.rooms_missing = 1.0;
                style.openings_missing = openings_missing;
                let found = scene(&building.export(&style).to_model().unwrap());
                let share = found_again(&truth, &found);
                println!("{} {name} without {openings_missing}: {share}", building.name);
                assert!(share >= 0.95, "{} {name} without {openings_missing}: {share}", building.name);
                assert!(found.rooms().all(|room| room.element().is_derived() && room.is_closed()));
            }
        }
    }
}
