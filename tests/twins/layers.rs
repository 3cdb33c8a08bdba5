//! Traps, layers and palettes in Oklab agree.

use bytemuck::bytes_of;
use conemarch::formula::Formula;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::pass::layers;
use conemarch::plan::Plan;
use conemarch::plan::layers::{Blend, Trap};
use conemarch::plan::look::PaletteSpace;
use conemarch::scene::Solid;
use glam::DVec3;

use super::common::plans::{distance, distance_solid, light, solid};
use super::common::probe::{Probe, probe};
use super::common::setups::{four, probe_of, seen_from};
use super::compare::{Allowed, MOVED, Twins, questions};
use super::three;

/// The layers of a plan, and a probe into them.
fn layered(plan: &Plan) -> Probe {
    let mut all = probe_of(plan, probe!("layers"));
    all.modules.push(conemarch::wgsl!("pass/look.wgsl"));
    let modules = layers::modules(&plan.look.layers, &solid(plan));
    all.modules.extend(modules);
    let light = light(plan);
    let look = bytes_of(&light.parameters()).to_vec();
    let over = bytes_of(&layers::uniform(&light)).to_vec();
    all.parameters.push(("look_parameters", look));
    all.parameters.push(("layers_parameters", over));
    all
}

/// The numbers of all traps, in order.
const NAMES: [&str; 7] = [
    "point",
    "line",
    "plane",
    "sphere",
    "cross",
    "iterations",
    "folds",
];

#[test]
fn traps_and_layers_agree() {
    let julia = Mandelbox {
        julia: true,
        rotation: DVec3::new(20.0, 0.0, 5.0),
        ..Mandelbox::default()
    };
    let more = [Formula::Mandelbox(julia)];
    let mut with_escaping = 0;
    for formula in Formula::all().into_iter().chain(more) {
        let bounds = formula.bounds();
        let reach = 1.2 * bounds.half.max_element().min(bounds.radius);
        let mut plan = seen_from([2.0, -1.0, 0.5], distance(formula.clone(), Some(10)));
        let look = &mut plan.look;
        look.palette_space = PaletteSpace::Oklab;
        // As many colours as there can be.
        look.layers.layer2_palette = (0..16)
            .map(|i| {
                DVec3::new(
                    f64::from(i % 5) / 4.0,
                    f64::from(i % 3) / 2.0,
                    f64::from(i) / 15.0,
                )
            })
            .collect();
        (look.layers.trap, look.layers.trap_scale) = (Trap::Cross, 0.7);
        look.layers.layer2_trap = Trap::Point;
        look.layers.layer2_blend = Blend::Screen;
        look.layers.layer3_trap = Trap::Plane;
        look.layers.layer3_blend = Blend::Multiply;
        look.layers.layer3_offset = 0.3;
        let eye = plan.camera.eye;
        let asked = questions(21, |random| {
            let point = random.cube(reach) - eye;
            let pigment = DVec3::new(random.unit(), random.unit(), random.unit());
            [four(point, 0.0), four(pigment, 0.0), [0.0; 4]]
        });
        let (scene, seen) = (distance_solid(&plan), light(&plan));
        // Some orbits escape, between two iterations.
        let traps = |q: &[[f32; 4]; 3]| scene.traps(three(q[0])).unwrap();
        let escaping = asked.iter().filter(|q| (10.0 * traps(q)[5]).fract() != 0.0);
        with_escaping += usize::from(escaping.count() > 500);
        let quantities = [
            // In ten iterations an error of f32 has grown by up to five digits.
            ("point line plane sphere cross", 0.01, Allowed(2e-6, 3e-2)),
            ("iterations", 0.01, Allowed(2e-6, 1e-3)),
            // Whole numbers, a tenth of which f32 has to seven digits.
            ("folds", 0.01, Allowed(1e-7, 1e-6)),
            ("albedo", 0.01, Allowed(1e-5, 5e-3)),
        ];
        let twins = Twins::new(&asked, &quantities, |pairs, q, a| {
            let got = a[0].iter().chain(&a[1]);
            for ((name, got), wanted) in NAMES.into_iter().zip(got).zip(traps(q)) {
                pairs.add(name, *got, wanted);
            }
            let albedo = layers::albedo(&scene, &seen, three(q[0]), three(q[1]));
            pairs.add_vector("albedo", a[2], albedo);
        });
        let moved = |change: fn(&mut Plan)| {
            let mut plan = plan.clone();
            change(&mut plan);
            layered(&plan)
        };
        // Without orbits, some numbers are the same everywhere.
        let first = traps(&asked[0]);
        let varies = |i: &usize| asked.iter().any(|q| traps(q)[*i] != first[*i]);
        let varying = (0..NAMES.len()).filter(varies).map(|i| NAMES[i]);
        let names: Vec<&str> = varying.chain(["albedo"]).collect();
        assert!(names.len() > 5, "{names:?}");
        let changes = [
            (
                &*names.join(" "),
                moved(|p| p.camera.eye += DVec3::splat(0.01)),
            ),
            (
                "albedo",
                moved(|p| p.look.layers.trap_scale *= 1.0 + 300.0 * (MOVED - 1.0)),
            ),
            ("albedo", moved(|p| p.look.layers.layer2_blend = Blend::Mix)),
            ("albedo", moved(|p| p.look.layers.layer3_weight *= 0.9)),
            ("albedo", moved(|p| p.look.layers.layer2_palette.reverse())),
            (
                "albedo",
                moved(|p| p.look.palette_space = PaletteSpace::Linear),
            ),
        ];
        twins.assert_agree(&format!("{:?}", plan.scene), &layered(&plan), &changes);
    }
    // Those of the Mandelbox and of its Julia set at least.
    assert!(with_escaping >= 2, "{with_escaping}");
}
