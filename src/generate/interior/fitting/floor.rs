//! Where things fit away from the walls.

use super::super::Rect;
use super::super::group::{Group, corner_at};
use super::super::region::Region;
use super::super::spacing::Spacing;
use super::Fitting;

impl Fitting<'_> {
    /// The floor that nothing stands on and nobody needs.
    fn free(&self) -> Region {
        let stands = self.stands.iter().filter(|s| !s.is_hung).map(|s| Rect::under(&s.bounds));
        self.region
            .without(stands.chain(self.used.iter().copied()).chain(self.room.keep_clear.iter().copied()))
    }

    /// Puts a group into the middle of the largest free part of the floor, or near it; turned in one of some ways.
    pub fn in_the_middle(&mut self, group: &Group, turns: &[u8]) -> bool {
        let free = self.free();
        turns.iter().any(|&turns| {
            let size = group.turned_size(turns);
            let Some(rect) = free.largest(|s| s[0] >= size[0] && s[1] >= size[1]) else { return false };
            let room = [0, 1].map(|i| rect.size()[i] - size[i]);
            // The middle, then further and further from it.
            let steps = [4, 3, 5, 2, 6, 1, 7, 0, 8];
            steps.iter().flat_map(|&i| steps.map(|j| (i, j))).any(|(i, j)| {
                let lo = [rect.lo[0] + room[0] / 8 * i, rect.lo[1] + room[1] / 8 * j];
                self.put(group, &corner_at(group.size, lo, turns))
            })
        })
    }

    /// Puts groups in rows and columns into the largest free part of the floor, at least `gap` apart along u and v and
    /// `margin` off its edges, until there are `enough`; how many stand. The first of some turns with which some fit.
    pub fn rows(&mut self, group: &Group, turns: &[u8], spacing: &Spacing, enough: u32) -> u32 {
        let free = self.free();
        let Spacing { gap, margin, .. } = *spacing;
        if enough == 0 {
            return 0;
        }
        for &turns in turns {
            let size = group.turned_size(turns);
            let gap = if turns.is_multiple_of(2) { gap } else { [gap[1], gap[0]] };
            let least = size.map(|s| s + 2 * margin);
            let Some(rect) = free.largest(|s| s[0] >= least[0] && s[1] >= least[1]) else { continue };
            let rect = rect.grown(-margin);
            let fit = [0, 1].map(|i| (rect.size()[i] + gap[i]) / (size[i] + gap[i]));
            let mut count = 0;
            for [x, y] in spacing.places(&rect, size, gap, fit, turns, enough) {
                let place = corner_at(group.size, [x, y], turns);
                count += u32::from(count < enough && self.put(group, &place));
            }
            if count > 0 {
                return count;
            }
        }
        0
    }
}
