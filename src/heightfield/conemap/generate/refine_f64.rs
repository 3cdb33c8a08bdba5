//! Ratios in f64 from what a device has found in f32.
//!
//! A device tells which place bounds a cone, as squared distance and height: whole, and
//! one of the map's own numbers, so the ratio can be computed as if it had been found
//! here. Where another place costs nearly as much, f32 may have preferred the wrong one,
//! and the place is searched again.

use crate::heightfield::conemap::generate::generator::Generator;
use crate::heightfield::conemap::generate::task::MapTask;
use crate::heightfield::conemap::generate::uniform::Search;
use crate::heightfield::conemap::generate::{quick, relaxed};

/// Whether f32 leaves open what bounds the cones of a place.
pub fn unsettled<'a>(prepared: &MapTask<'_>, mut found: impl Iterator<Item = &'a Search>) -> bool {
    // The note of a search along rays is something else.
    prepared.generator != Generator::RelaxedSearch && found.any(|s| s.note != 0)
}

/// The ratios of a place in f64, from what the device has found for each channel.
pub fn settled(prepared: &MapTask<'_>, index: usize, found: &[Search; 4]) -> [f64; 4] {
    let height = f64::from(prepared.values[index]);
    let cost = prepared.cost();
    if unsettled(prepared, found.iter()) {
        return prepared.find(index).ratios;
    }
    found.map(|s| {
        if s.top < 0.0 {
            return cost.ratio(cost.widest());
        }
        let (top, squared) = (f64::from(s.top), s.squared);
        let found = match prepared.generator {
            Generator::RelaxedSearch => {
                relaxed::exit_cost(squared, top, height, s.note, prepared.options.search_steps)
            }
            Generator::Naive | Generator::Improved | Generator::Center => {
                quick::cost(squared, top - height)
            }
            _ => cost.of(squared, top - height),
        };
        cost.ratio(found.min(cost.widest()))
    })
}
