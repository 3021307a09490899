//! The sheet: what is drawn of a storey, in which colours, and what stands around it.

use std::collections::BTreeMap;

use enfilade_importers::{Semantic, UpAxis};

use super::cut::{self, CutCell};
use super::drawing::{Anchor, Color, Drawing, Shape};
use super::storeys::PlanStorey;
use crate::format::records::CellRecord;
use crate::scene::Scene;
use crate::trace::{NONE, Prisms};

/// How to draw.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// How high above the storey's floor the plane is, metres. Default: 1.2.
    pub height: f64,
    /// Whether to draw the portals between cells, thin and blue. Default: no.
    pub cells: bool,
    /// Whether to draw furniture, door leaves and what else is detail. Default: yes.
    pub detail: bool,
    /// What to mark.
    pub marks: Vec<Mark>,
}

impl Default for PlanOptions {
    fn default() -> PlanOptions {
        PlanOptions { height: 1.2, cells: false, detail: true, marks: Vec::new() }
    }
}

/// Something to be marked: a finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Where it is, internal frame.
    pub at: [f64; 3],
    /// What it is about, for the legend: an element's name. Marks of one name in one place are one.
    pub of: String,
    /// What it is, for the legend.
    pub text: String,
}

const INK: Color = [38, 38, 38];
const WALL: Color = [72, 72, 76];
const DETAIL: Color = [150, 150, 150];
const DOOR: Color = [222, 184, 135];
const WINDOW: Color = [173, 216, 240];
const OPENING: Color = [245, 245, 245];
const VOID: Color = [236, 200, 200];
const CELLS: Color = [70, 110, 200];
const FINDING: Color = [200, 30, 30];

/// Space around what is drawn, metres.
const MARGIN: f64 = 1.0;

/// What a level plane through a storey cuts, as a drawing.
pub fn floor_plan(scene: &Scene, storey: &PlanStorey, options: &PlanOptions) -> Drawing {
    let z = storey.floor + options.height;
    let prisms = Prisms::new(&scene.tables);
    let cells = cut::cells(&prisms, z);
    let record = |cut: &CutCell| &prisms.cells[cut.cell as usize];
    let mut drawing = Drawing { bounds: around(&cells, &prisms, scene), shapes: Vec::new() };
    let mut rooms: BTreeMap<u32, Vec<&CutCell>> = BTreeMap::new();
    let mut openings: BTreeMap<u32, Vec<&CutCell>> = BTreeMap::new();
    let (mut walls, mut voids): (BTreeMap<u32, Vec<&CutCell>>, Vec<&CutCell>) = (BTreeMap::new(), Vec::new());
    for cell in &cells {
        let CellRecord { kind, semantic, element, room, .. } = *record(cell);
        match Semantic::from_number(semantic.into()).unwrap_or_default() {
            _ if kind == CellRecord::SOLID => walls.entry(element).or_default().push(cell),
            Semantic::Door | Semantic::Window | Semantic::Opening => {
                openings.entry(element).or_default().push(cell)
            }
            Semantic::Void => voids.push(cell),
            Semantic::Exterior => {}
            _ if room != NONE => rooms.entry(room).or_default().push(cell),
            _ => {}
        }
    }
    let polygons = |cells: &[&CutCell]| cells.iter().map(|cell| cell.polygon.clone()).collect();
    let area = |cells: &[&CutCell], fill: Color, seam: f64, title: &str| Shape::Area {
        polygons: polygons(cells),
        fill,
        stroke: Some((fill, seam)),
        title: title.to_owned(),
    };
    let named = |element: u32| if element == NONE { String::new() } else { name(scene, element) };
    drawing.shapes.extend(walls.iter().map(|(element, cells)| area(cells, WALL, 0.012, &named(*element))));
    if !voids.is_empty() {
        drawing.shapes.push(area(&voids, VOID, 0.004, "void"));
    }
    for (room, cells) in &rooms {
        drawing.shapes.push(area(cells, tint(*room), 0.004, &named(scene.room(*room).element().index())));
    }
    for (element, cells) in &openings {
        let fill = match scene.element(*element).semantic() {
            Semantic::Door => DOOR,
            Semantic::Window => WINDOW,
            _ => OPENING,
        };
        drawing.shapes.push(area(cells, fill, 0.004, &named(*element)));
    }
    if options.detail {
        drawing.shapes.push(Shape::Lines { lines: cut::detail(scene, z), color: DETAIL, width: 0.008 });
    }
    if options.cells {
        let lines = cut::borders(&prisms, &cells, z, |_, beyond| beyond.kind == CellRecord::AIR);
        drawing.shapes.push(Shape::Lines { lines, color: CELLS, width: 0.01 });
    }
    let lines = cut::borders(&prisms, &cells, z, |_, beyond| beyond.kind == CellRecord::SOLID);
    drawing.shapes.push(Shape::Lines { lines, color: INK, width: 0.025 });
    for (room, cells) in &rooms {
        label(&mut drawing, scene, *room, cells);
    }
    let legend = mark(&mut drawing, options, storey);
    frame(&mut drawing, scene, storey, options, &legend);
    drawing
}

