//! Columns: over each triangle of a slab's plan, the faces in order of height, and what fills the intervals between them.
//!
//! Which faces lie over a triangle is found by a flood through the plan: crossing a link goes on or off the faces whose
//! chains run along it. No point is tested against any face, so no rounding can say something else on two sides of an
//! edge. What an interval holds follows from the winding of each body along the column.

use std::collections::HashMap;

use super::account::{Account, Full, Meter};
use super::plan::{NONE, Plan};
use super::slabs::SlabFace;
use crate::lattice::{FINE_BITS, Plane};

/// Between two faces over a triangle of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Interval {
    /// Index of the plane below, among [`Columns::planes`].
    pub(super) floor: u32,
    /// Index of the plane above.
    pub(super) ceiling: u32,
    /// Index of the set of bodies that the interval is inside of.
    pub(super) set: u32,
}

/// The stacks over all triangles of a plan.
#[derive(Debug, Default)]
pub(super) struct Columns {
    /// First interval of each triangle's stack; one more at the end.
    pub(super) starts: Vec<u32>,
    /// From the bottom up; never empty for a triangle.
    pub(super) intervals: Vec<Interval>,
    /// Sets of bodies, ascending; the first is empty.
    pub(super) sets: Vec<Vec<u32>>,
    pub(super) planes: Vec<Plane>,
}

/// What the columns are built from.
pub(super) struct Input<'a> {
    pub(super) plan: &'a Plan,
    pub(super) levels: [i32; 2],
    pub(super) faces: &'a [SlabFace],
    /// By link: faces on the left of the link, seen from its lesser point, less those on its right.
    pub(super) toggles: &'a Toggles,
    /// For each body whether the winding number decides.
    pub(super) by_winding: &'a dyn Fn(u32) -> bool,
}

/// Faces that a link leads onto or off, by link.
#[derive(Debug, Default)]
pub(super) struct Toggles {
    starts: Vec<u32>,
    items: Vec<(u32, i32)>,
}

impl Toggles {
    /// From (link, face, times) in any order.
    pub(super) fn new(links: usize, mut entries: Vec<(u32, u32, i32)>) -> Toggles {
        entries.sort_unstable();
        let mut toggles = Toggles { starts: vec![0; links + 1], items: Vec::with_capacity(entries.len()) };
        for run in entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let times: i32 = run.iter().map(|e| e.2).sum();
            if times != 0 {
                toggles.items.push((run[0].1, times));
                toggles.starts[run[0].0 as usize + 1] += 1;
            }
        }
        for i in 1..toggles.starts.len() {
            toggles.starts[i] += toggles.starts[i - 1];
        }
        toggles
    }

    pub(super) fn of(&self, link: u32) -> &[(u32, i32)] {
        &self.items[self.starts[link as usize] as usize..self.starts[link as usize + 1] as usize]
    }
}

impl Columns {
    pub(super) fn stack(&self, triangle: u32) -> &[Interval] {
        &self.intervals[self.range(triangle)]
    }

    pub(super) fn range(&self, triangle: u32) -> std::ops::Range<usize> {
        self.starts[triangle as usize] as usize..self.starts[triangle as usize + 1] as usize
    }
}

/// Builds the columns.
///
/// # Errors
/// If they take more memory than `account` has.
pub(super) fn build(input: &Input<'_>, account: &Account) -> Result<Columns, Full> {
    let covers = flood(input, account)?;
    let mut builder = Builder::new(input);
    // With what later stages make of each.
    let (mut intervals, mut sets) = (Meter::new(account, 128), Meter::new(account, 8));
    let mut in_sets = 0;
    for t in 0..input.plan.triangles.len() {
        let before = builder.columns.sets.len();
        builder.column(t as u32, &covers.faces[covers.ranges[t].0 as usize..covers.ranges[t].1 as usize]);
        in_sets += builder.columns.sets[before..].iter().map(|set| set.len() + 8).sum::<usize>();
        intervals.reach(builder.columns.intervals.len())?;
        sets.reach(in_sets)?;
    }
    Ok(builder.columns)
}

/// Which faces lie over each triangle, and how often.
struct Covers {
    ranges: Vec<(u32, u32)>,
    faces: Vec<(u32, i32)>,
}

