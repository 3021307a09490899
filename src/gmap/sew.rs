//! Gluing and ungluing whole cells: alpha i of all darts of a cell of dimension i - 1.

use std::collections::HashMap;

use super::dart::{Dart, GMap};
use super::orbit::Orbit;

/// Why two darts cannot be sewn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SewError {
    /// A dart is not of this map.
    #[error("{0} is not of this map")]
    Unknown(Dart),
    /// There is no such involution.
    #[error("there is no alpha {0}")]
    NoInvolution(usize),
    /// A cell cannot be sewn to itself, as by folding it: this dart is on both sides.
    #[error("{0} would be on both sides of what alpha {1} glues")]
    Itself(Dart, usize),
    /// A dart of the cells to be glued is glued already.
    #[error("{dart} is not free by alpha {involution}: it leads to {other}")]
    NotFree {
        /// The dart.
        dart: Dart,
        /// The involution.
        involution: usize,
        /// Where it leads.
        other: Dart,
    },
    /// The cells to be glued have different forms: one involution is free, or comes back, on one side alone.
    #[error(
        "by alpha {involution} {a} leads to {from_a} and {b} to {from_b}: what is to be sewn differs there"
    )]
    Different {
        /// The involution.
        involution: usize,
        /// A dart of the first cell.
        a: Dart,
        /// Where it leads.
        from_a: Dart,
        /// The dart that it would be sewn to.
        b: Dart,
        /// Where that leads.
        from_b: Dart,
    },
}

/// Pairs of darts that [`GMap::sew`] would link: checked, not yet done.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use = "nothing is sewn before `commit`"]
pub struct Sewing {
    involution: usize,
    pairs: Vec<[Dart; 2]>,
}

impl Sewing {
    /// The involution that is to link them.
    pub fn involution(&self) -> usize {
        self.involution
    }

    /// The pairs.
    pub fn pairs(&self) -> &[[Dart; 2]] {
        &self.pairs
    }
}

/// The involutions that a dart's partner by alpha `i` must follow.
const fn followers(i: usize) -> &'static [usize] {
    match i {
        0 => &[2, 3],
        1 => &[3],
        2 => &[0],
        _ => &[0, 1],
    }
}

impl GMap {
    /// What sewing `a` to `b` by alpha `i` would link: `i` = 3 glues two volumes by the faces of the darts, 2 two faces by
    /// their edges, 1 two edges by their ends, 0 two darts to an edge. Changes nothing.
    ///
    /// # Errors
    /// [`SewError`].
    pub fn check_sew(&self, i: usize, a: Dart, b: Dart) -> Result<Sewing, SewError> {
        if i > 3 {
            return Err(SewError::NoInvolution(i));
        }
        for dart in [a, b] {
            if !self.contains(dart) {
                return Err(SewError::Unknown(dart));
            }
        }
        let (mut to, mut from) = (HashMap::new(), HashMap::new());
        let mut pairs: Vec<[Dart; 2]> = Vec::new();
        let mut pair = |a: Dart, b: Dart, pairs: &mut Vec<[Dart; 2]>| -> Result<bool, SewError> {
            for dart in [a, b] {
                let other = self.alpha(i, dart);
                if other != dart {
                    return Err(SewError::NotFree { dart, involution: i, other });
                }
            }
            match (to.get(&a), from.get(&b)) {
                (Some(&old), _) => return Ok(old == b),
                (None, Some(_)) => return Ok(false),
                (None, None) => {}
            }
            to.insert(a, b);
            from.insert(b, a);
            if let Some(&both) = [a, b].iter().find(|dart| to.contains_key(dart) && from.contains_key(dart)) {
                return Err(SewError::Itself(both, i));
            }
            pairs.push([a, b]);
            Ok(true)
        };
        pair(a, b, &mut pairs)?;
        let mut next = 0;
        while let Some(&[a, b]) = pairs.get(next) {
            for &j in followers(i) {
                let (from_a, from_b) = (self.alpha(j, a), self.alpha(j, b));
                let different = SewError::Different { involution: j, a, from_a, b, from_b };
                if (from_a == a) != (from_b == b) {
                    return Err(different);
                }
                if from_a != a && !pair(from_a, from_b, &mut pairs)? {
                    return Err(different);
                }
            }
            next += 1;
        }
        Ok(Sewing { involution: i, pairs })
    }

    /// Does what [`GMap::check_sew`] found.
    ///
    /// # Panics
    /// If one of the darts was removed or sewn in between.
    pub fn commit(&mut self, sewing: &Sewing) {
        let i = sewing.involution;
        for &[a, b] in &sewing.pairs {
            assert!(
                self.is_free(i, a) && self.is_free(i, b),
                "{a} or {b} was sewn since the sewing was checked"
            );
            self.link(i, a, b);
        }
    }

    /// Glues by alpha `i`: [`GMap::check_sew`], then [`GMap::commit`]. Returns how many pairs were linked.
    ///
    /// # Errors
    /// [`SewError`]; the map is as it was.
    pub fn sew(&mut self, i: usize, a: Dart, b: Dart) -> Result<usize, SewError> {
        let sewing = self.check_sew(i, a, b)?;
        self.commit(&sewing);
        Ok(sewing.pairs.len())
    }

    /// Takes apart what is glued by alpha `i` at a dart, all along the cell. Does nothing where the dart is free.
    ///
    /// # Errors
    /// [`SewError::NoInvolution`], [`SewError::Unknown`].
    pub fn unsew(&mut self, i: usize, dart: Dart) -> Result<usize, SewError> {
        if i > 3 {
            return Err(SewError::NoInvolution(i));
        }
        if !self.contains(dart) {
            return Err(SewError::Unknown(dart));
        }
        if self.is_free(i, dart) {
            return Ok(0);
        }
        let mut seen = std::collections::HashSet::from([dart]);
        let mut all = vec![dart];
        let mut next = 0;
        while let Some(&dart) = all.get(next) {
            for &j in followers(i) {
                let other = self.alpha(j, dart);
                if seen.insert(other) {
                    all.push(other);
                }
            }
            next += 1;
        }
        let mut count = 0;
        for dart in all {
            if !self.is_free(i, dart) {
                self.unlink(i, dart);
                count += 1;
            }
        }
        Ok(count)
    }

    /// Whether two darts are of one cell.
    ///
    /// # Panics
    /// If the map never had such a dart as `a`.
    pub fn is_same(&self, orbit: Orbit, a: Dart, b: Dart) -> bool {
        self.orbit(orbit, a).contains(&b)
    }
}
