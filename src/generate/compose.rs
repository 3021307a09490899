//! One plan of several that adjoin, and of the world around them.

use std::collections::{BTreeMap, BTreeSet};

use super::lattice::Rect;
use super::plan::{Column, Layer, Plan};
use super::sides::Sides;

/// The plan of all `pieces`, which do not overlap, and of `layers` over the rest of the rectangle `world`, in which
/// they lie. Where pieces adjoin, an edge of one is cut at the corners that others have on it.
pub fn compose(pieces: Vec<Plan>, world: Rect, bottom: i32, layers: &[Layer]) -> Plan {
    let mut plan = Plan { points: Vec::new(), bottom, columns: Vec::new() };
    let mut numbers: BTreeMap<[i32; 2], u32> = BTreeMap::new();
    for piece in pieces {
        let index: Vec<u32> = piece.points.iter().map(|&p| number(&mut plan, &mut numbers, p)).collect();
        plan.columns.extend(piece.columns.into_iter().map(|column| {
            let edges = column.edges.iter().map(|e| e.map(|i| index[i as usize]));
            // Points that fell together leave edges without length.
            Column { edges: edges.filter(|[u, v]| u != v).collect(), layers: column.layers }
        }));
    }
    let Rect { lo, hi } = world;
    let corners = [lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]].map(|p| number(&mut plan, &mut numbers, p));
    let border = (0..4).map(|i| [corners[i], corners[(i + 1) % 4]]);

    let mut free: BTreeSet<[u32; 2]> = Sides::of(&plan).unmatched().collect();
    let ends: BTreeSet<u32> = free.iter().flatten().copied().chain(corners).collect();
    let cut = |edge: [u32; 2]| split(&plan.points, &ends, edge);
    let border: Vec<[u32; 2]> = border.flat_map(cut).collect();
    let columns: Vec<Column> = plan
        .columns
        .iter()
        .map(|column| {
            let cut = |&edge: &[u32; 2]| if free.contains(&edge) { cut(edge) } else { vec![edge] };
            Column { edges: column.edges.iter().flat_map(cut).collect(), layers: column.layers.clone() }
        })
        .collect();
    plan.columns = columns;

    // What is left: inside the border, outside all pieces.
    free = Sides::of(&plan).unmatched().map(|[u, v]| [v, u]).collect();
    let mut rest: Vec<[u32; 2]> = Vec::new();
    for edge in border {
        // Where a piece reaches the border there is nothing between.
        if !free.remove(&[edge[1], edge[0]]) {
            rest.push(edge);
        }
    }
    rest.extend(free);
    if !rest.is_empty() {
        plan.columns.push(Column { edges: rest, layers: layers.to_vec() });
    }
    plan
}

/// The point's number among the plan's points.
fn number(plan: &mut Plan, numbers: &mut BTreeMap<[i32; 2], u32>, point: [i32; 2]) -> u32 {
    *numbers.entry(point).or_insert_with(|| {
        plan.points.push(point);
        plan.points.len() as u32 - 1
    })
}

/// The edge, cut at all points of `ends` inside it.
fn split(points: &[[i32; 2]], ends: &BTreeSet<u32>, [u, v]: [u32; 2]) -> Vec<[u32; 2]> {
    let [p, q] = [u, v].map(|i| points[i as usize].map(i64::from));
    let along = [q[0] - p[0], q[1] - p[1]];
    let length = along[0] * along[0] + along[1] * along[1];
    let mut inside: Vec<(i64, u32)> = ends
        .iter()
        .filter_map(|&i| {
            let [x, y] = points[i as usize].map(i64::from);
            let to = [x - p[0], y - p[1]];
            let far = along[0] * to[0] + along[1] * to[1];
            (along[0] * to[1] == along[1] * to[0] && far > 0 && far < length).then_some((far, i))
        })
        .collect();
    inside.sort_unstable();
    let chain: Vec<u32> = [u].into_iter().chain(inside.into_iter().map(|(_, i)| i)).chain([v]).collect();
    chain.windows(2).map(|w| [w[0], w[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::lattice::Cuboid;
    use crate::generate::plan::Top;

    fn area(plan: &Plan, column: &Column) -> i64 {
        let at = |i: u32| plan.points[i as usize].map(i64::from);
        column.edges.iter().map(|&[u, v]| at(u)[0] * at(v)[1] - at(u)[1] * at(v)[0]).sum()
    }

    #[test]
    fn the_world_fills_what_is_left() {
        let boxed = |x: i32, y: i32, w: i32, label| {
            Plan::of_boxes(&[(Cuboid { lo: [x, y, 0], hi: [x + w, y + w, 5] }, Some(label))])
        };
        let world = Rect { lo: [0, 0], hi: [20, 20] };
        let air = [Layer { top: Top::Level(9), label: Some(9) }];
        // The second touches half of a side of the first; the third touches the border.
        let plan = compose(vec![boxed(2, 2, 8, 1), boxed(10, 4, 4, 2), boxed(16, 10, 4, 3)], world, 0, &air);
        assert_eq!(plan.columns.len(), 4);
        let areas: Vec<i64> = plan.columns.iter().map(|c| area(&plan, c)).collect();
        assert_eq!(areas, [128, 32, 32, 2 * (400 - 64 - 16 - 16)]);
        assert_eq!(plan.columns[0].edges.len(), 6, "cut where the second begins and ends");
        // Every edge but the border's has its reverse.
        let free: Vec<_> = Sides::of(&plan).unmatched().collect();
        let length = |[u, v]: &[u32; 2]| {
            let [p, q] = [u, v].map(|i| plan.points[*i as usize]);
            (p[0] - q[0]).abs() + (p[1] - q[1]).abs()
        };
        assert_eq!(free.iter().map(length).sum::<i32>(), 80);
    }

    #[test]
    fn a_piece_as_large_as_the_world_leaves_nothing() {
        let world = Rect { lo: [0, 0], hi: [4, 4] };
        let all = Plan::of_boxes(&[(Cuboid { lo: [0; 3], hi: [4; 3] }, Some(1))]);
        assert_eq!(compose(vec![all.clone()], world, 0, &[]).columns.len(), 1);
    }
}
