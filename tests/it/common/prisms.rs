//! Random partitions of a box into convex prisms, and models that they are right for: made here from scratch, and
//! sharing nothing with how the program partitions space.

use std::collections::BTreeMap;

use enfilade::importers::{
    ElementId, Frame, Material, MaterialId, Model, ModelBuilder, NewElement, Semantic,
};
use enfilade::lattice::{FINE, Lattice, Plane, Point, orient};
use enfilade::partition::cells::{Cell, Cover, Face, Label, NONE, Partition, Section, Source};

use enfilade_testing::Random;

/// What a random partition is like.
#[derive(Clone, Copy, Debug)]
pub struct Style {
    /// Cuts along x, y and z.
    pub cuts: [usize; 3],
    /// Share of footprints that are cut into triangles.
    pub oblique: f64,
    /// Share of columns with sloped planes.
    pub sloped: f64,
    /// Share of prisms that are matter.
    pub solid: f64,
    /// Joins tried for each prism.
    pub joins: usize,
    /// How far, in lattice steps, the model's corners are from the partition's.
    pub moved: f64,
    /// Furniture triangles.
    pub furniture: usize,
    /// Furniture triangles around the partition's box.
    pub around: usize,
    /// Rounds the corners to multiples of so many steps: few numbers, many ties.
    pub grain: i32,
    /// Upright strips that a side of a solid is made of.
    pub strips: usize,
}

/// A prism of the partition that is being made.
#[derive(Clone, Debug)]
struct Prism {
    footprint: Vec<Point>,
    floor: Plane,
    ceiling: Plane,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Solid,
    Room,
    Void,
    Exterior,
}

/// Half the box, lattice steps.
const HALF: [i32; 3] = [12 << 16, 10 << 16, 6 << 16];

/// A partition and a model that it stands for.
#[derive(Clone)]
pub struct Made {
    pub model: Model,
    pub partition: Partition,
}

/// A random partition and its model.
pub fn make(random: &mut Random, style: &Style) -> Made {
    let footprints = footprints(random, style);
    let columns = heights(random, style, &footprints);
    let mut prisms = Vec::new();
    for (footprint, planes) in footprints.iter().zip(&columns) {
        let outer = footprint.iter().any(|p| p.x.abs() == HALF[0] || p.y.abs() == HALF[1]);
        for (i, w) in planes.windows(2).enumerate() {
            let kind = if outer || i == 0 || i + 2 == planes.len() {
                Kind::Exterior
            } else if random.unit() < style.solid {
                Kind::Solid
            } else if random.below(3) == 0 {
                Kind::Void
            } else {
                Kind::Room
            };
            prisms.push(Prism { footprint: footprint.clone(), floor: w[0], ceiling: w[1], kind });
        }
    }
    join(random, style.joins * prisms.len(), &mut prisms);
    Maker::new(random, style, prisms).finish()
}

/// Places along an axis, from end to end of the box; the first and the last piece lie at its border.
fn places(random: &mut Random, axis: usize, count: usize, grain: i32) -> Vec<i32> {
    let (low, high) = (-HALF[axis], HALF[axis]);
    let margin = 1 << 16;
    let mut places: Vec<i32> = (0..count)
        .map(|_| {
            let at = random.between(f64::from(low + margin), f64::from(high - margin)) as i32;
            at / grain * grain
        })
        .chain([low, low + margin, high - margin, high])
        .collect();
    places.sort_unstable();
    places.dedup();
    places
}

/// Convex polygons that tile the plan: rectangles, some cut into triangles around a point in them, some by a diagonal.
fn footprints(random: &mut Random, style: &Style) -> Vec<Vec<Point>> {
    let xs = places(random, 0, style.cuts[0], style.grain);
    let ys = places(random, 1, style.cuts[1], style.grain);
    let mut all = Vec::new();
    for x in xs.windows(2) {
        for y in ys.windows(2) {
            let corners =
                [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])].map(|(x, y)| Point::new(x, y));
            let [a, b, c, d] = corners;
            if random.unit() >= style.oblique {
                all.push(corners.to_vec());
            } else if random.below(3) == 0 {
                all.extend([vec![a, b, c], vec![a, c, d]]);
            } else {
                let between = |random: &mut Random, lo: i32, hi: i32| {
                    lo + 1 + random.below((hi - lo - 1).max(1) as usize) as i32
                };
                let middle = Point::new(between(random, x[0], x[1]), between(random, y[0], y[1]));
                let fan = (0..4).map(|i| vec![middle, corners[i], corners[(i + 1) % 4]]);
                all.extend(fan.filter(|t| orient(t[0], t[1], t[2]) > 0));
            }
        }
    }
    all
}

