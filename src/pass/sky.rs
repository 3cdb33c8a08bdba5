//! The light of the sky: two colours and a halo about the sun, or a file. Twins:
//! `wgsl/pass/sky.wgsl`, `sky_file.wgsl`.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec2, DVec3, Vec3, Vec4};

use crate::pass::look::{Light, smoothstep};
use crate::plan::sky::SkySettings;
use crate::scene::sky::Sky;

/// The sky of a file as WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SkyUniform {
    /// To the right of the file's middle.
    pub right: Vec3,
    /// Factor of its light.
    pub strength: f32,
    /// Toward its middle.
    pub forward: Vec3,
    /// Columns.
    pub width: u32,
    /// Up.
    pub up: Vec3,
    /// Rows.
    pub height: u32,
    /// As [`Sky::bands`].
    pub bands: [Vec4; 9],
}

/// The sky of a file, turned.
#[derive(Clone, Debug)]
pub struct SkyLight {
    /// What is in the file.
    pub sky: Arc<Sky>,
    /// The file's axes in the world: right, forward, up.
    frame: DMat3,
    strength: f64,
}

impl SkyLight {
    /// The sky of a file as the settings turn it about `up`.
    pub fn of(sky: Arc<Sky>, settings: &SkySettings, up: DVec3) -> Self {
        // Where up is along y, forward is along -z.
        let level = if up.y.abs() < 0.9 {
            DVec3::Y
        } else {
            DVec3::NEG_Z
        };
        let ahead = (level - up * up.dot(level)).normalize();
        let (sin, cos) = settings.sky_turn.to_radians().sin_cos();
        let forward = cos * ahead + sin * up.cross(ahead);
        Self {
            frame: DMat3::from_cols(forward.cross(up), forward, up),
            strength: settings.sky_strength,
            sky,
        }
    }

    fn own(&self, axis: DVec3) -> DVec3 {
        self.frame.transpose() * axis
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self) -> SkyUniform {
        let [width, height] = self.sky.size();
        SkyUniform {
            right: self.frame.x_axis.as_vec3(),
            strength: self.strength as f32,
            forward: self.frame.y_axis.as_vec3(),
            width,
            up: self.frame.z_axis.as_vec3(),
            height,
            bands: self.sky.bands().map(|band| band.as_vec3().extend(0.0)),
        }
    }

    /// A sample of the sky's directions, and its probability density per steradian.
    pub fn sky_toward(&self, cell: DVec2, pair: DVec2) -> (DVec3, f64) {
        let (own, density) = self.sky.toward(cell, pair);
        (self.frame * own, density)
    }

    /// The probability density of [`SkyLight::sky_toward`] in a direction.
    pub fn sky_density(&self, axis: DVec3) -> f64 {
        self.sky.density(self.own(axis))
    }
}

impl Light {
    /// Radiance of the sky in a direction.
    pub fn sky(&self, axis: DVec3) -> DVec3 {
        if let Some(file) = &self.sky {
            return file.strength * file.sky.radiance(file.own(axis));
        }
        let look = &self.look;
        let blend = smoothstep(-0.6, 0.8, axis.dot(self.world_up));
        look.sky_low.lerp(look.sky_high, blend) + self.halo(axis)
    }

    /// The wide, faint halo about the sun in the radiance of the sky: what air scatters of its light.
    pub fn halo(&self, axis: DVec3) -> DVec3 {
        if self.sky.is_some() {
            return DVec3::ZERO;
        }
        let near = axis.dot(self.look.light).max(0.0);
        self.look.light_color * (0.12 * near.powi(6))
    }

    /// Radiance that comes from the sky or the ground to a surface.
    pub fn sky_light(&self, axis: DVec3) -> DVec3 {
        let look = &self.look;
        if self.sky.is_some() {
            return look.fill * self.sky(axis);
        }
        let blend = smoothstep(-0.6, 0.8, axis.dot(self.world_up));
        let below = look.ground * look.sky_low;
        look.fill * (below.lerp(look.sky_high, blend) + self.halo(axis))
    }

    /// Radiance of fog in a direction. That of a file's sky has none of its details.
    pub fn sky_haze(&self, axis: DVec3) -> DVec3 {
        match &self.sky {
            Some(file) => file.strength * file.sky.ambient(file.own(axis)),
            None => self.sky(axis),
        }
    }

    /// Radiance of a white wall with a normal that nothing but sky and ground lights.
    pub fn sky_ambient(&self, normal: DVec3) -> DVec3 {
        let look = &self.look;
        if self.sky.is_some() {
            return look.fill * self.sky_haze(normal);
        }
        // From 0 for a surface that faces down to 1 for one that faces up. The ground absorbs
        // a part of the light of the lower sky.
        let up = 0.5 + 0.5 * normal.dot(self.world_up);
        (look.ground * look.sky_low).lerp(look.sky_high, up) * look.fill
    }
}
