//! Partitions made by hand, for tests of the passes over them: a grid of columns, each a stack of prisms.

use enfilade_importers::ElementId;
use glam::DVec3;

use super::cells::{Cell, Cover, Face, Label, NONE, Partition, Section};
use super::matter::MatterTriangle;
use super::shapes::up;
use crate::lattice::{Lattice, Plane, Point};

/// Steps in a metre of the lattice of these partitions.
pub(super) const METRE: f64 = 65536.0;

/// The nearest lattice coordinate.
pub(super) fn steps(metres: f64) -> i32 {
    (metres * METRE).round() as i32
}

/// The level plane at so many metres.
pub(super) fn level(metres: f64) -> Plane {
    Plane::level(steps(metres))
}

/// Matter of an element.
pub(super) fn solid(element: u32) -> Label {
    Label::Solid(ElementId(element))
}

/// A grid of columns.
pub(super) struct Stacks {
    /// Metres, ascending.
    pub(super) xs: Vec<f64>,
    pub(super) ys: Vec<f64>,
    /// Where all stacks start, metres.
    pub(super) bottom: f64,
    /// From the bottom up what fills each prism and the plane above; the last is the same level for all columns. The
    /// column of the strip i of x and j of y is number i + j * strips of x.
    pub(super) columns: Vec<Vec<(Label, Plane)>>,
}

impl Stacks {
    /// A grid of boxes with the levels `zs`, metres.
    pub(super) fn boxes(xs: &[f64], ys: &[f64], zs: &[f64], label: impl Fn([usize; 3]) -> Label) -> Stacks {
        let columns = (0..(xs.len() - 1) * (ys.len() - 1)).map(|c| {
            let (i, j) = (c % (xs.len() - 1), c / (xs.len() - 1));
            (0..zs.len() - 1).map(|k| (label([i, j, k]), level(zs[k + 1]))).collect()
        });
        Stacks { xs: xs.to_vec(), ys: ys.to_vec(), bottom: zs[0], columns: columns.collect() }
    }

    /// The partition: a cell for each prism, column by column.
    pub(super) fn build(&self) -> Partition {
        let mut draft = Partition {
            lattice: Lattice { origin: [0.0; 3], turn: [1.0, 0.0], bits: 16 },
            hull: [[0; 3]; 2],
            planes: vec![level(self.bottom)],
            cells: Vec::new(),
            sections: Vec::new(),
            faces: Vec::new(),
            covers: Vec::new(),
            sources: Vec::new(),
            detail: Vec::new(),
        };
        // The planes between the prisms of each column, and the number of its first cell.
        let mut ends: Vec<Vec<u32>> = Vec::new();
        let mut first = Vec::new();
        let mut cells = 0;
        for stack in &self.columns {
            first.push(cells);
            cells += stack.len() as u32;
            let index = |plane: &Plane, planes: &mut Vec<Plane>| {
                planes.iter().position(|p| p == plane).unwrap_or_else(|| {
                    planes.push(*plane);
                    planes.len() - 1
                }) as u32
            };
            let above = stack.iter().map(|(_, plane)| index(plane, &mut draft.planes));
            let all: Vec<u32> = std::iter::once(0).chain(above.collect::<Vec<_>>()).collect();
            ends.push(all);
        }
        let (wide, deep) = (self.xs.len() - 1, self.ys.len() - 1);
        for (c, stack) in self.columns.iter().enumerate() {
            let (i, j) = (c % wide, c / wide);
            let [x, y] = [[self.xs[i], self.xs[i + 1]].map(steps), [self.ys[j], self.ys[j + 1]].map(steps)];
            let corners = [
                Point::new(x[0], y[0]),
                Point::new(x[1], y[0]),
                Point::new(x[1], y[1]),
                Point::new(x[0], y[1]),
            ];
            let beside = [
                j.checked_sub(1).map(|j| i + j * wide),
                (i + 1 < wide).then_some(c + 1),
                (j + 1 < deep).then_some(c + wide),
                i.checked_sub(1).map(|i| i + j * wide),
            ];
            for (k, (label, _)) in stack.iter().enumerate() {
                let own = [ends[c][k], ends[c][k + 1]];
                let start = draft.sections.len() as u32;
                for side in 0..4 {
                    let edge = [corners[side], corners[(side + 1) % 4]];
                    let faces = draft.faces.len() as u32;
                    match beside[side] {
                        None => {
                            draft.faces.push(Face { top: NONE, cover: Cover { cell: NONE, source: NONE } })
                        }
                        Some(other) => stack_faces(&mut draft, own, &ends[other], first[other], edge),
                    }
                    let faces = faces..draft.faces.len() as u32;
                    draft.sections.push(Section { start: edge[0], faces });
                }
                let mut cover = |cell: Option<u32>| {
                    draft.covers.push(Cover { cell: cell.unwrap_or(NONE), source: NONE });
                    draft.covers.len() as u32 - 1..draft.covers.len() as u32
                };
                let here = first[c] + k as u32;
                let below = cover((k > 0).then(|| here - 1));
                let above = cover((k + 1 < stack.len()).then_some(here + 1));
                let sections = start..start + 4;
                draft.cells.push(Cell {
                    label: *label,
                    floor: own[0],
                    ceiling: own[1],
                    sections,
                    below,
                    above,
                });
            }
        }
        let top = self.columns[0].last().map_or(self.bottom, |(_, plane)| plane.height_f64(0.0, 0.0) / METRE);
        draft.hull = [[self.xs[0], self.ys[0], self.bottom], [self.xs[wide], self.ys[deep], top]]
            .map(|corner| corner.map(steps));
        draft
    }
}

