//! Names for the pictures of several views.

use std::path::{Path, PathBuf};

/// The file for view `index` (from 0) of `count`: `path` itself for a single one, else with the view's number, from 1
/// and at least four digits, before the extension: `out.png` becomes `out.0001.png`.
pub fn numbered(path: &Path, index: usize, count: usize) -> PathBuf {
    if count <= 1 {
        return path.to_owned();
    }
    let digits = count.to_string().len().max(4);
    let number = format!("{:0digits$}", index + 1);
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    if !name.is_empty() {
        name.push(".");
    }
    name.push(number);
    if let Some(extension) = path.extension() {
        name.push(".");
        name.push(extension);
    }
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_go_before_the_extension() {
        let name = |path: &str, index, count| numbered(path.as_ref(), index, count).display().to_string();
        assert_eq!(name("a/out.png", 0, 1), "a/out.png");
        assert_eq!(name("a/out.png", 0, 2), "a/out.0001.png");
        assert_eq!(name("out.v2.exr", 11, 12), "out.v2.0012.exr");
        assert_eq!(name("out", 122, 20_000), "out.00123");
    }
}
