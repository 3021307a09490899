//! The truth: what a ray meets in the model's own triangles, in f64.
//!
//! It shares no code with the tracer, and uses other formulas: the sides of edges with exact signs where f64 is not
//! sure (`triangle`), a search through all triangles (`brute`), nested uniform grids that rule triangles out
//! for the large runs (`grid`, checked against the brute force by [`Truth::check_grid`]), solid angles for what is
//! inside a solid (`shell`). Its own error is known from [`rational`], which does not round at all. What makes an answer *right* is written down in [`right`].

mod arrangement;
mod brute;
mod exact;
#[cfg(test)]
pub(crate) mod fixtures;
mod grid;
mod leave;
mod random;
pub mod rational;
pub mod rays;
pub mod right;
mod shell;
mod soup;
mod triangle;
mod vector;
mod witness;

use enfilade_importers::{ElementId, Model, Role};

use crate::parallel;

pub use rational::{First, On};
pub use rays::{RayKind, RaySource};
pub use right::{Judgement, Verdict, Why};
pub use soup::Nearest;

pub(crate) use random::Random;

use brute::Brute;
use grid::Grid;
use shell::Body;
use soup::Soup;
use triangle::Line;
use vector::Bounds;

use crate::trace::Ray;

/// What the truth is about.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TruthOptions {
    /// How far from the ray another ray may be whose exact answer counts as right, metres; see [`right`]. Not
    /// negative; 1 mm by default.
    pub tolerance: f64,
}

impl Default for TruthOptions {
    fn default() -> TruthOptions {
        TruthOptions { tolerance: 1e-3 }
    }
}

impl TruthOptions {
    /// The same with another tolerance, metres.
    pub fn with_tolerance(mut self, tolerance: f64) -> TruthOptions {
        self.tolerance = tolerance;
        self
    }
}

/// The exact answer to a ray.
#[derive(Clone, Debug, PartialEq)]
pub enum TrueAnswer {
    /// It meets this first. Of several triangles at the same `t`, the lowest element's lowest.
    Hit(Nearest),
    /// It meets nothing between its `tmin` and its `tmax`.
    Escaped,
    /// It starts (at its `tmin`) inside these carving solids, in the order of the model.
    InSolid(Vec<ElementId>),
}

/// A model's triangles, ready to say what a ray meets.
#[derive(Debug)]
pub struct Truth {
    soup: Soup,
    brute: Brute,
    grid: Grid,
    /// The carving solids: the elements of role solid that have a closed component.
    solids: Vec<(ElementId, Body)>,
    /// Their boxes, side by side: most points are in none or few.
    solid_bounds: Vec<Bounds>,
    tolerance: f64,
}

/// What [`Truth::check_grid`] found.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct GridCheck {
    /// Rays that both the grid and the brute force answered.
    pub rays: u64,
    /// Rays that met something.
    pub hits: u64,
    /// Rays whose two answers differ in any bit.
    pub different: u64,
    /// The first ray of those: origin, direction.
    pub first_different: Option<[[f64; 3]; 2]>,
}

impl Truth {
    /// The truth about `model`, whose elements have the roles that `role` gives. Air and what is to be ignored takes
    /// no part; closed components of [`Role::Solid`] elements carve.
    ///
    /// A tolerance that is negative or no number counts as 0, one beyond 1 m as 1 m.
    ///
    /// # Panics
    /// If an index in a mesh is out of range, which no [`ModelBuilder`](enfilade_importers::ModelBuilder) makes.
    pub fn new(model: &Model, role: impl Fn(ElementId) -> Role, options: &TruthOptions) -> Truth {
        let tolerance = options.tolerance.clamp(0.0, 1.0);
        let tolerance = if tolerance.is_nan() { 0.0 } else { tolerance };
        let soup = Soup::new(model, &role);
        let solid: Vec<usize> =
            (0..model.elements.len()).filter(|&index| role(ElementId(index as u32)) == Role::Solid).collect();
        let bodies = parallel::map(solid.len(), |i| Body::of(&model.elements[solid[i]].mesh));
        let solids: Vec<(ElementId, Body)> = solid
            .iter()
            .zip(bodies)
            .filter_map(|(&index, body)| Some((ElementId(index as u32), body?)))
            .collect();
        let solid_bounds = solids.iter().map(|(_, body)| body.bounds).collect();
        let brute = Brute::new(&soup);
        let grid = Grid::new(&soup, tolerance);
        Truth { soup, brute, grid, solids, solid_bounds, tolerance }
    }

    /// The tolerance, metres.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Triangles that take part.
    pub fn triangle_count(&self) -> usize {
        self.soup.len()
    }

