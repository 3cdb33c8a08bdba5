//! Work over all cores, or on the calling thread where there are no others.

use std::ops::Range;

#[cfg(feature = "cli")]
use rayon::prelude::*;

/// The results of a function over a range, in order. A core takes at least `least` at once.
pub fn collect<T: Send>(
    range: Range<usize>,
    least: usize,
    one: impl Fn(usize) -> T + Send + Sync,
) -> Vec<T> {
    #[cfg(feature = "cli")]
    return range.into_par_iter().with_min_len(least).map(one).collect();
    #[cfg(not(feature = "cli"))]
    {
        let _ = least;
        range.map(one).collect()
    }
}

/// Calls a function with the number and the values of each part of so many values.
pub fn for_each_part<T: Send>(
    all: &mut [T],
    length: usize,
    one: impl Fn(usize, &mut [T]) + Send + Sync,
) {
    #[cfg(feature = "cli")]
    let parts = all.par_chunks_mut(length).enumerate();
    #[cfg(not(feature = "cli"))]
    let parts = all.chunks_mut(length).enumerate();
    parts.for_each(|(i, part)| one(i, part));
}
