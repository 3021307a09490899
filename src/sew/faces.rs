//! What two cells have in common.

use super::Way;
use super::heights::Heights;
use super::overlay::common;
use super::vertices::Vertices;
use crate::lattice::{Point, Site, orient};
use crate::partition::cells::{Cell, NONE, Partition};

/// A part of the side of a cell beyond which there is one other cell over or under others, or the outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub(super) one: u32,
    /// [`NONE`] for the outside of the hull.
    pub(super) other: u32,
    /// In the plan, the first cell on the left.
    pub(super) ends: [Point; 2],
}

/// A face in the making.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    pub(super) one: u32,
    pub(super) other: u32,
    pub(super) way: Way,
    pub(super) corners: Vec<Corner>,
}

/// A corner, and the edge from it to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    /// Over which line of the plan the edge goes, and in which planes; upright edges go over none.
    pub(super) edge: Option<([Point; 2], [u32; 2])>,
}

/// The borders of all cells, each once.
pub(super) fn borders(partition: &Partition) -> Vec<Border> {
    let mut borders = Vec::new();
    let points: Vec<Vec<Point>> =
        partition.cells.iter().map(|cell| partition.footprint(cell).collect()).collect();
    for (one, cell) in partition.cells.iter().enumerate() {
        let own = &points[one];
        for (i, section) in sections(partition, cell).iter().enumerate() {
            let ends = [own[i], own[(i + 1) % own.len()]];
            let faces = &partition.faces[section.faces.start as usize..section.faces.end as usize];
            let mut beyond: Vec<u32> = faces.iter().map(|face| face.cover.cell).collect();
            beyond.sort_unstable();
            beyond.dedup();
            for other in beyond {
                let one = one as u32;
                if other == NONE {
                    borders.push(Border { one, other, ends });
                } else if one < other {
                    let theirs = &points[other as usize];
                    borders.extend((0..theirs.len()).filter_map(|k| {
                        let ends = shared(ends, [theirs[k], theirs[(k + 1) % theirs.len()]])?;
                        Some(Border { one, other, ends })
                    }));
                }
            }
        }
    }
    borders
}

fn sections<'p>(partition: &'p Partition, cell: &Cell) -> &'p [crate::partition::cells::Section] {
    &partition.sections[cell.sections.start as usize..cell.sections.end as usize]
}

