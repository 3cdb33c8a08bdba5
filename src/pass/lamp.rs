//! The light of lamps in the scene: small balls, weaker by the square of the distance, that shine
//! evenly or in a cone. Twins: `wgsl/pass/lamp.wgsl`, `lamp_off.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::base::srgb::linear;
use crate::pass::look::{Light, smoothstep};
use crate::plan::Plan;
use crate::plan::lamps::LampSettings;

/// The share of a cone's angle that has full light; to the edge it falls smoothly to none.
const LAMP_FULL: f64 = 0.8;

/// A light as a point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Unit direction to it.
    pub axis: DVec3,
    /// Its distance.
    pub far: f64,
    /// Tangent of its angular radius.
    pub softness: f64,
}

/// A lamp that shines, in lengths of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampSource {
    /// Its position relative to the eye.
    pub at: DVec3,
    /// Its radius.
    pub size: f64,
    /// Its linear colour times its strength at distance 1.
    pub light: DVec3,
    /// Unit direction of the middle of its cone.
    pub toward: DVec3,
    /// Squares of the distance from `toward` to a unit direction at the end of full light, and of
    /// all light. Unlike cosines, these are precise in narrow cones. All are at most 4.
    pub edge: [f64; 2],
}

/// A lamp as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LampUniform {
    /// Its position relative to the eye.
    pub at: Vec3,
    /// Its radius.
    pub size: f32,
    /// Its colour times its strength at distance 1.
    pub light: Vec3,
    /// Where full light ends.
    pub full: f32,
    /// Unit direction of the middle of its cone.
    pub toward: Vec3,
    /// Where all light ends.
    pub none: f32,
}

impl LampSource {
    /// The lamps of a plan that shine.
    pub fn all(plan: &Plan) -> Vec<Self> {
        let camera = &plan.camera;
        let distance = (camera.target - camera.eye).length();
        let one = |lamp: LampSettings| {
            let at = lamp.at.unwrap_or(camera.eye);
            let toward = lamp.toward.unwrap_or(camera.target) - at;
            let square = |half: f64| (2.0 * (0.5 * half).sin()).powi(2);
            let cone = lamp.cone.filter(|cone| *cone < 360.0);
            let half = cone.map(|cone| 0.5 * cone.to_radians());
            Self {
                at: at - camera.eye,
                size: lamp.size * distance,
                light: lamp.strength * (distance * distance) * linear(lamp.color),
                toward: toward.normalize_or(-camera.up.normalize()),
                // Without a cone the edge is where no direction is.
                edge: half.map_or([8.0, 16.0], |h| [LAMP_FULL * h, h].map(square)),
            }
        };
        plan.look.lit_lamps().map(one).collect()
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self) -> LampUniform {
        let [full, none] = self.edge.map(|x| x as f32);
        LampUniform {
            at: self.at.as_vec3(),
            size: self.size as f32,
            light: self.light.as_vec3(),
            full,
            toward: self.toward.as_vec3(),
            none,
        }
    }
}

/// A lamp as a point sees it. The lamps are counted by `light.lamps`.
pub fn lamp_from(light: &Light, nth: usize, q: DVec3) -> Lamp {
    let source = &light.lamps[nth];
    let way = source.at - q;
    // Not inside it.
    let far = way.length().max(source.size);
    Lamp {
        axis: way.normalize_or(light.world_up),
        far,
        softness: source.size / far,
    }
}

/// Radiance of a white wall that faces the lamp where it is seen so.
pub fn lamp_light(light: &Light, nth: usize, lamp: &Lamp) -> DVec3 {
    let source = &light.lamps[nth];
    let [full, none] = source.edge;
    let beyond = smoothstep(full, none, (lamp.axis + source.toward).length_squared());
    source.light / (lamp.far * lamp.far) * (1.0 - beyond)
}
