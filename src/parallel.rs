//! The same loop with or without the `rayon` feature.

/// `f(0)`, `f(1)`, ... `f(count - 1)`, in that order, made on all cores of the current pool.
#[cfg(feature = "rayon")]
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().map(f).collect()
}

/// `f(0)`, `f(1)`, ... `f(count - 1)`.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..count).map(f).collect()
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
