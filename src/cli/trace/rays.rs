//! Reading rays: text, raw f32 or f64, npy.

use std::io::BufRead;

use clap::ValueEnum;
use enfilade::Ray;
use npyz::{DType, NpyFile, Order, TypeChar};

use super::Failure;

/// How rays are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Form {
    /// Little-endian f32.
    F32,
    /// Little-endian f64.
    F64,
    /// Numbers separated by blanks or commas, a ray a line; # starts a comment.
    Text,
    /// NumPy's file of an array of 6 (or 8) columns of f32 or f64.
    Npy,
}

/// A source of rays.
pub struct Reader {
    source: Box<dyn BufRead>,
    name: String,
    columns: usize,
    encoding: Encoding,
    /// Rays, or lines of text, read so far.
    read: u64,
    /// How many rays there are, where a header says so.
    promised: Option<u64>,
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Text,
    F32,
    F64,
}

/// Longest line of text, bytes.
const LONGEST_LINE: u64 = 1 << 16;

impl Reader {
    pub fn new(
        mut source: Box<dyn BufRead>,
        form: Form,
        segments: bool,
        name: &str,
    ) -> Result<Reader, Failure> {
        let columns = if segments { 8 } else { 6 };
        let (encoding, promised) = match form {
            Form::F32 => (Encoding::F32, None),
            Form::F64 => (Encoding::F64, None),
            Form::Text => (Encoding::Text, None),
            Form::Npy => npy_encoding(&mut source, columns)
                .map(|(encoding, rows)| (encoding, Some(rows)))
                .map_err(|e| Failure::input(format!("{name}: {e}")))?,
        };
        Ok(Reader { source, name: name.to_owned(), columns, encoding, read: 0, promised })
    }

    /// Whether the rays are f32.
    pub fn is_single_precision(&self) -> bool {
        self.encoding == Encoding::F32
    }

    /// Appends up to `count` rays; none at the end.
    pub fn read(&mut self, count: usize, rays: &mut Vec<Ray>) -> Result<(), Failure> {
        match self.encoding {
            Encoding::Text => self.read_text(count, rays),
            Encoding::F32 => self.read_binary::<4>(count, rays, |b| f64::from(f32::from_le_bytes(b))),
            Encoding::F64 => self.read_binary::<8>(count, rays, f64::from_le_bytes),
        }
    }

    fn read_text(&mut self, count: usize, rays: &mut Vec<Ray>) -> Result<(), Failure> {
        let mut line = String::new();
        while rays.len() < count {
            line.clear();
            self.read += 1;
            let place = format!("{}: line {}", self.name, self.read);
            let bad = |what: String| Failure::input(format!("{place}: {what}"));
            let mut limited = std::io::Read::take(&mut self.source, LONGEST_LINE);
            let length = limited.read_line(&mut line).map_err(|e| bad(e.to_string()))?;
            if length == 0 {
                return Ok(());
            }
            if length as u64 == LONGEST_LINE {
                return Err(bad("longer than any ray".to_owned()));
            }
            let text = line.split('#').next().unwrap_or("");
            let mut numbers = [0.0; 8];
            let mut found = 0;
            for word in text.split(|c: char| c.is_whitespace() || c == ',').filter(|w| !w.is_empty()) {
                let number = word.parse().map_err(|_| bad(format!("'{word}' is no number")))?;
                if found < self.columns {
                    numbers[found] = number;
                }
                found += 1;
            }
            match found {
                0 => continue,
                n if n == self.columns => rays.push(self.ray(numbers).map_err(bad)?),
                n => return Err(bad(format!("{n} numbers where a ray has {}", self.columns))),
            }
        }
        Ok(())
    }

