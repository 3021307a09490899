//! Doors and windows: frames, leaves and panes, drawn in the frame of the hole that they fill.
//!
//! Panes are bodies of their own, which touch their frame: light that goes through a pane meets the frame around it.

use super::lattice::{Cuboid, Placement, units};
use super::palette::{GLASS, STEEL, WHITE_PAINT};
use super::plan::Plan;

/// A box with its material; `None` takes away.
type Painted = (Cuboid, Option<u32>);

/// A hole in a wall, in its own frame: u from 0 to `width` along the wall, v from 0 at the wall's face in the room
/// that doors swing into, down to `-depth`, z from 0 to `height`.
#[derive(Clone, Copy, Debug)]
pub struct Hole {
    /// Where it is.
    pub place: Placement,
    /// Along the wall, units.
    pub width: i32,
    /// Through the wall, units.
    pub depth: i32,
    /// Units.
    pub height: i32,
}

/// Which end of the hole a leaf hangs at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hinge {
    /// At u = 0.
    Low,
    /// At u = width.
    High,
}

/// How far a leaf stands open: an angle whose sine and cosine are the fractions `sine / whole` and
/// `cosine / whole`, so that a leaf drawn in multiples of `whole` units is on the grid when it is turned, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ajar {
    sine: i32,
    cosine: i32,
    whole: i32,
}

/// Shut, and 23, 37 and 53 degrees open.
pub const AJAR: [Ajar; 4] = [
    Ajar { sine: 0, cosine: 1, whole: 1 },
    Ajar { sine: 5, cosine: 12, whole: 13 },
    Ajar { sine: 3, cosine: 4, whole: 5 },
    Ajar { sine: 4, cosine: 3, whole: 5 },
];

/// A leaf to hang into a door frame.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    /// Where it hangs.
    pub hinge: Hinge,
    /// How far it is open.
    pub ajar: Ajar,
    /// Whether it is a pane in a frame, rather than a board.
    pub glazed: bool,
    /// Its material.
    pub paint: u32,
}

/// Width of a door's lining, metres.
const LINING: f64 = 0.04;

/// Room around a leaf, metres.
const GAP: f64 = 0.004;

/// A door: a lining around the hole, and one leaf or two.
pub fn door(hole: &Hole, leaves: &[Leaf]) -> Vec<Plan> {
    let lining = units(LINING);
    let Hole { width, depth, height, .. } = *hole;
    let frame = [
        (Cuboid { lo: [0, -depth, 0], hi: [width, 0, height] }, Some(WHITE_PAINT)),
        (Cuboid { lo: [lining, -depth, 0], hi: [width - lining, 0, height - lining] }, None),
    ];
    let mut plans = vec![standing(&hole.place, &frame)];
    let clear = width - 2 * units(LINING + GAP);
    let leaf_width = clear / leaves.len().max(1) as i32 - units(GAP / 2.0);
    plans.extend(leaves.iter().flat_map(|leaf| hung(hole, leaf, leaf_width)));
    plans
}

/// A leaf, turned open, in its place.
fn hung(hole: &Hole, leaf: &Leaf, width: i32) -> Vec<Plan> {
    let Ajar { sine, cosine, whole } = leaf.ajar;
    let hand = if leaf.hinge == Hinge::Low { 1 } else { -1 };
    let margin = units(LINING + GAP);
    let hinge = [if hand == 1 { margin } else { hole.width - margin }, -units(GAP)];
    let height = hole.height - units(LINING + GAP) - units(0.006);
    let turned = |[a, b]: [i32; 2]| {
        let u = (a * cosine - hand * b * sine) / whole;
        let v = (hand * a * sine + b * cosine) / whole;
        let [x, y] = hole.place.turn([hinge[0] + u, hinge[1] + v]);
        [hole.place.origin[0] + x, hole.place.origin[1] + y]
    };
    let raise = hole.place.origin[2] + units(0.006);
    let parts = leaf_boxes(width, height, leaf, hand, whole);
    parts.iter().map(|boxes| Plan::of_boxes(boxes).moved(turned).raised(raise)).collect()
}

