//! The levels of a building's floors: where its storeys begin.

use std::collections::BTreeMap;

use enfilade_importers::{Element, Model, Role, Semantic};
use glam::DVec3;

use super::matter::Bounds;

/// Storeys are at least so high, metres.
const LOWEST: f64 = 1.9;
/// What begins within this of each other begins on one floor, metres.
const ALIKE: f64 = 0.35;
/// A level is a floor's if it has this share of what the strongest has.
const SHARE: f64 = 0.04;
/// Walls lower than this are parapets, metres.
const PARAPET: f64 = 1.5;
/// What one door counts for, in metres of wall.
const DOOR: f64 = 4.0;

/// What speaks for a floor at a height.
#[derive(Clone, Copy, Debug)]
struct Sign {
    z: f64,
    weight: f64,
}

/// The levels of floors, ascending, and the top of what is solid. Metres, internal frame.
pub(super) fn floors(model: &Model, roles: &[Role]) -> Vec<f64> {
    let mut signs: Vec<Sign> = Vec::new();
    let (mut bottom, mut top) = (f64::INFINITY, f64::NEG_INFINITY);
    for (element, role) in model.elements.iter().zip(roles) {
        let bounds = Bounds::of(element.mesh.positions.iter().map(|&p| p.into()));
        if bounds.is_empty() {
            continue;
        }
        let size = bounds.hi - bounds.lo;
        if *role == Role::Solid {
            top = top.max(bounds.hi.z);
            bottom = bottom.min(bounds.lo.z);
        }
        let sign = match element.semantic {
            Semantic::Wall | Semantic::Unknown if *role == Role::Solid && size.z >= PARAPET => {
                Sign { z: bounds.lo.z, weight: size.truncate().length() }
            }
            Semantic::DoorLeaf | Semantic::Door => Sign { z: bounds.lo.z, weight: DOOR },
            Semantic::Ground if *role == Role::Solid => {
                signs.extend(treads(element));
                continue;
            }
            _ => continue,
        };
        signs.push(sign);
    }
    let signs = merged(signs);
    let strength = |z: f64| within(&signs, z, ALIKE).iter().map(|sign| sign.weight).sum::<f64>();
    let mut ranked: Vec<(f64, f64)> = signs.iter().map(|sign| (strength(sign.z), sign.z)).collect();
    ranked.dedup();
    // The strongest first; of equals the lower.
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let least = ranked.first().map_or(0.0, |first| SHARE * first.0);
    let mut floors: Vec<f64> = Vec::new();
    for (weight, z) in ranked {
        if weight >= least
            && z >= bottom
            && floors.iter().all(|floor| (floor - z).abs() >= LOWEST)
            && top - z >= LOWEST
        {
            floors.push(z);
        }
    }
    for floor in &mut floors {
        *floor = commonest(&signs, *floor);
    }
    floors.sort_by(f64::total_cmp);
    if !floors.is_empty() {
        floors.push(top);
    }
    floors
}

/// Signs in the order of their heights, those of one height as one, to the tenth of a millimetre.
fn merged(mut signs: Vec<Sign>) -> Vec<Sign> {
    signs.sort_by(|a, b| a.z.total_cmp(&b.z));
    let mut merged: Vec<Sign> = Vec::new();
    for sign in signs {
        match merged.last_mut() {
            Some(last) if sign.z - last.z < 1e-4 => last.weight += sign.weight,
            _ => merged.push(sign),
        }
    }
    merged
}

/// The signs no farther from a height than `reach`.
fn within(signs: &[Sign], z: f64, reach: f64) -> &[Sign] {
    let first = signs.partition_point(|sign| sign.z < z - reach);
    let end = signs.partition_point(|sign| sign.z <= z + reach);
    &signs[first..end]
}

/// The height near a floor that most speaks for.
fn commonest(signs: &[Sign], floor: f64) -> f64 {
    let exactly = |z: f64| within(signs, z, 2e-3).iter().map(|sign| sign.weight).sum::<f64>();
    let near = within(signs, floor, ALIKE).iter().map(|sign| (exactly(sign.z), sign.z));
    let best = near.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    best.map_or(floor, |best| best.1)
}

/// The level surfaces of a slab that look up: by the square root of their area, as walls count by their length.
fn treads(element: &Element) -> Vec<Sign> {
    let mut signs = Vec::new();
    for triangle in 0..element.mesh.triangles.len() {
        let [a, b, c] = element.mesh.corners(triangle).map(DVec3::from);
        let normal = (b - a).cross(c - a);
        if normal.z > 0.999 * normal.length() && normal.z > 0.0 {
            signs.push(Sign { z: a.z.max(b.z).max(c.z), weight: (normal.z / 2.0).sqrt() });
        }
    }
    signs
}

/// What storeys are called: as most of what begins in them says, else by number.
pub(super) fn names(model: &Model, floors: &[f64]) -> Vec<String> {
    let mut said: Vec<BTreeMap<&str, usize>> = vec![BTreeMap::new(); floors.len().saturating_sub(1)];
    for element in &model.elements {
        let bounds = Bounds::of(element.mesh.positions.iter().map(|&p| p.into()));
        let Some(storey) =
            element.storey.as_deref().filter(|storey| !storey.is_empty() && !bounds.is_empty())
        else {
            continue;
        };
        // What begins a little below a floor stands on it, too.
        let number = floors.partition_point(|floor| *floor <= bounds.lo.z + ALIKE);
        if let Some(said) = number.checked_sub(1).and_then(|number| said.get_mut(number)) {
            *said.entry(storey).or_default() += 1;
        }
    }
    let name = |(number, said): (usize, BTreeMap<&str, usize>)| {
        let most = said.into_iter().max_by(|a, b| a.1.cmp(&b.1).then(b.0.cmp(a.0)));
        most.map_or(format!("Storey {number}"), |most| most.0.to_owned())
    };
    said.into_iter().enumerate().map(name).collect()
}
