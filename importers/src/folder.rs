//! Files that a model refers to: only such as lie in the model's own folder.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::error::ImportErrorKind;
use crate::limits::Budget;

/// The folder of a model.
#[derive(Clone, Debug)]
pub(crate) struct Folder(PathBuf);

/// Why a reference cannot be followed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FolderError {
    /// It leads out of the folder, or may do so on some system.
    #[error("it leaves the model's folder")]
    Leaves,
    /// It is a folder, a pipe, a device.
    #[error("it is no regular file")]
    NoFile,
    /// There is no such file, or the system does not let it be looked at.
    #[error("{0}")]
    Unreadable(#[from] io::Error),
}

impl Folder {
    /// The folder that holds the model file `path`.
    pub(crate) fn of(path: &Path) -> Folder {
        match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => Folder(parent.to_owned()),
            _ => Folder(PathBuf::from(".")),
        }
    }

    /// The folder `path` itself.
    #[cfg(feature = "obj")]
    pub(crate) fn at(path: &Path) -> Folder {
        Folder(path.to_owned())
    }

    /// The regular file in this folder, or below, that `reference` names: as [`check`] has it, and no link leads out.
    pub(crate) fn resolve(&self, reference: &str) -> Result<PathBuf, FolderError> {
        check(reference)?;
        if reference.is_empty() {
            return Err(io::Error::new(io::ErrorKind::NotFound, "an empty name").into());
        }
        let folder = self.0.canonicalize()?;
        let file = folder.join(reference).canonicalize()?;
        if !file.starts_with(&folder) {
            return Err(FolderError::Leaves);
        }
        // A pipe or a device could block, or never end.
        if !file.metadata()?.is_file() {
            return Err(FolderError::NoFile);
        }
        Ok(file)
    }
}

/// Refuses what, by its letters, is no path with `/` between folders that stays below where it starts: absolute paths,
/// `..`, drive letters and backslashes, the same on every system. Whether there is such a file is not looked at.
pub(crate) fn check(reference: &str) -> Result<(), FolderError> {
    let drive = reference.as_bytes().get(1) == Some(&b':')
        && reference.as_bytes().first().is_some_and(u8::is_ascii_alphabetic);
    let leaves = drive
        || reference.starts_with('/')
        || reference.contains(['\\', '\0'])
        || reference.split('/').any(|part| part == "..")
        || Path::new(reference).is_absolute();
    if leaves { Err(FolderError::Leaves) } else { Ok(()) }
}

/// All bytes of `file`, taken from `budget` for `what`; the caller gives them back.
///
/// # Errors
/// The file cannot be read, or over the budget: nothing stays taken then.
pub(crate) fn read_whole(file: &Path, budget: &mut Budget, what: &str) -> Result<Vec<u8>, ImportErrorKind> {
    let file = File::open(file)?;
    let size = file.metadata()?.len();
    budget.take(size, what)?;
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0));
    // Not more than was paid for, even if the file grows meanwhile or is none (a device's length is 0).
    match file.take(size).read_to_end(&mut bytes) {
        Ok(_) => Ok(bytes),
        Err(error) => {
            budget.give_back(size);
            Err(error.into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    #[test]
    fn only_files_in_the_folder_are_found() {
        let outer = tempfile::tempdir().unwrap();
        let inner = outer.path().join("model");
        std::fs::create_dir_all(inner.join("sub")).unwrap();
        std::fs::write(outer.path().join("secret"), "s").unwrap();
        std::fs::write(inner.join("a b.mtl"), "a").unwrap();
        std::fs::write(inner.join("sub/c.png"), "c").unwrap();
        let folder = Folder::of(&inner.join("house.obj"));
        for fine in ["a b.mtl", "./a b.mtl", "sub/c.png", "sub//c.png"] {
            assert!(folder.resolve(fine).is_ok(), "{fine}");
        }
        let secret = outer.path().join("secret");
        for bad in [
            "../secret",
            "sub/../a b.mtl",
            "..",
            "/etc/hostname",
            secret.to_str().unwrap(),
            "C:\\a.mtl",
            "c:a.mtl",
            "sub\\c.png",
            "..\\secret",
            "\\\\server\\share",
        ] {
            assert!(matches!(folder.resolve(bad), Err(FolderError::Leaves)), "{bad}");
            assert!(check(bad).is_err(), "{bad}");
        }
        for missing in ["", "b.mtl", "sub/b.mtl"] {
            assert!(matches!(folder.resolve(missing), Err(FolderError::Unreadable(_))), "{missing}");
        }
        for no_file in ["sub", ".", "sub/"] {
            assert!(matches!(folder.resolve(no_file), Err(FolderError::NoFile)), "{no_file}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_may_not_lead_out() {
        let outer = tempfile::tempdir().unwrap();
        let inner = outer.path().join("model");
        std::fs::create_dir(&inner).unwrap();
        std::fs::write(outer.path().join("secret"), "s").unwrap();
        std::fs::write(inner.join("a"), "a").unwrap();
        std::os::unix::fs::symlink("../secret", inner.join("out")).unwrap();
        std::os::unix::fs::symlink("a", inner.join("in")).unwrap();
        std::os::unix::fs::symlink("..", inner.join("up")).unwrap();
        let folder = Folder::of(&inner.join("house.obj"));
        assert!(folder.resolve("in").is_ok());
        assert!(matches!(folder.resolve("out"), Err(FolderError::Leaves)));
        assert!(matches!(folder.resolve("up/secret"), Err(FolderError::Leaves)));
    }

    #[test]
    fn reading_is_paid_from_the_budget() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        std::fs::write(&file, [7; 1000]).unwrap();
        let mut budget = Budget::new(&Limits::default().with_max_memory(1500));
        assert_eq!(read_whole(&file, &mut budget, "a").unwrap().len(), 1000);
        assert_eq!(budget.used(), 1000);
        assert!(matches!(read_whole(&file, &mut budget, "a"), Err(ImportErrorKind::OverBudget(_))));
    }
}
