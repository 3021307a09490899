//! `enfilade render`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use enfilade::Scene;
use enfilade::beam::{BeamCounts, Beams};
use enfilade::format::Pages;
use enfilade::importers::Frame;
use enfilade::render::{
    Camera, ColorMode, Picture, RenderOptions, auto_view, numbered, outside_view, parse_cameras, render,
    room_views, write_exr, write_png,
};
use serde::Serialize;

use super::doors::Doors;
use super::failure::{Failure, Outcome};
use super::hide::Hide;
use super::input::{FrameName, Point, Reading, Resources, Up, parse_point};
use super::output;

/// Make pictures of a scene: PNG, or OpenEXR with radiance, depth, normals and ids as layers.
///
/// Views come from --eye and --target, from a camera of the model (--camera), from a file of cameras (--cams), or are
/// chosen (--view). --up also takes a vector, what is up in the picture (by default the up axis). Several views become numbered frames: out.0001.png...
#[derive(Args)]
#[command(after_help = "\
Examples:
  enfilade render house.enf -o house.png
  enfilade render house.glb -o rooms.png --view rooms --color room --size 512x512
  enfilade render house.enf -o kitchen.exr --eye 2,1.6,-3 --target 5,1.2,-4 --fov 75
  enfilade render house.enf -o walk.png --cams walk.txt
  enfilade render house.enf -o open.png --view rooms --open doors

A file of cameras has a line 'ex ey ez tx ty tz vfov_degrees' a view; # starts a comment.")]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    scene: PathBuf,
    /// The picture to write: .png or .exr.
    #[arg(short, long, value_name = "OUT.png|OUT.exr")]
    output: PathBuf,
    /// Where the camera is: three numbers, as 1,2,3 or 1 2 3.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, requires = "target")]
    eye: Option<Point>,
    /// Where it looks to.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, requires = "eye")]
    target: Option<Point>,
    /// Vertical field of view, degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0)]
    fov: f64,
    /// A camera of the model, by name or number from 0.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["eye", "cams", "view"])]
    camera: Option<String>,
    /// A file of cameras.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["eye", "view"])]
    cams: Option<PathBuf>,
    /// A view of choice: auto in the largest room, outside of the whole, rooms two level views in each room.
    #[arg(long, value_enum, value_name = "VIEW", conflicts_with = "eye")]
    view: Option<View>,
    /// What colours show: material, semantic, face, element, room, cell, depth, normal, packet (how large the packet of rays was that told each pixel) or cost.
    #[arg(long, value_name = "WHAT", default_value = "material", value_parser = parse_color)]
    color: ColorMode,
    /// Pixels.
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = parse_picture_size)]
    size: (u32, u32),
    /// The frame of --eye, --target, --up and --cams, and of what OpenEXR layers hold.
    #[arg(long, value_enum, default_value = "source")]
    frame: FrameName,
    /// Tell to stderr what of the scene each picture touched: cells, parts of rows, triangles, pixels left to rays, and, on Linux, pages of the file that beams read.
    #[arg(long)]
    stats: bool,
    /// Print the views and times as JSON, and what --stats tells.
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

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum View {
    Auto,
    Outside,
    Rooms,
}

fn parse_color(text: &str) -> Result<ColorMode, String> {
    text.parse().map_err(|e: enfilade::render::UnknownColorMode| e.to_string())
}

/// Width and height.
pub fn parse_picture_size(text: &str) -> Result<(u32, u32), String> {
    let parse = |n: &str| n.parse().ok().filter(|n| (1..=65536).contains(n));
    text.split_once(['x', 'X'])
        .and_then(|(w, h)| Some((parse(w)?, parse(h)?)))
        .ok_or_else(|| "not of the form 1024x768, each 1 to 65536".to_owned())
}

#[derive(Serialize)]
struct Shot {
    file: String,
    eye: [f64; 3],
    direction: [f64; 3],
    vfov_degrees: f64,
    seconds: f64,
    /// What it took beams; none where each pixel's ray was traced.
    touched: Option<Touched>,
}

