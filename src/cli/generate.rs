//! `enfilade generate`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use enfilade::generate::{HouseOptions, house};

use super::failure::{Failure, Outcome};
use super::style::StyleArguments;

/// Make a building whose truth is known.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade generate house -o house.glb\n  enfilade generate house --no-furniture -o house.obj\n  enfilade generate house --style cad -o export.glb\n  enfilade generate house --rooms-smaller --wall-ends=0.5 --style-seed 7 -o gaps.glb"
)]
pub struct Arguments {
    #[command(subcommand)]
    building: Building,
}

#[derive(Subcommand)]
enum Building {
    /// A one-storey house of 8 rooms, with doors, windows, lights and furniture.
    House {
        /// The model to write: .glb, or .obj with its .mtl.
        #[arg(short, long, value_name = "OUT.glb|OUT.obj")]
        output: PathBuf,
        /// Leave furniture, sanitary ware and lamps out.
        #[arg(long)]
        no_furniture: bool,
        /// Leave the garden out.
        #[arg(long)]
        no_site: bool,
        /// Identities, and how far doors stand open, follow from it.
        #[arg(long, value_name = "S", default_value_t = 0)]
        seed: u64,
        #[command(flatten)]
        style: StyleArguments,
    },
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let Building::House { output, no_furniture, no_site, seed, style } = &arguments.building;
    let mut options = HouseOptions::default();
    options.furniture = !no_furniture;
    options.site = !no_site;
    options.seed = *seed;
    house(&options).export(&style.style()).write(output).map_err(|e| Failure::Output(e.into()))?;
    Ok(Outcome::Fine)
}
