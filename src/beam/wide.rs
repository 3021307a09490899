//! Sixteen pixels of a row, and eight rows, side by side: one trait each, so that the loops over them are written once for all
//! instruction sets.

/// Pixels side by side.
pub(crate) const WIDE: usize = 16;

/// All of them, pixel i as bit i.
pub(crate) const ALL: u32 = 0xffff;

/// Rows side by side.
pub(crate) const ROWS: usize = 8;

/// Colours of sixteen pixels: red in the lower half of a word and blue in the upper, and green below what is opaque; in 256th, and half a step more.
#[derive(Clone, Copy)]
pub(crate) struct Levels {
    pub(crate) red_blue: [u32; WIDE],
    pub(crate) green: [u32; WIDE],
}

/// A number for each of sixteen pixels.
pub(crate) trait Wide: Copy {
    /// A column for each of eight rows.
    type Columns: Columns;
    /// Thirty-two bits for each of sixteen pixels.
    type Words: Copy;

    /// The same for all.
    fn splat(x: f32) -> Self;
    /// The number of each: 0, 1, 2...
    fn count() -> Self;
    fn load(from: &[f32; WIDE]) -> Self;
    fn add(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    /// `self * factor + more`, rounded once or twice.
    fn mul_add(self, factor: Self, more: Self) -> Self;
    fn abs(self) -> Self;
    /// One by the square root of a positive number, to four parts in ten thousand of it.
    fn inverse_root(self) -> Self;
    /// Where it is greater than another, pixel i as bit i.
    fn greater(self, other: Self) -> u32;
    /// Written where `mask` says.
    fn put(self, mask: u32, to: &mut [f32; WIDE]);
    /// Written to all.
    fn store(self, to: &mut [f32; WIDE]);

    /// The same for all.
    fn words(x: u32) -> Self::Words;
    /// Eight-bit RGBA, opaque, from three numbers from 0 to 255 each, rounded; red in the lowest bits.
    fn bytes(red: Self, green: Self, blue: Self) -> Self::Words;
    /// A colour so bright as each number says, red, green and blue times it from 0 to 255.
    fn levels(self, color: &[f32; 3]) -> Levels;
    /// As [`Wide::bytes`], of pixels that go evenly from the colour `from` to the colour `to`, which the pixel after the last has, and which is no more
    /// than half of 255 steps away.
    fn ramp(levels: &Levels, from: usize, to: usize) -> Self::Words;
    /// Written where `mask` says.
    fn put_words(words: Self::Words, mask: u32, to: &mut [u32; WIDE]);
    /// Written to all.
    fn put_all(words: Self::Words, to: &mut [u32; WIDE]);
}

/// A column for each of eight rows.
pub(crate) trait Columns: Copy {
    /// Where a line passes each of eight rows, in columns.
    type Lines: Lines<Columns = Self>;
    fn load(from: &[i32; ROWS]) -> Self;
    fn store(self) -> [i32; ROWS];
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    /// Where it is less than another, row i as bit i.
    fn less(self, other: Self) -> u32;
    /// Those rows that are `there`, row i as bit i, and in the others this column.
    fn held(self, there: u32, other: i32) -> Self;
    /// Of all rows.
    fn least(self) -> i32;
    /// Of all rows.
    fn most(self) -> i32;
    /// Which of the sixteen columns from the `first` on are from this one up to another, column i as bit i: of each row; and which rows have any. What
    /// is up to a column less than this one is none.
    fn up_to(self, end: Self, first: i32) -> ([u32; ROWS], u32);
}

/// Where a line passes each of eight rows, in columns. The same bits on every instruction set.
pub(crate) trait Lines: Copy {
    type Columns;
    /// The line at `start` in row 0 which goes by `slope` a row, in the rows from the `first` on. Both are finite.
    fn new(slope: f64, start: f64, first: i32) -> Self;
    /// The same column in all rows.
    fn splat(column: f64) -> Self;
    /// What is left, and right, of it becomes the farther right, or, if it `is_left`, the farther left of both.
    fn narrow(borders: &mut [Self; 2], line: Self, is_left: bool);
    /// The first column in each row that is not left of it, held within what columns may be.
    fn not_left(self) -> Self::Columns;
}

/// The farthest column, left and right, that a border may have.
pub(crate) const FARTHEST: f64 = 1e9;

/// For any CPU.
#[derive(Clone, Copy)]
pub(crate) struct Portable([f32; WIDE]);

/// Adding this to a small number that is not negative leaves it, rounded, in the lowest bits.
pub(crate) const MAGIC: f32 = 8_388_608.0;

/// As [`MAGIC`], and half of 256 more.
pub(crate) const HALF_UP: f32 = MAGIC + 128.0;

/// What is opaque.
pub(crate) const OPAQUE: u32 = 0xff00_0000;

/// Of each number what `f` makes of its place. Written out, since `array::from_fn` is a function by itself, in which nothing is done side by side.
macro_rules! each {
    ($count:expr, $zero:expr, |$i:ident| $body:expr) => {{
        let mut out = [$zero; $count];
        for $i in 0..$count {
            out[$i] = $body;
        }
        out
    }};
}

#[inline(always)]
fn bits(is_set: impl Fn(usize) -> bool) -> u32 {
    (0..WIDE).fold(0, |bits, i| bits | u32::from(is_set(i)) << i)
}

impl Wide for Portable {
    type Columns = PortableColumns;
    type Words = [u32; WIDE];

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Portable([x; WIDE])
    }
    #[inline(always)]
    fn count() -> Self {
        Portable(each!(WIDE, 0.0, |i| i as f32))
    }
    #[inline(always)]
    fn load(from: &[f32; WIDE]) -> Self {
        Portable(*from)
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Portable(each!(WIDE, 0.0, |i| self.0[i] + other.0[i]))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Portable(each!(WIDE, 0.0, |i| self.0[i] * other.0[i]))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        Portable(each!(WIDE, 0.0, |i| self.0[i] * factor.0[i] + more.0[i]))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Portable(each!(WIDE, 0.0, |i| self.0[i].abs()))
    }
    #[inline(always)]
    fn inverse_root(self) -> Self {
        Portable(each!(WIDE, 0.0, |i| 1.0 / self.0[i].sqrt()))
    }
    #[inline(always)]
    fn greater(self, other: Self) -> u32 {
        bits(|i| self.0[i] > other.0[i])
    }
    #[inline(always)]
    fn put(self, mask: u32, to: &mut [f32; WIDE]) {
        *to = each!(WIDE, Default::default(), |i| if mask >> i & 1 != 0 { self.0[i] } else { to[i] });
    }
    #[inline(always)]
    fn store(self, to: &mut [f32; WIDE]) {
        *to = self.0;
    }
    #[inline(always)]
    fn words(x: u32) -> Self::Words {
        [x; WIDE]
    }
    #[inline(always)]
    fn bytes(red: Self, green: Self, blue: Self) -> Self::Words {
        let byte = |x: f32| (x + MAGIC).to_bits() & 0xff;
        each!(WIDE, 0, |i| byte(red.0[i]) | byte(green.0[i]) << 8 | byte(blue.0[i]) << 16 | OPAQUE)
    }
    #[inline(always)]
    fn levels(self, color: &[f32; 3]) -> Levels {
        let level = |x: f32| (x * 256.0 + HALF_UP).to_bits() & 0xffff;
        let red_blue = each!(WIDE, 0, |i| level(self.0[i] * color[0]) | level(self.0[i] * color[2]) << 16);
        Levels { red_blue, green: each!(WIDE, 0, |i| level(self.0[i] * color[1]) | OPAQUE) }
    }
    #[inline(always)]
    fn ramp(levels: &Levels, from: usize, to: usize) -> Self::Words {
        let [red_blue, green] = [&levels.red_blue, &levels.green].map(|of| [of[from % WIDE], of[to % WIDE]]);
        // Of 2^15, as sixteen bits multiplied have it.
        let between = |[from, to]: [u32; 2], i: usize| {
            let by = i32::from((to as u16).wrapping_sub(from as u16) as i16);
            (from as u16).wrapping_add(((by * (i as i32 * 2048) + 0x4000) >> 15) as u16) as u32 >> 8
        };
        let upper = red_blue.map(|x| x >> 16);
        each!(WIDE, 0, |i| {
            between(red_blue, i) | between(green, i) << 8 | between(upper, i) << 16 | OPAQUE
        })
    }
    #[inline(always)]
    fn put_words(words: Self::Words, mask: u32, to: &mut [u32; WIDE]) {
        *to = each!(WIDE, Default::default(), |i| if mask >> i & 1 != 0 { words[i] } else { to[i] });
    }
    #[inline(always)]
    fn put_all(words: Self::Words, to: &mut [u32; WIDE]) {
        *to = words;
    }
}

