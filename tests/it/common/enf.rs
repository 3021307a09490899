//! Scene files taken apart and put together again, by `docs/FORMAT.md` and nothing else.

use twox_hash::XxHash3_64;

const HEADER: usize = 64;
const ENTRY: usize = 64;

/// One row of the section table.
#[derive(Clone, Debug)]
pub struct Section {
    pub name: String,
    /// First byte in the file.
    pub start: usize,
    pub length: usize,
    pub item: usize,
}

pub fn u32_at(file: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(file[at..at + 4].try_into().unwrap())
}

pub fn u64_at(file: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(file[at..at + 8].try_into().unwrap())
}

/// Writes `bytes` over those from `at` on.
pub fn put(file: &mut [u8], at: usize, bytes: &[u8]) {
    file[at..at + bytes.len()].copy_from_slice(bytes);
}

/// First byte of the row of section `index` in the table.
pub fn row(index: usize) -> usize {
    HEADER + index * ENTRY
}

/// The section table.
pub fn sections(file: &[u8]) -> Vec<Section> {
    let count = u32_at(file, 32) as usize;
    let section = |index| {
        let at = row(index);
        let name = file[at..at + 12].iter().take_while(|&&b| b != 0).map(|&b| b as char).collect();
        let number = |offset| u64_at(file, at + offset) as usize;
        Section { name, start: number(16), length: number(24), item: number(32) }
    };
    (0..count).map(section).collect()
}

/// The section with this name.
pub fn section(file: &[u8], name: &str) -> Section {
    sections(file).into_iter().find(|s| s.name == name).unwrap_or_else(|| panic!("no section {name}"))
}

/// Writes the checksums of all sections that lie in the file, and the header's.
pub fn seal(file: &mut [u8]) {
    for (index, section) in sections(file).into_iter().enumerate() {
        let end = section.start.saturating_add(section.length);
        if let Some(bytes) = file.get(section.start..end) {
            let hash = XxHash3_64::oneshot(bytes);
            put(file, row(index) + 40, &hash.to_le_bytes());
        }
    }
    seal_header(file);
}

/// Writes the header's checksum: of its first 56 bytes and the table.
pub fn seal_header(file: &mut [u8]) {
    let end = row(u32_at(file, 32) as usize);
    if let Some(table) = file.get(HEADER..end) {
        let hash = XxHash3_64::oneshot(&[&file[..56], table].concat());
        put(file, 56, &hash.to_le_bytes());
    }
}

/// The file with a section more at its end. The table grows, and all sections move by as much.
pub fn with_section(file: &[u8], name: &str, flags: u32, bytes: &[u8]) -> Vec<u8> {
    let count = u32_at(file, 32) as usize;
    let mut rows = file[HEADER..row(count)].to_vec();
    for at in (0..count).map(|index| index * ENTRY + 16) {
        let offset = u64_at(&rows, at) + ENTRY as u64;
        put(&mut rows, at, &offset.to_le_bytes());
    }
    let mut grown = file[..HEADER].to_vec();
    grown.extend(rows);
    let start = (file.len() + ENTRY) as u64;
    let mut entry = [0; ENTRY];
    put(&mut entry, 0, name.as_bytes());
    put(&mut entry, 12, &flags.to_le_bytes());
    for (at, number) in [(16, start), (24, bytes.len() as u64), (32, 1)] {
        put(&mut entry, at, &number.to_le_bytes());
    }
    grown.extend(entry);
    grown.extend(&file[row(count)..]);
    grown.extend(bytes);
    grown.resize(grown.len().next_multiple_of(64), 0);
    let length = grown.len() as u64;
    put(&mut grown, 24, &length.to_le_bytes());
    put(&mut grown, 32, &(count as u32 + 1).to_le_bytes());
    seal(&mut grown);
    grown
}
