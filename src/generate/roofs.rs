//! Roofs over wings.

use crate::importers::Semantic;

use super::building::Kind;
use super::complex::{MODULE, PARAPET, PlacedWing, SLAB};
use super::drawing::{Drawing, Floor, Furnished, upright};
use super::holes::Filling;
use super::lattice::Rect;
use super::palette::{self, Look};
use super::plan::{Paint, Slope, Top};
use super::uses::Use;
use super::wing::OUTER;

impl Drawing<'_> {
    /// The slab over the uppermost storey, gravel, and a parapet.
    pub(super) fn flat_roof(&mut self, placed: &PlacedWing, footprint: Rect) {
        let top = placed.top();
        let slab = self.roof_slab(&format!("{} roof slab", placed.name));
        self.draft.paint(slab, upright(footprint, [top - SLAB * MODULE, top]));
        let roof = self.roof(&format!("{} roof", placed.name));
        self.draft.paint(roof, upright(footprint, [top, top + MODULE]));
        let parapet = self.wall(&format!("{} parapet", placed.name), true);
        let ([l, d], t) = (footprint.hi, OUTER * placed.module());
        for rect in [[0, 0, l, t], [0, d - t, l, d], [0, t, t, d - t], [l - t, t, l, d - t]] {
            let rect = Rect { lo: [rect[0], rect[1]], hi: [rect[2], rect[3]] };
            self.draft.paint(parapet, upright(rect, [top, top + PARAPET * MODULE]));
        }
    }

    pub(super) fn roof(&mut self, name: &str) -> u32 {
        let roof = self.draft.element(Kind::Solid, Semantic::Roof, "IfcRoof", name);
        let look =
            Look { core: palette::CONCRETE, outside: palette::ZINC, top: palette::GRAVEL, ..Look::default() };
        self.draft.look(roof, look);
        roof
    }

    /// An attic under two slopes of one in two, between gable walls.
    pub(super) fn gable_roof(&mut self, placed: &PlacedWing, footprint: Rect) {
        let (top, [l, d], t) = (placed.top(), footprint.hi, OUTER * MODULE);
        let slab = self.slab(&format!("{} attic slab", placed.name), footprint, top);
        self.draft.storey("Attic");
        let under = |raised: i32| {
            let eaves = 2 * i64::from(top + PARAPET * MODULE + raised);
            [
                Top::Slope(Slope { run: [0, 1], rise: eaves, per: 2 }),
                Top::Slope(Slope { run: [0, -1], rise: eaves + i64::from(d), per: 2 }),
            ]
        };
        let (inside, outside) = (under(0), under(3 * MODULE));
        let halves = [[0, d / 2], [d / 2, d]];
        let roof = self.roof(&format!("{} roof", placed.name));
        let tiles = Look {
            core: palette::BEECH,
            outside: palette::MASONRY,
            top: palette::MASONRY,
            ..Look::default()
        };
        self.draft.look(roof, tiles);
        let name = self.room_name(placed.storeys.len(), Use::Attic);
        let attic = self.space(&name, Use::Attic);
        let sides =
            ["south", "north"].map(|side| self.wall(&format!("{} attic wall {side}", placed.name), true));
        let gables = ["west", "east"].map(|end| self.wall(&format!("{} gable {end}", placed.name), true));
        for (half, &[y0, y1]) in halves.iter().enumerate() {
            let mut paint = |label: u32, [x0, x1]: [i32; 2], [y0, y1]: [i32; 2], sides: [Top; 2]| {
                let rect = Rect { lo: [x0, y0], hi: [x1, y1] };
                self.draft.paint_prism(Paint { rect, sides, label: Some(label) });
            };
            let up_to_roof = [Top::Level(top), inside[half]];
            paint(attic, [0, l], [y0, y1], up_to_roof);
            paint(gables[0], [0, t], [y0, y1], up_to_roof);
            paint(gables[1], [l - t, l], [y0, y1], up_to_roof);
            let side = if half == 0 { [0, t] } else { [d - t, d] };
            paint(sides[half], [0, l], side, up_to_roof);
            paint(roof, [0, l], [y0, y1], [inside[half], outside[half]]);
        }
        for (end, [x0, x1]) in [[0, t], [l - t, l]].into_iter().enumerate() {
            let rect = Rect { lo: [x0, d / 2 - 8 * MODULE], hi: [x1, d / 2 + 8 * MODULE] };
            let name = format!("{} gable window {}", placed.name, ["west", "east"][end]);
            let space = upright(rect, [top + 9 * MODULE, top + 20 * MODULE]);
            self.pierce(&name, space, [3, 1][end], Filling::Window { panes: 2 }, gables[end]);
        }
        let mut clear = Vec::new();
        if let Some(wing) = placed.storeys.last() {
            let (k, z) = (placed.storeys.len(), top);
            let floor = Floor { placed, wing, plan: wing.storey(), k, z };
            for room in floor.plan.rooms.iter().filter(|room| room.use_ == Use::Stair) {
                if let Some(stair) = floor.stair(room) {
                    let well = floor.rect(&stair.well());
                    self.stairwell(&floor.name(&format!("Stairwell {}", room.rects[0][0])), well, z, slab);
                    clear.push(floor.rect(&room.rects[0]));
                }
            }
        }
        // Where one can stand.
        let low = 30 * MODULE;
        let rects = vec![Rect { lo: [t, low], hi: [l - t, d - low] }];
        let attic = Furnished {
            name: &name,
            use_: Use::Attic,
            rects,
            solids: Vec::new(),
            clear,
            windows: Vec::new(),
            heights: [top, top + PARAPET * MODULE + low / 2],
        };
        self.furnish(&attic);
    }
}
