//! Convert and render: reads a model (.glb, .gltf, .obj), compiles it, and writes a picture of it, from the largest
//! room or from outside.
//!
//!     cargo run --release --example render -- fixtures/house.glb house.png
//!     cargo run --release --example render -- fixtures/house.glb house.exr --outside --color semantic --size 800x600

use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;

use enfilade::importers::{ImportOptions, import};
use enfilade::render::{ColorMode, RenderOptions, auto_view, outside_view, render, write_exr, write_png};
use enfilade::{CompileOptions, compile};

const USAGE: &str = "usage: render MODEL PICTURE.png|.exr [--outside] [--color MODE] [--size WxH]";

struct Arguments {
    model: PathBuf,
    picture: PathBuf,
    is_outside: bool,
    color: ColorMode,
    size: (u32, u32),
}

fn parse(words: impl IntoIterator<Item = String>) -> Result<Arguments, Box<dyn Error>> {
    let (mut files, mut is_outside, mut color, mut size) =
        (Vec::new(), false, ColorMode::Material, (1024, 1024));
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--outside" => is_outside = true,
            "--color" => color = words.next().ok_or(USAGE)?.parse()?,
            "--size" => {
                let text = words.next().ok_or(USAGE)?;
                let (width, height) = text.split_once('x').ok_or(USAGE)?;
                size = (width.parse()?, height.parse()?);
            }
            option if option.starts_with("--") => return Err(USAGE.into()),
            _ => files.push(PathBuf::from(word)),
        }
    }
    let [model, picture] = <[PathBuf; 2]>::try_from(files).map_err(|_| USAGE)?;
    Ok(Arguments { model, picture, is_outside, color, size })
}

/// Does what the words of a command line say, and tells `out` about it.
pub fn run(words: impl IntoIterator<Item = String>, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let arguments = parse(words)?;
    // Files in, building out.
    let model = import(&arguments.model, &ImportOptions::default())?;
    let scene = compile(&model, &CompileOptions::default())?.scene();

    // From where? Inside the largest room, or outside.
    let camera = if arguments.is_outside { outside_view(&scene) } else { auto_view(&scene) };

    let (width, height) = arguments.size;
    let mut options = RenderOptions::new(width, height, arguments.color);
    options.frame = scene.frame();
    let picture = render(&scene, &camera, &options)?;
    if let Some(element) = picture.in_solid() {
        writeln!(out, "the camera is inside {}", scene.element(element).id())?;
    }

    let path = &arguments.picture;
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        write_exr(&picture, path, &scene.frame())?;
    } else {
        write_png(&picture, path)?;
    }
    let [x, y, z] = scene.frame().point_to_source(camera.eye());
    writeln!(out, "{} from ({x:.3} {y:.3} {z:.3})", path.display())?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().skip(1), &mut io::stdout().lock())
}
