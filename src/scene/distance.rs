//! A scene given by a distance estimate.
//!
//! Cones advance by the cone step, rays by sphere tracing with relaxation (docs/method.md, 2).
//! Steps, hits and normals all use one field: the larger of the estimate and the distance to
//! the bounds. So the bounds do not cut the visible surface open.
//! A step keeps clear of a share of the hit threshold, the *shell*, or a long step could jump over
//! a thin part of the surface. Twin: `wgsl/scene/distance.wgsl`.

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{DVec3, Vec3};

use crate::base::outcome::Counts;
use crate::base::shader::Module;
use crate::base::view::{Beam, footprint};
use crate::formula::{Bounds, Evaluator, Formula, Reading};
use crate::scene::contract::{Advance, Hit, Solid, Step, Surface, Twin};
use crate::scene::stepping::{Relaxation, Stepping};
use crate::wgsl;

/// A cone that gains less than this share of its ball stops and leaves the rest to its four
/// children. With a small share, cones creep along surfaces that they graze and pass places
/// that rays would hit. At 0.3 some pixels start behind the surface, at 0.8 none does on the
/// five bench presets.
const DISTANCE_ENOUGH: f64 = 0.8;
/// The ball that is tried, in radii of the last one. From 1.25 to 1.7 this makes no difference.
const DISTANCE_TRIAL: f64 = 1.5;
/// The least step of a ray, in hit thresholds.
const DISTANCE_LEAST: f64 = 0.1;
/// Weight of the newest slope in the automatic relaxation.
const DISTANCE_SMOOTHING: f64 = 0.3;
/// Where a clipped ray starts, in hit thresholds from the bounds. At 1, rounding decides whether the
/// first sample is a hit. At less, a grazing ray starts behind the threshold: 2.8 % of the pixels of
/// `bench-graze` do at 0.9, and 0.2 % at 0.99.
const DISTANCE_WITHIN: f64 = 0.99;
/// A gradient, as a sum of four differences, that is shorter than this has no direction.
const DISTANCE_FLAT: f64 = 1e-20;
/// The longest automatic step, in radii of the last ball.
const DISTANCE_MOST_RELAXED: f64 = 3.0;

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
    /// Unused.
    pub pad0: u32,
    /// Unused.
    pub pad1: u32,
    /// Unused.
    pub pad2: u32,
}

/// A formula seen from an eye, with all settings resolved to numbers.
#[derive(Clone, Debug)]
pub struct Distance {
    /// The formula.
    pub formula: Formula,
    evaluator: Evaluator,
    /// Its iteration limit.
    pub iterations: u32,
    /// Camera position.
    pub eye: DVec3,
    /// How steps are taken.
    pub stepping: Stepping,
    bounds: Bounds,
    lipschitz: f64,
    far: f64,
}

