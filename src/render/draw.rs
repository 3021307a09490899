//! From a scene and a camera to a picture.

use std::sync::atomic::{AtomicUsize, Ordering};

use enfilade_importers::{Budget, Cancelled, Frame, Limits, OverBudget, Watch};

use super::camera::{Camera, Pinhole};
use super::choose::PictureWay;
use super::color::{ColorMode, IN_SOLID, SKY, linear, ramp};
use super::picture::{Picture, Pixel};
use super::shade::shade;
use crate::beam::{Beams, Told};
use crate::packets::Packets;
use crate::scene::Scene;
use crate::trace::{Hit, Place, Ray, Start, Starts, Want};

/// How to make a picture.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RenderOptions {
    /// Pixels in a row. Default 1024.
    pub width: u32,
    /// Rows. Default 1024.
    pub height: u32,
    /// What the colours show.
    pub color: ColorMode,
    /// The frame in whose axes [`ColorMode::Normal`] shows normals: the source's own, [`Scene::frame`], or by default
    /// the internal one.
    pub frame: Frame,
    /// The near and the far end of the ramp of [`ColorMode::Depth`], metres. Default: the least and greatest depth.
    pub depth_range: Option<[f64; 2]>,
    /// What the picture may cost.
    pub limits: Limits,
    /// Progress and cancellation.
    pub watch: Watch,
}

impl Default for RenderOptions {
    fn default() -> RenderOptions {
        RenderOptions {
            width: 1024,
            height: 1024,
            color: ColorMode::default(),
            frame: Frame::default(),
            depth_range: None,
            limits: Limits::default(),
            watch: Watch::default(),
        }
    }
}

impl RenderOptions {
    /// The default options for a picture of `width` by `height` pixels that shows `color`.
    pub fn new(width: u32, height: u32, color: ColorMode) -> RenderOptions {
        RenderOptions { width, height, color, ..RenderOptions::default() }
    }
}

/// A picture could not be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// It has no pixels.
    #[error("a picture of {0} x {1} pixels has none")]
    Empty(u32, u32),
    /// More memory would be needed than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// Cancelled through its token.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Pictures are made in squares of this many pixels, whose rays meet much the same things.
const TILE: u32 = 16;

/// Rays that are traced together are those of so many columns and rows, which meet the same more often than those of a row.
const GROUP: (u32, u32) = (4, 2);

/// Edge of the squares of what is seen from inside a solid.
const CHECKER: u32 = 16;

/// The picture that `camera` takes of `scene`.
///
/// With the feature `rayon` the work is shared among the threads of the current pool: call it inside
/// `ThreadPool::install` to use your own. The picture does not depend on it.
///
/// From inside a solid there is nothing to be seen: see [`Picture::in_solid`].
///
/// # Errors
/// [`RenderError`].
pub fn render(scene: &Scene, camera: &Camera, options: &RenderOptions) -> Result<Picture, RenderError> {
    let (width, height) = (options.width, options.height);
    if width == 0 || height == 0 {
        return Err(RenderError::Empty(width, height));
    }
    let count = u64::from(width) * u64::from(height);
    // The ramp of depth and cost sorts a number per pixel.
    // Beams tell two numbers per pixel, packets one; those at borders are listed, and marked.
    let item = size_of::<Pixel>() + size_of::<f32>() + 3 * size_of::<u32>() + 2 * size_of::<usize>() + 1;
    Budget::new(&options.limits).take_items(count, item, "the picture")?;
    let blank = Pixel::new(&crate::trace::Hit::ESCAPED);
    let mut pixels = vec![blank; count as usize];

    let place = scene.locate(camera.eye());
    options.watch.check()?;
    // Steps are those of rays.
    let by_beams = options.color != ColorMode::Cost
        && PictureWay::of(scene, camera, (width, height), false) == PictureWay::Beams;
    let (told, beams) = by_beams.then(|| Beams::new(scene).tell(camera, width, height)).unzip();
    let job = Job {
        told,
        scene,
        pinhole: camera.pinhole(width, height),
        options,
        starts: scene.starts_at(camera.eye(), crate::trace::NONE),
        bands: height.div_ceil(TILE) as usize,
        done: AtomicUsize::new(0),
    };
    job.fill(&mut pixels)?;

    let scale = match options.color {
        ColorMode::Depth => color_depth(&mut pixels, options.depth_range),
        ColorMode::Cost => color_cost(&mut pixels),
        ColorMode::Packet if !matches!(place, Place::InSolid(_)) => {
            let mut sizes = vec![0; pixels.len()];
            Packets::new(scene).sizes(camera, width, &mut sizes);
            Some(color_packets(&mut pixels, &sizes))
        }
        _ => None,
    };
    let in_solid = match place {
        Place::InSolid(element) if pixels.iter().all(Pixel::is_in_solid) => Some(element),
        _ => None,
    };
    Ok(Picture { width, height, mode: options.color, scale, in_solid, beams, pixels })
}

