//! The pass before all others: it makes the heights and the cone maps that a scene needs.

use thiserror::Error;

use super::progress::{Progress, Watch};
use crate::base::clock::Clock;
use crate::base::key::Fault;
use crate::heightfield::assets::Preparation;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::tracer::settings::PrepareError;
use crate::plan::Plan;
use crate::scene::Assets;

/// Why there is no frame, on any executor.
#[derive(Debug, Error)]
pub enum FrameError {
    /// An asset of the scene could not be loaded or made.
    #[error(transparent)]
    Prepare(PrepareError),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<Fault> for FrameError {
    fn from(fault: Fault) -> Self {
        PrepareError::from(fault).into()
    }
}

impl From<PrepareError> for FrameError {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Generate(GenerateError::Cancelled) => Self::Cancelled,
            other => Self::Prepare(other),
        }
    }
}

/// Makes a cone map. It reports the share that is done, and stops if the answer is `false`.
pub type Maker<'a> = &'a mut dyn FnMut(
    Generator,
    &Heights,
    Patches,
    &Options,
    &mut dyn FnMut(f64) -> bool,
) -> Result<ConeMap, GenerateError>;

/// Makes the heights of a plan, and its cone maps by `maker`, and keeps them in the assets. Returns the
/// milliseconds by `clock` that each map took; 0 for a map that was kept.
///
/// # Errors
/// A file does not fit, the maker fails, or `watch` returns `false`.
pub fn prepare(
    plan: &Plan,
    assets: &Assets,
    maker: Maker<'_>,
    clock: Clock,
    watch: Watch<'_>,
) -> Result<Vec<(Preparation, f64)>, PrepareError> {
    let mut tell = |pass: &str, done| {
        let pass = pass.into();
        watch(&Progress {
            pass,
            done,
            is_step: true,
        })
    };
    if let Some(field) = plan.scene.heights() {
        let pass = format!("heights of {field}");
        let watch = &mut |done| tell(&pass, done);
        plan.scene.make_heights(assets, watch)?;
    }
    if let Some(path) = plan.look.sky.path().filter(|path| !assets.has_sky(path)) {
        if !tell(&format!("sky of {}", path.display()), 0.0) {
            return Err(GenerateError::Cancelled.into());
        }
        assets.sky(plan)?;
    }
    let mut taken = Vec::new();
    let make = &mut |generator, heights: &Heights, patches, options: &Options| {
        let start = clock();
        let pass = format!("cone map by {}", Generator::name(generator));
        let told = &mut |done| tell(&pass, done);
        let made = maker(generator, heights, patches, options, told);
        taken.push((generator, clock() - start));
        made
    };
    plan.scene.prepare(assets, make)?;
    let time = |map: Preparation| {
        let of = taken.iter().find(|(by, _)| *by == map.generator);
        (map, of.map_or(0.0, |(_, ms)| *ms))
    };
    let maps = plan.scene.preparations(assets);
    Ok(maps.into_iter().map(time).collect())
}
