//! The guard before `tobj` for OBJ: which statements it gets to see, and in which form.
//!
//! `tobj` sees nothing but `v`, `f` with plain vertex indices, and an `o` line with the number of the part before
//! the first face of each part. All else it would merge, split, forget, or trip over:
//!
//! * objects, groups and materials are kept here, with their lines, in tables;
//! * `l 1 2 3` would become a triangle, vertex colours on some vertices an error, indices of texture coordinates
//!   and normals are used unchecked in arithmetic: they are counted here, and left out;
//! * indices are checked here, where the line is still known.

use std::collections::HashMap;

use crate::error::{ImportError, ImportErrorKind};
use crate::limits::Budget;
use crate::model::LeftOutReason;
use crate::obj::feed::{Guard, excerpt};
use crate::obj::parts::{Named, PartTable};

/// What `tobj` spends on a vertex: three numbers, in a vector that doubles.
const VERTEX_COST: u64 = 48;
/// What `tobj` spends on a face while it reads the part that it is in: an enum of four corners of three indices.
const OPEN_FACE_COST: u64 = 208;
/// What a face costs in a finished mesh, with the line that is kept here, and what each corner costs.
const FACE_COST: u64 = 16;
const CORNER_COST: u64 = 8;
/// What each vertex of a finished mesh costs, with its entry in the map from old to new indices.
const MESH_VERTEX_COST: u64 = 88;

/// Statements of free-form geometry, which has no faces.
const FREE_FORM: &[&str] = &[
    "vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp",
    "end", "con", "cdc", "cdp", "bzp", "bsp", "res",
];
/// Statements that change nothing here.
const IDLE: &[&str] = &[
    "s",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "maplib",
    "usemap",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
];

/// Something that a part has and that does not become faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Note {
    pub(super) part: usize,
    pub(super) reason: LeftOutReason,
    pub(super) line: u64,
    pub(super) count: u64,
}

/// How often something odd occurred, and where first.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) count: u64,
    pub(super) first: Named,
}

impl Tally {
    fn add(&mut self, line: u64, what: &[u8]) {
        if self.count == 0 {
            self.first = Named { text: excerpt(&String::from_utf8_lossy(what)), line };
        }
        self.count += 1;
    }
}

/// The guard, and after the end what it learnt.
#[derive(Debug, Default)]
pub(super) struct ObjGuard {
    file: String,
    pub(super) parts: PartTable,
    pub(super) notes: Vec<Note>,
    /// `mtllib` lines.
    pub(super) libraries: Vec<Named>,
    /// Names of `usemtl` lines, each once; the first is empty: no material.
    pub(super) materials: Vec<Named>,
    material_index: HashMap<String, usize>,
    material: usize,
    /// From which face on which material holds.
    pub(super) switches: Vec<(u64, usize)>,
    /// The line of each face that `tobj` got; saturates.
    pub(super) face_lines: Vec<u32>,
    pub(super) vertices: u64,
    texture_coordinates: u64,
    normals: u64,
    /// The part of the last face, its corners, and the most faces that a part had so far.
    open: Option<usize>,
    open_corners: u64,
    most_open_faces: u64,
    /// The largest index in the open part that was larger than the number of vertices at its face, and its line.
    ahead: Option<(u64, u64)>,
    /// Bytes of budget that are free again once `tobj` is done.
    pub(super) transient: u64,
    pub(super) bad_indices: Tally,
    pub(super) free_form: Tally,
    pub(super) unknown: Tally,
    /// Whether there was any statement that OBJ has.
    pub(super) any_known: bool,
    corners: Vec<u8>,
}

impl ObjGuard {
    pub(super) fn new(file: &str) -> ObjGuard {
        ObjGuard { file: file.to_owned(), materials: vec![Named::default()], ..ObjGuard::default() }
    }

    pub(super) fn faces(&self) -> u64 {
        self.face_lines.len() as u64
    }

    fn malformed(&self, line: u64, text: String) -> ImportError {
        self.error(line, ImportErrorKind::Malformed(text))
    }

    fn take(&self, line: u64, budget: &mut Budget, bytes: u64, what: &str) -> Result<(), ImportError> {
        budget.take(bytes, what).map_err(|e| self.error(line, e.into()))
    }

    fn transient(
        &mut self,
        line: u64,
        budget: &mut Budget,
        bytes: u64,
        what: &str,
    ) -> Result<(), ImportError> {
        self.take(line, budget, bytes, what)?;
        self.transient += bytes;
        Ok(())
    }

    fn current_part(&mut self, line: u64, budget: &mut Budget) -> Result<usize, ImportError> {
        let vertices = self.vertices;
        self.parts.current(line, vertices, budget).map_err(|e| self.error(line, e.into()))
    }

