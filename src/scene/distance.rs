//! A scene given by a distance estimate.
//!
//! Cones advance by the cone step, rays by sphere tracing with relaxation (docs/method.md, 2).
//! Steps, hits and normals all use one field: the larger of the estimate and the distance to
//! the bounds. So the bounds do not cut the visible surface open.
//! A step keeps clear of a share of the hit threshold, the *shell*, or a long step could jump over
//! a thin part of the surface. Twin: `wgsl/scene/distance.wgsl`.

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{DVec3, Vec3};

use crate::base::lanes::{LANES, Places};
use crate::base::outcome::Counts;
use crate::base::shader::Module;
use crate::base::view::{Beam, footprint};
use crate::formula::{Bounds, Evaluator, Formula, Reading};
use crate::scene::contract::{Advance, Hit, ROOMS, Solid, Step, Surface, Twin};
use crate::scene::distance_steps::{
    DISTANCE_ENOUGH, DISTANCE_LEAST, DISTANCE_MOST_RELAXED, DISTANCE_SMOOTHING, DISTANCE_TRIAL,
    Walk,
};
use crate::scene::stepping::Stepping;
use crate::wgsl;

/// Where a clipped ray starts, in hit thresholds from the bounds. At 1, rounding decides whether the
/// first sample is a hit. At less, a grazing ray starts behind the threshold: 2.8 % of the pixels of
/// `bench-graze` do at 0.9, and 0.2 % at 0.99.
const DISTANCE_WITHIN: f64 = 0.99;
/// A gradient, as a sum of four differences, that is shorter than this has no direction.
const DISTANCE_FLAT: f64 = 1e-20;
/// The corners of a tetrahedron.
pub(super) const CORNERS: [DVec3; 4] = [
    DVec3::new(1.0, -1.0, -1.0),
    DVec3::new(-1.0, -1.0, 1.0),
    DVec3::new(-1.0, 1.0, -1.0),
    DVec3::new(1.0, 1.0, 1.0),
];

/// The scene as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct DistanceUniform {
    /// Camera position.
    pub eye: Vec3,
    /// Hit threshold in footprints.
    pub detail: f32,
    /// Centre of the bounds.
    pub centre: Vec3,
    /// Radius of the bounds.
    pub radius: f32,
    /// Half extents of the bounds.
    pub half: Vec3,
    /// Nothing is farther from the eye.
    pub far: f32,
    /// Share of the hit threshold that steps keep clear of.
    pub shell: f32,
    /// 0 automatic, 1 off, else a factor.
    pub relaxation: f32,
    /// Factor on ray steps.
    pub stride: f32,
    /// Iteration limit of the formula.
    pub iterations: u32,
    /// 1 to start rays where they enter the bounds.
    pub clip: u32,
    /// The first ball that cones from the eye try.
    pub first_trial: f32,
    /// Unused.
    pub pad0: u32,
    /// Unused.
    pub pad1: u32,
}

/// A formula seen from an eye, with all settings resolved to numbers.
#[derive(Clone, Debug)]
pub struct Distance {
    /// The formula.
    pub formula: Formula,
    pub(super) evaluator: Evaluator,
    /// Its iteration limit.
    pub iterations: u32,
    /// Camera position.
    pub eye: DVec3,
    /// How steps are taken.
    pub stepping: Stepping,
    pub(super) bounds: Bounds,
    /// The first ball that cones from the eye try: the estimate there.
    pub(super) first_trial: f64,
    lipschitz: f64,
    far: f64,
}

impl Distance {
    /// A formula seen from an eye.
    pub fn new(formula: Formula, iterations: u32, eye: DVec3, stepping: Stepping) -> Self {
        let bounds = formula.bounds();
        let evaluator = formula.evaluator();
        Self {
            iterations,
            eye,
            stepping,
            bounds,
            first_trial: evaluator.value(eye, iterations).0.max(0.0),
            lipschitz: formula.lipschitz(),
            far: bounds.farthest(eye),
            evaluator,
            formula,
        }
    }

    /// The same for rays that start at most so far from the eye.
    #[must_use]
    pub fn spaced(mut self, spacing: f64) -> Self {
        self.far += spacing;
        self
    }

    /// The hit threshold of a beam at a distance.
    pub(super) fn threshold(&self, beam: &Beam, t: f64) -> f64 {
        self.stepping.detail * footprint(beam, t)
    }

