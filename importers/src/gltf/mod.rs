//! glTF 2.0: `.gltf` with buffers beside it or inside it, and `.glb`.
//!
//! The way of a file: `container` finds the JSON and the binary chunk, `document` parses and checks the JSON,
//! `buffers` fetches the bytes, `graph` walks the scene that the file shows, `materials` and `lights` read what they
//! name, `whole` finds the nodes that are parts of one element, and `reader` makes an element of every other node with
//! a mesh.
//!
//! The `gltf` crate parses and reads typed items. Its own readers trust the file, so that every count, offset and
//! index is checked before it is asked to read (`accessors`), and its f32 node transforms are not used: they are
//! read again in f64 from the same JSON text (`document::Placement`).

mod accessors;
mod buffers;
mod container;
mod document;
mod extras;
#[cfg(test)]
mod forms;
mod graph;
mod identity;
mod images;
mod instancing;
mod json_cost;
mod lights;
mod materials;
mod mesh;
mod reader;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod transform;
mod uri;
mod whole;

use std::hash::Hasher;
use std::path::Path;

use twox_hash::XxHash3_64;

use crate::builder::ModelBuilder;
use crate::error::{ImportError, ImportErrorKind};
use crate::folder::read_whole;
use crate::frame::{Frame, UpAxis};
use crate::import::ImportOptions;
use crate::limits::Budget;
use crate::model::Model;

use uri::Uris;

/// Reads the glTF 2.0 file at `path` (`.gltf` or `.glb`; the first bytes tell which), without tagging it.
///
/// Buffers and images that the file names must lie in its folder or below.
///
/// # Errors
/// [`ImportError`]: the file cannot be read, is damaged, needs an extension that is not supported, refers to files
/// outside its folder, shows no triangle, or would cost more than `options.limits`; or a unit or an up axis is
/// asked for that glTF does not have.
pub fn read(path: &Path, options: &ImportOptions) -> Result<Model, ImportError> {
    let given = path.display().to_string();
    let source = path.file_name().map_or_else(|| given.clone(), |name| name.to_string_lossy().into_owned());
    let mut budget = Budget::new(&options.limits);
    read_whole(path, &mut budget, "the file")
        .map_err(|kind| fault("", kind))
        .and_then(|bytes| read_bytes(&bytes, &source, &Uris::of(path), options, budget))
        .map_err(|error| name_file(error, &source, &given))
}

/// Reads a glTF 2.0 file from memory: a `.glb`, or a `.gltf` whose buffers are data URIs. `name` stands for the
/// file in errors and reports.
///
/// # Errors
/// As [`read`]; buffers in other files cannot be found. Images in other files are left out with a warning.
pub fn read_slice(bytes: &[u8], name: &str, options: &ImportOptions) -> Result<Model, ImportError> {
    read_bytes(bytes, name, &Uris::of_no_folder(), options, Budget::new(&options.limits))
        .map_err(|error| name_file(error, name, name))
}

fn read_bytes(
    bytes: &[u8],
    source: &str,
    uris: &Uris,
    options: &ImportOptions,
    mut budget: Budget,
) -> Result<Model, ImportError> {
    check_options(options)?;
    options.watch.report("read", 0.0);
    let mut hasher = XxHash3_64::new();
    hasher.write(bytes);
    let container = container::split(bytes)?;
    let (document, placements) = document::parse(&container.json, &mut budget)?;
    let root = document.as_json();
    let buffers = buffers::load(root, container.bin.as_deref(), uris, &mut budget, &mut hasher)?;
    options.watch.check().map_err(|e| fault("", e.into()))?;

    let mut builder = ModelBuilder::with_budget(source, Frame::GLTF, &options.limits, budget);
    builder.source_hash(hasher.finish());
    reader::fill(builder, &document, &placements, &buffers, uris, options)
}

/// glTF fixes unit and axes; to ask for others is a misunderstanding that must not pass in silence.
fn check_options(options: &ImportOptions) -> Result<(), ImportError> {
    if options.unit.is_some_and(|unit| unit != 1.0) {
        let text = "glTF files are in metres: another unit cannot be given".to_owned();
        return Err(fault("", ImportErrorKind::Unsupported(text)));
    }
    if options.up.is_some_and(|up| up != UpAxis::Y) {
        let text = "glTF files have Y up: another axis cannot be given".to_owned();
        return Err(fault("", ImportErrorKind::Unsupported(text)));
    }
    Ok(())
}

/// An error about the file that is being read. Its name is put in at the end, by [`name_file`].
fn fault(place: impl Into<String>, kind: ImportErrorKind) -> ImportError {
    ImportError::new("", kind).at(place)
}

/// A [`fault`]: the file is no well-formed glTF.
fn malformed(place: impl Into<String>, text: impl Into<String>) -> ImportError {
    fault(place, ImportErrorKind::Malformed(text.into()))
}

/// The builder knows the file by its bare name, and faults know no name: both get the name as it was given.
fn name_file(mut error: ImportError, source: &str, given: &str) -> ImportError {
    if error.file.is_empty() || error.file == source {
        given.clone_into(&mut error.file);
    }
    error
}