    fn vertex(
        &mut self,
        line: u64,
        rest: &[u8],
        budget: &mut Budget,
        out: &mut Vec<u8>,
    ) -> Result<(), ImportError> {
        self.transient(line, budget, VERTEX_COST, "vertices")?;
        self.vertices += 1;
        if self.vertices > u64::from(u32::MAX) {
            let kind = ImportErrorKind::Unsupported("more than 4294967295 vertices".to_owned());
            return Err(self.error(line, kind));
        }
        let mut count = 0;
        let mut suspect = false;
        out.push(b'v');
        let start = out.len();
        for word in words(rest) {
            count += 1;
            // After three numbers come a weight, or a colour: three or four numbers more, not read.
            if count <= 5 {
                out.push(b' ');
                // `tobj` could not read on after bytes that are no UTF-8; it refuses a question mark as well.
                out.extend_from_slice(if word.is_ascii() { word } else { b"?" });
            }
            suspect |= !is_surely_finite(word) || count == 4;
        }
        if count > 5 {
            let three: usize = words(rest).take(3).map(|w| 1 + if w.is_ascii() { w.len() } else { 1 }).sum();
            out.truncate(start + three);
        }
        out.push(b'\n');
        if suspect { self.check_finite(line, rest, count) } else { Ok(()) }
    }

    /// Looks closely at a vertex whose numbers may not be finite, or be so after division by the weight. What is
    /// no number at all is left for `tobj` to refuse.
    fn check_finite(&self, line: u64, rest: &[u8], count: usize) -> Result<(), ImportError> {
        let number = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<f64>().ok();
        let weight = if count == 4 { words(rest).nth(3).and_then(number).unwrap_or(1.0) } else { 1.0 };
        for word in words(rest).take(3) {
            let Some(value) = number(word) else { continue };
            let value = if weight == 0.0 || value.is_nan() { value } else { value / weight };
            if !value.is_finite() {
                return Err(self.error(line, ImportErrorKind::NotFinite { vertex: self.vertices, value }));
            }
        }
        Ok(())
    }

    fn face(
        &mut self,
        line: u64,
        rest: &[u8],
        budget: &mut Budget,
        out: &mut Vec<u8>,
    ) -> Result<(), ImportError> {
        let part = self.current_part(line, budget)?;
        if self.open != Some(part) {
            self.close(budget)?;
            self.open = Some(part);
        }
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        let mut count = 0u64;
        for word in words(rest) {
            count += 1;
            corners.push(b' ');
            corners.extend_from_slice(self.corner(line, word)?);
        }
        if count < 3 {
            self.note(line, part, LeftOutReason::BadPolygon, 1, budget)?;
            self.corners = corners;
            return Ok(());
        }
        let in_part = self.parts.part_mut(part);
        in_part.faces += 1;
        let faces = in_part.faces;
        if faces == 1 {
            out.extend_from_slice(format!("o {part}\n").as_bytes());
        }
        if faces > self.most_open_faces {
            self.most_open_faces = faces;
            self.transient(line, budget, OPEN_FACE_COST, "faces")?;
        }
        self.take(line, budget, FACE_COST + CORNER_COST * count, "faces")?;
        self.open_corners += count;
        if self.switches.last().map_or(0, |s| s.1) != self.material {
            self.take(line, budget, 32, "materials")?;
            self.switches.push((self.faces(), self.material));
        }
        self.face_lines.push(u32::try_from(line).unwrap_or(u32::MAX));
        out.push(b'f');
        out.extend_from_slice(&corners);
        out.push(b'\n');
        self.corners = corners;
        Ok(())
    }

