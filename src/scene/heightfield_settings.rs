//! What the settings of a heightfield answer as those of a scene.

use std::path::{Path, PathBuf};

use super::heightfield::Heightfield;
use super::{AnySolid, Assets, Scene, SceneSettings, Viewpoint};
use crate::base::key::{Fault, Key};
use crate::heightfield::assets::{AssetKeys, Preparation};
use crate::heightfield::conemap::generate::generator::ShareWatch;
use crate::heightfield::settings::HeightfieldSettings;
use crate::heightfield::tracer::TracerKind;
use crate::heightfield::tracer::settings::{Make, PrepareError};

/// Cones pay from so many pixels on. Over most built-in heightfields, rays alone are faster up to
/// 320 x 180, and cones from 640 x 360 on.
const CONE_PIXELS: u64 = 100_000;

/// A cone map pays from about so many rays for each sample of the heights on: from 2 to 6 on software
/// Vulkan, by preset (`bench few_rays`), and from 2.5 to 3.8 on the CPU.
const RAYS_PER_CONE: u64 = 3;

impl SceneSettings for HeightfieldSettings {
    fn kind(&self) -> &'static str {
        "heightfield"
    }

    fn all() -> Vec<Self> {
        vec![Self::default()]
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        self.keys()
    }

    fn check(&self) -> Result<(), Fault> {
        self.check()
    }

    fn solid(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError> {
        let ready = assets.heightfield.ready(self, from.growth())?;
        Ok(AnySolid::Heightfield(Heightfield::of(self, ready, from)))
    }

    fn outline(&self, from: &Viewpoint, assets: &Assets) -> Result<AnySolid, PrepareError> {
        let ready = assets.heightfield.outline(self, from.growth())?;
        Ok(AnySolid::Heightfield(Heightfield::of(self, ready, from)))
    }

    fn probed(&self, from: &Viewpoint, assets: &Assets) -> Option<AnySolid> {
        let bare = self.colorless().exact();
        let made = assets.heightfield.has(&bare);
        made.then(|| bare.solid(from, assets).ok()).flatten()
    }

    /// A tracer of the papers can run out of steps anywhere; a fractal's ray does so only next
    /// to a hit.
    fn flags_unconverged(&self) -> bool {
        true
    }

    fn tells_distance(&self) -> bool {
        false
    }

    fn cone_pixels(&self) -> u64 {
        CONE_PIXELS
    }

    fn with_few_rays(&self, rays: u64, assets: &Assets) -> Option<Scene> {
        let samples = assets.heightfield.samples(self)?;
        let cones: u64 = samples.map(u64::from).iter().product();
        (self.may_drop_map() && rays < RAYS_PER_CONE * cones).then(|| {
            let mut other = self.clone();
            other.tracer_settings.tracer = Some(TracerKind::exact_without_map());
            other.into()
        })
    }

    fn exact(&self) -> Option<Scene> {
        Some(self.exact().into())
    }

    fn colorless(&self) -> Option<Scene> {
        Some(self.colorless().into())
    }

    fn heights(&self) -> Option<&str> {
        Some(&self.source.field)
    }

    fn pattern_size(&self) -> Option<[u32; 2]> {
        self.source.pattern_size()
    }

    fn folder(&self) -> &Path {
        &self.source.folder
    }

    fn set_folder(&mut self, folder: &Path) {
        self.source.folder = folder.to_path_buf();
    }

    fn files(&self) -> Vec<(&'static str, PathBuf)> {
        self.files()
    }

    fn file_names(&mut self) -> Vec<&mut String> {
        self.file_names()
    }

    fn map_files(&self) -> Vec<PathBuf> {
        self.map_file().into_iter().collect()
    }

    fn load(&self, assets: &Assets) -> Result<(), Fault> {
        assets.heightfield.load(self)
    }

    fn has_assets(&self, assets: &Assets) -> bool {
        assets.heightfield.has(self)
    }

    fn asset_keys(&self) -> Option<AssetKeys> {
        Some(AssetKeys::of(self))
    }

    fn make_heights(&self, assets: &Assets, watch: ShareWatch<'_>) -> Result<(), PrepareError> {
        assets.heightfield.make_heights(self, watch)
    }

    fn prepare(&self, assets: &Assets, make: Make<'_>) -> Result<(), PrepareError> {
        assets.heightfield.prepare(self, make)
    }

    fn preparations(&self, assets: &Assets) -> Vec<Preparation> {
        assets.heightfield.preparations(self)
    }

    fn notes(&self, assets: &Assets) -> Vec<String> {
        assets.heightfield.notes(self)
    }

    fn contents(&self, assets: &Assets) -> Vec<u8> {
        assets.heightfield.contents(self)
    }
}
