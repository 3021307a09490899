//! The way from one room to another.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use enfilade_importers::Semantic;
use glam::DVec3;

use super::Building;
use super::portals::Portals;
use crate::partition::cells::Label;

/// How one goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct WayOptions {
    /// Whether to go through windows, too. Default: no.
    pub windows: bool,
    /// Whether to go through the open. Default: yes.
    pub outside: bool,
}

impl Default for WayOptions {
    fn default() -> WayOptions {
        WayOptions { windows: false, outside: true }
    }
}

/// A way from one label of air to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// What one goes through: the first, each opening, room or the open between, the last.
    pub through: Vec<Label>,
    /// The middles of the portals on the way, one between each two of [`Way::through`]; metres, internal frame.
    pub portals: Vec<[f64; 3]>,
    /// From the first portal's middle straight to the next, and so on, metres.
    pub length: f64,
}

/// A gate, and the label that one comes into through it.
type Step = (usize, Label);

/// By step: how far it is, and the step before.
type Steps = BTreeMap<Step, (f64, Option<Step>)>;

/// All portals between two labels.
struct Gate {
    between: [Label; 2],
    middle: DVec3,
}

impl Building {
    /// The shortest way from one label of air to another, as [`Way::length`] measures it; `None` if there is none.
    /// All portals between two labels count as one, at the middle of their area. Nobody goes through voids.
    pub fn way(&self, from: Label, to: Label, options: &WayOptions) -> Option<Way> {
        if from == to {
            let is_known = !self.volumes_of(from).is_empty() && from.is_air();
            return is_known.then(|| Way { through: vec![from], portals: Vec::new(), length: 0.0 });
        }
        let gates = self.gates(&|label| label == from || label == to || self.is_passable(label, options));
        let mut at: BTreeMap<Label, Vec<usize>> = BTreeMap::new();
        for (number, gate) in gates.iter().enumerate() {
            gate.between.into_iter().for_each(|label| at.entry(label).or_default().push(number));
        }
        let mut best: Steps = BTreeMap::new();
        // No length is negative, so that bits are in the order of lengths.
        let mut waiting = BinaryHeap::new();
        for &gate in at.get(&from)? {
            let into = gates[gate].beyond(from);
            best.insert((gate, into), (0.0, None));
            waiting.push(Reverse((0u64, gate, into)));
        }
        while let Some(Reverse((bits, gate, here))) = waiting.pop() {
            let length = f64::from_bits(bits);
            if best.get(&(gate, here)).is_some_and(|known| length > known.0) {
                continue;
            }
            if here == to {
                return Some(self.traced(from, (gate, here), length, &best, &gates));
            }
            for &next in at.get(&here).into_iter().flatten().filter(|&&next| next != gate) {
                let length = length + gates[gate].middle.distance(gates[next].middle);
                let key = (next, gates[next].beyond(here));
                if best.get(&key).is_none_or(|known| length < known.0) {
                    best.insert(key, (length, Some((gate, here))));
                    waiting.push(Reverse((length.to_bits(), next, key.1)));
                }
            }
        }
        None
    }

    fn traced(&self, from: Label, end: Step, length: f64, best: &Steps, gates: &[Gate]) -> Way {
        let (mut through, mut portals) = (Vec::new(), Vec::new());
        let mut here = Some(end);
        while let Some((gate, label)) = here {
            through.push(label);
            portals.push(gates[gate].middle.to_array());
            here = best.get(&(gate, label)).and_then(|known| known.1);
        }
        through.push(from);
        through.reverse();
        portals.reverse();
        Way { through, portals, length }
    }

    /// The portals between all labels that may be passed.
    fn gates(&self, is_passable: &dyn Fn(Label) -> bool) -> Vec<Gate> {
        let portals = Portals::of(self);
        let mut gates = Vec::new();
        for one in portals.places() {
            let beyond = portals.around(one).filter(|(other, portal)| one < *other && portal.area > 0.0);
            gates.extend(
                beyond
                    .filter(|(other, _)| is_passable(one.0) && is_passable(other.0))
                    .map(|(other, portal)| Gate { between: [one.0, other.0], middle: portal.middle }),
            );
        }
        gates
    }

    fn is_passable(&self, label: Label, options: &WayOptions) -> bool {
        match self.semantic(label) {
            Semantic::Window => options.windows,
            Semantic::Exterior => options.outside,
            Semantic::Void => false,
            _ => label.is_air(),
        }
    }
}

impl Gate {
    fn beyond(&self, label: Label) -> Label {
        if self.between[0] == label { self.between[1] } else { self.between[0] }
    }
}
