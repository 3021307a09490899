//! Nested uniform grids that find the same hits as the brute force, faster.
//!
//! The grid only rules triangles out; what it leaves goes through the same test, so that its answers are the
//! brute force's to the last bit. That rests on three facts:
//!
//! 1. A triangle is listed in every cell from which it is at most [`Grid::pad`] away (along each axis).
//! 2. While the walk says that the line is in a cell, the line is at most [`Grid::slop`] outside that cell: the
//!    parameters where it crosses the cells' planes are computed afresh from the planes, `(plane - o) / d`, whose
//!    error, seen as a shift of the plane, is a few roundings of `plane - o`. The slop is a small part of the pad.
//!    For origins so far away that this fails, the walk is refused, and the caller looks at every triangle.
//! 3. A computed `t` is within [`T_ERROR`](super::triangle::T_ERROR) of the exact one, so a walk may stop once the best `t` lies that much
//!    before the end of the cell.
//!
//! The pad holds the tolerance as well: the walk along a line passes every triangle that comes within the tolerance
//! of it, which is what the search for witnesses needs.
//!
//! A cell with many triangles gets a grid of its own, so that a stray element a thousand kilometres away costs some
//! levels and no memory. Grids are made as fine as the number of references allows, never finer.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use super::soup::{Best, Soup, first_t};
use super::triangle::{Corners, Line, T_ERROR};
use super::vector::{Bounds, cross, dot, max_abs, sub};
use crate::trace::Ray;

/// Cells with more triangles than this may get a grid of their own.
const CROWD: usize = 12;

/// Grids within grids, at most.
const DEPTH: u32 = 10;

/// References that a grid may make of one triangle, on average.
const SHARE: usize = 8;

/// Cells and references a triangle over all levels; and as many more for small models.
const BUDGET: usize = 64;

/// Cells along one axis.
const MOST: f64 = 512.0;

/// A share of the coordinates' size, many roundings wide.
const SLOP: f64 = 64.0 * f64::EPSILON;

/// Coordinates of origins, metres, up to which [`Grid::slop`] holds even for small models.
const NEAR: f64 = 65536.0;

/// Nested grids over a soup.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    levels: Vec<Level>,
    cells: Vec<Cell>,
    references: Vec<u32>,
    slop: f64,
    pad: f64,
    /// Origins beyond this are refused.
    far: f64,
}

#[derive(Clone, Debug)]
struct Level {
    lo: [f64; 3],
    hi: [f64; 3],
    step: [f64; 3],
    count: [usize; 3],
    first_cell: usize,
}

/// Triangles `references[start..start + count]`, or the grid `levels[start]`.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    start: u32,
    count: u32,
}

const NESTED: u32 = u32::MAX;

/// The origin is too far from the model for the grid's error bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooFar;

impl Level {
    /// The plane between cells `index - 1` and `index`.
    fn plane(&self, axis: usize, index: usize) -> f64 {
        if index == self.count[axis] { self.hi[axis] } else { self.lo[axis] + index as f64 * self.step[axis] }
    }

    /// The cell along an axis; the first or last one beyond the ends.
    fn cell(&self, axis: usize, p: f64) -> usize {
        // A negative number or NaN becomes 0.
        (((p - self.lo[axis]) / self.step[axis]) as usize).min(self.count[axis] - 1)
    }

    fn number(&self, at: [usize; 3]) -> usize {
        self.first_cell + (at[2] * self.count[1] + at[1]) * self.count[0] + at[0]
    }

    fn cell_bounds(&self, at: [usize; 3]) -> Bounds {
        Bounds {
            lo: [0, 1, 2].map(|axis| self.plane(axis, at[axis])),
            hi: [0, 1, 2].map(|axis| self.plane(axis, at[axis] + 1)),
        }
    }
}

