//! The container: header, section table, sections. Knows nothing of what the sections hold.
//!
//! ```text
//! 0    magic 89 45 4E 46 0D 0A 1A 0A, version u32, endianness mark u32
//! 16   required feature bits u64, length of the file u64
//! 32   number of sections u32, zero u32, zero u64
//! 48   zero u64, XXH3-64 of bytes 0..56 and of the section table u64
//! 64   section table: 64 bytes a section
//! ...  sections, each from a multiple of 64 on, gaps filled with zeros
//! ```

use bytemuck::{Pod, Zeroable};
#[cfg(any(test, feature = "compile"))]
use bytemuck::{bytes_of, cast_slice};
use twox_hash::XxHash3_64;

use super::FormatError;

/// The first eight bytes. As PNG's: a high bit, letters, and line ends of both kinds, so that a transfer as text shows.
pub const MAGIC: [u8; 8] = *b"\x89ENF\r\n\x1a\n";

/// Rises when readers of an older version would read a newer file wrongly.
pub const VERSION: u32 = 7;

/// Reads differently where bytes are swapped.
pub const ENDIAN_MARK: u32 = 0x0A0B_0C0D;

/// The feature bit of files with sections that are packed.
pub const PACKED_FEATURE: u64 = 1;

/// Feature bits that this version knows. A file that requires another is refused.
pub const KNOWN_FEATURES: u64 = PACKED_FEATURE;

/// Sections start at multiples of this.
pub const ALIGN: usize = 64;

/// More sections than any writer makes.
const MAX_SECTIONS: u32 = 4096;

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Header {
    magic: [u8; 8],
    version: u32,
    endian_mark: u32,
    features: u64,
    file_len: u64,
    section_count: u32,
    reserved: [u32; 5],
    checksum: u64,
}

const HEADER_LEN: usize = 64;

/// One row of the section table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct SectionEntry {
    /// Name: up to 12 ASCII letters, filled with zeros.
    pub name: [u8; 12],
    /// Bit 0: a reader that does not know this section must refuse the file. Bit 1: it is packed.
    pub flags: u32,
    /// First byte, from the start of the file; a multiple of 64.
    pub offset: u64,
    /// Bytes in the file.
    pub len: u64,
    /// Bytes of one item.
    pub item_size: u64,
    /// XXH3-64 of the bytes in the file.
    pub checksum: u64,
    /// Bytes of all items, of a packed section; else zero.
    pub unpacked: u64,
    /// Zero.
    pub reserved: u64,
}

impl SectionEntry {
    /// The flag of sections that a reader must know.
    pub const REQUIRED: u32 = 1;

    /// The flag of sections that are packed (`packed`).
    pub const PACKED: u32 = 2;

    /// Whether its items must be unpacked.
    pub fn is_packed(&self) -> bool {
        self.flags & SectionEntry::PACKED != 0
    }

    /// Where it lies in the file.
    pub(super) fn range(&self) -> std::ops::Range<usize> {
        self.offset as usize..(self.offset + self.len) as usize
    }

    /// The name as text.
    pub fn name(&self) -> String {
        let end = self.name.iter().position(|&b| b == 0).unwrap_or(self.name.len());
        String::from_utf8_lossy(&self.name[..end]).into_owned()
    }
}

#[cfg(any(test, feature = "compile"))]
fn padded(len: usize) -> usize {
    len.div_ceil(ALIGN) * ALIGN
}

#[cfg(any(test, feature = "compile"))]
fn name_bytes(name: &str) -> [u8; 12] {
    let mut bytes = [0; 12];
    for (to, from) in bytes.iter_mut().zip(name.bytes()) {
        *to = from;
    }
    bytes
}

/// A section to be written.
#[cfg(any(test, feature = "compile"))]
pub struct NewSection<'a> {
    /// Up to 12 ASCII letters.
    pub name: &'static str,
    /// Whether readers that do not know it must refuse the file.
    pub required: bool,
    /// Bytes of one item.
    pub item_size: usize,
    /// The items.
    pub bytes: &'a [u8],
    /// What they are packed to, if they are (`packed`).
    pub packed: Option<Vec<u8>>,
}

#[cfg(any(test, feature = "compile"))]
impl NewSection<'_> {
    /// The bytes in the file.
    fn stored(&self) -> &[u8] {
        self.packed.as_deref().unwrap_or(self.bytes)
    }
}

