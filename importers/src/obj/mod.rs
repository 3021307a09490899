//! Wavefront OBJ and MTL.
//!
//! **Elements.** One element per object (`o` line); groups (`g` lines) are other names of it. Without an `o` line in
//! force, one element per `g` line. An object is split into one element per group where the groups are plainly the
//! elements: it is the only object of the file, or it has no class and no id, and two or more of its groups do. A
//! line that gives the name in force again goes on with the same element, as exporters write it at each `usemtl`;
//! but without an id and with new vertices before the next face it begins another one. A name that comes back later
//! is another element. Neighbours that are one thing by material (`Wall_1`, `Wall_2`) become one element where only
//! together they are closed.
//!
//! **Names.** `Class:name#id`: class, name and id of the element. A group name `Storey:NAME` or
//! `IfcBuildingStorey:NAME`, which goes to the end of its line, gives the storey. An element without id has its path
//! as id: `object`, `object/group`, `unnamed`, with `[2]` and so on where that was there before.
//!
//! **Faces.** Polygons are triangulated, concave ones too. Lines, points, free-form geometry, texture coordinates,
//! normals and vertex colours are left out. `usemtl` gives each triangle its material; a name that no library has
//! makes a grey material of that name.
//!
//! **Frame.** OBJ says nothing of units and axes: metres and Y up (as in glTF) unless the options say otherwise.
//!
//! **Colours.** `Kd` and `Ke` are taken as linear, as they are. The mean of `map_Kd` is multiplied in: taken in linear
//! light, with each texel's opacity as its weight, and its mean opacity.

mod assemble;
mod crossing;
mod feed;
mod guard;
mod join;
mod lines;
mod looks;
mod mtl;
mod names;
mod parts;
mod polygon;

use std::fs::File;
use std::hash::Hasher;
use std::io::{BufReader, Read};
use std::path::Path;

use crate::error::{ImportError, ImportErrorKind};
use crate::folder::Folder;
use crate::frame::{Frame, UpAxis};
use crate::import::ImportOptions;
use crate::limits::Budget;
use crate::model::{Model, Warning};
use crate::obj::feed::Feed;
use crate::obj::guard::{ObjGuard, Tally};
use crate::obj::lines::Hashing;

/// Reads the OBJ file at `path`, and the material libraries and textures beside it, without tagging it.
///
/// # Errors
/// [`ImportError`]: the file cannot be read, is damaged (at its line), has no triangles, refers to a library outside
/// its folder, or is over the limits; the unit of the options is not positive.
pub fn read(path: &Path, options: &ImportOptions) -> Result<Model, ImportError> {
    let name = path.display().to_string();
    let open = || -> std::io::Result<(File, u64)> {
        let file = File::open(path)?;
        let size = file.metadata()?.len();
        Ok((file, size))
    };
    let (file, size) = open().map_err(|e| ImportError::new(name.clone(), e))?;
    let source = path.file_name().map_or_else(|| name.clone(), |n| n.to_string_lossy().into_owned());
    read_from(file, size, &name, source, Some(&Folder::of(path)), options)
}

/// Reads an OBJ text in memory, without tagging it. `name` stands for the file's name. Material libraries are looked
/// for in `folder`; without one they count as missing.
///
/// # Errors
/// As [`read`].
pub fn read_text(
    text: &[u8],
    name: &str,
    folder: Option<&Path>,
    options: &ImportOptions,
) -> Result<Model, ImportError> {
    let folder = folder.map(Folder::at);
    read_from(text, text.len() as u64, name, name.to_owned(), folder.as_ref(), options)
}

fn read_from(
    source: impl Read,
    size: u64,
    file: &str,
    source_name: String,
    folder: Option<&Folder>,
    options: &ImportOptions,
) -> Result<Model, ImportError> {
    let frame = frame_of(options).map_err(|kind| ImportError::new(file, kind))?;
    let mut budget = Budget::new(&options.limits);
    let mut warnings = Vec::new();

    let progress = |reader: &BufReader<Hashing<_>>| {
        let done = reader.get_ref().bytes_read() as f64 / size.max(1) as f64;
        options.watch.report("read", done.min(1.0));
    };
    let reader = BufReader::with_capacity(1 << 16, Hashing::new(source));
    let mut feed = Feed::new(reader, ObjGuard::new(file), &mut budget, &options.watch, &progress);
    // The guard hands on no `mtllib`: libraries are read afterwards, when it is known which materials are used.
    let no_library = |_: &Path| Ok(Default::default());
    let (meshes, _) = match tobj::load_obj_buf(&mut feed, &tobj::LoadOptions::default(), no_library) {
        Ok(read) => read,
        Err(error) => return Err(feed.failure(error)),
    };
    let (reader, mut guard) = feed.into_parts();
    budget.give_back(guard.transient);
    let mut hash = reader.into_inner().into_hash();
    options.watch.report("read", 1.0);

    if guard.faces() == 0 {
        return Err(no_faces(file, &guard));
    }
    let materials = looks::materials(&guard, file, folder, &mut hash, &mut budget, options, &mut warnings)?;
    note_oddities(&mut guard, &mut warnings);
    let mut model = assemble::assemble(meshes, &guard, materials, file, frame, budget, options)?;
    model.source = source_name;
    model.source_hash = hash.finish();
    warnings.append(&mut model.warnings);
    model.warnings = warnings;
    Ok(model)
}

fn frame_of(options: &ImportOptions) -> Result<Frame, ImportErrorKind> {
    let unit = options.unit.unwrap_or(1.0);
    if !(unit.is_finite() && unit > 0.0) {
        let text = format!("a unit of {unit} metres: it must be positive and finite");
        return Err(ImportErrorKind::Unsupported(text));
    }
    Ok(Frame { unit, up: options.up.unwrap_or(UpAxis::Y), offset: [0.0; 3] })
}

fn no_faces(file: &str, guard: &ObjGuard) -> ImportError {
    let unknown = &guard.unknown;
    if !guard.any_known && unknown.count > 0 {
        let text = format!("this is no OBJ file: it has no statement '{}'", unknown.first.text);
        let place = format!("line {}", unknown.first.line);
        return ImportError::new(file, ImportErrorKind::Malformed(text)).at(place);
    }
    let text = format!("the file has {} vertices, but no faces of three or more corners", guard.vertices);
    ImportError::new(file, ImportErrorKind::Empty(text))
}

/// Warnings about what was read over.
fn note_oddities(guard: &mut ObjGuard, warnings: &mut Vec<Warning>) {
    let mut warn = |tally: &Tally, text: &str| {
        if tally.count > 0 {
            let text = format!("{} {text} (first '{}')", tally.count, tally.first.text);
            warnings.push(Warning { place: format!("line {}", tally.first.line), text });
        }
    };
    warn(&guard.unknown, "statements that OBJ does not have were skipped");
    warn(&guard.free_form, "statements of free-form geometry were left out");
    warn(&guard.bad_indices, "corners of faces refer to texture coordinates or normals that there are not");
    if let (count, Some(first)) = guard.parts.unused() {
        let text = format!("{count} objects have nothing in them (first '{}')", first.text);
        warnings.push(Warning { place: format!("line {}", first.line), text });
    }
}
