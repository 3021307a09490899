//! Wings against the north facade of a main wing.

use super::complex::{Apse, Complex, Foyer, MODULE, PlacedWing, Roof};
use super::sheet::Turn;
use super::wing::Wing;

/// A wing that is entered from a bay of the main wing's north row.
#[derive(Clone, Debug, PartialEq)]
pub struct Attached {
    /// Its name.
    pub name: &'static str,
    /// Its plan on each storey.
    pub storeys: Vec<Wing>,
    /// The bay, in which there must be a corridor.
    pub bay: usize,
    /// How far it is turned from the main wing's direction: at 90 it stands against the facade, its west end open;
    /// at less, from 20 on, at one corner of a foyer, its west end a passage.
    pub degrees: f64,
}

/// A building before its wings are in their places.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its name.
    pub name: &'static str,
    /// The main wing's plan on each storey.
    pub main: Vec<Wing>,
    /// What covers the main wing.
    pub roof: Roof,
    /// The other wings.
    pub attached: Vec<Attached>,
    /// A round end.
    pub apse: Option<Apse>,
    /// Point lights.
    pub lights: usize,
    /// How much furniture, per cent of what is usual.
    pub fullness: u32,
}

/// Half the width of a passage, modules.
const HALF_WAY: i32 = 9;
/// From a passage to the corners of its foyer, modules.
const TO_EAST: i32 = 30;
const TO_WEST: i32 = 25;

impl Outline {
    /// The building.
    pub fn complex(mut self, furniture: bool, seed: u64) -> Complex {
        let straight = Turn { sine: 0, cosine: 1, whole: 1 };
        let facade = self.main.first().map_or(0, |wing| wing.size()[1]) * MODULE;
        let (mut wings, mut ways, mut foyers) = (Vec::new(), Vec::new(), Vec::new());
        for attached in self.attached {
            let Some(wing) = attached.storeys.first() else { continue };
            let [west, east] = self.main[0].bay_span(1, attached.bay);
            let middle = (west + east) / 2;
            ways.push([(middle - HALF_WAY) * MODULE, (middle + HALF_WAY) * MODULE]);
            let turn = Turn::near(attached.degrees);
            let against = if turn.cosine == 0 {
                let [south, north] = wing.corridor_rows();
                let corner = middle + (south + north) / 2;
                let against = [corner - wing.size()[1], corner];
                wings.push((attached, [corner * MODULE, facade], turn));
                against
            } else {
                let against = [west - TO_WEST, east + TO_EAST];
                foyers.push(Foyer { wing: wings.len() + 1, west: against[0] * MODULE });
                wings.push((attached, [against[1] * MODULE, facade], turn));
                against
            };
            // Behind these there is no window.
            for wing in &mut self.main {
                for i in 0..wing.bays[1].len() {
                    let [x0, x1] = wing.bay_span(1, i);
                    wing.bays[1][i].is_blind |= x0 < against[1] && against[0] < x1;
                }
            }
        }
        let main = PlacedWing {
            name: "Main wing".to_owned(),
            storeys: self.main,
            origin: [0, 0],
            turn: straight,
            roof: self.roof,
        };
        let others = wings.into_iter().map(|(attached, origin, turn)| PlacedWing {
            name: attached.name.to_owned(),
            storeys: attached.storeys,
            origin,
            turn,
            roof: Roof::Flat,
        });
        Complex {
            name: self.name.to_owned(),
            wings: [main].into_iter().chain(others).collect(),
            ways,
            foyers,
            apse: self.apse,
            lights: self.lights,
            furniture,
            fullness: self.fullness,
            seed,
        }
    }
}
