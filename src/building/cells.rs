//! The cells of a building, read off its map.
//!
//! What the scene stores of a cell, its footprint, the stacks of its sides, what covers its floor and its ceiling, is in the
//! map: a cell is the orbit of a dart by alpha 0 to 2; its floor ends where alpha 2 leads to a side, and alpha 0 and 1 lead around
//! it; what lies beyond a face is the volume of alpha 3. This is the inverse of [`sew`](crate::sew::sew), but for parts of sides
//! that have no height, which are no faces.

use super::{Building, Volume};
use crate::gmap::Dart;
use crate::lattice::{Point, orient};
use crate::partition::cells::{Cell, Cover, Face, NONE, Partition, Section};
use crate::sew::Way as Lie;

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
        let reader = Reader::new(self)?;
        let mut partition = Partition {
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
        for volume in 0..self.volumes.len() as u32 {
            let failed = |what| CellsError { volume, what };
            reader.add(volume, &mut partition).map_err(failed)?;
        }
        Ok(partition)
    }
}

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
}

impl<'a> Reader<'a> {
    fn new(building: &'a Building) -> Result<Reader<'a>, CellsError> {
        let map = &building.topology.map;
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
        Ok(Reader { building, volume_of, face_of, starts, sides })
    }

    /// Adds a cell and all that it is made of.
    fn add(&self, number: u32, partition: &mut Partition) -> Result<(), &'static str> {
        let volume = &self.building.volumes[number as usize];
        let own =
            &self.sides[self.starts[number as usize] as usize..self.starts[number as usize + 1] as usize];
        let first_section = partition.sections.len() as u32;
        for edge in self.footprint(volume, own)? {
            let mut before: Vec<Face> = Vec::new();
            for (start, stack) in edge.pieces(self)? {
                // What has the same beyond it is one section.
                if stack != before {
                    let first = partition.faces.len() as u32;
                    partition.faces.extend(&stack);
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
            }
            let range = first..partition.covers.len() as u32;
            if range.is_empty() { Err("it has no floor, or no ceiling") } else { Ok(range) }
        };
        let below = covers(Part::Floor, volume.floor)?;
        let above = covers(Part::Ceiling, volume.ceiling)?;
        partition.cells.push(Cell {
            label: volume.label,
            floor: volume.floor,
            ceiling: volume.ceiling,
            sections,
            below,
            above,
        });
        Ok(())
    }

    /// The edges of the footprint, counter-clockwise, each as long as it is straight: all around the floor.
    fn footprint(&self, volume: &Volume, own: &[Side]) -> Result<Vec<Edge>, &'static str> {
        let walked = self.walk(own)?;
        let at = |dart: Dart| {
            let [x, y, _] =
                self.building.topology.points[self.building.topology.vertex_of[dart.index()] as usize];
            [x, y]
        };
        let points: Vec<[f64; 2]> = walked.iter().map(|&dart| at(dart)).collect();
        let ahead = |i: usize| points[(i + 1) % points.len()];
        let double: f64 = (0..points.len())
            .map(|i| {
                let [a, b] = [points[i], ahead(i)].map(|p| [p[0] - points[0][0], p[1] - points[0][1]]);
                a[0] * b[1] - a[1] * b[0]
            })
            .sum();
        let number = self.volume_of[volume.dart.index()];
        let mut edges: Vec<Edge> = Vec::new();
        for (i, &dart) in walked.iter().enumerate() {
            let (a, b) = if double > 0.0 { (points[i], ahead(i)) } else { (ahead(i), points[i]) };
            let (side, ends) = self.upright_at(dart)?;
            let [run, rise] = [0, 1].map(|axis| b[axis] - a[axis]);
            let along = |ends: [Point; 2]| {
                run * (f64::from(ends[1].x) - f64::from(ends[0].x))
                    + rise * (f64::from(ends[1].y) - f64::from(ends[0].y))
            };
            let (ends, is_first) = if along(ends) > 0.0 { (ends, true) } else { ([ends[1], ends[0]], false) };
            // Where the volume has no height, what is on the right of the side there is beyond it.
            let span = Span { ends, side, is_own: self.volume_of[side.dart.index()] == number };
            if span.is_own && is_first != side.is_first {
                return Err("a side has the volume on its wrong side");
            }
            let span =
                Span { side: if is_first == side.is_first { side } else { self.across(side) }, ..span };
            match edges.last_mut() {
                Some(last) if last.holds(ends) => last.spans.push(span),
                _ => edges.push(Edge { spans: vec![span] }),
            }
        }
        if double < 0.0 {
            edges.reverse();
        }
        if edges.len() > 1 && edges[0].holds(edges[edges.len() - 1].spans[0].ends) {
            let last = edges.pop();
            edges[0].spans.extend(last.into_iter().flat_map(|edge| edge.spans));
        }
        // All that stands over an edge, not only on the floor.
        for side in own {
            if let Lie::Upright(ends) = self.lie(side.face) {
                let ends = if side.is_first { ends } else { [ends[1], ends[0]] };
                let edge =
                    edges.iter_mut().find(|edge| edge.holds(ends)).ok_or("a side stands on no edge")?;
                edge.spans.push(Span { ends, side: *side, is_own: true });
            }
        }
        // Wherever the walk began, a cell begins at the same corner.
        let first = (0..edges.len()).min_by_key(|&i| edges[i].start()).unwrap_or(0);
        edges.rotate_left(first);
        let next = edges.iter().cycle().skip(1);
        let closes = edges.len() > 2 && edges.iter().zip(next).all(|(edge, next)| edge.end() == next.start());
        if closes { Ok(edges) } else { Err("its sides do not close") }
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

    /// The side that stands on an edge of the floor, and over what. Where the volume has no height there, it is the next around the
    /// edge.
    fn upright_at(&self, edge: Dart) -> Result<(Side, [Point; 2]), &'static str> {
        let map = &self.building.topology.map;
        let mut dart = map.alpha(2, edge);
        // An edge has fewer faces than there are darts.
        for _ in 0..map.len() {
            let side = self.side_at(dart);
            if let Lie::Upright(ends) = self.lie(side.face) {
                return Ok((side, ends));
            }
            let across = map.alpha(3, dart);
            if across == dart {
                break;
            }
            dart = map.alpha(2, across);
        }
        Err("an edge of its floor has no side")
    }

