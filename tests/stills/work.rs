//! A render in slices: whatever their sizes, and whatever was begun before, the picture is the
//! same; and what a frame needs again stays on the device.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use conemarch::base::clock::clock;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::{Cutting, Renderer};
use conemarch::heightfield::conemap::generate::Generator;
use conemarch::heightfield::{ConeMap, Heights};
use conemarch::picture::frame::{Frame, Traffic};
use conemarch::picture::{Layer, Shades};
use conemarch::plan::look::LightMode;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{BUILTIN, load};
use conemarch::scene::Assets;
use wgpu::Limits;

use super::common::plans::{preset, sized};
use super::common::random::Random;
use crate::adapter::{self, EVERYTHING, render, render_cut};

/// All bits of a frame.
pub fn bits(frame: &Frame) -> Vec<u32> {
    let mut all: Vec<u32> = frame
        .radiance
        .iter()
        .flatten()
        .map(|x| x.to_bits())
        .collect();
    all.extend(frame.alpha.iter().map(|a| a.to_bits()));
    all.extend(frame.variance.iter().map(|v| v.to_bits()));
    all.extend(frame.depth.iter().map(|t| t.to_bits()));
    all.extend(frame.normal.iter().flatten().map(|x| x.to_bits()));
    all.extend(frame.state.iter().map(|s| u32::from(*s)));
    all.extend(
        frame
            .work
            .iter()
            .flat_map(|w| [w.evaluations, w.iterations]),
    );
    for level in &frame.levels {
        all.extend(level.front.iter().map(|f| f.to_bits()));
        all.extend(level.state.iter().map(|s| u32::from(*s)));
    }
    all
}

/// The bits of a plan's frame, which must be the same in blocks and slices.
pub fn bits_however_cut(plan: &Plan) -> Vec<u32> {
    let whole = bits(&render(plan, EVERYTHING));
    let cutting = Cutting {
        block: 32,
        chunk: 5,
    };
    assert!(whole == bits(&render_cut(plan, EVERYTHING, cutting)));
    whole
}

/// A plan of several samples with cones, and one without them through a lens.
fn sampled() -> [Plan; 2] {
    [("mandelbox", 16), ("bench-thin", 1)].map(|(name, coarsest)| {
        let mut plan = sized(name, [70, 45]);
        plan.samples = 3;
        plan.march.coarsest = Some(coarsest);
        plan.camera.aperture = if coarsest == 1 { 0.02 } else { 0.0 };
        plan
    })
}

/// A plan with limits, one without, and a heightfield.
pub fn plans() -> Vec<Plan> {
    let mut limited = sized("bench-outside", [70, 45]);
    limited.march.steps = Some(7);
    vec![
        limited,
        sized("mandelbox", [96, 54]),
        preset("terrain", &["scene.field=fbm:32x32", "image.size=[80, 45]"]),
    ]
}

#[test]
fn slices_and_what_was_begun_before_change_no_bit() {
    let mut renderer = adapter::open();
    let mut followed = sized("mandelbox", [70, 45]);
    (followed.samples, followed.until) = (8, 0.05);
    followed.look.mode = LightMode::Path;
    let plans = [&plans()[..], &sampled(), &[followed]].concat();
    let assets = Assets::default();
    let go = &mut |_: &_| true;
    let whole: Vec<_> = plans
        .iter()
        .map(|plan| bits(&renderer.render(plan, &assets, EVERYTHING, go).unwrap()))
        .collect();
    let mut random = Random::new(12);
    let (mut finished, mut dropped, mut changed) = (0, 0, 0);
    for _ in 0..90 {
        renderer.cutting = Cutting {
            block: [32, 64, 1024][random.index(3)],
            chunk: [1, 5, 64][random.index(3)],
        };
        let extras = Extras {
            shown: random.index(2) == 0,
            sketched: random.index(2) == 0,
            reuse: random.index(2) == 0,
            ..EVERYTHING
        };
        let mut which = random.index(plans.len());
        let mut work = renderer.begin(&plans[which], &assets, extras).unwrap();
        // A thread may prepare a plan for a while.
        let patience = [3, usize::MAX][random.index(2)];
        let began = Instant::now();
        let mut changes = random.index(3);
        let frame = (0..patience).find_map(|_| {
            if changes > 0 && random.index(3) == 0 {
                (which, changes, changed) = (random.index(plans.len()), changes - 1, changed + 1);
                renderer.set(&mut work, &plans[which], &assets).unwrap();
            }
            assert!(began.elapsed() < Duration::from_secs(60), "plan {which}");
            work.advance(10.0_f64.powf(random.between(-2.0, 2.0)))
                .unwrap();
            renderer.device.wait().unwrap();
            work.poll().unwrap()
        });
        match frame {
            Some(frame) => {
                finished += 1;
                // Not assert_eq: it would print a million numbers.
                assert!(
                    bits(&frame) == whole[which],
                    "plan {which}, {:?}",
                    renderer.cutting
                );
            }
            None => dropped += 1,
        }
    }
    assert!(
        finished > 30 && dropped > 5 && changed > 20,
        "{finished} finished, {dropped} dropped, {changed} changed"
    );
}