fn flood(input: &Input<'_>, account: &Account) -> Result<Covers, Full> {
    let plan = input.plan;
    let mut covers = Covers { ranges: vec![(NONE, NONE); plan.triangles.len()], faces: Vec::new() };
    // No body reaches the hull: over a triangle at its side lies nothing.
    let Some(first) = plan.across.iter().position(|across| across.contains(&NONE)) else { return Ok(covers) };
    covers.ranges[first] = (0, 0);
    let mut waiting = vec![first as u32];
    let mut meter = Meter::new(account, size_of::<(u32, i32)>());
    let mut state: Vec<(u32, i32)> = Vec::new();
    while let Some(t) = waiting.pop() {
        for i in 0..3 {
            let other = plan.across[t as usize][i];
            if other == NONE || covers.ranges[other as usize].0 != NONE {
                continue;
            }
            let link = plan.links[t as usize][i];
            let (start, end) = covers.ranges[t as usize];
            if link == NONE || input.toggles.of(link).is_empty() {
                // The same faces: the same place in the list.
                covers.ranges[other as usize] = (start, end);
            } else {
                let corners = plan.triangles[t as usize];
                // The triangle lies on the left of its edges. Leaving the left side of a link from its lesser point ...
                let leaves_left = corners[i] < corners[(i + 1) % 3];
                state.clear();
                state.extend_from_slice(&covers.faces[start as usize..end as usize]);
                for &(face, times) in input.toggles.of(link) {
                    let change = if leaves_left { -times } else { times };
                    match state.binary_search_by_key(&face, |entry| entry.0) {
                        Ok(place) => {
                            state[place].1 += change;
                            if state[place].1 == 0 {
                                state.remove(place);
                            }
                        }
                        Err(place) => state.insert(place, (face, change)),
                    }
                }
                let start = covers.faces.len() as u32;
                meter.reach(covers.faces.len() + state.len())?;
                // An index counts no more.
                u32::try_from(covers.faces.len() + state.len()).map_err(|_| Full)?;
                covers.faces.extend_from_slice(&state);
                covers.ranges[other as usize] = (start, covers.faces.len() as u32);
            }
            waiting.push(other);
        }
    }
    Ok(covers)
}

struct Builder<'a> {
    input: &'a Input<'a>,
    columns: Columns,
    set_index: HashMap<Vec<u32>, u32>,
    plane_index: HashMap<Plane, u32>,
    /// Height (sum over the corners), face, times.
    sorted: Vec<(i128, u32, i32)>,
    /// Bodies and their winding so far.
    winding: Vec<(u32, i32)>,
}

impl<'a> Builder<'a> {
    fn new(input: &'a Input<'a>) -> Builder<'a> {
        let mut builder = Builder {
            input,
            columns: Columns { starts: vec![0], sets: vec![Vec::new()], ..Columns::default() },
            set_index: HashMap::from([(Vec::new(), 0)]),
            plane_index: HashMap::new(),
            sorted: Vec::new(),
            winding: Vec::new(),
        };
        // The slab's own levels are the first planes.
        for z in input.levels {
            builder.plane(Plane::level(z));
        }
        builder
    }

    fn plane(&mut self, plane: Plane) -> u32 {
        let next = self.columns.planes.len() as u32;
        let index = *self.plane_index.entry(plane).or_insert(next);
        if index == next {
            self.columns.planes.push(plane);
        }
        index
    }

    fn column(&mut self, triangle: u32, faces: &[(u32, i32)]) {
        let corners = self.input.plan.corners(triangle);
        let [bottom, top] = self.input.levels.map(|z| 3 * (i128::from(z) << FINE_BITS));
        // Heights closer than a lattice unit are one.
        let unit = 3i128 << FINE_BITS;
        self.sorted.clear();
        for &(face, times) in faces {
            let plane = &self.input.faces[face as usize].plane;
            let height: i128 = corners.iter().map(|&c| i128::from(plane.height(c))).sum();
            self.sorted.push((height.clamp(bottom, top), face, times));
        }
        self.sorted.sort_unstable();
        self.winding.clear();
        let count = self.sorted.len();
        let mut next = self.sorted.iter().take_while(|f| f.0 < bottom + unit).count();
        self.pass(0..next);
        let mut floor = 0;
        while next < count && self.sorted[next].0 <= top - unit {
            let group = self.sorted[next].0;
            let start = next;
            next += self.sorted[start..].iter().take_while(|f| f.0 < group + unit).count();
            let planes = self.sorted[start..next].iter().map(|f| self.input.faces[f.1 as usize].plane);
            let Some(plane) = planes.min_by_key(|p| (!p.is_level(), *p)) else { break };
            let ceiling = self.plane(plane);
            let set = self.inside();
            self.columns.intervals.push(Interval { floor, ceiling, set });
            floor = ceiling;
            self.pass(start..next);
        }
        let set = self.inside();
        self.columns.intervals.push(Interval { floor, ceiling: 1, set });
        self.columns.starts.push(self.columns.intervals.len() as u32);
    }

    /// Goes up through the faces of one height.
    fn pass(&mut self, group: std::ops::Range<usize>) {
        for &(_, face, times) in &self.sorted[group] {
            let body = self.input.faces[face as usize].body;
            // Going up through a face that looks up leaves the body.
            match self.winding.binary_search_by_key(&body, |entry| entry.0) {
                Ok(place) => self.winding[place].1 -= times,
                Err(place) => self.winding.insert(place, (body, -times)),
            }
        }
    }

    /// The set of bodies that the column is inside of here.
    fn inside(&mut self) -> u32 {
        let by_winding = self.input.by_winding;
        let inside = |&(body, times): &(u32, i32)| {
            let is_inside = if by_winding(body) { times != 0 } else { times % 2 != 0 };
            is_inside.then_some(body)
        };
        let set: Vec<u32> = self.winding.iter().filter_map(inside).collect();
        let next = self.columns.sets.len() as u32;
        match self.set_index.get(&set) {
            Some(&index) => index,
            None => {
                self.columns.sets.push(set.clone());
                self.set_index.insert(set, next);
                next
            }
        }
    }
}
