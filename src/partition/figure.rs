//! A picture of the cells that a level plane cuts, as SVG.

use std::fmt::Write;

use enfilade_importers::{Model, Semantic};

use super::cells::{Cell, Label, Partition};
use super::kind;
use crate::lattice::{FINE, Point};

/// Draws the cells of `model` at height `z` (metres, internal frame), north up; one user unit is a metre. Tooltips name
/// the elements.
pub fn svg(partition: &Partition, model: &Model, z: f64) -> String {
    let lattice = &partition.lattice;
    let place = |p: Point| lattice.metres([f64::from(p.x), f64::from(p.y), 0.0]);
    let [lo, hi] = partition.hull;
    let corners = [[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]];
    let corners = corners.map(|[x, y]| place(Point::new(x, y)));
    let least = |axis: usize| corners.iter().fold(f64::INFINITY, |least, c| least.min(c[axis]));
    let most = |axis: usize| corners.iter().fold(f64::NEG_INFINITY, |most, c| most.max(c[axis]));
    let (left, top) = (least(0), most(1));
    let (width, height) = (most(0) - left, top - least(1));
    let mut svg = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.3} {height:.3}\" width=\"{:.0}\">",
        (width * 40.0).clamp(480.0, 1600.0)
    );
    let _ = writeln!(svg, "<g stroke=\"#555\" stroke-width=\"0.015\" stroke-linejoin=\"round\">");
    let level = lattice.steps(z - lattice.origin[2]);
    for cell in &partition.cells {
        if !is_cut(partition, cell, level) {
            continue;
        }
        let mut path = String::new();
        for (i, p) in partition.footprint(cell).enumerate() {
            let [x, y, _] = place(p);
            let (x, y) = (x - left, top - y);
            let _ = write!(path, "{}{x:.3} {y:.3}", if i == 0 { "M" } else { " L" });
        }
        let _ = writeln!(
            svg,
            "<path d=\"{path} Z\" fill=\"{}\"><title>{}</title></path>",
            fill(cell.label, model),
            escape(name(cell.label, model))
        );
    }
    svg.push_str("</g>\n</svg>\n");
    svg
}

/// How high above the floor of the largest room a plan is cut, metres.
const ABOVE_FLOOR: f64 = 1.2;

/// A height at which [`svg`] shows much: above the floor of the room with the largest box in the plan, the first of
/// equals; without rooms above the lowest point. Metres, internal frame.
pub fn usual_height(model: &Model) -> f64 {
    let rooms = model.elements.iter().filter(|element| element.semantic == Semantic::Room);
    let boxes = rooms.filter_map(|room| {
        let corners = room.mesh.positions.iter().map(|&p| [p; 2]);
        corners.reduce(|[lo, hi], [p, _]| {
            [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
        })
    });
    let largest = boxes.reduce(|best, next| {
        let area = |[lo, hi]: [[f64; 3]; 2]| (hi[0] - lo[0]) * (hi[1] - lo[1]);
        if area(next) > area(best) { next } else { best }
    });
    ABOVE_FLOOR + largest.or(model.bounds()).map_or(0.0, |[lo, _]| lo[2])
}

/// Whether a level plane cuts the cell over the middle of its footprint's corners.
fn is_cut(partition: &Partition, cell: &Cell, level: f64) -> bool {
    let points = partition.footprint(cell);
    let count = points.len() as f64;
    let (x, y) =
        points.fold((0.0, 0.0), |(x, y), p| (x + f64::from(p.x) / count, y + f64::from(p.y) / count));
    let height = |plane: u32| {
        let plane = &partition.planes[plane as usize];
        (plane.p as f64 * x + plane.q as f64 * y + plane.r as f64) / FINE as f64
    };
    height(cell.floor) <= level && level < height(cell.ceiling)
}

/// Colours: matter dark, rooms in pale hues of their own, openings white, the exterior nearly so, void red.
fn fill(label: Label, model: &Model) -> String {
    match (kind(label, model), label) {
        ("solid", _) => "#6b6b6b".to_owned(),
        ("exterior", _) => "#eef3f7".to_owned(),
        ("opening", _) => "#ffffff".to_owned(),
        ("room", Label::Air(element)) => {
            // Hues as far apart as the golden angle puts them.
            let hue = (f64::from(element.0) * 137.508) % 360.0;
            format!("hsl({hue:.0}, 60%, 82%)")
        }
        _ => "#e89090".to_owned(),
    }
}

fn name(label: Label, model: &Model) -> &str {
    match label {
        Label::Air(element) | Label::Solid(element) => &model.elements[element.0 as usize].name,
        Label::Exterior => "exterior",
        Label::Void => "void",
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
