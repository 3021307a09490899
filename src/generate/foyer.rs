//! Ways from the main wing to others, and foyers between them.

use super::complex::{CLEAR, Foyer, MODULE, PARAPET, SLAB, STOREY};
use super::drawing::{Drawing, Floor, storey_name, upright};
use super::holes::Filling;
use super::lattice::Rect;
use super::uses::Use;
use super::wing::OUTER;

impl Drawing<'_> {
    /// Passages from the first wing to those that stand against its north facade.
    pub(super) fn ways(&mut self, floor: &Floor<'_>, walls: &[u32]) {
        let Some(north) = floor.plan.walls.iter().position(|wall| wall.name == "Outer wall north") else {
            return;
        };
        for (i, &[west, east]) in self.complex.ways.iter().enumerate() {
            let [_, south, _, north_side] = floor.plan.walls[north].rect.map(|c| c * MODULE);
            let rect = Rect { lo: [west, south], hi: [east, north_side] };
            let space = upright(rect, [floor.z, floor.z + 23 * MODULE]);
            self.pierce(&floor.name(&format!("Way {}", i + 1)), space, 0, Filling::Nothing, walls[north]);
        }
    }

    /// The floor in front of ways between wings.
    pub(super) fn clear_of_ways(&self, floor: &Floor<'_>) -> Vec<Rect> {
        let [_, depth] = floor.placed.size();
        let before = 12 * floor.placed.module();
        if floor.placed.origin == [0, 0] {
            let inside = depth - OUTER * MODULE;
            let way = |&[west, east]: &[i32; 2]| Rect { lo: [west, inside - before], hi: [east, inside] };
            return self.complex.ways.iter().map(way).collect();
        }
        let [south, north] = floor.wing.corridor_rows().map(|m| m * floor.placed.module());
        vec![Rect { lo: [0, south], hi: [before, north] }]
    }

    pub(super) fn foyer(&mut self, foyer: &Foyer) {
        let (Some(first), Some(wing)) = (self.complex.wings.first(), self.complex.wings.get(foyer.wing))
        else {
            return;
        };
        let facade = first.size()[1];
        let [_, depth] = wing.size();
        let (near, far) = (wing.origin, wing.place([0, depth]));
        let far_inside = wing.place([0, depth - OUTER * wing.module()]);
        let (west, west_inside) = ([foyer.west, facade], [foyer.west + 2 * OUTER * MODULE, facade]);
        let (inside, wall_outline) = ([west_inside, near, far_inside], [west, west_inside, far_inside, far]);
        let storeys = first.storeys.len().min(wing.storeys.len());
        let (mut room_layers, mut wall_layers) = (Vec::new(), Vec::new());
        for k in 0..storeys {
            self.draft.storey(&storey_name(k));
            let z = k as i32 * STOREY * MODULE;
            let heights = [z, z + CLEAR * MODULE];
            let slab = self.slab_without_extent(&format!("{} foyer slab {k}", wing.name), z);
            let wall = self.wall(&format!("{} foyer wall {k}", wing.name), true);
            let name = self.room_name(k, Use::Corridor);
            let room = self.space(&name, Use::Corridor);
            let below = ([z - SLAB * MODULE, z], slab);
            room_layers.extend([below, (heights, room)]);
            wall_layers.extend([below, (heights, wall)]);
            // Where its middle is, hangs its lamp.
            let middle = [0, 1].map(|axis| inside.iter().map(|p| p[axis]).sum::<i32>() / 3);
            let lamps = self.lights.next().unwrap_or(1);
            self.draft.in_world(true);
            for i in 0..lamps {
                let at = [middle[0] + i as i32 * 4 * MODULE, middle[1], heights[1]];
                self.lamp(&format!("{name} {}", i + 1), at);
            }
            self.draft.in_world(false);
        }
        let top = storeys as i32 * STOREY * MODULE;
        let slab = self.roof_slab(&format!("{} foyer roof slab", wing.name));
        let roof = self.roof(&format!("{} foyer roof", wing.name));
        // As high as the parapets around: else these would touch in a line, between air on both sides.
        let above = [([top - SLAB * MODULE, top], slab), ([top, top + PARAPET * MODULE], roof)];
        room_layers.extend(above);
        wall_layers.extend(above);
        self.draft.region(&inside, &room_layers);
        self.draft.region(&wall_outline, &wall_layers);
    }
}
