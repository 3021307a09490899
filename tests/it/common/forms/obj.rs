//! The building as OBJ, in any form that the format has for it.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use enfilade::importers::{ImportOptions, UpAxis};

use super::Written;
use super::algebra::{Content, Point, is_short};
use super::building::{Building, Face, Part};
use enfilade_testing::Random;

/// How a file is written.
#[derive(Clone, Debug)]
pub struct ObjForm {
    /// Metres.
    pub unit: f64,
    pub y_up: bool,
    pub digits: Digits,
    pub names: Names,
    pub vertices: Vertices,
    /// Behind the three numbers of a vertex: nothing, a weight, a colour.
    pub tail: &'static str,
    pub polygons: Polygons,
    /// Indices count from the last vertex.
    pub is_relative: bool,
    pub corners: Corners,
    pub materials: UseMaterial,
    /// The storey's line for each element, not only where it changes.
    pub repeats_storey: bool,
    /// Faces of an element in any order.
    pub is_shuffled: bool,
    /// Last element first.
    pub is_reversed: bool,
    pub text: Text,
    /// For all that is drawn face by face.
    pub seed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// As many as it takes.
    Shortest,
    /// The same with an exponent.
    Exponent,
    /// Six behind the point, as most exporters do.
    Six,
}

/// What the elements are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Names {
    Objects,
    /// Objects, with groups inside.
    ObjectsWithGroups,
    Groups,
    /// Groups of the only object.
    GroupsOfOne,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vertices {
    /// All before the first face; equal ones of all elements once.
    First,
    /// Before each element's faces.
    ByElement,
    /// Before each face.
    ByFace,
}

/// Which faces are written as polygons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Polygons {
    /// None: their triangles are.
    None,
    /// All, from this corner on.
    All(u8),
    /// About half of them, from any corner on.
    Some(u64),
}

#[derive(Clone, Copy, Debug)]
pub enum Corners {
    V,
    Vt,
    Vn,
    Vtn,
    /// Each face as it likes.
    Mixed,
}

#[derive(Clone, Copy, Debug)]
pub enum UseMaterial {
    /// Faces in order of their materials.
    Sorted,
    /// Where it changes.
    Changes,
    /// Before each face.
    Always,
}

#[derive(Clone, Copy, Debug)]
pub struct Text {
    pub end: &'static str,
    pub has_comments: bool,
    /// Lines broken behind a backslash.
    pub is_continued: bool,
    /// More blanks than needed.
    pub is_spaced: bool,
}

/// Writes the building into `folder`.
pub fn write(building: &Building, form: &ObjForm, folder: &Path) -> Written {
    let mut order: Vec<usize> = (0..building.parts.len()).collect();
    if form.is_reversed {
        order.reverse();
    }
    let mut writer = Writer {
        building,
        form,
        content: Content { unit: form.unit, y_up: form.y_up },
        random: Random::new(form.seed),
        cuts: Random::new(if let Polygons::Some(seed) = form.polygons { seed } else { 0 }),
        lines: Vec::new(),
        known: HashMap::new(),
        vertices: 0,
        material: None,
        storey: None,
    };
    writer.all(&order);
    let path = folder.join("a.obj");
    std::fs::write(&path, form.text.lay_out(&writer.lines)).unwrap();
    std::fs::write(folder.join("all colours.mtl"), library(building)).unwrap();
    std::fs::create_dir_all(folder.join("tex")).unwrap();
    std::fs::write(folder.join("tex/tür 1.png"), super::texture()).unwrap();

    let mut options = ImportOptions::default();
    options.unit = Some(form.unit).filter(|unit| *unit != 1.0);
    options.up = Some(if form.y_up { UpAxis::Y } else { UpAxis::Z });
    let bounds = building.parts.iter().map(|part| writer.bound(part)).collect();
    let cut = Some(form.polygons).filter(|polygons| *polygons != Polygons::None);
    Written { path, options, frame: (form.unit, form.y_up), bounds, order, cut }
}

struct Writer<'a> {
    building: &'a Building,
    form: &'a ObjForm,
    content: Content,
    random: Random,
    /// Apart from `random`, so that equal [`Polygons`] give equal polygons whatever else is drawn.
    cuts: Random,
    lines: Vec<String>,
    /// Vertices by their text, with numbers from 1.
    known: HashMap<String, usize>,
    vertices: usize,
    material: Option<usize>,
    storey: Option<&'a str>,
}

