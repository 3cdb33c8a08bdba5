//! Tracers with one cone per sample: those of the papers, put right.
//! Twins: `wgsl/heightfield/tracer/cones.wgsl`, with `cones_one.wgsl` or `cones_four.wgsl`.
//!
//! Dummer's step (Cone Step Mapping, 2006) from the height z over a place with height h and
//! ratio R is `(z - h) R / (iz - dz R)` along a direction of horizontal part iz; his text has
//! the wrong sign, his code the right one. What is put right besides: a step goes at least
//! to the cell's edge, in place of a texel added to each; the part of the ray inside the
//! block is clipped first, so that rising and level rays end; the first place under the
//! surface ends the search and is refined between it and the one before; and a ray that has
//! used up its steps above the surface has not converged, whatever the papers show there.
//!
//! None of this makes such cones safe: they keep clear of samples, not of the surface
//! between them. What each tracer misses is measured, not promised away.

use std::sync::Arc;

use glam::DVec3;

use crate::base::shader::Module;
use crate::base::work::Work;
use crate::heightfield::conemap::generate::mips::rounded_down;
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::{HeightSurface, Numbers};
use crate::heightfield::heights::Patches;
use crate::heightfield::tracer::contract::{LocalRay, Step, Trace, TraceError, Tracer};
use crate::heightfield::tracer::course::{
    course_begin, course_cross, course_end, course_exit, course_hit, course_land, course_solve,
    course_uv,
};
use crate::heightfield::tracer::refine::{Refine, refine, refine_over};
use crate::heightfield::tracer::walk::{check_map, cone_way};
use crate::wgsl;

/// How a ratio is read between the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Lookup {
    /// Height and ratio of the nearest sample.
    Nearest,
    /// The surface's height, and the ratio interpolated.
    #[default]
    Bilinear,
}

/// How many steps a ray has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// As many as the caller allows.
    Endless,
    /// The same for every ray.
    Fixed(u32),
    /// `steps * (0.5 + iz)`, iz being the horizontal part of the direction when heights and
    /// texture widths are the units, and half of them at the distance `lod` along the ray, a
    /// third at twice that; `lod` 0 is for no such thing.
    View {
        /// Steps of a ray halfway between vertical and level.
        steps: u32,
        /// Distance in units of the ray's parameter.
        lod: f64,
    },
}

/// What tells one of these tracers from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manner {
    /// Its name.
    pub name: &'static str,
    /// How ratios are read.
    pub lookup: Lookup,
    /// Whether the patch of each cell on the way is solved.
    pub solves: bool,
    /// Its own limit.
    pub budget: Budget,
    /// Factor on the steps that cones give.
    pub scale: f64,
    /// How a bracket becomes a hit.
    pub refine: Refine,
}

/// Steps of the paper's fixed version.
pub const FIXED_STEPS: u32 = 10;
/// Steps that the paper shows its adaptive version with.
pub const LOOP_STEPS: u32 = 20;
/// Cone steps of listing 18-3, and halvings after them.
pub const RCS_STEPS: u32 = 15;
/// Halvings of listing 18-3.
pub const RCS_ROUNDS: u32 = 6;
/// False positions: the error falls at least by half with each, mostly by much more.
pub const SECANT_ROUNDS: u32 = 4;
/// How much `csm-scaled` stretches a step: what it jumps over is mostly thinner than a
/// texel still.
pub const SCALE: f64 = 1.5;