    /// Adds the cost of an evaluation, and widens it by the distance to the bounds. Inside the
    /// bounds the value may be negative: the gradient needs it.
    pub(super) fn read(
        &self,
        q: DVec3,
        reading: Reading,
        clear: f64,
        work: &mut Counts,
    ) -> (f64, f64) {
        work.evaluations += 1;
        work.iterations += reading.iterations;
        let outside = self.bounds.distance(self.eye + q);
        let value = match outside > 0.0 {
            true => reading.value.max(outside),
            false => reading.value,
        };
        (value, reading.radius.max(outside - clear))
    }

    /// The value of the field.
    fn value(&self, q: DVec3, work: &mut Counts) -> f64 {
        let (value, iterations) = self.evaluator.value(self.eye + q, self.iterations);
        let reading = Reading {
            value,
            radius: 0.0,
            iterations,
        };
        self.read(q, reading, 0.0, work).0
    }

    /// The size of the tetrahedron that a normal is taken from: half a pixel.
    pub(super) fn tap(&self, ray: &Beam, hit: &Hit) -> f64 {
        0.5 * footprint(ray, hit.t) + self.far * 1e-7
    }

    /// The surface with the values at the corners of a tetrahedron about it.
    pub(super) fn surface_of(ray: &Beam, values: [f64; 4], pigment: DVec3) -> Surface {
        let g: DVec3 = CORNERS.iter().zip(values).map(|(&c, v)| c * v).sum();
        Surface {
            // A point without a gradient faces the viewer.
            normal: match g.length() > DISTANCE_FLAT {
                true => g.normalize(),
                false => -ray.axis,
            },
            pigment,
        }
    }

    /// The value of the field, and the radius of a ball in which it should exceed `clear`. Where
    /// rays go by proven balls, the ball is empty, but at most `trial` is tried.
    fn field(&self, q: DVec3, clear: f64, trial: f64, work: &mut Counts) -> (f64, f64) {
        let (p, most) = (self.eye + q, self.iterations);
        let reading = match self.stepping.proven {
            true => self.evaluator.ball(p, most, trial),
            false => self.evaluator.step(p, most, clear),
        };
        self.read(q, self.cleared(reading, clear), clear, work)
    }

    /// What was read for the step of a ray: a proven ball does not keep clear by itself.
    pub(super) fn cleared(&self, reading: Reading, clear: f64) -> Reading {
        let kept = if self.stepping.proven { clear } else { 0.0 };
        Reading {
            radius: reading.radius - kept,
            ..reading
        }
    }

    /// The part of a ray, as (near, far), that is nearer to the bounds than
    /// `DISTANCE_WITHIN` hit thresholds; near > far for none. The threshold grows along the
    /// ray, so the faces of the box lean outwards.
    pub fn bounds_interval(&self, ray: &Beam) -> (f64, f64) {
        let p = self.eye - self.bounds.centre + ray.origin;
        let within = DISTANCE_WITHIN * self.stepping.detail;
        let room = self.bounds.half + DVec3::splat(within * ray.grain0);
        let lean = within * ray.grain;
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for i in 0..3 {
            let a = ray.axis[i];
            // A ray no steeper than the lean may never cross a face.
            if a.abs() <= lean + 1e-9 {
                continue;
            }
            let low = (-room[i] - p[i]) / (a + lean);
            let high = (room[i] - p[i]) / (a - lean);
            near = near.max(low.min(high));
            far = far.min(low.max(high));
        }
        let margin = self.threshold(ray, self.far);
        let b = p.dot(ray.axis);
        let off = p - b * ray.axis;
        let q = (self.bounds.radius + margin).powi(2) - off.length_squared();
        if q < 0.0 {
            return (1.0, -1.0);
        }
        (near.max(-b - q.sqrt()), far.min(-b + q.sqrt()))
    }
}

impl Twin for Distance {
    fn trap_modules(&self) -> Vec<Module> {
        vec![wgsl!("formula/traps.wgsl"), self.formula.traps_module()]
    }

