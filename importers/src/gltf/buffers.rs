//! The bytes behind buffers and buffer views.

use std::hash::Hasher;

use gltf::json;

use super::malformed;
use super::uri::Uris;
use crate::error::ImportError;
use crate::limits::Budget;

/// Where a buffer's bytes are.
#[derive(Debug)]
enum Bytes<'a> {
    /// In the binary chunk.
    Chunk(&'a [u8]),
    /// From a `uri`.
    Own(Vec<u8>),
    /// Nowhere: legal, as long as nothing reads it.
    Missing,
}

/// All buffers of a file.
#[derive(Debug)]
pub(super) struct Buffers<'a>(Vec<Bytes<'a>>);

/// Fetches all buffers, and adds those from other files to the hash, in order.
///
/// # Errors
/// A `uri` is refused or cannot be read, a buffer is shorter than it says, or over the budget.
pub(super) fn load<'a>(
    root: &json::Root,
    bin: Option<&'a [u8]>,
    uris: &Uris,
    budget: &mut Budget,
    hasher: &mut dyn Hasher,
) -> Result<Buffers<'a>, ImportError> {
    let mut all = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let place = format!("buffers[{index}]");
        let bytes = match (&buffer.uri, bin) {
            (Some(uri), _) => {
                let bytes = uris.read(uri, &format!("{place}.uri"), "buffers", budget)?;
                if !uri.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("data:")) {
                    hasher.write(&bytes);
                }
                check_length(&bytes, buffer.byte_length.0, &place)?;
                Bytes::Own(bytes)
            }
            (None, Some(bin)) if index == 0 => {
                check_length(bin, buffer.byte_length.0, &place)?;
                Bytes::Chunk(bin)
            }
            (None, _) => Bytes::Missing,
        };
        all.push(bytes);
    }
    Ok(Buffers(all))
}

/// Checks that a buffer is as long as its description says.
///
/// # Errors
/// It is shorter.
fn check_length(bytes: &[u8], stated: u64, place: &str) -> Result<(), ImportError> {
    if (bytes.len() as u64) < stated {
        return Err(malformed(place, format!("byteLength is {stated}, but there are {} bytes", bytes.len())));
    }
    Ok(())
}

impl Buffers<'_> {
    /// The bytes of buffer `index`, if it has any.
    pub fn get(&self, index: usize) -> Option<&[u8]> {
        match self.0.get(index)? {
            Bytes::Chunk(bytes) => Some(bytes),
            Bytes::Own(bytes) => Some(bytes),
            Bytes::Missing => None,
        }
    }

    /// The bytes of buffer view `index`, which must exist.
    ///
    /// # Errors
    /// The view goes over its buffer's end, or the buffer has no bytes.
    pub fn view(&self, root: &json::Root, index: usize) -> Result<&[u8], ImportError> {
        let place = || format!("bufferViews[{index}]");
        let Some(view) = root.buffer_views.get(index) else {
            return Err(malformed(place(), "no such buffer view"));
        };
        let Some(bytes) = self.get(view.buffer.value()) else {
            let text = format!("buffers[{}] has neither a uri nor a binary chunk", view.buffer);
            return Err(malformed(place(), text));
        };
        // Within what the buffer says, too: a binary chunk is padded.
        let stated = root.buffers.get(view.buffer.value()).map_or(0, |buffer| buffer.byte_length.0);
        let offset = view.byte_offset.unwrap_or_default().0;
        let length = view.byte_length.0;
        let end = offset.checked_add(length).filter(|&end| end <= stated && end <= bytes.len() as u64);
        match end {
            Some(end) => Ok(&bytes[offset as usize..end as usize]),
            None => {
                let text =
                    format!("bytes {offset} to {offset} + {length} go over the buffer's end at {stated}");
                Err(malformed(place(), text))
            }
        }
    }
}