fn name(scene: &Scene, element: u32) -> String {
    let element = scene.element(element);
    if element.name().is_empty() { element.id().to_owned() } else { element.name().to_owned() }
}

/// Pale, and of hues as far apart as the golden angle puts them.
fn tint(room: u32) -> Color {
    let hue = f64::from(room) * 137.508 % 360.0 / 60.0;
    // Of lightness 0.87 and saturation 0.55.
    let (chroma, light) = (0.143, 0.87);
    let second = chroma * (1.0 - (hue % 2.0 - 1.0).abs());
    let [r, g, b] = match hue as u32 {
        0 => [chroma, second, 0.0],
        1 => [second, chroma, 0.0],
        2 => [0.0, chroma, second],
        3 => [0.0, second, chroma],
        4 => [second, 0.0, chroma],
        _ => [chroma, 0.0, second],
    };
    [r, g, b].map(|c| ((c + light - chroma / 2.0) * 255.0).round() as u8)
}

/// The sheet around what is not the open.
fn around(cells: &[CutCell], prisms: &Prisms<'_>, scene: &Scene) -> [[f64; 2]; 2] {
    let is_shown = |cell: &&CutCell| {
        let record = &prisms.cells[cell.cell as usize];
        record.kind == CellRecord::SOLID
            || Semantic::from_number(record.semantic.into()) != Some(Semantic::Exterior)
    };
    let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for p in cells.iter().filter(is_shown).flat_map(|cell| &cell.polygon) {
        for axis in 0..2 {
            bounds[0][axis] = bounds[0][axis].min(p[axis]);
            bounds[1][axis] = bounds[1][axis].max(p[axis]);
        }
    }
    if bounds[0][0] > bounds[1][0] {
        let [lo, hi] = scene.hull();
        bounds = [[lo[0], lo[1]], [hi[0], hi[1]]];
    }
    [bounds[0].map(|c| c - MARGIN), bounds[1].map(|c| c + MARGIN)]
}

/// Writes a room's name and area where there is most place: in its largest cell.
fn label(drawing: &mut Drawing, scene: &Scene, room: u32, cells: &[&CutCell]) {
    let Some(cell) = cells.iter().max_by(|a, b| size(&a.polygon).total_cmp(&size(&b.polygon))) else {
        return;
    };
    let [x, y] = centroid(&cell.polygon);
    let view = scene.room(room);
    let name = name(scene, view.element().index());
    let area = view.floor_area().map_or(String::new(), |area| format!("{area:.1} m\u{b2}"));
    let longest = name.chars().count().max(area.chars().count()).max(4) as f64;
    let width = extent(&cell.polygon, 0);
    let height = extent(&cell.polygon, 1);
    // A letter is some 0.6 of its height wide.
    let size = (0.9 * width / (0.6 * longest)).min(height / 2.8).clamp(0.12, 0.38);
    let text = |text: String, y: f64, size: f64| Shape::Text {
        at: [x, y],
        size,
        anchor: Anchor::Middle,
        color: INK,
        text,
    };
    drawing.shapes.push(text(name, y + 0.1 * size, size));
    if !area.is_empty() {
        drawing.shapes.push(text(area, y - 1.05 * size, 0.85 * size));
    }
}

fn extent(polygon: &[[f64; 2]], axis: usize) -> f64 {
    let (lo, hi) = polygon
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| (lo.min(p[axis]), hi.max(p[axis])));
    hi - lo
}

/// Twice the area.
fn size(polygon: &[[f64; 2]]) -> f64 {
    moments(polygon)[0]
}

fn centroid(polygon: &[[f64; 2]]) -> [f64; 2] {
    let [area, x, y] = moments(polygon);
    let first = polygon.first().copied().unwrap_or_default();
    if area == 0.0 { first } else { [first[0] + x / (3.0 * area), first[1] + y / (3.0 * area)] }
}

fn moments(polygon: &[[f64; 2]]) -> [f64; 3] {
    let first = polygon.first().copied().unwrap_or_default();
    polygon.windows(2).fold([0.0; 3], |[area, x, y], pair| {
        let [a, b] = [pair[0], pair[1]].map(|p| [p[0] - first[0], p[1] - first[1]]);
        let cross = a[0] * b[1] - a[1] * b[0];
        [area + cross, x + cross * (a[0] + b[0]), y + cross * (a[1] + b[1])]
    })
}

