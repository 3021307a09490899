//! Triangles in cells: rasterised, with depth, into the region of the picture whose rays are in the cell.
//!
//! In the camera's own coordinates, in which the ray through column `x` and row `y` is `(x, y, 1)`, the plane through the eye and an edge is the cross product
//! of its ends: a line of the picture, of equal size and opposite sign on the other side. A triangle is where three of them are positive, so that
//! nothing is clipped, not even behind the eye; and `1 / t` is linear.

use glam::{DMat3, DVec3, Vec3};

use super::backs::Hidden;
use super::cut::{Cut, Cutting, Exits, ROUNDED, outside};
use super::facets::Facets;
use super::joined::{Joined, MOST_CORNERS, Once, Polygon};
use super::kernels::{Bound, Deep, Kernels, up};
use super::outer::{Group, Outer};
use super::rows::{Arena, Region};
use super::screen::Screen;
use super::sight::{Place, Sight, away, reaches, triangles_reach};
use super::simd;
use crate::format::Views;
use crate::format::records::{LANES, Leaf, NodeRecord};
use crate::trace::NONE;

/// A corner that is this much farther outside of a cell, metres, is outside.
const OUTSIDE: f64 = 1e-6;

/// A corner nearer than this in front of the eye, in units of the ray, has no place in the picture.
const FRONT: f64 = 1e-6;

/// The triangles of a scene as a picture sees them.
pub(crate) struct Detail<'a> {
    tables: &'a Views,
    /// Along the internal frame's axes.
    pub(super) screen: Screen,
    /// From a point relative to the eye to the camera's coordinates.
    camera: DMat3,
    /// Whether that swaps left and right.
    is_mirrored: bool,
    /// The backs that are not drawn.
    hidden: &'a Hidden<'a>,
    /// The eye relative to the scene's center.
    eye: Vec3,
    sight: Sight,
    stack: Vec<u32>,
    open: Open,
    /// Which triangles were met already: several boxes may each hold a part of one.
    met: Met,
    /// Which blocks of them.
    met_blocks: Met,
    /// Which polygons were drawn already.
    once: &'a mut Once,
}

/// What was met in a picture: a bit each, as [`Once`] takes 5 % longer for pictures of all triangles, and this too long to begin anew for each cell.
struct Met(Vec<u64>);

impl Met {
    /// Nothing yet, of so many.
    fn begin(&mut self, count: usize) {
        self.0.clear();
        self.0.resize(count.div_ceil(64), 0);
    }

