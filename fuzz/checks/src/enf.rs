//! Scene files: taken apart and put together by `docs/FORMAT.md`, with the right offsets, lengths and checksums, and a
//! mutator that does so.

use enfilade::Scene;
use enfilade_testing::Random;
use twox_hash::XxHash3_64;

use crate::ask::{self, Origin};
use crate::numbers::change_number;

const HEADER: usize = 64;
const ENTRY: usize = 64;

/// More sections than this are not taken apart.
const MOST_SECTIONS: usize = 64;

/// Opens `file`, and asks the scene everything if it is one.
pub fn check(file: &[u8]) {
    match Scene::from_bytes(file) {
        Ok(mut scene) => ask::everything(&mut scene, Origin::Opened),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// A section: its row in the table without offset, length and checksum, and its bytes as they lie in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    name: [u8; 12],
    flags: u32,
    item: u64,
    /// Bytes of its items, if it is packed.
    unpacked: u64,
    bytes: Vec<u8>,
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|b| u64::from_le_bytes(*b))
}

/// The first bytes of `file`, up to the number of sections, and its sections; none if it is too damaged to tell.
pub fn sections(file: &[u8]) -> Option<([u8; 32], Vec<Section>)> {
    let head = *file.first_chunk::<32>()?;
    let count = (u32_at(file, 32)? as usize).min(MOST_SECTIONS);
    let section = |index: usize| {
        let row = file.get(HEADER + index * ENTRY..HEADER + (index + 1) * ENTRY)?;
        let start = usize::try_from(u64_at(row, 16)?).ok()?;
        let end = start.checked_add(usize::try_from(u64_at(row, 24)?).ok()?)?;
        let bytes = file.get(start..end)?.to_vec();
        let (flags, item, unpacked) = (u32_at(row, 12)?, u64_at(row, 32)?, u64_at(row, 48)?);
        Some(Section { name: *row.first_chunk()?, flags, item, unpacked, bytes })
    };
    Some((head, (0..count).map(section).collect::<Option<_>>()?))
}

/// The file that begins with `head` and holds `sections`, its lengths and checksums right.
pub fn file(head: &[u8; 32], sections: &[Section]) -> Vec<u8> {
    let mut file = head.to_vec();
    file.extend((sections.len() as u32).to_le_bytes());
    file.resize(HEADER + sections.len() * ENTRY, 0);
    for (index, section) in sections.iter().enumerate() {
        file.resize(file.len().next_multiple_of(64), 0);
        let row = HEADER + index * ENTRY;
        let mut put = |at: usize, bytes: &[u8]| file[row + at..row + at + bytes.len()].copy_from_slice(bytes);
        put(0, &section.name);
        put(12, &section.flags.to_le_bytes());
        put(24, &(section.bytes.len() as u64).to_le_bytes());
        put(32, &section.item.to_le_bytes());
        put(40, &XxHash3_64::oneshot(&section.bytes).to_le_bytes());
        put(48, &section.unpacked.to_le_bytes());
        let start = file.len() as u64;
        file[row + 16..row + 24].copy_from_slice(&start.to_le_bytes());
        file.extend(&section.bytes);
    }
    file.resize(file.len().next_multiple_of(64), 0);
    let length = file.len() as u64;
    file[24..32].copy_from_slice(&length.to_le_bytes());
    let table = &file[HEADER..HEADER + sections.len() * ENTRY];
    let checksum = XxHash3_64::oneshot(&[&file[..56], table].concat());
    file[56..64].copy_from_slice(&checksum.to_le_bytes());
    file
}

/// Mutates the file `data[..size]` to one of at most `max_size` bytes whose lengths and checksums are right, and returns
/// its size. `plain` is libFuzzer's own mutator.
pub fn mutate(
    data: &mut [u8],
    size: usize,
    max_size: usize,
    seed: u32,
    plain: fn(&mut [u8], usize, usize) -> usize,
) -> usize {
    let mut random = Random::new(u64::from(seed));
    let Some((mut head, mut sections)) = sections(&data[..size]) else { return plain(data, size, max_size) };
    for _ in 0..1 + random.below(3) {
        if sections.is_empty() || random.one_in(64) {
            change_number(&mut head, &mut random);
            continue;
        }
        let index = random.below(sections.len());
        if random.one_in(64) {
            mutate_table(&mut sections, index, &mut random);
        } else {
            mutate_items(&mut sections, index, &mut random, plain);
        }
    }
    let file = file(&head, &sections);
    if file.len() > max_size {
        return size;
    }
    data[..file.len()].copy_from_slice(&file);
    file.len()
}

