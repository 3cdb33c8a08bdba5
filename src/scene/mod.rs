//! Scenes: what there is to see.
//!
//! - [`distance`]: a formula; [`distance_settings`]: its keys; [`stepping`]: how it takes its
//!   steps
//! - [`heightfield`]: a block with heights on top
//! - [`slab`]: a slab between two planes, the smallest complete scene
//! - [`sky`]: a sky in a file; `assets`: what is read and made
//! - `contract`: [`Solid`], what passes ask a scene; [`Twin`], what a GPU needs of it
//! - `settings`: [`SceneSettings`], what the settings of a scene answer
//!
//! A [`Scene`] holds the settings of one kind as a plain value. [`SceneSettings::solid`]
//! resolves them to an [`AnySolid`], which answers [`Solid`] and [`Twin`]. The list `scenes!`
//! below names all kinds; passes and executors do not know them.

mod assets;
mod contract;
pub mod distance;
pub mod distance_settings;
pub mod heightfield;
mod settings;
pub mod sky;
pub mod slab;
pub mod stepping;

use std::ops::{Deref, DerefMut};
use std::path::{Path, PathBuf};

use crate::base::key::Fault;
use crate::formula::Formula;
use crate::heightfield::assets::Preparation;
use crate::heightfield::settings::HeightfieldSettings;
use crate::heightfield::tracer::settings::{Make, PrepareError};
pub use assets::Assets;
pub use contract::{Advance, Hit, Solid, Step, Surface, Twin};
use distance::Distance;
use distance_settings::DistanceSettings;
use heightfield::Heightfield;
pub use settings::{MOST_SHADOW_STEPS, SceneSettings, Viewpoint};
use slab::{Slab, SlabSettings};

/// Generic work on a scene of any kind.
pub trait Task {
    /// Its result.
    type Output;
    /// Does the work on one scene.
    fn run<S: Solid>(self, solid: &S) -> Self::Output;
}

