//! Picture files are there whole or not at all, and errors name them.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::format::write_atomically;

/// A picture could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {error}")]
pub struct WriteError {
    /// The file's name as it was given.
    pub file: String,
    /// Why.
    #[source]
    pub error: io::Error,
}

/// Writes `path` through `write`, see [`write_atomically`].
pub(super) fn write(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    let written = write_atomically(path, |file| {
        let mut writer = BufWriter::new(file);
        write(&mut writer)?;
        writer.flush()
    });
    written.map_err(|error| WriteError { file: path.display().to_string(), error })
}
