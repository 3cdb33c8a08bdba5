//! Scenes whose picture is solved in closed form, and cameras to see them with.

use conemarch::base::view::Beam;
use conemarch::formula::{Formula, balls::Balls};
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use conemarch::plan::camera::Camera;
use conemarch::scene::Scene;

use super::exact::{self, Exact};
use super::plans::{camera, distance, scene};

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
    let formula = Formula::Balls(Balls {
        rod_radius,
        ..Balls::default()
    });
    let mut plan = Plan::new(distance(formula, None)).one_sample();
    // The details of its own pixels.
    plan.reference = None;
    plan.camera = camera.clone();
    plan.march.coarsest = Some(32);
    // Rays that graze a ball creep for hundreds of steps; none is to end half-way.
    plan.march.steps = Some(2048);
    plan.size = size;
    plan
}

/// A disc, solved in closed form by the scene itself.
pub fn slab(camera: &Camera, size: [u32; 2]) -> Plan {
    let mut plan = balls(0.05, camera, size);
    plan.scene = scene("kind = 'slab'");
    plan
}

/// The solids of a plan in closed form, if that is known.
pub fn solids(plan: &Plan) -> Option<Vec<Exact>> {
    match &plan.scene {
        Scene::Slab(s) => Some(vec![Exact::Disc(s.normal, s.half, s.radius)]),
        Scene::Distance(settings) => match &settings.formula {
            Formula::Balls(b) => Some(exact::balls(b.rod_radius, b.box_size, b.ball_radius)),
            _ => None,
        },
        _ => None,
    }
}

/// The rays of all pixels, row by row.
pub fn rays(plan: &Plan) -> impl Iterator<Item = Beam> {
    let (view, [w, h]) = (plan.view(), plan.size);
    (0..w * h).map(move |i| view.view_ray([i % w, i / w]))
}

/// The exact picture, and its distances in f64; infinity where nothing is met.
///
/// # Panics
/// For plans of other scenes than balls and slabs.
pub fn solved(plan: &Plan) -> (Frame, Vec<f64>) {
    let solids = solids(plan).expect("balls or a slab");
    let meet = |ray: Beam| exact::first_hit(&solids, plan.camera.eye + ray.origin, ray.axis);
    let t: Vec<f64> = rays(plan).map(meet).collect();
    let frame = Frame {
        size: plan.size,
        depth: t.iter().map(|t| *t as f32).collect(),
        state: t.iter().map(|t| u8::from(t.is_finite())).collect(),
        ..Frame::default()
    };
    (frame, t)
}