impl Manner {
    /// Cones until the surface, every patch on the way solved.
    pub const CSM_EXACT: Self = Self {
        name: "csm-exact",
        lookup: Lookup::Bilinear,
        solves: true,
        budget: Budget::Endless,
        scale: 1.0,
        refine: Refine::Settle,
    };
    /// A number of steps that follows the view.
    pub const CSM_LOOP: Self = Self {
        name: "csm-loop",
        solves: false,
        budget: Budget::View {
            steps: LOOP_STEPS,
            lod: 0.0,
        },
        refine: Refine::Secant(SECANT_ROUNDS),
        ..Self::CSM_EXACT
    };
    /// The same number of steps for every ray.
    pub const CSM_FIXED: Self = Self {
        name: "csm-fixed",
        budget: Budget::Fixed(FIXED_STEPS),
        ..Self::CSM_LOOP
    };
    /// Stretched steps, then halvings.
    pub const CSM_SCALED: Self = Self {
        name: "csm-scaled",
        budget: Budget::Endless,
        scale: SCALE,
        refine: Refine::Binary(RCS_ROUNDS),
        ..Self::CSM_LOOP
    };
    /// One cone for each of four sides.
    pub const QUAD: Self = Self {
        name: "quad",
        budget: Budget::Endless,
        ..Self::CSM_LOOP
    };
    /// Relaxed cones, then halvings.
    pub const RCS_BINARY: Self = Self {
        name: "rcs-binary",
        budget: Budget::Fixed(RCS_STEPS),
        refine: Refine::Binary(RCS_ROUNDS),
        ..Self::CSM_LOOP
    };
    /// Any cones, then false positions.
    pub const SECANT: Self = Self {
        name: "secant",
        budget: Budget::Endless,
        ..Self::CSM_LOOP
    };

    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::CSM_EXACT,
        Self::CSM_LOOP,
        Self::CSM_FIXED,
        Self::CSM_SCALED,
        Self::QUAD,
        Self::RCS_BINARY,
        Self::SECANT,
    ];

    /// Kinds of maps that it can use.
    pub fn kinds(&self) -> &'static [MapKind] {
        match self.name {
            "quad" => &[MapKind::Quad],
            "rcs-binary" => &[MapKind::Relaxed],
            "secant" => &[MapKind::Samples, MapKind::Quad, MapKind::Relaxed],
            _ => &[MapKind::Samples],
        }
    }
}

/// Cone steps over a relief.
#[derive(Clone, Debug)]
pub struct Cones {
    relief: Arc<HeightSurface>,
    map: Arc<ConeMap>,
    manner: Manner,
}

impl Cones {
    /// A tracer with the cones of a map.
    ///
    /// # Errors
    /// The map is of a kind that the manner cannot use, or of another relief.
    pub fn new(
        relief: Arc<HeightSurface>,
        map: Arc<ConeMap>,
        manner: Manner,
    ) -> Result<Self, TraceError> {
        check_map(manner.name, manner.kinds(), &relief, &map)?;
        Ok(Self {
            relief,
            map,
            manner,
        })
    }

    /// Height and ratio of the cone over the ray at s.
    fn cone(&self, ray: &LocalRay, trace: &Trace) -> (f64, f64) {
        let relief = &*self.relief;
        let [u, v] = course_uv(ray, trace.cell, trace.s);
        let [x, y] = relief.tile_cell(trace.cell).map(i64::from);
        // A box's sample lies in its middle, a patch's in its corners.
        let boxes = relief.patches() == Patches::Boxes;
        if self.manner.lookup == Lookup::Nearest {
            let [i, j] = if boxes {
                [x, y]
            } else {
                [x + i64::from(u >= 0.5), y + i64::from(v >= 0.5)]
            };
            return (relief.heights().at(i, j), self.ratio(ray.axis, i, j));
        }
        let height = relief.height(trace.cell, u, v);
        let [[i, u], [j, v]] = [[u, x as f64], [v, y as f64]].map(|[f, i]| {
            let at = if boxes { i + f - 0.5 } else { i + f };
            // The far edge belongs to the cell.
            let low = if boxes { at.floor() } else { i };
            [low, at - low]
        });
        let (i, j) = (i as i64, j as i64);
        let near = |j| {
            let (a, b) = (self.ratio(ray.axis, i, j), self.ratio(ray.axis, i + 1, j));
            a + u * (b - a)
        };
        let (low, high) = (near(j), near(j + 1));
        (height, low + v * (high - low))
    }

    /// The ratio at a sample, for the side that the ray goes to.
    fn ratio(&self, axis: DVec3, i: i64, j: i64) -> f64 {
        let heights = self.relief.heights();
        let (i, j) = (heights.index(0, i), heights.index(1, j));
        let at = (j * self.map.size[0] + i) as usize;
        if self.map.kind != MapKind::Quad {
            return self.map.ratios[at];
        }
        let side = if axis.x.abs() >= axis.y.abs() {
            usize::from(axis.x < 0.0)
        } else {
            2 + usize::from(axis.y < 0.0)
        };
        self.map.ratios[4 * at + side]
    }

    /// Steps of a ray that begins at s; 0 for no limit.
    fn budget(&self, ray: &LocalRay, s: f64) -> u32 {
        match self.manner.budget {
            Budget::Endless => 0,
            Budget::Fixed(steps) => steps.max(1),
            Budget::View { steps, lod } => {
                let [w, h] = self.relief.cells().map(f64::from);
                let flat = (ray.axis.x / w).hypot(ray.axis.y / h);
                let whole = flat.hypot(ray.axis.z).max(f64::MIN_POSITIVE);
                let far = if lod > 0.0 {
                    1.0 + s.max(0.0) / lod
                } else {
                    1.0
                };
                let count = f64::from(steps) * (0.5 + flat / whole) / far;
                count.ceil().max(1.0) as u32
            }
        }
    }
}

