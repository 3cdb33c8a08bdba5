//! Balls, boxes and a rod with an exact distance.
//!
//! With an exact distance, tests of cones need no tolerance. The formula also shows that
//! [`DistanceEstimate`] suits shapes that are unlike the Mandelbox.
//! Twin: `wgsl/formula/balls.wgsl`.

use bytemuck::{Pod, Zeroable, bytes_of};
use glam::{DVec3, DVec4, Vec4};

use crate::base::key::{Key, number};
use crate::base::shader::Module;
use crate::formula::contract::{Bounds, DistanceEstimate, Evaluate, Evaluator};
use crate::{settings, wgsl};

/// The solids as WGSL reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct BallsUniform {
    /// Centre and radius.
    pub ball0: Vec4,
    /// Centre and radius.
    pub ball1: Vec4,
    /// Centre and radius.
    pub ball2: Vec4,
    /// Centre and half edge.
    pub box0: Vec4,
    /// Centre and half edge.
    pub box1: Vec4,
    /// x, y, half height, radius.
    pub rod: Vec4,
}

settings! {
    /// Three balls, two boxes and a vertical rod.
    pub struct Balls {
        rod_radius: f64 = 0.05, number(1e-6, 0.5), "radius of the rod";
        box_size: f64 = 0.7, number(1e-3, 1.2), "half edge of the larger box";
        ball_radius: f64 = 1.0, number(1e-3, 2.5), "radius of the largest ball";
    }
}

/// Every solid fits in a box of this half extent about the origin.
const EXTENT: f64 = 3.0;

impl Balls {
    /// Centre and radius of each ball, centre and half edge of each box, and x, y, half height
    /// and radius of the rod.
    fn solids(&self) -> [DVec4; 6] {
        [
            DVec4::new(0.0, 0.0, 0.0, self.ball_radius),
            DVec4::new(1.6, 0.4, -0.3, 0.45),
            DVec4::new(-0.9, -1.3, 0.9, 0.25),
            DVec4::new(-1.6, 1.0, -0.4, self.box_size),
            DVec4::new(1.2, -1.5, -0.7, 0.35),
            DVec4::new(0.4, -2.0, 1.8, self.rod_radius),
        ]
    }
}

impl DistanceEstimate for Balls {
    fn name(&self) -> &'static str {
        "balls"
    }

    fn keys(&mut self) -> Vec<Key<'_>> {
        self.keys()
    }

    fn modules(&self) -> Vec<Module> {
        vec![wgsl!("formula/balls.wgsl"), wgsl!("formula/plain.wgsl")]
    }

    fn uniforms(&self, _iterations: u32) -> Vec<(&'static str, Vec<u8>)> {
        let [ball0, ball1, ball2, box0, box1, rod] = self.solids().map(|s| s.as_vec4());
        let solids = BallsUniform {
            ball0,
            ball1,
            ball2,
            box0,
            box1,
            rod,
        };
        vec![("balls_parameters", bytes_of(&solids).to_vec())]
    }

    fn evaluator(&self) -> Evaluator {
        Evaluator::new(self.clone())
    }

    fn bounds(&self) -> Bounds {
        Bounds::cuboid(DVec3::splat(EXTENT))
    }

    fn iterations(&self, _eps: f64) -> u32 {
        1
    }
}

impl Evaluate for Balls {
    fn value(&self, p: DVec3, _most: u32) -> (f64, u32) {
        let [balls @ .., box0, box1, rod] = self.solids();
        let mut d = f64::INFINITY;
        for s in balls {
            d = d.min((p - s.truncate()).length() - s.w);
        }
        for s in [box0, box1] {
            let q = (p - s.truncate()).abs() - DVec3::splat(s.w);
            d = d.min(q.max(DVec3::ZERO).length() + q.max_element().min(0.0));
        }
        let nearest = DVec3::new(rod.x, rod.y, p.z.clamp(-rod.z, rod.z));
        (d.min((p - nearest).length() - rod.w), 1)
    }

    fn trap(&self, p: DVec3, _most: u32) -> DVec3 {
        (p - p.round()).abs() * 2.0
    }
}
