//! What there is to see. The only place that tells one kind of scene from another.

mod contract;
pub mod distance;
pub mod heightfield;
pub mod slab;

pub use contract::{Advance, Hit, Solid, Step, Surface, Twin};

/// A scene made ready for one view.
#[derive(Clone, Debug)]
pub enum Scene {
    /// A distance-estimated formula.
    Distance(distance::Distance),
    /// A block with heights on top.
    Heightfield(heightfield::Heightfield),
    /// A slab between two planes.
    Slab(slab::Slab),
}

/// Work that is the same for every kind of scene.
pub trait Task {
    /// What it yields.
    type Output;
    /// Does it on one kind.
    fn run<S: Solid>(self, solid: &S) -> Self::Output;
}

impl Scene {
    /// Does a task on the scene, whatever its kind.
    pub fn run<T: Task>(&self, task: T) -> T::Output {
        match self {
            Self::Distance(s) => task.run(s),
            Self::Heightfield(s) => task.run(s),
            Self::Slab(s) => task.run(s),
        }
    }

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

    /// The GPU's side of the scene.
    pub fn twin(&self) -> &dyn Twin {
        match self {
            Self::Distance(s) => s,
            Self::Heightfield(s) => s,
            Self::Slab(s) => s,
        }
    }
}
