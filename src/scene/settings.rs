//! What the settings of every kind of scene answer, before a scene is made from them.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::stepping::Stepping;
use super::{AnySolid, Assets, Scene};
use crate::base::key::{Fault, Key};
use crate::base::view::View;
use crate::heightfield::assets::{AssetKeys, Preparation};
use crate::heightfield::conemap::generate::generator::ShareWatch;
use crate::heightfield::tracer::settings::{Make, PrepareError};

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

    /// Every scene of the kind, with its defaults.
    fn all() -> Vec<Self>
    where
        Self: Sized;

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

    /// The scene for a few rays that tell whether cones pay; `None` if heights must be made for that.
    fn probed(&self, _from: &Viewpoint, _assets: &Assets) -> Option<AnySolid> {
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
    fn precision_warning(&self, _from: &Viewpoint, _view: &View) -> Option<String> {
        None
    }

    /// Whether the estimate tells the distance to the surface, which a glow follows.
    fn tells_distance(&self) -> bool {
        true
    }

    /// The most iterations of an evaluation.
    fn iterations(&self, _from: &Viewpoint) -> u32 {
        1
    }

    /// The fewest pixels of a picture in which cones pay, whatever the view.
    fn cone_pixels(&self) -> u64 {
        0
    }

    /// The same scene as it is best rendered with only so many rays; `None` if it has no other.
    fn with_few_rays(&self, _rays: u64, _assets: &Assets) -> Option<Scene> {
        None
    }

    /// The same scene with an exact tracer, for the truth; `None` if it has no other.
    fn exact(&self) -> Option<Scene> {
        None
    }

    /// The same scene with its sharpest estimate; `None` if it has no other.
    fn sharpest(&self) -> Option<Scene> {
        self.exact()
    }

    /// The same scene without what only colours need; `None` if it has nothing of this kind.
    fn colorless(&self) -> Option<Scene> {
        None
    }

    /// The name of the heights that the scene is made of.
    fn heights(&self) -> Option<&str> {
        None
    }

    /// Samples along each axis of heights that a pattern makes.
    fn pattern_size(&self) -> Option<[u32; 2]> {
        None
    }

    /// The folder that names of files are relative to.
    fn folder(&self) -> &Path {
        Path::new("")
    }

    /// Sets the folder that names of files are relative to.
    fn set_folder(&mut self, _folder: &Path) {}

    /// The named files, each with the key that names it.
    fn files(&self) -> Vec<(&'static str, PathBuf)> {
        Vec::new()
    }

    /// The names of files, as the preset has them.
    fn file_names(&mut self) -> Vec<&mut String> {
        Vec::new()
    }

    /// The named files that decide how a ray is followed, and not what it meets.
    fn map_files(&self) -> Vec<PathBuf> {
        Vec::new()
    }

    /// Reads the named files and checks that they fit.
    ///
    /// # Errors
    /// The key of a file that cannot be read or does not fit.
    fn load(&self, _assets: &Assets) -> Result<(), Fault> {
        Ok(())
    }

    /// Whether all assets are loaded and made. It never waits for a thread that does it.
    fn has_assets(&self, _assets: &Assets) -> bool {
        true
    }

    /// What decides the assets; `None` for a scene without.
    fn asset_keys(&self) -> Option<AssetKeys> {
        None
    }

    /// Makes the heights, if a pattern describes them.
    ///
    /// # Errors
    /// A file does not fit, or `watch` returns `false`.
    fn make_heights(&self, _assets: &Assets, _watch: ShareWatch<'_>) -> Result<(), PrepareError> {
        Ok(())
    }

    /// Makes the cone maps by `make`.
    ///
    /// # Errors
    /// A file does not fit, or `make` fails.
    fn prepare(&self, _assets: &Assets, _make: Make<'_>) -> Result<(), PrepareError> {
        Ok(())
    }

    /// The cone maps that [`SceneSettings::prepare`] makes.
    fn preparations(&self, _assets: &Assets) -> Vec<Preparation> {
        Vec::new()
    }

    /// Notes about the named files: what was ignored in them, and what could not be checked.
    fn notes(&self, _assets: &Assets) -> Vec<String> {
        Vec::new()
    }

    /// The numbers in the named files. They decide a picture as the settings do.
    fn contents(&self, _assets: &Assets) -> Vec<u8> {
        Vec::new()
    }
}