/// Changes which sections there are, or what one's row says.
fn mutate_table(sections: &mut Vec<Section>, index: usize, random: &mut Random) {
    match random.below(7) {
        0 => drop(sections.remove(index)),
        1 if sections.len() < MOST_SECTIONS => sections.push(sections[index].clone()),
        2 => change_number(&mut sections[index].name, random),
        3 => sections[index].flags ^= *random.pick(&[1, 2]),
        4 => sections[index].item = *random.pick(&[0, 1, 4, 8, 24, u64::MAX]),
        5 => {
            let section = &mut sections[index];
            section.unpacked = *random.pick(&[0, section.item, section.unpacked / 2, u64::MAX]);
        }
        _ => {
            let other = random.below(sections.len());
            sections.swap(index, other);
        }
    }
}

/// Changes the items of a section: a number of one, libFuzzer's own way, one more or one less.
fn mutate_items(
    sections: &mut [Section],
    index: usize,
    random: &mut Random,
    plain: fn(&mut [u8], usize, usize) -> usize,
) {
    let counts: Vec<u32> = sections.iter().map(|s| (s.bytes.len() as u64 / s.item.max(1)) as u32).collect();
    let section = &mut sections[index];
    let item = usize::try_from(section.item.clamp(1, 4096)).unwrap_or(1);
    let count = section.bytes.len() / item;
    let one = random.below(count) * item;
    if count == 0 {
        section.bytes.resize(item, 0);
        return;
    }
    let (end, range) = (one + item, one..one + item);
    match random.below(12) {
        0 => drop(section.bytes.drain(range)),
        1 => section.bytes.extend_from_within(range),
        2 => {
            let to = random.below(count) * item;
            section.bytes.copy_within(range, to);
        }
        3 => section.bytes.truncate(one),
        4 | 5 => {
            let mut bytes = section.bytes[range.clone()].to_vec();
            let size = plain(&mut bytes, item, item);
            bytes[size..].fill(0);
            section.bytes[range].copy_from_slice(&bytes);
        }
        // An index at the end of another table.
        6..=8 if item >= 4 => {
            let at = one + random.below(item / 4) * 4;
            let number = random.pick(&counts).wrapping_sub(random.below(2) as u32)
                | (random.below(4) as u32 / 3) << 31;
            section.bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        }
        9 if item >= 8 => {
            // The same number twice.
            let (from, to) = (one + random.below(item / 8) * 8, one + random.below(item / 8) * 8);
            section.bytes.copy_within(from..from + 8, to);
        }
        _ => change_number(&mut section.bytes[one..end], random),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_make_the_file_again() {
        for (name, seed) in crate::seeds::enf() {
            let (head, sections) = sections(&seed).unwrap();
            assert_eq!(sections.len(), if name == "map" { 35 } else { 25 });
            assert!(file(&head, &sections) == seed, "{name}");
        }
    }

    #[test]
    fn checksums_of_mutated_files_are_right_and_some_open() {
        let plain = |_: &mut [u8], size: usize, _: usize| size;
        let seeds = crate::seeds::enf();
        assert_eq!(seeds[0].1[16], 0);
        assert_eq!(seeds[1].1[16], 1, "with packed sections");
        let (mut checksums, mut opened) = (0, 0);
        for round in 0..1000 {
            let seed = &seeds[round as usize % 2].1;
            let mut data = seed.clone();
            data.resize(seed.len() + 4096, 0);
            let max = data.len();
            let size = mutate(&mut data, seed.len(), max, round, plain);
            match Scene::from_bytes(&data[..size]) {
                Err(enfilade::format::FormatError::Checksum(_)) => checksums += 1,
                Err(_) => {}
                Ok(_) => opened += 1,
            }
        }
        assert_eq!(checksums, 0);
        assert!((200..900).contains(&opened), "{opened}");
    }
}
