//! Limits of steps over heightfields: rays and shadow rays have as many steps as they can take, and
//! if they are given fewer, the picture says so.

use conemarch::heightfield::tracer::Accuracy;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use glam::DVec3;

use crate::adapter::{DEPTHS, NORMALS};
use crate::cases::of_accuracy;
use crate::common::folder::Folder;
use crate::common::pictures::raw;
use crate::{both, camera, plan};

/// A scene with each of the exact tracers.
fn exact(scene: &str) -> impl Iterator<Item = Plan> {
    let exact = of_accuracy(|own| own == Accuracy::Exact);
    exact.map(move |kind| plan(&format!("{scene}\ntracer = '{}'", kind.name())))
}

#[test]
fn shadows_that_reach_their_limit_are_counted_and_flagged() {
    const MAGENTA: [f32; 3] = [1.0, 0.0, 1.0];
    for mut plan in exact("field = 'fbm:128x128,seed=5,power=3'\ndepth = 2.6") {
        plan.camera = camera([7.0, -9.0, 8.0], [0.0; 3], 40.0);
        plan.look.light = DVec3::new(-0.8, -0.25, 0.15);
        plan.look.flag_unconverged = false;
        let rendered = |plan: &Plan| -> [Frame; 2] { both(plan, Extras::default()) };
        // By itself a shadow of so few cells has as many steps as it can need.
        let whole = rendered(&plan);
        assert_eq!(whole.each_ref().map(|f| f.undecided), [0, 0]);
        // With few some rays end on the way; those that met something before did not.
        plan.look.shadow_steps = Some(6);
        let cut = rendered(&plan);
        plan.look.flag_unconverged = true;
        let flagged = rendered(&plan);
        for ((cut, flagged), whole) in cut.iter().zip(&flagged).zip(&whole) {
            assert!(cut.undecided > 300, "{}", cut.undecided);
            assert_eq!(cut.undecided, flagged.undecided);
            assert!(!cut.radiance.contains(&MAGENTA));
            let marked = flagged.radiance.iter().filter(|c| **c == MAGENTA).count();
            assert_eq!(marked, cut.undecided);
            let cut = cut.radiance.iter().zip(&whole.radiance);
            for ((cut, whole), flagged) in cut.zip(&flagged.radiance) {
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
    let folder = Folder::new();
    folder.write("wall-64x64.raw", raw(&heights.collect::<Vec<_>>()));
    let file = folder.0.join("wall-64x64.raw");
    let mut plan = plan(&format!("field = '{}'\ndepth = 4", file.display()));
    plan.size = [60, 60];
    plan.look.light = DVec3::new(-1.0, 0.0, 0.2);
    plan.look.occlusion = 0.0;
    let mut open = plan.clone();
    open.look.shadow = false;
    // Over the floor, and inside the block, where the far corner is nearer than the wall is
    // to what it shadows.
    for height in [0.5, 3.0, 12.0] {
        for plan in [&mut plan, &mut open] {
            plan.camera = camera([3.0, 0.0, height], [5.0, 0.0, 0.0], 70.0);
        }
        for (dark, lit) in both(&plan, NORMALS).into_iter().zip(both(&open, NORMALS)) {
            let position = dark.positions(&plan.picture_rays());
            let floor = |i: &usize| dark.normal[*i][2] > 0.99 && position[*i][2] < 0.1;
            let floor: Vec<usize> = (0..dark.state.len()).filter(floor).collect();
            assert!(floor.len() > 500, "{} pixels of floor", floor.len());
            let bright = |i: &&usize| dark.radiance[**i] == lit.radiance[**i];
            let bright: Vec<_> = floor.iter().filter(bright).map(|i| position[*i]).collect();
            assert!(bright.is_empty(), "from {height}: {bright:?}");
        }
    }
}

#[test]
fn no_ray_of_an_exact_tracer_lacks_steps() {
    // Spikes seen along their tips: some rays pass by hundreds of them.
    let scene = "field = 'spikes:256x256'\nwrap = 'xy'\ntiles = [16, 16]\ndepth = 0.02";
    let lost = |plan: &Plan| both(plan, DEPTHS).map(|frame| frame.census()[2]);
    for mut plan in exact(scene) {
        plan.size = [100, 50];
        plan.camera = camera([0.0, 0.0, 0.0195], [6.0, 2.0, 0.012], 4.0);
        assert_eq!(lost(&plan), [0; 2]);
        plan.march.steps = Some(256);
        assert!(lost(&plan).iter().all(|n| *n > 100));
    }
}

#[test]
fn equal_steps_never_leave_shadows_undecided() {
    for steps in [200, 2048] {
        let scene = "field = 'fbm:64x64'\ntracer = 'linear-binary'";
        let mut plan = plan(&format!("{scene}\ntracer_steps = {steps}"));
        plan.camera = camera([7.0, -9.0, 8.0], [0.0; 3], 40.0);
        plan.size = [60, 40];
        for frame in both(&plan, Extras::default()) {
            let open = (frame.census()[2], frame.undecided);
            assert_eq!(open, (0, 0), "{steps} steps");
        }
    }
}