#[test]
fn a_second_frame_writes_parameters_and_creates_nothing() {
    let mut renderer = adapter::open();
    let assets = Assets::default();
    for mut plan in plans().into_iter().chain(sampled()) {
        let mut frame = |plan: &Plan| {
            let frame = renderer.render(plan, &assets, Extras::default(), &mut |_| true);
            frame.unwrap().traffic.unwrap()
        };
        let first = frame(&plan);
        assert!(first.allocations > 0);
        frame(&plan);
        for step in 1..4 {
            plan.camera.eye *= 1.0 + 1e-3 * f64::from(step);
            let again = frame(&plan);
            let expected = Traffic {
                uploads: again.uploads,
                submissions: again.submissions,
                ..Traffic::default()
            };
            assert_eq!(again, expected, "a frame from another eye");
            // The view, the scene's numbers and the light.
            assert!((1..2048).contains(&again.uploads), "{again:?}");
        }
    }
}

#[test]
fn the_device_never_waits_for_the_host() {
    let assets = Assets::default();
    for name in ["mandelbox-gate", "bench-thin", "terrain"] {
        let mut renderer = adapter::open();
        let mut plan = sized(name, [960, 540]);
        for frame in 0..4 {
            plan.camera.eye *= 1.0 + 1e-2 * f64::from(frame);
            let made = renderer.render(&plan, &assets, Extras::default(), &mut |_| true);
            let traffic = made.unwrap().traffic.unwrap();
            assert_eq!(traffic.drains, 0, "{name}, frame {frame}: {traffic:?}");
        }
    }
}

/// A change of a plan, and whether it keeps the colours and the rays.
type Change = (fn(&mut Plan), bool, bool);

#[test]
fn a_change_of_the_look_keeps_the_rays_and_one_of_the_exposure_the_colours() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let again = Extras {
        reuse: true,
        time: true,
        ..EVERYTHING
    };
    let changes: [Change; 5] = [
        (|_| (), true, true),
        (|plan| plan.look.key *= 0.5, false, true),
        (|plan| plan.look.exposure += 1.0, true, true),
        (|plan| plan.camera.fov += 0.1, false, false),
        (|plan| plan.camera.eye *= 1.01, false, false),
    ];
    for mut plan in plans() {
        renderer
            .render(&plan, &assets, again, &mut |_| true)
            .unwrap();
        for (change, keeps_colours, keeps_rays) in &changes {
            change(&mut plan);
            let frame = renderer
                .render(&plan, &assets, again, &mut |_| true)
                .unwrap();
            assert!(bits(&frame) == bits(&adapter::render(&plan, EVERYTHING)));
            let ran = |pass: &str| {
                let all = frame.passes.iter().filter(|p| p.pass.name() == pass);
                all.filter(|p| p.gpu_ms.is_some()).count() > 0
            };
            assert_eq!(ran("trace"), !keeps_rays, "{:?}", frame.passes);
            assert_eq!(ran("color"), !keeps_colours, "{:?}", frame.passes);
            if *keeps_colours {
                assert_eq!(frame.traffic.unwrap().submissions, 1);
            }
        }
    }
}

