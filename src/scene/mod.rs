//! What there is to see: one list of the kinds of scenes.
//!
//! A [`Scene`] is the settings of one kind, a plain value. [`SceneSettings::solid`] resolves it to an
//! [`AnySolid`], which answers what passes ask ([`Solid`]) and what a GPU needs ([`Twin`]).
//! Nothing else tells one kind from another.

mod contract;
pub mod distance;
pub mod heightfield;
mod settings;
pub mod slab;

use std::ops::{Deref, DerefMut};

pub use crate::heightfield::assets::Assets;
use crate::heightfield::settings::HeightfieldSettings;
pub use contract::{Advance, Hit, Solid, Step, Surface, Twin};
use distance::{Distance, DistanceSettings};
use heightfield::Heightfield;
pub use settings::{MOST_SHADOW_STEPS, SceneSettings, Viewpoint};
use slab::{Slab, SlabSettings};

/// Work that is the same for every kind of scene.
pub trait Task {
    /// What it yields.
    type Output;
    /// Does it on one kind.
    fn run<S: Solid>(self, solid: &S) -> Self::Output;
}

/// Makes the enums of all kinds of scenes out of one list.
macro_rules! scenes {
    ($($(#[$doc:meta])* $kind:ident: $settings:ty => $solid:ty),* $(,)?) => {
        /// What there is to see, as a preset says it.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Scene { $($(#[$doc])* $kind($settings)),* }

        /// A scene resolved to numbers, seen from one eye.
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
            /// Does a task on the scene, whatever its kind.
            pub fn run<T: Task>(&self, task: T) -> T::Output {
                match self { $(Self::$kind(s) => task.run(s)),* }
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
        let formulas = DistanceSettings::all().into_iter().map(Self::Distance);
        let others = [
            HeightfieldSettings::default().into(),
            SlabSettings::default().into(),
        ];
        formulas.chain(others).collect()
    }
}

impl AnySolid {
    /// Whether pigments are colours themselves.
    pub fn is_colored(&self) -> bool {
        struct Asked;
        impl Task for Asked {
            type Output = bool;
            fn run<S: Solid>(self, solid: &S) -> bool {
                solid.is_colored()
            }
        }
        self.run(Asked)
    }
}
