//! What a `uri` may refer to: data inside it, or a file in the model's folder or below.

use std::io;
use std::path::Path;

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

use super::fault;
use crate::error::{ImportError, ImportErrorKind};
use crate::folder::{self, Folder, FolderError, read_whole};
use crate::limits::Budget;

/// Exporters differ in whether they pad; nothing is lost by taking both.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Follows a model's URIs.
#[derive(Debug)]
pub(super) struct Uris(Option<Folder>);

/// What a `uri` refers to.
#[derive(Debug, PartialEq)]
enum Target<'a> {
    /// `data:`; the text behind the comma.
    Data { base64: bool, body: &'a str },
    /// A path that, taken by its letters, stays in the folder.
    File(String),
}

impl Uris {
    /// Those of the file at `path`: other files must be in its folder.
    pub fn of(path: &Path) -> Uris {
        Uris(Some(Folder::of(path)))
    }

    /// Those of a file without a folder: every reference to a file is an error.
    pub fn of_no_folder() -> Uris {
        Uris(None)
    }

    /// Refuses a `uri` that is no data and no file of the folder, without looking whether the file exists.
    ///
    /// # Errors
    /// Absolute paths, paths that climb out, schemes, backslashes.
    pub fn check(&self, uri: &str, place: &str) -> Result<(), ImportError> {
        target(uri).map(|_| ()).map_err(|kind| fault(place, kind))
    }

    /// The bytes that `uri` refers to; `what` names them for the `budget`, from which their size is taken.
    ///
    /// # Errors
    /// As [`Uris::check`]; a link that leads out; no such file, or it cannot be read; data that is no base64;
    /// over the budget.
    pub fn read(
        &self,
        uri: &str,
        place: &str,
        what: &str,
        budget: &mut Budget,
    ) -> Result<Vec<u8>, ImportError> {
        let bytes = match target(uri) {
            Ok(Target::Data { base64, body }) => read_data(base64, body, what, budget),
            Ok(Target::File(path)) => self.read_file(uri, &path, what, budget),
            Err(kind) => Err(kind),
        };
        bytes.map_err(|kind| fault(place, kind))
    }

    fn read_file(
        &self,
        uri: &str,
        path: &str,
        what: &str,
        budget: &mut Budget,
    ) -> Result<Vec<u8>, ImportErrorKind> {
        let Some(folder) = &self.0 else {
            let text = format!("'{}' is another file, and there is no folder to look in", short(uri));
            return Err(ImportErrorKind::Io(io::Error::new(io::ErrorKind::NotFound, text)));
        };
        let file = folder.resolve(path).map_err(|error| refusal(error, uri))?;
        read_whole(&file, budget, what).map_err(|kind| match kind {
            ImportErrorKind::Io(error) => refusal(error.into(), uri),
            kind => kind,
        })
    }
}

/// An error about the file that `uri` names.
fn refusal(error: FolderError, uri: &str) -> ImportErrorKind {
    match error {
        FolderError::Leaves => ImportErrorKind::LeavesFolder(short(uri)),
        FolderError::NoFile => ImportErrorKind::Unsupported(format!("'{}' is no regular file", short(uri))),
        FolderError::Unreadable(error) => {
            ImportErrorKind::Io(io::Error::new(error.kind(), format!("'{}': {error}", short(uri))))
        }
    }
}

fn read_data(base64: bool, body: &str, what: &str, budget: &mut Budget) -> Result<Vec<u8>, ImportErrorKind> {
    budget.take(body.len() as u64, what)?;
    // Percent codes are legal in any URI; in base64 exporters use them for `+`, `/` and `=`.
    let plain = percent_decode_str(body);
    if !base64 {
        return Ok(plain.collect());
    }
    let decoded =
        if body.contains('%') { BASE64.decode(plain.collect::<Vec<u8>>()) } else { BASE64.decode(body) };
    decoded.map_err(|e| ImportErrorKind::Malformed(format!("the data URI is no base64: {e}")))
}

