//! Binary glTF files, by the specification.

use serde_json::Value;

/// The file of this JSON and this binary chunk.
pub fn of_json(json: &Value, bin: &[u8]) -> Vec<u8> {
    of_text(json.to_string().as_bytes(), bin)
}

/// The file of this text, which need be no JSON, and this binary chunk: its lengths are right.
pub fn of_text(text: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut file = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, body, padding) in [(b"JSON", text, b' '), (b"BIN\0", bin, 0)] {
        let length = body.len().next_multiple_of(4);
        file.extend((length as u32).to_le_bytes());
        file.extend(kind);
        file.extend(body);
        file.resize(file.len() + length - body.len(), padding);
    }
    let length = file.len() as u32;
    file[8..12].copy_from_slice(&length.to_le_bytes());
    file
}
