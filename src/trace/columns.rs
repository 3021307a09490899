//! Which triangles of a volume a vertical line may cross: a grid over its plan, finer where they are smaller, made when it is first asked for.
//!
//! Whether a point lies inside of a volume hangs on the triangles over it ([`super::locate::crossings`]). Slabs and walls of large buildings have
//! thousands, and one in a hundred rays of a random walk asks.

use std::sync::OnceLock;

use super::walk::each;
use crate::format::Views;
use crate::format::records::VolumeRecord;

/// The grids of a scene's volumes.
pub(crate) struct Columns(Vec<OnceLock<Box<Grid>>>);

impl Columns {
    /// Fewer triangles are looked at one by one.
    const FEW: u32 = 24;

    pub(crate) fn new(tables: &Views) -> Columns {
        Columns(tables.volumes.iter().map(|_| OnceLock::new()).collect())
    }

    /// The corners of all triangles of volume `index` that the vertical line through a point may cross, and perhaps of others.
    #[inline]
    pub(super) fn over<'a>(
        &'a self,
        tables: &'a Views,
        index: usize,
        point: [f64; 3],
    ) -> impl Iterator<Item = [[f64; 3]; 3]> + 'a {
        let volume = &tables.volumes[index];
        let first = volume.first_triangle;
        let listed = (volume.triangle_count > Columns::FEW)
            .then(|| self.0[index].get_or_init(|| Box::new(Grid::new(tables, volume))).at(point));
        let some = listed.into_iter().flatten().map(move |&item| first + item);
        let all = if listed.is_some() { 0..0 } else { first..first + volume.triangle_count };
        some.chain(all).map(move |triangle| corners(tables, triangle))
    }
}

#[inline(always)]
fn corners(tables: &Views, triangle: u32) -> [[f64; 3]; 3] {
    each(tables.triangles[triangle as usize], |v| tables.vertices[v as usize])
}

/// Rectangles over a volume's plan, in rows along x, and the triangles over each.
struct Grid {
    /// Along each axis the lines between columns and rows, lowest first.
    lines: [Vec<f64>; 2],
    /// For each rectangle its first item, and the end of the last.
    starts: Vec<u32>,
    /// Triangles, counted from the volume's first.
    items: Vec<u32>,
}

impl Grid {
    /// At most so many items for each triangle, and rectangles.
    const SHARE: u64 = 8;

    fn new(tables: &Views, volume: &VolumeRecord) -> Grid {
        let count = volume.triangle_count;
        let [lo, hi] = volume.bounds.map(|[x, y, _]| [x, y]);
        // What is beside a triangle by more than roundings is not crossed, however it is computed.
        let margins = [0, 1].map(|axis| lo[axis].abs().max(hi[axis].abs()) * (-40f64).exp2());
        let boxes: Vec<[[f64; 2]; 2]> = (0..count)
            .map(|item| {
                let corners = corners(tables, volume.first_triangle + item);
                [0, 1].map(|axis| {
                    let [a, b, c] = corners.map(|corner| corner[axis]);
                    [a.min(b).min(c) - margins[axis], a.max(b).max(c) + margins[axis]]
                })
            })
            .collect();
        let places = [0, 1].map(|axis| Places::new(boxes.iter().map(|of| of[axis]), margins[axis]));
        // As fine as triangles are: slivers side by side have columns across them, and no rows.
        let mut dims =
            places.each_ref().map(|places| (2.0 / places.mean_extent).min(f64::from(count)) as usize);
        loop {
            let lines = [0, 1].map(|axis| places[axis].lines(dims[axis]));
            let counts = lines.each_ref().map(|lines| lines.len() + 1);
            let covered = |of: &[[f64; 2]; 2]| [0, 1].map(|axis| of[axis].map(|c| place(&lines[axis], c)));
            let total: u64 =
                boxes.iter().map(covered).map(|[x, y]| ((x[1] - x[0] + 1) * (y[1] - y[0] + 1)) as u64).sum();
            let most = Grid::SHARE * u64::from(count);
            if total.max(counts[0] as u64 * counts[1] as u64) > most && counts != [1, 1] {
                dims = counts.map(|n| n.div_ceil(2));
                continue;
            }
            let rectangles = |[x, y]: [[usize; 2]; 2]| {
                (y[0]..=y[1]).flat_map(move |row| (x[0]..=x[1]).map(move |column| row * counts[0] + column))
            };
            let mut starts = vec![0; counts[0] * counts[1] + 1];
            boxes.iter().map(covered).flat_map(rectangles).for_each(|at| starts[at + 1] += 1);
            for at in 1..starts.len() {
                starts[at] += starts[at - 1];
            }
            let mut free = starts.clone();
            let mut items = vec![0; total as usize];
            for (item, of) in (0..).zip(&boxes) {
                for at in rectangles(covered(of)) {
                    items[free[at] as usize] = item;
                    free[at] += 1;
                }
            }
            return Grid { lines, starts, items };
        }
    }