impl Grid {
    /// A grid that also serves [`Grid::near_line`] and [`Grid::near_point`] up to `tolerance`.
    pub(crate) fn new(soup: &Soup, tolerance: f64) -> Grid {
        let reach = soup.sizes.iter().fold(0.0, |a: f64, size| a.max(size.reach));
        let far = 4.0 * reach.max(NEAR);
        let slop = SLOP * far;
        let pad = tolerance + 2.0 * slop;
        let mut grid = Grid { levels: Vec::new(), cells: Vec::new(), references: Vec::new(), slop, pad, far };
        if let Some(bounds) = soup.bounds {
            let all: Vec<u32> = (0..soup.len() as u32).collect();
            let mut builder = Builder { soup, left: BUDGET * (soup.len() + 1024), grid: &mut grid };
            builder.grid.cells.push(Cell::default());
            // The model is the only cell of a level of its own, which is then refined like any other.
            let bounds = bounds.grown(pad);
            builder.grid.levels.push(Level {
                lo: bounds.lo,
                hi: bounds.hi,
                step: bounds.size(),
                count: [1; 3],
                first_cell: 0,
            });
            builder.fill(0, &all, bounds, 0);
        }
        grid
    }

    /// The nearest hit within the ray's `tmin` and `tmax`.
    pub(crate) fn nearest(&self, soup: &Soup, line: &Line, ray: &Ray) -> Result<Best, TooFar> {
        let mut best = Best::NONE;
        // Triangles that span cells would be tested again in each: remember the last few.
        let mut seen = [u32::MAX; 64];
        self.walk(line, first_t(ray), ray.tmax, |triangles, exit| {
            for &index in triangles {
                let slot = &mut seen[index as usize % 64];
                if *slot != index {
                    *slot = index;
                    if let Some(t) = soup.hit(line, ray, index) {
                        best.offer(t, index);
                    }
                }
            }
            if best.t + widening(best.t) < exit { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        Ok(best)
    }

    /// All triangles that come within the tolerance of the line between `from` and `to`, and perhaps others;
    /// ascending.
    pub(crate) fn near_line(&self, line: &Line, from: f64, to: f64) -> Result<Vec<u32>, TooFar> {
        let mut found = Vec::new();
        self.walk(line, from, to, |triangles, _| {
            found.extend_from_slice(triangles);
            ControlFlow::Continue(())
        })?;
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }

    /// All triangles within the tolerance of `p`, and perhaps others.
    pub(crate) fn near_point(&self, p: [f64; 3]) -> &[u32] {
        let Some(mut level) = self.levels.first() else { return &[] };
        loop {
            let inside = (0..3).all(|axis| level.lo[axis] <= p[axis] && p[axis] <= level.hi[axis]);
            if !inside {
                return &[];
            }
            let cell = self.cells[level.number([0, 1, 2].map(|axis| level.cell(axis, p[axis])))];
            if cell.count != NESTED {
                return self.list(cell);
            }
            level = &self.levels[cell.start as usize];
        }
    }

    fn list(&self, cell: Cell) -> &[u32] {
        &self.references[cell.start as usize..cell.start as usize + cell.count as usize]
    }

    /// Visits, in the order of the line, the lists of the cells that it passes between `from` and `to`, each with the
    /// `t` where it leaves the cell, until `visit` breaks.
    fn walk(
        &self,
        line: &Line,
        from: f64,
        to: f64,
        mut visit: impl FnMut(&[u32], f64) -> ControlFlow<()>,
    ) -> Result<(), TooFar> {
        if line.reach > self.far {
            return Err(TooFar);
        }
        if !self.levels.is_empty() {
            let (from, to) = (from - widening(from), to + widening(to));
            let _ = self.walk_level(&self.levels[0], line, from, to, &mut visit);
        }
        Ok(())
    }

    fn walk_level(
        &self,
        level: &Level,
        line: &Line,
        from: f64,
        to: f64,
        visit: &mut impl FnMut(&[u32], f64) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (o, d) = (line.origin, line.direction);
        let (mut enter, mut leave) = (from, to);
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis] < level.lo[axis] || o[axis] > level.hi[axis] {
                    return ControlFlow::Continue(());
                }
            } else {
                let (a, b) = ((level.lo[axis] - o[axis]) / d[axis], (level.hi[axis] - o[axis]) / d[axis]);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
        }
        if enter > leave {
            return ControlFlow::Continue(());
        }
        let start = line.at(enter);
        let mut at = [0, 1, 2].map(|axis| level.cell(axis, start[axis]));
        let crossing = |axis: usize, at: usize| {
            if d[axis] == 0.0 {
                f64::INFINITY
            } else {
                (level.plane(axis, at + usize::from(d[axis] > 0.0)) - o[axis]) / d[axis]
            }
        };
        let mut next = [0, 1, 2].map(|axis| crossing(axis, at[axis]));
        // Each round moves one index one step the same way, so the loop ends.
        loop {
            let axis = if next[0] <= next[1] && next[0] <= next[2] {
                0
            } else if next[1] <= next[2] {
                1
            } else {
                2
            };
            let exit = next[axis].min(leave);
            let cell = self.cells[level.number(at)];
            if cell.count == NESTED {
                self.walk_level(&self.levels[cell.start as usize], line, enter, exit, visit)?;
            } else {
                visit(self.list(cell), exit)?;
            }
            if next[axis] > leave {
                return ControlFlow::Continue(());
            }
            if d[axis] > 0.0 && at[axis] + 1 < level.count[axis] {
                at[axis] += 1;
            } else if d[axis] < 0.0 && at[axis] > 0 {
                at[axis] -= 1;
            } else {
                return ControlFlow::Continue(());
            }
            enter = enter.max(next[axis]);
            next[axis] = crossing(axis, at[axis]);
        }
    }
}

/// How far a computed `t` may be off, doubled.
fn widening(t: f64) -> f64 {
    if t.is_finite() { 2.0 * T_ERROR * (1.0 + t.abs()) } else { 0.0 }
}

struct Builder<'a> {
    soup: &'a Soup,
    grid: &'a mut Grid,
    /// Cells and references that may still be made.
    left: usize,
}

