//! How much fog there is along a ray, if it thins out with the height.
//! Twins: `wgsl/pass/fog_height.wgsl`, `fog_height_off.wgsl`.

use crate::base::view::Beam;
use crate::pass::LookFeature;
use crate::pass::look::Light;

/// Below so many scale heights fog gets no denser. It is opaque long before.
const FOG_DEEPEST: f64 = -60.0;

/// The optical depth of the first `t` units of a ray: the integral of the density, which is
/// `fog exp(-h)` at a height of h scale heights.
pub fn fog_depth(light: &Light, ray: &Beam, t: f64) -> f64 {
    if !light.has(LookFeature::FogHeight) {
        return light.look.fog * t;
    }
    let start = light.fog_start + light.fog_rise * ray.origin.dot(light.world_up);
    let rise = light.fog_rise * ray.axis.dot(light.world_up) * t;
    let low = start.min(start + rise).max(FOG_DEEPEST);
    light.look.fog * t * (-low).exp() * fog_mean(rise.abs())
}

/// The mean of `exp(-x)` from 0 to x: `(1 - exp(-x)) / x` without cancellation.
fn fog_mean(x: f64) -> f64 {
    if x > 0.5 {
        return (1.0 - (-x).exp()) / x;
    }
    1.0 - x / 2.0
        * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0 * (1.0 - x / 7.0)))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;
    use crate::scene::Assets;
    use crate::scene::slab::SlabSettings;
    use glam::DVec3;

    /// The depth by a sum over many short parts of the ray.
    fn summed(plan: &Plan, ray: &Beam, t: f64) -> f64 {
        const PARTS: u32 = 20_000;
        let away = plan.camera.eye - plan.camera.target;
        let (look, up) = (&plan.look, plan.camera.up.normalize());
        let part = |i: u32| {
            let at = t * (f64::from(i) + 0.5) / f64::from(PARTS);
            let height = (away + ray.at(at)).dot(up) / away.length() - look.fog_level;
            look.fog / away.length() * (-height / look.fog_height).exp()
        };
        (0..PARTS).map(part).sum::<f64>() * t / f64::from(PARTS)
    }

    #[test]
    fn the_depth_is_the_integral_of_the_density() {
        let mut plan = Plan::new(SlabSettings::default());
        plan.camera.eye = DVec3::new(3.0, -4.0, 2.0);
        plan.look.fog = 1.5;
        plan.look.fog_height = 0.3;
        let ray = |origin: DVec3, axis: DVec3| Beam {
            origin,
            axis: axis.normalize(),
            r0: 0.0,
            k: 0.0,
            grain0: 0.0,
            grain: 0.0,
        };
        let light = |plan: &Plan| {
            let solid = plan.scene.solid(&plan.viewpoint(), &Assets::default());
            Light::of(plan, &solid.expect("it names no file"))
        };
        for level in [-0.4, 0.0, 2.0] {
            plan.look.fog_level = level;
            let light = light(&plan);
            for rise in [-1.0, -0.3, -1e-3, -1e-9, 0.0, 1e-12, 0.01, 0.2, 5.0] {
                let ray = ray(DVec3::new(0.1, 0.2, -0.4), DVec3::new(1.0, 0.5, rise));
                for t in [0.0, 1e-6, 0.5, 3.0, 12.0] {
                    let (found, wanted) = (fog_depth(&light, &ray, t), summed(&plan, &ray, t));
                    assert!(
                        (found - wanted).abs() <= 1e-5 * wanted,
                        "{level} {rise} {t}: {found} {wanted}"
                    );
                }
            }
            // However far a ray goes, up or down, there is a number.
            for rise in [-1.0, 1.0] {
                let depth = fog_depth(&light, &ray(DVec3::ZERO, DVec3::Z * rise), 1e12);
                assert!(
                    depth.is_finite() && (rise > 0.0) == (depth < 1e3),
                    "{depth}"
                );
            }
        }
        // A great height is fog of one density.
        plan.look.fog_height = 1000.0;
        let at = ray(DVec3::ZERO, DVec3::ONE);
        let even = fog_depth(&light(&plan), &at, 2.0);
        plan.look.fog_height = 0.0;
        let plain = fog_depth(&light(&plan), &at, 2.0);
        assert!((even / plain - 1.0).abs() < 0.01 && even != plain);
        assert_eq!(plain, light(&plan).look.fog * 2.0);
    }
}
