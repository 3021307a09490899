//! The same loop with or without the `rayon` feature.

use std::sync::{Mutex, PoisonError};

/// In so many parts at most is work divided: enough that no thread waits long for another.
const PARTS: usize = 1 << 10;

/// `f(0)`, `f(1)`, ... `f(count - 1)`, in that order, made on all cores of the current pool.
///
/// What hands out the parts knows nothing of `f` or `T`: compiled once, and not again for each of dozens that call this.
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let size = count.div_ceil(PARTS).max(1);
    let parts: Vec<Mutex<Vec<T>>> = (0..count.div_ceil(size)).map(|_| Mutex::default()).collect();
    each(parts.len(), &|part| {
        let made = (part * size..count.min((part + 1) * size)).map(&f).collect();
        *parts[part].lock().unwrap_or_else(PoisonError::into_inner) = made;
    });
    let mut all = Vec::with_capacity(count);
    for part in parts {
        all.append(&mut part.into_inner().unwrap_or_else(PoisonError::into_inner));
    }
    all
}

/// Calls `job` with each number below `count`, on all cores of the current pool.
fn each(count: usize, job: &(dyn Fn(usize) + Sync)) {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        (0..count).into_par_iter().with_max_len(1).for_each(job);
    }
    #[cfg(not(feature = "rayon"))]
    (0..count).for_each(job);
}

/// Calls `f` with the number and the items of each part of `size` items, the last one perhaps shorter; an error, if there is any.
pub(crate) fn try_for_chunks<T: Send, E: Send>(
    items: &mut [T],
    size: usize,
    f: impl Fn(usize, &mut [T]) -> Result<(), E> + Sync + Send,
) -> Result<(), E> {
    #[cfg(feature = "rayon")]
    let parts = rayon::slice::ParallelSliceMut::par_chunks_mut(items, size);
    #[cfg(feature = "rayon")]
    use rayon::iter::{IndexedParallelIterator, ParallelIterator};
    #[cfg(not(feature = "rayon"))]
    let parts = items.chunks_mut(size);
    parts.enumerate().try_for_each(|(number, part)| f(number, part))
}

/// The results of both, made at the same time if there are threads.
#[cfg(feature = "compile")]
pub(crate) fn both<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(feature = "rayon")]
    return rayon::join(a, b);
    #[cfg(not(feature = "rayon"))]
    (a(), b())
}
