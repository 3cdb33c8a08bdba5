//! The questions about a kind of scene that its settings answer, before anything is made.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::distance::Stepping;
use super::{AnySolid, Scene};
use crate::base::key::{Fault, Key};
use crate::heightfield::assets::{Assets, Preparation};
use crate::heightfield::tracer::settings::{Make, PrepareError};

/// The most steps of a shadow ray over scenes without a formula. With the rounds of the loops
/// in them they stay under the 65 535 after which Mesa's software Vulkan ends loops.
pub const MOST_SHADOW_STEPS: u32 = 2048;

/// From where, how finely and by which steps a scene is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The camera's position.
    pub eye: DVec3,
    /// Half a pixel's width at distance 1, where pixels are finest: in the image's corners.
    pub grain: f64,
    /// How steps are taken.
    pub stepping: Stepping,
}

/// The settings of one kind of scene.
pub trait SceneSettings {
    /// The word for it in `scene.kind`.
    fn kind(&self) -> &'static str;

    /// The name of its formula, for scenes that have one.
    fn formula(&self) -> Option<&'static str> {
        None
    }

    /// The keys of `[scene]`, beside `kind` and `formula`.
    fn keys(&mut self) -> Vec<Key<'_>>;

    /// Checks that the settings fit together. No file is read.
    fn check(&self) -> Result<(), Fault>;

    /// The scene in numbers; what its assets lack is loaded, or made on the CPU.
    fn solid(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError>;

    /// As [`SceneSettings::solid`], with empty stand-ins for what takes long to make. Its
    /// programs are the same.
    fn outline(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError> {
        self.solid(from, assets)
    }

    /// The largest slope of the distance estimate, by which steps are divided.
    fn lipschitz(&self) -> f64 {
        1.0
    }

    /// The most steps that a shadow ray may take.
    fn most_shadow_steps(&self) -> u32;

    /// Whether unconverged pixels are magenta unless a preset says otherwise.
    fn flags_unconverged(&self) -> bool {
        false
    }

    /// A sentence about precision, where f32 cannot hold what a picture asks for.
    fn precision_warning(&self, _from: &Viewpoint) -> Option<String> {
        None
    }

    /// The same scene with exact hits, for the truth.
    fn exact(&self) -> Option<Scene> {
        None
    }

    /// The same scene without what only colours need, where there is such a thing.
    fn colorless(&self) -> Option<Scene> {
        None
    }

    /// Makes the names of files relative to a folder.
    fn set_folder(&mut self, _folder: &Path) {}

    /// The named files, each with the key that names it.
    fn files(&self) -> Vec<(&'static str, PathBuf)> {
        Vec::new()
    }

    /// Reads the named files and checks that they fit.
    fn load(&self, _assets: &Assets) -> Result<(), Fault> {
        Ok(())
    }

    /// Makes what takes long, by `make`.
    fn prepare(&self, _assets: &Assets, _make: Make<'_>) -> Result<(), PrepareError> {
        Ok(())
    }

    /// What [`SceneSettings::prepare`] makes.
    fn preparations(&self, _assets: &Assets) -> Vec<Preparation> {
        Vec::new()
    }

    /// Notes about the named files: what was left out of them, and what is taken on trust.
    fn notes(&self, _assets: &Assets) -> Vec<String> {
        Vec::new()
    }

    /// The numbers of the named files, which decide a picture as much as the settings do.
    fn contents(&self, _assets: &Assets) -> Vec<u8> {
        Vec::new()
    }

    /// The most steps that a ray can take through the scene, where that is known.
    fn most_steps(&self, _assets: &Assets) -> Option<u32> {
        None
    }
}
