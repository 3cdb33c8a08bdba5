//! Cone maps in f64 on the CPU, places over threads.

use std::time::Instant;

use rayon::prelude::*;

use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::generator::{
    GenerateError, Generator, Options, Watch, Work,
};
use crate::heightfield::conemap::generate::min3x3::min3x3;
use crate::heightfield::conemap::generate::task::{Found, MapTask};
use crate::heightfield::heights::{Heights, Patches};

/// Places before the first look at the watch: seconds at most for the slowest generators
/// on large maps.
const BAND: usize = 1 << 10;
/// How long a band should take at least, in seconds. Bands grow until they do: each ends
/// with waiting for the last thread, long on a busy machine.
const SHORT: f64 = 0.03;
/// Places that a thread takes at least: fewer cost more in handing out than they save.
const TAKEN: usize = 64;

/// Makes a cone map. Patches matter to the walks: they say which cells there are.
///
/// # Errors
/// Options that are out of range; [`GenerateError::Cancelled`] when `watch` returns
/// `false`.
pub fn generate(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
    watch: Watch<'_>,
) -> Result<ConeMap, GenerateError> {
    generate_counted(generator, heights, patches, options, watch).map(|(map, _)| map)
}

/// Makes a cone map, and tells how much work it was.
///
/// # Errors
/// As [`generate`].
pub fn generate_counted(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
    watch: Watch<'_>,
) -> Result<(ConeMap, Work), GenerateError> {
    let prepared = MapTask::new(generator, heights, patches, options)?;
    let places = prepared.values.len();
    let channels = generator.channels();
    let mut ratios = Vec::with_capacity(places * channels);
    let mut work = Work::default();
    let mut band: Vec<Found> = Vec::new();
    let (mut start, mut length) = (0, BAND);
    while start < places {
        let since = Instant::now();
        let indices = (start..places.min(start + length)).into_par_iter();
        let found = indices
            .with_min_len(TAKEN)
            .map(|index| prepared.find(index));
        found.collect_into_vec(&mut band);
        for found in &band {
            ratios.extend_from_slice(&found.ratios[..channels]);
            work.nodes += u64::from(found.nodes);
            work.most = work.most.max(found.nodes);
        }
        start += band.len();
        if !watch(start as f64 / places as f64) {
            return Err(GenerateError::Cancelled);
        }
        if since.elapsed().as_secs_f64() < SHORT {
            length *= 2;
        }
    }
    let mut map = prepared.map(ratios);
    if options.min3x3 {
        map = min3x3(&map);
    }
    Ok((map, work))
}
