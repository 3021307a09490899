//! Limits on what an input may cost, so that no file can exhaust the machine.

/// How much memory and how many elements an import or a compilation may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Bytes of memory (`--max-memory`), estimated before they are allocated. Default 8 GiB.
    pub max_memory: u64,
    /// Elements (`--max-elements`). Default 4 million.
    pub max_elements: u64,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits { max_memory: 8 << 30, max_elements: 4_000_000 }
    }
}

impl Limits {
    /// The default limits with another bound on memory, in bytes.
    pub fn with_max_memory(mut self, bytes: u64) -> Limits {
        self.max_memory = bytes;
        self
    }

    /// The default limits with another bound on the number of elements.
    pub fn with_max_elements(mut self, elements: u64) -> Limits {
        self.max_elements = elements;
        self
    }
}

/// A running account of memory against [`Limits::max_memory`]. Stages take from it *before* they allocate.
#[derive(Clone, Debug)]
pub struct Budget {
    limit: u64,
    used: u64,
    peak: u64,
}

/// More memory would be needed than the limit allows.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} needs {needs} bytes more, over the limit of {limit} bytes (raise --max-memory)")]
pub struct OverBudget {
    /// What the memory was for.
    pub what: String,
    /// Bytes asked for.
    pub needs: u64,
    /// The limit in force.
    pub limit: u64,
}

impl Budget {
    /// An empty account against `limits`.
    pub fn new(limits: &Limits) -> Budget {
        Budget { limit: limits.max_memory, used: 0, peak: 0 }
    }

    /// Takes `bytes` for `what`, before they are allocated.
    ///
    /// # Errors
    /// If the sum would pass the limit; nothing is taken then.
    pub fn take(&mut self, bytes: u64, what: &str) -> Result<(), OverBudget> {
        match self.used.checked_add(bytes) {
            Some(sum) if sum <= self.limit => {
                self.used = sum;
                self.peak = self.peak.max(sum);
                Ok(())
            }
            _ => Err(OverBudget { what: what.to_owned(), needs: bytes, limit: self.limit }),
        }
    }

    /// Takes room for `count` items of `size` bytes each.
    ///
    /// # Errors
    /// As [`Budget::take`]; a product that overflows is over any limit.
    pub fn take_items(&mut self, count: u64, size: usize, what: &str) -> Result<(), OverBudget> {
        self.take(count.saturating_mul(size as u64), what)
    }

    /// Gives `bytes` back, after they were freed.
    pub fn give_back(&mut self, bytes: u64) {
        self.used = self.used.saturating_sub(bytes);
    }

    /// Bytes in use now.
    pub fn used(&self) -> u64 {
        self.used
    }

    /// The most bytes in use at once so far.
    pub fn peak(&self) -> u64 {
        self.peak
    }

    /// Bytes still free.
    pub fn left(&self) -> u64 {
        self.limit - self.used
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_and_gives_back() {
        let mut budget = Budget::new(&Limits::default().with_max_memory(100));
        assert!(budget.take(60, "a").is_ok());
        let error = budget.take(41, "b").unwrap_err();
        assert_eq!((error.needs, error.limit), (41, 100));
        budget.give_back(30);
        assert!(budget.take(41, "b").is_ok());
        assert!(budget.take_items(u64::MAX, 8, "c").is_err());
        assert_eq!((budget.used(), budget.peak(), budget.left()), (71, 71, 29));
    }
}
