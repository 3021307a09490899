//! Darts and their links.

use std::fmt;

/// A dart: one vertex of one edge of one face of one volume. Only the map that made it knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dart(pub(super) u32);

impl Dart {
    /// Its number in the map, for tables by dart.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for Dart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "dart {}", self.0)
    }
}

/// A 3-dimensional generalized map. See [`crate::gmap`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GMap {
    /// By involution and dart: where it leads; the dart itself if it is free.
    pub(super) alpha: [Vec<u32>; 4],
    /// By dart: whether it was removed. Such darts are free in all involutions and in no cell.
    pub(super) is_gone: Vec<bool>,
    /// How many darts were removed.
    pub(super) gone: usize,
}

impl GMap {
    /// A map without darts.
    pub fn new() -> GMap {
        GMap::default()
    }

    /// A map without darts that has room for `darts`.
    pub fn with_capacity(darts: usize) -> GMap {
        let column = || Vec::with_capacity(darts);
        GMap { alpha: [column(), column(), column(), column()], is_gone: Vec::with_capacity(darts), gone: 0 }
    }

    /// A map with these alphas, by dart; a dart that was removed leads nowhere by any. That each is an involution is known.
    pub(crate) fn from_alphas(alphas: impl ExactSizeIterator<Item = [u32; 4]>) -> GMap {
        let mut map = GMap::with_capacity(alphas.len());
        for (dart, alpha) in (0..).zip(alphas) {
            let is_gone = alpha == [u32::MAX; 4];
            map.is_gone.push(is_gone);
            map.gone += usize::from(is_gone);
            for (column, to) in map.alpha.iter_mut().zip(alpha) {
                column.push(if is_gone { dart } else { to });
            }
        }
        map
    }

    /// Lets alpha `i` of a dart lead anywhere, and not back.
    #[cfg(test)]
    pub(crate) fn break_alpha(&mut self, i: usize, dart: Dart, to: Dart) {
        self.alpha[i][dart.index()] = to.0;
    }

    /// Adds a dart that is free in all involutions.
    ///
    /// # Panics
    /// If there are 2^32 - 1 darts.
    pub fn add_dart(&mut self) -> Dart {
        let next = self.is_gone.len();
        assert!(next < u32::MAX as usize, "a map has fewer than 2^32 - 1 darts");
        for column in &mut self.alpha {
            column.push(next as u32);
        }
        self.is_gone.push(false);
        Dart(next as u32)
    }

    /// How many darts there are.
    pub fn len(&self) -> usize {
        self.is_gone.len() - self.gone
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One more than the largest [`Dart::index`]: the length of a table by dart. Removed darts leave gaps.
    pub fn table_len(&self) -> usize {
        self.is_gone.len()
    }

    /// All darts, ascending.
    pub fn darts(&self) -> impl Iterator<Item = Dart> + '_ {
        self.is_gone.iter().zip(0..).filter(|(is_gone, _)| !**is_gone).map(|(_, dart)| Dart(dart))
    }

    /// Whether the dart is one of this map's, and was not removed.
    pub fn contains(&self, dart: Dart) -> bool {
        self.is_gone.get(dart.index()).is_some_and(|is_gone| !is_gone)
    }

    /// The dart with this number, if there is one.
    pub fn dart(&self, index: usize) -> Option<Dart> {
        let dart = Dart(u32::try_from(index).ok()?);
        self.contains(dart).then_some(dart)
    }

    /// Alpha `i` of a dart.
    ///
    /// # Panics
    /// If `i` is over 3, or the map never had such a dart. A removed one leads to itself.
    #[inline]
    pub fn alpha(&self, i: usize, dart: Dart) -> Dart {
        Dart(self.alpha[i][dart.index()])
    }

    /// Several involutions, the first first: `map.walk(dart, &[0, 1])` is alpha 1 of alpha 0 of the dart.
    ///
    /// # Panics
    /// As [`GMap::alpha`].
    pub fn walk(&self, dart: Dart, way: &[usize]) -> Dart {
        way.iter().fold(dart, |dart, &i| self.alpha(i, dart))
    }

    /// Whether alpha `i` leads to the dart itself.
    ///
    /// # Panics
    /// As [`GMap::alpha`].
    #[inline]
    pub fn is_free(&self, i: usize, dart: Dart) -> bool {
        self.alpha(i, dart) == dart
    }

    /// Links two darts by alpha `i`, and frees what they were linked to before. No other dart follows, so that the map
    /// may be invalid until its user has linked all that belongs together: [`GMap::sew`] does that by itself.
    ///
    /// # Panics
    /// If `i` is over 3, or a dart is not of this map.
    pub fn link(&mut self, i: usize, a: Dart, b: Dart) {
        assert!(self.contains(a) && self.contains(b), "{a} and {b} are of this map");
        self.unlink(i, a);
        self.unlink(i, b);
        self.alpha[i][a.index()] = b.0;
        self.alpha[i][b.index()] = a.0;
    }

    /// Frees a dart, and the one it is linked to by alpha `i`.
    ///
    /// # Panics
    /// As [`GMap::alpha`].
    pub fn unlink(&mut self, i: usize, dart: Dart) {
        let other = self.alpha(i, dart);
        self.alpha[i][other.index()] = other.0;
        self.alpha[i][dart.index()] = dart.0;
    }

    /// Takes out a dart that is free in all involutions, or frees it first.
    pub(super) fn take_out(&mut self, dart: Dart) {
        for i in 0..4 {
            self.unlink(i, dart);
        }
        if !std::mem::replace(&mut self.is_gone[dart.index()], true) {
            self.gone += 1;
        }
    }
}
