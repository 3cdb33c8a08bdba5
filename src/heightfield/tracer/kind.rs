//! The list of tracers, and what is known of each before it is made.

use std::sync::Arc;

use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, MOST_LEVELS};
use crate::heightfield::tracer::cone::check_map;
use crate::heightfield::tracer::contract::{TraceError, Tracer};
use crate::heightfield::tracer::settings::{Supply, TracerSettings};
use crate::heightfield::tracer::{cones, linear, max_mip, relaxed, walk, walk_mip};

/// How well a tracer finds the first hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accuracy {
    /// It finds every first hit.
    Exact,
    /// It passes no first hit, and its own hits are off by at most a pixel.
    Pixel,
    /// It may pass thin parts of the surface.
    Approximate,
}

/// What limits the steps of a ray that nobody limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// One step to each cell on its way.
    Cells,
    /// Steps up and down the pyramid of maxima.
    Pyramid,
    /// The tracer divides every ray into its own number of steps.
    Own,
}

/// What a tracer is made of.
#[derive(Debug)]
pub struct Parts<'a> {
    /// The tracer.
    pub kind: TracerKind,
    /// What it traces.
    pub surface: &'a Arc<HeightSurface>,
    /// The cones, if there are any.
    pub cones: Option<&'a Supply>,
    /// The numbers that a preset gives it.
    pub settings: &'a TracerSettings,
    /// The distance from the eye at which a texel is as wide as a pixel.
    pub pixel: f64,
}

impl Parts<'_> {
    /// The cone map, after a check that the tracer can use it.
    ///
    /// # Errors
    /// There is none, it is of another kind, or it was made for another surface.
    pub fn map(&self) -> Result<Arc<ConeMap>, TraceError> {
        let name = self.kind.name();
        let Some(cones) = self.cones else {
            return Err(TraceError::Missing(name));
        };
        check_map(name, self.kind.kinds(), self.surface, &cones.map)?;
        Ok(cones.map.clone())
    }
}

/// Makes the enum of all tracers from one list. Each line has the word that chooses the tracer,
/// its accuracy, the kinds of cones that it can use (the one to make by default comes first),
/// the bound of its steps, the number of steps that it counts itself (0 for none), and the
/// function that makes it.
macro_rules! tracers {
    ($($(#[$doc:meta])* $kind:ident $word:literal $accuracy:ident [$($map:ident)*] $bound:ident $steps:literal $make:expr;)*) => {
        /// A way to find where a ray first meets a height surface.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum TracerKind {
            $($(#[$doc])* $kind,)*
        }

        impl TracerKind {
            /// Every tracer.
            pub const ALL: &[Self] = &[$(Self::$kind),*];

            /// Every tracer with its word.
            pub const WORDS: &[(&str, Self)] = &[$(($word, Self::$kind)),*];

            /// The word that chooses it.
            pub fn name(self) -> &'static str {
                match self { $(Self::$kind => $word,)* }
            }

            /// How well it finds the first hit.
            pub fn accuracy(self) -> Accuracy {
                match self { $(Self::$kind => Accuracy::$accuracy,)* }
            }

            /// The kinds of cones that it can use, the one to make by default first; none for a
            /// tracer without cones.
            pub fn kinds(self) -> &'static [MapKind] {
                match self { $(Self::$kind => &[$(MapKind::$map),*],)* }
            }

            /// What limits the steps of its rays.
            pub fn bound(self) -> Bound {
                match self { $(Self::$kind => Bound::$bound,)* }
            }

            /// The number of steps that it counts itself by default; 0 for no such limit.
            pub fn own_steps(self) -> u32 {
                match self { $(Self::$kind => $steps,)* }
            }

            fn maker(self) -> fn(&Parts<'_>) -> Result<Arc<dyn Tracer>, TraceError> {
                match self { $(Self::$kind => $make,)* }
            }
        }
    };
}

tracers! {
    /// The cone walk.
    Walk "walk" Exact [Walk] Cells 0 walk::make;
    /// The cone walk with relaxed cones.
    WalkRelaxed "walk-relaxed" Exact [WalkRelaxed] Cells 0 relaxed::make;
    /// The cone walk over nodes as wide as a pixel, with the cones of cells.
    WalkMip "walk-mip" Pixel [Walk] Cells 0 walk_mip::make;
    /// The cone walk over nodes as wide as a pixel, with the cones of nodes.
    ConeMip "cone-mip" Pixel [Walk] Cells 0 walk_mip::make_with_nodes;
    /// Descent of the pyramid of maxima.
    MaxMip "max-mip" Exact [] Pyramid 0 max_mip::make;
    /// Equal steps, then bisection. 32 steps are those of Policarpo, Oliveira, Comba 2005.
    LinearBinary "linear-binary" Approximate [] Own 32 linear::make;
    /// Cone steps until the surface, with the exact solve of every patch on the way.
    CsmExact "csm-exact" Approximate [Samples] Cells 0 |parts| cones::make(parts, cones::CSM_EXACT);
    /// As many cone steps as the view needs. Dummer's adaptive version is shown with 20.
    CsmLoop "csm-loop" Approximate [Samples] Cells 20 |parts| cones::make(parts, cones::CSM_LOOP);
    /// The same number of cone steps for every ray: Dummer's fixed version has 10.
    CsmFixed "csm-fixed" Approximate [Samples] Cells 10 |parts| cones::make(parts, cones::SECANT);
    /// Cone steps that are stretched, then bisection.
    CsmScaled "csm-scaled" Approximate [Samples] Cells 0 |parts| cones::make(parts, cones::CSM_SCALED);
    /// Cone steps with one cone for each of four sides.
    Quad "quad" Approximate [Quad] Cells 0 |parts| cones::make(parts, cones::SECANT);
    /// Relaxed cones, then bisection. Listing 18-3 has 15 cone steps.
    RcsBinary "rcs-binary" Approximate [Relaxed] Cells 15 |parts| cones::make(parts, cones::RCS_BINARY);
    /// Any cones over samples, then the secant method.
    Secant "secant" Approximate [Samples Quad Relaxed] Cells 0 |parts| cones::make(parts, cones::SECANT);
}

impl TracerKind {
    /// The tracer of a word.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.name() == word)
    }

    /// Whether it needs a cone map.
    pub fn needs_map(self) -> bool {
        !self.kinds().is_empty()
    }

    /// Whether it may give a ray up because the steps that it counts itself are used up.
    pub fn gives_up(self) -> bool {
        self.own_steps() > 0 && self.bound() != Bound::Own
    }

    /// Makes the tracer of a surface. `settings` gives its numbers; `pixel` is the distance from
    /// the eye at which a texel is as wide as a pixel.
    ///
    /// # Errors
    /// It needs a cone map, and there is none that it can use.
    pub fn make(
        self,
        surface: &Arc<HeightSurface>,
        cones: Option<&Supply>,
        settings: &TracerSettings,
        pixel: f64,
    ) -> Result<Arc<dyn Tracer>, TraceError> {
        self.maker()(&Parts {
            kind: self,
            surface,
            cones,
            settings,
            pixel,
        })
    }

    /// The most steps that a ray can take over a surface of so many cells along x and y
    /// together, if nobody limits them. `own` is the number of steps that the tracer counts.
    pub fn most_steps(self, cells: u32, own: u32) -> u32 {
        match self.bound() {
            // The first cell, and a line of either axis for each other one.
            Bound::Cells => cells,
            // A step down for each step up, and those down from the top.
            Bound::Pyramid => 2 * cells + MOST_LEVELS as u32,
            Bound::Own => own,
        }
    }
}
