//! Whole pictures: exact beams, our packets, Embree's packets for the same pixels, and the shading floor.
//!
//! Beams and packets paint a picture, beams also on two threads; Embree is only asked for distance and triangle of each pixel's ray, with rays and room for
//! the answers made before the clock runs; the floor is [`crate::floor`]'s plane.

mod report;
mod views;

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context;
use enfilade::beam::{BeamCounts, Beams};
use enfilade::packets::{PacketCounts, Packets};
use enfilade::render::Camera;
use enfilade::{Kernel, Ray, Scene};
use serde::Serialize;

use crate::embree::{Built, Embree, Quality, Sixteen};
use crate::scenes::Measured;
use crate::way::{Met, Rays, Way, soup};
use crate::{Arguments, floor, median};
pub use report::{Report, lines, rows};

/// Pixels along a side of what Embree gets as one packet.
const TILE: u32 = 4;

/// What one picture took on all ways.
#[derive(Clone, Debug, Serialize)]
pub struct View {
    pub scene: String,
    /// `inside` or `outside`.
    pub from: &'static str,
    /// The eye, where the scene has its points.
    pub eye: [f64; 3],
    pub pixels: u64,
    /// One for each way that paints.
    pub painted: Vec<Painted>,
    /// Seconds for all pixels' rays, on the better of Embree's hierarchies.
    pub embree: Option<f64>,
    /// Seconds to shade one plane.
    pub floor: f64,
}

/// A picture by beams or packets.
#[derive(Clone, Debug, Serialize)]
pub struct Painted {
    /// What painted it, by which instructions, and, if not on one, on how many threads.
    pub way: String,
    pub seconds: f64,
    pub cells: u64,
    /// None by packets.
    pub spans: Option<u64>,
    pub triangles: u64,
    /// Pixels left to rays.
    pub unsure: u64,
}

/// What paints pictures.
struct Painter<'a> {
    name: String,
    maker: Maker<'a>,
    /// Threads, if not the one of the others.
    pool: Option<rayon::ThreadPool>,
}

enum Maker<'a> {
    Beams(Box<Beams<&'a Scene>>),
    Packets(Box<Packets<&'a Scene>>),
}

impl Painter<'_> {
    /// From outside packets draw all triangles that there are: nobody would use them.
    fn is_for(&self, from: &str) -> bool {
        from == "inside" || matches!(self.maker, Maker::Beams(_))
    }

    /// Paints a picture once more than once, so that caches are as that leaves them; on several threads for a while, until the system has put each of them on a
    /// core of its own. Returns what the last took, and the seconds.
    fn paint(&mut self, camera: &Camera, size: u32, picture: &mut [u32]) -> (Counts, f64) {
        let maker = &mut self.maker;
        let mut once = || match maker {
            Maker::Beams(beams) => Counts::Beams(beams.paint(camera, size, picture)),
            Maker::Packets(packets) => Counts::Packets(packets.paint(camera, size, picture)),
        };
        let warm = Duration::from_millis(if self.pool.is_some() { 60 } else { 0 });
        let mut last = || {
            let start = Instant::now();
            once();
            while start.elapsed() < warm {
                once();
            }
            let start = Instant::now();
            let counts = once();
            (counts, start.elapsed().as_secs_f64())
        };
        match &self.pool {
            // From a thread that sleeps until it is done: one of another pool would look for work meanwhile.
            Some(pool) => std::thread::scope(|scope| {
                let done = scope.spawn(|| pool.install(last)).join();
                done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            }),
            None => last(),
        }
    }
}

/// What a picture took.
#[derive(Clone, Copy)]
enum Counts {
    Beams(BeamCounts),
    Packets(PacketCounts),
}

impl Counts {
    fn painted(self, way: String, seconds: f64) -> Painted {
        match self {
            Counts::Beams(BeamCounts { cells, spans, triangles, unsure, .. }) => {
                Painted { way, seconds, cells, spans: Some(spans), triangles, unsure }
            }
            Counts::Packets(PacketCounts { cells, triangles, rays, .. }) => {
                Painted { way, seconds, cells, spans: None, triangles, unsure: rays }
            }
        }
    }
}

/// The pixels of a picture, tile by tile: sixteen that follow each other are a square of four by four. What is less
/// than a tile at the borders shifts those after it, so sizes should be multiples of four.
fn tiled(size: u32) -> impl Iterator<Item = (u32, u32)> {
    let starts = move || (0..size).step_by(TILE as usize);
    let within = move |from: u32| from..(from + TILE).min(size);
    let corners = starts().flat_map(move |top| starts().map(move |left| (left, top)));
    corners.flat_map(move |(left, top)| within(top).flat_map(move |y| within(left).map(move |x| (x, y))))
}

/// The rays of a picture, as [`tiled`].
fn rays(scene: &Scene, camera: &Camera, size: u32) -> Rays {
    let pinhole = camera.pinhole(size, size);
    let rays: Vec<Ray> = tiled(size).map(|(x, y)| pinhole.ray(x, y)).collect();
    Rays::rounded(scene, &rays)
}

/// The first of the rays, to run before the clock does.
fn first(rays: &Rays) -> Rays {
    let count = rays.singles.len() / 8;
    Rays { exact: Vec::new(), cells: Vec::new(), hits: Vec::new(), singles: rays.singles[..count].to_vec() }
}

/// Seconds that something takes.
fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// All ways on one scene, with what they keep from one picture to the next.
struct Ways<'a> {
    scene: &'a Scene,
    painters: Vec<Painter<'a>>,
    /// None without Embree.
    peers: Vec<Sixteen>,
    /// What is painted, and how many pixels wide and high it is.
    picture: Vec<u32>,
    size: u32,
    /// Embree's answers.
    met: Vec<Met>,
    repeat: usize,
}

