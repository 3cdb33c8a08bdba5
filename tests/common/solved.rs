//! Scenes whose picture is solved in closed form, and cameras to see them with.

use conemarch::formula::{Formula, balls::Balls};
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use conemarch::plan::camera::Camera;
use conemarch::scene::Scene;
use conemarch::scene::distance::DistanceSettings;
use conemarch::scene::slab::SlabSettings;
use glam::DVec3;

use super::exact;

/// A camera that looks at a point, +z up.
pub fn camera(eye: [f64; 3], target: [f64; 3]) -> Camera {
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::Z,
        fov: 48.5,
    }
}

/// From far, from near, eight thousandths off the largest ball and along it, inside the
/// bounds between the solids, and straight along an axis.
pub fn cameras() -> [Camera; 5] {
    [
        camera([10.0, -17.0, 12.0], [0.0, 0.0, 0.0]),
        camera([4.0, -6.0, 3.0], [0.1, 0.2, 0.0]),
        camera([0.0, -0.6, 0.81], [2.0, -0.2, 1.0]),
        camera([-0.2, -2.2, -1.2], [0.3, 0.2, 0.2]),
        camera([7.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ]
}

/// The default solids but for the rod, with an exact distance field and five levels.
pub fn balls(rod_radius: f64, camera: &Camera, size: [u32; 2]) -> Plan {
    let mut plan = Plan::new(Scene::from(Formula::Balls(Balls {
        rod_radius,
        ..Balls::default()
    })));
    plan.camera = camera.clone();
    plan.march.coarsest = 32;
    // Rays that graze a ball creep for hundreds of steps; none is to end half-way.
    plan.march.steps = Some(2048);
    plan.size = size;
    plan
}

/// A disc, solved in closed form by the scene itself.
pub fn slab(camera: &Camera, size: [u32; 2]) -> Plan {
    let mut plan = balls(0.05, camera, size);
    plan.scene = Scene::Slab(SlabSettings::default());
    plan
}

/// Where a ray first meets the subject: solved, not marched.
pub fn meet(subject: &Scene, eye: DVec3, axis: DVec3) -> f64 {
    let solids = match subject {
        Scene::Slab(s) => vec![exact::Exact::Disc(s.normal, s.half, s.radius)],
        Scene::Distance(DistanceSettings { formula: shape, .. }) => match shape {
            Formula::Balls(b) => exact::balls(b.rod_radius, b.box_size, b.ball_radius),
            _ => panic!("only balls and slabs are solved here"),
        },
        Scene::Heightfield(_) => panic!("only balls and slabs are solved here"),
    };
    exact::first_hit(&solids, eye, axis)
}

/// The exact picture, and its distances in f64.
pub fn solved(plan: &Plan) -> (Frame, Vec<f64>) {
    let view = plan.view();
    let [w, h] = plan.size;
    let pixels = (0..h).flat_map(|y| (0..w).map(move |x| [x, y]));
    let t: Vec<f64> = pixels
        .map(|p| meet(&plan.scene, view.eye, view.view_ray(p).axis))
        .collect();
    let frame = Frame {
        size: plan.size,
        depth: t.iter().map(|t| *t as f32).collect(),
        state: t.iter().map(|t| u8::from(t.is_finite())).collect(),
        ..Frame::default()
    };
    (frame, t)
}
