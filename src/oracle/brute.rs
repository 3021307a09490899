//! The nearest hit by looking at every triangle.
//!
//! Eight triangles at a time, their corners transposed so that the compiler makes vector code of it, are tested by
//! the same sides as in [`triangle`](super::triangle), in plain f64. That only rules out what is surely missed; what is left
//! goes through the one careful test.

use super::soup::{Best, Nearest, Soup};
use super::triangle::{Line, Size};
use super::vector;
use crate::parallel;
use crate::trace::Ray;

const LANES: usize = 8;

/// Blocks of triangles that stay in the cache while many rays pass.
const BLOCKS: usize = 48;

/// Rays of one job.
const RAYS: usize = 32;

/// Eight triangles: the nine coordinates of their corners, and their sizes.
#[derive(Clone, Copy, Debug)]
struct Block {
    corners: [[f64; LANES]; 9],
    reach: [f64; LANES],
    span: [f64; LANES],
}

/// The soup in blocks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Brute {
    blocks: Vec<Block>,
}

impl Brute {
    pub(crate) fn new(soup: &Soup) -> Brute {
        let blocks = soup
            .corners
            .chunks(LANES)
            .zip(soup.sizes.chunks(LANES))
            .map(|(corners, sizes)| {
                let mut block = Block { corners: [[0.0; LANES]; 9], reach: [0.0; LANES], span: [0.0; LANES] };
                // The last block is filled up by repeating its last triangle; the copies are never looked at.
                for lane in 0..LANES {
                    let from = lane.min(corners.len() - 1);
                    for i in 0..9 {
                        block.corners[i][lane] = corners[from][i / 3][i % 3];
                    }
                    block.reach[lane] = sizes[from].reach;
                    block.span[lane] = sizes[from].span;
                }
                block
            })
            .collect();
        Brute { blocks }
    }

    /// The nearest hits of `rays`.
    pub(crate) fn nearest(&self, soup: &Soup, rays: &[Ray]) -> Vec<Option<Nearest>> {
        let jobs = parallel::map(rays.len().div_ceil(RAYS), |job| {
            let rays = &rays[job * RAYS..rays.len().min((job + 1) * RAYS)];
            let lines: Vec<Option<Line>> = rays.iter().map(Line::new).collect();
            let mut best = vec![Best::NONE; rays.len()];
            for first in (0..self.blocks.len()).step_by(BLOCKS) {
                let last = self.blocks.len().min(first + BLOCKS);
                for ((ray, line), best) in rays.iter().zip(&lines).zip(&mut best) {
                    if let Some(line) = line {
                        self.some_blocks(soup, ray, line, first..last, best);
                    }
                }
            }
            best.into_iter().map(|best| soup.nearest(best)).collect::<Vec<_>>()
        });
        jobs.into_iter().flatten().collect()
    }

    fn some_blocks(
        &self,
        soup: &Soup,
        ray: &Ray,
        line: &Line,
        blocks: std::ops::Range<usize>,
        best: &mut Best,
    ) {
        for number in blocks {
            let missed = self.blocks[number].missed(line);
            if missed == [1; LANES] {
                continue;
            }
            for (lane, &missed) in missed.iter().enumerate() {
                let index = number * LANES + lane;
                if missed == 0 && index < soup.len() {
                    let index = index as u32;
                    if let Some(t) = soup.hit(line, ray, index) {
                        best.offer(t, index);
                    }
                }
            }
        }
    }
}

impl Block {
    /// 1 for each triangle that the line surely misses.
    fn missed(&self, line: &Line) -> [u64; LANES] {
        let mut missed = [0u64; LANES];
        let (o, d) = (line.origin, line.direction);
        let c = &self.corners;
        for lane in 0..LANES {
            let p = [c[0][lane], c[1][lane], c[2][lane]];
            let q = [c[3][lane], c[4][lane], c[5][lane]];
            let r = [c[6][lane], c[7][lane], c[8][lane]];
            let s = vector::dot(d, vector::cross(vector::sub(q, o), vector::sub(r, q)));
            let t = vector::dot(d, vector::cross(vector::sub(r, o), vector::sub(p, r)));
            let u = vector::dot(d, vector::cross(vector::sub(p, o), vector::sub(q, p)));
            let size = Size { reach: self.reach[lane], span: self.span[lane] };
            let error = size.side_error(line.reach);
            let some_right = (s < -error) | (t < -error) | (u < -error);
            let some_left = (s > error) | (t > error) | (u > error);
            missed[lane] = u64::from(some_right & some_left);
        }
        missed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::fixtures::{Shape, model};
    use enfilade_importers::{ElementId, Role, Semantic};

    #[test]
    fn nearest_of_two_boxes_and_ties() {
        let boxes = [
            (Semantic::Wall, Shape::cuboid([0.0; 3], [1.0; 3])),
            (Semantic::Wall, Shape::cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0])),
            (Semantic::Wall, Shape::cuboid([2.0, 0.0, 0.0], [4.0, 1.0, 1.0])),
        ];
        let soup = Soup::new(&model(&boxes), |_| Role::Solid);
        let brute = Brute::new(&soup);
        let rays = [
            Ray::new([-1.0, 0.25, 0.5], [1.0, 0.0, 0.0]),
            Ray::new([1.5, 0.25, 0.5], [1.0, 0.0, 0.0]),
            Ray::segment([1.5, 0.25, 0.5], [2.0, 0.0, 0.0], 0.75, 1.4),
            Ray::segment([1.5, 0.25, 0.5], [2.0, 0.0, 0.0], 0.75, 1.5),
            Ray::new([0.5, 0.25, 5.0], [0.0, 0.0, f64::NAN]),
        ];
        let found = brute.nearest(&soup, &rays);
        let brief: Vec<_> = found.iter().map(|n| n.map(|n| (n.t, n.element.0))).collect();
        assert_eq!(brief, [Some((1.0, 0)), Some((0.5, 1)), None, Some((1.5, 1)), None]);
        assert_eq!(soup.element(11), ElementId(0));
        assert_eq!(soup.element(12), ElementId(1));
    }

    #[test]
    fn air_and_ignored_elements_take_no_part() {
        let shapes = [
            (Semantic::Room, Shape::cuboid([0.0; 3], [1.0; 3])),
            (Semantic::Annotation, Shape::cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0])),
            (Semantic::Furniture, Shape::cuboid([4.0, 0.0, 0.0], [5.0, 1.0, 1.0])),
        ];
        let model = model(&shapes);
        let soup = Soup::new(&model, |e| model.elements[e.0 as usize].semantic.role().unwrap());
        let found = Brute::new(&soup).nearest(&soup, &[Ray::new([-1.0, 0.25, 0.5], [1.0, 0.0, 0.0])]);
        assert_eq!(found[0].map(|n| (n.t, n.element.0)), Some((5.0, 2)));
    }
}
