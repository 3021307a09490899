//! Pictures of a compiled scene by beams: from the middle of each room, and how long each took.
//!
//! ```text
//! cargo run --release --example beams -- house.enf
//! ```

use std::time::Instant;

use anyhow::Context;
use enfilade::Scene;
use enfilade::beam::Beams;
use enfilade::render::room_views;

const SIZE: u32 = 1024;

fn main() -> anyhow::Result<()> {
    let path = std::env::args().nth(1).context("usage: beams SCENE.enf [PICTURE.png]")?;
    let scene = Scene::open(path.as_ref())?;
    let mut beams = Beams::new(&scene);
    let mut pixels = vec![0; (SIZE * SIZE) as usize];
    for (index, camera) in room_views(&scene, 2).iter().enumerate() {
        // The first picture warms the buffers.
        beams.paint(camera, SIZE, &mut pixels);
        let start = Instant::now();
        let counts = beams.paint(camera, SIZE, &mut pixels);
        let time = start.elapsed().as_secs_f64();
        println!("view {index}: {:.3} ms, {counts:?}", time * 1e3);
    }
    if let Some(out) = std::env::args().nth(2) {
        let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_le_bytes()).collect();
        image::save_buffer(out, &bytes, SIZE, SIZE, image::ColorType::Rgba8)?;
    }
    Ok(())
}
