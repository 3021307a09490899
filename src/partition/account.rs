//! How much memory the stages of a partition take together.

use std::sync::atomic::{AtomicU64, Ordering};

/// An account of bytes that threads take from; nothing is given back. Whether it suffices does not depend on the order in
/// which it is taken from, and so not on the number of threads.
#[derive(Debug)]
pub(super) struct Account {
    limit: u64,
    used: AtomicU64,
}

/// More would be needed than there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Full;

impl Account {
    pub(super) fn new(limit: u64) -> Account {
        Account { limit, used: AtomicU64::new(0) }
    }

    /// Takes room for `count` items of `size` bytes.
    pub(super) fn take(&self, count: usize, size: usize) -> Result<(), Full> {
        let bytes = (count as u64).saturating_mul(size as u64);
        let add = |used: u64| Some(used.saturating_add(bytes));
        let before = self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, add);
        let used = before.unwrap_or_else(|used| used).saturating_add(bytes);
        if used > self.limit { Err(Full) } else { Ok(()) }
    }

    /// Whether more was asked for than there is.
    pub(super) fn is_full(&self) -> bool {
        self.used.load(Ordering::Relaxed) > self.limit
    }
}

/// A list that grows item by item: pays for so many at a time.
#[derive(Debug)]
pub(super) struct Meter<'a> {
    account: &'a Account,
    size: usize,
    paid: usize,
}

impl<'a> Meter<'a> {
    /// Items paid for at once.
    const CHUNK: usize = 1 << 12;

    /// For items of `size` bytes.
    pub(super) fn new(account: &'a Account, size: usize) -> Meter<'a> {
        Meter { account, size, paid: 0 }
    }

    /// There are `count` items now, or soon.
    #[inline]
    pub(super) fn reach(&mut self, count: usize) -> Result<(), Full> {
        if count <= self.paid {
            return Ok(());
        }
        let more = (count - self.paid).next_multiple_of(Self::CHUNK);
        self.paid += more;
        self.account.take(more, self.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pays_ahead_and_up_to_the_limit() {
        let account = Account::new(3 * 4096 * 8);
        let (mut one, mut other) = (Meter::new(&account, 8), Meter::new(&account, 8));
        assert!(one.reach(1).is_ok() && one.reach(4096).is_ok());
        assert!(other.reach(4097).is_ok() && !account.is_full());
        assert_eq!(one.reach(4097), Err(Full));
        assert!(account.is_full() && other.reach(8192).is_ok());
        assert_eq!(account.take(usize::MAX, usize::MAX), Err(Full));
    }
}
