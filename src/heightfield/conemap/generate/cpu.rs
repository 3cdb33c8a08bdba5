//! Cone maps in f64 on the CPU, places over threads.

use std::time::Instant;

use rayon::prelude::*;

use crate::heightfield::conemap::generate::generator::{NodeCount, ShareWatch};
use crate::heightfield::conemap::generate::{
    GenerateError, Generator, MapTask, Options, min3x3::min3x3, task::Found,
};
use crate::heightfield::{ConeMap, Heights, Patches};

/// Places before the first call of the watch: seconds at most for the slowest generators
/// on large maps.
const BAND: usize = 1 << 10;
/// How long a band should take at least, in seconds. Bands grow until they do, because each
/// ends with waiting for the last thread, which is long on a busy machine.
const SHORT: f64 = 0.03;
/// Places that a thread takes at least: fewer cost more in handing out than they save.
const TAKEN: usize = 64;

/// Makes a cone map. Only generators over cells depend on the patches.
///
/// # Errors
/// Options that are out of range; [`GenerateError::Cancelled`] when `watch` returns
/// `false`.
pub fn generate(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
    watch: ShareWatch<'_>,
) -> Result<ConeMap, GenerateError> {
    generate_counted(generator, heights, patches, options, watch).map(|(map, _)| map)
}

/// Makes a cone map, and counts the nodes that the searches looked up.
///
/// # Errors
/// As [`generate`].
pub fn generate_counted(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
    watch: ShareWatch<'_>,
) -> Result<(ConeMap, NodeCount), GenerateError> {
    let task = MapTask::new(generator, heights, patches, options)?;
    let places = task.values.len();
    let channels = generator.channels();
    let mut ratios = Vec::with_capacity(places * channels);
    let mut count = NodeCount::default();
    let mut band: Vec<Found> = Vec::new();
    let (mut start, mut length) = (0, BAND);
    while start < places {
        let since = Instant::now();
        let indices = (start..places.min(start + length)).into_par_iter();
        let found = indices.with_min_len(TAKEN).map(|index| task.find(index));
        found.collect_into_vec(&mut band);
        for found in &band {
            ratios.extend_from_slice(&found.ratios[..channels]);
            count.total += u64::from(found.nodes);
            count.most = count.most.max(found.nodes);
        }
        start += band.len();
        if !watch(start as f64 / places as f64) {
            return Err(GenerateError::Cancelled);
        }
        if since.elapsed().as_secs_f64() < SHORT {
            length *= 2;
        }
    }
    let mut map = task.map(ratios);
    if options.min3x3 {
        map = min3x3(&map);
    }
    Ok((map, count))
}
