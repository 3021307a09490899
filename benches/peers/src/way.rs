//! What is compared: ways to answer the same rays.

use bytemuck::{Pod, Zeroable};
use enfilade::{Hit, Ray, Scene, Start, Starts};
use glam::DVec3;

/// A ray as the peers take it: f32, relative to the middle of the scene.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Single {
    pub origin: [f32; 3],
    pub tmin: f32,
    pub direction: [f32; 3],
    pub tmax: f32,
}

/// Rays, as each way likes them best; made before the clock runs.
pub struct Rays {
    /// In f64, and the cell of the air in which each starts; of those that go on from hits these tell more.
    pub exact: Vec<Ray>,
    pub cells: Vec<u32>,
    /// The hits from which they go on; none, if they start in the air.
    pub hits: Vec<Hit>,
    pub singles: Vec<Single>,
}

/// Nearer than this, metres, peers meet nothing of rays that go on from a hit: mostly that would be what they start on.
const NEAR: f32 = 1e-4;

impl Rays {
    pub fn new(scene: &Scene, exact: Vec<Ray>, cells: Vec<u32>) -> Rays {
        let Rays { singles, .. } = Rays::rounded(scene, &exact);
        Rays { exact, cells, hits: Vec::new(), singles }
    }

    /// Rays that go on from hits.
    pub fn onward(scene: &Scene, exact: Vec<Ray>, hits: Vec<Hit>) -> Rays {
        let Rays { mut singles, .. } = Rays::rounded(scene, &exact);
        singles.iter_mut().for_each(|single| single.tmin = NEAR);
        Rays { exact, cells: hits.iter().map(|hit| hit.cell).collect(), hits, singles }
    }

    /// Where a ray starts, as far as it is known.
    pub fn start(&self, index: usize) -> Start<'_> {
        self.hits.get(index).map_or_else(|| Start::Cell(self.cells[index]), Start::Hit)
    }

    /// The same of all.
    pub fn starts(&self) -> Starts<'_> {
        if self.hits.is_empty() { Starts::Cells(&self.cells) } else { Starts::Hits(&self.hits) }
    }

    /// In f32 only.
    pub fn rounded(scene: &Scene, exact: &[Ray]) -> Rays {
        let center = center(scene);
        let single = |ray: &Ray| {
            let direction = DVec3::from(ray.direction).normalize();
            Single {
                origin: (DVec3::from(ray.origin) - center).as_vec3().to_array(),
                tmin: ray.tmin as f32,
                direction: direction.as_vec3().to_array(),
                tmax: ray.tmax as f32,
            }
        };
        let singles = exact.iter().map(single).collect();
        Rays { exact: Vec::new(), cells: Vec::new(), hits: Vec::new(), singles }
    }

    pub fn len(&self) -> usize {
        self.exact.len()
    }

    /// The first of them, to run before the clock does: so that no way pays for what the one before left in the caches.
    pub fn first(&self) -> Rays {
        let count = self.len() / 8;
        Rays {
            exact: self.exact[..count].to_vec(),
            cells: self.cells[..count].to_vec(),
            hits: self.hits[..count.min(self.hits.len())].to_vec(),
            singles: self.singles[..count].to_vec(),
        }
    }
}

/// What a way says of a ray: the distance, infinite if nothing is met, and the triangle.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Met {
    pub t: f64,
    pub triangle: u32,
    pub padding: u32,
}

impl Met {
    pub const NOTHING: Met = Met { t: f64::INFINITY, triangle: u32::MAX, padding: 0 };
}

/// A way to answer rays, ready to run on one thread.
pub trait Way {
    fn name(&self) -> String;

    /// Whether it can answer rays that go on from hits.
    fn goes_on(&self) -> bool {
        true
    }

    /// The nearest hit of each ray.
    fn nearest(&self, rays: &Rays, met: &mut [Met]);

    /// Whether anything is met between the ends of each ray; `false` if this way has no answer of its own for that.
    fn occluded(&self, rays: &Rays, answers: &mut [bool]) -> bool {
        let _ = (rays, answers);
        false
    }
}

/// What is taken off coordinates before they are rounded to f32.
pub fn center(scene: &Scene) -> DVec3 {
    let [lo, hi] = scene.hull().map(DVec3::from);
    (lo + hi) / 2.0
}

/// The corners of all triangles that rays can meet, in f32.
pub fn soup(scene: &Scene) -> Vec<[[f32; 3]; 3]> {
    let center = center(scene);
    let rounded = |p: [f64; 3]| (DVec3::from(p) - center).as_vec3().to_array();
    (0..scene.detail_triangle_count()).map(|t| scene.triangle(t).map(rounded)).collect()
}
