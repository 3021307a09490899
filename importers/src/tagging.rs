//! Tagging: from names, classes and metadata to meanings.

use crate::error::ImportError;
use crate::import::ImportOptions;
use crate::model::Model;

/// Rules that give elements a meaning.
#[derive(Clone, Debug, Default)]
pub struct Rules {}

/// Tags every element of `model`.
///
/// # Errors
/// [`ImportError`].
pub fn tag(model: &mut Model, options: &ImportOptions) -> Result<(), ImportError> {
    let _ = (model, options);
    Ok(())
}
