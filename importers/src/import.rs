//! One call for any format.

use std::path::Path;

use crate::error::{ImportError, ImportErrorKind};
use crate::frame::UpAxis;
use crate::limits::Limits;
#[cfg(all(feature = "rules", feature = "gltf", feature = "obj"))]
use crate::model::Model;
use crate::semantic::Untagged;
use crate::watch::Watch;

/// How to read a model.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct ImportOptions {
    /// Metres in one unit of the file. `None`: 1, which for glTF is fixed (another value is an error there).
    pub unit: Option<f64>,
    /// Which axis points up. `None`: Y, which for glTF is fixed.
    pub up: Option<UpAxis>,
    /// What the import may cost.
    pub limits: Limits,
    /// Rules that go before all other ways to find a tag.
    #[cfg(feature = "rules")]
    pub rules: Option<crate::tagging::Rules>,
    /// What to make of elements without a tag.
    pub untagged: Untagged,
    /// Progress and cancellation.
    pub watch: Watch,
}

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// glTF 2.0, JSON or binary.
    Gltf,
    /// Wavefront OBJ.
    Obj,
}

impl Format {
    /// The format by a file's first bytes, or else by its name's ending.
    ///
    /// # Errors
    /// [`ImportErrorKind::UnknownFormat`] if neither tells.
    pub fn detect(path: &Path, first_bytes: &[u8]) -> Result<Format, ImportError> {
        if first_bytes.starts_with(b"glTF") {
            return Ok(Format::Gltf);
        }
        let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "gltf" | "glb" => Ok(Format::Gltf),
            "obj" => Ok(Format::Obj),
            _ => Err(ImportError::new(
                path.display().to_string(),
                ImportErrorKind::UnknownFormat(
                    "not a model that enfilade reads: the name ends in none of .glb, .gltf, .obj".to_owned(),
                ),
            )),
        }
    }
}

/// Reads and tags the model at `path`, glTF or OBJ.
///
/// # Errors
/// [`ImportError`], which names the file, the place and the element.
#[cfg(all(feature = "rules", feature = "gltf", feature = "obj"))]
pub fn import(path: &Path, options: &ImportOptions) -> Result<Model, ImportError> {
    use std::io::Read;
    let mut first = Vec::new();
    std::fs::File::open(path)
        .and_then(|file| file.take(4).read_to_end(&mut first))
        .map_err(|e| ImportError::new(path.display().to_string(), e))?;
    let mut model = match Format::detect(path, &first)? {
        Format::Gltf => crate::gltf::read(path, options)?,
        Format::Obj => crate::obj::read(path, options)?,
    };
    crate::tagging::tag(&mut model, options)?;
    Ok(model)
}
