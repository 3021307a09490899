//! Which pages of a mapped file some work reads: as the operating system tells, which notes of each page that it was read.

use std::io::Write;

/// Pages of a mapped file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pages {
    /// Those that were read.
    pub read: u64,
    /// All.
    pub all: u64,
    /// How large one is, bytes.
    pub size: u64,
}

/// The pages of the mapped file that holds `address`, of which `work` reads some; `None` where the system does not tell (only Linux does), or
/// nothing is mapped there. What other threads of the program read meanwhile counts, too.
pub(crate) fn pages_read(address: usize, work: impl FnOnce()) -> Option<Pages> {
    if !cfg!(target_os = "linux") {
        work();
        return None;
    }
    let forget = || {
        let mut file = std::fs::OpenOptions::new().write(true).open("/proc/self/clear_refs")?;
        // All pages of the process count as not read (proc(5)).
        file.write_all(b"1")
    };
    let is_forgotten = forget().is_ok();
    forget_translations();
    work();
    let maps = std::fs::read_to_string("/proc/self/smaps").ok().filter(|_| is_forgotten)?;
    of_map(&maps, address)
}

/// Makes the processor forget where pages are: of those that it knows it does not note again that they are read. To take away more pages than it would
/// forget one by one makes it forget all.
fn forget_translations() {
    /// Linux takes away no more than 33 of them one by one.
    #[cfg(feature = "mmap")]
    const PAGES: usize = 256;
    #[cfg(feature = "mmap")]
    if let Ok(mut pages) = memmap2::MmapMut::map_anon(PAGES << 12) {
        pages.iter_mut().step_by(1 << 12).for_each(|byte| *byte = 1);
    }
}

/// The same of what `smaps` says.
fn of_map(maps: &str, address: usize) -> Option<Pages> {
    let range = |line: &str| {
        let (from, to) = line.split_whitespace().next()?.split_once('-')?;
        let number = |digits: &str| usize::from_str_radix(digits, 16).ok();
        Some(number(from)?..number(to)?)
    };
    let mut lines = maps.lines();
    let header = lines.by_ref().find(|line| range(line).is_some_and(|range| range.contains(&address)))?;
    // Of a file: after range, rights, offset, device and inode there is its name.
    header.split_whitespace().nth(5).filter(|name| name.starts_with('/'))?;
    let mut fields = lines.take_while(|line| range(line).is_none());
    let mut field = |name: &str| {
        let value = fields.find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
        value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| kilobytes << 10)
    };
    // In the order in which they stand there.
    let (all, size, read) = (field("Size")?, field("KernelPageSize")?, field("Referenced")?);
    (size > 0).then(|| Pages { read: read / size, all: all / size, size })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAPS: &str = "\
55d0c0000000-55d0c0002000 rw-p 00000000 00:00 0                          [heap]
Size:                  8 kB
KernelPageSize:        4 kB
Referenced:            8 kB
7f0000000000-7f0000100000 r--s 00000000 08:01 1234                       /tmp/house.enf
Size:               1024 kB
KernelPageSize:        4 kB
MMUPageSize:           4 kB
Rss:                1024 kB
Referenced:           40 kB
7f0000100000-7f0000200000 r--p 00000000 00:00 0
Size:               1024 kB
KernelPageSize:        4 kB
Referenced:          400 kB
";

    #[test]
    fn of_the_file_at_the_address() {
        let expected = Pages { read: 10, all: 256, size: 4096 };
        assert_eq!(of_map(MAPS, 0x7f00_0000_0000), Some(expected));
        assert_eq!(of_map(MAPS, 0x7f00_000f_ffff), Some(expected));
    }

    #[test]
    fn of_nothing_else() {
        for address in [0, 0x55d0_c000_0010, 0x7f00_0010_0000] {
            assert_eq!(of_map(MAPS, address), None);
        }
        assert_eq!(of_map("", 0), None);
    }
}
