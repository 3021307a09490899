//! A room being furnished: what stands in it, and where more fits.

mod floor;
mod walls;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::generate::lattice::{Cuboid, Placement, units};

use super::catalogue::{Catalogue, Item, Thing};
use super::group::{Group, Part, within};
use super::random::Random;
use super::region::{FAR, Region, Wall};
use super::walkway::Walkway;
use super::wish::{Filler, Wish};
use super::{HEADROOM, MOST_RECTS, Placed, Rect, Room};

/// Width of the way to a thing, metres.
const NARROW: f64 = 0.5;

/// No room gets more things.
const MOST_THINGS: usize = 1000;

/// A thing that stands.
struct Stand {
    bounds: Cuboid,
    boxes: Vec<Cuboid>,
    /// Whether one walks past it as if it were not there.
    is_hung: bool,
}

/// A room being furnished.
pub struct Fitting<'a> {
    /// The room.
    pub room: &'a Room<'a>,
    /// Chance.
    pub random: Random,
    catalogue: &'a mut Catalogue,
    region: Region,
    walls: Vec<Wall>,
    area: i64,
    floor: i32,
    ceiling: i32,
    /// The way between doors, if that is wider than the ways to things.
    thoroughfare: Option<Walkway>,
    walkway: Walkway,
    window_fronts: Vec<(Rect, i32)>,
    stands: Vec<Stand>,
    used: Vec<Rect>,
    placed: Vec<Placed>,
    faces: u32,
}