/// One picture under way.
struct Job<'a> {
    /// What beams tell of the pixels.
    told: Option<Told>,
    scene: &'a Scene,
    pinhole: Pinhole,
    options: &'a RenderOptions,
    starts: Starts<'a>,
    bands: usize,
    done: AtomicUsize,
}

impl Job<'_> {
    /// Fills all pixels, by bands of rows.
    fn fill(&self, pixels: &mut [Pixel]) -> Result<(), Cancelled> {
        let band = self.options.width as usize * TILE as usize;
        #[cfg(feature = "rayon")]
        {
            use rayon::prelude::*;
            pixels.par_chunks_mut(band).enumerate().try_for_each(|(index, rows)| self.fill_band(index, rows))
        }
        #[cfg(not(feature = "rayon"))]
        pixels.chunks_mut(band).enumerate().try_for_each(|(index, rows)| self.fill_band(index, rows))
    }

    fn fill_band(&self, index: usize, rows: &mut [Pixel]) -> Result<(), Cancelled> {
        self.options.watch.check()?;
        let (width, top) = (self.options.width, index as u32 * TILE);
        let height = (rows.len() / width as usize) as u32;
        let mut tile = Tile::default();
        for left in (0..width).step_by(TILE as usize) {
            tile.fill([left, top], [width.min(left.saturating_add(TILE)), top + height]);
            self.trace(&mut tile);
            for (index, &[x, y]) in tile.places.iter().enumerate() {
                rows[(y - top) as usize * width as usize + x as usize] = self.pixel([x, y], &tile, index);
            }
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.options.watch.report("render", done as f64 / self.bands as f64);
        Ok(())
    }

    /// What the rays of a tile meet.
    fn trace(&self, tile: &mut Tile) {
        let rays = tile.places.iter().map(|&[x, y]| self.pinhole.ray(x, y));
        tile.rays.clear();
        tile.rays.extend(rays);
        tile.hits.clear();
        tile.costs.clear();
        let want = Want::default();
        let want = match self.options.color {
            ColorMode::Cost => {
                // Steps are those of rays by themselves.
                let start =
                    if let Starts::Cell(cell) = self.starts { Start::Cell(cell) } else { Start::Anywhere };
                for ray in &tile.rays {
                    let (hit, cost) = self.scene.trace_cost_from(start, ray, want);
                    tile.hits.push(hit);
                    tile.costs.push(cost.total());
                }
                return;
            }
            ColorMode::Face => want.with_face(),
            _ => want,
        };
        tile.hits.resize(tile.rays.len(), Hit::ESCAPED);
        match &self.told {
            None => self.scene.trace_many_of(self.starts, &tile.rays, &mut tile.hits, want),
            Some(told) => self.by_beams(told, tile, want),
        }
    }

    /// The same by what beams tell, and by rays where they do not.
    fn by_beams(&self, told: &Told, tile: &mut Tile, want: Want) {
        let width = self.options.width as usize;
        let pixels = tile.places.iter().map(|&[x, y]| y as usize * width + x as usize);
        let pixels = pixels.zip(tile.rays.iter().copied());
        told.hits(self.scene, pixels, (want, self.starts), &mut tile.hits);
    }

    fn pixel(&self, [x, y]: [u32; 2], tile: &Tile, index: usize) -> Pixel {
        let (ray, hit) = (&tile.rays[index], &tile.hits[index]);
        let mut pixel = Pixel { cost: tile.costs.get(index).map_or(0, |&cost| cost), ..Pixel::new(hit) };
        pixel.color = if pixel.is_in_solid() {
            linear(IN_SOLID[((x / CHECKER + y / CHECKER) % 2) as usize])
        } else {
            shade(self.scene, ray, hit, self.options.color, &self.options.frame)
        };
        pixel
    }
}