    fn read_binary<const SIZE: usize>(
        &mut self,
        count: usize,
        rays: &mut Vec<Ray>,
        number: impl Fn([u8; SIZE]) -> f64,
    ) -> Result<(), Failure> {
        let mut row = vec![0; self.columns * SIZE];
        while rays.len() < count {
            let place = format!("{}: ray {}", self.name, self.read);
            let bad = |what: String| Failure::input(format!("{place}: {what}"));
            let mut filled = 0;
            while filled < row.len() {
                match self.source.read(&mut row[filled..]) {
                    Ok(0) if filled == 0 => return self.ended().map_err(bad),
                    Ok(0) => return Err(bad(format!("cut off after {filled} of {} bytes", row.len()))),
                    Ok(n) => filled += n,
                    Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
                    Err(e) => return Err(bad(e.to_string())),
                }
            }
            if self.promised == Some(self.read) {
                return Err(bad("the file holds more rays than its header says".to_owned()));
            }
            let mut numbers = [0.0; 8];
            for (to, from) in numbers.iter_mut().zip(row.as_chunks::<SIZE>().0) {
                *to = number(*from);
            }
            rays.push(self.ray(numbers).map_err(bad)?);
            self.read += 1;
        }
        Ok(())
    }

    /// Checks that as many rays came as the header said.
    fn ended(&self) -> Result<(), String> {
        match self.promised {
            Some(rows) if rows != self.read => Err(format!("cut off: the header says {rows} rays")),
            _ => Ok(()),
        }
    }

    fn ray(&self, n: [f64; 8]) -> Result<Ray, String> {
        let mut ray = Ray::new([n[0], n[1], n[2]], [n[3], n[4], n[5]]);
        if self.columns == 8 {
            (ray.tmin, ray.tmax) = (n[6], n[7]);
        }
        if ray.is_valid() {
            Ok(ray)
        } else {
            Err("no ray: its numbers must be finite (tmax may be inf) and its direction not zero".to_owned())
        }
    }
}

/// Longest header of an .npy file that is read, bytes; numpy's own have 128.
const LONGEST_HEADER: usize = 1 << 12;

/// Magic, version and header of an .npy file, bounded before they are parsed: the parser would take whatever memory the
/// length asks for, recurse as deep as brackets nest, and multiply the shape's numbers whatever they are.
fn npy_header(source: &mut dyn BufRead) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0; 10];
    let cut = |e: std::io::Error| format!("no .npy file: {e}");
    source.read_exact(&mut bytes).map_err(cut)?;
    if !bytes.starts_with(b"\x93NUMPY") {
        return Err("no .npy file: it does not begin as one".to_owned());
    }
    let mut length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    if bytes[6] > 1 {
        // From version 2 on, lengths have four bytes.
        bytes.resize(12, 0);
        source.read_exact(&mut bytes[10..]).map_err(cut)?;
        length += usize::from(u16::from_le_bytes([bytes[10], bytes[11]])) << 16;
    }
    if length > LONGEST_HEADER {
        return Err(format!("no .npy file of rays: its header is {length} bytes long"));
    }
    let start = bytes.len();
    bytes.resize(start + length, 0);
    source.read_exact(&mut bytes[start..]).map_err(cut)?;
    let count = |test: fn(&u8) -> bool| bytes[start..].iter().filter(|b| test(b)).count();
    // Numbers of 18 digits in all have a product below 10^18.
    if count(|b| b"([{".contains(b)) > 8 || count(u8::is_ascii_digit) > 18 {
        return Err("no .npy file of rays: its header describes something else".to_owned());
    }
    Ok(bytes)
}

/// Reads the header of an .npy file: how rays are written, and how many there are.
fn npy_encoding(source: &mut Box<dyn BufRead>, columns: usize) -> Result<(Encoding, u64), String> {
    let header = npy_header(source)?;
    let header = NpyFile::new(&header[..]).map_err(|e| format!("no .npy file: {e}"))?.header().clone();
    let shape = header.shape();
    if shape.len() != 2 || shape[1] != columns as u64 {
        return Err(format!("an array of shape {shape:?} where rays need (n, {columns})"));
    }
    if header.order() != Order::C {
        return Err("a Fortran-ordered array: save it in C order (numpy.ascontiguousarray)".to_owned());
    }
    let dtype = header.dtype();
    let text = dtype.descr();
    match &dtype {
        DType::Plain(plain) if plain.type_char() == TypeChar::Float && !text.contains('>') => {
            match plain.size_field() {
                4 => Ok((Encoding::F32, shape[0])),
                8 => Ok((Encoding::F64, shape[0])),
                _ => Err(format!("numbers of type {text} where rays are f32 or f64")),
            }
        }
        _ => Err(format!("numbers of type {text} where rays are little-endian f32 or f64")),
    }
}
