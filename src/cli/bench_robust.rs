//! `enfilade bench robust`.

use std::path::PathBuf;

use clap::Args;
use enfilade::bench::{Damage, FrozenScene, RobustOptions, robust};

use super::bench::draw;
use super::failure::{Failure, Outcome};
use super::input::Resources;
use super::output;

/// What growing damage does to a generated building: to what openings join, cells, compile time, the time of rays, and what they meet.
///
/// Each line is an export with one kind of damage of one size, held against what is true of the building as it was drawn; `wrong` are answers that the
/// damaged model's own triangles deny. Ends with exit code 1 if there are any.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade bench robust\n  enfilade bench robust --frozen build1 --damage room-gaps,solid-gaps --figure gaps.svg\n  enfilade bench robust --sizes 1e-4,1e-3,1e-2 --markdown"
)]
pub struct Arguments {
    /// A scene of benches/scenes.toml: its building is damaged, whatever its style.
    #[arg(long, value_name = "NAME", default_value = "house")]
    frozen: String,
    /// Which kinds of damage: room-gaps, room-overlaps, solid-gaps, solid-overlaps, jitter, noise; by default all.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = parse_damage)]
    damage: Vec<Damage>,
    /// How far things are off, metres; by default from a micrometre to three centimetres.
    #[arg(long, value_name = "METRES,...", value_delimiter = ',', value_parser = parse_size)]
    sizes: Vec<f64>,
    /// Random rays from rooms, which are timed and compared.
    #[arg(long, value_name = "N")]
    rays: Option<u32>,
    /// Rays by which answers are verified.
    #[arg(long, value_name = "N")]
    verified: Option<u64>,
    /// How often rays are timed, and short compilations, those at most three times; the median counts.
    #[arg(long, value_name = "R", default_value_t = 5)]
    repeat: u32,
    /// Where random numbers start.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Where to draw it: .svg, or .png. May be given more than once.
    #[arg(long, value_name = "FILE")]
    figure: Vec<PathBuf>,
    /// Print the table as Markdown.
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    resources: Resources,
}

fn parse_damage(name: &str) -> Result<Damage, String> {
    let names = || Damage::ALL.map(Damage::name).join(", ");
    Damage::ALL.into_iter().find(|damage| damage.name() == name).ok_or_else(|| format!("one of {}", names()))
}

fn parse_size(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(size) if (1e-12..=1e3).contains(&size) => Ok(size),
        _ => Err("must be a number from 1e-12 to 1000".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let scene = FrozenScene::by_name(&arguments.frozen).map_err(|e| Failure::usage(e.to_string()))?;
    let building = scene.building().map_err(Failure::input)?;
    let mut options = RobustOptions::default();
    if !arguments.damage.is_empty() {
        options.damages = arguments.damage.clone();
    }
    if !arguments.sizes.is_empty() {
        options.sizes = arguments.sizes.clone();
    }
    options.rays = arguments.rays.unwrap_or(options.rays);
    options.verified = arguments.verified.unwrap_or(options.verified);
    (options.repeat, options.seed) = (arguments.repeat, arguments.seed);
    options.watch = arguments.resources.watch();
    let report = arguments.resources.in_pool(|| robust(&building, &options))?.map_err(Failure::input)?;
    if arguments.json {
        output::print_json(&report)?;
    } else {
        output::print(&if arguments.markdown { report.markdown() } else { report.text() })?;
    }
    draw(&arguments.figure, || report.chart())?;
    let is_wrong = report.rows.iter().any(|row| row.wrong > 0) || report.drawn.wrong > 0;
    Ok(if is_wrong { Outcome::Findings } else { Outcome::Fine })
}
