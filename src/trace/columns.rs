//! Which triangles of a volume a vertical line may cross: a grid over its plan, made when it is first asked for.
//!
//! Whether a point lies inside of a volume hangs on the triangles over it ([`super::locate::crossings`]). Slabs and walls of large buildings have
//! thousands, and one in a hundred rays of a random walk asks.

use std::sync::OnceLock;

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

    /// Calls `each` with the corners of all triangles of volume `index` that the vertical line through a point may cross, and perhaps of others.
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

fn corners(tables: &Views, triangle: u32) -> [[f64; 3]; 3] {
    tables.triangles[triangle as usize].map(|v| tables.vertices[v as usize])
}

/// Squares over a volume's plan, x fastest, and the triangles over each.
struct Grid {
    lo: [f64; 2],
    /// Squares in a metre.
    per: [f64; 2],
    dims: [usize; 2],
    /// For each square its first item, and the end of the last.
    starts: Vec<u32>,
    /// Triangles, counted from the volume's first.
    items: Vec<u32>,
}

impl Grid {
    /// At most so many items for each triangle.
    const SHARE: u64 = 8;

    fn new(tables: &Views, volume: &VolumeRecord) -> Grid {
        let count = volume.triangle_count;
        let [lo, hi] = volume.bounds.map(|[x, y, _]| [x, y]);
        // What is beside a triangle by more than roundings is not crossed, however it is computed.
        let margin = [0, 1].map(|axis| lo[axis].abs().max(hi[axis].abs()) * (-40f64).exp2());
        let size = [0, 1].map(|axis| (hi[axis] - lo[axis]).max(1e-9));
        let wanted = f64::from(count);
        let along = (wanted * size[0] / size[1]).sqrt().clamp(1.0, wanted);
        let mut dims = [along.ceil() as usize, (wanted / along).ceil() as usize];
        loop {
            let mut grid = Grid {
                lo,
                per: [0, 1].map(|axis| dims[axis] as f64 / size[axis]),
                dims,
                starts: vec![0; dims[0] * dims[1] + 1],
                items: Vec::new(),
            };
            let boxes: Vec<[[usize; 2]; 2]> = (0..count)
                .map(|item| {
                    let corners = corners(tables, volume.first_triangle + item);
                    let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
                        pick(pick(corners[0][axis], corners[1][axis]), corners[2][axis])
                    };
                    [0, 1].map(|axis| {
                        [bound(axis, f64::min) - margin[axis], bound(axis, f64::max) + margin[axis]]
                            .map(|c| grid.place(axis, c))
                    })
                })
                .collect();
            let total: u64 = boxes.iter().map(|[x, y]| ((x[1] - x[0] + 1) * (y[1] - y[0] + 1)) as u64).sum();
            if total > Grid::SHARE * u64::from(count) && dims != [1, 1] {
                dims = dims.map(|n| n.div_ceil(2));
                continue;
            }
            let squares = |[x, y]: [[usize; 2]; 2]| {
                (y[0]..=y[1]).flat_map(move |row| (x[0]..=x[1]).map(move |column| row * dims[0] + column))
            };
            boxes.iter().flat_map(|&of| squares(of)).for_each(|square| grid.starts[square + 1] += 1);
            for square in 0..dims[0] * dims[1] {
                grid.starts[square + 1] += grid.starts[square];
            }
            let mut free = grid.starts.clone();
            grid.items = vec![0; total as usize];
            for (item, &of) in (0..).zip(&boxes) {
                for square in squares(of) {
                    grid.items[free[square] as usize] = item;
                    free[square] += 1;
                }
            }
            return grid;
        }
    }

    /// The row or column of squares at a coordinate, or the one nearest to it.
    #[inline]
    fn place(&self, axis: usize, c: f64) -> usize {
        // A negative number becomes 0.
        (((c - self.lo[axis]) * self.per[axis]) as usize).min(self.dims[axis] - 1)
    }

    #[inline]
    fn at(&self, [x, y, _]: [f64; 3]) -> &[u32] {
        let square = self.place(1, y) * self.dims[0] + self.place(0, x);
        &self.items[self.starts[square] as usize..self.starts[square + 1] as usize]
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use crate::trace::locate::crossings;

    #[test]
    fn lines_cross_the_same_triangles_with_the_grid_and_without() {
        let options = crate::generate::OfficeOptions::default();
        let model = crate::generate::build1(&options).to_model().unwrap();
        let scene = crate::compile(&model, &crate::CompileOptions::default()).unwrap().scene();
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
