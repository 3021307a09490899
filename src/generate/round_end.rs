//! A round end of a building.

use crate::importers::Semantic;

use super::building::Kind;
use super::complex::{Apse, CLEAR, MODULE, SLAB, STOREY};
use super::drawing::{Drawing, Furnished, storey_name, upright};
use super::lattice::Rect;
use super::palette::{self, Look};
use super::sheet::Embedding;
use super::uses::Use;
use super::wing::OUTER;

impl Drawing<'_> {
    /// A round end, as high as the first wing.
    pub(super) fn apse(&mut self, apse: Apse) {
        let Some(first) = self.complex.wings.first() else { return };
        let Some(wing) = first.storeys.first() else { return };
        let [south, north] = wing.corridor_rows();
        let middle = (south + north) * MODULE / 2;
        let center = first.place([0, middle]);
        let embedding = Embedding::round(center, apse.facets.max(2) as usize, [90.0, 270.0]);
        let facets = apse.facets.max(2);
        let (outer, inner) = (apse.radius * MODULE, (apse.radius - OUTER) * MODULE);
        let ring = |r: [i32; 2], u: [i32; 2]| Rect { lo: [r[0], u[0]], hi: [r[1], u[1]] };
        let all = ring([0, outer], [0, facets]);
        self.draft.begin_sheet(embedding, all);
        for k in 0..first.storeys.len() {
            self.draft.storey(&storey_name(k));
            let z = k as i32 * STOREY * MODULE;
            let heights = [z, z + CLEAR * MODULE];
            self.slab(&format!("Apse slab {k}"), all, z);
            let wall = self.wall(&format!("Apse wall {k}"), true);
            self.draft.paint(wall, upright(ring([inner, outer], [0, facets]), heights));
            let name = self.room_name(k, Use::Conference);
            let room = self.space(&name, Use::Conference);
            self.draft.paint(room, upright(ring([0, inner], [0, facets]), heights));
            for facet in (1..facets - 1).step_by(2) {
                let sill = [z + 9 * MODULE, z + 23 * MODULE];
                self.round_window(&format!("Apse window {facet}.{k}"), wall, [inner, outer], facet, sill);
            }
            // The largest square within, less its corners.
            let half = inner * 6 / 10;
            let [x, y] = center;
            let rects = vec![Rect { lo: [x - half, y - half], hi: [x - 2, y + half] }];
            let clear = vec![Rect { lo: [x - 12 * MODULE, y - 10 * MODULE], hi: [x, y + 10 * MODULE] }];
            let use_ = Use::Conference;
            let (solids, windows) = (Vec::new(), Vec::new());
            let furnished = Furnished { name: &name, use_, rects, solids, clear, windows, heights };
            self.draft.in_world(true);
            self.furnish(&furnished);
            self.draft.in_world(false);
        }
        let top = first.top();
        let slab = self.roof_slab("Apse roof slab");
        self.draft.paint(slab, upright(all, [top - SLAB * MODULE, top]));
        let roof = self.roof("Apse roof");
        self.draft.paint(roof, upright(all, [top, top + MODULE]));
    }

    /// A window as wide as a facet of a round wall.
    pub(super) fn round_window(
        &mut self,
        name: &str,
        wall: u32,
        [inner, outer]: [i32; 2],
        facet: i32,
        [z0, z1]: [i32; 2],
    ) {
        let opening = self.draft.element(
            Kind::Opening,
            Semantic::Window,
            "IfcOpeningElement",
            &format!("{name} opening"),
        );
        let look = Look { floor: palette::STONE, ceiling: palette::PLASTER, ..Look::default() };
        self.draft.look(opening, look);
        let part = |r: [i32; 2], z: [i32; 2]| upright(Rect { lo: [r[0], facet], hi: [r[1], facet + 1] }, z);
        self.draft.paint(opening, part([inner, outer], [z0, z1]));
        let window = self.draft.element(Kind::Detail, Semantic::WindowFrame, "IfcWindow", name);
        let middle = (inner + outer) / 2;
        let rail = 72;
        let frame = [[z0, z0 + rail], [z1 - rail, z1]].map(|z| part([middle - 36, middle + 36], z));
        let paints = frame.map(|cuboid| (cuboid, Some(palette::WHITE_PAINT)).into());
        self.draft.detail_of(window, &paints, z0);
        let pane = part([middle - 10, middle + 10], [z0 + rail, z1 - rail]);
        self.draft.detail_of(window, &[(pane, Some(palette::GLASS)).into()], z0 + rail);
        self.draft.fill(wall, opening, Some(window));
    }
}
