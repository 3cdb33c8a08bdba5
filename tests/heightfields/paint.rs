//! Heightfields painted by the width of cones, on both executors.

use conemarch::base::view::Beam;
use conemarch::cpu;
use conemarch::heightfield::assets::Ready;
use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::heights::Patches;
use conemarch::pass;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::scene::{self, Assets, Solid};
use glam::DVec3;

use crate::adapter::DEPTHS;
use crate::cases::made;
use crate::scenes::{ready, solid};
use crate::{apart, both, plan};

/// Generators whose places are samples, four cones at each, or cells; and boxes.
const PAINTED: [(Generator, Patches); 4] = [
    (Generator::Exact, Patches::Bilinear),
    (Generator::Quad, Patches::Bilinear),
    (Generator::Walk, Patches::Bilinear),
    (Generator::Exact, Patches::Boxes),
];

/// A small map of noise that wraps along x, twice, painted by the cones of a generator.
fn painted((by, patches): (Generator, Patches)) -> Plan {
    plan(&format!(
        "field = 'noise:7x5,seed=3'\nwrap = 'x'\ntiles = [2, 1]\nsurface = '{}'\npaint = '{}'",
        patches.name(),
        by.name()
    ))
}

#[test]
fn paint_is_how_wide_the_cones_are() {
    for (by, patches) in PAINTED {
        let plan = painted((by, patches));
        let Ready {
            surface, placement, ..
        } = ready(&plan);
        let map = made(by, &surface, 2.0);
        let scene = solid(&plan);
        let eye = placement.position(plan.camera.eye);
        let units = DVec3::new(placement.texel, placement.texel, placement.depth);
        let [w, h] = surface.domain();
        let mut hues = Vec::new();
        // A quarter and three quarters into each cell, from above.
        for (i, j) in (0..2 * h).flat_map(|j| (0..2 * w).map(move |i| (i, j))) {
            let place = [i, j].map(|n| 0.25 + 0.5 * f64::from(n));
            let from = DVec3::new(place[0], place[1], 2.0);
            let ray = Beam {
                origin: placement.side((from - eye) * units),
                axis: -placement.side(DVec3::Z),
                r0: 0.0,
                k: 0.0,
                grain0: 0.0,
                grain: 0.0,
            };
            let mut work = Default::default();
            let mut walk = scene.begin(&ray, 0.0, f64::INFINITY, &mut work);
            while scene.walk_step(&ray, &mut walk, &mut work) == scene::Step::Moving {}
            let hue = scene.surface(&ray, &scene.walk_hit(&walk)).pigment.x;
            let round = by.over_cells() || patches == Patches::Boxes;
            let near = place.map(|n| if round { n.floor() } else { n.round() } as usize);
            let number = near[1] * map.size[0] as usize + near[0] % map.size[0] as usize;
            let cones = &map.ratios[number * by.channels()..][..by.channels()];
            let mean = cones.iter().sum::<f64>() / cones.len() as f64;
            let wanted = (mean / 7.0).min(1.0).sqrt();
            let off = (hue - wanted).abs();
            assert!(off < 1e-6, "{by:?}, {place:?}: {hue} for {wanted}");
            hues.push((1e6 * hue) as u32);
        }
        hues.sort_unstable();
        hues.dedup();
        assert!(hues.len() > 5, "{by:?}: {} hues", hues.len());
    }
}

#[test]
fn both_executors_paint_alike() {
    for by in PAINTED {
        let mut plan = painted(by);
        plan.look.palette_cycles = 1.0;
        let [here, there] = both(&plan, Extras::default());
        let wrong = apart(&here, &there, 0.02);
        // Rays that meet the line between two places within a rounding take either.
        assert!(wrong <= 40, "{by:?}: {wrong} pixels apart");
    }
}

#[test]
fn depths_alone_need_no_map_to_paint_by() {
    let fresh = || painted(PAINTED[0]);
    let maps = |frame: &Frame| {
        let passes = frame.passes.iter().map(|p| p.pass);
        passes.filter(|p| matches!(p, Pass::Prepare(_))).count()
    };
    for (extras, wanted) in [(Extras::default(), 2), (DEPTHS, 1)] {
        let said = pass::explain(&fresh(), &Assets::default(), extras).unwrap();
        assert_eq!(said.matches("prepare").count(), wanted, "{said}");
        assert_eq!(both(&fresh(), extras).each_ref().map(maps), [wanted; 2]);
    }
    // Assets that have served a render without the paint still have it afterwards.
    let assets = Assets::default();
    let render = |extras| cpu::render(&fresh(), &assets, extras, &mut |_| true).unwrap();
    let (without, with) = (render(DEPTHS), render(Extras::default()));
    assert_eq!(without.depth, with.depth);
    let [own, _] = both(&fresh(), Extras::default());
    assert_eq!(with.radiance, own.radiance);
}
