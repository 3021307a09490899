//! Generated buildings that many tests look at, each compiled once for all of them. To be asked for by a test's own thread: compiling waits for
//! jobs, and one of these that asks for the same would wait for it.

use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock};

use crate::generate::{HouseOptions, OfficeOptions, Style, TowerOptions, build1, house, random, tower};
#[cfg(feature = "render")]
use crate::generate::{RoundRoomOptions, round_room};
use crate::{CompileOptions, Scene, compile};

/// A building, furnished.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Sample {
    House,
    /// With an attic under sloped roofs, a round end, an oblique wing.
    Build1,
    #[cfg(feature = "render")]
    RoundRoom,
    /// Of so many storeys; has floors that reach over several of them.
    Tower(usize),
    /// By chance.
    Random(u64),
}

/// A building as it is, or as a drawing tool writes it: corners a hair aside each.
type Key = (Sample, Option<u64>);

/// What is compiled of one, the file and that opened.
type Made = OnceLock<(Vec<u8>, Scene)>;

static MADE: Mutex<BTreeMap<Key, &'static Made>> = Mutex::new(BTreeMap::new());

impl Sample {
    /// As it is.
    pub(crate) fn scene(self) -> &'static Scene {
        &made((self, None)).1
    }

    /// As a drawing tool writes it.
    pub(crate) fn drawn(self, seed: u64) -> &'static Scene {
        &made((self, Some(seed))).1
    }

    /// One's own, as it is.
    pub(crate) fn own(self) -> Scene {
        Scene::from_bytes(&made((self, None)).0).unwrap()
    }

    /// One's own, as a drawing tool writes it.
    pub(crate) fn own_drawn(self, seed: u64) -> Scene {
        Scene::from_bytes(&made((self, Some(seed))).0).unwrap()
    }
}

fn made(key: Key) -> &'static (Vec<u8>, Scene) {
    let one = *MADE.lock().unwrap().entry(key).or_insert_with(|| Box::leak(Box::default()));
    // Others are made meanwhile.
    one.get_or_init(|| {
        let office = |seed| OfficeOptions { seed, ..OfficeOptions::default() };
        let building = match key.0 {
            Sample::House => house(&HouseOptions::default()),
            Sample::Build1 => build1(&office(0)),
            #[cfg(feature = "render")]
            Sample::RoundRoom => round_room(&RoundRoomOptions::default()),
            Sample::Tower(storeys) => tower(&TowerOptions { storeys, office: office(0) }),
            Sample::Random(seed) => random(&office(seed)),
        };
        let style = key.1.map_or(Style::exact(), Style::cad);
        let model = building.export(&style).to_model().unwrap();
        let bytes = compile(&model, &CompileOptions::default()).unwrap().bytes;
        let scene = Scene::from_bytes(&bytes).unwrap();
        (bytes, scene)
    })
}
