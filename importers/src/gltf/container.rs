//! Finds the JSON and the binary chunk: `.glb` or plain JSON, by the first bytes.

use std::borrow::Cow;

use gltf::binary::{Error as GlbError, Glb};

use super::{fault, malformed};
use crate::error::{ImportError, ImportErrorKind};

/// A file's two parts.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The JSON text.
    pub json: Cow<'a, [u8]>,
    /// The binary chunk of a `.glb`.
    pub bin: Option<Cow<'a, [u8]>>,
}

/// Bytes of a GLB header, and of the first chunk's header behind it.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Splits `bytes`.
///
/// # Errors
/// A `.glb` whose lengths do not fit, or of another version than 2.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>, ImportError> {
    if !bytes.starts_with(b"glTF") {
        // A byte order mark is against the specification, which lets readers skip it.
        let json = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        return Ok(Container { json: Cow::Borrowed(json), bin: None });
    }
    let Some(length) = bytes.get(8..HEADER).and_then(|length| length.try_into().ok()).map(u32::from_le_bytes)
    else {
        return Err(malformed("GLB header", format!("the file ends after {} bytes", bytes.len())));
    };
    let length = length as usize;
    // The crate subtracts the header's size from this length unchecked, and takes bytes behind the file's stated
    // end for a chunk: it gets neither to see.
    if length < HEADER + CHUNK_HEADER {
        return Err(malformed(
            "GLB header",
            format!("the header states {length} bytes: no room for a chunk"),
        ));
    }
    let Some(stated) = bytes.get(..length) else {
        let text = format!("the header states {length} bytes, the file has {}", bytes.len());
        return Err(malformed("GLB header", text));
    };
    let glb = Glb::from_slice(stated).map_err(glb_error)?;
    Ok(Container { json: glb.json, bin: glb.bin })
}

fn glb_error(error: gltf::Error) -> ImportError {
    match error {
        gltf::Error::Binary(GlbError::Version(version)) => {
            let text = format!("GLB version {version}; enfilade reads version 2");
            fault("GLB header", ImportErrorKind::Unsupported(text))
        }
        gltf::Error::Binary(GlbError::ChunkLength { ty, length, length_read }) => {
            let text = format!("the {ty:?} chunk states {length} bytes, the file has {length_read}");
            malformed("GLB chunk", text)
        }
        gltf::Error::Binary(GlbError::UnknownChunkType(name)) => {
            malformed("GLB chunk", format!("unknown chunk '{}'", name.escape_ascii()))
        }
        other => malformed("GLB chunk", other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
        let glb = Glb {
            header: gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
            json: json.into(),
            bin: Some(bin.into()),
        };
        glb.to_vec().unwrap()
    }

    #[test]
    fn both_parts_are_found_and_bytes_behind_the_end_ignored() {
        let mut bytes = glb(b"{}", b"abcd");
        bytes.extend_from_slice(b"trailing");
        let container = split(&bytes).unwrap();
        assert_eq!(container.json.trim_ascii(), b"{}");
        assert_eq!(container.bin.as_deref(), Some(&b"abcd"[..]));
        assert_eq!(*split(b"\xEF\xBB\xBF{}").unwrap().json, *b"{}");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = glb(br#"{"asset":{"version":"2.0"}}"#, b"abcd");
        for end in 4..bytes.len() {
            let error = split(&bytes[..end]).unwrap_err();
            assert!(error.place.starts_with("GLB"), "{error}");
        }
    }

    #[test]
    fn wrong_lengths_and_versions_are_errors() {
        for length in [0u32, 3, 11, 12, 19, 1 << 31, u32::MAX] {
            let mut bytes = glb(b"{}", b"abcd");
            bytes[8..12].copy_from_slice(&length.to_le_bytes());
            assert!(split(&bytes).is_err(), "{length}");
        }
        let mut bytes = glb(b"{}", b"abcd");
        bytes[4] = 1;
        assert!(matches!(split(&bytes).unwrap_err().kind, ImportErrorKind::Unsupported(_)));
        bytes[4] = 2;
        bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(split(&bytes).unwrap_err().to_string().contains("chunk"));
    }
}
