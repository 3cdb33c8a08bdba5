//! A scene given by a distance estimate.
//!
//! Cones advance by the exact step, rays by sphere tracing with relaxation (docs/method.md, 2).
//! The bounds are part of the field: its value is the larger of the estimate and the
//! distance to the bounds, for steps, hits and normals alike. So the surface that is
//! seen is closed and within the hit threshold of the bounds, instead of being cut by
//! them. A step keeps clear of a share of the hit threshold, the *shell*, so that a long one
//! does not jump over the thin skin in which small steps would find a hit.
//! Twin: `wgsl/scene/distance.wgsl`.

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{DVec3, Vec3};

use crate::base::cone::ConeRule;
use crate::base::key::{AutoCount, Fault, Key};
use crate::base::shader::Module;
use crate::base::view::{Beam, footprint};
use crate::base::work::Work;
use crate::formula::{Bounds, Formula};
use crate::heightfield::tracer::settings::PrepareError;
use crate::keys;
use crate::scene::contract::{Advance, Hit, Solid, Step, Surface, Twin};
use crate::scene::{AnySolid, Assets, Scene, SceneSettings, Viewpoint};
use crate::wgsl;

/// A cone that gains less than this share of its ball leaves the rest to its four
/// children. A large share also keeps cones from creeping along surfaces that they
/// graze, where short steps would find hits and long ones pass through the thin skin:
/// at 0.3 such cones start pixels behind, at 0.8 none did on the five bench presets.
const DISTANCE_ENOUGH: f64 = 0.8;
/// Weight of the newest slope in the automatic relaxation.
const DISTANCE_SMOOTHING: f64 = 0.3;
/// Where a clipped ray starts, in hit thresholds from the bounds. At 1 the first sample
/// would lie on the threshold, and rounding would decide whether it is a hit; much under
/// 1 a grazing ray would start far behind the place where it came under the threshold
/// (at 0.9 on `bench-graze` 2.8 % of pixels did, at 0.99 0.2 %).
const DISTANCE_WITHIN: f64 = 0.99;
/// Gradients, as sums of four differences, below this are none, here as in the shader.
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
    /// The estimate's largest slope.
    pub lipschitz: f32,
    /// Share of the threshold that steps keep clear of.
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
}

/// How rays may stretch their steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Relaxation {
    /// Steps are the radius of the empty ball.
    Off,
    /// Steps follow the measured slope of the radius.
    #[default]
    Auto,
    /// Steps are this many radii, 1 to 2.
    Factor(f64),
}

impl Relaxation {
    fn code(self) -> f64 {
        match self {
            Self::Off => 1.0,
            Self::Auto => 0.0,
            Self::Factor(f) => f,
        }
    }
}

/// A formula as it is marched: everything resolved to numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Distance {
    /// The formula.
    pub formula: Formula,
    /// Iteration limit.
    pub iterations: u32,
    /// Camera position.
    pub eye: DVec3,
    /// Hit where `estimate <= detail * footprint`.
    pub detail: f64,
    /// Steps keep clear of `shell * detail * footprint`, 0 <= shell < 1.
    pub shell: f64,
    /// How rays stretch their steps.
    pub relaxation: Relaxation,
    /// Factor on ray steps: 1, or less for the truth.
    pub stride: f64,
    /// Which rule carries cones.
    pub rule: ConeRule,
    /// Whether rays start where they enter the bounds.
    pub clip: bool,
    bounds: Bounds,
    lipschitz: f64,
    far: f64,
}

/// The settings of a distance scene: a formula and its iteration limit.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceSettings {
    /// The formula and its parameters.
    pub formula: Formula,
    /// Iteration limit; `None` follows the finest footprint.
    pub iterations: Option<u32>,
}

/// Most iterations that a formula may run. `auto` stops following the footprint there.
pub const MOST_ITERATIONS: u32 = 1000;
/// Most steps of a shadow ray: each has the iterations of a formula in it, and Mesa's software
/// Vulkan ends loops after 65 535 rounds.
const DISTANCE_MOST_SHADOW_STEPS: u32 = 512;

impl DistanceSettings {
    /// Every formula with its defaults.
    pub fn all() -> Vec<Self> {
        Formula::all().into_iter().map(Self::from).collect()
    }

    /// The iteration limit: the given one, or the one that the finest footprint needs.
    fn limit(&self, from: &Viewpoint) -> u32 {
        // A quarter of the hit threshold: the skin of an unconverged estimate must not
        // move the surface by what a comparison could see.
        let eps = 0.25 * from.stepping.detail * self.finest_footprint(from);
        let auto = || self.formula.iterations(eps).min(MOST_ITERATIONS);
        self.iterations.unwrap_or_else(auto)
    }

