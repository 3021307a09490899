//! The cells of a building, read off its map.
//!
//! What the scene stores of a cell, its footprint, the stacks of its sides, what covers its floor and its ceiling, is in the
//! map: a cell is the orbit of a dart by alpha 0 to 2; its floor ends where alpha 2 leads to a side, and alpha 0 and 1 lead around
//! it; what lies beyond a face is the volume of alpha 3. This is the inverse of [`sew`](crate::sew::sew), but for parts of sides
//! that have no height, which are no faces.

use std::cell::Cell;
use std::collections::HashMap;

use super::{Building, FaceKind, Volume};
use crate::gmap::Dart;
use crate::lattice::{Point, gcd, orient};
use crate::partition::cells::{Cell as Prism, Cover, Face, NONE, Partition, Section};
use crate::sew::{Part, Way as Lie};

/// The map of a building does not have the form of cells.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("volume {volume}: {what}")]
pub struct CellsError {
    /// The volume.
    pub volume: u32,
    /// What is not there, or not alone.
    pub what: &'static str,
}

impl Building {
    /// The cells of the map: a partition that sews to the same map.
    ///
    /// # Errors
    /// [`CellsError`]: the map is not one of convex prisms. None that [`Building::new`] made is refused.
    pub fn cells(&self) -> Result<Partition, CellsError> {
        self.named_cells().map(|cells| cells.partition)
    }

    /// The same, with the kind of each part of their surfaces.
    pub(crate) fn named_cells(&self) -> Result<NamedCells, CellsError> {
        let reader = Reader::new(self)?;
        let partition = Partition {
            lattice: self.lattice,
            hull: self.hull,
            planes: self.planes.clone(),
            cells: Vec::with_capacity(self.volumes.len()),
            sections: Vec::new(),
            faces: Vec::new(),
            covers: Vec::new(),
            sources: self.sources.clone(),
            detail: self.detail.clone(),
        };
        let mut cells = NamedCells { partition, faces: Vec::new(), covers: Vec::new() };
        for volume in 0..self.volumes.len() as u32 {
            let failed = |what| CellsError { volume, what };
            reader.add(volume, &mut cells).map_err(failed)?;
        }
        Ok(cells)
    }
}

/// Cells, and what the parts of their surfaces are called.
#[derive(Clone, Debug)]
pub(crate) struct NamedCells {
    pub(crate) partition: Partition,
    /// By face of the partition.
    pub(crate) faces: Vec<FaceKind>,
    /// By cover.
    pub(crate) covers: Vec<FaceKind>,
}

/// A part of a section, and what it is called.
type Named = (Face, FaceKind);

/// A side of a face that a volume has.
#[derive(Clone, Copy, Debug)]
struct Side {
    face: u32,
    /// A dart of it in the volume.
    dart: Dart,
    /// Whether that is the face's first side.
    is_first: bool,
}

/// No volume, no face.
const UNSEEN: u32 = u32::MAX;

struct Reader<'a> {
    building: &'a Building,
    /// By dart: the volume that its orbit is.
    volume_of: Vec<u32>,
    /// By dart: the face that its orbit is.
    face_of: Vec<u32>,
    /// By volume: where its sides start in `sides`.
    starts: Vec<u32>,
    sides: Vec<Side>,
    /// How much work is left that may grow faster than the map.
    left: Cell<u64>,
}

/// Spans of an edge that are looked at for each dart of the map, and on top: real buildings have less than one.
const WORK: [u64; 2] = [256, 1 << 22];