impl Builder<'_> {
    /// Fills cell `cell`, whose box is `bounds`, with `triangles`: as a list, or as a grid of its own.
    fn fill(&mut self, cell: usize, triangles: &[u32], bounds: Bounds, depth: u32) {
        if triangles.len() > CROWD && depth < DEPTH && self.refine(cell, triangles, bounds, depth) {
            return;
        }
        self.left = self.left.saturating_sub(triangles.len());
        self.grid.cells[cell] =
            Cell { start: self.grid.references.len() as u32, count: triangles.len() as u32 };
        self.grid.references.extend_from_slice(triangles);
    }

    /// Makes a grid of the cell, unless that would not help or cost too much.
    fn refine(&mut self, cell: usize, triangles: &[u32], bounds: Bounds, depth: u32) -> bool {
        let pad = self.grid.pad;
        let mut content = Bounds::EMPTY;
        for &index in triangles {
            content = content.union(Bounds::of(&self.soup.corners[index as usize]));
        }
        let bounds = bounds.grown(2.0 * self.grid.slop).intersection(content.grown(pad));
        if bounds.is_empty() {
            return false;
        }
        let mut target = 2.0 * triangles.len() as f64;
        for _ in 0..4 {
            let mut level = new_level(bounds, target);
            let cells: usize = level.count.iter().product();
            let most = (SHARE * triangles.len()).min(self.left.saturating_sub(cells));
            if cells > 1
                && self.left > cells
                && let Some((starts, lists)) = self.sort_into(&level, triangles, most)
            {
                let fullest = starts.windows(2).map(|w| w[1] - w[0]).max().unwrap_or(0);
                if fullest as usize * 10 > triangles.len() * 9 && lists.len() > 2 * triangles.len() {
                    return false;
                }
                level.first_cell = self.grid.cells.len();
                self.left -= cells;
                self.grid.cells[cell] = Cell { start: self.grid.levels.len() as u32, count: NESTED };
                self.grid.cells.resize(level.first_cell + cells, Cell::default());
                self.grid.levels.push(level.clone());
                for number in 0..cells {
                    let (x, rest) = (number % level.count[0], number / level.count[0]);
                    let at = [x, rest % level.count[1], rest / level.count[1]];
                    let list = &lists[starts[number] as usize..starts[number + 1] as usize];
                    self.fill(level.first_cell + number, list, level.cell_bounds(at), depth + 1);
                }
                return true;
            }
            target /= 8.0;
        }
        false
    }

    /// The triangles of each cell: where its list starts, and all lists. `None` if they are longer than `most`.
    fn sort_into(&self, level: &Level, triangles: &[u32], most: usize) -> Option<(Vec<u32>, Vec<u32>)> {
        let cells: usize = level.count.iter().product();
        let mut starts = vec![0u32; cells + 1];
        let mut total = 0usize;
        // Long oblique triangles pass few of the cells of their boxes: looking must not cost too much either.
        let mut looks = 64 * most.max(1024);
        let mut pairs = Vec::new();
        for &index in triangles {
            let corners = &self.soup.corners[index as usize];
            let bounds = Bounds::of(corners).grown(self.grid.pad);
            let low = [0, 1, 2].map(|axis| level.cell(axis, bounds.lo[axis]));
            let high = [0, 1, 2].map(|axis| level.cell(axis, bounds.hi[axis]));
            let slab = Slab::new(corners, level, self.grid.pad);
            let volume: usize = (0..3).map(|axis| high[axis] - low[axis] + 1).product();
            looks = looks.checked_sub(volume)?;
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        if slab.meets(level.cell_bounds([x, y, z]).center()) {
                            let number = (z * level.count[1] + y) * level.count[0] + x;
                            starts[number + 1] += 1;
                            total += 1;
                            if total > most {
                                return None;
                            }
                            pairs.push((number as u32, index));
                        }
                    }
                }
            }
        }
        for number in 0..cells {
            starts[number + 1] += starts[number];
        }
        let mut fill = starts.clone();
        let mut lists = vec![0u32; total];
        for (number, index) in pairs {
            lists[fill[number as usize] as usize] = index;
            fill[number as usize] += 1;
        }
        Some((starts, lists))
    }
}