    /// Checks a corner of a face; gives its vertex index as it is written.
    fn corner<'a>(&mut self, line: u64, word: &'a [u8]) -> Result<&'a [u8], ImportError> {
        let mut fields = word.split(|&b| b == b'/');
        let vertex = fields.next().unwrap_or_default();
        let others = [self.texture_coordinates, self.normals];
        let shape = |guard: &Self| {
            let text = excerpt(&String::from_utf8_lossy(word));
            guard.malformed(line, format!("'{text}' is no corner of a face: v, v/vt, v//vn or v/vt/vn"))
        };
        let index = integer(vertex).ok_or_else(|| shape(self))?;
        match index {
            0 => return Err(self.malformed(line, "a face refers to vertex 0; they count from 1".to_owned())),
            1.. if index.unsigned_abs() > self.vertices => {
                // The vertex may follow, as long as it does before the next part.
                if self.ahead.is_none_or(|(highest, _)| highest < index.unsigned_abs()) {
                    self.ahead = Some((index.unsigned_abs(), line));
                }
            }
            ..0 if index.unsigned_abs() > self.vertices => {
                return Err(self.out_of_range(line, index));
            }
            _ => {}
        }
        for (known, field) in others.into_iter().zip(&mut fields) {
            // Texture coordinates and normals are not used, so that a wrong reference to them is no error.
            if !field.is_empty() {
                let index = integer(field).ok_or_else(|| shape(self))?;
                if index == 0 || index.unsigned_abs() > known {
                    self.bad_indices.add(line, word);
                }
            }
        }
        if fields.next().is_some() { Err(shape(self)) } else { Ok(vertex) }
    }

    fn out_of_range(&self, line: u64, index: impl std::fmt::Display) -> ImportError {
        let text = format!("a face refers to vertex {index}, but there are {} before it", self.vertices);
        self.malformed(line, text)
    }

    /// Before `tobj` makes a mesh of the open part.
    fn close(&mut self, budget: &mut Budget) -> Result<(), ImportError> {
        let Some(part) = self.open.take() else { return Ok(()) };
        if let Some((index, line)) = self.ahead.take()
            && index > self.vertices
        {
            let mut error = self.out_of_range(line, index);
            error.element = self.parts.name_of(part).map(str::to_owned);
            return Err(error);
        }
        let line = self.face_lines.last().map_or(0, |&line| u64::from(line));
        let distinct = std::mem::take(&mut self.open_corners).min(self.vertices);
        self.take(line, budget, distinct * MESH_VERTEX_COST, "vertices")
    }

    fn note(
        &mut self,
        line: u64,
        part: usize,
        reason: LeftOutReason,
        count: u64,
        budget: &mut Budget,
    ) -> Result<(), ImportError> {
        match self.notes.iter_mut().rev().take(3).find(|n| n.part == part && n.reason == reason) {
            Some(note) => note.count += count,
            None => {
                self.take(line, budget, 256, "notes")?;
                self.notes.push(Note { part, reason, line, count });
            }
        }
        Ok(())
    }

    fn use_material(&mut self, line: u64, name: &str, budget: &mut Budget) -> Result<(), ImportError> {
        self.material = match self.material_index.get(name) {
            _ if name.is_empty() => 0,
            Some(&known) => known,
            None => {
                self.take(line, budget, 512 + 4 * name.len() as u64, "materials")?;
                let index = self.materials.len();
                self.materials.push(Named { text: name.to_owned(), line });
                self.material_index.insert(name.to_owned(), index);
                index
            }
        };
        Ok(())
    }
}

impl Guard for ObjGuard {
    fn statement(
        &mut self,
        number: u64,
        statement: &[u8],
        budget: &mut Budget,
        out: &mut Vec<u8>,
    ) -> Result<(), ImportError> {
        let statement = statement.trim_ascii();
        let end = statement.iter().position(u8::is_ascii_whitespace).unwrap_or(statement.len());
        let (keyword, rest) = statement.split_at(end);
        if keyword.is_empty() || keyword[0] == b'#' {
            return Ok(());
        }
        let known = self.unknown.count;
        match keyword {
            b"v" => self.vertex(number, rest, budget, out)?,
            // `fo` is how version 2 wrote faces.
            b"f" | b"fo" => self.face(number, rest, budget, out)?,
            b"vt" => self.texture_coordinates += 1,
            b"vn" => self.normals += 1,
            b"o" => self.parts.object(&text(rest), number),
            b"g" => self.parts.groups(&text(rest), number),
            b"usemtl" => self.use_material(number, &text(rest), budget)?,
            b"mtllib" => {
                let text = text(rest);
                self.take(number, budget, 128 + 2 * text.len() as u64, "names")?;
                self.libraries.push(Named { text, line: number });
            }
            b"l" | b"p" => {
                let points = words(rest).count() as u64;
                let (reason, count) = match keyword {
                    b"l" => (LeftOutReason::Lines, points.saturating_sub(1)),
                    _ => (LeftOutReason::Points, points),
                };
                if count > 0 {
                    let part = self.current_part(number, budget)?;
                    self.note(number, part, reason, count, budget)?;
                }
            }
            _ if IDLE.iter().any(|k| k.as_bytes() == keyword) => {}
            _ if FREE_FORM.iter().any(|k| k.as_bytes() == keyword) => self.free_form.add(number, keyword),
            _ => self.unknown.add(number, keyword),
        }
        self.any_known |= self.unknown.count == known;
        Ok(())
    }

    fn end(&mut self, budget: &mut Budget) -> Result<(), ImportError> {
        self.close(budget)
    }

    fn error(&self, number: u64, kind: ImportErrorKind) -> ImportError {
        let mut error = ImportError::new(self.file.clone(), kind).at(format!("line {number}"));
        error.element = self.parts.name_in_force().map(str::to_owned);
        error
    }
}

/// The words of a statement up to a comment.
fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    // `tobj` takes a vertical tab for a blank too.
    text.split(|b| b.is_ascii_whitespace() || *b == 0x0b)
        .filter(|w| !w.is_empty())
        .take_while(|w| w[0] != b'#')
}

/// A name: the rest of a statement. Bytes that are no UTF-8 become U+FFFD.
fn text(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}

/// Whether a word, if it is a number at all, is a finite one: digits, not too many, and no exponent or letters.
fn is_surely_finite(word: &[u8]) -> bool {
    word.len() < 300 && word.iter().all(|&b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'))
}

/// An index.
fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}