/// For any CPU.
#[derive(Clone, Copy)]
pub(crate) struct PortableColumns([i32; ROWS]);

impl Columns for PortableColumns {
    type Lines = PortableLines;

    #[inline(always)]
    fn load(from: &[i32; ROWS]) -> Self {
        PortableColumns(*from)
    }
    #[inline(always)]
    fn store(self) -> [i32; ROWS] {
        self.0
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        PortableColumns(each!(ROWS, 0, |i| self.0[i].min(other.0[i])))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        PortableColumns(each!(ROWS, 0, |i| self.0[i].max(other.0[i])))
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        (0..ROWS).fold(0, |bits, i| bits | u32::from(self.0[i] < other.0[i]) << i)
    }
    #[inline(always)]
    fn held(self, there: u32, other: i32) -> Self {
        PortableColumns(each!(ROWS, 0, |i| if there >> i & 1 != 0 { self.0[i] } else { other }))
    }
    #[inline(always)]
    fn least(self) -> i32 {
        self.0.into_iter().fold(i32::MAX, i32::min)
    }
    #[inline(always)]
    fn most(self) -> i32 {
        self.0.into_iter().fold(i32::MIN, i32::max)
    }
    #[inline(always)]
    fn up_to(self, end: Self, first: i32) -> ([u32; ROWS], u32) {
        let bits = each!(ROWS, 0, |i| {
            let from = (self.0[i] - first).clamp(0, WIDE as i32);
            let to = (end.0[i] - first).clamp(from, WIDE as i32);
            (1 << to) - (1 << from)
        });
        (bits, (0..ROWS).fold(0, |rows, i| rows | u32::from(bits[i] != 0) << i))
    }
}