/// Radiance in a byte of each channel, as a PNG of 8 bits holds it.
pub fn bytes(plan: &Plan, frame: &Frame) -> Vec<u8> {
    let shades = Shades::new(Layer::Color, frame, plan).bytes();
    let pixel = |rgb: &[u8]| [rgb[0], rgb[1], rgb[2], 255];
    shades.chunks(3).flat_map(pixel).collect()
}

#[test]
fn the_picture_on_the_device_grows_into_that_of_the_file() {
    let (assets, shown) = (
        Assets::default(),
        Extras {
            shown: true,
            sketched: true,
            ..Extras::default()
        },
    );
    let with_cones = sampled().into_iter().take(1);
    for mut plan in plans().into_iter().chain(with_cones) {
        for (exposure, block) in [(0.0, 1024), (-3.0, 32), (2.5, 64)] {
            let mut renderer = adapter::open();
            renderer.cutting.block = block;
            plan.look.exposure = exposure;
            let mut work = renderer.begin(&plan, &assets, shown).unwrap();
            while work.picture().is_none() {
                work.advance(0.0).unwrap();
            }
            let mut seen = vec![work.pixels().unwrap()];
            let frame = (0..10_000).find_map(|_| {
                work.advance(1e-3).unwrap();
                seen.push(work.pixels().unwrap());
                work.poll().unwrap()
            });
            let wanted = bytes(&plan, &frame.unwrap());
            let wrong = |picture: &Vec<u8>| {
                let pairs = picture.iter().zip(&wanted);
                pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>()
            };
            assert_eq!(wrong(&work.pixels().unwrap()), 0, "{plan:?}");
            // At first it is black, and a sketch is nearer to the picture than that.
            let (first, sketched) = (wrong(&seen[0]), seen.iter().map(wrong));
            assert!(first > 0 && sketched.clone().any(|w| w > 0 && w < first / 2));
            // All blocks are sketched before the first one is finished.
            if block < 1024 {
                let reached = seen.iter().find(|picture| !picture.ends_with(&[0; 4]));
                let half = wanted.len() / 2;
                assert!(reached.unwrap()[..half] != wanted[..half], "{block}");
            }
        }
    }
}

#[test]
fn a_first_picture_comes_also_where_rays_have_no_cones() {
    let shown = Extras {
        shown: true,
        sketched: true,
        ..Extras::default()
    };
    for block in [1024, 64] {
        let mut plan = load("mandelbox", &[]).unwrap().plan.one_sample();
        plan.size = [320, 180];
        assert!(plan.resolved(shown, &Assets::default()).levels().is_empty());
        let mut renderer = adapter::open();
        renderer.cutting.block = block;
        let mut work = renderer.begin(&plan, &Assets::default(), shown).unwrap();
        // The first pictures of all blocks are no part of what is done.
        while work.picture().is_none() || work.progress().done == 0.0 {
            work.advance(1e-3).unwrap();
        }
        let pixels = work.pixels().unwrap();
        let lit = pixels.chunks(4).filter(|p| p[..3] != [0; 3]).count();
        assert!(
            4 * lit > pixels.chunks(4).count(),
            "{lit} of {}",
            pixels.len() / 4
        );
        let frame = work.finish(&mut |_| true).unwrap();
        assert!(bits(&frame) == bits(&adapter::render(&plan, Extras::default())));
    }
}

/// Whether cones pay changes on the way to a surface. The pictures are those of stills.
#[test]
fn a_flight_makes_no_buffer_and_compiles_nothing() {
    let live = Extras {
        shown: true,
        sketched: true,
        reuse: true,
        ..Extras::default()
    };
    for name in ["mandelbox", "bench-far", "mandelbox-gate"] {
        let mut renderer = adapter::open();
        let mut plan = load(name, &[]).unwrap().plan.one_sample();
        plan.size = [320, 180];
        let mut choices = BTreeSet::new();
        for nth in 0..30 {
            choices.insert(plan.resolved(live, &Assets::default()).levels().len());
            let frame = renderer.render(&plan, &Assets::default(), live, &mut |_| true);
            let frame = frame.unwrap();
            let traffic = frame.traffic.unwrap();
            let made = (traffic.allocations, traffic.compilations);
            assert!(nth == 0 || made == (0, 0), "{name}, frame {nth}: {made:?}");
            if nth == 0 || nth % 10 == 9 {
                let still = adapter::render(&plan, Extras::default());
                assert!(bits(&frame) == bits(&still), "{name}, frame {nth}");
            }
            let way = plan.camera.target - plan.camera.eye;
            plan.camera.eye += 0.03 * way;
        }
        assert_eq!(choices.len(), 2, "{name}: {choices:?}");
    }
}