impl<'a> Reader<'a> {
    fn spend(&self, work: u64) -> Result<(), &'static str> {
        let left = self.left.get().checked_sub(work).ok_or("its sides have too many parts")?;
        self.left.set(left);
        Ok(())
    }

    fn new(building: &'a Building) -> Result<Reader<'a>, CellsError> {
        let map = &building.topology.map;
        if building.faces.len() != building.topology.faces.len() {
            return Err(CellsError { volume: 0, what: "not all faces have names" });
        }
        let at = |dart: Dart| building.topology.cell_of.get(dart.index()).copied().unwrap_or(UNSEEN);
        if let Some(defect) = map.defects().next() {
            return Err(CellsError { volume: at(defect.dart()), what: "its alphas do not fit each other" });
        }
        if let Some(dart) = (0..3).find_map(|i| map.free(i).next()) {
            return Err(CellsError { volume: at(dart), what: "it is open" });
        }
        let mut volume_of = vec![UNSEEN; map.table_len()];
        let mut waiting = Vec::new();
        for (volume, number) in building.volumes.iter().zip(0..) {
            waiting.push(volume.dart);
            while let Some(dart) = waiting.pop() {
                match volume_of[dart.index()] {
                    UNSEEN => volume_of[dart.index()] = number,
                    known if known == number => continue,
                    _ => return Err(CellsError { volume: number, what: "it is one with another volume" }),
                }
                waiting.extend([0, 1, 2].map(|i| map.alpha(i, dart)));
            }
        }
        let mut face_of = vec![UNSEEN; map.table_len()];
        let mut sides = Vec::with_capacity(2 * building.topology.faces.len());
        for (face, number) in building.topology.faces.iter().zip(0..) {
            let beyond = map.alpha(3, face.dart);
            let both = [(face.dart, true), (beyond, false)];
            for (dart, is_first) in both.into_iter().take(if beyond == face.dart { 1 } else { 2 }) {
                let volume = volume_of[dart.index()];
                let failed = |what| CellsError { volume, what };
                for start in map.around_face(dart) {
                    for dart in [start, map.alpha(0, start)] {
                        if std::mem::replace(&mut face_of[dart.index()], number) != UNSEEN {
                            return Err(failed("two of its faces are one"));
                        }
                        if volume_of[dart.index()] != volume {
                            return Err(failed("a face is of two volumes"));
                        }
                    }
                }
                if volume == UNSEEN {
                    return Err(failed("a face is of no volume"));
                }
                sides.push((volume, Side { face: number, dart, is_first }));
            }
        }
        let is_whole = map.darts().all(|dart| face_of[dart.index()] != UNSEEN);
        if !is_whole {
            return Err(CellsError { volume: 0, what: "there are darts of no face" });
        }
        // In the order of volumes, and of faces within each.
        sides.sort_by_key(|(volume, _)| *volume);
        let mut starts = vec![0; building.volumes.len() + 1];
        sides.iter().for_each(|(volume, _)| starts[*volume as usize + 1] += 1);
        for volume in 0..building.volumes.len() {
            starts[volume + 1] += starts[volume];
        }
        let sides = sides.into_iter().map(|(_, side)| side).collect();
        let left = Cell::new(WORK[0] * map.len() as u64 + WORK[1]);
        Ok(Reader { building, volume_of, face_of, starts, sides, left })
    }

    /// Adds a cell and all that it is made of.
    fn add(&self, number: u32, cells: &mut NamedCells) -> Result<(), &'static str> {
        let partition = &mut cells.partition;
        let volume = &self.building.volumes[number as usize];
        let own =
            &self.sides[self.starts[number as usize] as usize..self.starts[number as usize + 1] as usize];
        let first_section = partition.sections.len() as u32;
        for edge in self.footprint(volume, own)? {
            let mut before: Vec<Named> = Vec::new();
            for (start, stack) in edge.pieces(self)? {
                // What has the same beyond it is one section.
                if stack != before {
                    let first = partition.faces.len() as u32;
                    partition.faces.extend(stack.iter().map(|named| named.0));
                    cells.faces.extend(stack.iter().map(|named| named.1));
                    let faces = first..partition.faces.len() as u32;
                    partition.sections.push(Section { start, faces });
                    before = stack;
                }
            }
        }
        let sections = first_section..partition.sections.len() as u32;
        let mut covers = |part: Part, plane: u32| {
            let first = partition.covers.len() as u32;
            for side in own.iter().filter(|side| self.part(side) == part) {
                let (Lie::Ceiling(lies) | Lie::Floor(lies)) = self.lie(side.face) else { continue };
                if lies != plane {
                    return Err("a floor or ceiling lies in two planes");
                }
                partition.covers.push(self.cover(side));
                cells.covers.push(self.building.faces[side.face as usize].kind);
            }
            let range = first..partition.covers.len() as u32;
            if range.is_empty() { Err("it has no floor, or no ceiling") } else { Ok(range) }
        };
        let below = covers(Part::Floor, volume.floor)?;
        let above = covers(Part::Ceiling, volume.ceiling)?;
        partition.cells.push(Prism {
            label: volume.label,
            floor: volume.floor,
            ceiling: volume.ceiling,
            sections,
            below,
            above,
        });
        Ok(())
    }

    /// The edges of the footprint, counter-clockwise, with all that stands over them.
    fn footprint(&self, volume: &Volume, own: &[Side]) -> Result<Vec<Edge>, &'static str> {
        let corners =
            &self.building.footprints[volume.footprint.start as usize..volume.footprint.end as usize];
        let ahead = |i: usize| (i + 1) % corners.len();
        let mut edges: Vec<Edge> =
            (0..corners.len()).map(|i| Edge::new([corners[i], corners[ahead(i)]])).collect();
        // The walk comes by all corners, one after the other; it may go either way around.
        let mut walked = self.walk(own)?;
        let places: HashMap<[u64; 2], usize> = corners
            .iter()
            .zip(0..)
            .map(|(p, i)| ([f64::from(p.x), f64::from(p.y)].map(f64::to_bits), i))
            .collect();
        let corner = |dart: Dart| {
            let topology = &self.building.topology;
            let [x, y, _] = topology.points[topology.vertex_of[dart.index()] as usize];
            // Not -0.
            places.get(&[x + 0.0, y + 0.0].map(f64::to_bits)).copied()
        };
        let start = walked.iter().position(|&dart| corner(dart) == Some(0)).ok_or("it misses a corner")?;
        walked.rotate_left(start);
        let mut passed: Vec<usize> = walked.iter().filter_map(|&dart| corner(dart)).collect();
        let is_forward = passed.get(1) == Some(&1);
        if !is_forward {
            passed[1..].reverse();
        }
        if !passed.iter().copied().eq(0..corners.len()) {
            return Err("its floor does not come by its corners in turn");
        }
        let map = &self.building.topology.map;
        let mut at = if is_forward { corners.len() - 1 } else { 0 };
        for &dart in &walked {
            if corner(dart).is_some() {
                at = if is_forward { ahead(at) } else { (at + corners.len() - 1) % corners.len() };
            }
            let over = self.side_at(map.alpha(2, dart));
            if self.part(&over) == Part::Ceiling {
                let middle = [0, 1].map(|k| {
                    let end = if k == 0 { dart } else { map.alpha(0, dart) };
                    self.building.topology.points[self.building.topology.vertex_of[end.index()] as usize]
                });
                edges[at].closed.push(([0, 1].map(|axis| (middle[0][axis] + middle[1][axis]) / 2.0), over));
            }
        }
        // No two edges of a convex polygon go the same way.
        let by_way: HashMap<[i64; 2], usize> =
            edges.iter().zip(0..).map(|(edge, i)| (lowest_terms(edge.ends), i)).collect();
        for side in own {
            if let Lie::Upright(ends) = self.lie(side.face) {
                let ends = if side.is_first { ends } else { [ends[1], ends[0]] };
                let edge = by_way.get(&lowest_terms(ends)).map(|&i| &mut edges[i]);
                let edge = edge.filter(|edge| edge.holds(ends)).ok_or("a side stands on no edge")?;
                edge.spans.push((ends, *side));
            }
        }
        Ok(edges)
    }

    /// The edges of the floor's border in turn, each as the dart at its start in the floor.
    fn walk(&self, own: &[Side]) -> Result<Vec<Dart>, &'static str> {
        let map = &self.building.topology.map;
        let is_floor = |dart: Dart| self.part(&self.side_at(dart)) == Part::Floor;
        let floors = own.iter().filter(|side| self.part(side) == Part::Floor);
        let mut starts = floors.flat_map(|side| map.around_face(side.dart));
        let first = starts.find(|&start| !is_floor(map.alpha(2, start))).ok_or("its floor has no border")?;
        let most = own.iter().map(|side| map.around_face(side.dart).count()).sum::<usize>();
        let (mut walked, mut here, mut turns) = (Vec::new(), first, 0);
        loop {
            walked.push(here);
            here = map.alpha(1, map.alpha(0, here));
            while is_floor(map.alpha(2, here)) {
                here = map.alpha(1, map.alpha(2, here));
                turns += 1;
                if turns > most {
                    return Err("its floor does not end");
                }
            }
            if here == first {
                return Ok(walked);
            }
            if walked.len() > most {
                return Err("its floor has no one border");
            }
        }
    }

    /// Twice the height of the middle of a volume over an edge, times as much for all.
    fn middle(&self, volume: u32, ends: [Point; 2]) -> i128 {
        let Some(volume) = self.building.volumes.get(volume as usize) else { return 0 };
        let planes = [volume.floor, volume.ceiling].map(|plane| &self.building.planes[plane as usize]);
        planes.iter().flat_map(|plane| ends.map(|end| i128::from(plane.height(end)))).sum()
    }

    /// What a volume has beyond a side.
    fn cover(&self, side: &Side) -> Cover {
        let sources = self.building.topology.faces[side.face as usize].sources;
        Cover { cell: self.beyond(side.dart), source: sources[if side.is_first { 0 } else { 1 }] }
    }

    /// The volume beyond a face.
    fn beyond(&self, dart: Dart) -> u32 {
        let map = &self.building.topology.map;
        if map.is_free(3, dart) { NONE } else { self.volume_of[map.alpha(3, dart).index()] }
    }

    fn lie(&self, face: u32) -> Lie {
        self.building.topology.faces[face as usize].way
    }

    /// The side of a face that a dart is of.
    fn side_at(&self, dart: Dart) -> Side {
        let face = self.face_of[dart.index()];
        let first = self.building.topology.faces[face as usize].dart;
        let is_first = self.volume_of[first.index()] == self.volume_of[dart.index()];
        Side { face, dart, is_first }
    }

    fn part(&self, side: &Side) -> Part {
        self.lie(side.face).part(side.is_first)
    }
}