impl<'a> Ways<'a> {
    fn new(
        scene: &'a Scene,
        embree: Option<&Arc<Embree>>,
        arguments: &Arguments,
    ) -> anyhow::Result<Ways<'a>> {
        let beams = |kernel: Kernel| Maker::Beams(Box::new(Beams::new(scene).with_kernel(kernel)));
        let packets = |kernel: Kernel| Maker::Packets(Box::new(Packets::new(scene).with_kernel(kernel)));
        let kernels = Kernel::available();
        let painter = |what: &str, kernel: &Kernel, maker| Painter {
            name: format!("{what} {}", kernel.name()),
            maker,
            pool: None,
        };
        let mut painters: Vec<Painter<'_>> =
            kernels.iter().map(|kernel| painter("beams", kernel, beams(*kernel))).collect();
        if let Some(best) = kernels.last() {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
            let name = format!("beams {} x 2", best.name());
            painters.push(Painter { name, maker: beams(*best), pool: Some(pool) });
        }
        painters.extend(kernels.iter().map(|kernel| painter("packets", kernel, packets(*kernel))));
        let peer = |embree: &Arc<Embree>, soup: &[[[f32; 3]; 3]], quality| Sixteen {
            built: Arc::new(Built::new(embree, soup, quality, false)),
            coherent: true,
        };
        let peers = embree.map_or_else(Vec::new, |embree| {
            let soup = soup(scene);
            [Quality::High, Quality::Medium].map(|quality| peer(embree, &soup, quality)).into()
        });
        let count = arguments.picture_size as usize * arguments.picture_size as usize;
        Ok(Ways {
            scene,
            painters,
            met: vec![Met::NOTHING; if peers.is_empty() { 0 } else { count }],
            peers,
            picture: vec![0; count],
            size: arguments.picture_size,
            repeat: arguments.repeat.max(1),
        })
    }

    /// The ways take turns. Each runs once before the clock does, or Embree an eighth: so that none pays for what the
    /// one before left in the caches.
    fn view(&mut self, name: &str, from: &'static str, camera: &Camera) -> View {
        let (size, picture, met) = (self.size, &mut self.picture, &mut self.met);
        let rays = (!self.peers.is_empty()).then(|| rays(self.scene, camera, size));
        let rays = rays.map(|rays| (first(&rays), rays));
        let mut painters: Vec<&mut Painter<'_>> =
            self.painters.iter_mut().filter(|painter| painter.is_for(from)).collect();
        let mut painting = vec![Vec::new(); painters.len()];
        let mut counts = vec![Counts::Packets(PacketCounts::default()); painters.len()];
        let mut tracing = vec![Vec::new(); self.peers.len()];
        let mut shading = Vec::new();
        for _ in 0..self.repeat {
            for (i, painter) in painters.iter_mut().enumerate() {
                let (took, seconds) = painter.paint(camera, size, picture);
                (counts[i], _) = (took, painting[i].push(seconds));
                black_box(&mut *picture);
            }
            for (peer, times) in self.peers.iter().zip(&mut tracing) {
                if let Some((first, rays)) = &rays {
                    peer.nearest(first, &mut met[..first.singles.len()]);
                    times.push(seconds(|| peer.nearest(rays, met)));
                    black_box(&mut *met);
                }
            }
            floor::shade(picture, size as usize);
            black_box(&mut *picture);
            shading.push(seconds(|| floor::shade(picture, size as usize)));
            black_box(&mut *picture);
        }
        let ways = painters.iter().zip(&mut painting).zip(&counts);
        let painted =
            ways.map(|((painter, times), counts)| counts.painted(painter.name.clone(), median(times)));
        View {
            scene: name.to_owned(),
            from,
            eye: camera.eye(),
            pixels: picture.len() as u64,
            painted: painted.collect(),
            embree: tracing.iter_mut().map(|times| median(times)).min_by(f64::total_cmp),
            floor: median(&mut shading),
        }
    }
}

/// Measures all ways on one scene, from inside and from outside.
///
/// # Errors
/// If a scene has no extent that it could be looked at from outside, or no thread can be started.
pub fn run(
    measured: &Measured,
    embree: Option<&Arc<Embree>>,
    arguments: &Arguments,
) -> anyhow::Result<Vec<View>> {
    let scene = &*measured.scene;
    let inside = views::inside(scene, arguments.views);
    let outside = views::outside(scene).with_context(|| measured.name.clone())?;
    let mut ways = Ways::new(scene, embree, arguments)?;
    let cameras = inside.iter().map(|camera| ("inside", camera));
    let cameras = cameras.chain(outside.iter().map(|camera| ("outside", camera)));
    // All of it on one thread of its own, but what says otherwise: the rays that beams leave would else go to all threads.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    Ok(pool.install(|| cameras.map(|(from, camera)| ways.view(&measured.name, from, camera)).collect()))
}

#[cfg(test)]
mod tests {
    use super::tiled;

    #[test]
    fn sixteen_pixels_are_a_square_and_none_is_left_out() {
        let pixels: Vec<(u32, u32)> = tiled(12).collect();
        for packet in pixels.chunks(16) {
            assert!(packet.iter().all(|(x, y)| (x / 4, y / 4) == (packet[0].0 / 4, packet[0].1 / 4)));
        }
        for size in [1, 7, 12] {
            let mut pixels: Vec<(u32, u32)> = tiled(size).collect();
            pixels.sort_unstable();
            assert_eq!(pixels, (0..size).flat_map(|x| (0..size).map(move |y| (x, y))).collect::<Vec<_>>());
        }
    }
}
