//! glTF: binary files taken apart and put together with the right lengths, a mutator that does so, and what each file
//! goes through.

use enfilade::importers::gltf;
use enfilade_testing::Random;
use serde_json::Value;

use crate::numbers::change_number;
use crate::{FILE, json, model, options};

/// Reads `file`, and goes on with the model if it is one.
pub fn check(file: &[u8]) {
    match gltf::read_slice(file, FILE, &options()) {
        Ok(read) => model::go_on(read),
        Err(error) => model::check_error(&error),
    }
}

/// A glTF file in its parts.
pub struct Parts {
    /// The text.
    pub json: Vec<u8>,
    /// The binary chunk; none for a `.gltf`.
    pub bin: Option<Vec<u8>>,
}

impl Parts {
    /// The parts of `file`, however its lengths may be wrong.
    pub fn of(file: &[u8]) -> Parts {
        if !file.starts_with(b"glTF") {
            return Parts { json: file.to_vec(), bin: None };
        }
        let (json, rest) = chunk(file.get(12..).unwrap_or(&[]));
        let (bin, _) = chunk(rest);
        Parts { json: json.to_vec(), bin: Some(bin.to_vec()) }
    }

    /// The file of these parts, with the lengths that belong to them.
    pub fn file(&self) -> Vec<u8> {
        let Some(bin) = &self.bin else { return self.json.clone() };
        enfilade_testing::glb::of_text(&self.json, bin)
    }
}

/// The body of the chunk at the start of `bytes`, cut where they end, and what follows it.
fn chunk(bytes: &[u8]) -> (&[u8], &[u8]) {
    let Some((head, body)) = bytes.split_first_chunk::<8>() else { return (&[], &[]) };
    let length = u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize;
    body.split_at(length.min(body.len()))
}

/// Mutates the file `data[..size]` to one of at most `max_size` bytes, and returns its size. `plain` is libFuzzer's own
/// mutator.
pub fn mutate(
    data: &mut [u8],
    size: usize,
    max_size: usize,
    seed: u32,
    plain: fn(&mut [u8], usize, usize) -> usize,
) -> usize {
    let mut random = Random::new(u64::from(seed));
    // The container itself.
    if random.one_in(10) {
        return plain(data, size, max_size);
    }
    let mut parts = Parts::of(&data[..size]);
    let of_bytes = |bytes: &mut Vec<u8>| {
        let size = bytes.len();
        bytes.resize(size + 64, 0);
        let size = plain(bytes, size, size + 64);
        bytes.truncate(size);
    };
    match (random.below(8), &mut parts.bin) {
        (0, _) => of_bytes(&mut parts.json),
        (1, Some(bin)) => of_bytes(bin),
        (2, Some(bin)) => change_number(bin, &mut random),
        _ => match serde_json::from_slice::<Value>(&parts.json) {
            Ok(mut tree) => {
                for _ in 0..1 + random.below(3) {
                    json::mutate(&mut tree, &mut random);
                }
                parts.json = tree.to_string().into_bytes();
            }
            Err(_) => of_bytes(&mut parts.json),
        },
    }
    let file = parts.file();
    if file.len() > max_size {
        return plain(data, size, max_size);
    }
    data[..file.len()].copy_from_slice(&file);
    file.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_the_file_again() {
        for (name, seed) in crate::seeds::gltf() {
            assert!(Parts::of(&seed).file() == seed, "{name}");
        }
        for cut in [0, 3, 4, 11, 12, 19, 20, 40] {
            let seed = &crate::seeds::gltf()[0].1;
            let file = Parts::of(&seed[..cut]).file();
            assert_eq!(file.starts_with(b"glTF"), cut >= 4);
        }
    }

    #[test]
    fn most_mutated_files_are_still_containers() {
        let plain = |_: &mut [u8], size: usize, _: usize| size;
        let seed = &crate::seeds::gltf()[0].1;
        let mut whole = 0;
        for round in 0..500 {
            let mut data = seed.clone();
            data.resize(seed.len() + 4096, 0);
            let max = data.len();
            let size = mutate(&mut data, seed.len(), max, round, plain);
            let parts = Parts::of(&data[..size]);
            assert!(parts.file() == data[..size]);
            whole += usize::from(serde_json::from_slice::<Value>(&parts.json).is_ok());
        }
        assert_eq!(whole, 500);
    }
}