/// The part of two opposite edges that is common to two polygons, if it is more than a point.
fn common_edge(one: &[Point], other: &[Point]) -> Option<[Point; 2]> {
    for i in 0..one.len() {
        let (a, b) = (one[i], one[(i + 1) % one.len()]);
        for j in 0..other.len() {
            let (c, d) = (other[(j + 1) % other.len()], other[j]);
            if orient(a, b, c) != 0 || orient(a, b, d) != 0 {
                continue;
            }
            let along = |p: Point| {
                let (ex, ey) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
                ex * i64::from(p.x - a.x) + ey * i64::from(p.y - a.y)
            };
            if along(c) >= along(d) {
                continue;
            }
            let low = if along(c) > 0 { c } else { a };
            let high = if along(d) < along(b) { d } else { b };
            if along(low) < along(high) {
                return Some([low, high]);
            }
        }
    }
    None
}

/// For each footprint the planes that cut its column, from the bottom of the box to its top. No two planes of
/// neighbours cross over their common edge.
fn heights(random: &mut Random, style: &Style, footprints: &[Vec<Point>]) -> Vec<Vec<Plane>> {
    let levels = places(random, 2, style.cuts[2], style.grain);
    let ends = [Plane::level(levels[0]), Plane::level(levels[levels.len() - 1])];
    let inner: Vec<Plane> = levels[1..levels.len() - 1].iter().map(|&z| Plane::level(z)).collect();
    let pool: Vec<Plane> = (0..8)
        .map(|_| {
            let along = [random.between(-0.2, 0.2), random.between(-0.2, 0.2)];
            let z = random.between(-0.5, 0.5) * f64::from(HALF[2]);
            Plane::sloped(along, [0.0, 0.0, z]).unwrap()
        })
        .collect();
    let gap = FINE * 64;
    let mut columns: Vec<Vec<Plane>> = Vec::new();
    for (i, footprint) in footprints.iter().enumerate() {
        let mut planes = Vec::new();
        for attempt in 0..20 {
            let mut chosen: Vec<Plane> = if random.unit() < style.sloped && attempt < 19 {
                let mut some: Vec<Plane> =
                    pool.iter().chain(&inner[..1]).chain(inner.last()).copied().collect();
                some.retain(|_| random.below(3) != 0);
                some
            } else if attempt < 19 {
                // The lowest and the highest always, so that the box's bottom and top stay free.
                let last = inner.len() - 1;
                let kept = |j: usize| j == 0 || j == last || random.below(3) != 0;
                let kept: Vec<bool> = (0..inner.len()).map(kept).collect();
                inner.iter().zip(kept).filter(|(_, kept)| *kept).map(|(p, _)| *p).collect()
            } else {
                Vec::new()
            };
            let low = |plane: &Plane| footprint.iter().map(|&p| plane.height(p)).min().unwrap();
            chosen.sort_by_key(low);
            chosen.insert(0, ends[0]);
            chosen.push(ends[1]);
            let ordered =
                chosen.windows(2).all(|w| footprint.iter().all(|&p| w[0].height(p) + gap < w[1].height(p)));
            let crosses = || {
                (0..i).any(|j| {
                    common_edge(footprint, &footprints[j]).is_some_and(|[a, b]| {
                        chosen.iter().any(|p| {
                            columns[j].iter().any(|q| {
                                let at = |v: Point| (p.height(v) - q.height(v)).signum();
                                at(a) * at(b) < 0
                            })
                        })
                    })
                })
            };
            if ordered && !crosses() {
                planes = chosen;
                break;
            }
        }
        if planes.is_empty() {
            planes = ends.to_vec();
        }
        columns.push(planes);
    }
    columns
}

/// Joins prisms side by side whose union is convex, in a random order.
fn join(random: &mut Random, tries: usize, prisms: &mut Vec<Prism>) {
    for _ in 0..tries {
        let (i, j) = (random.below(prisms.len()), random.below(prisms.len()));
        let (a, b) = (&prisms[i], &prisms[j]);
        if i == j || (a.floor, a.ceiling, a.kind) != (b.floor, b.ceiling, b.kind) {
            continue;
        }
        if let Some(footprint) = union(&a.footprint, &b.footprint) {
            prisms[i].footprint = footprint;
            prisms.swap_remove(j);
        }
    }
}

