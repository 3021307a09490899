//! Many rays of one origin, at once: told by the four corners of a pyramid that holds them, as the paper's packets are (section 5.1).
//!
//! A prism's faces are convex. If the corners of a pyramid leave a prism through one face, so do all rays within, and they are no nearer
//! to its border. Whatever the way out has of doubt is least or greatest at a corner: the sides of the line that corners of the footprint are on
//! are linear in the direction, the margins they have to keep grow no faster (they are norms of it); the blur of heights and of places in level
//! planes is such a norm by a linear function, and nowhere greater than the greatest at a corner. So where the corners are in no doubt, nor is
//! any ray. Where these part, the rays are halved; eight go on by themselves.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3};

use super::answers::{Answers, Group, Pool};
use super::eight::Eight;
use super::lines::Lines;
use super::pyramid::Pyramid;
use super::{ALL, BLOCK, COARSEST};
use crate::format::Views;
use crate::format::records::LANES;
use crate::trace::entries::Entries;
use crate::trace::kernel::Ask;
use crate::trace::lanes::{Lanes, Wide};
use crate::trace::quick;
use crate::trace::ray::Ray;
use crate::trace::step::Step;

/// Packets that are looked at together at most.
const MOST: usize = BLOCK / LANES;

/// Fewer packets are looked at one by one.
const FEWEST: usize = 2;

/// The cosine of the angle between a ray and the axis of its bundle is no less.
const NARROW: f32 = 0.75;

/// The square of a ray's length in the plan is no less.
const STEEPEST: f32 = (1.03 * quick::STEEPEST * quick::STEEPEST) as f32;

/// The corners are so much farther out than the rays, for what f32 makes of these.
const WIDER: f32 = 4e-6;

/// What is the same of all rays of a bundle, and where each of them is in the picture plane at right angles to the axis.
pub(super) struct Bundle<L> {
    /// The axis, and two directions at right angles to it.
    pub(super) axes: [Vec3; 3],
    /// Where the rays of each packet are along the second and the third.
    places: [[L; 2]; MOST],
    /// No ray ends before.
    limit: f32,
    /// How far apart the rays' origin and the scene's center are.
    pub(super) local: Vec3,
    /// That origin along the lattice's axes.
    from: [L; 3],
}

/// Some of a bundle's packets, under way from a cell.
#[derive(Clone, Copy)]
pub(super) struct Part {
    first: u8,
    count: u8,
    pub(super) starts: bool,
    pub(super) cell: u32,
}

/// Where what becomes of packets is noted.
struct Notes<'a> {
    ask: Ask,
    answers: &'a mut Answers,
    /// The cells in which rays are that are left to others, and which of those did not start there.
    cells: &'a mut [u32],
    moved: u64,
    /// Nothing is put there.
    next: Pool,
}

impl Notes<'_> {
    /// A packet of a part.
    #[inline(always)]
    fn of(&mut self, packet: usize, part: &Part) -> Group<'_> {
        let mut numbers = [0; LANES];
        for (number, to) in (packet * LANES..).zip(&mut numbers) {
            *to = number as u8;
        }
        Group {
            ask: self.ask,
            starts: part.starts,
            numbers,
            cells: [part.cell; LANES],
            answers: self.answers,
            next: &mut self.next,
            again: None,
        }
    }

    /// Leaves packets to others.
    #[inline(always)]
    fn leave(&mut self, packets: std::ops::Range<usize>, part: &Part) {
        if part.starts {
            return;
        }
        for number in packets.start * LANES..packets.end * LANES {
            if let Some(cell) = self.cells.get_mut(number) {
                *cell = part.cell;
                self.moved |= 1 << (number % BLOCK);
            }
        }
    }
}

/// Takes rays of one origin that go similar ways from their cell through prisms, as many as possible at once, and notes what they meet. Of those that
/// have no answer then the cells are those in which they are; tells which did not start there.
#[inline(always)]
pub(in crate::trace) fn bundle<L: Entries>(
    ask: Ask,
    tables: &Views,
    rays: &[Ray],
    cells: &mut [u32],
    answers: &mut Answers,
) -> u64 {
    let count = rays.len().min(cells.len()).min(BLOCK);
    let (Some(one), Some(&cell)) = (rays.first(), cells.first()) else { return 0 };
    let last = count - 1;
    if last < LANES || cell as usize >= tables.steps.len() || one.origin != rays[last].origin {
        return 0;
    }
    if tables.scene[0].lattice_bits < COARSEST || cells[..count].iter().any(|&other| other != cell) {
        return 0;
    }
    let mut packets = ArrayVec::<Eight<'_, L>, MOST>::new();
    for first in (0..count).step_by(LANES) {
        let mut own = [one; LANES];
        for (lane, own) in own.iter_mut().enumerate() {
            // What is left of the last packet are copies of the last ray.
            *own = &rays[(first + lane).min(last)];
        }
        packets.push(Eight::new(tables, own));
    }
    let Some(bundle) = Bundle::new(&packets) else { return 0 };
    let few = count % LANES;
    if few != 0
        && let Some(last) = packets.last_mut()
    {
        last.under_way &= ALL >> (LANES - few);
    }
    let mut notes = Notes { ask, answers, cells, moved: 0, next: Pool::NONE };
    bundle.run(tables, &mut packets, cell, &mut notes);
    notes.moved
}