/// The parts of a shut leaf: a from its hinge (towards `hand`), b from its front, plan coordinates in multiples of
/// `whole`.
fn leaf_boxes(width: i32, height: i32, leaf: &Leaf, hand: i32, whole: i32) -> Vec<Vec<Painted>> {
    let multiple = |c: i32| (c + c.signum() * whole / 2) / whole * whole;
    let width = width / whole * whole;
    let part = |a: [i32; 2], b: [i32; 2], z: [i32; 2], material| {
        let at = |a, b, z| [hand * multiple(a), multiple(b), z];
        (Cuboid::between(at(a[0], b[0], z[0]), at(a[1], b[1], z[1])), material)
    };
    let thick = -multiple(units(0.042));
    let mut boxes = vec![part([0, width], [thick, 0], [0, height], Some(leaf.paint))];
    let mut panes = Vec::new();
    if leaf.glazed {
        let stile = units(0.11);
        let (a, z) = ([stile, width - stile], [units(0.20), height - stile]);
        let (back, front) = (thick / 2 - units(0.012), thick / 2 + units(0.012));
        boxes.push(part(a, [thick, 0], z, None));
        panes.push(vec![part(a, [back, front], z, Some(GLASS))]);
    }
    // A lever on each side.
    let [from, to] = [width - units(0.16), width - units(0.05)];
    let z = [units(1.0), units(1.025)];
    for b in [[thick - units(0.045), thick], [0, units(0.045)]] {
        boxes.push(part([from, to], b, z, Some(STEEL)));
    }
    panes.push(boxes);
    panes
}

/// A window: a frame with `panes` panes side by side.
pub fn window(hole: &Hole, panes: i32) -> Vec<Plan> {
    let (w, h) = (hole.width, hole.height);
    let thick = units(0.07);
    // In the outer half of a thick wall.
    let outer = -hole.depth + (hole.depth - thick).max(0) * 2 / 5;
    let (rail, mullion) = (units(0.07), units(0.09));
    let glass = [outer + units(0.025), outer + units(0.045)];
    let mut boxes = vec![(Cuboid { lo: [0, outer, 0], hi: [w, outer + thick, h] }, Some(WHITE_PAINT))];
    let inner = w - 2 * rail + mullion;
    let mut parts = Vec::new();
    for i in 0..panes {
        let [a, b] = [rail + inner * i / panes, rail + inner * (i + 1) / panes - mullion];
        let at = |v: [i32; 2]| Cuboid { lo: [a, v[0], rail], hi: [b, v[1], h - rail] };
        boxes.push((at([outer, outer + thick]), None));
        parts.push(standing(&hole.place, &[(at(glass), Some(GLASS))]));
    }
    parts.push(standing(&hole.place, &boxes));
    parts
}

/// The plan of boxes given in a thing's own frame.
pub fn standing(place: &Placement, boxes: &[Painted]) -> Plan {
    let placed: Vec<_> = boxes.iter().map(|(cuboid, material)| (place.cuboid(cuboid), *material)).collect();
    Plan::of_boxes(&placed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_turn_on_the_grid() {
        for ajar in AJAR {
            assert_eq!(ajar.sine.pow(2) + ajar.cosine.pow(2), ajar.whole.pow(2));
            for hinge in [Hinge::Low, Hinge::High] {
                let leaf = Leaf { hinge, ajar, glazed: true, paint: 0 };
                let hand = if hinge == Hinge::Low { 1 } else { -1 };
                for (cuboid, _) in leaf_boxes(800, 2000, &leaf, hand, ajar.whole).concat() {
                    assert!(!cuboid.is_empty(), "{ajar:?} {hinge:?}");
                    let plan = [cuboid.lo[0], cuboid.lo[1], cuboid.hi[0], cuboid.hi[1]];
                    assert!(plan.iter().all(|c| c % ajar.whole == 0), "{ajar:?} {hinge:?}");
                }
            }
        }
    }
}