impl<'a> Writer<'a> {
    fn line(&mut self, line: impl Into<String>) {
        self.lines.push(line.into());
    }

    fn all(&mut self, order: &[usize]) {
        self.line("mtllib all colours.mtl");
        // Three of each, for faces to refer to.
        for line in ["vt 0 0", "vt 1 0", "vt 0.5 1 0", "vn 0 0 1", "vn 0 1 0", "vn 1 0 0"] {
            self.line(line);
        }
        if self.form.names == Names::GroupsOfOne {
            self.line("o building");
        }
        if self.form.vertices == Vertices::First {
            for &part in order {
                for p in self.points(part) {
                    self.vertex(p);
                }
            }
        }
        for &part in order {
            self.part(part);
        }
    }

    fn points(&self, part: usize) -> Vec<Point> {
        let points = self.building.points(&self.building.parts[part]);
        points.into_iter().map(|p| [0, 1, 2].map(|i| p[i] + self.building.far[i])).collect()
    }

    /// Writes a vertex unless it is known; gives its number, from 1.
    fn vertex(&mut self, p: Point) -> usize {
        let mut text = "v".to_owned();
        for c in self.content.point(p) {
            match self.form.digits {
                Digits::Shortest => write!(text, " {c}").unwrap(),
                Digits::Exponent => write!(text, " {c:e}").unwrap(),
                Digits::Six => write!(text, " {c:.6}").unwrap(),
            }
        }
        text.push_str(self.form.tail);
        if let Some(&known) = self.known.get(&text) {
            return known;
        }
        self.vertices += 1;
        self.known.insert(text.clone(), self.vertices);
        self.line(text);
        self.vertices
    }

    fn part(&mut self, index: usize) {
        let (building, form) = (self.building, self.form);
        let part = &building.parts[index];
        self.name(part);
        if form.vertices != Vertices::First {
            self.known.clear();
        }
        let points = self.points(index);
        if form.vertices == Vertices::ByElement {
            points.iter().for_each(|p| _ = self.vertex(*p));
        }
        let faces = building.faces(part);
        let mut pieces: Vec<(usize, Vec<usize>)> = faces.iter().flat_map(|face| self.pieces(face)).collect();
        if form.is_shuffled {
            for last in (1..pieces.len()).rev() {
                let other = self.random.below(last + 1);
                pieces.swap(last, other);
            }
        }
        if matches!(form.materials, UseMaterial::Sorted) {
            pieces.sort_by_key(|piece| piece.0);
        }
        for (index, (look, corners)) in pieces.into_iter().enumerate() {
            // A group with nothing in it, such as the storey's, would be none.
            if form.names == Names::ObjectsWithGroups && index > 0 && self.random.below(3) == 0 {
                let group = ["left", "right side", "off"][self.random.below(3)];
                self.line(format!("g {group}"));
            }
            if matches!(form.materials, UseMaterial::Always) || self.material != Some(look) {
                self.material = Some(look);
                self.line(format!("usemtl {}", building.looks[look].material.name));
            }
            if form.vertices == Vertices::ByFace {
                self.known.clear();
                corners.iter().for_each(|v| _ = self.vertex(points[*v]));
            }
            self.face(&corners, &points);
        }
    }

    /// The lines that start an element.
    fn name(&mut self, part: &'a Part) {
        let class = part.class.map(|class| format!("{class}:")).unwrap_or_default();
        let full = format!("{class}{}#{}", part.name, part.id);
        let storey = part.storey.map(|storey| match self.form.seed % 2 {
            0 => format!("Storey:{storey}"),
            _ => format!("IfcBuildingStorey:{storey}#2eyxpyOx95m90jmsXLOuR0"),
        });
        match self.form.names {
            Names::Objects => {
                // A storey in force goes on.
                let is_new = part.storey != self.storey;
                self.line(format!("o {full}"));
                if is_new || self.form.repeats_storey {
                    self.line(format!("g {}", storey.unwrap_or_default()));
                }
                self.storey = part.storey;
            }
            // The groups within take its place, and a later group line ends it.
            Names::ObjectsWithGroups => {
                self.line(format!("o {full}"));
                self.line(format!("g first {}", storey.unwrap_or_default()));
            }
            Names::Groups | Names::GroupsOfOne => {
                self.line(format!("g {full} {}", storey.unwrap_or_default()));
            }
        }
    }

