//! stand-in
use crate::lattice::Point;
#[derive(Clone, Copy)]
pub struct Step {
    pub link: u32,
    pub forward: bool,
}
pub struct Straightened {
    pub vertices: Vec<Point>,
    pub links: Vec<[u32; 2]>,
    pub of: Vec<Option<Step>>,
    pub largest_displacement: f64,
}
pub fn straighten(
    vertices: &[Point],
    links: &[[u32; 2]],
    _class: &[u32],
    _keep: &[bool],
    _tolerance: f64,
) -> Straightened {
    let mut used = vec![false; vertices.len()];
    links.iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut new = vec![u32::MAX; vertices.len()];
    let mut out = Vec::new();
    for v in 0..vertices.len() {
        if used[v] {
            new[v] = out.len() as u32;
            out.push(vertices[v]);
        }
    }
    Straightened {
        vertices: out,
        links: links.iter().map(|l| l.map(|v| new[v as usize])).collect(),
        of: (0..links.len() as u32).map(|link| Some(Step { link, forward: true })).collect(),
        largest_displacement: 0.0,
    }
}
