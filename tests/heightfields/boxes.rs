//! The sides of boxes, on both executors: whatever finds them, they face the way from which they
//! are seen.

use conemarch::heightfield::tracer::{Accuracy, TracerKind};
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;
use glam::DVec3;

use crate::adapter::{HIT, NORMALS};
use crate::cases::{first_box, of_accuracy};
use crate::scenes::{SCENES, local, ready};
use crate::{both, plan};

/// The scenes of boxes, traced by a tracer.
fn boxes(tracer: TracerKind) -> impl Iterator<Item = (String, Plan)> {
    let scenes = SCENES.into_iter().filter(|scene| scene.contains("boxes"));
    scenes.map(move |scene| {
        let scene = format!("{scene}\ntracer = '{}'", tracer.name());
        let plan = plan(&scene);
        (scene, plan)
    })
}

fn normal(frame: &Frame, pixel: usize) -> DVec3 {
    DVec3::from_array(frame.normal[pixel].map(f64::from))
}

#[test]
fn the_sides_of_boxes_face_sideways() {
    for tracer in of_accuracy(|own| own != Accuracy::Approximate) {
        for (name, plan) in boxes(tracer) {
            let (ready, view) = (ready(&plan), plan.view());
            for frame in both(&plan, NORMALS) {
                check_normals(&name, &frame, |pixel| {
                    let ray = local(&ready.placement, view.eye, &view.view_ray(pixel));
                    let (_, normal) = first_box(&ready.surface, &ray)?;
                    Some(ready.placement.side(normal))
                });
            }
        }
    }
}

/// Compares the normals of a frame with those of its rays, and sees that sides and tops
/// are among them.
fn check_normals(what: &str, frame: &Frame, truth: impl Fn([u32; 2]) -> Option<DVec3>) {
    let width = frame.size[0];
    let (mut wrong, mut seen) = (0, Vec::<(DVec3, u32)>::new());
    for i in (0..frame.state.len()).filter(|i| frame.state[*i] == HIT) {
        let own = normal(frame, i);
        let truth = truth([i as u32 % width, i as u32 / width]);
        wrong += u32::from(truth.is_none_or(|n| n.distance(own) > 1e-5));
        match seen.iter_mut().find(|(n, _)| n.distance(own) < 1e-5) {
            Some((_, count)) => *count += 1,
            None => seen.push((own, 1)),
        }
    }
    // Rays that meet an edge within a rounding: f32 takes either side.
    assert!(wrong <= 8, "{what}: {wrong} wrong, {seen:?}");
    let often = seen.iter().filter(|(_, count)| *count > 100).count();
    assert!(often >= 3, "{what}: {seen:?}");
}

#[test]
fn bisections_and_secants_find_the_sides_of_boxes_too() {
    let truths = boxes(TracerKind::Walk).map(|(_, plan)| both(&plan, NORMALS));
    let truths: Vec<_> = truths.collect();
    for tracer in of_accuracy(|own| own == Accuracy::Approximate) {
        for ((name, plan), truths) in boxes(tracer).zip(&truths) {
            for (own, truth) in both(&plan, NORMALS).iter().zip(truths) {
                // Where these tracers find the first hit, they know what they met.
                let both = |i: &usize| own.state[*i] == HIT && truth.state[*i] == HIT;
                let same = |i: &usize| (own.depth[*i] - truth.depth[*i]).abs() < 1e-4;
                let found: Vec<usize> = (0..own.state.len()).filter(both).filter(same).collect();
                let apart = |i: &&usize| normal(own, **i).distance(normal(truth, **i)) > 1e-4;
                let wrong = found.iter().filter(apart).count();
                assert!(found.len() > 500, "{name}: {} found", found.len());
                // Rays that meet an edge within a rounding.
                assert!(wrong <= 8, "{name}: {wrong} of {}", found.len());
            }
        }
    }
}