/// A level of about `target` cells, as cubic as the box allows.
fn new_level(bounds: Bounds, target: f64) -> Level {
    let size = bounds.size();
    // Axes along which the box is thinner than a cube get one cell, and the others share the cells.
    let mut wide: Vec<usize> = (0..3).collect();
    let mut edge;
    loop {
        let volume: f64 = wide.iter().map(|&axis| size[axis].log2()).sum();
        edge = ((volume - target.max(1.0).log2()) / wide.len() as f64).exp2();
        let before = wide.len();
        wide.retain(|&axis| size[axis] > edge);
        if wide.len() == before || wide.is_empty() {
            break;
        }
    }
    let count = [0, 1, 2].map(|axis| {
        if wide.contains(&axis) { (size[axis] / edge).round().clamp(1.0, MOST) as usize } else { 1 }
    });
    let step = [0, 1, 2].map(|axis| size[axis] / count[axis] as f64);
    Level { lo: bounds.lo, hi: bounds.hi, step, count, first_cell: 0 }
}

/// The space within the pad of a triangle's plane, as seen by boxes of one size.
struct Slab {
    corner: [f64; 3],
    normal: [f64; 3],
    /// Half the box's width along the normal.
    width: f64,
    /// Bounds the error of the normal, for slivers.
    doubt: f64,
}

impl Slab {
    fn new(corners: &Corners, level: &Level, pad: f64) -> Slab {
        let (e, f) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let normal = cross(e, f);
        let width = (0..3).map(|axis| normal[axis].abs() * (0.5 * level.step[axis] + pad)).sum();
        Slab { corner: corners[0], normal, width, doubt: 64.0 * f64::EPSILON * max_abs(e) * max_abs(f) }
    }

    /// Whether the box around `center` may come within the pad of the plane.
    fn meets(&self, center: [f64; 3]) -> bool {
        let way = sub(center, self.corner);
        let far =
            dot(self.normal, way).abs().partial_cmp(&(self.width * (1.0 + 1e-9) + self.doubt * max_abs(way)));
        // A NaN counts as a meeting.
        far != Some(Ordering::Greater)
    }
}