/// The faces over `edge` of the prism between the planes `own`, beside a stack with the planes `ends`.
fn stack_faces(draft: &mut Partition, own: [u32; 2], ends: &[u32], first: u32, edge: [Point; 2]) {
    let height = |plane: u32| -> i64 { edge.iter().map(|&p| draft.planes[plane as usize].height(p)).sum() };
    let [floor, ceiling] = own.map(height);
    let mut faces = Vec::new();
    for k in 0..ends.len() - 1 {
        let (low, high) = (height(ends[k]), height(ends[k + 1]));
        let is_beside = if floor < ceiling {
            low < ceiling && high > floor && low < high
        } else {
            low <= floor && floor < high
        };
        if is_beside {
            let top = if high < ceiling { ends[k + 1] } else { NONE };
            faces.push(Face { top, cover: Cover { cell: first + k as u32, source: NONE } });
        }
    }
    assert_eq!(faces.iter().filter(|f| f.top == NONE).count(), 1);
    draft.faces.extend(faces);
}

/// The triangles of the closed surface of a cell, outward.
pub(super) fn cell_triangles(partition: &Partition, cell: &Cell) -> Vec<[[f64; 3]; 3]> {
    let points: Vec<Point> = partition.footprint(cell).collect();
    let [low, high] = [cell.floor, cell.ceiling].map(|plane| {
        let plane = partition.planes[plane as usize];
        let lift = |p: &Point| {
            let (x, y) = (f64::from(p.x), f64::from(p.y));
            [x, y, plane.height_f64(x, y)]
        };
        points.iter().map(lift).collect::<Vec<_>>()
    });
    let mut all = Vec::new();
    for i in 1..points.len() - 1 {
        all.push([high[0], high[i], high[i + 1]]);
        all.push([low[0], low[i + 1], low[i]]);
    }
    for i in 0..points.len() {
        let next = (i + 1) % points.len();
        all.push([low[i], low[next], high[next]]);
        all.push([low[i], high[next], high[i]]);
    }
    all.retain(|t| {
        let [a, b, c] = t.map(DVec3::from);
        (b - a).cross(c - a).length() > 0.0
    });
    all
}

