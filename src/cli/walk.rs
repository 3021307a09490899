//! `enfilade walk`.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use enfilade::beam::{BeamCounts, Beams};
use enfilade::importers::Frame;
use enfilade::render::{Camera, numbered, rgba_bytes, room_views, walk, write_png_rgba};
use enfilade::{Kernel, Scene};
use serde::Serialize;

use super::doors::Doors;
use super::failure::{Failure, Outcome};
use super::hide::Hide;
use super::input::{FrameName, Reading, Resources};
use super::output;
use super::render::{parse_picture_size, read_cameras};

/// Walk through a scene past way-points, frame by frame, and tell how long the frames take.
///
/// Frames are made by beams: the only light a lamp at the eye, what is behind glass seen through it. The eye goes straight from each way-point to
/// the next. Without -o and --raw frames are only timed.
#[derive(Args)]
#[command(after_help = "\
Examples:
  enfilade walk house.enf
  enfilade walk house.enf --cams way.txt -o frames.png --speed 1.4 --rate 25
  enfilade walk house.enf --raw - | ffplay -f rawvideo -pixel_format rgba -video_size 1024x1024 -
  enfilade walk build2.enf --threads 1 --json

A file of way-points has a line 'ex ey ez tx ty tz vfov_degrees' each; # starts a comment.")]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    scene: PathBuf,
    /// A file of way-points; by default half a turn in the middle of each room.
    #[arg(long, value_name = "FILE")]
    cams: Option<PathBuf>,
    /// Metres in a second.
    #[arg(long, value_name = "METRES", default_value_t = 1.4, value_parser = positive)]
    speed: f64,
    /// Turns in a second, degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 90.0, value_parser = positive)]
    turn: f64,
    /// Frames in a second.
    #[arg(long, value_name = "FRAMES", default_value_t = 25.0, value_parser = positive)]
    rate: f64,
    /// No more frames than this.
    #[arg(long, value_name = "N")]
    most: Option<usize>,
    /// Pictures to write: numbered PNGs, out.0001.png...
    #[arg(short, long, value_name = "OUT.png", conflicts_with = "raw")]
    output: Option<PathBuf>,
    /// Where to write all frames, one after the other: eight-bit RGBA, rows from the top; - for stdout.
    #[arg(long, value_name = "FILE")]
    raw: Option<PathBuf>,
    /// Pixels.
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = parse_picture_size)]
    size: (u32, u32),
    /// Glass is not seen through.
    #[arg(long)]
    opaque_glass: bool,
    /// The instruction set: portable, avx2 or avx512; by default the best that the CPU has.
    #[arg(long, value_name = "NAME", value_parser = parse_kernel)]
    kernel: Option<Kernel>,
    /// The frame of --cams.
    #[arg(long, value_enum, default_value = "source")]
    frame: FrameName,
    /// Tell also how many pages of the file a frame reads, on Linux: each is made once more for that.
    #[arg(long)]
    stats: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    doors: Doors,
    #[command(flatten)]
    hide: Hide,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("must be more than 0".to_owned()) }
}

fn parse_kernel(text: &str) -> Result<Kernel, String> {
    let names = || Kernel::available().into_iter().map(Kernel::name).collect::<Vec<_>>().join(", ");
    Kernel::by_name(text).ok_or_else(|| format!("this machine has {}", names()))
}

