//! The same rays in the same process, through enfilade, Embree, `obvhs` and `bvh`.
//!
//! ```sh
//! cargo run --release -p enfilade-peers -- --frozen house,build2
//! EMBREE_LIB=/path/to/libembree4.so.4 cargo run --release -p enfilade-peers -- house.glb --markdown table.md --plot plot.svg
//! cargo run --release -p enfilade-peers -- --pictures --frozen house,build2    # whole pictures, by beams
//! ```
//!
//! One thread. Every way has its rays in the layout that it likes best before the clock runs, and writes distance and triangle
//! of each ray; the ways take turns, each looks at some of the rays before the clock runs, and the medians of the repeats count. Embree 3 is used as Debian's `libembree-dev`
//! installs it, or the library that `EMBREE_LIB` names, 3 or 4; without either the other ways are still compared.

mod crates;
mod embree;
mod errors;
mod floor;
mod own;
mod pictures;
mod report;
mod run;
mod scenes;
mod way;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Parser;
use enfilade::plan::{plan_png, plan_svg};

/// Compare enfilade with its peers on the same rays.
#[derive(Parser)]
struct Arguments {
    /// Models (.glb, .gltf, .obj) or folders of them.
    models: Vec<PathBuf>,
    /// Scenes of benches/scenes.toml, with their cameras.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    frozen: Vec<String>,
    /// Width and height of frames, pixels.
    #[arg(long, default_value_t = 512)]
    size: u32,
    /// How often each way traces the same rays; the median counts.
    #[arg(long, default_value_t = 5)]
    repeat: usize,
    /// Random rays, and pairs of points, a scene.
    #[arg(long, default_value_t = 1 << 18)]
    random: usize,
    /// Also the scenes left one cell, all of it a hierarchy of triangles.
    #[arg(long)]
    uncut: bool,
    /// Only ways whose name holds one of these.
    #[arg(long, value_name = "PART,...", value_delimiter = ',')]
    ways: Vec<String>,
    /// Only these kinds of rays: primary, random, pairs, onward, lamps, outside, facades, points.
    #[arg(long, value_name = "KIND,...", value_delimiter = ',', value_parser = ["primary", "random", "pairs", "onward", "lamps", "outside", "facades", "points"])]
    kinds: Vec<String>,
    /// Instead of times alone, time beside error of all ways on the frames, by exact arithmetic.
    #[arg(long)]
    errors: bool,
    /// Instead of rays, whole pictures: beams, Embree's packets of coherent rays for the same pixels, and shading alone.
    #[arg(long, conflicts_with_all = ["errors", "ways", "plot"])]
    pictures: bool,
    /// Pictures from inside a scene at most; with `--pictures`.
    #[arg(long, value_name = "N", default_value_t = 20)]
    views: usize,
    /// Width and height of pictures, pixels, a multiple of four; with `--pictures`.
    #[arg(long, value_name = "SIZE", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..))]
    picture_size: u32,
    /// Where to write the table as Markdown.
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// Where to write the plot, SVG; with `--errors` the folder for charts.
    #[arg(long, value_name = "PATH")]
    plot: Option<PathBuf>,
    /// Where to write all figures as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The middle of the times.
fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    let middle = times.len() / 2;
    if times.len() % 2 == 1 { times[middle] } else { (times[middle - 1] + times[middle]) / 2.0 }
}

/// Time beside error, scene by scene.
fn errors(arguments: &Arguments, embree: Option<&Arc<embree::Embree>>) -> anyhow::Result<()> {
    let (mut markdown, mut reports) = (String::new(), serde_json::Map::new());
    for scene in scenes::scenes(arguments)? {
        let scene = scene?;
        let report = errors::errors(&scene, embree, arguments)?;
        println!("{}\n{}", scene.name, report.text());
        markdown.push_str(&format!("### {}\n\n{}\n", scene.name, report.markdown()));
        if let Some(folder) = &arguments.plot {
            std::fs::create_dir_all(folder)?;
            let drawing = report.chart(&scene.name);
            std::fs::write(folder.join(format!("{}.svg", scene.name)), plan_svg(&drawing))?;
            std::fs::write(folder.join(format!("{}.png", scene.name)), plan_png(&drawing, 1400)?)?;
        }
        reports.insert(scene.name, serde_json::to_value(&report)?);
    }
    if let Some(path) = &arguments.markdown {
        std::fs::write(path, markdown)?;
    }
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&reports)?)?;
    }
    Ok(())
}

/// Whole pictures, scene by scene.
fn pictures(arguments: &Arguments, embree: Option<&Arc<embree::Embree>>) -> anyhow::Result<()> {
    let mut report = pictures::Report::new(arguments, embree.map(|embree| &**embree));
    print!("{}", report.head());
    for scene in scenes::scenes(arguments)? {
        let views = pictures::run(&scene?, embree, arguments)?;
        let rows = pictures::rows(&views);
        print!("{}", pictures::lines(&rows));
        report.rows.extend(rows);
        report.views.extend(views);
    }
    if let Some(path) = &arguments.markdown {
        std::fs::write(path, report.markdown())?;
    }
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&report)?)?;
    }
    Ok(())
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    // Frames and batches run on this thread alone; what builds scenes and hierarchies may use all.
    let embree = match embree::Embree::load() {
        Ok(embree) => Some(embree),
        Err(error) => {
            eprintln!("without Embree: {error:#}");
            None
        }
    };
    if arguments.errors {
        return errors(&arguments, embree.as_ref());
    }
    if arguments.pictures {
        return pictures(&arguments, embree.as_ref());
    }
    let floor = floor::measure(1024, 99);
    let mut table = report::Report::new(&arguments, embree.as_deref(), floor);
    println!("{}", table.head());
    for scene in scenes::scenes(&arguments)? {
        let scene = scene?;
        let rows = run::run(&scene, embree.as_ref(), &arguments);
        print!("{}", report::lines(&rows));
        table.rows.extend(rows);
    }
    if let Some(path) = &arguments.markdown {
        std::fs::write(path, table.markdown())?;
    }
    if let Some(path) = &arguments.plot {
        table.plot(path)?;
    }
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&table)?)?;
    }
    Ok(())
}
