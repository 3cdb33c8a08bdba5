//! Heights and cone maps, which one thread makes at a time.

use std::sync::{MutexGuard, TryLockError};

use super::Shared;
#[cfg(feature = "cli")]
use crate::gpu::conemap::generate::Maker;
use crate::gpu::error::{RenderError, check_room};
use crate::heightfield::assets::Preparation;
#[cfg(not(feature = "cli"))]
use crate::heightfield::conemap::generate::cpu::generate;
use crate::pass::prepare::prepare;
use crate::pass::progress::{Progress, Watch};
use crate::plan::Plan;
use crate::scene::Assets;

impl Shared {
    /// Waits until no other thread prepares. What it makes may be what this one needs.
    pub fn wait_to_prepare(&self, tell: Watch<'_>) -> Result<MutexGuard<'_, ()>, RenderError> {
        let wait = Progress {
            pass: "heights, maps and programs".into(),
            ..Progress::default()
        };
        loop {
            match self.preparing.try_lock() {
                Ok(turn) => return Ok(turn),
                Err(TryLockError::Poisoned(turn)) => return Ok(turn.into_inner()),
                Err(TryLockError::WouldBlock) if !tell(&wait) => {
                    return Err(RenderError::Cancelled);
                }
                // Without threads, it is free.
                Err(TryLockError::WouldBlock) => {
                    #[cfg(feature = "cli")]
                    std::thread::sleep(std::time::Duration::from_millis(2));
                }
            }
        }
    }

    /// Makes the heights and the cone maps of a plan.
    pub fn make_maps(
        &self,
        plan: &Plan,
        assets: &Assets,
        tell: Watch<'_>,
    ) -> Result<Vec<(Preparation, f64)>, RenderError> {
        let device = &self.device;
        // Large heights take seconds to make.
        if let Some([w, h]) = plan.scene.pattern_size() {
            let bytes = 4 * u64::from(w) * u64::from(h);
            check_room(&device.info.name, "heights", bytes, device.most_bound())?;
        }
        // The device makes the cone maps, where one may wait for it.
        #[cfg(feature = "cli")]
        let made = {
            let mut maker = Maker::new(device);
            maker.kernels = self.kernels.clone();
            let make = &mut |generator,
                             heights: &_,
                             patches,
                             options: &_,
                             share: &mut dyn FnMut(f64) -> bool| {
                maker.generate(generator, heights, patches, options, share)
            };
            prepare(plan, assets, make, device.clock, tell)
        };
        #[cfg(not(feature = "cli"))]
        let made = prepare(plan, assets, &mut generate, device.clock, tell);
        Ok(made?)
    }
}