/// What two edges have in common that lie on one line and go opposite ways.
fn shared([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<[Point; 2]> {
    if orient(a, b, c) != 0 || orient(a, b, d) != 0 {
        return None;
    }
    let along = |p: Point| {
        let (ux, uy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
        ux * (i64::from(p.x) - i64::from(a.x)) + uy * (i64::from(p.y) - i64::from(a.y))
    };
    if along(c) <= along(d) {
        return None;
    }
    let from = if along(d) > 0 { d } else { a };
    let to = if along(c) < along(b) { c } else { b };
    (along(from) < along(to)).then_some([from, to])
}

/// All faces, upright and level, without the vertices that lie on their edges.
pub(super) fn gather(
    partition: &Partition,
    borders: &[Border],
    heights: &Heights,
    vertices: &mut Vertices<'_>,
) -> Vec<Polygon> {
    let mut faces: Vec<Polygon> =
        borders.iter().filter_map(|border| upright(partition, border, heights, vertices)).collect();
    for (one, cell) in partition.cells.iter().enumerate() {
        let footprint: Vec<Point> = partition.footprint(cell).collect();
        let above = &partition.covers[cell.above.start as usize..cell.above.end as usize];
        for cover in above {
            let theirs: Vec<Point> = match cover.cell {
                NONE => footprint.clone(),
                other => partition.footprint(&partition.cells[other as usize]).collect(),
            };
            faces.extend(level(one as u32, cover.cell, cell.ceiling, &footprint, &theirs, vertices));
        }
        let below = &partition.covers[cell.below.start as usize..cell.below.end as usize];
        if below.iter().any(|cover| cover.cell == NONE) {
            faces.extend(level(one as u32, NONE, cell.floor, &footprint, &footprint, vertices));
        }
    }
    faces
}

/// The common part of the ceiling of a cell and the floor of another, or of the hull.
fn level(
    one: u32,
    other: u32,
    plane: u32,
    footprint: &[Point],
    theirs: &[Point],
    vertices: &mut Vertices<'_>,
) -> Option<Polygon> {
    let corners = common(footprint, theirs)
        .into_iter()
        .map(|corner| Corner {
            vertex: vertices.at(corner.at, &[plane]),
            edge: Some((corner.line, [plane; 2])),
        })
        .collect();
    polygon(one, other, Way::Level(plane), corners)
}

/// The face, if it has three corners.
fn polygon(one: u32, other: u32, way: Way, mut corners: Vec<Corner>) -> Option<Polygon> {
    // An edge whose ends are one vertex is none.
    for i in (0..corners.len()).rev() {
        if corners.len() > 1 && corners[i].vertex == corners[(i + 1) % corners.len()].vertex {
            corners.remove(i);
        }
    }
    (corners.len() > 2).then_some(Polygon { one, other, way, corners })
}

/// A plane over an edge: its number, and its heights over the ends.
#[derive(Clone, Copy, Debug)]
struct Line {
    plane: u32,
    ends: [i128; 2],
}

/// A share of an edge.
#[derive(Clone, Copy, Debug)]
struct Share {
    part: i128,
    whole: i128,
}

impl Share {
    const START: Share = Share { part: 0, whole: 1 };
    const END: Share = Share { part: 1, whole: 1 };

    fn is_before(&self, other: &Share) -> bool {
        // Both below 2^64.
        self.part * other.whole < other.part * self.whole
    }
}

impl Line {
    /// The height at a share, times its `whole`.
    fn at(&self, share: &Share) -> i128 {
        self.ends[0] * share.whole + (self.ends[1] - self.ends[0]) * share.part
    }

    /// Where two lines cross between the ends.
    fn crossing(&self, other: &Line) -> Option<Share> {
        let [start, end] = [0, 1].map(|i| self.ends[i] - other.ends[i]);
        let whole = (start - end).abs();
        ((start > 0 && end < 0) || (start < 0 && end > 0)).then(|| Share { part: start.abs(), whole })
    }
}

/// The common part of two upright sides.
fn upright(
    partition: &Partition,
    border: &Border,
    heights: &Heights,
    vertices: &mut Vertices<'_>,
) -> Option<Polygon> {
    let line = |plane: u32| {
        let height = |end: Site| heights.at(&end, end.height(&partition.planes[plane as usize]));
        Line { plane, ends: border.ends.map(|end| height(end.into())) }
    };
    let cells = [border.one, border.other].into_iter().filter(|&cell| cell != NONE);
    let cells: Vec<&Cell> = cells.map(|cell| &partition.cells[cell as usize]).collect();
    let floors: Vec<Line> = cells.iter().map(|cell| line(cell.floor)).collect();
    let ceilings: Vec<Line> = cells.iter().map(|cell| line(cell.ceiling)).collect();
    // Where all ceilings are over all floors.
    let (mut from, mut to) = (Share::START, Share::END);
    for floor in &floors {
        for ceiling in &ceilings {
            let [start, end] = [0, 1].map(|i| ceiling.ends[i] - floor.ends[i]);
            if start <= 0 && end <= 0 {
                return None;
            }
            if let Some(crossing) = floor.crossing(ceiling) {
                if start > 0 && crossing.is_before(&to) {
                    to = crossing;
                } else if start < 0 && from.is_before(&crossing) {
                    from = crossing;
                }
            }
        }
    }
    if !from.is_before(&to) {
        return None;
    }
    let bends = |lines: &[Line]| {
        let crossing = match lines {
            [a, b] => a.crossing(b),
            _ => None,
        };
        crossing.filter(|share| from.is_before(share) && share.is_before(&to))
    };
    let corner = |lines: &[Line], share: Share, toward: Share, extreme: fn(i128, i128) -> i128| {
        let best = |share: &Share| lines.iter().map(|l| l.at(share)).reduce(extreme);
        let through = |share: &Share| -> Vec<u32> {
            lines.iter().filter(|l| Some(l.at(share)) == best(share)).map(|l| l.plane).collect()
        };
        // The edge towards the next corner: the lines that are extreme in its middle are so at both ends.
        let (here, there) = (through(&share), through(&toward));
        let both: Vec<u32> = here.iter().copied().filter(|plane| there.contains(plane)).collect();
        let planes = [both.first().copied(), both.last().copied()].map(|plane| plane.unwrap_or(NONE));
        (here, planes, share)
    };
    let chain = |bend: Option<Share>, start: Share, end: Share| -> Vec<Share> {
        [Some(start), bend, Some(end)].into_iter().flatten().collect()
    };
    let mut made: Vec<(Vec<u32>, Option<[u32; 2]>, Share)> = Vec::new();
    let low = chain(bends(&floors), from, to);
    for (k, &share) in low.iter().enumerate() {
        let toward = *low.get(k + 1).unwrap_or(&share);
        let (here, planes, share) = corner(&floors, share, toward, i128::max);
        made.push((here, (k + 1 < low.len()).then_some(planes), share));
    }
    let high = chain(bends(&ceilings), to, from);
    for (k, &share) in high.iter().enumerate() {
        let toward = *high.get(k + 1).unwrap_or(&share);
        let (here, planes, share) = corner(&ceilings, share, toward, i128::min);
        made.push((here, (k + 1 < high.len()).then_some(planes), share));
    }
    // Where floor and ceiling meet they are one vertex, which lies on planes of both.
    let [low_end, high_end] = [low.len() - 1, low.len()];
    let last = made.len() - 1;
    let meets = |share: &Share| {
        let floor = floors.iter().map(|l| l.at(share)).max();
        floor == ceilings.iter().map(|l| l.at(share)).min()
    };
    for (a, b, share) in [(low_end, high_end, to), (0, last, from)] {
        if meets(&share) {
            let both = [made[a].0.clone(), made[b].0.clone()].concat();
            (made[a].0, made[b].0) = (both.clone(), both);
        }
    }
    let corners = made
        .into_iter()
        .map(|(planes, edge, share)| Corner {
            vertex: vertices.at(Site::between(border.ends, share.part, share.whole), &planes),
            edge: edge.map(|planes| (border.ends, planes)),
        })
        .collect();
    polygon(border.one, border.other, Way::Upright, corners)
}
