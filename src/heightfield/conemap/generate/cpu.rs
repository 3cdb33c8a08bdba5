//! Cone maps in f64 on the CPU, places over threads.

use crate::base::parallel::collect;
use crate::heightfield::conemap::generate::generator::ShareWatch;
use crate::heightfield::conemap::generate::{
    GenerateError, Generator, MapTask, Options, min3x3::min3x3, task::Found,
};
use crate::heightfield::{ConeMap, Heights, Patches};

/// Places before the first call of the watch: seconds at most for the slowest generators
/// on large maps.
const BAND: usize = 1 << 10;
/// How many nodes the searches of a band should look up at least: some 30 ms on two cores. Bands
/// grow until they do, because each ends with waiting for the last thread, which is long on a busy
/// machine.
const FEW_NODES: u64 = 1 << 22;
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
    let task = MapTask::new(generator, heights, patches, options)?;
    let places = task.values.len();
    let channels = generator.channels();
    let mut ratios = Vec::with_capacity(places * channels);
    let (mut start, mut length) = (0, BAND);
    while start < places {
        let band = start..places.min(start + length);
        let runs = band.len().div_ceil(TAKEN);
        let found: Vec<Vec<Found>> = collect(0..runs, 1, |run| {
            let mut likely = [None; 4];
            let first = band.start + run * TAKEN;
            (first..band.end.min(first + TAKEN))
                .map(|index| task.find(index, &mut likely))
                .collect()
        });
        let mut nodes = 0;
        for found in found.iter().flatten() {
            ratios.extend_from_slice(&found.ratios[..channels]);
            nodes += u64::from(found.nodes);
        }
        start += band.len();
        if !watch(start as f64 / places as f64) {
            return Err(GenerateError::Cancelled);
        }
        if nodes < FEW_NODES {
            length *= 2;
        }
    }
    let map = task.map(ratios);
    Ok(match options.min3x3 {
        true => min3x3(&map),
        false => map,
    })
}