/// The triangles of all solid cells, each by itself: cells of one element together make its mesh.
pub(super) fn matter_of(partition: &Partition) -> Vec<MatterTriangle> {
    let mut next = std::collections::BTreeMap::new();
    let mut all = Vec::new();
    for cell in &partition.cells {
        let Label::Solid(element) = cell.label else { continue };
        for corners in cell_triangles(partition, cell) {
            let triangle = next.entry(element).or_insert(0u32);
            all.push(MatterTriangle { corners, element, triangle: *triangle });
            *triangle += 1;
        }
    }
    all.sort_by_key(MatterTriangle::name);
    all
}

/// The triangles of a box between two corners, metres, outward.
pub(super) fn box_triangles(low: [f64; 3], high: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let one = Stacks::boxes(&[low[0], high[0]], &[low[1], high[1]], &[low[2], high[2]], |_| solid(0)).build();
    cell_triangles(&one, &one.cells[0])
}

/// Triangles, lattice units, as those of elements in turn.
pub(super) fn as_matter(elements: &[Vec<[[f64; 3]; 3]>]) -> Vec<MatterTriangle> {
    let mut all = Vec::new();
    for (e, triangles) in elements.iter().enumerate() {
        all.extend(triangles.iter().enumerate().map(|(t, &corners)| MatterTriangle {
            corners,
            element: ElementId(e as u32),
            triangle: t as u32,
        }));
    }
    all
}

/// Whether a point lies in a cell or on it, to a thousandth of a lattice unit.
pub(super) fn is_in(partition: &Partition, cell: &Cell, p: DVec3) -> bool {
    let points: Vec<Point> = partition.footprint(cell).collect();
    let is_left = |i: usize| {
        let (a, b) = (points[i], points[(i + 1) % points.len()]);
        let (u, v) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
        (u * (p.y - f64::from(a.y)) - v * (p.x - f64::from(a.x))) / u.hypot(v) >= -1e-3
    };
    let above = |plane: u32| {
        let plane = partition.planes[plane as usize];
        (p.z - plane.height_f64(p.x, p.y)) * up(&plane).z
    };
    (0..points.len()).all(is_left) && above(cell.floor) >= -1e-3 && above(cell.ceiling) <= 1e-3
}

/// Points all over a triangle: its corners, and a grid inside with `count` points along each edge.
pub(super) fn points_on(corners: &[[f64; 3]; 3], count: u32) -> Vec<DVec3> {
    let [a, b, c] = corners.map(DVec3::from);
    let mut all = Vec::new();
    for i in 0..count {
        for j in 0..count - i {
            let at = |n: u32| (f64::from(n) + 1.0 / 3.0) / f64::from(count);
            all.push(a + (b - a) * at(i) + (c - a) * at(j));
        }
    }
    all
}

/// The distance of a point from a triangle.
pub(super) fn distance(corners: &[[f64; 3]; 3], p: DVec3) -> f64 {
    let points = corners.map(DVec3::from);
    let normal = (points[1] - points[0]).cross(points[2] - points[0]).normalize();
    let foot = p - normal * normal.dot(p - points[0]);
    let is_inside =
        (0..3).all(|i| (points[(i + 1) % 3] - points[i]).cross(foot - points[i]).dot(normal) >= 0.0);
    if is_inside {
        return (p - foot).length();
    }
    let to_edge = |i: usize| {
        let (from, along) = (points[i], points[(i + 1) % 3] - points[i]);
        let part = (along.dot(p - from) / along.length_squared()).clamp(0.0, 1.0);
        (p - from - along * part).length()
    };
    (0..3).map(to_edge).fold(f64::INFINITY, f64::min)
}

/// The models of the reader's own folder, with their paths; none if there is no such folder.
pub(crate) fn real_models() -> Vec<(String, enfilade_importers::Model)> {
    let Some(folder) = std::env::var_os("ENFILADE_BUILDINGS") else {
        println!("SKIPPED: ENFILADE_BUILDINGS is not set");
        return Vec::new();
    };
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "glb"));
    paths.sort();
    assert!(!paths.is_empty());
    let read = |path: &std::path::PathBuf| crate::importers::import(path, &Default::default()).unwrap();
    paths.iter().map(|path| (path.display().to_string(), read(path))).collect()
}