impl Tracer for Cones {
    fn begin(&self, ray: &LocalRay, from: f64, to: f64, _work: &mut Work) -> Trace {
        let mut trace = course_begin(&self.relief, ray, from, to);
        trace.left = self.budget(ray, trace.s);
        trace
    }

    fn look(&self, ray: &LocalRay, trace: &mut Trace, work: &mut Work) -> Step {
        let relief = &*self.relief;
        let (exit, axis) = course_exit(ray, trace.cell, trace.cell.map(|i| i + 1));
        let to = exit.min(trace.end);
        let z = ray.height(trace.s);
        trace.gap = z.min(ray.height(to)) - relief.apex(trace.cell);
        if refine_over(relief, ray, trace.s) <= 0.0 {
            course_hit(relief, ray, trace, trace.s);
            return Step::Hit;
        }
        let solves = self.manner.solves;
        if solves && trace.gap <= 0.0 && course_solve(relief, ray, trace, to) {
            return Step::Hit;
        }
        let (height, ratio) = self.cone(ray, trace);
        let way = cone_way(ray, ratio, z - height, 0.0) * self.manner.scale;
        let next = (trace.s + way).max(exit).min(trace.end);
        let ended = next >= trace.end;
        if (ended && trace.falls) || refine_over(relief, ray, next) <= 0.0 {
            let low = if solves { to } else { trace.s };
            refine(relief, ray, trace, [low, next], self.manner.refine, work);
            return Step::Hit;
        }
        if ended {
            return course_end(relief, ray, trace);
        }
        if next > exit {
            course_land(relief, ray, trace, next);
        } else {
            course_cross(ray, trace, exit, axis);
        }
        if trace.left == 1 {
            trace.state = Step::Spent;
        }
        trace.left = trace.left.saturating_sub(1);
        trace.state
    }

    fn modules(&self) -> Vec<Module> {
        let set = |is: bool| f64::from(u8::from(is));
        let manner = &self.manner;
        let mut all = self.relief.modules();
        all.push(wgsl!("heightfield/tracer/cone.wgsl"));
        all.push(wgsl!("heightfield/tracer/refine.wgsl"));
        all.push(if self.map.kind == MapKind::Quad {
            wgsl!("heightfield/tracer/cones_four.wgsl")
        } else {
            wgsl!("heightfield/tracer/cones_one.wgsl")
        });
        all.push(wgsl!(
            "heightfield/tracer/cones.wgsl",
            "CONES_NEAREST" = set(manner.lookup == Lookup::Nearest),
            "CONES_SOLVE" = set(manner.solves),
            "CONES_VIEW" = set(matches!(manner.budget, Budget::View { .. })),
            "CONES_SECANT" = set(matches!(manner.refine, Refine::Secant(_))),
        ));
        all
    }

    fn buffers(&self) -> Vec<(&'static str, Vec<u8>)> {
        let (steps, lod) = match self.manner.budget {
            Budget::Endless => (0, 0.0),
            Budget::Fixed(steps) => (steps.max(1), 0.0),
            Budget::View { steps, lod } => (steps, lod),
        };
        let numbers = Numbers {
            scale: self.manner.scale,
            steps,
            lod,
            rounds: match self.manner.refine {
                Refine::Binary(rounds) | Refine::Secant(rounds) => rounds,
                Refine::Settle => 0,
            },
        };
        if self.map.kind != MapKind::Quad {
            return self.relief.buffers(Some(&self.map), numbers);
        }
        // Four cones of a map of 4096 x 4096 are more than a binding must hold: two, and two.
        let half = |side: usize| -> Vec<u8> {
            let two = self
                .map
                .ratios
                .chunks(4)
                .flat_map(|four| &four[side..side + 2]);
            two.flat_map(|ratio| rounded_down(*ratio).to_ne_bytes())
                .collect()
        };
        let bare = ConeMap {
            ratios: Vec::new(),
            ..*self.map
        };
        let mut all = self.relief.buffers(Some(&bare), numbers);
        all.retain(|(name, _)| *name != "ratios");
        all.extend([("ratios", half(0)), ("ratios_y", half(2))]);
        all
    }
}