/// The least and the greatest.
#[inline(always)]
fn range(of: [f32; LANES]) -> [f32; 2] {
    [folded(of, |a, b| if a < b { a } else { b }), folded(of, |a, b| if a > b { a } else { b })]
}

/// Halves by halves: one after the other each would wait for the one before. Comparing is one instruction, which `f32::min` is not.
#[inline(always)]
fn folded(of: [f32; LANES], pick: impl Fn(f32, f32) -> f32) -> f32 {
    let [a, b, c, d, e, f, g, h] = of;
    let [a, b, c, d] = [pick(a, e), pick(b, f), pick(c, g), pick(d, h)];
    pick(pick(a, c), pick(b, d))
}

#[inline(always)]
pub(super) fn most<L: Lanes>(of: L) -> f32 {
    range(of.store())[1]
}

impl<L: Entries> Bundle<L> {
    /// Of packets whose rays all are under way, from one origin, in directions that are not too far apart.
    #[inline(always)]
    fn new(packets: &[Eight<'_, L>]) -> Option<Self> {
        let (lead, last) = (packets.first()?, packets.last()?);
        // No `map`: it has lanes in its closure.
        let (mut origin, mut from, mut to) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for axis in 0..3 {
            origin[axis] = lead.origin[axis].store()[0];
            from[axis] = lead.direction[axis].store()[0];
            to[axis] = last.direction[axis].store()[LANES - 1];
        }
        let (from, to) = (from.as_vec3(), to.as_vec3());
        let local = (origin - DVec3::from(lead.tables.scene[0].center)).as_vec3();
        let ahead = (from + to).normalize();
        // Along the way from the first to the last, so that a row of pixels is no wider than it is.
        let over = ahead.cross(to - from);
        let over =
            if over.length_squared() > 1e-8 { over } else { ahead.any_orthogonal_vector() }.normalize();
        let axes = [ahead, over.cross(ahead), over];
        let [[x, y, z], _] = lead.turned();
        let from = [L::narrow(x), L::narrow(y), L::narrow(z)];
        let mut bundle =
            Bundle { axes, places: [[L::splat(0.0); 2]; MOST], limit: f32::INFINITY, local, from };
        let origin = [L::Wide::splat(origin.x), L::Wide::splat(origin.y), L::Wide::splat(origin.z)];
        let mut limit = lead.limit;
        for (packet, place) in packets.iter().zip(&mut bundle.places) {
            let mut apart = packet.under_way ^ ALL;
            for (of, one) in packet.origin.iter().zip(origin) {
                apart |= !(of.le(one) & one.le(*of)) & ALL;
            }
            let [dx, dy, dz] = packet.direction;
            let (dx, dy, dz) = (L::narrow(dx), L::narrow(dy), L::narrow(dz));
            let mut at = [L::splat(0.0); 3];
            for (at, axis) in at.iter_mut().zip(bundle.axes) {
                *at = dx.mul_add(L::splat(axis[0]), dy.mul_add(L::splat(axis[1]), dz.mul(L::splat(axis[2]))));
            }
            apart |= !L::bits(L::splat(NARROW).le(at[0])) & ALL;
            // No steeper than `quick` takes them, however the lattice is turned.
            apart |= !L::bits(L::splat(STEEPEST).le(dx.mul_add(dx, dy.mul(dy)))) & ALL;
            if apart != 0 {
                return None;
            }
            let per = L::splat(1.0).div(at[0]);
            *place = [at[1].mul(per), at[2].mul(per)];
            limit = limit.min(packet.limit);
        }
        // Less than any, where it is rounded up.
        bundle.limit = range(L::narrow(limit).store())[0] * (1.0 - 1e-6);
        Some(bundle)
    }

    /// The pyramid that holds the rays of some packets.
    #[inline(always)]
    fn pyramid<'a>(&'a self, tables: &'a Views, part: Part) -> Option<Pyramid<'a, L>> {
        let places = self.places.get(usize::from(part.first)..)?.get(..usize::from(part.count))?;
        let (mut least, mut greatest) = (*places.first()?, *places.first()?);
        for place in places {
            for i in 0..2 {
                (least[i], greatest[i]) = (least[i].min(place[i]), greatest[i].max(place[i]));
            }
        }
        let mut reach = [[0.0; 2]; 2];
        for i in 0..2 {
            reach[i] = [range(least[i].store())[0] - WIDER, range(greatest[i].store())[1] + WIDER];
        }
        // No corner's direction is longer than unit: so places along it are no nearer than along a ray.
        let squares = |[lo, hi]: [f32; 2]| (lo * lo).max(hi * hi);
        let size = 1.0 / (1.0 + squares(reach[0]) + squares(reach[1])).sqrt() * (1.0 - 1e-6);
        let [[a, b], [c, d]] = reach;
        let (right, up) = (L::load(&[a, b, b, a, a, b, b, a]), L::load(&[c, c, d, d, c, c, d, d]));
        let mut along = [right; 3];
        for (axis, to) in along.iter_mut().enumerate() {
            let [ahead, aside, over] = [self.axes[0][axis], self.axes[1][axis], self.axes[2][axis]];
            *to = right
                .mul_add(L::splat(aside), up.mul_add(L::splat(over), L::splat(ahead)))
                .mul(L::splat(size));
        }
        let [cos, sin] = tables.scene[0].lattice_turn;
        if sin != 0.0 {
            let (cos, sin) = (L::splat(cos as f32), L::splat(sin as f32));
            let [x, y, z] = along;
            along = [x.mul(cos).add(y.mul(sin)), y.mul(cos).sub(x.mul(sin)), z];
        }
        let mut corners = Lines::through(self.from, along, tables.airgrid[0].rounding);
        corners.tilt = L::splat(most(corners.tilt));
        Some(Pyramid { tables, corners, reach, of: self })
    }

    /// Takes packets through prisms as long as all rays of a part leave them one way. Where that ends they are halved, and at last left to others.
    #[inline(always)]
    fn run(&self, tables: &Views, packets: &mut [Eight<'_, L>], cell: u32, notes: &mut Notes<'_>) {
        let mut parts = ArrayVec::<Part, MOST>::new();
        parts.push(Part { first: 0, count: packets.len().min(MOST) as u8, starts: true, cell });
        while let Some(mut part) = parts.pop() {
            if self.pass(tables, packets, &mut part, notes) {
                continue;
            }
            if usize::from(part.count) > FEWEST {
                let half = part.count / 2;
                parts.push(Part { first: part.first + half, count: part.count - half, ..part });
                parts.push(Part { count: half, ..part });
            } else {
                notes.leave(part.packets(), &part);
            }
        }
    }

    /// Takes a part through prisms as long as all rays leave them one way; whether those that are under way then are left to others already.
    #[inline(always)]
    fn pass(
        &self,
        tables: &Views,
        packets: &mut [Eight<'_, L>],
        part: &mut Part,
        notes: &mut Notes<'_>,
    ) -> bool {
        let Some(packets) = packets.get_mut(part.packets()) else { return true };
        let Some(pyramid) = self.pyramid(tables, *part) else { return true };
        // Each cell once.
        for _ in 0..tables.cells.len() {
            let step = &tables.steps[part.cell as usize];
            let Some((edge, link, exit)) = pyramid.way_out(step, *part) else { return false };
            let is_end = link & Step::PLATE != 0;
            // What is too far is for others.
            let is_in_reach = exit <= self.limit;
            if !is_end && !is_in_reach {
                return false;
            }
            let Some(near) = pyramid.gather(step.root, exit) else { return false };
            if is_end {
                for (number, packet) in part.packets().zip(&mut *packets) {
                    let source = link & !Step::PLATE;
                    if packet.under_way != 0
                        && !packet.end(Some(&near), step, source, &mut notes.of(number, part))
                    {
                        notes.leave(number..number + 1, part);
                    }
                }
                return true;
            }
            if !near.is_empty() {
                let mut under_way = 0;
                for (number, packet) in part.packets().zip(&mut *packets) {
                    packet.pass_detail(Some(&near), step, edge, L::splat(exit), &mut notes.of(number, part));
                    under_way |= packet.under_way;
                }
                if under_way == 0 {
                    return true;
                }
            }
            (part.cell, part.starts) = (link, false);
        }
        false
    }
}

impl Part {
    #[inline(always)]
    fn packets(&self) -> std::ops::Range<usize> {
        let first = usize::from(self.first);
        first..first + usize::from(self.count)
    }
}
