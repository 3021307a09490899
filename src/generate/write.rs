//! Writing a building to a file.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::building::Building;
use super::style::{Export, Style};
use crate::format::write_atomically;

/// A building could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The name says no format.
    #[error("{}: the name must end in .glb or .obj", .0.display())]
    Format(PathBuf),
    /// The name cannot stand in an OBJ file.
    #[error("{}: the name of an .obj must be Unicode, without blanks at its ends, line ends and #", .0.display())]
    Name(PathBuf),
    /// The system refused.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// Writes a building as it is: [`Export::write`] in the style [`Style::exact`].
///
/// # Errors
/// As [`Export::write`].
pub fn write(building: &Building, path: &Path) -> Result<(), WriteError> {
    building.export(&Style::exact()).write(path)
}

/// Writes as the name's end says.
pub fn write_export(export: &Export<'_>, path: &Path) -> Result<(), WriteError> {
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("glb") => replace(path, &export.to_glb()),
        Some("obj") => {
            let mtl_path = path.with_extension("mtl");
            let name = mtl_path.file_name().and_then(|n| n.to_str()).filter(|n| is_plain(n));
            let name = name.ok_or_else(|| WriteError::Name(path.to_owned()))?;
            let (obj, mtl) = export.to_obj(name);
            replace(&mtl_path, mtl.as_bytes())?;
            replace(path, obj.as_bytes())
        }
        _ => Err(WriteError::Format(path.to_owned())),
    }
}

/// Whether readers of OBJ take a name after `mtllib` for what it is.
fn is_plain(name: &str) -> bool {
    name.trim() == name && !name.contains(['\n', '\r', '#', '\\'])
}

pub(super) fn replace(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_atomically(path, |file| file.write_all(bytes))
        .map_err(|source| WriteError::Io { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::generate::{HouseOptions, house};

    #[test]
    fn files_are_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let building = house(&HouseOptions::default());
        for name in ["a.glb", "b.OBJ"] {
            fs::write(folder.path().join(name), "old").unwrap();
            write(&building, &folder.path().join(name)).unwrap();
        }
        let mut names: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["a.glb", "b.OBJ", "b.mtl"]);
        assert_eq!(fs::read(folder.path().join("a.glb")).unwrap(), building.to_glb());
        let obj = fs::read_to_string(folder.path().join("b.OBJ")).unwrap();
        assert!(obj.lines().any(|line| line == "mtllib b.mtl"));
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let building = house(&HouseOptions { furniture: false, ..HouseOptions::default() });
        let no_format = write(&building, Path::new("house.step")).unwrap_err();
        assert_eq!(no_format.to_string(), "house.step: the name must end in .glb or .obj");
        assert!(matches!(write(&building, Path::new("a#b.obj")), Err(WriteError::Name(_))));
        // A folder in the way: the temporary file goes again.
        let taken = folder.path().join("x.glb");
        fs::create_dir(&taken).unwrap();
        let error = write(&building, &taken).unwrap_err();
        assert!(matches!(&error, WriteError::Io { path, .. } if *path == taken), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