/// The union of two convex polygons with one edge in common, if it is convex.
fn union(one: &[Point], other: &[Point]) -> Option<Vec<Point>> {
    for i in 0..one.len() {
        let (a, b) = (one[i], one[(i + 1) % one.len()]);
        let Some(j) = (0..other.len()).find(|&j| other[j] == b && other[(j + 1) % other.len()] == a) else {
            continue;
        };
        let rest_of_one = (0..one.len() - 1).map(|k| one[(i + 1 + k) % one.len()]);
        let rest_of_other = (0..other.len() - 1).map(|k| other[(j + 1 + k) % other.len()]);
        let all: Vec<Point> = rest_of_one.chain(rest_of_other).collect();
        let turn = |k: usize| {
            let n = all.len();
            orient(all[(k + n - 1) % n], all[k], all[(k + 1) % n])
        };
        if (0..all.len()).any(|k| turn(k) < 0) {
            return None;
        }
        return Some((0..all.len()).filter(|&k| turn(k) > 0).map(|k| all[k]).collect());
    }
    None
}

struct Maker<'a> {
    random: &'a mut Random,
    style: Style,
    prisms: Vec<Prism>,
    lattice: Lattice,
    seed: u64,
    planes: Vec<Plane>,
    sources: Vec<Source>,
    /// The source of a solid prism's floor (0), ceiling (1), or edge from its corner `i` on (`i + 2`).
    source_of: BTreeMap<(usize, usize), u32>,
    elements: Vec<ElementId>,
}