/// What a picture touched.
#[derive(Serialize)]
struct Touched {
    /// Cells, each as often as a beam came through.
    cells: u64,
    /// Cells of the scene.
    of_cells: usize,
    /// Parts of rows.
    parts: u64,
    /// Triangles drawn.
    triangles: u64,
    /// Triangles of the scene.
    of_triangles: u32,
    /// Pixels left to rays.
    to_rays: u64,
    /// Pages of the file that the picture's beams read, with --stats; none where the system does not tell, or no file is mapped.
    pages: Option<u64>,
    /// Pages of the file.
    of_pages: Option<u64>,
}

/// Tells which pages of the file the beams of a picture read, by making it once more.
struct Reader<'s> {
    scene: &'s Scene,
    beams: Beams<&'s Scene>,
    pixels: Vec<u32>,
}

impl<'s> Reader<'s> {
    fn new(scene: &'s Scene, (width, height): (u32, u32)) -> Reader<'s> {
        Reader { scene, beams: Beams::new(scene), pixels: vec![0; width as usize * height as usize] }
    }

    fn pages(&mut self, camera: &Camera, width: u32) -> Option<Pages> {
        let Reader { scene, beams, pixels } = self;
        // Partings of floors and the like are made by the first picture, and kept.
        beams.paint(camera, width, pixels);
        scene.pages_read(|| {
            beams.paint(camera, width, pixels);
        })
    }
}

impl Touched {
    fn new(scene: &Scene, counts: BeamCounts, pages: Option<Pages>) -> Touched {
        Touched {
            cells: counts.cells,
            of_cells: scene.cells().len(),
            parts: counts.spans,
            triangles: counts.triangles,
            of_triangles: scene.detail_triangle_count(),
            to_rays: counts.unsure,
            pages: pages.map(|pages| pages.read),
            of_pages: pages.map(|pages| pages.all),
        }
    }