/// From one point to another, in lowest terms.
fn lowest_terms([a, b]: [Point; 2]) -> [i64; 2] {
    let way = [i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y)];
    let common = gcd(u128::from(way[0].unsigned_abs()), u128::from(way[1].unsigned_abs())) as i64;
    way.map(|c| c / common.max(1))
}

/// An edge of a footprint, the volume on its left.
#[derive(Clone, Debug)]
struct Edge {
    ends: [Point; 2],
    /// What stands over parts of it.
    spans: Vec<([Point; 2], Side)>,
    /// Where the floor meets the ceiling: in the middle of each part, and the ceiling there.
    closed: Vec<([f64; 2], Side)>,
}

impl Edge {
    fn new(ends: [Point; 2]) -> Edge {
        Edge { ends, spans: Vec::new(), closed: Vec::new() }
    }

    /// Whether something lies on it, the same way.
    fn holds(&self, ends: [Point; 2]) -> bool {
        let [a, b] = self.ends;
        let [from, to] = ends.map(|p| self.along(p));
        orient(a, b, ends[0]) == 0
            && orient(a, b, ends[1]) == 0
            && 0 <= from
            && from < to
            && to <= self.along(b)
    }

    /// How far a point is along it.
    fn along(&self, p: Point) -> i64 {
        let [a, b] = self.ends;
        let less = |p: i32, q: i32| i64::from(p) - i64::from(q);
        less(b.x, a.x) * less(p.x, a.x) + less(b.y, a.y) * less(p.y, a.y)
    }