/// For any CPU.
#[derive(Clone, Copy)]
pub(crate) struct PortableLines([f64; ROWS]);

impl Lines for PortableLines {
    type Columns = PortableColumns;

    #[inline(always)]
    fn new(slope: f64, start: f64, first: i32) -> Self {
        let first = f64::from(first);
        PortableLines(each!(ROWS, 0.0, |i| start + slope * (first + i as f64)))
    }
    #[inline(always)]
    fn splat(column: f64) -> Self {
        PortableLines([column; ROWS])
    }
    #[inline(always)]
    fn narrow([left, right]: &mut [Self; 2], line: Self, is_left: bool) {
        for i in 0..ROWS {
            let line = line.0[i];
            left.0[i] = if !is_left && line > left.0[i] { line } else { left.0[i] };
            right.0[i] = if is_left && line < right.0[i] { line } else { right.0[i] };
        }
    }
    // Of what is no number the least: as the instructions have it.
    #[allow(clippy::manual_clamp)]
    #[inline(always)]
    fn not_left(self) -> PortableColumns {
        /// Adding and taking off this rounds to the nearest whole number; its last bits, as an integer, are those of the number added.
        const MAGIC: f64 = 6_755_399_441_055_744.0;
        PortableColumns(each!(ROWS, 0, |i| {
            let column = self.0[i].max(-FARTHEST).min(FARTHEST);
            let nearest = (column + MAGIC) - MAGIC;
            let up = if nearest < column { 1.0 } else { 0.0 };
            ((nearest + up) + MAGIC).to_bits() as i32
        }))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    fn some(numbers: impl Fn(usize) -> f32) -> [f32; WIDE] {
        std::array::from_fn(numbers)
    }

    fn words<W: Wide>(words: W::Words) -> [u32; WIDE] {
        let mut out = [0; WIDE];
        W::put_all(words, &mut out);
        out
    }

    fn numbers<W: Wide>(wide: W) -> [f32; WIDE] {
        let mut out = [0.0; WIDE];
        wide.put(ALL, &mut out);
        out
    }

    /// What every instruction set must do.
    #[inline(always)]
    pub(in crate::beam) fn check<W: Wide>() {
        let a = some(|i| i as f32 * 1.5 - 7.0);
        let b = some(|i| 3.0 - i as f32 * 0.5);
        let (wide_a, wide_b) = (W::load(&a), W::load(&b));
        assert_eq!(numbers(wide_a), a);
        assert_eq!(numbers(W::splat(2.5)), [2.5; WIDE]);
        assert_eq!(numbers(W::count()), some(|i| i as f32));
        assert_eq!(numbers(wide_a.add(wide_b)), some(|i| a[i] + b[i]));
        assert_eq!(numbers(wide_a.mul(wide_b)), some(|i| a[i] * b[i]));
        assert_eq!(numbers(wide_a.mul_add(wide_b, W::splat(1.0))), some(|i| a[i] * b[i] + 1.0));
        assert_eq!(numbers(wide_a.abs()), a.map(f32::abs));
        let roots = numbers(wide_a.abs().add(W::splat(0.25)).inverse_root());
        for i in 0..WIDE {
            let exact = (a[i].abs() + 0.25).sqrt();
            assert!((roots[i] * exact - 1.0).abs() < 4e-4, "{} {exact}", roots[i]);
            assert_eq!(wide_a.greater(wide_b) >> i & 1, u32::from(a[i] > b[i]));
        }
        let mask = 0b1010_0110_0101_1001;
        let is_set = |i: usize| mask >> i & 1 != 0;
        let mut out = b;
        wide_a.put(mask, &mut out);
        assert_eq!(out, some(|i| if is_set(i) { a[i] } else { b[i] }));
        wide_a.store(&mut out);
        assert_eq!(out, a);
        assert_eq!(words::<W>(W::words(77)), [77; WIDE]);
        let mut out = [9; WIDE];
        W::put_words(W::words(77), mask, &mut out);
        assert_eq!(out, std::array::from_fn(|i| if is_set(i) { 77 } else { 9 }));
        let [red, green, blue] = [0.4f32, 200.6, 255.0];
        let rgba = W::bytes(W::splat(red), W::splat(green), W::splat(blue));
        assert_eq!(words::<W>(rgba), [0xffff_c900; WIDE]);
        let bright = some(|i| if i == 0 { 0.05 } else { i as f32 / 15.0 });
        let levels = W::load(&bright).levels(&[241.75, 100.25, 0.0]);
        for (from, to) in [(0, 1), (5, 11), (11, 5), (2, 2)] {
            for (i, word) in words::<W>(W::ramp(&levels, from, to)).into_iter().enumerate() {
                let bright = bright[from] + (bright[to] - bright[from]) * i as f32 / 16.0;
                let bytes = word.to_le_bytes().map(f32::from);
                let expected = [241.75 * bright, 100.25 * bright, 0.0, 255.0];
                assert!((0..4).all(|c| (bytes[c] - expected[c]).abs() < 0.52), "{bytes:?} {expected:?}");
            }
        }
        let line = |slope, start| <W::Columns as Columns>::Lines::new(slope, start, 5);
        let columns = |slope, start| line(slope, start).not_left().store();
        assert_eq!(columns(1.0, 0.0), [5, 6, 7, 8, 9, 10, 11, 12]);
        assert_eq!(columns(-0.5, 0.25), [-2, -2, -3, -3, -4, -4, -5, -5]);
        assert_eq!(columns(1e300, 0.0), [1_000_000_000; ROWS]);
        assert_eq!(columns(-1e300, 0.0), [-1_000_000_000; ROWS]);
        let mut borders = [line(0.0, 3.25), line(0.0, 9.0)];
        Lines::narrow(&mut borders, line(1.0, -3.0), false);
        Lines::narrow(&mut borders, line(-1.0, 15.0), true);
        assert_eq!(borders[0].not_left().store(), [4, 4, 4, 5, 6, 7, 8, 9]);
        assert_eq!(borders[1].not_left().store(), [9, 9, 8, 7, 6, 5, 4, 3]);
        let all = <W::Columns as Columns>::Lines::splat(2.5).not_left().store();
        assert_eq!(all, [3; ROWS]);
        let [lo, hi] = [[3, -1, 7, 0, 0, 2, 9, -8], [1, 0, 9, 0, -1, 2, 8, 8]];
        let [a, b] = [lo, hi].map(|c| W::Columns::load(&c));
        assert_eq!(a.min(b).store(), std::array::from_fn(|i| lo[i].min(hi[i])));
        assert_eq!(a.max(b).store(), std::array::from_fn(|i| lo[i].max(hi[i])));
        assert_eq!(a.less(b), 0b1000_0110);
        assert_eq!(a.held(0b1010_0101, 77).store(), [3, 77, 7, 77, 77, 2, 77, -8]);
        for turn in 0..ROWS {
            let turned = |of: [i32; ROWS]| W::Columns::load(&std::array::from_fn(|i| of[(i + turn) % ROWS]));
            assert_eq!([turned(lo).least(), turned(lo).most()], [-8, 9]);
            assert_eq!([turned(hi).least(), turned(hi).most()], [-1, 9]);
        }
        let [a, b] =
            [[3, -9, 20, 36, 19, 16, 40, 9], [5, 90, 30, 40, 20, 17, 90, 4]].map(|c| W::Columns::load(&c));
        assert_eq!(a.up_to(b, 20), ([0, ALL, 0x3ff, 0, 0, 0, 0, 0], 0b110));
        assert_eq!(a.up_to(b, 4), ([1, ALL, 0, 0, 0x8000, 0x1000, 0, 0], 0b11_0011));
    }

    #[test]
    fn portable() {
        check::<Portable>();
    }
}
