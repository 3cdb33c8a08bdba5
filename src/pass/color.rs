//! The colour pass: key light with shadow, sky and bounce with occlusion, fog.
//! Twin: `wgsl/pass/color.wgsl`.

use glam::DVec3;

use crate::base::shader::Module;
use crate::base::view::{Beam, footprint};
use crate::base::work::State;
use crate::pass::look::Light;
use crate::pass::shadow::{self, Shadow};
use crate::pass::{fog, occlusion};
use crate::scene::{Hit, Solid, Surface};
use crate::wgsl;

/// The WGSL module of the pass; normals are written out only where they are asked for, and
/// the palette looked up only where pigments are not colours themselves.
pub fn module(keeps_normals: bool, colored: bool) -> Module {
    wgsl!(
        "pass/color.wgsl",
        "COLOR_KEEPS_NORMALS" = f64::from(u8::from(keeps_normals)),
        "COLOR_IS_PIGMENT" = f64::from(u8::from(colored))
    )
}

/// Radiance that leaves a surface towards the eye, and whether the shadow's ray came to an
/// end.
pub fn shade<S: Solid>(
    solid: &S,
    light: &Light,
    ray: &Beam,
    q: DVec3,
    surface: &Surface,
    grain: f64,
) -> (DVec3, bool) {
    let n = surface.normal;
    let albedo = if solid.is_colored() {
        surface.pigment
    } else {
        light.pigment_color(surface.pigment)
    };
    let facing = n.dot(light.light);
    // What faces away is dark without asking: it needs no shadow ray.
    let key = if facing > 0.0 {
        shadow::shadow(solid, light, q, n, grain)
    } else {
        Shadow::NONE
    };
    let lit = facing.max(0.0) * key.open;
    let open = occlusion::occlusion(solid, light, q, n, grain);
    let up = 0.5 + 0.5 * n.dot(light.world_up);
    let ambient = (0.45 * light.sky_low).lerp(light.sky_high, up) * light.fill;
    // Light thrown back by lit neighbours: warm, from below and behind.
    let bounce = light.light_color * (0.12 * light.fill * (1.0 - up));
    let half_way = (light.light - ray.axis).normalize_or_zero();
    let shine = n.dot(half_way).max(0.0).powi(40);
    let c = albedo * (light.light_color * (light.key * lit) + (ambient + bounce) * open)
        + light.light_color * (light.gloss * lit * shine);
    (c, key.decided)
}

/// What the pass says of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaded {
    /// Radiance towards the eye.
    pub radiance: DVec3,
    /// Unit normal, zero for the sky.
    pub normal: DVec3,
    /// Whether the shadow's ray, if there was one, came to its end within its steps.
    pub decided: bool,
}

/// The light of a pixel.
pub fn color<S: Solid>(solid: &S, light: &Light, ray: &Beam, hit: &Hit, state: State) -> Shaded {
    if state == State::Sky {
        return Shaded {
            radiance: light.sky(ray.axis),
            normal: DVec3::ZERO,
            decided: true,
        };
    }
    let surface = solid.surface(ray, hit);
    let grain = footprint(ray, hit.t);
    let (mut c, decided) = shade(solid, light, ray, ray.at(hit.t), &surface, grain);
    c = fog::fog(light, c, ray.axis, hit.t);
    if light.flag && (state == State::Unconverged || !decided) {
        c = DVec3::new(1.0, 0.0, 1.0);
    }
    Shaded {
        radiance: c,
        normal: surface.normal,
        decided,
    }
}