    /// Its parts from its start to its end, each with what lies beyond it from the floor up.
    fn pieces(&self, reader: &Reader<'_>) -> Result<Vec<(Point, Vec<Named>)>, &'static str> {
        // Every span is looked at for every piece: a map that somebody made up must not take for ever.
        reader.spend((self.spans.len() as u64 + 1).pow(2))?;
        let mut points: Vec<Point> = self.spans.iter().flat_map(|span| span.0).chain(self.ends).collect();
        points.sort_unstable_by_key(|&p| self.along(p));
        points.dedup();
        points.windows(2).map(|ends| Ok((ends[0], self.stack([ends[0], ends[1]], reader)?))).collect()
    }

    fn stack(&self, ends: [Point; 2], reader: &Reader<'_>) -> Result<Vec<Named>, &'static str> {
        let [from, to] = ends.map(|p| self.along(p));
        let over = self.spans.iter().filter(|(of, _)| self.along(of[0]) <= from && to <= self.along(of[1]));
        let mut beyond: Vec<(i128, Cover, u32)> = over
            .map(|(_, side)| {
                let cover = reader.cover(side);
                (reader.middle(cover.cell, ends), cover, side.face)
            })
            .collect();
        beyond.sort_by_key(|&(middle, cover, face)| (middle, cover.cell, face));
        // Where planes bend, a neighbour has several faces.
        beyond.dedup_by_key(|(_, cover, _)| cover.cell);
        let Some(last) = beyond.len().checked_sub(1) else { return Ok(vec![self.nothing(ends, reader)?]) };
        let top = |(k, (_, cover, face)): (usize, &(i128, Cover, u32))| {
            let other = reader.building.volumes.get(cover.cell as usize).filter(|_| k < last);
            let kind = reader.building.faces[*face as usize].kind;
            (Face { top: other.map_or(NONE, |other| other.ceiling), cover: *cover }, kind)
        };
        Ok(beyond.iter().enumerate().map(top).collect())
    }

    /// What is beyond a part over which the volume has no height: what is above it. Nothing can be seen there.
    fn nothing(&self, ends: [Point; 2], reader: &Reader<'_>) -> Result<Named, &'static str> {
        let middle = [ends[0].x + ends[1].x, ends[0].y + ends[1].y].map(|c| f64::from(c) / 2.0);
        let off = |at: &[f64; 2]| (at[0] - middle[0]).hypot(at[1] - middle[1]);
        let nearest = self.closed.iter().min_by(|a, b| off(&a.0).total_cmp(&off(&b.0)));
        let (_, ceiling) = nearest.ok_or("a part of a side has no face")?;
        let kind = reader.building.faces[ceiling.face as usize].kind;
        Ok((Face { top: NONE, cover: Cover { cell: reader.beyond(ceiling.dart), source: NONE } }, kind))
    }
}
