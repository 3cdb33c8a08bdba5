//! What a generator's method of search must provide.

use crate::base::shader::Module;
use crate::heightfield::conemap::generate::{Best, MapTask, SearchState, grid_distance::Sector};
use crate::heightfield::{Heights, Patches};

/// A place that is searched from: where it is, and the height of its apex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apex {
    /// Column and row.
    pub place: [u32; 2],
    /// Height of the sample, or of the cell's highest point.
    pub height: f64,
}

/// A method of search: on the CPU in f64, and on a device by the WGSL of [`ConeSearch::modules`].
pub trait ConeSearch: Sync {
    /// The searches of a place: which places each of them looks at. Their number is that of
    /// the cones of a place, or a multiple of it; then several searches narrow one cone.
    fn sectors(&self) -> &'static [Sector] {
        &[Sector::All]
    }

    /// The values of which pyramids of maxima are needed: none, one list for all searches,
    /// or one list for each. Given are the height map, what the places are cells of (if they
    /// are cells), and the heights of the places.
    fn pyramids(&self, _: &Heights, _: Option<Patches>, _values: &[f32]) -> Vec<Vec<f32>> {
        Vec::new()
    }

    /// Whether it follows rays in [`search_steps`](super::Options::search_steps) steps.
    fn counts_steps(&self) -> bool {
        false
    }

    /// Whether planes above the heights speed it up.
    fn uses_planes(&self) -> bool {
        false
    }

    /// Searches from an apex and lowers the best to the least cost that is found. `search`
    /// counts the [`ConeSearch::sectors`].
    fn search(&self, task: &MapTask<'_>, search: usize, from: Apex, best: &mut Best);

    /// The WGSL modules of the search.
    fn modules(&self, task: &MapTask<'_>) -> Vec<Module>;

    /// Whether f32 leaves open which place bounds the cone: two cost nearly the same.
    fn is_ambiguous(&self, found: &SearchState) -> bool {
        found.note != 0
    }

    /// The cost in f64 of the place that a device has found.
    fn found_cost(&self, task: &MapTask<'_>, found: &SearchState, height: f64) -> f64 {
        task.cost().of(found.squared, f64::from(found.top) - height)
    }

    /// Rounds of a dispatch that one round of the search may take.
    fn rounds(&self) -> u32 {
        1
    }
}