impl<'a> Fitting<'a> {
    /// The empty room; nothing if it has no air.
    pub fn new(catalogue: &'a mut Catalogue, room: &'a Room<'a>) -> Option<Fitting<'a>> {
        if room.rects.len().saturating_add(room.solids.len()) > MOST_RECTS {
            return None;
        }
        let [floor, ceiling] = [room.floor, room.ceiling].map(|z| z.clamp(-FAR, FAR));
        let region = Region::new(room.rects, room.solids);
        let area = region.area();
        if area == 0 || ceiling <= floor {
            return None;
        }
        let way = |width: f64| Walkway::new(&region, units(width), room.keep_clear);
        let wide = room.use_.walkway();
        let thoroughfare = (wide > NARROW).then(|| way(wide));
        let walkway = way(NARROW);
        Some(Fitting {
            room,
            random: Random::new(room.seed),
            catalogue,
            walls: region.walls(),
            region,
            area,
            floor,
            ceiling: ceiling - units(HEADROOM),
            thoroughfare,
            walkway,
            window_fronts: room.windows.iter().map(|w| (w.front(), w.sill)).collect(),
            stands: Vec::new(),
            used: Vec::new(),
            placed: Vec::new(),
            faces: 0,
        })
    }

    /// The room's area, square metres, rounded down.
    pub fn square_metres(&self) -> u32 {
        u32::try_from(self.area >> 20).unwrap_or(u32::MAX)
    }

    /// How many faces show so far.
    pub fn faces(&self) -> u32 {
        self.faces
    }

    /// How many faces should show in the end.
    pub fn target(&self) -> u32 {
        let usual = u64::from(self.room.use_.target(self.area));
        u32::try_from(usual * u64::from(self.room.fullness) / 100).unwrap_or(u32::MAX)
    }

    /// How many faces more may show before the room is fuller than it should be.
    pub fn budget(&self) -> u32 {
        let target = self.target();
        (target + (target / 33).max(3)).saturating_sub(self.faces)
    }

    /// The smallest rectangle around the room.
    pub fn bounds(&self) -> Rect {
        self.region.bounds().unwrap_or(Rect { lo: [0; 2], hi: [0; 2] })
    }

    /// The floor from which things are used.
    #[cfg(test)]
    pub fn used(&self) -> &[Rect] {
        &self.used
    }

    /// A thing of the catalogue.
    pub fn item(&mut self, thing: Thing) -> Arc<Item> {
        self.catalogue.item(thing)
    }

    /// Puts a group at a place in the plan, if it fits there.
    pub fn put(&mut self, group: &Group, place: &Placement) -> bool {
        let place = Placement { origin: [place.origin[0], place.origin[1], self.floor], ..*place };
        if self.placed.len() + group.parts.len() > MOST_THINGS || group.parts.is_empty() {
            return false;
        }
        let used: Vec<Rect> = group.used.iter().map(|rect| rect.placed(&place)).collect();
        let is_blocked = |rect: &Rect| {
            !self.region.holds(rect)
                || self.stands.iter().any(|s| !s.is_hung && Rect::under(&s.bounds).overlaps(rect))
        };
        if used.iter().any(is_blocked) {
            return false;
        }
        let mut stands = Vec::with_capacity(group.parts.len());
        for part in &group.parts {
            match self.stand(part, &within(&place, &part.place)) {
                Some(stand) => stands.push(stand),
                None => return false,
            }
        }
        let in_the_way: Vec<Rect> = stands
            .iter()
            .zip(&group.parts)
            .filter(|(stand, part)| !stand.is_hung && !part.is_movable)
            .map(|(stand, _)| Rect::under(&stand.bounds))
            .collect();
        let Some(taken) = self.walkway.take(&in_the_way, &used) else { return false };
        if self.thoroughfare.as_mut().is_some_and(|way| way.take(&in_the_way, &[]).is_none()) {
            self.walkway.give_back(taken);
            return false;
        }
        self.used.extend(used);
        self.stands.extend(stands);
        for part in &group.parts {
            let place = within(&place, &part.place);
            let faces = self.shown(&part.item, &place);
            self.faces = self.faces.saturating_add(faces);
            self.placed.push(Placed {
                name: part.item.name.to_owned(),
                semantic: part.item.semantic,
                class: part.item.class,
                piece: part.item.piece.clone(),
                place,
                faces,
            });
        }
        true
    }

    /// A part where it would stand, if nothing is in its way.
    fn stand(&self, part: &Part, place: &Placement) -> Option<Stand> {
        let item = &part.item;
        let [w, d] = item.size;
        let bounds = place.cuboid(&Cuboid { lo: [0, 0, item.z[0]], hi: [w, d, item.z[1]] });
        let under = Rect::under(&bounds);
        let is_hung = item.is_hung();
        let fits = bounds.hi[2] <= self.ceiling
            && self.region.holds(&under)
            && !self.room.keep_clear.iter().any(|clear| !clear.is_empty() && clear.overlaps(&under))
            && (is_hung || !self.used.iter().any(|used| used.overlaps(&under)));
        if !fits {
            return None;
        }
        let boxes: Vec<Cuboid> = item.boxes.iter().map(|b| place.cuboid(b)).collect();
        let hides_window = self.window_fronts.iter().any(|(front, sill)| {
            front.overlaps(&under) && boxes.iter().any(|b| b.hi[2] > *sill && front.overlaps(&Rect::under(b)))
        });
        let collides = self.stands.iter().any(|other| {
            share_space(&other.bounds, &bounds)
                && other.boxes.iter().any(|a| boxes.iter().any(|b| share_space(a, b)))
        });
        (!hides_window && !collides).then_some(Stand { bounds, boxes, is_hung })
    }

    /// How many faces of a thing can be seen: all but those at sides that touch a wall all along.
    fn shown(&self, item: &Item, place: &Placement) -> u32 {
        let [w, d] = item.size;
        let beside = [
            Rect { lo: [0, -1], hi: [w, 0] },
            Rect { lo: [w, 0], hi: [w + 1, d] },
            Rect { lo: [0, d], hi: [w, d + 1] },
            Rect { lo: [-1, 0], hi: [0, d] },
        ];
        let hidden =
            beside.iter().zip(item.at_sides).filter(|(rect, _)| self.region.misses(&rect.placed(place)));
        item.faces - hidden.map(|(_, faces)| faces).sum::<u32>()
    }

    /// Puts one thing against a wall, unless the room would be too full then.
    pub fn add(&mut self, thing: Thing, front: i32, wish: &Wish) -> bool {
        let item = self.item(thing);
        item.faces <= self.budget() && self.against_wall(&Group::alone(&item, front), wish)
    }

    /// Adds small things until the room shows as many faces as it should, or no more fit.
    pub fn fill(&mut self, fillers: &[Filler]) {
        let by_size = 1 + self.square_metres().min(4000) / 25;
        let mut tries: Vec<(u32, bool)> = vec![(0, true); fillers.len()];
        // Not many of one kind; but if the others find no place, more of it.
        for round in 1..=3 {
            loop {
                if self.faces >= self.target() {
                    return;
                }
                let budget = self.budget();
                let mut open = Vec::new();
                for (i, filler) in fillers.iter().enumerate() {
                    let (count, fits) = tries[i];
                    if fits
                        && count < filler.most * by_size * round
                        && self.item(filler.thing).faces <= budget
                    {
                        open.push(i);
                    }
                }
                let Some(&pick) = open.get(self.random.below(open.len() as u32) as usize) else { break };
                let filler = fillers[pick];
                let item = self.item(filler.thing);
                let group = Group::alone(&item, filler.front * 1024 / 100);
                let fits = self.against_wall(&group, &filler.wish);
                tries[pick] = (tries[pick].0 + u32::from(fits), fits);
            }
        }
    }

    /// All that stands, each with a name of its own.
    pub fn finish(self) -> Vec<Placed> {
        let mut placed = self.placed;
        let mut counts: BTreeMap<String, [u32; 2]> = BTreeMap::new();
        placed.iter().for_each(|p| counts.entry(p.name.clone()).or_default()[0] += 1);
        for piece in &mut placed {
            if let Some([all, so_far]) = counts.get_mut(&piece.name).filter(|[all, _]| *all > 1) {
                *so_far = (*so_far + 1).min(*all);
                piece.name = format!("{} {so_far}", piece.name);
            }
        }
        placed
    }
}

/// Whether the insides of two boxes share a point.
fn share_space(a: &Cuboid, b: &Cuboid) -> bool {
    (0..3).all(|i| a.lo[i] < b.hi[i] && b.lo[i] < a.hi[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::interior::{Use, Window};

    fn rect(west: f64, south: f64, east: f64, north: f64) -> Rect {
        Rect { lo: [west, south].map(units), hi: [east, north].map(units) }
    }

    fn at(x: f64, y: f64, turns: u8) -> Placement {
        Placement { origin: [units(x), units(y), 0], turns }
    }

    const CUPBOARD: Thing = Thing::Cupboard { w: 100, h: 195, doors: 2, is_dark: false };

    /// A room of 4 by 3 m with a door in the west and one in the east, and a window in the north.
    fn with_room(use_: Use, test: impl FnOnce(&mut Fitting)) {
        let rects = [rect(0.0, 0.0, 4.0, 3.0)];
        let keep_clear = [rect(0.0, 1.0, 0.8, 2.0), rect(3.2, 1.0, 4.0, 2.0)];
        let windows = [Window { from: [1024, 3072], to: [3072, 3072], sill: units(0.9) }];
        let (floor, ceiling) = (0, units(2.6));
        let room = Room {
            use_,
            rects: &rects,
            solids: &[],
            floor,
            ceiling,
            keep_clear: &keep_clear,
            windows: &windows,
            fullness: 100,
            seed: 0,
        };
        test(&mut Fitting::new(&mut Catalogue::default(), &room).unwrap());
    }

    #[test]
    fn things_stand_where_nothing_is_in_their_way() {
        with_room(Use::Office, |f| {
            let cupboard = Group::alone(&f.item(CUPBOARD), units(0.5));
            assert!(!f.put(&cupboard, &at(3.5, 0.0, 0)), "it would go through the wall");
            assert!(!f.put(&cupboard, &at(0.0, 1.5, 0)), "a door");
            assert!(!f.put(&cupboard, &at(2.0, 3.0, 2)), "it would hide the window");
            assert!(f.put(&cupboard, &at(1.0, 0.0, 0)));
            assert!(!f.put(&cupboard, &at(1.9, 0.0, 0)), "one stands there");
            assert!(f.put(&cupboard, &at(2.0, 0.0, 0)), "side by side");
            let bin = Group::alone(&f.item(Thing::Bin), 0);
            assert!(!f.put(&bin, &at(1.5, 0.5, 0)), "in front of the doors");
            assert!(f.put(&bin, &at(1.5, 1.0, 0)));
            assert!(f.put(&bin, &at(2.0, 2.7, 0)), "lower than the sill");
            let picture = Group::alone(&f.item(Thing::Picture { w: 50, h: 70, color: 0 }), 0);
            assert!(!f.put(&picture, &at(2.0, 0.0, 0)), "a cupboard is there");
            assert!(f.put(&picture, &at(0.0, 0.7, 3)), "beside the door");
            assert!(!f.put(&picture, &at(0.0, 1.3, 3)), "on the door");
            let rack = Group::alone(&f.item(Thing::Rack { w: 100, pattern: 0 }), 0);
            assert!(f.put(&rack, &at(3.0, 0.0, 0)), "2 m are high enough");
            assert_eq!(f.faces(), f.placed.iter().map(|p| p.faces).sum::<u32>());
        });
    }

    #[test]
    fn hung_things_may_be_over_used_floor_and_low_ones_not() {
        with_room(Use::Office, |f| {
            let cupboard = Group::alone(&f.item(CUPBOARD), units(0.9));
            assert!(f.put(&cupboard, &at(0.0, 1.0, 3)));
            let clock = Group::alone(&f.item(Thing::Clock), 0);
            let bin = Group::alone(&f.item(Thing::Bin), 0);
            assert!(!f.put(&bin, &at(0.6, 0.0, 0)));
            assert!(f.put(&clock, &at(0.6, 0.0, 0)));
            // And nothing is put where its own floor is taken.
            assert!(f.put(&bin, &at(2.0, 0.5, 0)));
            assert!(!f.put(&cupboard, &at(1.6, 0.0, 0)));
        });
    }

    #[test]
    fn ways_are_left() {
        // A table from the southern wall on, so long in centimetres, across the way between the doors.
        let barrier = |f: &mut Fitting, w: u16| {
            let table = f.item(Thing::Table { w, d: 40, h: 74 });
            f.put(&Group::alone(&table, 0), &at(2.2, 0.0, 1))
        };
        with_room(Use::Office, |f| assert!(!barrier(f, 260), "0.4 m are left"));
        with_room(Use::Office, |f| assert!(barrier(f, 230), "0.7 m are left"));
        with_room(Use::Corridor, |f| assert!(!barrier(f, 230), "too little in a corridor"));
        with_room(Use::Corridor, |f| assert!(barrier(f, 160)));
        // A table along the southern wall that is used from behind.
        let behind = |f: &mut Fitting, w: u16| {
            let mut table = Group::alone(&f.item(Thing::Table { w, d: 30, h: 74 }), 0);
            table.used.push(Rect { lo: [0, -units(0.6)], hi: [units(2.0), 0] });
            f.put(&table, &at(0.0, 0.6, 0))
        };
        with_room(Use::Office, |f| assert!(behind(f, 300)));
        with_room(Use::Office, |f| assert!(!behind(f, 400), "nobody gets there"));
    }

    #[test]
    fn the_best_place_is_taken_first() {
        with_room(Use::Office, |f| {
            let plant = Group::alone(&f.item(Thing::SmallPlant), 0);
            let far_from_light = Wish { window: -20, corner: 20, ..Wish::default() };
            assert!(f.against_wall(&plant, &far_from_light));
            let under = Rect::under(&f.stands[0].bounds);
            assert!(under.lo[1] == 0 && (under.lo[0] == 0 || under.hi[0] == units(4.0)), "{under:?}");
            assert!(f.in_corner(&plant, true, &Wish { facing: Some((1, 50)), ..Wish::default() }));
            let placed = f.placed[1].place;
            assert_eq!(
                (placed.turns, placed.origin),
                (1, [units(4.0), if under.hi[0] == units(4.0) { placed.origin[1] } else { 0 }, 0])
            );
            let names: Vec<String> = f.placed.iter().map(|p| p.name.clone()).collect();
            assert_eq!(names, ["Plant", "Plant"]);
        });
    }
}
