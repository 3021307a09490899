//! A picture by beams of each room of a model, and how long it took.
//!
//! ```text
//! cargo run --release --example beams -- fixtures/house.glb rooms.png
//! ```

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use enfilade::beam::Beams;
use enfilade::importers::{ImportOptions, import};
use enfilade::render::{numbered, room_views, write_png_rgba};
use enfilade::{CompileOptions, compile};

const SIZE: u32 = 512;

/// Does what the words of a command line say, and tells `out` about it.
pub fn run(words: impl IntoIterator<Item = String>, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = words.into_iter().collect();
    let [model, picture] = words.as_slice() else { return Err("usage: beams MODEL OUT.png".into()) };
    let model = import(model.as_ref(), &ImportOptions::default())?;
    let scene = compile(&model, &CompileOptions::default())?.scene();
    let mut beams = Beams::new(&scene);
    let mut pixels = vec![0; (SIZE * SIZE) as usize];
    let views = room_views(&scene, 1);
    for (index, camera) in views.iter().enumerate() {
        // The first picture warms what is kept from one to the next.
        beams.paint(camera, SIZE, &mut pixels);
        let start = Instant::now();
        let counts = beams.paint(camera, SIZE, &mut pixels);
        let time = start.elapsed().as_secs_f64() * 1e3;
        let file = numbered(Path::new(picture), index, views.len());
        write_png_rgba(&pixels, SIZE, &file)?;
        let cells = counts.cells;
        writeln!(out, "{}: {time:.3} ms, through {cells} cells", file.display())?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().skip(1), &mut std::io::stdout())
}
