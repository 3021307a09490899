//! Sections that opening reads whole, packed: smaller on the disk, and read back by all cores.
//!
//! Items go into chunks of as many as have [`CHUNK`] bytes at most. Of a chunk the first bytes of all its items come first, then the second bytes, and
//! so on: neighbours are much alike in most of their bytes, in coordinates as in indices. That is one block of LZ4, or, where it would be no smaller, left
//! as it is. The lengths of the blocks, u32 each, come before all of them.

use super::FormatError;
use super::storage::Storage;
use crate::parallel;

/// Bytes of a chunk at most. Below 65535 the blocks are the same on machines of any word size.
pub(super) const CHUNK: usize = 65_520;

/// Items may be no longer than this in packed sections.
const LONGEST: usize = 4096;

/// What LZ4 makes of one byte, at most.
const EXPANSION: usize = 255;

/// Bytes of a chunk of items of so many bytes.
fn chunk_of(item: usize) -> usize {
    CHUNK / item * item
}

/// The section packed, if that makes it smaller by a tenth at least.
#[cfg(feature = "compile")]
pub(super) fn pack(bytes: &[u8], item: usize) -> Option<Vec<u8>> {
    if item == 0 || item > LONGEST {
        return None;
    }
    let size = chunk_of(item);
    let blocks = parallel::map(bytes.len().div_ceil(size), |chunk| {
        let raw = &bytes[chunk * size..bytes.len().min((chunk + 1) * size)];
        let shuffled = shuffled(raw, item);
        let block = lz4_flex::block::compress(&shuffled);
        if block.len() < raw.len() { block } else { shuffled }
    });
    let mut packed: Vec<u8> = blocks.iter().flat_map(|block| (block.len() as u32).to_le_bytes()).collect();
    packed.extend(blocks.iter().flatten());
    (packed.len() < bytes.len() - bytes.len() / 10).then_some(packed)
}

/// The items of a section of `len` bytes that was packed.
///
/// # Errors
/// [`FormatError::Table`] if these bytes are none. No more memory is asked for than 255 times what they take.
pub(super) fn unpack(name: &str, packed: &[u8], len: u64, item: u64) -> Result<Storage, FormatError> {
    let bad = |what: &str| FormatError::Table(format!("section '{name}', packed: {what}"));
    let len = usize::try_from(len).map_err(|_| bad("it is too long"))?;
    let item = usize::try_from(item).ok().filter(|item| (1..=LONGEST).contains(item));
    let item = item.ok_or_else(|| bad("items of that size are never packed"))?;
    if !len.is_multiple_of(item) {
        return Err(bad("no whole number of items"));
    }
    let size = chunk_of(item);
    let count = len.div_ceil(size);
    let lengths = count.checked_mul(4).and_then(|end| packed.get(..end)).ok_or_else(|| bad("cut"))?;
    let mut blocks = Vec::with_capacity(count);
    let mut rest = &packed[4 * count..];
    for (chunk, length) in lengths.as_chunks::<4>().0.iter().enumerate() {
        let raw = size.min(len - chunk * size);
        let length = u32::from_le_bytes(*length) as usize;
        if length > raw || raw / EXPANSION > length {
            return Err(bad("a block is longer than its items, or too short for them"));
        }
        let (block, after) = rest.split_at_checked(length).ok_or_else(|| bad("cut"))?;
        blocks.push(block);
        rest = after;
    }
    if !rest.is_empty() {
        return Err(bad("bytes after its last block"));
    }
    Storage::made(len, |bytes| {
        parallel::try_for_chunks(bytes, size, |chunk, to| {
            let block = blocks[chunk];
            if block.len() == to.len() {
                unshuffle(block, to, item);
                return Ok(());
            }
            let mut shuffled = [0; CHUNK];
            let shuffled = &mut shuffled[..to.len()];
            match lz4_flex::block::decompress_into(block, shuffled) {
                Ok(length) if length == to.len() => unshuffle(shuffled, to, item),
                _ => return Err(bad("a block does not unpack to its items")),
            }
            Ok(())
        })
    })
}

/// The first bytes of all items, their second bytes...
#[cfg(feature = "compile")]
fn shuffled(items: &[u8], item: usize) -> Vec<u8> {
    (0..item).flat_map(|byte| items.iter().skip(byte).step_by(item).copied()).collect()
}

