//! glTF 2.0.

use std::path::Path;

use crate::error::ImportError;
use crate::import::ImportOptions;
use crate::model::Model;

/// Reads the glTF 2.0 file at `path` (`.gltf` or `.glb`), without tagging it.
///
/// # Errors
/// [`ImportError`].
pub fn read(path: &Path, options: &ImportOptions) -> Result<Model, ImportError> {
    let _ = (path, options);
    Err(ImportError::new("", crate::ImportErrorKind::Unsupported("stub".into())))
}