/// The whole file with these sections.
#[cfg(any(test, feature = "compile"))]
pub fn write(sections: &[NewSection<'_>]) -> Vec<u8> {
    let is_packed = sections.iter().any(|section| section.packed.is_some());
    let mut offset = padded(HEADER_LEN + sections.len() * size_of::<SectionEntry>());
    let mut table = Vec::with_capacity(sections.len());
    for section in sections {
        let stored = section.stored();
        let (is_packed, required) = (section.packed.is_some(), section.required);
        table.push(SectionEntry {
            name: name_bytes(section.name),
            flags: SectionEntry::REQUIRED * u32::from(required) + SectionEntry::PACKED * u32::from(is_packed),
            offset: offset as u64,
            len: stored.len() as u64,
            item_size: section.item_size as u64,
            checksum: XxHash3_64::oneshot(stored),
            unpacked: if is_packed { section.bytes.len() as u64 } else { 0 },
            reserved: 0,
        });
        offset = padded(offset + stored.len());
    }
    let mut header = Header {
        magic: MAGIC,
        version: VERSION,
        endian_mark: ENDIAN_MARK,
        features: if is_packed { PACKED_FEATURE } else { 0 },
        file_len: offset as u64,
        section_count: sections.len() as u32,
        reserved: [0; 5],
        checksum: 0,
    };
    header.checksum = checksum(bytes_of(&header), cast_slice(&table));
    let mut file = Vec::with_capacity(offset);
    file.extend_from_slice(bytes_of(&header));
    file.extend_from_slice(cast_slice(&table));
    for section in sections {
        file.resize(padded(file.len()), 0);
        file.extend_from_slice(section.stored());
    }
    file.resize(offset, 0);
    file
}

/// Of the header without its last 8 bytes, and of the table.
fn checksum(header: &[u8], table: &[u8]) -> u64 {
    XxHash3_64::oneshot(&[&header[..HEADER_LEN - 8], table].concat())
}

/// Checks header and table of `file` and returns the table. Every entry lies within the file, aligned, and holds a
/// whole number of items.
///
/// # Errors
/// [`FormatError`] for anything else; never panics.
pub fn read_table(file: &[u8]) -> Result<Vec<SectionEntry>, FormatError> {
    if cfg!(target_endian = "big") {
        return Err(FormatError::BigEndianMachine);
    }
    let start = file
        .get(..HEADER_LEN)
        .ok_or(FormatError::TooShort { needs: HEADER_LEN as u64, has: file.len() as u64 })?;
    let header: Header = bytemuck::pod_read_unaligned(start);
    if header.magic != MAGIC {
        return Err(FormatError::Magic);
    }
    if header.endian_mark != ENDIAN_MARK {
        return Err(FormatError::Endianness);
    }
    if header.version != VERSION {
        return Err(FormatError::Version { found: header.version, known: VERSION });
    }
    if header.features & !KNOWN_FEATURES != 0 {
        return Err(FormatError::Features(header.features & !KNOWN_FEATURES));
    }
    if header.file_len != file.len() as u64 {
        return Err(FormatError::TooShort { needs: header.file_len, has: file.len() as u64 });
    }
    if header.section_count > MAX_SECTIONS {
        return Err(FormatError::Table(format!("{} sections", header.section_count)));
    }
    let table_end = HEADER_LEN + header.section_count as usize * size_of::<SectionEntry>();
    let table_bytes = file
        .get(HEADER_LEN..table_end)
        .ok_or(FormatError::TooShort { needs: table_end as u64, has: file.len() as u64 })?;
    if checksum(start, table_bytes) != header.checksum {
        return Err(FormatError::Checksum("header".to_owned()));
    }
    let table: Vec<SectionEntry> =
        table_bytes.chunks_exact(size_of::<SectionEntry>()).map(bytemuck::pod_read_unaligned).collect();
    let mut last_end = table_end as u64;
    for entry in &table {
        let bad = |what: &str| FormatError::Table(format!("section '{}': {what}", entry.name()));
        let end = entry.offset.checked_add(entry.len).ok_or_else(|| bad("its length overflows"))?;
        if end > file.len() as u64 {
            return Err(bad("it runs past the end of the file"));
        }
        if entry.offset < last_end || !entry.offset.is_multiple_of(ALIGN as u64) {
            return Err(bad("it overlaps an earlier one or is not aligned"));
        }
        let items = if entry.is_packed() { entry.unpacked } else { entry.len };
        if entry.item_size == 0 || !items.is_multiple_of(entry.item_size) {
            return Err(bad("its length is no whole number of items"));
        }
        last_end = end;
    }
    Ok(table)
}

/// Whether `bytes`, as they lie in the file, are those that a section was written with.
///
/// # Errors
/// [`FormatError::Checksum`].
pub fn check(bytes: &[u8], entry: &SectionEntry) -> Result<(), FormatError> {
    if XxHash3_64::oneshot(bytes) == entry.checksum {
        Ok(())
    } else {
        Err(FormatError::Checksum(entry.name()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section<'a>(file: &'a [u8], entry: &SectionEntry) -> Result<&'a [u8], FormatError> {
        let bytes = &file[entry.range()];
        check(bytes, entry).map(|()| bytes)
    }

    fn example() -> Vec<u8> {
        write(&[
            NewSection {
                name: "numbers",
                required: true,
                item_size: 4,
                bytes: &[1, 2, 3, 4, 5, 6, 7, 8],
                packed: None,
            },
            NewSection { name: "text", required: false, item_size: 1, bytes: b"hello", packed: None },
        ])
    }

    #[test]
    fn what_is_written_is_read() {
        let file = example();
        assert_eq!(file.len() % ALIGN, 0);
        let table = read_table(&file).unwrap();
        assert_eq!(table.len(), 2);
        assert_eq!(table[1].name(), "text");
        assert_eq!(section(&file, &table[1]).unwrap(), b"hello");
    }

    #[test]
    fn every_changed_byte_is_noticed() {
        let file = example();
        let table = read_table(&file).unwrap();
        let used = |i: usize| {
            i < HEADER_LEN + 2 * size_of::<SectionEntry>()
                || table.iter().any(|e| (e.offset..e.offset + e.len).contains(&(i as u64)))
        };
        for i in 0..file.len() {
            let mut changed = file.clone();
            changed[i] ^= 0x10;
            let outcome = read_table(&changed)
                .and_then(|t| t.iter().try_for_each(|entry| section(&changed, entry).map(|_| ())));
            assert_eq!(outcome.is_err(), used(i), "byte {i}");
        }
        for len in 0..file.len() {
            assert!(read_table(&file[..len]).is_err());
        }
    }
}