#[test]
fn a_host_lends_its_device_and_a_render_moves_to_another_thread() {
    let adapters = Adapters::find();
    let (adapter, _) = adapters
        .choose(&Choice::Auto)
        .unwrap()
        .expect(adapter::NO_ADAPTER);
    // A window's device: what WebGPU promises, and no timestamps.
    let opened = pollster::block_on(adapter.request_device(&Default::default()));
    let (device, queue) = opened.unwrap();
    let mut renderer = Renderer::new(Device::adopt(adapter, device, queue, clock));
    let plan = sized("mandelbox", [96, 54]);
    let work = renderer.begin(&plan, &Assets::default(), EVERYTHING);
    let work = work.unwrap();
    let frame = std::thread::spawn(move || work.finish(&mut |_| true))
        .join()
        .unwrap();
    assert!(bits(&frame.unwrap()) == bits(&adapter::render(&plan, EVERYTHING)));
}

#[test]
fn a_painted_relief_with_four_cones_at_each_of_4096_x_4096_places_fits_too() {
    let field = "scene.field=checker:4096x4096";
    let changes = [
        field,
        "scene.tracer=quad",
        "scene.paint=quad",
        "image.size=[64, 36]",
    ];
    let plan = preset("terrain", &changes);
    let assets = Assets::default();
    // Narrow cones everywhere: to make the true ones takes minutes.
    let make = &mut |generator: Generator, heights: &Heights, _, _: &_| {
        Ok(ConeMap {
            kind: generator.kind(),
            size: heights.size(),
            wrap: heights.wrap(),
            offset: 0.0,
            ratios: vec![0.1; heights.data().len() * generator.channels()],
        })
    };
    plan.scene.prepare(&assets, make).unwrap();
    let mut renderer = Renderer::new(within_promised_limits());
    let frame = renderer.render(&plan, &assets, EVERYTHING, &mut |_| true);
    let frame = frame.unwrap();
    assert!(frame.traffic.unwrap().uploads > 5 * 4 * 4096 * 4096);
    assert!(frame.census()[0] < 64 * 36, "only sky");
}

/// A device with the limits that WebGPU promises.
pub fn within_promised_limits() -> Device {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto).unwrap();
    let (adapter, _) = chosen.expect(adapter::NO_ADAPTER);
    Device::open_with(adapter, Limits::default()).unwrap()
}

#[test]
fn every_preset_renders_within_the_limits_that_webgpu_promises() {
    let mut renderer = Renderer::new(within_promised_limits());
    let mut hits = 0;
    for (name, _) in BUILTIN {
        let mut plan = load(name, &[]).unwrap().plan;
        // With cones, and with samples that end early.
        (plan.size, plan.samples, plan.until) = ([64, 36], 9, 0.05);
        plan.march.coarsest = Some(16);
        let frame = renderer.render(&plan, &Assets::default(), EVERYTHING, &mut |_| true);
        let frame = frame.unwrap_or_else(|e| panic!("{name}: {e}"));
        hits += frame.census()[1];
    }
    assert!(hits > 10_000, "the pictures show nothing: {hits} hits");
    // In larger pictures that are shown on their way.
    let live = Extras {
        shown: true,
        sketched: true,
        reuse: true,
        ..Extras::default()
    };
    for name in ["terrain", "mandelbox-gate"] {
        let mut plan = load(name, &[]).unwrap().plan.one_sample();
        plan.size = [320, 180];
        plan.march.coarsest = Some(16);
        let frame = renderer.render(&plan, &Assets::default(), live, &mut |_| true);
        assert!(frame.unwrap().census()[1] > 10_000, "{name}");
    }
}
