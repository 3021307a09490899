//! How many faces a piece shows, before it stands anywhere.

use crate::generate::lattice::Cuboid;

/// Faces of a piece: planar polygons of one material, as large as they can be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faces {
    /// All of them.
    pub all: u32,
    /// Those in the planes of the sides of the box around it that look out of it: to -u, -v, -z, +u, +v, +z.
    pub outermost: [[u32; 3]; 2],
}

/// The faces of boxes painted one over the other, with their materials; `None` takes away.
pub fn faces(boxes: &[(Cuboid, Option<u32>)]) -> Faces {
    let cuts = [0, 1, 2].map(|axis| {
        let mut cuts: Vec<i32> = boxes.iter().flat_map(|(c, _)| [c.lo[axis], c.hi[axis]]).collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    });
    let size = [0, 1, 2].map(|axis| cuts[axis].len().saturating_sub(1));
    let cell = |at: [usize; 3]| (at[2] * size[1] + at[1]) * size[0] + at[0];
    let mut labels: Vec<Option<u32>> = vec![None; size.iter().product()];
    for (cuboid, label) in boxes.iter().filter(|(cuboid, _)| !cuboid.is_empty()) {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let index = |c: i32| cuts[axis].partition_point(|&cut| cut < c);
            index(cuboid.lo[axis])..index(cuboid.hi[axis])
        });
        for k in z {
            for j in y.clone() {
                labels[cell([x.start, j, k])..cell([x.end, j, k])].fill(*label);
            }
        }
    }
    let mut found = Faces::default();
    for axis in 0..3 {
        let [across, up] = [(axis + 1) % 3, (axis + 2) % 3];
        let at = |layer: usize, a: usize, b: usize| {
            let mut at = [0; 3];
            (at[axis], at[across], at[up]) = (layer, a, b);
            labels[cell(at)]
        };
        let matter = (0..size[axis])
            .filter(|&layer| (0..size[across]).any(|a| (0..size[up]).any(|b| at(layer, a, b).is_some())));
        let ends = [matter.clone().min(), matter.max()];
        for layer in 0..size[axis] {
            for side in 0..2 {
                let beyond = if side == 0 { layer.checked_sub(1) } else { Some(layer + 1) };
                let beyond = beyond.filter(|&l| l < size[axis]);
                let shown = |a: usize, b: usize| {
                    at(layer, a, b).filter(|_| beyond.is_none_or(|l| at(l, a, b).is_none()))
                };
                let count = patches([size[across], size[up]], shown);
                found.all += count;
                if ends[side] == Some(layer) {
                    found.outermost[side][axis] += count;
                }
            }
        }
    }
    found
}

/// How many connected pieces of one label each a grid has.
fn patches([wide, high]: [usize; 2], label: impl Fn(usize, usize) -> Option<u32>) -> u32 {
    let mut open: Vec<Option<u32>> = (0..wide * high).map(|i| label(i % wide, i / wide)).collect();
    let mut count = 0;
    for first in 0..open.len() {
        let Some(label) = open[first].take() else { continue };
        count += 1;
        let mut reached = vec![first];
        while let Some(i) = reached.pop() {
            let (a, b) = (i % wide, i / wide);
            let beside = [
                (a > 0, i.wrapping_sub(1)),
                (a + 1 < wide, i + 1),
                (b > 0, i.wrapping_sub(wide)),
                (b + 1 < high, i + wide),
            ];
            for (exists, next) in beside {
                if exists && open[next] == Some(label) {
                    open[next] = None;
                    reached.push(next);
                }
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_shows_fourteen_faces_and_four_feet() {
        let table = crate::generate::furniture::table([1.2, 0.8, 0.75], 0);
        let found = faces(&table.boxes);
        // The top's edges and the legs' outer sides are four faces; eight inner sides of legs; top; underside; feet.
        assert_eq!(found.all, 4 + 8 + 1 + 1 + 4);
        assert_eq!(found.outermost, [[1, 1, 4], [1, 1, 1]]);
    }

    #[test]
    fn nothing_shows_nothing() {
        assert_eq!(faces(&[]), Faces::default());
        let cuboid = Cuboid { lo: [0; 3], hi: [4; 3] };
        assert_eq!(faces(&[(cuboid, Some(1)), (cuboid, None)]), Faces::default());
    }
}
