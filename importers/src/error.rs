//! What can go wrong on the way to a model, and where.

use std::fmt;

use crate::limits::OverBudget;
use crate::watch::Cancelled;

/// An import failed: which file, which element, which place in the file, and why.
#[derive(Debug)]
#[non_exhaustive]
pub struct ImportError {
    /// The file's name as it was given, or a buffer's, image's or material library's beside it.
    pub file: String,
    /// The element's name, where it is about one.
    pub element: Option<String>,
    /// The place in the file: a JSON path such as `meshes[3].primitives[0].indices`, or `line 12`; may be empty.
    pub place: String,
    /// What went wrong.
    pub kind: ImportErrorKind,
}

/// Why an import failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportErrorKind {
    /// The file, or one that it refers to, could not be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The file's name or first bytes are of no format that this build reads.
    #[error("{0}")]
    UnknownFormat(String),
    /// The file is no well-formed file of its format.
    #[error("{0}")]
    Malformed(String),
    /// A required extension that enfilade does not support.
    #[error("the required extension {0} is not supported")]
    RequiredExtension(String),
    /// A part of the format that enfilade does not support.
    #[error("{0}")]
    Unsupported(String),
    /// A `uri` or `mtllib` that leaves the model's folder.
    #[error("'{0}' leaves the model's folder, and is refused")]
    LeavesFolder(String),
    /// A coordinate that is not finite, or beyond 1e12 metres.
    #[error(
        "coordinate {value} of vertex {vertex} is {}",
        if value.is_finite() { "farther than 1e12 metres from the origin" } else { "not finite" }
    )]
    NotFinite {
        /// The vertex's index in its accessor or file.
        vertex: u64,
        /// The value.
        value: f64,
    },
    /// The model has no triangle at all.
    #[error("no triangles: {0}")]
    Empty(String),
    /// More memory would be needed than allowed.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
    /// More elements than allowed.
    #[error("more than {0} elements (raise --max-elements)")]
    TooManyElements(u64),
    /// Elements without a tag, where the options make that an error.
    #[error("{0}")]
    Untagged(String),
    /// A rules file is wrong.
    #[error("{0}")]
    Rules(String),
    /// Cancelled through its token.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ImportError {
    /// An error about `file` as a whole.
    pub fn new(file: impl Into<String>, kind: impl Into<ImportErrorKind>) -> ImportError {
        ImportError { file: file.into(), element: None, place: String::new(), kind: kind.into() }
    }

    /// The same at a place in the file.
    pub fn at(mut self, place: impl Into<String>) -> ImportError {
        self.place = place.into();
        self
    }

    /// The same about an element.
    pub fn of_element(mut self, name: impl Into<String>) -> ImportError {
        self.element = Some(name.into());
        self
    }
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if !self.place.is_empty() {
            write!(f, ": {}", self.place)?;
        }
        if let Some(element) = &self.element {
            write!(f, ": element '{element}'")?;
        }
        write!(f, ": {}", self.kind)
    }
}

impl std::error::Error for ImportError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        std::error::Error::source(&self.kind)
    }
}
