//! Random points: each in exactly one cell, which says what the meshes say.

use enfilade::arbitrary::{Finding, Space};
use enfilade::partition::cells::Label;

use super::truth::{Meshes, Random};

/// Points looked at for each building.
const POINTS: usize = 48;
/// A room may reach so far over unlabelled air, metres: gaps of 5 cm in the plan, farther along slopes.
const THIN: f64 = 0.1;
/// Points nearer to a cell's border than this may be in two cells, or in none; lattice units.
const BORDER: f64 = 2.0;

pub fn check(space: &Space<'_>, meshes: &Meshes<'_>, random: &mut Random) -> Vec<Finding> {
    let mut findings = Vec::new();
    let hull = space.partition.hull;
    for k in 0..POINTS {
        let local = match k % 4 {
            0 => [0, 1, 2].map(|i| random.between(f64::from(hull[0][i]), f64::from(hull[1][i]))),
            // Halfway between lattice points.
            1 => {
                [0, 1, 2].map(|i| random.between(f64::from(hull[0][i]), f64::from(hull[1][i])).floor() + 0.5)
            }
            // In the box of an element.
            _ => {
                let elements = &meshes.model.elements;
                let element = &elements[(random.next() * elements.len() as f64) as usize];
                let first = element.mesh.positions[0];
                let [lo, hi] = element.mesh.positions.iter().fold([first; 2], |[lo, hi], p| {
                    [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
                });
                space.local([0, 1, 2].map(|i| random.between(lo[i] - 0.02, hi[i] + 0.02)))
            }
        };
        at(space, meshes, local, &mut |kind, text| findings.push(Finding { kind, text }));
    }
    findings
}

/// Checks one point, in lattice units.
pub fn at(
    space: &Space<'_>,
    meshes: &Meshes<'_>,
    local: [f64; 3],
    find: &mut dyn FnMut(&'static str, String),
) {
    let depths: Vec<(usize, f64)> = (0..space.footprints.len())
        .map(|c| (c, space.depth(c, local)))
        .filter(|(_, d)| *d > -BORDER)
        .collect();
    let inside: Vec<usize> = depths.iter().filter(|(_, d)| *d > BORDER).map(|(c, _)| *c).collect();
    // The hull stands along the lattice: the box of an element along the model's axes may reach beyond it.
    let in_hull = space.depth_in_hull(local);
    if depths.is_empty() && in_hull > -BORDER {
        find("no cell", format!("{local:?}"));
    }
    if !inside.is_empty() && in_hull < 0.0 {
        find("beyond the hull", format!("{local:?}: {inside:?}, {} units", -in_hull));
    }
    if inside.len() > 1 {
        find("cells overlap", format!("{local:?}: {inside:?}"));
    }
    let found = match inside[..] {
        [cell] => match space.cell(cell).label {
            Label::Void => Label::Exterior,
            label => label,
        },
        [] if in_hull < -BORDER => Label::Exterior,
        _ => return,
    };
    let lattice = &space.partition.lattice;
    let p = lattice.metres(local);
    let distance = meshes.distance(p);
    if distance <= meshes.margin {
        return;
    }
    let expected = meshes.labels_at(p);
    if expected.is_empty() {
        return;
    }
    if expected.contains(&found) {
        return;
    }
    let text =
        || format!("{local:?}, {distance} m from surfaces, in {inside:?}: {found:?}, expected {expected:?}");
    match found {
        // A gap beside a room is the room's.
        Label::Air(e) if expected == [Label::Exterior] && meshes.is_room(e) => {
            let far = meshes.distance_to(p, e);
            if far > THIN + meshes.margin {
                find("room too far", format!("{far} m; {}", text()));
            }
        }
        _ => find("label", text()),
    }
}
