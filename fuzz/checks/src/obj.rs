//! OBJ: one input is a model and, after a line `#library`, the material library beside it.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use enfilade::importers::obj;

use crate::{FILE, model, options, seeds};

/// The line between the model and its library.
pub const BETWEEN: &[u8] = b"\n#library\n";

/// The library's name, which the model must give.
pub const LIBRARY: &str = "a.mtl";

/// A picture that is always there.
pub const PICTURE: &str = "a.png";

/// Reads `input`, and goes on with the model if it is one.
pub fn check(input: &[u8]) {
    let (text, library) = split(input);
    match obj::read_text(text, FILE, library.map(beside), &options()) {
        Ok(read) => model::go_on(read),
        Err(error) => model::check_error(&error),
    }
}

/// The model's text, and the library's if there is one.
pub fn split(input: &[u8]) -> (&[u8], Option<&[u8]>) {
    match input.windows(BETWEEN.len()).position(|window| window == BETWEEN) {
        Some(at) => (&input[..at + 1], Some(&input[at + BETWEEN.len()..])),
        None => (input, None),
    }
}

/// The folder of this process, in which the library now has this text.
fn beside(library: &[u8]) -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = std::env::temp_dir().join(format!("enfilade-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
        std::fs::write(folder.join(PICTURE), seeds::PNG).expect("a picture can be written");
        folder
    });
    std::fs::write(folder.join(LIBRARY), library).expect("a library can be written");
    folder
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_cut_off() {
        let input = b"mtllib a.mtl\nf 1 2 3\n#library\nnewmtl x\n";
        assert_eq!(split(input), (&b"mtllib a.mtl\nf 1 2 3\n"[..], Some(&b"newmtl x\n"[..])));
        assert_eq!(split(b"v 1 2 3\n"), (&b"v 1 2 3\n"[..], None));
    }
}