    /// The same face from its other side.
    fn across(&self, side: Side) -> Side {
        let dart = self.building.topology.map.alpha(3, side.dart);
        Side { dart, is_first: !side.is_first, ..side }
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
        match self.lie(side.face) {
            Lie::Upright(_) => Part::Side,
            Lie::Ceiling(_) if side.is_first => Part::Ceiling,
            Lie::Ceiling(_) | Lie::Floor(_) => Part::Floor,
        }
    }
}

/// What a face is of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Floor,
    Ceiling,
    Side,
}

/// A straight edge of a footprint, the volume on its left.
#[derive(Clone, Debug)]
struct Edge {
    /// What stands over parts of it; never empty.
    spans: Vec<Span>,
}

/// A side over a part of an edge.
#[derive(Clone, Copy, Debug)]
struct Span {
    ends: [Point; 2],
    /// Seen from the left.
    side: Side,
    /// Whether it is a side of the volume; else one beyond what has no height.
    is_own: bool,
}

impl Edge {
    /// Whether a part of the plan lies on it, the same way.
    fn holds(&self, ends: [Point; 2]) -> bool {
        let [a, b] = self.spans[0].ends;
        orient(a, b, ends[0]) == 0 && orient(a, b, ends[1]) == 0 && self.along(ends[0]) < self.along(ends[1])
    }

    /// How far a point is along it.
    fn along(&self, p: Point) -> i64 {
        let [a, b] = self.spans[0].ends;
        let less = |p: i32, q: i32| i64::from(p) - i64::from(q);
        less(b.x, a.x) * less(p.x, a.x) + less(b.y, a.y) * less(p.y, a.y)
    }

    fn start(&self) -> Point {
        let starts = self.spans.iter().map(|span| span.ends[0]);
        starts.min_by_key(|&p| self.along(p)).unwrap_or_default()
    }

    fn end(&self) -> Point {
        let ends = self.spans.iter().map(|span| span.ends[1]);
        ends.max_by_key(|&p| self.along(p)).unwrap_or_default()
    }

    /// Its parts from its start to its end, each with what lies beyond it from the floor up.
    fn pieces(&self, reader: &Reader<'_>) -> Result<Vec<(Point, Vec<Face>)>, &'static str> {
        let mut points: Vec<Point> = self.spans.iter().flat_map(|span| span.ends).collect();
        points.sort_unstable_by_key(|&p| self.along(p));
        points.dedup();
        points.windows(2).map(|ends| Ok((ends[0], self.stack([ends[0], ends[1]], reader)?))).collect()
    }

    fn stack(&self, ends: [Point; 2], reader: &Reader<'_>) -> Result<Vec<Face>, &'static str> {
        let [from, to] = ends.map(|p| self.along(p));
        let is_over = |span: &&Span| self.along(span.ends[0]) <= from && to <= self.along(span.ends[1]);
        let over: Vec<&Span> = self.spans.iter().filter(is_over).collect();
        let is_own = over.iter().any(|span| span.is_own);
        let mut beyond: Vec<(i128, Cover, u32)> = over
            .iter()
            .filter(|span| span.is_own == is_own)
            .map(|span| {
                let cover = reader.cover(&span.side);
                (reader.middle(cover.cell, ends), cover, span.side.face)
            })
            .collect();
        beyond.sort_by_key(|&(middle, cover, face)| (middle, cover.cell, face));
        // Where planes bend, and where the walk met it, a neighbour comes more than once.
        beyond.dedup_by_key(|(_, cover, _)| cover.cell);
        if !is_own {
            // There is nothing to be seen: whatever lies beyond serves.
            beyond.truncate(1);
        }
        let last = beyond.len().checked_sub(1).ok_or("a part of a side has no face")?;
        let top = |(k, (_, cover, _)): (usize, &(i128, Cover, u32))| {
            let other = reader.building.volumes.get(cover.cell as usize).filter(|_| k < last);
            Face { top: other.map_or(NONE, |other| other.ceiling), cover: *cover }
        };
        Ok(beyond.iter().enumerate().map(top).collect())
    }
}