    fn marks_hits(&self) -> bool {
        false
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = vec![
            wgsl!("base/real.wgsl"),
            self.stepping.rule.module(),
            wgsl!(
                "scene/distance.wgsl",
                "DISTANCE_ENOUGH" = DISTANCE_ENOUGH,
                "DISTANCE_TRIAL" = DISTANCE_TRIAL,
                "DISTANCE_LEAST" = DISTANCE_LEAST,
                "DISTANCE_PROVEN" = f64::from(u8::from(self.stepping.proven)),
                "DISTANCE_SMOOTHING" = DISTANCE_SMOOTHING,
                "DISTANCE_MOST_RELAXED" = DISTANCE_MOST_RELAXED,
                "DISTANCE_WITHIN" = DISTANCE_WITHIN,
                "HIT_CARRIES_MARK" = 0.0
            ),
        ];
        all.extend(self.formula.modules());
        [all, vec![self.formula.four_module()]].concat()
    }

    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)> {
        let scene = DistanceUniform {
            eye: self.eye.as_vec3(),
            detail: self.stepping.detail as f32,
            centre: self.bounds.centre.as_vec3(),
            radius: self.bounds.radius as f32,
            half: self.bounds.half.as_vec3(),
            // Rounded up: the farthest corner must not lie beyond it.
            far: (self.far * (1.0 + 1e-6)) as f32,
            shell: self.stepping.shell as f32,
            relaxation: self.stepping.relaxation.code() as f32,
            stride: self.stepping.stride as f32,
            iterations: self.iterations,
            clip: u32::from(self.stepping.clip),
            first_trial: self.first_trial as f32,
            ..Zeroable::zeroed()
        };
        let mut all = vec![("distance_parameters", bytes_of(&scene).to_vec())];
        all.extend(self.formula.uniforms(self.iterations));
        all
    }

    fn describe(&self) -> String {
        let (name, n) = (self.formula.name(), self.iterations);
        format!("{name}: {n} iterations, lipschitz {}", self.lipschitz)
    }

    fn rounds(&self) -> u32 {
        self.iterations
    }
}

impl Solid for Distance {
    type Walk = Walk;

    fn advance(&self, cone: &Beam, at: Advance, work: &mut Counts) -> Advance {
        let near = self.near(cone, at);
        let ball = near.trial.map(|trial| {
            let (p, most) = (self.eye + near.q, self.iterations);
            match self.stepping.proven {
                true => self.evaluator.ball(p, most, trial),
                false => self.evaluator.cone(p, most, trial),
            }
        });
        self.advance_by(cone, at, &near, ball, work)
    }

    fn advance_lanes(
        &self,
        cones: &[Beam; LANES],
        at: &mut [Advance; LANES],
        on: [bool; LANES],
        work: &mut [Counts; LANES],
    ) {
        self.advance_all(cones, at, on, work);
    }

    fn begin(&self, ray: &Beam, front: f64, t_max: f64, _work: &mut Counts) -> Walk {
        let (near, far) = self.bounds_interval(ray);
        let clip = self.stepping.clip;
        Walk {
            t: if clip { front.max(near) } else { front },
            radius: 0.0,
            pace: 0.0,
            slope: -1.0,
            room: 0.0,
            end: if near > far { -1.0 } else { far.min(t_max) },
        }
    }

    fn walk_step(&self, ray: &Beam, walk: &mut Walk, work: &mut Counts) -> Step {
        let Some(ahead) = self.ahead(ray, walk) else {
            return Step::Out;
        };
        let field = self.field(ahead.q, ahead.clear, ahead.trial, work);
        self.go_on(ray, walk, &ahead, field)
    }

    fn has_lanes(&self) -> bool {
        self.evaluator.has_lanes()
    }

    fn step_lanes(
        &self,
        rays: &[Beam; LANES],
        walks: &mut [Walk; LANES],
        on: [bool; LANES],
        work: &mut [Counts; LANES],
    ) -> [Step; LANES] {
        self.step_all(rays, walks, on, work)
    }

    fn walk_hit(&self, walk: &Walk) -> Hit {
        Hit {
            t: walk.t,
            ..Hit::default()
        }
    }

    fn clearance(&self, q: DVec3) -> f64 {
        let step = self.evaluator.step(self.eye + q, self.iterations, 0.0);
        self.read(q, step, 0.0, &mut Counts::default()).1.max(0.0)
    }

    fn room(&self, q: DVec3, _enough: f64, work: &mut Counts) -> f64 {
        self.value(q, work).max(0.0)
    }

    fn rooms_lanes(
        &self,
        at: &Places,
        axes: &[DVec3; LANES],
        nearest: &[f64; LANES],
    ) -> [[f64; ROOMS]; LANES] {
        self.rooms_all(at, axes, nearest)
    }

    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface {
        let (q, h) = (ray.at(hit.t), self.tap(ray, hit));
        let values = CORNERS.map(|c| self.value(q + h * c, &mut Counts::default()));
        let pigment = self.evaluator.trap(self.eye + q, self.iterations);
        Self::surface_of(ray, values, pigment)
    }

    fn surfaces(&self, hits: &[(Beam, Hit)]) -> Vec<Surface> {
        self.surfaces_all(hits)
    }

    fn traps(&self, q: DVec3) -> Option<[f64; 7]> {
        Some(self.evaluator.traps(self.eye + q, self.iterations))
    }

    fn bounds_far(&self) -> f64 {
        self.far
    }
}