    /// Whether this is new.
    #[inline(always)]
    fn insert(&mut self, at: usize) -> bool {
        let (word, bit) = (&mut self.0[at / 64], 1 << (at % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }
}

/// What draws triangles.
pub(super) trait Pen {
    /// Whether nothing in a place would show.
    fn hides(&mut self, place: &Place) -> bool;

    /// The polygons to draw: where it is all the same which of the triangles of one is seen.
    fn joined(&self) -> Option<&Joined>;

    fn draw(&mut self, drawn: &Drawn);

    /// Notes where a polygon, which is about to be drawn, may end a little sooner, or later.
    fn cut(&mut self, drawn: &Drawn);
}

/// Nodes and leaves that wait, each with where in the picture it is: the nearest come first, but for a hundredth of how far they are. A heap, that
/// has them in order, takes 3 % of a picture from outside.
struct Open {
    all: Vec<Waiting>,
    /// By how far each is the last that was added and has not been taken, if any has not.
    last: Box<[u32; Open::STEPS]>,
    /// Where any wait, in words, and which words have any.
    waits: [u64; Open::STEPS / 64],
    words: u32,
}

#[derive(Clone, Copy)]
struct Waiting {
    link: u32,
    /// What was added before it as far away, or [`NONE`].
    before: u32,
    place: Place,
}

impl Open {
    /// Of an f32 so many bits after the exponent.
    const BITS: u32 = 6;
    /// From a square of a few centimetres to one of kilometres; what is nearer or farther is together.
    const FIRST: u32 = (127 - 10) << Open::BITS;
    const STEPS: usize = 32 << Open::BITS;

    fn new() -> Open {
        Open { all: Vec::new(), last: Box::new([NONE; Open::STEPS]), waits: [0; Open::STEPS / 64], words: 0 }
    }

    fn clear(&mut self) {
        self.all.clear();
        (self.waits, self.words) = ([0; Open::STEPS / 64], 0);
    }

    /// Adds one, and the square of how far it is, metres.
    #[inline(always)]
    fn push(&mut self, link: u32, away: f32, place: Place) {
        let step = (away.to_bits() >> (23 - Open::BITS)).saturating_sub(Open::FIRST) as usize;
        let step = step.min(Open::STEPS - 1);
        let (word, bit) = (step / 64, 1 << (step % 64));
        let before = if self.waits[word] & bit == 0 { NONE } else { self.last[step] };
        self.last[step] = self.all.len() as u32;
        self.all.push(Waiting { link, before, place });
        self.waits[word] |= bit;
        self.words |= 1 << word;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(u32, Place)> {
        if self.words == 0 {
            return None;
        }
        let word = self.words.trailing_zeros() as usize;
        let bit = self.waits[word].trailing_zeros() as usize;
        let last = &mut self.last[64 * word + bit];
        let Waiting { link, before, place } = self.all[*last as usize];
        *last = before;
        if before == NONE {
            self.waits[word] &= self.waits[word] - 1;
            if self.waits[word] == 0 {
                self.words &= self.words - 1;
            }
        }
        Some((link, place))
    }
}

/// A triangle, or a polygon of some, ready to be drawn.
pub(crate) struct Drawn {
    /// One of them.
    pub(super) triangle: u32,
    /// How many.
    pub(super) count: usize,
    /// The rows that it may reach.
    pub(super) rows: [i32; 2],
    /// Along the internal frame's axes, unit length.
    pub(super) normal: DVec3,
    /// How it looks, if that is known.
    pub(super) color: Option<[f32; 3]>,
    /// Whether it is known that one doesn't see through it.
    pub(super) is_opaque: bool,
    pub(super) deep: Deep,
    /// So many of the bounds are its sides, and the planes of its cell that have no faces.
    pub(super) within: usize,
    /// Where it may have come to an end a little before, or may do so a little later.
    pub(super) cuts: Vec<Cut>,
}

impl Drawn {
    /// Of nothing yet.
    fn new() -> Drawn {
        let deep = Deep { bounds: Vec::new(), near: [0.0; 3], nearest: 0.0 };
        Drawn {
            triangle: u32::MAX,
            count: 0,
            rows: [0; 2],
            normal: DVec3::ZERO,
            color: None,
            is_opaque: false,
            deep,
            within: 0,
            cuts: Vec::new(),
        }
    }
}

impl<'a> Detail<'a> {
    pub(crate) fn new(
        tables: &'a Views,
        screen: Screen,
        hidden: &'a Hidden<'a>,
        once: &'a mut Once,
    ) -> Detail<'a> {
        let camera = DMat3::from_cols(screen.across, screen.down, screen.first).inverse();
        let eye = (screen.eye - DVec3::from(tables.scene[0].center)).as_vec3();
        let [lo, hi] = tables.scene[0].hull.map(DVec3::from);
        let reach = (lo - screen.eye).abs().max((hi - screen.eye).abs()).length() + (hi - lo).length();
        let sight = Sight::new(camera, eye, reach);
        let is_mirrored = camera.determinant() < 0.0;
        Detail {
            tables,
            screen,
            camera,
            is_mirrored,
            hidden,
            eye,
            sight,
            stack: Vec::new(),
            open: Open::new(),
            met: Met(Vec::new()),
            met_blocks: Met(Vec::new()),
            once,
        }
    }

    /// Gives `pen` all triangles below `root` that may show in a region, as far as they are within the planes through which the region's rays leave.
    pub(super) fn draw(&mut self, region: &Region, root: u32, exits: Exits<'_>, pen: &mut impl Pen) {
        let (frustum, mut drawn) = (self.frustum(region), Drawn::new());
        self.once.begin(self.tables.triangles.len());
        self.stack.clear();
        // A scene may have no triangles at all.
        self.stack.extend((root != NONE).then_some(root));
        while let Some(link) = self.stack.pop() {
            if link & Leaf::BIT == 0 {
                let node = &self.tables.nodes[link as usize];
                let seen = reaches(node, self.eye, &frustum, self.sight.slack);
                self.push_nearest_last(node, seen);
                continue;
            }
            let leaf = Leaf::new(link);
            let block = &self.tables.blocks[leaf.block()];
            // Triangles that rays are not to meet are no numbers: they reach nowhere.
            let mut seen = leaf.mask() & triangles_reach(block, self.eye, &frustum, self.sight.slack);
            let backs = self.hidden.of_block(leaf.block());
            if seen != 0 {
                seen &= !self.sight.hidden(block, backs);
            }
            while seen != 0 {
                let lane = seen.trailing_zeros() as usize;
                seen &= seen - 1;
                self.draw_once((block.triangle[lane], of_lane(backs, lane)), region, exits, &mut drawn, pen);
            }
        }
    }

    /// Puts those children of a node that are seen on the stack, so that the nearest comes first: it hides others.
    fn push_nearest_last(&mut self, node: &NodeRecord, mut seen: u32) {
        let away = away(node, self.eye);
        let bottom = self.stack.len();
        let mut order = [0.0f32; LANES];
        while seen != 0 {
            let lane = seen.trailing_zeros() as usize;
            seen &= seen - 1;
            if node.child[lane] == u32::MAX {
                continue;
            }
            self.fetch(node.child[lane]);
            let mut at = self.stack.len() - bottom;
            self.stack.push(node.child[lane]);
            while at > 0 && order[at - 1] < away[lane] {
                order[at] = order[at - 1];
                self.stack.swap(bottom + at, bottom + at - 1);
                at -= 1;
            }
            order[at] = away[lane];
        }
    }

    /// Gives `pen` all triangles below `root` that may show in a region, which is to be most of the picture: from near to far, so that what
    /// is hidden is left out a box at a time.
    pub(super) fn draw_all(&mut self, region: &Region, root: u32, kernels: Kernels, pen: &mut impl Pen) {
        let (frustum, mut drawn) = (self.frustum(region), Drawn::new());
        self.met.begin(self.tables.triangles.len());
        self.met_blocks.begin(self.tables.blocks.len());
        self.once.begin(self.tables.triangles.len());
        self.open.clear();
        if root != NONE {
            self.open.push(root, 0.0, Place::ANYWHERE);
        }
        while let Some((link, place)) = self.open.pop() {
            if !place.is_anywhere() && pen.hides(&place) {
                continue;
            }
            if link & Leaf::BIT == 0 {
                let node = &self.tables.nodes[link as usize];
                let boxes = kernels.look_at_boxes(&self.sight, node, region, &frustum);
                let mut seen = boxes.seen;
                while seen != 0 {
                    let lane = seen.trailing_zeros() as usize;
                    seen &= seen - 1;
                    let link = node.child[lane];
                    if link != u32::MAX {
                        self.fetch(link);
                        self.open.push(link, boxes.away[lane], boxes.places.of(lane));
                    }
                }
                continue;
            }
            // All triangles of a block are looked at together, when the first leaf that has some of them is met.
            let at = Leaf::new(link).block();
            if !self.met_blocks.insert(at) {
                continue;
            }
            let block = &self.tables.blocks[at];
            let backs = self.hidden.of_block(at);
            let (mut seen, places) = kernels.look_at_triangles(&self.sight, block, backs, region, &frustum);
            while seen != 0 {
                let lane = seen.trailing_zeros() as usize;
                seen &= seen - 1;
                let (place, triangle) = (places.of(lane), block.triangle[lane]);
                if !self.met.insert(triangle as usize) {
                    continue;
                }
                if place.is_anywhere() || !pen.hides(&place) {
                    self.draw_once((triangle, of_lane(backs, lane)), region, Exits::NONE, &mut drawn, pen);
                }
            }
        }
    }

    /// The same of all polygons, each of which is there once.
    pub(super) fn draw_facets(
        &mut self,
        region: &Region,
        facets: &Facets,
        kernels: Kernels,
        pen: &mut impl Pen,
    ) {
        let (frustum, mut drawn) = (self.frustum(region), Drawn::new());
        let is_within_any = self.hidden.is_within_any();
        self.open.clear();
        if let Some(root) = facets.root() {
            self.open.push(root, 0.0, Place::ANYWHERE);
        }
        while let Some((link, place)) = self.open.pop() {
            if !place.is_anywhere() && pen.hides(&place) {
                continue;
            }
            if link & Leaf::BIT != 0 {
                let (facet, corners) = facets.facet(link);
                let (mut world, count) = ([DVec3::ZERO; MOST_CORNERS], corners.len().min(MOST_CORNERS));
                for (world, &corner) in world.iter_mut().zip(corners) {
                    *world = corner - self.screen.eye;
                }
                drawn.color = Some(facet.color);
                drawn.is_opaque = !facet.is_glass();
                let backs = if is_within_any { self.hidden.of(facet.triangle) } else { facet.backs() };
                let of = (facet.triangle, backs);
                self.polygon(
                    of,
                    (&world[..count], Some(facet.normal())),
                    region,
                    Exits::NONE,
                    &mut drawn,
                    pen,
                );
                continue;
            }
            let node = facets.node(link);
            let boxes = kernels.look_at_boxes(&self.sight, &node.boxes, region, &frustum);
            let mut seen = boxes.seen;
            if !is_within_any {
                seen &= !self.sight.behind(&node.planes);
            }
            while seen != 0 {
                let lane = seen.trailing_zeros() as usize;
                seen &= seen - 1;
                let link = node.boxes.child[lane];
                if link != NONE {
                    facets.fetch(link);
                    self.open.push(link, boxes.away[lane], boxes.places.of(lane));
                }
            }
        }
    }

    /// Has what waits in the memory brought nearer by the time that it is taken.
    #[inline(always)]
    fn fetch(&self, link: u32) {
        if link & Leaf::BIT == 0 {
            simd::fetch(&self.tables.nodes[link as usize]);
        } else {
            simd::fetch(&self.tables.blocks[Leaf::new(link).block()]);
        }
    }

    /// The same of what lies around the prisms.
    pub(super) fn draw_outer(
        &mut self,
        region: &Region,
        outer: &Outer,
        exits: Exits<'_>,
        pen: &mut impl Pen,
    ) {
        let (frustum, mut drawn) = (self.frustum(region), Drawn::new());
        self.once.begin(self.tables.triangles.len());
        let (eye, slack) = (self.eye, self.sight.slack);
        let is_seen = |group: &&Group| {
            frustum.iter().all(|normal| {
                let far = Vec3::select(normal.cmpgt(Vec3::ZERO), group.hi, group.lo);
                normal.dot(far - eye) >= -slack
            })
        };
        for group in outer.0.iter().filter(is_seen) {
            for &triangle in &group.triangles {
                self.draw_once((triangle, self.hidden.of(triangle)), region, exits, &mut drawn, pen);
            }
        }
    }

    /// Gives `pen` those of some triangles that may show in a region.
    pub(super) fn draw_listed(&mut self, region: &Region, triangles: &[u32], pen: &mut impl Pen) {
        let mut drawn = Drawn::new();
        self.once.begin(self.tables.triangles.len());
        for &triangle in triangles {
            self.draw_once((triangle, self.hidden.of(triangle)), region, Exits::NONE, &mut drawn, pen);
        }
    }

    /// The planes through the eye and the borders of a region's box, inward.
    fn frustum(&self, region: &Region) -> [Vec3; 4] {
        let Screen { first, across, down, .. } = self.screen;
        let ([x0, x1], [y0, y1]) = (region.columns.map(f64::from), region.rows.map(f64::from));
        let inward = |along: DVec3, at: DVec3, toward: DVec3| {
            let normal = along.cross(at).normalize_or_zero();
            if normal.dot(toward) < 0.0 { -normal } else { normal }.as_vec3()
        };
        [
            inward(down, first + across * (x0 - 0.5), across),
            inward(down, first + across * (x1 - 0.5), -across),
            inward(across, first + down * (y0 - 0.5), down),
            inward(across, first + down * (y1 - 0.5), -down),
        ]
    }

    /// Draws a triangle, or the polygon that it is of if that was not drawn yet.
    #[inline(always)]
    fn draw_once(
        &mut self,
        of: (u32, [bool; 2]),
        region: &Region,
        exits: Exits<'_>,
        drawn: &mut Drawn,
        pen: &mut impl Pen,
    ) {
        let (tables, triangle) = (self.tables, of.0);
        match pen.joined().map(|joined| joined.of(tables, triangle)) {
            Some(Polygon { lead, corners }) if self.once.insert(lead) => {
                // Taken out of what the pen has.
                let (mut world, count) = ([DVec3::ZERO; MOST_CORNERS], corners.len().min(MOST_CORNERS));
                for (world, &corner) in world.iter_mut().zip(corners) {
                    *world = DVec3::from(tables.vertices[corner as usize]) - self.screen.eye;
                }
                self.polygon(of, (&world[..count], None), region, exits, drawn, pen);
            }
            Some(_) => {}
            None => {
                let mut world = [DVec3::ZERO; 3];
                for (world, &corner) in world.iter_mut().zip(&tables.triangles[triangle as usize]) {
                    *world = DVec3::from(tables.vertices[corner as usize]) - self.screen.eye;
                }
                self.polygon(of, (&world, None), region, exits, drawn, pen);
            }
        }
    }

    /// Draws a polygon with these corners, one of whose triangles this is, unless nothing of it is seen in the region; it is left out where the eye is on
    /// its left, or its right, if that is said.
    fn polygon(
        &self,
        (triangle, [left, right]): (u32, [bool; 2]),
        (world, normal): (&[DVec3], Option<DVec3>),
        region: &Region,
        exits: Exits<'_>,
        drawn: &mut Drawn,
        pen: &mut impl Pen,
    ) {
        let mut seen = [DVec3::ZERO; MOST_CORNERS];
        let (mut is_before, mut is_behind) = (true, true);
        for (seen, &world) in seen.iter_mut().zip(world) {
            *seen = self.camera * world;
            is_before &= seen.z > FRONT;
            is_behind &= seen.z <= 0.0;
        }
        let seen = &seen[..world.len()];
        let (mut rows, mut nearest) = (region.rows, f64::INFINITY);
        if is_before {
            let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            nearest = 0.0;
            for v in seen {
                let inverse = 1.0 / v.z;
                let [x, y] = [v.x * inverse, v.y * inverse];
                least = [least[0].min(x), least[1].min(y)];
                most = [most[0].max(x), most[1].max(y)];
                nearest = inverse.max(nearest);
            }
            nearest *= 1.0 + 1e-6;
            let columns = [up(least[0] - ROUNDED), up(most[0] + ROUNDED)];
            rows[0] = rows[0].max(up(least[1] - ROUNDED));
            rows[1] = rows[1].min(up(most[1] + ROUNDED));
            if rows[0] >= rows[1]
                || columns[0] >= columns[1]
                || columns[0] >= region.columns[1]
                || columns[1] <= region.columns[0]
            {
                return;
            }
        } else if is_behind {
            return;
        }
        // The planes through the eye and the sides; together they are the plane's own normal.
        let (mut sides, mut all) = ([DVec3::ZERO; MOST_CORNERS], DVec3::ZERO);
        for (i, side) in sides.iter_mut().enumerate().take(seen.len()) {
            *side = seen[i].cross(seen[if i + 1 < seen.len() { i + 1 } else { 0 }]);
            all += *side;
        }
        let size = seen[0].dot(all);
        // Seen from the eye, the corners go around to the left where the volume that they span with it is negative.
        let is_left = (size < 0.0) != self.is_mirrored;
        if size == 0.0 || if is_left { left } else { right } {
            return;
        }
        let sign = size.signum();
        let near = all / size;
        let bounds = &mut drawn.deep.bounds;
        bounds.clear();
        for &side in &sides[..seen.len()] {
            bounds.push(Bound::new(side * sign, &mut rows));
        }
        let polygon = Cutting { corners: seen, near, is_before, rows, camera: &self.camera };
        let mut is_within = true;
        drawn.cuts.clear();
        // First the exits without faces: beyond them other cells cut it.
        for has_faces in [false, true] {
            let exits = exits.0.iter().filter(|exit| exit.is_exit());
            for exit in exits.filter(|exit| (exit.off.faces > 0.0) == has_faces) {
                let [least, most] = outside(exit, seen);
                if most > OUTSIDE * exit.size {
                    bounds.push(Bound::new(near + DVec3::from(exit.grows) / exit.away, &mut rows));
                }
                let reach = if has_faces { exit.off.faces } else { exit.off.at_edges };
                is_within &= least < reach * exit.size;
                if has_faces {
                    drawn.cuts.extend(polygon.at(exit, [least, most]));
                }
            }
            if !has_faces {
                drawn.within = bounds.len();
            }
        }
        if !is_within {
            drawn.cuts.clear();
        }
        if rows[0] >= rows[1] && drawn.cuts.is_empty() {
            return;
        }
        drawn.triangle = triangle;
        drawn.rows = rows;
        drawn.count = world.len() - 2;
        drawn.normal = normal.unwrap_or_else(|| {
            let mut normal = DVec3::ZERO;
            for pair in world[1..].windows(2) {
                normal += (pair[0] - world[0]).cross(pair[1] - world[0]);
            }
            normal.normalize_or_zero()
        });
        drawn.deep.near = near.to_array();
        drawn.deep.nearest = nearest;
        if !drawn.cuts.is_empty() {
            pen.cut(drawn);
        }
        if rows[0] < rows[1] {
            pen.draw(drawn);
        }
    }
}

/// Which of those of a block are told of a lane.
#[inline(always)]
fn of_lane([left, right]: [u32; 2], lane: usize) -> [bool; 2] {
    [left >> lane & 1 != 0, right >> lane & 1 != 0]
}

/// The borders of those rows of a region that `rows` holds, and more.
pub(super) fn borders_of<'a>(arena: &'a Arena, region: &Region, rows: [i32; 2]) -> [&'a [i32]; 2] {
    arena.borders_and_more(&region.within(rows))
}