/// Makes the enums of all kinds of scenes from one list: name, settings, solid.
macro_rules! scenes {
    ($($(#[$doc:meta])* $kind:ident: $settings:ty => $solid:ty),* $(,)?) => {
        /// The settings of a scene.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Scene { $($(#[$doc])* $kind($settings)),* }

        /// A scene seen from one eye, with all settings resolved to numbers.
        #[derive(Clone, Debug)]
        pub enum AnySolid { $($(#[$doc])* $kind($solid)),* }

        impl Deref for Scene {
            type Target = dyn SceneSettings;
            fn deref(&self) -> &Self::Target {
                match self { $(Self::$kind(s) => s),* }
            }
        }

        impl DerefMut for Scene {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self { $(Self::$kind(s) => s),* }
            }
        }

        impl AnySolid {
            /// Does a task on the scene.
            pub fn run<T: Task>(&self, task: T) -> T::Output {
                match self { $(Self::$kind(s) => task.run(s)),* }
            }

            /// Whether pigments are colours.
            pub fn is_colored(&self) -> bool {
                match self { $(Self::$kind(s) => s.is_colored()),* }
            }

            /// The GPU's side of the scene.
            pub fn twin(&self) -> &dyn Twin {
                match self { $(Self::$kind(s) => s),* }
            }
        }

        $(impl From<$settings> for Scene {
            fn from(settings: $settings) -> Self {
                Self::$kind(settings)
            }
        })*
    };
}

/// Over a heightfield, cones pay from so many pixels on. Over the built-in ones, rays alone are
/// faster at 160 x 90, neither at 320 x 180, and cones at 640 x 360.
const CONE_PIXELS: u32 = 50_000;

scenes![
    /// A distance-estimated formula.
    Distance: DistanceSettings => Distance,
    /// A block with heights on top.
    Heightfield: HeightfieldSettings => Heightfield,
    /// A slab between two planes.
    Slab: SlabSettings => Slab,
];

impl Scene {
    /// Every scene with its defaults: each formula, and each other kind.
    pub fn all() -> Vec<Self> {
        let formulas = Formula::all().into_iter().map(Self::from);
        let others = [
            HeightfieldSettings::default().into(),
            SlabSettings::default().into(),
        ];
        formulas.chain(others).collect()
    }

    /// The settings of a heightfield, the only kind that names files and needs assets.
    pub fn heightfield(&self) -> Option<&HeightfieldSettings> {
        match self {
            Self::Heightfield(settings) => Some(settings),
            _ => None,
        }
    }

    /// The fewest pixels of a picture in which cones pay, whatever the view.
    pub fn cone_pixels(&self) -> u32 {
        self.heightfield().map_or(0, |_| CONE_PIXELS)
    }

    /// The same kind of scene with its defaults.
    pub fn usual(&self) -> Self {
        let same = |scene: &Self| scene.kind() == self.kind() && scene.formula() == self.formula();
        let mut usual = Self::all()
            .into_iter()
            .find(same)
            .unwrap_or_else(|| self.clone());
        if let (Self::Heightfield(usual), Some(own)) = (&mut usual, self.heightfield()) {
            usual.source.folder = own.source.folder.clone();
        }
        usual
    }

    /// The same scene with an exact tracer, for the truth; `None` if it has no other.
    pub fn exact(&self) -> Option<Self> {
        Some(self.heightfield()?.exact().into())
    }

    /// The same scene with its sharpest estimate, or an exact tracer.
    pub fn sharpest(&self) -> Self {
        let mut sharpest = self.exact().unwrap_or_else(|| self.clone());
        if let Self::Distance(settings) = &mut sharpest {
            settings.formula.sharpen();
        }
        sharpest
    }

    /// The same scene without what only colours need; `None` if it has nothing of this kind.
    pub fn colorless(&self) -> Option<Self> {
        Some(self.heightfield()?.colorless().into())
    }

    /// Sets the folder that names of files are relative to.
    pub fn set_folder(&mut self, folder: &Path) {
        if let Self::Heightfield(settings) = self {
            settings.source.folder = folder.to_path_buf();
        }
    }

    /// The named files, each with the key that names it.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        self.heightfield().map(|h| h.files()).unwrap_or_default()
    }

    /// Reads the named files and checks that they fit.
    ///
    /// # Errors
    /// The key of a file that cannot be read or does not fit.
    pub fn load(&self, assets: &Assets) -> Result<(), Fault> {
        self.heightfield()
            .map_or(Ok(()), |h| assets.heightfield.load(h))
    }

    /// Samples along each axis of heights that a pattern makes.
    pub fn pattern_size(&self) -> Option<[u32; 2]> {
        self.heightfield()?.source.pattern_size()
    }

    /// Whether all assets are loaded and made. It never waits for a thread that does it.
    pub fn has_assets(&self, assets: &Assets) -> bool {
        self.heightfield().is_none_or(|h| assets.heightfield.has(h))
    }

    /// Makes the cone maps by `make`.
    ///
    /// # Errors
    /// A file does not fit, or `make` fails.
    pub fn prepare(&self, assets: &Assets, make: Make<'_>) -> Result<(), PrepareError> {
        self.heightfield()
            .map_or(Ok(()), |h| assets.heightfield.prepare(h, make))
    }

    /// The cone maps that [`Scene::prepare`] makes.
    pub fn preparations(&self, assets: &Assets) -> Vec<Preparation> {
        let all = self
            .heightfield()
            .map(|h| assets.heightfield.preparations(h));
        all.unwrap_or_default()
    }

    /// Notes about the named files: what was ignored in them, and what could not be checked.
    pub fn notes(&self, assets: &Assets) -> Vec<String> {
        let all = self.heightfield().map(|h| assets.heightfield.notes(h));
        all.unwrap_or_default()
    }

    /// The numbers in the named files. They decide a picture as the settings do.
    pub fn contents(&self, assets: &Assets) -> Vec<u8> {
        let all = self.heightfield().map(|h| assets.heightfield.contents(h));
        all.unwrap_or_default()
    }
}
