//! Glow: light that the air sends out near the surface, summed up along the ray of a pixel.
//! Twins: `wgsl/pass/glow.wgsl`, `glow_off.wgsl`.
//!
//! The air at the distance d from the surface sends out `exp(-d / width)` per width. A ray gathers the
//! integral of this over its way. Fog of the depth f lets `exp(-f)` of it through. The integral does not
//! depend on steps or cones, so it is the same however the ray was marched.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::base::outcome::Counts;
use crate::base::srgb::linear;
use crate::base::view::Beam;
use crate::pass::LookFeature;
use crate::pass::fog_height::fog_depth;
use crate::pass::look::Light;
use crate::plan::Plan;
use crate::scene::Solid;

/// Parts of a ray at most, where its inner loops allow so many.
const GLOW_PARTS: u32 = 256;
/// Length of a part next to the surface, in widths.
const GLOW_FINE: f64 = 0.25;
/// Parts of a ray at least, where there is glow: the fog is not linear along a long one.
const GLOW_LEAST: f64 = 32.0;
/// So many widths from the surface there is no glow: `exp(-10)`.
const GLOW_NONE: f64 = 10.0;

/// The glow as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GlowUniform {
    /// Radiance of a whole way to a flat wall.
    pub light: Vec3,
    /// Widths per unit of length.
    pub rate: f32,
    /// Parts of a ray at most.
    pub parts: u32,
    /// Unused.
    pub pad: [u32; 3],
}

/// The glow in the numbers that passes use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glow {
    /// Radiance of a whole way to a flat wall.
    pub light: DVec3,
    /// Widths per unit of length.
    pub rate: f64,
    /// Parts of a ray at most.
    pub parts: u32,
}

impl Glow {
    /// The glow of a plan. A ray may have so many parts for the sake of the device.
    pub fn of(plan: &Plan, most: u32) -> Self {
        let distance = plan.camera.eye.distance(plan.camera.target);
        Self {
            light: plan.look.glow * linear(plan.look.glow_color),
            rate: 1.0 / (plan.look.glow_width * distance),
            parts: GLOW_PARTS.min(most).max(1),
        }
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self) -> GlowUniform {
        GlowUniform {
            light: self.light.as_vec3(),
            rate: self.rate as f32,
            parts: self.parts,
            pad: [0; 3],
        }
    }
}

/// The mean of `exp(-x)` from 0 to x.
fn glow_mean(x: f64) -> f64 {
    // The quotient would cancel.
    if x < 0.01 {
        return 1.0 - x * (0.5 - x / 6.0);
    }
    (1.0 - (-x).exp()) / x
}

/// Radiance of the glow on the first `end` units of a ray.
///
/// Within a part, distance and fog are taken to be linear, and so the integral is one of an
/// exponential. A part ends before the glow of what is ahead can begin; in the glow its length is
/// that within which the curve of the distance, at most 1/d, does not show.
pub fn glow<S: Solid>(solid: &S, light: &Light, ray: &Beam, end: f64) -> DVec3 {
    if !light.has(LookFeature::Glow) {
        return DVec3::ZERO;
    }
    let Glow { rate, parts, .. } = light.glow;
    let away = |t: f64| solid.room(ray.at(t), f64::MAX, &mut Counts::default()) * rate;
    let (least, most) = (end / f64::from(parts), end / GLOW_LEAST);
    let (mut t, mut far, mut sum) = (0.0, away(0.0), 0.0);
    let mut dim = far;
    for _ in 0..parts {
        let fine = (GLOW_FINE * (1.0 + far).sqrt() / rate).min(most);
        let part = fine.max((far - GLOW_NONE) / rate);
        let next = (t + part.max(least)).min(end);
        far = away(next);
        let then = far + fog_depth(light, ray, next);
        sum += (next - t) * (-dim.min(then)).exp() * glow_mean((then - dim).abs());
        (t, dim) = (next, then);
        if t >= end {
            break;
        }
    }
    light.glow.light * (sum * rate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::outcome::State;
    use crate::formula::Formula;
    use crate::pass::trace::trace;
    use crate::scene::{Assets, Task};

    /// The glow of the rays of a plan, and the same by the midpoints of many short parts.
    struct Both<'a>(&'a Plan, &'a Light);

    impl Task for Both<'_> {
        type Output = Vec<[f64; 2]>;

        fn run<S: Solid>(self, solid: &S) -> Self::Output {
            const PARTS: u32 = 8000;
            let Self(plan, light) = self;
            let [w, h] = plan.size;
            let one = |pixel: u32| {
                let ray = plan.view().view_ray([pixel % w, pixel / w]);
                let (hit, state) = trace(solid, &ray, 0.0, 4096, &mut Counts::default());
                let end = match state {
                    State::Sky => solid.bounds_far(),
                    _ => hit.t,
                };
                let part = |i: u32| {
                    let t = end * (f64::from(i) + 0.5) / f64::from(PARTS);
                    let dim =
                        solid.room(ray.at(t), f64::MAX, &mut Counts::default()) * light.glow.rate;
                    (-dim - fog_depth(light, &ray, t)).exp()
                };
                let sum: f64 = (0..PARTS).map(part).sum();
                let fine = sum * end / f64::from(PARTS) * light.glow.rate;
                [glow(solid, light, &ray, end).x, fine * light.glow.light.x]
            };
            (0..w * h).map(one).collect()
        }
    }

    fn light(plan: &Plan) -> (crate::scene::AnySolid, Light) {
        let solid = plan.scene.solid(&plan.viewpoint(), &Assets::default());
        let solid = solid.expect("it names no file");
        let light = Light::of(plan, &solid);
        (solid, light)
    }

    fn plan(mut plan: Plan) -> Plan {
        plan.size = [16, 9];
        (plan.look.glow, plan.look.glow_color) = (1.0, DVec3::ONE);
        plan
    }

    #[test]
    fn glow_is_the_integral_along_the_ray() {
        let mut worst: f64 = 0.0;
        for formula in Formula::all() {
            let name = formula.name();
            let mut plan = plan(Plan::new(formula));
            plan.reference = None;
            for (eye, fov) in [
                (DVec3::new(10.0, -17.0, 12.0), 40.0),
                (DVec3::new(4.0, -7.0, 9.0), 100.0),
            ] {
                (plan.camera.eye, plan.camera.fov) = (eye, fov);
                for width in [0.005, 0.02, 0.1, 1.0] {
                    for (fog, height) in [(0.0, 0.0), (1.5, 0.2)] {
                        let look = &mut plan.look;
                        (look.glow_width, look.fog, look.fog_height) = (width, fog, height);
                        let (solid, light) = light(&plan);
                        let all = solid.run(Both(&plan, &light));
                        let off = |[a, b]: &[f64; 2]| (a - b).abs() / b.max(0.05);
                        let mut all: Vec<f64> = all.iter().map(off).collect();
                        all.sort_by(f64::total_cmp);
                        let [median, most] = [all[all.len() / 2], all[all.len() - 1]];
                        assert!(
                            median < 3e-3 && most < 8e-3,
                            "{name} {fov} {width} {fog}: {median} {most}"
                        );
                        worst = worst.max(most);
                    }
                }
            }
        }
        // Some rays are hard.
        assert!(worst > 1e-3, "{worst}");
    }
}