/// Some pixels, group by group, and what their rays meet.
#[derive(Default)]
struct Tile {
    places: Vec<[u32; 2]>,
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    /// Steps, if they are counted.
    costs: Vec<u32>,
}

impl Tile {
    /// The pixels from one place up to another.
    fn fill(&mut self, [left, top]: [u32; 2], [right, bottom]: [u32; 2]) {
        let (columns, rows) = GROUP;
        self.places.clear();
        for group_y in (top..bottom).step_by(rows as usize) {
            for group_x in (left..right).step_by(columns as usize) {
                for y in group_y..group_y + rows.min(bottom - group_y) {
                    let across = columns.min(right - group_x);
                    self.places.extend((group_x..group_x + across).map(|x| [x, y]));
                }
            }
        }
    }
}

/// Colours the pixels by depth, near ones light. Returns the ends of the ramp: far, near.
fn color_depth(pixels: &mut [Pixel], range: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let met = pixels.iter().map(|p| p.depth).filter(|d| d.is_finite());
    let [near, far] = match range {
        Some(range) => range,
        None => {
            let (near, far) = met.fold((f32::INFINITY, 0.0f32), |(lo, hi), d| (lo.min(d), hi.max(d)));
            near.is_finite().then_some([f64::from(near), f64::from(far)])?
        }
    };
    let size = far - near;
    for pixel in pixels.iter_mut().filter(|p| p.depth.is_finite()) {
        let away = f64::from(pixel.depth) - near;
        pixel.color = ramp(if size > 0.0 { 1.0 - away / size } else { 1.0 });
    }
    Some([far, near])
}

/// Colours the pixels by the edges of the packets that told them; those left to rays as single pixels. Returns the ends of the ramp.
fn color_packets(pixels: &mut [Pixel], sizes: &[u32]) -> [f64; 2] {
    // Sizes that are no packets' are marks of pixels left to rays.
    let size = |size: u32| if size > Packets::<&Scene>::LARGEST { 1 } else { size.max(1) };
    let largest = sizes.iter().map(|&s| size(s)).max().unwrap_or(1);
    let most = f64::from(largest.max(2)).log2();
    for (pixel, &edge) in pixels.iter_mut().zip(sizes) {
        pixel.cost = size(edge);
        if !pixel.has_escaped() {
            pixel.color = ramp(f64::from(pixel.cost).log2() / most);
        }
    }
    [1.0, f64::from(largest)]
}

/// Colours the pixels by cost. Returns the ends of the ramp: none, and what all but one ray in a thousand stay under.
fn color_cost(pixels: &mut [Pixel]) -> Option<[f64; 2]> {
    let mut costs: Vec<u32> = pixels.iter().filter(|p| !p.is_in_solid()).map(|p| p.cost).collect();
    if costs.is_empty() {
        return None;
    }
    let rank = costs.len() - 1 - costs.len() / 1000;
    let most = f64::from((*costs.select_nth_unstable(rank).1).max(1));
    for pixel in pixels.iter_mut().filter(|p| !p.is_in_solid()) {
        // Rays that escape cost something too: their sky is shown only where there was nothing to do.
        pixel.color = if pixel.cost == 0 { linear(SKY) } else { ramp(f64::from(pixel.cost) / most) };
    }
    Some([0.0, most])
}
