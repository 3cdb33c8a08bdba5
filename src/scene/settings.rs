//! What the settings of every kind of scene answer, before a scene is made from them.

use glam::DVec3;

use super::AnySolid;
use super::Assets;
use super::stepping::Stepping;
use crate::base::key::{Fault, Key};
use crate::heightfield::tracer::settings::PrepareError;

/// The largest step limit of a shadow ray in scenes without a formula. Mesa's software Vulkan
/// ends loops after 65 535 rounds, inner loops included.
pub const MOST_SHADOW_STEPS: u32 = 2048;

/// The eye, the finest pixel and the steps with which a scene is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The camera's position.
    pub eye: DVec3,
    /// Half a pixel's width at distance 0; 0 unless rays are parallel.
    pub grain0: f64,
    /// How much it grows per unit of distance in a corner of the image, where pixels are finest.
    pub grain: f64,
    /// How far from the eye rays start at most.
    pub spacing: f64,
    /// How steps are taken.
    pub stepping: Stepping,
}

impl Viewpoint {
    /// The growth of pixels with the distance, as a tracer asks for it that takes coarse heights far
    /// from the eye. It is never zero: between parallel rays no heights are coarse.
    pub fn growth(&self) -> f64 {
        self.grain.max(1e-20)
    }
}

/// The settings of one kind of scene.
pub trait SceneSettings {
    /// The value of `scene.kind`.
    fn kind(&self) -> &'static str;

    /// The name of the formula, if the scene has one.
    fn formula(&self) -> Option<&'static str> {
        None
    }

    /// The keys of `[scene]` except `kind` and `formula`.
    fn keys(&mut self) -> Vec<Key<'_>>;

    /// Checks that the settings fit together. No file is read.
    fn check(&self) -> Result<(), Fault>;

    /// The scene with all settings resolved to numbers. Missing assets are loaded, or made on
    /// the CPU.
    fn solid(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError>;

    /// As [`SceneSettings::solid`], with empty stand-ins for maps that take long to make. The
    /// programs are the same.
    fn outline(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError> {
        self.solid(from, assets)
    }

    /// The scene, if it needs no assets: a few of its rays tell whether cones pay.
    fn without_assets(&self, _from: &Viewpoint) -> Option<AnySolid> {
        None
    }

    /// The Lipschitz constant of the distance estimate. Steps divide by it.
    fn lipschitz(&self) -> f64 {
        1.0
    }

    /// The largest step limit of a shadow ray.
    fn most_shadow_steps(&self) -> u32 {
        MOST_SHADOW_STEPS
    }

    /// Whether unconverged pixels are magenta by default.
    fn flags_unconverged(&self) -> bool {
        false
    }

    /// A warning if f32 is too coarse for the picture.
    fn precision_warning(&self, _from: &Viewpoint) -> Option<String> {
        None
    }
}
