//! Statements of an OBJ or MTL file, one at a time, with their line numbers, whatever the line ends.

use std::hash::Hasher;
use std::io::{self, BufRead, Read};

use twox_hash::XxHash3_64;

use crate::limits::{Budget, OverBudget};

/// Lines up to this many bytes are free; a longer one takes [`LINE_COST`] bytes of budget per byte.
const FREE_LINE: usize = 1 << 16;

/// What one byte of a line costs at most on its way: this buffer, the rewritten line, the parser's copy, and 24
/// bytes for each corner of a face, of which one fits into two bytes; twice each, as vectors double.
const LINE_COST: u64 = 32;

/// Counts and hashes the bytes that are read through it.
pub(super) struct Hashing<R> {
    source: R,
    hash: XxHash3_64,
    bytes: u64,
}

impl<R: Read> Hashing<R> {
    pub(super) fn new(source: R) -> Hashing<R> {
        Hashing { source, hash: XxHash3_64::new(), bytes: 0 }
    }

    pub(super) fn bytes_read(&self) -> u64 {
        self.bytes
    }

    pub(super) fn into_hash(self) -> XxHash3_64 {
        self.hash
    }
}

impl<R: Read> Read for Hashing<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(buffer)?;
        self.hash.write(&buffer[..count]);
        self.bytes += count as u64;
        Ok(count)
    }
}

/// Why there is no next statement.
#[derive(Debug)]
pub(super) enum LineError {
    Io(io::Error),
    OverBudget(OverBudget),
}

impl From<io::Error> for LineError {
    fn from(error: io::Error) -> LineError {
        LineError::Io(error)
    }
}

impl From<OverBudget> for LineError {
    fn from(error: OverBudget) -> LineError {
        LineError::OverBudget(error)
    }
}

/// Splits a text into statements: at LF, CRLF or CR, but not after a backslash, which joins the next line with a
/// blank between (not at the end of a comment: Windows paths end so). A byte order mark is taken off.
pub(super) struct Lines<R> {
    source: R,
    text: Vec<u8>,
    /// Line of the statement's first byte, and of its last, from 1.
    first: u64,
    last: u64,
    /// The last line ended with CR: an LF that follows belongs to it.
    after_cr: bool,
    granted: usize,
    taken: u64,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(source: R) -> Lines<R> {
        Lines { source, text: Vec::new(), first: 0, last: 0, after_cr: false, granted: FREE_LINE, taken: 0 }
    }

    /// Goes to the next statement; `false` at the end.
    pub(super) fn advance(&mut self, budget: &mut Budget) -> Result<bool, LineError> {
        self.text.clear();
        let mut any = false;
        let mut is_comment = false;
        while self.physical_line(budget)? {
            self.last += 1;
            if !any {
                any = true;
                self.first = self.last;
                if self.last == 1 && self.text.starts_with(b"\xef\xbb\xbf") {
                    self.text.drain(..3);
                }
                is_comment = self.text.trim_ascii_start().starts_with(b"#");
            }
            match self.text.last_mut() {
                Some(end) if *end == b'\\' && !is_comment => *end = b' ',
                _ => break,
            }
        }
        Ok(any)
    }

    /// The statement, without its line end.
    pub(super) fn text(&self) -> &[u8] {
        &self.text
    }

    /// The line where the statement starts, from 1.
    pub(super) fn number(&self) -> u64 {
        self.first
    }

    /// What is read from.
    pub(super) fn source(&self) -> &R {
        &self.source
    }

    /// What was read from, and the bytes of budget that the lines took: free again now.
    pub(super) fn into_source(self) -> (R, u64) {
        (self.source, self.taken)
    }

    /// Adds the next line to the text; `false` if there is none.
    fn physical_line(&mut self, budget: &mut Budget) -> Result<bool, LineError> {
        let mut any = false;
        loop {
            let chunk = match self.source.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                other => other?,
            };
            if chunk.is_empty() {
                return Ok(any);
            }
            if std::mem::take(&mut self.after_cr) && chunk[0] == b'\n' {
                self.source.consume(1);
                continue;
            }
            any = true;
            let end = chunk.iter().position(|&b| b == b'\n' || b == b'\r');
            let line = &chunk[..end.unwrap_or(chunk.len())];
            let length = self.text.len() + line.len();
            if length > self.granted {
                let more = (length - self.granted).max(self.granted);
                let cost = (more as u64).saturating_mul(LINE_COST);
                budget.take(cost, "a long line")?;
                self.granted += more;
                self.taken += cost;
            }
            self.text.extend_from_slice(line);
            let used = line.len();
            match end {
                Some(end) => {
                    self.after_cr = chunk[end] == b'\r';
                    self.source.consume(used + 1);
                    return Ok(true);
                }
                None => self.source.consume(used),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn split(text: &[u8], chunk: usize) -> Vec<(u64, String)> {
        let mut budget = Budget::new(&Limits::default());
        let mut lines = Lines::new(io::BufReader::with_capacity(chunk, text));
        let mut all = Vec::new();
        while lines.advance(&mut budget).unwrap() {
            all.push((lines.number(), String::from_utf8_lossy(lines.text()).into_owned()));
        }
        all
    }

    #[test]
    fn all_line_ends_continuations_and_the_byte_order_mark() {
        let text = b"\xef\xbb\xbfv 1\r\n\nf 1 2 \\\r\n3 \\\n4\r# C:\\\ro a\\b\nlast\\";
        let expected = ["v 1", "", "f 1 2  3  4", "# C:\\", "o a\\b", "last "];
        let numbers = [1, 2, 3, 6, 7, 8];
        for chunk in [1, 2, 3, 7, 1000] {
            let all = split(text, chunk);
            assert_eq!(all.iter().map(|l| l.1.as_str()).collect::<Vec<_>>(), expected, "chunk {chunk}");
            assert_eq!(all.iter().map(|l| l.0).collect::<Vec<_>>(), numbers, "chunk {chunk}");
        }
        assert!(split(b"", 10).is_empty());
    }

    #[test]
    fn a_line_longer_than_the_budget_is_refused() {
        let text = vec![b'x'; 3_000_000];
        let mut budget = Budget::new(&Limits::default().with_max_memory(20_000_000));
        let mut lines = Lines::new(io::BufReader::new(&text[..]));
        assert!(matches!(lines.advance(&mut budget), Err(LineError::OverBudget(_))));
        assert!(lines.text().len() < 1_000_000);
    }

    #[test]
    fn the_hash_is_that_of_the_whole() {
        let text: Vec<u8> = (0..5000u32).map(|i| (i * 7) as u8).collect();
        let mut reader = io::BufReader::with_capacity(17, Hashing::new(&text[..]));
        io::copy(&mut reader, &mut io::sink()).unwrap();
        let hashing = reader.into_inner();
        assert_eq!(hashing.bytes_read(), 5000);
        assert_eq!(hashing.into_hash().finish(), XxHash3_64::oneshot(&text));
    }
}