fn target(uri: &str) -> Result<Target<'_>, ImportErrorKind> {
    if let Some(rest) = uri.get(..5).filter(|s| s.eq_ignore_ascii_case("data:")).and(uri.get(5..)) {
        let Some((kind, body)) = rest.split_once(',') else {
            return Err(ImportErrorKind::Malformed("the data URI has no comma".to_owned()));
        };
        let base64 = kind.rsplit(';').next().is_some_and(|last| last.eq_ignore_ascii_case("base64"));
        return Ok(Target::Data { base64, body });
    }
    let decoded = percent_decode_str(uri).decode_utf8().map_err(|_| {
        ImportErrorKind::Malformed(format!("'{}' is no UTF-8 once its % codes are decoded", short(uri)))
    })?;
    if decoded.is_empty() || decoded.contains('\0') {
        return Err(ImportErrorKind::Malformed(format!("'{}' is no file name", short(uri))));
    }
    match scheme(&decoded) {
        None => {}
        // A drive letter looks like a scheme of one letter.
        Some(scheme) if scheme.len() == 1 || scheme.eq_ignore_ascii_case("file") => {
            return Err(ImportErrorKind::LeavesFolder(short(uri)));
        }
        Some(scheme) => {
            let text =
                format!("'{}': files are read from the model's folder only, not by {scheme}:", short(uri));
            return Err(ImportErrorKind::Unsupported(text));
        }
    }
    if decoded.starts_with('/') {
        return Err(ImportErrorKind::LeavesFolder(short(uri)));
    }
    // A rule of URIs: dots that stay inside are taken out. What leads out keeps its dots, and is refused.
    let mut parts: Vec<&str> = Vec::new();
    for part in decoded.split('/') {
        match (part, parts.last()) {
            ("" | ".", _) => {}
            ("..", Some(&last)) if last != ".." => _ = parts.pop(),
            _ => parts.push(part),
        }
    }
    let path = parts.join("/");
    folder::check(&path).map_err(|error| refusal(error, uri))?;
    if path.is_empty() {
        return Err(ImportErrorKind::Malformed(format!("'{}' is no file name", short(uri))));
    }
    Ok(Target::File(path))
}

/// The scheme of an absolute URI, without the colon.
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let first = scheme.chars().next()?;
    let ok = first.is_ascii_alphabetic()
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '+' | '-' | '.'));
    ok.then_some(scheme)
}

/// A `uri` as messages show it: a hostile one may be megabytes long, or hold control characters.
fn short(uri: &str) -> String {
    let mut text: String = uri.chars().take(120).flat_map(char::escape_debug).collect();
    if uri.chars().nth(120).is_some() {
        text.push_str("...");
    }
    text
}

/// Whether the error is about a `uri` that is refused, rather than about a file that is missing or broken.
pub(super) fn is_refusal(error: &ImportError) -> bool {
    matches!(error.kind, ImportErrorKind::LeavesFolder(_) | ImportErrorKind::Unsupported(_))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    #[test]
    fn uris_that_leave_the_folder_are_refused() {
        let refused = [
            "../x.bin",
            "a/../../x.bin",
            "./../x.bin",
            "%2e%2e/x.bin",
            "%2E%2E%2Fx.bin",
            "/etc/passwd",
            "%2fetc/passwd",
            "//host/share/x.bin",
            "..\\x.bin",
            "a\\..\\..\\x.bin",
            "C:/x.bin",
            "C:\\x.bin",
            "c%3Ax.bin",
            "./C:/x.bin",
            "/",
            "file:///etc/passwd",
            "FILE:x.bin",
            "http://example.org/x.bin",
            "https://example.org/x.bin",
            "ftp:x.bin",
            "..",
        ];
        for uri in refused {
            let kind = target(uri).unwrap_err();
            assert!(is_refusal(&ImportError::new("", kind)), "{uri}");
        }
        for uri in ["", ".", "a/..", "%00", "a%ffb", "data:nothing"] {
            assert!(matches!(target(uri), Err(ImportErrorKind::Malformed(_))), "{uri}");
        }
    }

    #[test]
    fn names_in_the_folder_are_decoded() {
        let file = |name: &str| Target::File(name.to_owned());
        assert_eq!(target("x.bin").unwrap(), file("x.bin"));
        assert_eq!(target("a/../b/./x.bin").unwrap(), file("b/x.bin"));
        assert_eq!(target("a//.././/b//x.bin").unwrap(), file("b/x.bin"));
        assert_eq!(target("T%C3%BCr%20%231.bin").unwrap(), file("Tür #1.bin"));
        assert_eq!(target("Tür.bin").unwrap(), file("Tür.bin"));
        assert_eq!(target("1:2.bin").unwrap(), file("1:2.bin"));
    }

    #[test]
    fn data_uris_are_decoded_with_and_without_padding() {
        let mut budget = Budget::new(&Limits::default());
        let mut read = |uri: &str| Uris::of_no_folder().read(uri, "buffers[0].uri", "a buffer", &mut budget);
        assert_eq!(read("data:application/octet-stream;base64,AQID/w==").unwrap(), [1, 2, 3, 255]);
        assert_eq!(read("DATA:;BASE64,AQID/w").unwrap(), [1, 2, 3, 255]);
        assert_eq!(read("data:;base64,AQID%2Fw%3D%3D").unwrap(), [1, 2, 3, 255]);
        assert_eq!(read("data:,a%20b").unwrap(), b"a b");
        let error = read("data:;base64,A$ID").unwrap_err();
        assert_eq!(error.place, "buffers[0].uri");
        assert!(matches!(error.kind, ImportErrorKind::Malformed(_)));
        assert!(matches!(read("x.bin").unwrap_err().kind, ImportErrorKind::Io(_)));
    }

    #[test]
    fn messages_stay_short() {
        let uri = format!("../{}\u{1b}", "x".repeat(1_000_000));
        assert!(target(&uri).unwrap_err().to_string().len() < 300);
    }
}
