//! The list of generators, their options, and why a map cannot be made.

use thiserror::Error;

use crate::base::named::named_enum;
use crate::heightfield::conemap::MapKind::{self, Relaxed, Samples};
use crate::heightfield::conemap::generate::{
    ConeSearch, brute::BruteForce, quick::Quick, relaxed::RaySearch, search,
};

/// How the cones of a generator compare with the widest that their kind allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// As wide, to the last bit.
    Exact,
    /// Never wider.
    Conservative,
    /// Sometimes wider. In words: what their cones then may contain.
    Flawed(&'static str),
}

use Quality::{Conservative, Exact, Flawed};

/// What is particular to a generator.
pub struct GeneratorFacts {
    /// What it does, in words.
    pub about: &'static str,
    /// The kind of map that it makes.
    pub kind: MapKind,
    /// How wide its cones are.
    pub quality: Quality,
    /// How it searches.
    pub method: &'static dyn ConeSearch,
}

impl GeneratorFacts {
    fn new(kind: MapKind, quality: Quality, method: &'static dyn ConeSearch) -> Self {
        Self {
            about: "",
            kind,
            quality,
            method,
        }
    }

    fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }
}

named_enum! {
    /// A way to make a cone map.
    pub enum Generator: GeneratorFacts {
        /// Compares every sample with the others in growing rings, until no ring can matter
        /// (Dummer 2006).
        Brute = "brute" => GeneratorFacts::new(Samples, Exact, &BruteForce)
            .about("apex on a sample; compares it with all others, which is slow (Dummer 2006)"),
        /// Looks at eight neighbours per level of the maxima, each at its nearest point
        /// (Valasek and Ban 2022, Algorithm 1): narrower than `Brute`, never wider.
        Naive = "naive" => GeneratorFacts::new(Samples, Conservative, &Quick::Naive)
            .about("quick, and never wider than brute (Valasek and Ban 2022, Algorithm 1)"),
        /// The same, each neighbour at the nearest point that finer levels have not seen
        /// (Algorithm 2, corrected).
        Improved = "improved" => GeneratorFacts::new(Samples, Conservative, &Quick::Improved)
            .about("quick, closer to brute than naive is, and never wider (Algorithm 2)"),
        /// The same, each neighbour at its centre: close to `Brute`, but *not* conservative.
        Center = "center" =>
            GeneratorFacts::new(Samples, Flawed("samples may lie inside"), &Quick::Center)
                .about("quick, about as wide as brute; samples may lie inside some cones"),
        /// `Brute` by branch and bound over the maxima: equal to the last bit.
        Exact = "exact" => GeneratorFacts::new(Samples, Exact, &search::ALL)
            .about("the cones of brute to the last bit, found by a search that skips most samples"),
        /// Four cones per sample, one per side, by branch and bound.
        Quad = "quad" => GeneratorFacts::new(MapKind::Quad, Exact, &search::SIDES)
            .about("four cones per sample, one to each side"),
        /// Relaxed cones by a search along rays (Policarpo and Oliveira 2007, Listing
        /// 18-2): unsound at any number of steps.
        RelaxedSearch = "relaxed-search" =>
            GeneratorFacts::new(Relaxed, Flawed("rays may cross twice"), &RaySearch).about(
                "wider cones, in which a ray should enter the surface only once; rays may enter it twice (Policarpo and Oliveira 2007)",
            ),
        /// Relaxed cones by the rule of falling edges, by branch and bound.
        RelaxedExact = "relaxed-exact" => GeneratorFacts::new(Relaxed, Exact, &search::FALLING)
            .about("such cones, limited by the samples behind which the surface falls (Ban and others 2024)"),
        /// Cones over cells, for the exact tracer.
        Walk = "walk" => GeneratorFacts::new(MapKind::Walk, Exact, &search::ALL)
            .about("apex over a cell; proven empty of the surface between the samples too"),
        /// The same, limited only by cells that fall away behind.
        WalkRelaxed = "walk-relaxed" =>
            GeneratorFacts::new(MapKind::WalkRelaxed, Exact, &search::FALLING)
                .about("the same, limited only by cells that fall away behind; for rays that go down"),
    }
}

impl Generator {
    /// The kind of map that it makes.
    pub fn kind(self) -> MapKind {
        self.facts().kind
    }

    /// Whether its places are cells instead of samples.
    pub fn over_cells(self) -> bool {
        self.kind().over_cells()
    }

    /// Cones per place.
    pub fn channels(self) -> usize {
        self.kind().channels()
    }

    /// Whether it follows rays in [`Options::search_steps`] steps.
    pub fn counts_steps(self) -> bool {
        self.facts().method.counts_steps()
    }
}

/// Most steps of a search along a ray: several to each texel of the longest axis.
pub const MOST_SEARCH_STEPS: u32 = 4096;
/// Least room that the cones of a walk leave, in texels. With no room, a cell next to a
/// slightly higher one would have a cone of no width.
pub const LEAST_OFFSET: f64 = 1e-3;
/// Most room that they may leave: more only shortens every step.
pub const MOST_OFFSET: f64 = 1e3;

/// Options of the generators.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Steps along each ray that a generator follows, 1 to [`MOST_SEARCH_STEPS`].
    pub search_steps: u32,
    /// Room that the cones of a walk leave, in texels, [`LEAST_OFFSET`] to [`MOST_OFFSET`].
    pub offset: f64,
    /// Whether each cone is made as narrow as the narrowest of its eight neighbours (Bán
    /// and others 2024): nearly safe between the samples, too, but without a proof.
    pub min3x3: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            // The number of the published listing.
            search_steps: 128,
            // Fewest steps over rays of all inclinations on terrain: 1.4 texels are as
            // good for steep rays, 3 for flat ones.
            offset: 2.0,
            min3x3: false,
        }
    }
}

impl Options {
    /// Checks that all numbers are in range.
    ///
    /// # Errors
    /// The number that is out of range.
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

/// Why a cone map cannot be made.
#[derive(Debug, Error)]
pub enum GenerateError {
    /// Too few or too many steps of the search.
    #[error("a search of {0} steps is out of range; give 1 to {MOST_SEARCH_STEPS}")]
    Steps(u32),
    /// An offset out of range.
    #[error("an offset of {0} texels is out of range; give {LEAST_OFFSET} to {MOST_OFFSET}")]
    Offset(f64),
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The device that makes the map failed.
    #[error(transparent)]
    Device(Box<dyn std::error::Error + Send + Sync>),
}

/// Receives the share of places that are done, now and then; `false` cancels.
pub type ShareWatch<'a> = &'a mut dyn FnMut(f64) -> bool;
