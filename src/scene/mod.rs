//! Scenes: what there is to see.
//!
//! - [`distance`]: a formula; [`distance_settings`]: its keys; [`stepping`]: how it takes its
//!   steps; `distance_steps`: one step; `distance_lanes`: steps side by side
//! - [`heightfield`]: a block with heights on top; `heightfield_settings`: what its keys mean here
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
mod distance_lanes;
pub mod distance_settings;
mod distance_steps;
pub mod heightfield;
mod heightfield_settings;
mod settings;
pub mod sky;
pub mod slab;
pub mod stepping;

use std::ops::{Deref, DerefMut};

use crate::heightfield::settings::HeightfieldSettings;
pub use assets::Assets;
pub use contract::{Advance, Hit, ROOMS, Solid, Step, Surface, Twin};
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

        impl Scene {
            /// Every scene with its defaults: each formula, and each other kind.
            pub fn all() -> Vec<Self> {
                let mut all = Vec::new();
                $(all.extend(<$settings>::all().into_iter().map(Self::$kind));)*
                all
            }
        }

        $(impl From<$settings> for Scene {
            fn from(settings: $settings) -> Self {
                Self::$kind(settings)
            }
        })*
    };
}

scenes![
    /// A distance-estimated formula.
    Distance: DistanceSettings => Distance,
    /// A block with heights on top.
    Heightfield: HeightfieldSettings => Heightfield,
    /// A slab between two planes.
    Slab: SlabSettings => Slab,
];

impl Scene {
    /// The same kind of scene with its defaults, and the folder of its files.
    #[must_use]
    pub fn usual(&self) -> Self {
        let same = |scene: &Self| scene.kind() == self.kind() && scene.formula() == self.formula();
        let usual = Self::all().into_iter().find(same);
        let mut usual = usual.unwrap_or_else(|| self.clone());
        usual.set_folder(self.folder());
        usual
    }
}