/// What a walk took.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    threads: usize,
    kernel: &'static str,
    width: u32,
    height: u32,
    frames: usize,
    /// Making the frames, without what is written.
    seconds: f64,
    frames_per_second: f64,
    mpixels_per_second: f64,
    median_ms: f64,
    worst_ms: f64,
    /// For a frame, in the mean.
    cells: f64,
    triangles: f64,
    spans: f64,
    /// The share of the pixels that beams left to rays.
    left_to_rays: f64,
    /// Pages of the file that a frame reads, in the mean, with --stats; none where the system does not tell, or no file is mapped.
    pages: Option<f64>,
    /// Pages of the file.
    of_pages: Option<u64>,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let is_png = |path: &PathBuf| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if let Some(path) = arguments.output.as_ref().filter(|path| !is_png(path)) {
        return Err(Failure::usage(format!("{}: not .png", path.display())));
    }
    arguments.resources.in_pool(|| {
        let mut scene = arguments.reading.scene(&arguments.scene, &arguments.resources)?;
        arguments.doors.apply(&mut scene, &arguments.resources)?;
        arguments.hide.apply(&mut scene)?;
        let mut frames = frames(arguments, &scene)?;
        frames.truncate(arguments.most.unwrap_or(usize::MAX));
        if frames.is_empty() {
            return Err(Failure::input("there is no way: the scene has no room in which one could stand"));
        }
        let report = match &arguments.raw {
            None => paint(arguments, &scene, &frames, None)?,
            Some(path) => {
                let mut made = None;
                let written = output::write(Some(path), |out| {
                    let report = paint(arguments, &scene, &frames, Some(out));
                    let stopped = report.is_err();
                    made = Some(report);
                    if stopped { Err(std::io::Error::other("stopped")) } else { Ok(()) }
                });
                // Why it stopped, or else why what was made could not be kept.
                let report = made.transpose()?;
                written?;
                report.ok_or_else(|| Failure::input("no frame was made"))?
            }
        };
        let is_stdout = arguments.raw.as_ref().is_some_and(|path| path.as_os_str() == "-");
        if arguments.json && !is_stdout {
            return output::print_json(&report);
        }
        if !arguments.resources.quiet {
            eprintln!(
                "{} frames of {} x {} in {:.3} s: {:.0} frames/s, {:.0} M pixels/s, median {:.3} ms, worst {:.3} ms, {}, {} thread(s)",
                report.frames,
                report.width,
                report.height,
                report.seconds,
                report.frames_per_second,
                report.mpixels_per_second,
                report.median_ms,
                report.worst_ms,
                report.kernel,
                report.threads
            );
            eprintln!(
                "a frame: {:.1} cells, {:.0} triangles, {:.0} parts of rows; {:.4} % of the pixels left to rays",
                report.cells,
                report.triangles,
                report.spans,
                report.left_to_rays * 100.0
            );
            if let (Some(read), Some(all)) = (report.pages, report.of_pages) {
                eprintln!("a frame reads {read:.1} pages of the file, of {all}");
            }
        }
        Ok(Outcome::Fine)
    })?
}

/// The cameras along the way.
fn frames(arguments: &Arguments, scene: &Scene) -> Result<Vec<Camera>, Failure> {
    let frame = match arguments.frame {
        FrameName::Source => scene.frame(),
        FrameName::Internal => Frame::default(),
    };
    let (step, turn) = (arguments.speed / arguments.rate, arguments.turn.to_radians() / arguments.rate);
    Ok(match &arguments.cams {
        Some(path) => walk(&read_cameras(path, &frame)?, step, turn),
        // From one room to the next there may be walls.
        None => room_views(scene, 2).chunks(2).flat_map(|views| walk(views, step, turn)).collect(),
    })
}

/// Makes the frames, and writes them where that is asked for.
fn paint(
    arguments: &Arguments,
    scene: &Scene,
    frames: &[Camera],
    mut raw: Option<&mut dyn Write>,
) -> Result<Report, Failure> {
    let (width, height) = arguments.size;
    let kernel = arguments.kernel.or(Kernel::avx512()).unwrap_or(Kernel::best());
    let beams = Beams::new(scene).with_kernel(kernel);
    let mut beams = if arguments.opaque_glass { beams } else { beams.through_glass() };
    let mut pixels = vec![0u32; width as usize * height as usize];
    // Warms what is kept from frame to frame.
    beams.paint(&frames[0], width, &mut pixels);
    let (mut times, mut sum) = (Vec::with_capacity(frames.len()), BeamCounts::default());
    for (index, camera) in frames.iter().enumerate() {
        let start = Instant::now();
        let counts = beams.paint(camera, width, &mut pixels);
        times.push(start.elapsed().as_secs_f64());
        sum += counts;
        if let Some(out) = raw.as_mut() {
            out.write_all(&rgba_bytes(&pixels)).map_err(|e| Failure::output("frames", e))?;
        }
        if let Some(path) = &arguments.output {
            let path = numbered(path, index, frames.len());
            write_png_rgba(&pixels, width, &path).map_err(|e| Failure::Output(e.into()))?;
        }
    }
    let (mut read, mut of_pages) = (0, None);
    for camera in frames.iter().filter(|_| arguments.stats) {
        let pages = scene.pages_read(|| {
            beams.paint(camera, width, &mut pixels);
        });
        read += pages.map_or(0, |pages| pages.read);
        of_pages = pages.map(|pages| pages.all);
    }
    let (count, seconds) = (frames.len() as f64, times.iter().sum::<f64>());
    times.sort_by(f64::total_cmp);
    Ok(Report {
        version: env!("CARGO_PKG_VERSION"),
        threads: rayon::current_num_threads(),
        kernel: kernel.name(),
        width,
        height,
        frames: frames.len(),
        seconds,
        frames_per_second: count / seconds,
        mpixels_per_second: count * pixels.len() as f64 / seconds / 1e6,
        median_ms: times[times.len() / 2] * 1e3,
        worst_ms: times[times.len() - 1] * 1e3,
        cells: sum.cells as f64 / count,
        triangles: sum.triangles as f64 / count,
        spans: sum.spans as f64 / count,
        left_to_rays: sum.unsure as f64 / count / pixels.len() as f64,
        pages: of_pages.map(|_| read as f64 / count),
        of_pages,
    })
}
