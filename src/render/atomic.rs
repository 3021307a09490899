//! Files that are there whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A picture could not be written.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct WriteError {
    /// The file's name as it was given.
    pub file: String,
    /// Why.
    pub reason: String,
    /// The error of the file system, if it was one.
    #[source]
    pub io: Option<io::Error>,
}

impl WriteError {
    pub(super) fn new(path: &Path, reason: impl Into<String>) -> WriteError {
        WriteError { file: path.display().to_string(), reason: reason.into(), io: None }
    }

    fn from_io(path: &Path, error: io::Error) -> WriteError {
        WriteError { file: path.display().to_string(), reason: error.to_string(), io: Some(error) }
    }
}

/// Writes `path` through `write`: to a temporary file in the same folder, which is then given the name. What was there
/// stays until then, and if anything fails.
pub(super) fn write(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), String>,
) -> Result<(), WriteError> {
    if path.file_name().is_none() {
        return Err(WriteError::new(path, "this is no name for a file"));
    }
    let (mut temporary, file) = create_beside(path).map_err(|e| WriteError::from_io(path, e))?;
    let mut writer = BufWriter::new(file);
    let result = write(&mut writer)
        .map_err(|reason| WriteError::new(path, reason))
        .and_then(|()| finish(writer, &temporary.path, path).map_err(|e| WriteError::from_io(path, e)));
    if result.is_ok() {
        temporary.renamed();
    }
    result
}

fn finish(mut writer: BufWriter<File>, temporary: &Path, path: &Path) -> io::Result<()> {
    writer.flush()?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.sync_all()?;
    drop(file);
    fs::rename(temporary, path)
}

/// Deletes the file when dropped, unless it has got its name.
struct Temporary {
    path: PathBuf,
    is_renamed: bool,
}

impl Temporary {
    fn renamed(&mut self) {
        self.is_renamed = true;
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.is_renamed {
            // Nothing more can be done if this fails: the error that led here is the one to report.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// A new file in the folder of `path`, whose name nobody else has.
fn create_beside(path: &Path) -> io::Result<(Temporary, File)> {
    const TRIES: u32 = 1000;
    let name = path.file_name().unwrap_or_default();
    for number in 0..TRIES {
        let mut other = std::ffi::OsString::from(".");
        other.push(name);
        other.push(format!(".{}-{number}.tmp", std::process::id()));
        let other = path.with_file_name(other);
        match OpenOptions::new().write(true).read(true).create_new(true).open(&other) {
            Ok(file) => return Ok((Temporary { path: other, is_renamed: false }, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::new(io::ErrorKind::AlreadyExists, "no free name for a temporary file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write(&path, |w| w.write_all(b"one").map_err(|e| e.to_string())).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
        let failed = write(&path, |w| {
            w.write_all(b"tw").map_err(|e| e.to_string())?;
            Err("half way".to_owned())
        });
        assert_eq!(failed.unwrap_err().to_string(), format!("{}: half way", path.display()));
        assert_eq!(fs::read(&path).unwrap(), b"one");
        write(&path, |w| w.write_all(b"two").map_err(|e| e.to_string())).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "temporary files are gone");
        let nowhere = folder.path().join("none").join("a.txt");
        let error = write(&nowhere, |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("a.txt"), "{error}");
        assert!(error.io.is_some());
    }
}
