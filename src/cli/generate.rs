//! `enfilade generate`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use enfilade::generate::{
    Building as Generated, HouseOptions, OfficeOptions, RoundRoomOptions, TowerOptions, build1, build2,
    build3, house, random, round_room, tower,
};

use super::failure::{Failure, Outcome};
use super::style::StyleArguments;

/// Make a building whose truth is known.
///
/// Beside the model OUT.glb or OUT.obj goes OUT.truth.json: rooms with volume, floor area and faces, what each opening
/// joins, and points with what holds them.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade generate house -o house.glb\n  enfilade generate build2 --no-furniture -o build2.obj\n  enfilade generate tower --storeys 20 -o tower.glb\n  enfilade generate random --seed 7 -o random.glb\n  enfilade generate house --style cad -o export.glb\n  enfilade generate house --rooms-smaller --wall-ends=0.5 --style-seed 7 -o gaps.glb"
)]
pub struct Arguments {
    #[command(subcommand)]
    building: Building,
}

#[derive(Subcommand)]
enum Building {
    /// A one-storey house of 8 rooms, with doors, windows, lights and furniture.
    House {
        #[command(flatten)]
        common: Common,
        /// Leave the garden out.
        #[arg(long)]
        no_site: bool,
    },
    /// One storey of 46 rooms: a wing with an attic, a round end, an oblique wing; 55 lights.
    Build1 {
        #[command(flatten)]
        common: Common,
    },
    /// One storey of 135 rooms in four wings, one of them oblique; 199 lights.
    Build2 {
        #[command(flatten)]
        common: Common,
    },
    /// Thirteen storeys of 135 rooms, 1755 in all; 2557 lights.
    Build3 {
        #[command(flatten)]
        common: Common,
    },
    /// A tower with a round side, columns, stairwells, and an entrance hall over two storeys.
    Tower {
        #[command(flatten)]
        common: Common,
        /// How many storeys.
        #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=TowerOptions::MOST_STOREYS as i64))]
        storeys: u16,
    },
    /// One room with round walls of 64 facets, as in Fig. 10 of the paper.
    RoundRoom {
        #[command(flatten)]
        common: Common,
    },
    /// A building of one to four storeys, one wing or two, that follows from the seed.
    Random {
        #[command(flatten)]
        common: Common,
    },
}

/// What all buildings take.
#[derive(Args)]
struct Common {
    /// The model to write: .glb, or .obj with its .mtl.
    #[arg(short, long, value_name = "OUT.glb|OUT.obj")]
    output: PathBuf,
    /// Put furniture, sanitary ware and lamps in: so it is unless said otherwise.
    #[arg(long, overrides_with = "no_furniture")]
    furniture: bool,
    /// Leave furniture, sanitary ware and lamps out.
    #[arg(long)]
    no_furniture: bool,
    /// Do not write OUT.truth.json.
    #[arg(long)]
    no_truth: bool,
    /// Identities, furniture, and how far doors stand open, follow from it; of `random` all.
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    style: StyleArguments,
}

impl Common {
    fn has_furniture(&self) -> bool {
        !self.no_furniture
    }

    fn office(&self) -> OfficeOptions {
        let mut options = OfficeOptions::default();
        options.furniture = self.has_furniture();
        options.seed = self.seed;
        options
    }
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let (common, building): (&Common, Generated) = match &arguments.building {
        Building::House { common, no_site } => {
            let mut options = HouseOptions::default();
            options.furniture = common.has_furniture();
            options.site = !no_site;
            options.seed = common.seed;
            (common, house(&options))
        }
        Building::Build1 { common } => (common, build1(&common.office())),
        Building::Build2 { common } => (common, build2(&common.office())),
        Building::Build3 { common } => (common, build3(&common.office())),
        Building::Tower { common, storeys } => {
            let mut options = TowerOptions::default();
            options.storeys = usize::from(*storeys);
            options.office = common.office();
            (common, tower(&options))
        }
        Building::RoundRoom { common } => {
            let mut options = RoundRoomOptions::default();
            options.seed = common.seed;
            (common, round_room(&options))
        }
        Building::Random { common } => (common, random(&common.office())),
    };
    let style = common.style.style();
    building.export(&style).write(&common.output).map_err(|e| Failure::Output(e.into()))?;
    if !common.no_truth {
        building.truth().styled(&style).write(&common.output).map_err(|e| Failure::Output(e.into()))?;
    }
    Ok(Outcome::Fine)
}