    /// The box around the triangles that take part: lower and upper corner.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        self.soup.bounds.map(|b| [b.lo, b.hi])
    }

    /// The nearest hit between the ray's `tmin` and `tmax`, by the grid, whatever the ray starts inside of.
    pub fn nearest(&self, ray: &Ray) -> Option<Nearest> {
        let line = Line::new(ray)?;
        match self.grid.nearest(&self.soup, &line, ray) {
            Ok(best) => self.soup.nearest(best),
            Err(grid::TooFar) => self.brute.nearest(&self.soup, &[*ray]).pop().flatten(),
        }
    }

    /// The same for many rays, by looking at every triangle.
    pub fn nearest_by_brute_force(&self, rays: &[Ray]) -> Vec<Option<Nearest>> {
        self.brute.nearest(&self.soup, rays)
    }

    /// The carving solids that `point` is inside of, in the order of the model. On a surface either may be said.
    pub fn solids_at(&self, point: [f64; 3]) -> Vec<ElementId> {
        self.solids
            .iter()
            .zip(&self.solid_bounds)
            .filter(|((_, body), bounds)| bounds.contains(point) && body.contains(point))
            .map(|((element, _), _)| *element)
            .collect()
    }

    /// The exact answer. What is no ray (see [`Ray::is_valid`]) meets nothing.
    pub fn answer(&self, ray: &Ray) -> TrueAnswer {
        let Some(start) = start(ray) else { return TrueAnswer::Escaped };
        let solids = self.solids_at(start);
        if !solids.is_empty() {
            return TrueAnswer::InSolid(solids);
        }
        self.nearest(ray).map_or(TrueAnswer::Escaped, TrueAnswer::Hit)
    }

    /// Asks the grid and the brute force about `count` random rays from inside and outside the model's box, and some
    /// along axes and through vertices and edges.
    pub fn check_grid(&self, count: u64, seed: u64) -> GridCheck {
        let source = RaySource::new(self, seed);
        let kinds = [RayKind::Box, RayKind::Outside, RayKind::Hard];
        let rays: Vec<Ray> = (0..count).map(|i| source.ray(kinds[(i % 3) as usize], i)).collect();
        let brute = self.nearest_by_brute_force(&rays);
        let same = |a: &Option<Nearest>, b: &Option<Nearest>| match (a, b) {
            (Some(a), Some(b)) => {
                (a.t.to_bits(), a.element, a.triangle) == (b.t.to_bits(), b.element, b.triangle)
            }
            (None, None) => true,
            _ => false,
        };
        let differs = parallel::map(rays.len(), |i| !same(&brute[i], &self.nearest(&rays[i])));
        let first = differs.iter().position(|&differs| differs).map(|i| [rays[i].origin, rays[i].direction]);
        GridCheck {
            rays: count,
            hits: brute.iter().flatten().count() as u64,
            different: differs.iter().filter(|&&differs| differs).count() as u64,
            first_different: first,
        }
    }

    /// All hits of the line with `from <= t <= to`, by `t`, then by triangle.
    fn hits_between(&self, ray: &Ray, from: f64, to: f64) -> Vec<Nearest> {
        let Some(line) = Line::new(ray) else { return Vec::new() };
        let mut hits: Vec<Nearest> = self
            .near_line(&line, from, to)
            .into_iter()
            .filter_map(|index| self.soup.nearest(soup::Best { t: self.soup.pierce(&line, index)?, index }))
            .filter(|hit| (from..=to).contains(&hit.t))
            .collect();
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        hits
    }

    /// Whether the line meets an element between two places along it.
    pub(crate) fn meets(&self, ray: &Ray, element: u32, from: f64, to: f64) -> bool {
        self.hits_between(ray, from, to).iter().any(|hit| hit.element.0 == element)
    }

    /// Triangles that come within the tolerance of the line between `from` and `to`, and perhaps others; ascending.
    fn near_line(&self, line: &Line, from: f64, to: f64) -> Vec<u32> {
        match self.grid.near_line(line, from, to) {
            Ok(found) => found,
            Err(grid::TooFar) => (0..self.soup.len() as u32).collect(),
        }
    }

    fn model_bounds(&self) -> Bounds {
        self.soup.bounds.unwrap_or(Bounds { lo: [-1.0; 3], hi: [1.0; 3] })
    }
}

/// The point at which the ray starts: its origin, or the point at `tmin`. `None` for what is no ray.
fn start(ray: &Ray) -> Option<[f64; 3]> {
    let tmin = soup::first_t(ray);
    Line::new(ray).map(|line| if tmin > 0.0 { line.at(tmin) } else { ray.origin })
}

#[cfg(test)]
mod tests;
