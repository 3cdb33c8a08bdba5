//! Limits of steps over heightfields: rays have as many as they can take, those of shadows,
//! too, and where they are told to have fewer it is said.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a test may panic, and is read by its name"
)]

mod adapter;

use conemarch::cpu;
use conemarch::heightfield::settings::{HeightfieldSettings, Wrap};
use conemarch::picture::frame::Frame;
use conemarch::plan::camera::Camera;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;
use conemarch::scene::Scene;
use glam::DVec3;

const DEPTHS: Extras = Extras {
    count: false,
    normals: false,
    levels: false,
    depth_only: true,
    time: false,
};

/// A plan as both executors render it: the CPU first.
fn both(plan: &Plan, extras: Extras) -> [Frame; 2] {
    let here = cpu::render(plan, &Assets::default(), extras, &mut |_| true).unwrap();
    [here, adapter::render(plan, extras)]
}

/// From above.
fn camera() -> Camera {
    Camera {
        eye: DVec3::new(7.0, -9.0, 8.0),
        target: DVec3::ZERO,
        up: DVec3::Z,
        fov: 40.0,
    }
}

#[test]
fn shadows_that_reach_their_limit_are_counted_and_flagged() {
    const MAGENTA: [f32; 3] = [1.0, 0.0, 1.0];
    for tracer in ["walk", "walk-relaxed", "max-mip"] {
        let mut shape = HeightfieldSettings::default();
        shape.source.field = "fbm:128x128,seed=5,power=3".into();
        shape.depth = 2.6;
        shape.tracing.tracer = tracer;
        let mut plan = Plan::new(Scene::Heightfield(shape));
        plan.camera = camera();
        plan.size = [120, 80];
        plan.look.light = DVec3::new(-0.8, -0.25, 0.15);
        plan.look.flag_unconverged = false;
        let rendered = |plan: &Plan| both(plan, Extras::default());
        // By itself a shadow of so few cells has as many steps as it can need.
        let whole = rendered(&plan);
        assert_eq!(whole.each_ref().map(|f| f.undecided), [0, 0], "{tracer}");
        // With few some rays end on the way; those that met something before did not.
        plan.look.shadow_steps = Some(6);
        let cut = rendered(&plan);
        plan.look.flag_unconverged = true;
        let flagged = rendered(&plan);
        for ((cut, flagged), whole) in cut.iter().zip(&flagged).zip(&whole) {
            assert!(cut.undecided > 300, "{tracer}: {}", cut.undecided);
            assert_eq!(cut.undecided, flagged.undecided);
            assert!(!cut.radiance.contains(&MAGENTA));
            let marked = flagged.radiance.iter().filter(|c| **c == MAGENTA).count();
            assert_eq!(marked, cut.undecided, "{tracer}");
            for ((cut, flagged), whole) in cut
                .radiance
                .iter()
                .zip(&flagged.radiance)
                .zip(&whole.radiance)
            {
                // What is not marked is as it should be.
                assert!(*flagged == MAGENTA || (flagged == cut && cut == whole));
            }
        }
    }
}

#[test]
fn shadows_reach_across_the_block_from_wherever_they_are_seen() {
    // A wall at the low end of x, and light from there so low that all the floor is dark.
    let heights = (0..64 * 64).map(|i| f32::from(u8::from(i % 64 < 2)));
    let file =
        std::env::temp_dir().join(format!("conemarch-wall-{}-64x64.raw", std::process::id()));
    let bytes: Vec<u8> = heights.flat_map(f32::to_le_bytes).collect();
    std::fs::write(&file, bytes).unwrap();
    let mut shape = HeightfieldSettings::default();
    shape.source.field = file.to_string_lossy().into_owned();
    shape.depth = 4.0;
    let mut plan = Plan::new(Scene::Heightfield(shape));
    plan.size = [60, 60];
    plan.look.light = DVec3::new(-1.0, 0.0, 0.2);
    plan.look.occlusion = 0.0;
    let mut open = plan.clone();
    open.look.shadow = false;
    // Over the floor, and inside the block, where the far corner is nearer than the wall is
    // to what it shadows.
    for height in [0.5, 3.0, 12.0] {
        for plan in [&mut plan, &mut open] {
            plan.camera = Camera {
                eye: DVec3::new(3.0, 0.0, height),
                target: DVec3::new(5.0, 0.0, 0.0),
                fov: 70.0,
                ..plan.camera
            };
        }
        let render = |plan: &Plan| {
            let normals = Extras {
                normals: true,
                ..Extras::default()
            };
            both(plan, normals)
        };
        for (dark, lit) in render(&plan).into_iter().zip(render(&open)) {
            let position = dark.positions(&plan.view());
            let floor = |i: &usize| dark.normal[*i][2] > 0.99 && position[*i][2] < 0.1;
            let floor: Vec<usize> = (0..dark.state.len()).filter(floor).collect();
            assert!(floor.len() > 500, "{} pixels of floor", floor.len());
            let bright = |i: &&usize| dark.radiance[**i] == lit.radiance[**i];
            let bright: Vec<_> = floor.iter().filter(bright).map(|i| position[*i]).collect();
            assert!(bright.is_empty(), "from {height}: {bright:?}");
        }
    }
    std::fs::remove_file(&file).unwrap();
}

#[test]
fn no_ray_of_an_exact_tracer_lacks_steps() {
    // Spikes seen along their tips: some rays pass by hundreds of them.
    for tracer in ["walk", "walk-relaxed", "max-mip"] {
        let mut shape = HeightfieldSettings::default();
        shape.source.field = "spikes:256x256".into();
        shape.source.wrap = Wrap::Both;
        shape.tiles = [16, 16];
        shape.depth = 0.02;
        shape.tracing.tracer = tracer;
        let mut plan = Plan::new(Scene::Heightfield(shape));
        plan.size = [100, 50];
        plan.camera = Camera {
            eye: DVec3::new(0.0, 0.0, 0.0195),
            target: DVec3::new(6.0, 2.0, 0.012),
            fov: 4.0,
            ..plan.camera
        };
        let lost = |plan: &Plan| both(plan, DEPTHS).map(|frame| frame.census()[2]);
        assert_eq!(lost(&plan), [0; 2], "{tracer}");
        plan.march.steps = Some(256);
        assert!(lost(&plan).iter().all(|n| *n > 100), "{tracer}");
    }
}

#[test]
fn equal_steps_never_leave_shadows_undecided() {
    for steps in [200, 2048] {
        let mut shape = HeightfieldSettings::default();
        shape.source.field = "fbm:64x64".into();
        shape.tracing.tracer = "linear-binary";
        shape.tracing.steps = Some(steps);
        let mut plan = Plan::new(Scene::Heightfield(shape));
        plan.camera = camera();
        plan.size = [60, 40];
        for frame in both(&plan, Extras::default()) {
            assert_eq!(
                (frame.census()[2], frame.undecided),
                (0, 0),
                "{steps} steps"
            );
        }
    }
}
