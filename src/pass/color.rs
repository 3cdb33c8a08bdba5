//! The colour pass: key light with shadow, light from the sky and from the ground with
//! occlusion, and fog. Twin: `wgsl/pass/color.wgsl`.

use glam::DVec3;

use crate::base::outcome::State;
use crate::base::view::{Beam, footprint};
use crate::pass::look::Light;
use crate::pass::shadow::{self, Shadow};
use crate::pass::{fog, layers, occlusion};
use crate::scene::{Hit, Solid, Surface};

/// Radiance that leaves a surface towards the eye, and whether the shadow ray reached its end.
fn shade<S: Solid>(
    solid: &S,
    light: &Light,
    ray: &Beam,
    t: f64,
    surface: &Surface,
) -> (DVec3, bool) {
    let (q, grain) = (ray.at(t), footprint(ray, t));
    let (n, look) = (surface.normal, &light.look);
    let albedo = if solid.is_colored() {
        surface.pigment
    } else {
        layers::albedo(solid, light, q, surface.pigment)
    };
    let facing = n.dot(look.light);
    // A surface that faces away is dark: it needs no shadow ray.
    let key = if facing > 0.0 {
        shadow::shadow(solid, light, q, n, grain)
    } else {
        Shadow::NONE
    };
    let lit = facing.max(0.0) * key.open;
    let open = occlusion::occlusion(solid, light, q, n, grain);
    let up = 0.5 + 0.5 * n.dot(light.world_up);
    let ambient = (0.45 * look.sky_low).lerp(look.sky_high, up) * look.fill;
    // Light from lit neighbours: warm, from below.
    let bounce = look.light_color * (0.12 * look.fill * (1.0 - up));
    let half_way = (look.light - ray.axis).normalize_or_zero();
    let shine = n.dot(half_way).max(0.0).powi(40);
    let c = albedo * (look.light_color * (look.key * lit) + (ambient + bounce) * open)
        + look.light_color * (look.gloss * lit * shine);
    (c, key.decided)
}

/// A pixel's colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaded {
    /// Radiance towards the eye.
    pub radiance: DVec3,
    /// Unit normal; zero for sky.
    pub normal: DVec3,
    /// Whether the shadow ray, if there was one, reached its end before its step limit.
    pub decided: bool,
}

/// Colours one pixel.
pub fn color<S: Solid>(solid: &S, light: &Light, ray: &Beam, hit: &Hit, state: State) -> Shaded {
    if state == State::Sky {
        return Shaded {
            radiance: light.sky(ray.axis),
            normal: DVec3::ZERO,
            decided: true,
        };
    }
    let surface = solid.surface(ray, hit);
    let (mut c, decided) = shade(solid, light, ray, hit.t, &surface);
    c = fog::fog(light, c, ray.axis, hit.t);
    if light.look.flag_unconverged && (state == State::Unconverged || !decided) {
        c = DVec3::new(1.0, 0.0, 1.0);
    }
    Shaded {
        radiance: c,
        normal: surface.normal,
        decided,
    }
}