    /// The smallest footprint that any hit can have: that of the nearest point that
    /// could be hit, seen through the corner of the image.
    fn finest_footprint(&self, from: &Viewpoint) -> f64 {
        let bounds = self.formula.bounds();
        let (raw, _) = self.formula.estimate(from.eye, MOST_ITERATIONS);
        let clear = bounds
            .distance(from.eye)
            .max(raw / self.formula.lipschitz());
        // A camera on the surface would ask for infinitely fine work.
        let least = 1e-7 * bounds.farthest(from.eye);
        from.grain * clear.max(least)
    }
}

impl From<Formula> for DistanceSettings {
    fn from(formula: Formula) -> Self {
        Self {
            formula,
            iterations: None,
        }
    }
}

impl From<Formula> for Scene {
    fn from(formula: Formula) -> Self {
        DistanceSettings::from(formula).into()
    }
}

impl SceneSettings for DistanceSettings {
    fn kind(&self) -> &'static str {
        "distance"
    }

    fn formula(&self) -> Option<&'static str> {
        Some(self.formula.name())
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        let mut keys = self.formula.keys();
        keys.extend(keys![
            "iterations" = AutoCount(&mut self.iterations, 1, MOST_ITERATIONS),
                "iteration limit; auto follows the finest footprint, up to 1000";
        ]);
        keys
    }

    fn check(&self) -> Result<(), Fault> {
        self.formula.check()
    }

    fn solid(&self, from: &Viewpoint, _: &Assets) -> Result<AnySolid, PrepareError> {
        let formula = self.formula.clone();
        let solid = Distance::new(formula, self.limit(from), from.eye, from.stepping);
        Ok(AnySolid::Distance(solid))
    }

    fn lipschitz(&self) -> f64 {
        self.formula.lipschitz()
    }

    fn most_shadow_steps(&self) -> u32 {
        DISTANCE_MOST_SHADOW_STEPS
    }

    /// The estimate's noise in f32 is about 2e-8 of the size of the coordinates
    /// (docs/method.md, 6), and those of an orbit are of the size of the bounds
    /// wherever it starts; a footprint under a hundred times that is damaged.
    fn precision_warning(&self, from: &Viewpoint) -> Option<String> {
        let finest = self.finest_footprint(from);
        let floor = 2e-6 * self.formula.bounds().half.max_element();
        (finest < 0.99 * floor).then(|| {
            format!(
                "the finest footprint, {finest:.1e}, is under the f32 floor of about {floor:.0e}: details that near are noise. Move the camera away, or render with --device cpu"
            )
        })
    }
}

/// Numbers that a [`Distance`] is made from, beside its formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// See [`Distance::detail`].
    pub detail: f64,
    /// See [`Distance::shell`].
    pub shell: f64,
    /// See [`Distance::relaxation`].
    pub relaxation: Relaxation,
    /// See [`Distance::stride`].
    pub stride: f64,
    /// See [`Distance::rule`].
    pub rule: ConeRule,
    /// See [`Distance::clip`].
    pub clip: bool,
}

impl Distance {
    /// A formula seen from an eye.
    pub fn new(formula: Formula, iterations: u32, eye: DVec3, stepping: Stepping) -> Self {
        let bounds = formula.bounds();
        Self {
            iterations,
            eye,
            detail: stepping.detail,
            shell: stepping.shell,
            relaxation: stepping.relaxation,
            stride: stepping.stride,
            rule: stepping.rule,
            clip: stepping.clip,
            bounds,
            lipschitz: formula.lipschitz(),
            far: bounds.farthest(eye),
            formula,
        }
    }

    fn estimate_at(&self, q: DVec3, work: &mut Work) -> f64 {
        let (d, n) = self.formula.estimate(self.eye + q, self.iterations);
        work.evaluations += 1;
        work.iterations += n;
        d
    }

    /// Value of the field, and a ball's radius in which it exceeds `clear`. Inside the
    /// bounds the value is the estimate's alone, negative ones too: the gradient needs
    /// them.
    fn field(&self, q: DVec3, clear: f64, work: &mut Work) -> (f64, f64) {
        let outside = self.bounds.distance(self.eye + q);
        let inside = self.estimate_at(q, work);
        let ball = ((inside - clear) / self.lipschitz).max(outside - clear);
        let value = if outside > 0.0 {
            inside.max(outside)
        } else {
            inside
        };
        (value, ball)
    }

