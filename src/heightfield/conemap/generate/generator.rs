//! The generators by name, what they are told, and why there may be no map.

use thiserror::Error;

use crate::gpu::device::DeviceError;
use crate::gpu::kernel::KernelError;
use crate::heightfield::conemap::MapKind;

/// A way to make a cone map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Generator {
    /// Every sample against the others in growing rings, until no ring can matter
    /// (Dummer 2006).
    Brute,
    /// Eight neighbours per level of the maxima, each at its nearest point (Valasek and
    /// Ban 2022, Algorithm 1): narrower than `Brute`, never wider.
    Naive,
    /// The same, each at the nearest point that finer levels have not seen (Algorithm
    /// 2, with the nearest point as it should be).
    Improved,
    /// The same at the centres: close to `Brute`, but *not* conservative.
    Center,
    /// `Brute` by branch and bound over the maxima: equal to the last bit.
    Exact,
    /// Four cones per sample, one per side, by branch and bound.
    Quad,
    /// Relaxed cones by searching along rays (Policarpo and Oliveira 2007, Listing
    /// 18-2): unsound at any number of steps.
    RelaxedSearch,
    /// Relaxed cones by the rule of falling edges, by branch and bound.
    RelaxedExact,
    /// Cones over cells, for the exact tracer.
    Walk,
    /// The same, limited only by cells that fall away behind.
    WalkRelaxed,
}

impl Generator {
    /// Every generator.
    pub const ALL: [Self; 10] = [
        Self::Brute,
        Self::Naive,
        Self::Improved,
        Self::Center,
        Self::Exact,
        Self::Quad,
        Self::RelaxedSearch,
        Self::RelaxedExact,
        Self::Walk,
        Self::WalkRelaxed,
    ];

    /// The word that chooses it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Naive => "naive",
            Self::Improved => "improved",
            Self::Center => "center",
            Self::Exact => "exact",
            Self::Quad => "quad",
            Self::RelaxedSearch => "relaxed-search",
            Self::RelaxedExact => "relaxed-exact",
            Self::Walk => "walk",
            Self::WalkRelaxed => "walk-relaxed",
        }
    }

    /// The generator of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|g| g.name() == name)
    }

    /// What its cones promise.
    pub fn kind(self) -> MapKind {
        match self {
            Self::Brute | Self::Naive | Self::Improved | Self::Center | Self::Exact => {
                MapKind::Samples
            }
            Self::Quad => MapKind::Quad,
            Self::RelaxedSearch | Self::RelaxedExact => MapKind::Relaxed,
            Self::Walk => MapKind::Walk,
            Self::WalkRelaxed => MapKind::WalkRelaxed,
        }
    }

    /// Whether its places are cells, with an apex each, instead of samples.
    pub fn over_cells(self) -> bool {
        matches!(self, Self::Walk | Self::WalkRelaxed)
    }

    /// Whether no cone is wider than its kind allows.
    pub fn keeps_its_promise(self) -> bool {
        !matches!(self, Self::Center | Self::RelaxedSearch)
    }

    /// Cones per place.
    pub fn channels(self) -> usize {
        if self == Self::Quad { 4 } else { 1 }
    }
}

/// Most steps of a search along a ray: several to each texel of the longest axis.
pub const MOST_SEARCH_STEPS: u32 = 4096;
/// Least room that a walk's cones leave, in texels. With none at all a cell next to a
/// higher one, by however little, would have a cone of no width.
pub const LEAST_OFFSET: f64 = 1e-3;
/// Most room that they may leave: more only takes from every jump.
pub const MOST_OFFSET: f64 = 1e3;

/// What generators can be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Steps along each ray of `RelaxedSearch`, 1 to [`MOST_SEARCH_STEPS`].
    pub search_steps: u32,
    /// Room that the walks' cones leave, in texels, [`LEAST_OFFSET`] to [`MOST_OFFSET`].
    pub offset: f64,
    /// Whether each cone ends up as narrow as the narrowest of its eight neighbours (Ban
    /// and others 2024): nearly safe between the samples, too, and still no promise.
    pub min3x3: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            // As the listing has it.
            search_steps: 128,
            // Fewest steps over rays of all inclinations on terrain: 1.4 texels are as
            // good for steep rays, 3 for flat ones.
            offset: 2.0,
            min3x3: false,
        }
    }
}

impl Options {
    /// Whether a generator can be told this.
    ///
    /// # Errors
    /// Numbers outside their ranges.
    pub fn check(&self) -> Result<(), GenerateError> {
        if !(1..=MOST_SEARCH_STEPS).contains(&self.search_steps) {
            return Err(GenerateError::Steps(self.search_steps));
        }
        if !(LEAST_OFFSET..=MOST_OFFSET).contains(&self.offset) {
            return Err(GenerateError::Offset(self.offset));
        }
        Ok(())
    }
}

/// Why there is no cone map.
#[derive(Debug, Error)]
pub enum GenerateError {
    /// Too few or too many steps of the search.
    #[error("a search of {0} steps: 1 to {MOST_SEARCH_STEPS} would do")]
    Steps(u32),
    /// No offset to walk with.
    #[error("an offset of {0} texels: a number from {LEAST_OFFSET} to {MOST_OFFSET} would do")]
    Offset(f64),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// A buffer that the device does not allow.
    #[error(
        "the device `{device}` binds at most {most} bytes at once, and a map of {} x {} places needs {needed}; choose another with --device, or use --device cpu",
        size[0], size[1]
    )]
    TooLarge {
        /// Its name.
        device: String,
        /// Places along each axis.
        size: [u32; 2],
        /// Bytes of the largest buffer.
        needed: u64,
        /// Bytes that it allows.
        most: u64,
    },
    /// The device failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A program failed.
    #[error(transparent)]
    Kernel(#[from] KernelError),
    /// The device ended a search that claims not to have begun.
    #[error(
        "the device `{0}` made no progress on a cone map and reported no error; choose another with --device, or use --device cpu"
    )]
    Stuck(String),
}

/// Told the share of places that are done, now and then; `false` cancels.
pub type Watch<'a> = &'a mut dyn FnMut(f64) -> bool;

/// How much work a map was. Nodes are values looked up: samples, or maxima of any level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Nodes of all places together.
    pub nodes: u64,
    /// Nodes of the place that took most.
    pub most: u32,
}