    fn text(&self) -> String {
        let Touched { cells, of_cells, parts, triangles, of_triangles, to_rays, pages, of_pages } = self;
        let read = match (pages, of_pages) {
            (Some(read), Some(all)) => format!("; {read} of {all} pages of the file read"),
            _ => String::new(),
        };
        format!(
            "beams came {cells} times through cells, of which there are {of_cells}; {parts} parts of rows, {triangles} triangles drawn of \
             {of_triangles}; {to_rays} pixels left to rays{read}"
        )
    }
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let exr = match arguments.output.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref()
    {
        Some("png") => false,
        Some("exr") => true,
        _ => return Err(Failure::usage(format!("{}: neither .png nor .exr", arguments.output.display()))),
    };
    arguments.resources.in_pool(|| {
        let mut scene = arguments.reading.scene(&arguments.scene, &arguments.resources)?;
        arguments.doors.apply(&mut scene, &arguments.resources)?;
        arguments.hide.apply(&mut scene)?;
        let frame = match arguments.frame {
            FrameName::Source => scene.frame(),
            FrameName::Internal => Frame::default(),
        };
        let cameras = cameras(arguments, &scene, &frame)?;
        let mut options = RenderOptions::new(arguments.size.0, arguments.size.1, arguments.color);
        options.frame = frame;
        options.limits = arguments.resources.limits();
        options.watch = arguments.resources.watch();
        let mut shots = Vec::new();
        let mut reader = arguments.stats.then(|| Reader::new(&scene, arguments.size));
        for (i, camera) in cameras.iter().enumerate() {
            let path = numbered(&arguments.output, i, cameras.len());
            let start = Instant::now();
            let picture = render(&scene, camera, &options).map_err(Failure::input)?;
            let seconds = start.elapsed().as_secs_f64();
            warn_in_solid(arguments, &scene, &picture, &path);
            let written = if exr { write_exr(&picture, &path, &frame) } else { write_png(&picture, &path) };
            written.map_err(|e| Failure::Output(e.into()))?;
            shots.push(Shot {
                file: path.display().to_string(),
                eye: frame.point_to_source(camera.eye()),
                direction: frame.direction_to_source(camera.forward()),
                vfov_degrees: camera.vfov_degrees(),
                seconds,
                touched: picture.beams().map(|counts| {
                    let pages = reader.as_mut().and_then(|reader| reader.pages(camera, arguments.size.0));
                    Touched::new(&scene, counts, pages)
                }),
            });
        }
        if arguments.json {
            return output::print_json(&shots);
        }
        if !arguments.resources.quiet {
            for shot in &shots {
                let [x, y, z] = shot.eye;
                eprintln!("{}: from ({x:.3} {y:.3} {z:.3}), {:.1} ms", shot.file, shot.seconds * 1e3);
            }
        }
        if arguments.stats {
            for shot in &shots {
                let touched = shot.touched.as_ref().map_or("a ray for each pixel".to_owned(), Touched::text);
                eprintln!("{}: {touched}", shot.file);
            }
        }
        Ok(Outcome::Fine)
    })?
}

fn warn_in_solid(arguments: &Arguments, scene: &Scene, picture: &Picture, path: &Path) {
    if let Some(element) = picture.in_solid() {
        let id = scene.element(element).id();
        arguments
            .resources
            .warn(&[format!("{}: the camera is inside the solid element {id}", path.display())]);
    }
}

/// The views that the arguments ask for.
fn cameras(arguments: &Arguments, scene: &Scene, frame: &Frame) -> Result<Vec<Camera>, Failure> {
    if let (Some(eye), Some(target)) = (&arguments.eye, &arguments.target) {
        let up = match arguments.reading.up {
            Some(Up::Vector(up)) => frame.direction_to_internal(up.0),
            _ => [0.0, 0.0, 1.0],
        };
        let eye = frame.point_to_internal(eye.0);
        let target = frame.point_to_internal(target.0);
        let camera = Camera::look_at(eye, target, up, arguments.fov).map_err(Failure::usage)?;
        return Ok(vec![camera]);
    }
    if let Some(path) = &arguments.cams {
        return read_cameras(path, frame);
    }
    if let Some(name) = &arguments.camera {
        let records = scene.cameras();
        let by_name = records.iter().find(|c| scene.text(c.name) == name);
        let by_number = || name.parse::<usize>().ok().and_then(|n| records.get(n));
        let record = by_name.or_else(by_number).ok_or_else(|| {
            let names: Vec<&str> = records.iter().map(|c| scene.text(c.name)).collect();
            Failure::usage(format!("no camera '{name}'; the scene has {}: {names:?}", names.len()))
        })?;
        return Ok(vec![Camera::from_record(record).map_err(Failure::input)?]);
    }
    Ok(match arguments.view.unwrap_or(View::Auto) {
        View::Auto => vec![auto_view(scene)],
        View::Outside => vec![outside_view(scene)],
        View::Rooms => {
            let views = room_views(scene, 2);
            if views.is_empty() {
                return Err(Failure::input("the scene has no room in which one could stand"));
            }
            views
        }
    })
}

/// Reads a file of cameras.
pub fn read_cameras(path: &Path, frame: &Frame) -> Result<Vec<Camera>, Failure> {
    use std::io::Read;
    /// Longer than any walk; a file that never ends is none.
    const LONGEST: u64 = 64 << 20;
    let name = path.display().to_string();
    let bad = |what: String| Failure::input(format!("{name}: {what}"));
    let mut text = String::new();
    let file = std::fs::File::open(path).map_err(|e| bad(e.to_string()))?;
    let length = file.take(LONGEST).read_to_string(&mut text).map_err(|e| bad(e.to_string()))?;
    if length as u64 == LONGEST {
        return Err(bad(format!("longer than {LONGEST} bytes: no file of cameras")));
    }
    let cameras = parse_cameras(&text, &name, frame).map_err(Failure::input)?;
    if cameras.is_empty() {
        return Err(Failure::input(format!("{name}: no camera in it")));
    }
    Ok(cameras)
}