    #[inline]
    fn at(&self, [x, y, _]: [f64; 3]) -> &[u32] {
        let [columns, rows] = &self.lines;
        let at = place(rows, y) * (columns.len() + 1) + place(columns, x);
        &self.items[self.starts[at] as usize..self.starts[at + 1] as usize]
    }
}

/// Which column or row a coordinate is in.
#[inline]
fn place(lines: &[f64], c: f64) -> usize {
    lines.partition_point(|&line| line <= c)
}

/// Where along an axis triangles begin and end.
struct Places {
    /// Those places, lowest first, each once.
    ends: Vec<f64>,
    /// How many of them a triangle covers, as a share of all.
    mean_extent: f64,
}

impl Places {
    /// Of triangles from and to; what is no farther apart than `margin` is one place.
    fn new(extents: impl ExactSizeIterator<Item = [f64; 2]> + Clone, margin: f64) -> Places {
        let mut ends: Vec<f64> = extents.clone().flatten().collect();
        ends.sort_unstable_by(f64::total_cmp);
        // Those are too far out by a margin, each way.
        ends.dedup_by(|next, end| *next - *end <= 4.0 * margin);
        let covered = |[from, to]: [f64; 2]| place(&ends, to) - place(&ends, from) + 1;
        let covered: usize = extents.clone().map(covered).sum();
        let mean_extent = covered as f64 / (ends.len().max(1) * extents.len().max(1)) as f64;
        Places { ends, mean_extent }
    }

    /// Lines that part it into `count`, or fewer, with about as many places in each.
    fn lines(&self, count: usize) -> Vec<f64> {
        let between = |index: usize| 0.5 * (self.ends[index - 1] + self.ends[index]);
        let most = count.min(self.ends.len());
        (1..most).map(|k| between(k * self.ends.len() / most)).collect()
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use crate::trace::locate::crossings;

    #[test]
    fn lines_cross_the_same_triangles_with_the_grid_and_without() {
        let scene = crate::samples::Sample::Build1.scene();
        let tables = &scene.tables;
        let columns = Columns::new(tables);
        let mut random = crate::splitmix::SplitMix64::new(3);
        let (mut large, mut crossed) = (0, 0);
        for (index, volume) in tables.volumes.iter().enumerate() {
            large += u32::from(volume.triangle_count > Columns::FEW);
            let [lo, hi] = volume.bounds;
            let own = || {
                (volume.first_triangle..volume.first_triangle + volume.triangle_count)
                    .map(|t| corners(tables, t))
            };
            let vertices: Vec<[f64; 3]> = own().flatten().collect();
            let anywhere = (0..40)
                .map(|_| [0, 1, 2].map(|i| random.between(lo[i] - 0.1, hi[i] + 0.1)))
                .collect::<Vec<_>>();
            // Over corners, and over the middles of edges.
            let corners = vertices.iter().step_by(7).copied();
            let middles =
                vertices.windows(2).step_by(5).map(|w| [0, 1, 2].map(|i| (w[0][i] + w[1][i]) / 2.0));
            for point in anywhere.into_iter().chain(corners).chain(middles) {
                let point = [point[0], point[1], lo[2] - 0.05];
                let all = crossings(own(), point);
                assert_eq!(crossings(columns.over(tables, index, point), point), all);
                crossed += all.count;
            }
        }
        assert!(large > 10 && crossed > 1000, "{large} {crossed}");
    }

    #[test]
    fn a_hint_changes_nothing() {
        let model = crate::generate::house(&Default::default()).to_model().unwrap();
        let scene = crate::compile(&model, &crate::CompileOptions::default()).unwrap().scene();
        let ([lo, hi], cells) = (scene.hull(), scene.cells().len() as f64);
        let mut random = crate::splitmix::SplitMix64::new(4);
        // A walk, and steps through walls.
        let mut hint = 0;
        for k in 0..20_000 {
            let point = [0, 1, 2].map(|i| random.between(lo[i] - 0.2, hi[i] + 0.2));
            let place = scene.locate(point);
            assert_eq!(scene.locate_near(point, hint), place);
            hint = match place {
                crate::Place::Air { cell, .. } if k % 3 == 0 => cell,
                _ if k % 7 == 0 => u32::MAX,
                _ => random.between(0.0, cells) as u32,
            };
        }
    }
}