    /// The part of a ray where the bounds are within nearly the hit threshold, as
    /// (near, far); near > far if it misses. The threshold grows along the ray, so the
    /// faces lean outwards by its slope.
    pub fn bounds_interval(&self, ray: &Beam) -> (f64, f64) {
        let p = self.eye - self.bounds.centre + ray.origin;
        let within = DISTANCE_WITHIN * self.detail;
        let room = self.bounds.half + DVec3::splat(within * ray.grain0);
        let lean = within * ray.grain;
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        for i in 0..3 {
            let a = ray.axis[i];
            // A ray as flat as the lean may stay between two faces for ever.
            if a.abs() <= lean + 1e-9 {
                continue;
            }
            let low = (-room[i] - p[i]) / (a + lean);
            let high = (room[i] - p[i]) / (a - lean);
            near = near.max(low.min(high));
            far = far.min(low.max(high));
        }
        let margin = self.detail * footprint(ray, self.far);
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
    fn marks_hits(&self) -> bool {
        false
    }

    fn modules(&self) -> Vec<Module> {
        let mut all = vec![
            wgsl!("base/real.wgsl"),
            self.rule.module(),
            wgsl!(
                "scene/distance.wgsl",
                "DISTANCE_ENOUGH" = DISTANCE_ENOUGH,
                "DISTANCE_SMOOTHING" = DISTANCE_SMOOTHING,
                "DISTANCE_MOST_RELAXED" = DISTANCE_MOST_RELAXED,
                "DISTANCE_WITHIN" = DISTANCE_WITHIN,
                "HIT_CARRIES_MARK" = 0.0
            ),
        ];
        all.extend(self.formula.modules());
        all
    }

    #[allow(clippy::cast_possible_truncation, reason = "f32 is what the GPU takes")]
    fn uniforms(&self) -> Vec<(&'static str, Vec<u8>)> {
        let scene = DistanceUniform {
            eye: self.eye.as_vec3(),
            detail: self.detail as f32,
            centre: self.bounds.centre.as_vec3(),
            radius: self.bounds.radius as f32,
            half: self.bounds.half.as_vec3(),
            // Rounded up: the corner itself must not count as past everything.
            far: (self.far * (1.0 + 1e-6)) as f32,
            lipschitz: self.lipschitz as f32,
            shell: self.shell as f32,
            relaxation: self.relaxation.code() as f32,
            stride: self.stride as f32,
            iterations: self.iterations,
            clip: u32::from(self.clip),
            pad0: 0,
            pad1: 0,
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
    t: f64,
    radius: f64,
    pace: f64,
    slope: f64,
    end: f64,
}

impl Solid for Distance {
    type Walk = Walk;

    fn advance(&self, cone: &Beam, front: f64, work: &mut Work) -> Advance {
        let q = cone.at(front);
        let eps = self.detail * footprint(cone, front);
        let mut d = self.bounds.distance(self.eye + q) - cone.r0 - self.shell * eps;
        // Outside the bounds their distance will do, while it carries the cone.
        if d <= 2.0 * cone.k * front {
            let e = (self.estimate_at(q, work) - self.shell * eps) / self.lipschitz;
            d = d.max(e - cone.r0);
        }
        let next = self.rule.cone_front(front, front, d, cone.k);
        Advance {
            front: next,
            // After a short gain the rest is better left to the four thinner children;
            // where there is no ball, so is all of it.
            going: next - front > DISTANCE_ENOUGH * d.max(0.0),
        }
    }

    fn begin(&self, ray: &Beam, front: f64, t_max: f64, _work: &mut Work) -> Walk {
        let (near, far) = self.bounds_interval(ray);
        let t = if self.clip { front.max(near) } else { front };
        Walk {
            t,
            radius: 0.0,
            pace: 0.0,
            slope: -1.0,
            end: if near > far { -1.0 } else { far.min(t_max) },
        }
    }

    fn walk_step(&self, ray: &Beam, walk: &mut Walk, work: &mut Work) -> Step {
        let w = *walk;
        if w.t + w.radius > w.end {
            return Step::Out;
        }
        let t = (w.t + w.pace).min(w.end);
        let gone = t - w.t;
        let eps = self.detail * footprint(ray, t);
        let (value, ball) = self.field(ray.at(t), self.shell * eps, work);
        let radius = ball * self.stride;
        // Only a stretched step can leave a gap: what else exceeds the radius is rounding.
        if w.pace > w.radius && gone > w.radius + radius.max(0.0) {
            walk.pace = w.radius;
            walk.slope = -1.0;
            return Step::Moving;
        }
        walk.t = t;
        if value <= eps {
            return Step::Hit;
        }
        let factor = match self.relaxation {
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
        walk.radius
    }

    fn clearance(&self, q: DVec3) -> f64 {
        self.field(q, 0.0, &mut Work::default()).1.max(0.0)
    }

    fn surface(&self, ray: &Beam, hit: &Hit) -> Surface {
        let q = ray.at(hit.t);
        let h = 0.5 * footprint(ray, hit.t) + self.far * 1e-7;
        let corners = [
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(-1.0, -1.0, 1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::new(1.0, 1.0, 1.0),
        ];
        let work = &mut Work::default();
        let g: DVec3 = corners
            .iter()
            .map(|&c| c * self.field(q + h * c, 0.0, work).0)
            .sum();
        Surface {
            // A flat estimate has no gradient: turn such a point to the viewer. Deep in the
            // set its squares would come under the range of f64, too.
            normal: if g.length() > DISTANCE_FLAT {
                g.normalize()
            } else {
                -ray.axis
            },
            pigment: self.formula.trap(self.eye + q, self.iterations),
        }
    }

    fn bounds_far(&self) -> f64 {
        self.far
    }
}