impl Distance {
    /// A formula seen from an eye.
    pub fn new(formula: Formula, iterations: u32, eye: DVec3, stepping: Stepping) -> Self {
        let bounds = formula.bounds();
        Self {
            iterations,
            eye,
            stepping,
            bounds,
            lipschitz: formula.lipschitz(),
            far: bounds.farthest(eye),
            evaluator: formula.evaluator(),
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
    fn threshold(&self, beam: &Beam, t: f64) -> f64 {
        self.stepping.detail * footprint(beam, t)
    }

    /// Adds the cost of an evaluation, and widens it by the distance to the bounds. Inside the
    /// bounds the value may be negative: the gradient needs it.
    fn read(&self, q: DVec3, reading: Reading, clear: f64, work: &mut Counts) -> (f64, f64) {
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
    fn value(&self, q: DVec3) -> f64 {
        let (value, iterations) = self.evaluator.value(self.eye + q, self.iterations);
        let reading = Reading {
            value,
            radius: 0.0,
            iterations,
        };
        self.read(q, reading, 0.0, &mut Counts::default()).0
    }

    /// The value of the field, and the radius of a ball in which it should exceed `clear`. Where
    /// rays go by proven balls, the ball is empty, but at most `trial` is tried.
    fn field(&self, q: DVec3, clear: f64, trial: f64, work: &mut Counts) -> (f64, f64) {
        let (p, most) = (self.eye + q, self.iterations);
        let reading = match self.stepping.proven {
            true => {
                let ball = self.evaluator.ball(p, most, trial);
                Reading {
                    radius: ball.radius - clear,
                    ..ball
                }
            }
            false => self.evaluator.step(p, most, clear),
        };
        self.read(q, reading, clear, work)
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

/// The state of a ray between two steps.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// The last accepted point.
    t: f64,
    /// Radius of the empty ball there.
    radius: f64,
    /// Length of the next step.
    pace: f64,
    /// The smoothed slope of the radius.
    slope: f64,
    /// The value of the field there: a smooth guess of the free room.
    room: f64,
    /// Where the ray ends.
    end: f64,
}

impl Solid for Distance {
    type Walk = Walk;

    fn advance(&self, cone: &Beam, at: Advance, work: &mut Counts) -> Advance {
        let t = at.front;
        let q = cone.at(t);
        let eps = self.threshold(cone, t);
        let shell = self.stepping.shell * eps;
        let mut d = self.bounds.distance(self.eye + q) - cone.r0 - shell;
        // How wide the cone is.
        let parallel = cone.grain == 0.0;
        let wide = if parallel { cone.r0 } else { cone.k * t };
        // Far from the bounds their distance is enough.
        if d <= 2.0 * wide {
            let (p, most) = (self.eye + q, self.iterations);
            let trial = if at.radius > 0.0 {
                DISTANCE_TRIAL * at.radius
            } else if t > 0.0 {
                4.0 * wide
            } else {
                self.evaluator.value(p, most).0.max(0.0)
            };
            let trial = trial + 2.0 * eps + cone.r0;
            let ball = match self.stepping.proven {
                true => self.evaluator.ball(p, most, trial),
                false => self.evaluator.cone(p, most, trial),
            };
            work.evaluations += 1;
            work.iterations += ball.iterations;
            d = d.max(ball.radius - shell - cone.r0);
        }
        let front = self.stepping.rule.cone_front(t, t, d, cone.k);
        let (front, ball) = match parallel {
            true => {
                let (ball, rule) = (d + cone.r0, self.stepping.rule);
                (rule.cone_parallel(t, ball, cone.r0, cone.k), ball)
            }
            false => (front, d),
        };
        Advance {
            front,
            radius: d.max(0.0),
            // After a short gain, or without a ball, the four thinner children go on.
            going: front - t > DISTANCE_ENOUGH * ball.max(0.0),
        }
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
        let w = *walk;
        if w.t + w.radius > w.end {
            return Step::Out;
        }
        let t = (w.t + w.pace).min(w.end);
        let gone = t - w.t;
        let eps = self.threshold(ray, t);
        let clear = self.stepping.shell * eps;
        let trial = DISTANCE_TRIAL * w.radius + 2.0 * eps;
        let (value, ball) = self.field(ray.at(t), clear, trial, work);
        // Near a fold the ball may be tiny, and rays would creep.
        let least = match self.stepping.proven {
            true => (ball + clear).min(DISTANCE_LEAST * eps),
            false => DISTANCE_LEAST * eps,
        };
        let radius = ball.max(least) * self.stepping.stride;
        // Only a stretched step can leave a gap. Any other difference is rounding.
        if w.pace > w.radius && gone > w.radius + radius.max(0.0) {
            walk.pace = w.radius;
            walk.slope = -1.0;
            return Step::Moving;
        }
        walk.t = t;
        if value <= eps {
            return Step::Hit;
        }
        let factor = match self.stepping.relaxation {
            Relaxation::Off => 1.0,
            Relaxation::Factor(f) => f,
            Relaxation::Auto => {
                if gone > 0.0 && w.radius > 0.0 {
                    let slope = (radius - w.radius) / gone;
                    walk.slope += DISTANCE_SMOOTHING * (slope - walk.slope);
                }
                (2.0 / (1.0 - walk.slope).max(1e-3)).clamp(1.0, DISTANCE_MOST_RELAXED)
            }
        };
        walk.radius = radius;
        walk.room = value;
        walk.pace = radius * factor;
        Step::Moving
    }

    fn walk_hit(&self, walk: &Walk) -> Hit {
        Hit {
            t: walk.t,
            ..Hit::default()
        }
    }

    fn walk_radius(&self, _ray: &Beam, walk: &Walk) -> f64 {
        walk.room
    }

    fn clearance(&self, q: DVec3) -> f64 {
        let step = self.evaluator.step(self.eye + q, self.iterations, 0.0);
        self.read(q, step, 0.0, &mut Counts::default()).1.max(0.0)
    }

    fn room(&self, q: DVec3, _enough: f64) -> f64 {
        self.value(q).max(0.0)
    }

    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface {
        let q = ray.at(hit.t);
        // The corners of a tetrahedron half a pixel wide.
        let h = 0.5 * footprint(ray, hit.t) + self.far * 1e-7;
        let corners = [
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(-1.0, -1.0, 1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::new(1.0, 1.0, 1.0),
        ];
        let g: DVec3 = corners.iter().map(|&c| c * self.value(q + h * c)).sum();
        Surface {
            // A point without a gradient faces the viewer.
            normal: match g.length() > DISTANCE_FLAT {
                true => g.normalize(),
                false => -ray.axis,
            },
            pigment: self.formula.trap(self.eye + q, self.iterations),
        }
    }

    fn traps(&self, q: DVec3) -> Option<[f64; 7]> {
        Some(self.formula.traps(self.eye + q, self.iterations))
    }

    fn bounds_far(&self) -> f64 {
        self.far
    }
}