impl<'a> Maker<'a> {
    fn new(random: &'a mut Random, style: &Style, prisms: Vec<Prism>) -> Maker<'a> {
        let lattice = Lattice { origin: [3.0, -2.0, 5.0], turn: [1.0, 0.0], bits: 16 };
        let seed = random.bits();
        Maker {
            random,
            style: *style,
            prisms,
            lattice,
            seed,
            planes: Vec::new(),
            sources: Vec::new(),
            source_of: BTreeMap::new(),
            elements: Vec::new(),
        }
    }

    /// How far a number is moved in the model: always the same for the same number.
    fn moved(&self, axis: u64, of: i64) -> f64 {
        let hash =
            Random::new(self.seed ^ (of as u64).wrapping_mul(0xD129_42A5_57DF_2B4D) ^ axis << 60).unit();
        (hash - 0.5) * 2.0 * self.style.moved
    }

    /// A corner in the model.
    fn corner(&self, p: Point, plane: &Plane) -> [f64; 3] {
        let key = i64::from(p.x) << 30 ^ i64::from(p.y);
        let z = plane.height(p) as f64 / FINE as f64 + self.moved(2, plane.r ^ plane.p << 7 ^ plane.q << 21);
        self.lattice.metres([f64::from(p.x) + self.moved(0, key), f64::from(p.y) + self.moved(1, key), z])
    }

    fn finish(mut self) -> Made {
        let mut builder = ModelBuilder::new("prisms", Frame::default());
        let material = builder.material(Material::default());
        for i in 0..self.prisms.len() {
            let prism = self.prisms[i].clone();
            let (name, semantic) = match prism.kind {
                Kind::Solid => ("wall", Semantic::Wall),
                Kind::Room => ("room", Semantic::Room),
                Kind::Void | Kind::Exterior => {
                    self.elements.push(ElementId(NONE));
                    continue;
                }
            };
            let element =
                builder.element(NewElement { name: format!("{name} {i}"), ..NewElement::default() }).unwrap();
            builder.semantic(element, semantic);
            self.elements.push(element);
            self.add_mesh(&mut builder, material, element, i, &prism);
        }
        let mut detail = Vec::new();
        let furniture =
            builder.element(NewElement { name: "furniture".into(), ..NewElement::default() }).unwrap();
        builder.semantic(furniture, Semantic::Furniture);
        for i in 0..self.style.furniture + self.style.around + 1 {
            let inside = i < self.style.furniture;
            let size = if inside { 1.0 } else { 6.0 };
            let grow = if inside { 0.95 } else { 1.8 };
            let at = [0, 1, 2].map(|a| self.random.between(-1.0, 1.0) * grow * f64::from(HALF[a] >> 16));
            let corners = [0; 3].map(|_| {
                [0, 1, 2].map(|a| at[a] + self.lattice.origin[a] + self.random.between(-size, size))
            });
            builder.triangle(furniture, corners, material).unwrap();
            detail.push((furniture, i as u32));
        }
        let model = builder.finish().unwrap();
        let partition = self.partition(detail);
        Made { model, partition }
    }

    fn add_mesh(
        &mut self,
        builder: &mut ModelBuilder,
        material: MaterialId,
        element: ElementId,
        index: usize,
        prism: &Prism,
    ) {
        let low: Vec<[f64; 3]> = prism.footprint.iter().map(|&p| self.corner(p, &prism.floor)).collect();
        let high: Vec<[f64; 3]> = prism.footprint.iter().map(|&p| self.corner(p, &prism.ceiling)).collect();
        let n = low.len();
        let strips = self.style.strips;
        let ring = |p: &[[f64; 3]]| -> Vec<[f64; 3]> {
            let along = |k: usize| {
                let (a, b, share) =
                    (p[k / strips], p[(k / strips + 1) % n], (k % strips) as f64 / strips as f64);
                [0, 1, 2].map(|axis| a[axis] + (b[axis] - a[axis]) * share)
            };
            (0..n * strips).map(along).collect()
        };
        let (low, high) = (ring(&low), ring(&high));
        // Around the middle: strips have corners on the edges of the caps.
        let fan = |p: &[[f64; 3]]| -> Vec<[[f64; 3]; 3]> {
            let middle = [0, 1, 2].map(|axis| p.iter().map(|q| q[axis]).sum::<f64>() / p.len() as f64);
            (0..p.len()).map(|i| [middle, p[i], p[(i + 1) % p.len()]]).collect()
        };
        let mut parts = vec![fan(&low).into_iter().map(|[a, b, c]| [a, c, b]).collect(), fan(&high)];
        for i in 0..n {
            let strip = |k: usize| {
                let j = (k + 1) % low.len();
                [[low[k], low[j], high[j]], [low[k], high[j], high[k]]]
            };
            parts.push((i * strips..(i + 1) * strips).flat_map(strip).collect());
        }
        let mut count = 0;
        for (part, triangles) in parts.into_iter().enumerate() {
            let ids: Vec<(ElementId, u32)> =
                (count..count + triangles.len() as u32).map(|t| (element, t)).collect();
            count += triangles.len() as u32;
            for corners in triangles {
                builder.triangle(element, corners, material).unwrap();
            }
            if prism.kind == Kind::Solid {
                self.source_of.insert((index, part), self.sources.len() as u32);
                self.sources.push(Source { triangles: ids, plane: None });
            }
        }
    }

    fn plane(&mut self, plane: Plane) -> u32 {
        let found = self.planes.iter().position(|p| *p == plane);
        found.unwrap_or_else(|| {
            self.planes.push(plane);
            self.planes.len() - 1
        }) as u32
    }

    /// The footprints with all corners of all footprints on their edges; each edge with the corner of the footprint
    /// from which its own edge starts.
    fn refined(&self) -> Vec<Vec<(Point, usize)>> {
        let mut points: Vec<Point> = self.prisms.iter().flat_map(|p| p.footprint.clone()).collect();
        points.sort_unstable();
        points.dedup();
        let refine = |prism: &Prism| {
            let mut all = Vec::new();
            for (i, &a) in prism.footprint.iter().enumerate() {
                let b = prism.footprint[(i + 1) % prism.footprint.len()];
                let along = |p: Point| {
                    i64::from(b.x - a.x) * i64::from(p.x - a.x) + i64::from(b.y - a.y) * i64::from(p.y - a.y)
                };
                let mut on: Vec<Point> = points
                    .iter()
                    .copied()
                    .filter(|&p| orient(a, b, p) == 0 && along(p) >= 0 && along(p) < along(b))
                    .collect();
                on.sort_by_key(|&p| along(p));
                all.extend(on.into_iter().map(|p| (p, i)));
            }
            all
        };
        self.prisms.iter().map(refine).collect()
    }

    fn cover(&self, from: usize, to: usize, part_of_from: usize, part_of_to: usize) -> Cover {
        let (a, b) = (self.prisms[from].kind == Kind::Solid, self.prisms[to].kind == Kind::Solid);
        let source = match (a, b) {
            (true, false) => self.source_of[&(from, part_of_from)],
            (false, true) => self.source_of[&(to, part_of_to)],
            _ => NONE,
        };
        Cover { cell: to as u32, source }
    }

    fn partition(mut self, detail: Vec<(ElementId, u32)>) -> Partition {
        let refined = self.refined();
        let mut edges: BTreeMap<(Point, Point), Vec<(usize, usize)>> = BTreeMap::new();
        for (i, footprint) in refined.iter().enumerate() {
            for (k, &(a, side)) in footprint.iter().enumerate() {
                let b = footprint[(k + 1) % footprint.len()].0;
                edges.entry((a, b)).or_default().push((i, side));
            }
        }
        let (mut cells, mut sections, mut faces, mut covers) = (vec![], vec![], vec![], vec![]);
        for i in 0..self.prisms.len() {
            let prism = self.prisms[i].clone();
            let first_section = sections.len() as u32;
            for (k, &(a, side)) in refined[i].iter().enumerate() {
                let b = refined[i][(k + 1) % refined[i].len()].0;
                let first_face = faces.len() as u32;
                let beyond = edges.get(&(b, a)).cloned().unwrap_or_default();
                self.stack(i, side, [a, b], &beyond, &mut faces);
                sections.push(Section { start: a, faces: first_face..faces.len() as u32 });
            }
            let mut cap = |plane: Plane, up: bool| {
                let first = covers.len() as u32;
                for (j, other) in self.prisms.iter().enumerate() {
                    let meets = if up { other.floor == plane } else { other.ceiling == plane };
                    if meets && overlap(&prism.footprint, &other.footprint) {
                        let parts = if up { (1, 0) } else { (0, 1) };
                        covers.push(self.cover(i, j, parts.0, parts.1));
                    }
                }
                if covers.len() as u32 == first {
                    covers.push(Cover { cell: NONE, source: NONE });
                }
                first..covers.len() as u32
            };
            let (below, above) = (cap(prism.floor, false), cap(prism.ceiling, true));
            let label = match prism.kind {
                Kind::Solid => Label::Solid(self.elements[i]),
                Kind::Room => Label::Air(self.elements[i]),
                Kind::Void => Label::Void,
                Kind::Exterior => Label::Exterior,
            };
            cells.push(Cell {
                label,
                floor: self.plane(prism.floor),
                ceiling: self.plane(prism.ceiling),
                sections: first_section..sections.len() as u32,
                below,
                above,
            });
        }
        Partition {
            lattice: self.lattice,
            hull: [HALF.map(|c| -c), HALF],
            planes: self.planes,
            cells,
            sections,
            faces,
            covers,
            sources: self.sources,
            detail,
        }
    }

    /// The faces of prism `i` over the edge from `a` to `b`, from the floor up.
    fn stack(
        &mut self,
        i: usize,
        side: usize,
        [a, b]: [Point; 2],
        beyond: &[(usize, usize)],
        faces: &mut Vec<Face>,
    ) {
        let prism = self.prisms[i].clone();
        let height = |plane: &Plane| plane.height(a) + plane.height(b);
        let mut parts: Vec<(Plane, Plane, usize, usize)> = beyond
            .iter()
            .filter_map(|&(j, other_side)| {
                let other = &self.prisms[j];
                let low = if height(&other.floor) > height(&prism.floor) { other.floor } else { prism.floor };
                let high = if height(&other.ceiling) < height(&prism.ceiling) {
                    other.ceiling
                } else {
                    prism.ceiling
                };
                (height(&low) < height(&high)).then_some((low, high, j, other_side))
            })
            .collect();
        if parts.is_empty() {
            faces.push(Face { top: NONE, cover: Cover { cell: NONE, source: NONE } });
            return;
        }
        parts.sort_by_key(|(low, ..)| height(low));
        let same = |p: &Plane, q: &Plane| p.height(a) == q.height(a) && p.height(b) == q.height(b);
        assert!(same(&parts[0].0, &prism.floor) && same(&parts[parts.len() - 1].1, &prism.ceiling));
        assert!(parts.windows(2).all(|w| same(&w[0].1, &w[1].0)), "the stack has gaps");
        let last = parts.len() - 1;
        for (k, (_, high, j, other_side)) in parts.into_iter().enumerate() {
            let top = if k == last { NONE } else { self.plane(high) };
            faces.push(Face { top, cover: self.cover(i, j, side + 2, other_side + 2) });
        }
    }
}

/// Whether two convex polygons have more than their borders in common.
fn overlap(one: &[Point], other: &[Point]) -> bool {
    let apart = |p: &[Point], q: &[Point]| {
        (0..p.len()).any(|i| q.iter().all(|&v| orient(p[i], p[(i + 1) % p.len()], v) <= 0))
    };
    !apart(one, other) && !apart(other, one)
}