    /// A face as one polygon, or as its triangles.
    fn pieces(&mut self, face: &Face) -> Vec<(usize, Vec<usize>)> {
        let whole = |start: usize| {
            let mut corners = face.corners.clone();
            corners.rotate_left(start % face.corners.len());
            vec![(face.look, corners)]
        };
        match self.form.polygons {
            Polygons::All(start) => whole(usize::from(start)),
            Polygons::Some(_) if self.cuts.below(2) == 0 => whole(self.cuts.below(8)),
            _ => face.triangles().into_iter().map(|t| (face.look, t.to_vec())).collect(),
        }
    }

    fn face(&mut self, corners: &[usize], points: &[Point]) {
        let numbers: Vec<usize> = corners.iter().map(|v| self.vertex(points[*v])).collect();
        let mut text = "f".to_owned();
        let form = match self.form.corners {
            Corners::Mixed => [Corners::V, Corners::Vt, Corners::Vn, Corners::Vtn][self.random.below(4)],
            form => form,
        };
        for number in numbers {
            let (vertex, other) = match self.form.is_relative {
                true => (number as i64 - self.vertices as i64 - 1, -1 - (number % 3) as i64),
                false => (number as i64, 1 + (number % 3) as i64),
            };
            match form {
                Corners::Vt => write!(text, " {vertex}/{other}").unwrap(),
                Corners::Vn => write!(text, " {vertex}//{other}").unwrap(),
                Corners::Vtn => write!(text, " {vertex}/{other}/{other}").unwrap(),
                _ => write!(text, " {vertex}").unwrap(),
            }
        }
        self.line(text);
    }

    /// How far the part's coordinates may be off, metres.
    fn bound(&self, part: &Part) -> f64 {
        let form = self.form;
        if form.digits == Digits::Six {
            return 0.5e-6 * form.unit * 1.001 + super::ROUNDING * self.building.reach();
        }
        // Such units are powers of two; the text holds all digits.
        let is_exact = is_short(form.unit) && is_short(1.0 / form.unit);
        let is_exact = is_exact && self.building.points(part).into_iter().flatten().all(is_short);
        if is_exact { 0.0 } else { super::ROUNDING * self.building.reach() }
    }
}

impl Text {
    fn lay_out(&self, lines: &[String]) -> String {
        let mut text = String::new();
        for (index, line) in lines.iter().enumerate() {
            let is_plain = line.starts_with("v ") || line.starts_with("f ");
            if self.has_comments && index % 3 == 0 {
                write!(text, "# {line} \\{}{}", self.end, self.end).unwrap();
            }
            let mut line = line.clone();
            if self.is_spaced && is_plain {
                line = format!("  {} \t", line.replace(' ', " \t "));
            }
            if self.is_continued && is_plain {
                let middle = line.len() / 2;
                let blank = line[middle..].find(' ').map_or(1, |at| middle + at);
                line.insert_str(blank, &format!(" \\{}", self.end));
            }
            if self.has_comments && is_plain && index % 5 == 0 {
                line.push_str(" # a comment");
            }
            write!(text, "{line}{}", self.end).unwrap();
        }
        text
    }
}

/// The materials, the last one first.
fn library(building: &Building) -> String {
    let mut text = "# colours\n".to_owned();
    for look in building.looks.iter().rev() {
        let m = &look.material;
        let ([r, g, b], [er, eg, eb], t) = (m.base_color, m.emissive, m.transmission);
        write!(
            text,
            "newmtl {}\nKa 0 0 0\nKd {r} {g} {b}\nKe {er} {eg} {eb}\nd {}\nNi {}\nPr {}\nPm {}\n",
            m.name, m.alpha, m.ior, m.roughness, m.metallic
        )
        .unwrap();
        if t > 0.0 {
            writeln!(text, "Tf {t} {t} {t}").unwrap();
        }
        if look.is_textured {
            writeln!(text, "map_Kd -s 2 2 1 tex\\tür 1.png").unwrap();
        }
    }
    text
}
