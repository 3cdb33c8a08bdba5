//! What there is at a pixel or at a point of the scene. Twin: `wgsl/pass/pick.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::base::outcome::{self, State};
use crate::base::shader::Program;
use crate::base::view::View;
use crate::scene::AnySolid;
use crate::wgsl;

/// Where to look. A pixel may lie beyond the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// Along the ray of a pixel, from the upper left.
    Pixel([u32; 2]),
    /// At a point of the world.
    Point(DVec3),
}

/// What there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// What the pixel is; `None` for a point.
    pub state: Option<State>,
    /// The distance from the eye to the position, infinite for sky.
    pub distance: f64,
    /// Where the ray met the surface or stopped, some point of it for sky; or the point, rounded to f32
    /// relative to the eye.
    pub position: DVec3,
    /// The radius of a ball about the position that is as surely empty as the step of a ray is.
    pub clearance: f64,
}

/// What the device is asked.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct PickQuestion {
    /// The point relative to the eye.
    pub point: Vec3,
    /// 1 for the pixel, 0 for the point.
    pub traces: u32,
    /// The pixel.
    pub pixel: [u32; 2],
    /// The step limit of a dispatch.
    pub steps: u32,
    /// The step limit of the ray. It starts at the eye, so it has the steps of the cones too.
    pub limit: u32,
}

impl PickQuestion {
    /// The question for a place that is seen from an eye.
    pub fn new(at: At, eye: DVec3, [steps, limit]: [u32; 2]) -> Self {
        let (traces, pixel, point) = match at {
            At::Pixel(pixel) => (1, pixel, Vec3::ZERO),
            At::Point(point) => (0, [0; 2], (point - eye).as_vec3()),
        };
        Self {
            point,
            traces,
            pixel,
            steps,
            limit,
        }
    }
}

/// What the device answers.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct PickAnswer {
    /// The point that was met or asked for, relative to the eye.
    pub point: Vec3,
    /// The radius of an empty ball about it.
    pub clearance: f32,
    /// Its distance from the eye.
    pub distance: f32,
    /// The state of the ray.
    pub state: u32,
    /// 1 if there was a ray.
    pub begun: u32,
    /// Steps done.
    pub done: u32,
}

impl PickAnswer {
    /// The answer in the world. A ray that still moves has reached its step limit.
    pub fn picked(&self, eye: DVec3) -> Picked {
        let state = State::from_code(self.state).unwrap_or(State::Unconverged);
        Picked {
            state: (self.begun == 1).then_some(state),
            distance: match (self.begun, state) {
                (1, State::Sky) => f64::INFINITY,
                _ => self.distance.into(),
            },
            position: eye + self.point.as_dvec3(),
            clearance: self.clearance.into(),
        }
    }
}

/// The program over a scene in a view.
pub fn program(view: &View, scene: &AnySolid) -> Program {
    let mut modules = scene.twin().modules();
    modules.extend(view.modules());
    modules.extend(outcome::modules(false));
    modules.extend([wgsl!("scene/contract.wgsl"), wgsl!("pass/pick.wgsl")]);
    Program::new("pick", modules)
}
