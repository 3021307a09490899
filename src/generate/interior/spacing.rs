//! How groups stand in rows and columns.

use super::Rect;

/// At most so many places of a field are tried.
const MOST_PLACES: i32 = 1500;

/// Rows and columns of groups; units.
#[derive(Clone, Copy, Debug)]
pub struct Spacing {
    /// At least between neighbours along the groups' u and v.
    pub gap: [i32; 2],
    /// To the edges of the free floor.
    pub margin: i32,
    /// Whether the groups stand as near as they may, in the rows that are furthest to their front, as an audience
    /// does; else they spread over the floor.
    pub is_audience: bool,
}

impl Spacing {
    /// Groups spread over the floor.
    pub fn spread(gap: [i32; 2], margin: i32) -> Spacing {
        Spacing { gap, margin, is_audience: false }
    }

    /// Corners with the least coordinates for up to `enough` groups of a size in a rectangle that has room for `fit`
    /// of them on each axis, best first; a few more, as some may be taken.
    pub fn places(
        &self,
        rect: &Rect,
        size: [i32; 2],
        gap: [i32; 2],
        fit: [i32; 2],
        turns: u8,
        enough: u32,
    ) -> Vec<[i32; 2]> {
        let fit = fit.map(|n| n.clamp(0, MOST_PLACES));
        let enough = i32::try_from(enough).unwrap_or(i32::MAX).min(MOST_PLACES);
        let number = if self.is_audience { fit } else { thinned(rect.size(), fit, enough) };
        if number[0] == 0 || number[1] == 0 {
            return Vec::new();
        }
        let along = |axis: usize, i: i32| {
            let n = number[axis];
            let left = rect.size()[axis] - n * size[axis];
            let between = if self.is_audience { gap[axis] } else { (left / n).max(gap[axis]) };
            let before = (left - between * (n - 1)) / 2;
            rect.lo[axis] + before + i * (size[axis] + between)
        };
        // The groups look to +y, -x, -y, +x.
        let depth = if turns.is_multiple_of(2) { 1 } else { 0 };
        let from_high = turns == 0 || turns == 3;
        let mut places = Vec::new();
        for row in 0..number[depth] {
            let row = if from_high { number[depth] - 1 - row } else { row };
            let mut columns: Vec<i32> = (0..number[1 - depth]).collect();
            let middle = number[1 - depth] - 1;
            columns.sort_by_key(|&i| ((2 * i - middle).abs(), i));
            for column in columns {
                if places.len() >= MOST_PLACES as usize {
                    return places;
                }
                let mut at = [0; 2];
                at[depth] = along(depth, row);
                at[1 - depth] = along(1 - depth, column);
                if self.is_audience {
                    // No rows are left free before the first one.
                    let left =
                        rect.size()[depth] - number[depth] * size[depth] - gap[depth] * (number[depth] - 1);
                    at[depth] += if from_high { left / 2 } else { -(left / 2) };
                }
                places.push(at);
            }
        }
        places
    }
}

/// The fewest rows and columns, of those that fit, that make up `enough`, as far apart along as across.
fn thinned(size: [i32; 2], fit: [i32; 2], enough: i32) -> [i32; 2] {
    let mut best: Option<(i64, [i32; 2])> = None;
    for columns in 1..=fit[0] {
        let rows = ((enough + columns - 1) / columns).clamp(1, fit[1].max(1)).min(fit[1]);
        if rows == 0 {
            continue;
        }
        let missing = i64::from((enough - rows * columns).max(0));
        let over = i64::from((rows * columns - enough).max(0));
        let pitch = [size[0] / columns, size[1] / rows];
        let uneven = i64::from((pitch[0] - pitch[1]).abs());
        // One too many or too few is worth two metres of unevenness.
        let cost = uneven + (missing * 4 + over) * 2048;
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, [columns, rows]));
        }
    }
    best.map_or([0, 0], |(_, number)| number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_groups_spread_and_audiences_do_not() {
        let rect = Rect { lo: [0, 0], hi: [1000, 500] };
        let spread = Spacing::spread([10, 10], 0);
        let two = spread.places(&rect, [100, 100], [10, 10], [9, 4], 0, 2);
        assert_eq!(two, [[200, 200], [700, 200]]);
        let audience = Spacing { is_audience: true, ..spread };
        // They look to the north: the middle of the northernmost row comes first.
        let seats = audience.places(&rect, [100, 100], [10, 10], [9, 4], 0, 2);
        assert_eq!((seats.len(), seats[0]), (36, [450, 400]));
        assert_eq!(audience.places(&rect, [100, 100], [10, 10], [9, 4], 2, 2)[0], [450, 0]);
        assert_eq!(audience.places(&rect, [100, 100], [10, 10], [9, 4], 1, 2)[0][0], 0);
        assert!(spread.places(&rect, [1001, 1], [1, 1], [0, 250], 0, 3).is_empty());
    }

    #[test]
    fn rows_and_columns_make_up_what_is_wanted() {
        assert_eq!(thinned([100, 100], [5, 5], 4), [2, 2]);
        assert_eq!(thinned([100, 10_000], [5, 5], 3), [1, 3]);
        assert_eq!(thinned([100, 100], [2, 2], 100), [2, 2]);
        assert_eq!(thinned([100, 100], [0, 2], 3), [0, 0]);
    }
}