/// The items again.
fn unshuffle(shuffled: &[u8], items: &mut [u8], item: usize) {
    // Those that there are, with loops that the compiler can unroll.
    match item {
        4 => unshuffle_of::<4>(shuffled, items),
        12 => unshuffle_of::<12>(shuffled, items),
        24 => unshuffle_of::<24>(shuffled, items),
        _ => {
            let count = items.len() / item;
            for (index, to) in items.chunks_exact_mut(item).enumerate() {
                for (byte, to) in to.iter_mut().enumerate() {
                    *to = shuffled[byte * count + index];
                }
            }
        }
    }
}

fn unshuffle_of<const ITEM: usize>(shuffled: &[u8], items: &mut [u8]) {
    let items = items.as_chunks_mut::<ITEM>().0;
    let count = items.len();
    let planes: [&[u8]; ITEM] = std::array::from_fn(|byte| &shuffled[byte * count..][..count]);
    for (index, to) in items.iter_mut().enumerate() {
        for byte in 0..ITEM {
            to[byte] = planes[byte][index];
        }
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Items much like their neighbours; of noise.
    fn bytes(count: usize, item: usize, noise: bool) -> Vec<u8> {
        let mut random = crate::splitmix::SplitMix64::new(1);
        let byte =
            |i: usize| if noise { random.bits() as u8 } else { ((i / item / 7) >> (i % item).min(9)) as u8 };
        (0..count * item).map(byte).collect()
    }

    #[test]
    fn what_was_packed_is_unpacked() {
        for item in [1, 3, 4, 12, 24, 96, LONGEST] {
            for count in [1, 2, CHUNK / item - 1, CHUNK / item, CHUNK / item + 1, 3 * (CHUNK / item) + 5] {
                let whole = bytes(count, item, false);
                if let Some(packed) = pack(&whole, item) {
                    let back = unpack("a", &packed, whole.len() as u64, item as u64).unwrap();
                    assert!(back.bytes() == whole, "{count} items of {item}");
                } else {
                    assert!(whole.len() < 200 || item == LONGEST, "{count} items of {item}");
                }
            }
        }
        assert!(pack(&[], 4).is_none() && pack(&bytes(50_000, 4, true), 4).is_none());
        assert!(pack(&bytes(10, LONGEST + 1, false), LONGEST + 1).is_none());
        // A chunk that does not shrink, between two that do.
        let chunk = CHUNK / 12;
        let mixed = [bytes(chunk, 12, false), bytes(chunk, 12, true), bytes(chunk, 12, false)].concat();
        let packed = pack(&mixed, 12).unwrap();
        assert!(unpack("a", &packed, mixed.len() as u64, 12).unwrap().bytes() == mixed);
    }

    #[test]
    fn what_was_not_packed_is_refused() {
        let whole = bytes(20_000, 12, false);
        let packed = pack(&whole, 12).unwrap();
        let refused = |packed: &[u8], len: u64, item: u64| unpack("a", packed, len, item).is_err();
        let len = whole.len() as u64;
        assert!(!refused(&packed, len, 12));
        for (len, item) in [
            (len, 0),
            (len, 24 * 4096),
            (len + 12, 12),
            (len - 12, 12),
            (len + 1, 12),
            (u64::MAX / 12 * 12, 12),
        ] {
            assert!(refused(&packed, len, item), "{len} {item}");
        }
        assert!(refused(&[], len, 12) && !refused(&[], 0, 12) && refused(&[0], 0, 12));
        for cut in 0..64 {
            assert!(refused(&packed[..packed.len() * cut / 64], len, 12));
        }
        // A bomb: no memory is asked for.
        assert!(refused(&vec![255; 1 << 20], (1u64 << 40) / 12 * 12, 12));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn damage_never_panics(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        ) {
            let whole = bytes(12_000, 12, false);
            let mut packed = pack(&whole, 12).unwrap();
            for (at, to) in changes {
                let at = at.index(packed.len());
                packed[at] = to;
            }
            if let Ok(back) = unpack("a", &packed, whole.len() as u64, 12) {
                prop_assert_eq!(back.bytes().len(), whole.len());
            }
        }
    }
}