/// Draws the marks of a storey; returns the lines of the legend.
fn mark(drawing: &mut Drawing, options: &PlanOptions, storey: &PlanStorey) -> Vec<String> {
    let here =
        options.marks.iter().filter(|mark| mark.at[2] >= storey.floor - 0.5 && mark.at[2] < storey.top + 0.2);
    let mut groups: Vec<Vec<&Mark>> = Vec::new();
    for mark in here {
        let is_same = |group: &&mut Vec<&Mark>| {
            let [x, y, _] = group[0].at;
            group[0].of == mark.of && (x - mark.at[0]).hypot(y - mark.at[1]) < APART
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push(mark),
            None => groups.push(vec![mark]),
        }
    }
    let labels: Vec<[f64; 2]> = drawing
        .shapes
        .iter()
        .filter_map(|shape| if let Shape::Text { at, .. } = shape { Some(*at) } else { None })
        .collect();
    let mut legend = Vec::new();
    for (group, number) in groups.iter().zip(1..) {
        let [x, mut y, _] = group[0].at;
        // Not over a room's name.
        if labels.iter().any(|at| (at[0] - x).abs() < 2.0 * APART && (at[1] - y).abs() < APART) {
            y += 2.0 * APART;
        }
        let around = |i: i32| f64::from(i) / 24.0 * std::f64::consts::TAU;
        let ring = (0..=24).map(|i| [x + 0.2 * around(i).cos(), y + 0.2 * around(i).sin()]).collect();
        drawing.shapes.push(Shape::Lines { lines: vec![ring], color: FINDING, width: 0.035 });
        let text = number.to_string();
        drawing.shapes.push(Shape::Text {
            at: [x + 0.26, y + 0.08],
            size: 0.24,
            anchor: Anchor::Start,
            color: FINDING,
            text,
        });
        let texts: Vec<&str> = group.iter().map(|mark| mark.text.as_str()).collect();
        legend.push(format!("{number} {}: {}", group[0].of, texts.join("; ")));
    }
    legend
}

/// Marks and names nearer to each other than this would lie over each other, metres.
const APART: f64 = 0.45;

/// Lines of the legend that are written; of more only how many.
const LEGEND: usize = 30;

/// Adds the title, a scale bar, the north and the legend, and makes place for them.
fn frame(
    drawing: &mut Drawing,
    scene: &Scene,
    storey: &PlanStorey,
    options: &PlanOptions,
    legend: &[String],
) {
    let [lo, hi] = drawing.bounds;
    let width = hi[0] - lo[0];
    let letter = (width / 50.0).clamp(0.25, 1.5);
    let left = lo[0] + MARGIN / 2.0;
    let mut text = |at: [f64; 2], size: f64, color: Color, text: String| {
        drawing.shapes.push(Shape::Text { at, size, anchor: Anchor::Start, color, text });
    };
    let title = if storey.name.is_empty() { "Floor plan".to_owned() } else { storey.name.clone() };
    let unit = scene.frame().length_to_source(1.0);
    let [_, _, z] = [0.0, 0.0, storey.floor + options.height];
    let up = if scene.frame().up == UpAxis::Y { "y" } else { "z" };
    let level = (z + scene.frame().offset[2]) * unit;
    text([left, hi[1] + 0.5 * letter], letter, INK, format!("{title}, cut at {up} = {level:.2}"));
    // The scale bar: a fifth of the sheet, in whole steps of 1, 2, 5, 10...
    let steps = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
    let step = steps.into_iter().rfind(|step| *step <= width / 5.0).unwrap_or(steps[0]);
    let y = lo[1] - 0.6 * letter;
    text(
        [left + 2.0 * step + 0.4 * letter, y - 0.1 * letter],
        0.8 * letter,
        INK,
        format!("{} m", 2.0 * step),
    );
    let mut y_legend = y - 1.6 * letter;
    for line in legend.iter().take(LEGEND) {
        text([left, y_legend], 0.6 * letter, FINDING, line.clone());
        y_legend -= 0.85 * letter;
    }
    if legend.len() > LEGEND {
        text([left, y_legend], 0.6 * letter, FINDING, format!("and {} more", legend.len() - LEGEND));
        y_legend -= 0.85 * letter;
    }
    let box_from =
        |x: f64| vec![vec![[x, y], [x + step, y], [x + step, y + 0.25 * letter], [x, y + 0.25 * letter]]];
    let bar = |x: f64, fill: Color| Shape::Area {
        polygons: box_from(x),
        fill,
        stroke: Some((INK, 0.02)),
        title: String::new(),
    };
    drawing.shapes.extend([bar(left, INK), bar(left + step, [255, 255, 255])]);
    // North: what is up in the plan, by the source's own axis.
    let (x, top) = (hi[0] - MARGIN / 2.0 - 0.5 * letter, hi[1] + 1.6 * letter);
    let arrow = vec![vec![
        [x, top],
        [x - 0.35 * letter, top - 1.2 * letter],
        [x, top - 0.9 * letter],
        [x + 0.35 * letter, top - 1.2 * letter],
    ]];
    drawing.shapes.push(Shape::Area { polygons: arrow, fill: INK, stroke: None, title: "north".to_owned() });
    let axis = if scene.frame().up == UpAxis::Y { "N (-z)" } else { "N (+y)" };
    drawing.shapes.push(Shape::Text {
        at: [x - 3.4 * letter, top - 1.1 * letter],
        size: 0.7 * letter,
        anchor: Anchor::Start,
        color: INK,
        text: axis.to_owned(),
    });
    drawing.bounds = [[lo[0], y_legend.min(y - letter)], [hi[0], top + 0.5 * letter]];
}
