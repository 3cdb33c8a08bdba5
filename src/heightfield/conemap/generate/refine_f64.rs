//! Ratios in f64 from what a device has found in f32.
//!
//! A device reports which place bounds a cone, as squared distance and height. The distance
//! is a whole number and the height is one of the map's own numbers, so the ratio can be
//! computed as if the CPU had found the place. Where another place costs nearly as much, f32
//! may have preferred the wrong one; then the place is searched again on the CPU.

use crate::heightfield::conemap::generate::{MapTask, SearchState};

/// Whether f32 leaves open what bounds any cone of a place.
pub fn is_ambiguous(task: &MapTask<'_>, found: &[SearchState]) -> bool {
    found.iter().any(|s| task.method.is_ambiguous(s))
}

/// The ratios of a place in f64, from what the device has found for each cone.
pub fn refined(task: &MapTask<'_>, index: usize, found: &[SearchState]) -> [f64; 4] {
    if is_ambiguous(task, found) {
        return task.find(index, &mut [None; 4]).ratios;
    }
    let height = f64::from(task.values[index]);
    let cost = task.cost();
    let mut ratios = [0.0; 4];
    for (ratio, s) in ratios.iter_mut().zip(found) {
        let mut least = cost.widest();
        if s.top >= 0.0 {
            least = least.min(task.method.found_cost(task, s, height));
        }
        *ratio = cost.ratio(least);
    }
    ratios
}
