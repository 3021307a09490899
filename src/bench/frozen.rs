//! Scenes and cameras that stay the same from version to version, so that times can be compared: `benches/scenes.toml`.

use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_64;

use crate::generate::{
    Building, HouseOptions, OfficeOptions, RoundRoomOptions, Style, TowerOptions, build1, build2, build3,
    house, random, round_room, tower,
};

/// The file, as it was when the crate was built.
const FILE: &str = include_str!("../../benches/scenes.toml");

/// A frozen scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct FrozenScene {
    /// Its name.
    pub name: String,
    /// Which generator makes it: `house`, `build1`, `build2`, `build3`, `tower`, `random`, `round-room`.
    pub building: String,
    /// Storeys of a tower.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storeys: Option<usize>,
    /// The generator's seed.
    #[serde(default)]
    pub seed: u64,
    /// Whether it is written as CAD tools do ([`Style::cad`] with the same seed) rather than exactly.
    #[serde(default)]
    pub cad: bool,
    /// Whether it stands empty: without furniture and lamps.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub bare: bool,
    /// Hash of the bytes of its `.glb`: XXH3, 64 bits, in hexadecimal.
    pub hash: String,
    /// Its cameras, a line each as in camera files, in the frame of the `.glb`.
    #[serde(default)]
    pub cameras: String,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    scene: Vec<FrozenScene>,
}

/// A frozen scene cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FrozenError {
    /// The file is not what it should be.
    #[error("benches/scenes.toml: {0}")]
    File(String),
    /// No scene of this name.
    #[error("no frozen scene '{name}'; there are {}", known.join(", "))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names of those there are.
        known: Vec<String>,
    },
    /// The generator makes something else than it did when the scene was frozen.
    #[error("scene '{name}' has hash {now}, and had {frozen} when it was frozen")]
    Changed {
        /// The scene.
        name: String,
        /// The hash in the file.
        frozen: String,
        /// The hash of what is made now.
        now: String,
    },
}

impl FrozenScene {
    /// All of them.
    ///
    /// # Errors
    /// [`FrozenError::File`].
    pub fn all() -> Result<Vec<FrozenScene>, FrozenError> {
        toml::from_str::<File>(FILE).map(|file| file.scene).map_err(|e| FrozenError::File(e.to_string()))
    }

    /// The one of this name.
    ///
    /// # Errors
    /// [`FrozenError::File`], [`FrozenError::Unknown`].
    pub fn by_name(name: &str) -> Result<FrozenScene, FrozenError> {
        let all = FrozenScene::all()?;
        let known = all.iter().map(|scene| scene.name.clone()).collect();
        let found = all.into_iter().find(|scene| scene.name == name);
        found.ok_or_else(|| FrozenError::Unknown { name: name.to_owned(), known })
    }

    /// The building, whatever its hash.
    ///
    /// # Errors
    /// [`FrozenError::File`] if there is no such generator.
    pub fn building(&self) -> Result<Building, FrozenError> {
        let furniture = !self.bare;
        let office = || OfficeOptions { seed: self.seed, furniture };
        Ok(match self.building.as_str() {
            "house" => house(&HouseOptions { seed: self.seed, furniture, ..HouseOptions::default() }),
            "build1" => build1(&office()),
            "build2" => build2(&office()),
            "build3" => build3(&office()),
            "tower" => {
                let usual = TowerOptions::default();
                tower(&TowerOptions { storeys: self.storeys.unwrap_or(usual.storeys), office: office() })
            }
            "random" => random(&office()),
            "round-room" => round_room(&RoundRoomOptions { seed: self.seed }),
            other => return Err(FrozenError::File(format!("no building '{other}'"))),
        })
    }

    /// The bytes of its `.glb`, and their hash as the file has it.
    ///
    /// # Errors
    /// As [`FrozenScene::building`].
    pub fn glb_and_hash(&self) -> Result<(Vec<u8>, String), FrozenError> {
        let style = if self.cad { Style::cad(self.seed) } else { Style::exact() };
        let glb = self.building()?.export(&style).to_glb();
        let hash = format!("{:016x}", XxHash3_64::oneshot(&glb));
        Ok((glb, hash))
    }

    /// The bytes of its `.glb`, which are those that were frozen.
    ///
    /// # Errors
    /// [`FrozenError::Changed`] if they are not; as [`FrozenScene::building`].
    pub fn glb(&self) -> Result<Vec<u8>, FrozenError> {
        let (glb, now) = self.glb_and_hash()?;
        if now == self.hash {
            return Ok(glb);
        }
        Err(FrozenError::Changed { name: self.name.clone(), frozen: self.hash.clone(), now })
    }

    /// Scenes as the file has them.
    ///
    /// # Errors
    /// [`FrozenError::File`] if TOML cannot hold them.
    pub fn to_file(scenes: Vec<FrozenScene>) -> Result<String, FrozenError> {
        toml::to_string(&File { scene: scenes }).map_err(|e| FrozenError::File(e.to_string()))
    }
}
