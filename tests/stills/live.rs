//! What a window needs of a render: another plan in the middle, a device that is lost, and what there
//! is under the cursor.

use std::collections::BTreeSet;
use std::sync::Arc;

use conemarch::base::clock::clock;
use conemarch::base::key::Redo;
use conemarch::base::outcome::State;
use conemarch::gpu::RenderError;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::{Device, DeviceError};
use conemarch::gpu::render::Renderer;
use conemarch::pass::features::LookFeature;
use conemarch::pass::pick::{At, Picked};
use conemarch::plan::{Extras, Plan};
#[cfg(feature = "preview")]
use conemarch::preview::pictures::Pictures;
use conemarch::scene::Assets;
use glam::DVec3;
use toml::Value;

use super::common::plans::{allow, preset, sized, switch};
use super::work::{bits, plans, within_promised_limits};
use crate::adapter::{self, EVERYTHING};

pub fn whole(renderer: &mut Renderer, plan: &Plan) -> Result<Vec<u32>, RenderError> {
    let frame = renderer.render(plan, &Assets::default(), EVERYTHING, &mut |_| true);
    frame.map(|frame| bits(&frame))
}

#[test]
fn another_plan_in_the_middle_discards_what_was_submitted() {
    let (mut renderer, assets, go) = (adapter::open(), Assets::default(), &mut |_: &_| true);
    let wanted: Vec<_> = plans()
        .iter()
        .map(|plan| whole(&mut adapter::open(), plan).unwrap())
        .collect();
    for (from, to) in [(0, 1), (1, 2), (2, 0), (1, 1)] {
        for slices in 0..6 {
            let mut work = renderer.begin(&plans()[from], &assets, EVERYTHING).unwrap();
            for _ in 0..slices {
                work.advance(0.1).unwrap();
            }
            renderer.set(&mut work, &plans()[to], &assets).unwrap();
            let frame = work.finish(go).unwrap();
            assert!(bits(&frame) == wanted[to], "{from} to {to} after {slices}");
        }
    }
    // A plan that cannot be rendered leaves the work as it was.
    let mut work = renderer.begin(&plans()[1], &assets, EVERYTHING).unwrap();
    work.advance(0.1).unwrap();
    let missing = preset("terrain", &["scene.field=no-such-file.png"]);
    renderer.set(&mut work, &missing, &assets).unwrap();
    let error = loop {
        if let Err(error) = work.advance(0.1) {
            break error.to_string();
        }
    };
    assert!(error.contains("no-such-file.png"), "{error}");
    assert!(bits(&work.finish(go).unwrap()) == wanted[1]);
}

/// Other values for a key: of a switch, a number, a word or a list.
fn others(now: &Value, expects: &str) -> Vec<Value> {
    let scaled = |x: &Value| match x {
        Value::Integer(n) => Value::Integer(n * 7 / 8),
        Value::Float(x) => Value::Float(0.9 * x + 0.01),
        other => other.clone(),
    };
    let words = expects.split('"').skip(1).step_by(2);
    let words = words.map(|word| Value::String(word.into()));
    let own = match now {
        Value::Boolean(b) => vec![Value::Boolean(!b)],
        Value::Array(list) => vec![Value::Array(list.iter().map(scaled).collect())],
        Value::String(_) => vec![
            Value::String("other".into()),
            Value::String("fbm:32x32,seed=3".into()),
            Value::Integer(9),
            Value::Float(0.9),
        ],
        number => vec![scaled(number), Value::Float(0.0)],
    };
    let all = own.into_iter().chain(words.take(3));
    all.filter(|value| value != now).collect()
}

#[test]
fn a_new_value_makes_no_more_again_than_its_key_says() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let extras = Extras {
        time: true,
        reuse: true,
        shown: true,
        sketched: true,
        ..Extras::default()
    };
    let mut render = |plan: &Plan| renderer.render(plan, &assets, extras, &mut |_| true);
    let mut anew = adapter::open();
    let shown = Extras {
        shown: true,
        sketched: true,
        ..Extras::default()
    };
    let mut anew = |plan: &Plan| {
        let frame = anew.render(plan, &assets, shown, &mut |_| true);
        bits(&frame.unwrap())
    };
    // Cones that come and go with the plan.
    for sets in [&[][..], &["march.coarsest=16"], &["march.mode=calibrated"]] {
        let plan = preset("bench-far", &[sets, &["image.size=[320, 180]"]].concat());
        assert!(bits(&render(&plan).unwrap()) == anew(&plan), "{sets:?}");
    }
    let (mut seen, mut wrong) = (BTreeSet::new(), Vec::new());
    let all: &[&str] = &["", "scene", "camera", "march", "look", "image"];
    // With several samples, a lens and samples that end early need other programs.
    let mut many = sized("mandelbox", [64, 36]);
    many.samples = 9;
    let some: &[&str] = &["camera", "look", "image"];
    let bases = plans().into_iter().skip(1).map(|base| (base, all));
    for (base, sections) in &bases.chain([(many, some)]).collect::<Vec<_>>() {
        for section in *sections {
            let list = |plan: &mut Plan| plan.keys(section).unwrap().len();
            for index in 0..list(&mut base.clone()) {
                let mut copy = base.clone();
                let key = &copy.keys(section).unwrap()[index];
                let (name, redo) = (key.name, key.redo.unwrap());
                for value in others(&key.slot.get(), &key.slot.expects()) {
                    let mut plan = base.clone();
                    let fits = plan.keys(section).unwrap()[index].slot.set(&value).is_ok();
                    if !fits || plan.check().is_err() {
                        continue;
                    }
                    render(base).unwrap();
                    let missing = !plan.scene.has_assets(&assets);
                    let Ok(frame) = render(&plan) else { continue };
                    if bits(&frame) != anew(&plan) {
                        wrong.push(format!("{section}.{name} = {value}: other bits"));
                    }
                    let traffic = frame.traffic.unwrap();
                    let ran = |pass: &str| {
                        let mut all = frame.passes.iter();
                        all.any(|p| p.pass.name() == pass && p.gpu_ms.is_some())
                    };
                    let found = match () {
                        () if missing => Redo::Assets,
                        () if traffic.compilations > 0 => Redo::Program,
                        () if ran("trace") => Redo::March,
                        () if ran("color") => Redo::Color,
                        () if traffic.uploads > 0 => Redo::Tone,
                        () => Redo::Nothing,
                    };
                    let keeps_rays = base.samples == 1;
                    let again = keeps_rays && *section == "look" && ran("trace");
                    // Of several samples, the sum of the colours is kept, and no rays are.
                    let most = match redo {
                        Redo::Color if !keeps_rays => Redo::March,
                        redo => redo,
                    };
                    if found > most || again {
                        wrong.push(format!("{section}.{name} = {value}: {found:?}"));
                    }
                    seen.extend((found == redo).then_some(redo));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(seen.len(), 6, "{seen:?}");
}

#[test]
fn a_lost_device_is_opened_again() {
    let (mut renderer, assets, go) = (adapter::open(), Assets::default(), &mut |_: &_| true);
    let plan = &plans()[1];
    let wanted = whole(&mut renderer, plan).unwrap();
    for slices in 0..4 {
        let mut work = renderer.begin(plan, &assets, EVERYTHING).unwrap();
        for _ in 0..slices {
            work.advance(0.1).unwrap();
        }
        renderer.device.device.destroy();
        let error = work.finish(go).unwrap_err();
        assert!(matches!(
            error,
            RenderError::Device(DeviceError::Lost { .. })
        ));
        assert!(whole(&mut renderer, plan).unwrap() == wanted);
    }
    // A host opens its device itself.
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto).unwrap();
    let (adapter, _) = chosen.expect(adapter::NO_ADAPTER);
    let opened = pollster::block_on(adapter.request_device(&Default::default()));
    let (device, queue) = opened.unwrap();
    let mut lent = Renderer::new(Device::adopt(adapter, device, queue, clock));
    // An error of the host itself is no reason to stop.
    let _wrong = lent.device.device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 3,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    assert!(lent.device.check().is_err());
    assert!(whole(&mut lent, plan).unwrap() == wanted);
    lent.device.device.destroy();
    let is_loss = |e: &RenderError| matches!(e, RenderError::Device(DeviceError::Lost { .. }));
    for _ in 0..2 {
        let error = whole(&mut lent, plan).unwrap_err();
        assert!(is_loss(&error), "{error}");
    }
    // A work in flight says it first, and not what follows from it.
    let mut renderer = adapter::open();
    let large = preset("mandelbox", &["image.size=[640, 360]"]);
    whole(&mut renderer, &large).unwrap();
    let mut work = renderer.begin(&large, &assets, EVERYTHING).unwrap();
    work.advance(40.0).unwrap();
    renderer.device.device.destroy();
    let error = loop {
        if let Err(error) = work.advance(1.0).and_then(|()| work.poll()) {
            break error;
        }
    };
    assert!(is_loss(&error), "{error}");
    assert!(whole(&mut renderer, plan).unwrap() == wanted);
}

#[test]
fn heights_that_do_not_fit_are_an_error_and_the_next_frame_is_right() {
    let mut renderer = Renderer::new(within_promised_limits());
    let large = preset("terrain", &["scene.field=checker:8192x8192"]);
    let error = whole(&mut renderer, &large).unwrap_err().to_string();
    assert!(error.contains("`heights` needs 256 MiB"), "{error}");
    let plan = &plans()[1];
    let wanted = whole(&mut adapter::open(), plan).unwrap();
    assert!(whole(&mut renderer, plan).unwrap() == wanted);
}

/// Goes on until there is nothing to do, and gives the full picture.
#[cfg(feature = "preview")]
fn full(pictures: &mut Pictures) -> Result<Vec<u32>, RenderError> {
    while pictures.is_busy() {
        pictures.advance()?;
    }
    let finished = pictures.finished().filter(|finished| finished.is_full);
    Ok(bits(finished.expect("a full picture").frame))
}

#[cfg(feature = "preview")]
#[test]
fn a_plan_that_fails_is_tried_once_and_again_after_a_change() {
    let mut pictures = Pictures::new(Arc::new(within_promised_limits()));
    let large = preset("terrain", &["scene.field=checker:8192x8192"]);
    for _ in 0..2 {
        pictures.want(&large);
        let error = full(&mut pictures).unwrap_err().to_string();
        assert!(error.contains("`heights` needs 256 MiB"), "{error}");
        for _ in 0..3 {
            pictures.want(&large);
            assert!(!pictures.is_busy());
            assert!(matches!(pictures.advance(), Ok(false)));
        }
        // Other texts of shaders may do.
        pictures.again();
    }
    let plan = &plans()[1];
    pictures.keep(EVERYTHING, false);
    pictures.want(plan);
    assert!(!full(&mut pictures).unwrap().is_empty());
}

#[cfg(feature = "preview")]
#[test]
fn pictures_on_a_device_that_was_opened_again_are_the_same() {
    let plan = &plans()[1];
    let shown = |pictures: &mut Pictures| {
        pictures.keep(EVERYTHING, false);
        pictures.want(plan);
        full(pictures)
    };
    let mut pictures = Pictures::new(adapter::open().device);
    let wanted = shown(&mut pictures).unwrap();
    // At rest too, a loss is told.
    pictures.renderer.device.device.destroy();
    let error = pictures.advance().unwrap_err();
    let RenderError::Device(DeviceError::Lost { .. }) = error else {
        panic!("{error}");
    };
    let mut again = Pictures::new(adapter::open().device);
    again.assets = pictures.assets.clone();
    assert!(shown(&mut again).unwrap() == wanted);
}

fn picked(renderer: &mut Renderer, plan: &Plan, at: At) -> Picked {
    let mut pick = renderer.pick(plan, &Assets::default(), at).unwrap();
    loop {
        if let Some(picked) = pick.poll().unwrap() {
            return picked;
        }
    }
}

#[test]
fn what_is_picked_is_what_the_picture_shows() {
    let mut renderer = adapter::open();
    let mut seen = [0; 2];
    for plan in plans().into_iter().skip(1) {
        let frame = adapter::on_cpu(&plan, Extras::default());
        for (i, state) in frame.state.iter().enumerate().step_by(97) {
            let width = plan.size[0];
            let pixel = [i as u32 % width, i as u32 / width];
            let found = picked(&mut renderer, &plan, At::Pixel(pixel));
            let Some(found_state) = found.state else {
                panic!("a pixel has a state")
            };
            // The edges of shapes may differ between the executors.
            if found_state == State::Sky {
                assert_eq!(found.distance, f64::INFINITY);
            }
            if *state != State::Hit as u8 || found_state != State::Hit {
                seen[0] += usize::from(found_state as u8 == *state);
                continue;
            }
            let depth = f64::from(frame.depth[i]);
            let ray = plan.view().view_ray(pixel);
            let place = plan.camera.eye + depth * ray.axis;
            let near = 2.0 * ray.grain * depth + 1e-5 * depth;
            assert!(
                (found.distance - depth).abs() < near,
                "{pixel:?}: {found:?}"
            );
            assert!((found.position - place).length() < near, "{found:?}");
            // Next to the surface there is no room, and at the eye there is.
            assert!(found.clearance < near, "{found:?}");
            seen[1] += 1;
        }
        let eye = plan.camera.eye;
        let at_eye = picked(&mut renderer, &plan, At::Point(eye));
        assert_eq!((at_eye.state, at_eye.distance), (None, 0.0));
        assert!(at_eye.clearance > 0.1, "{at_eye:?}");
        let nearest = frame.depth.iter().copied().fold(f32::INFINITY, f32::min);
        // A hit lies up to its threshold, half a pixel here, before the surface.
        let threshold = 1e-4 * f64::from(nearest);
        assert!(at_eye.clearance < f64::from(nearest) + threshold);
        let aside = eye + DVec3::new(0.25, -0.5, 1.0);
        let found = picked(&mut renderer, &plan, At::Point(aside));
        assert!((found.position - aside).length() < 1e-5);
    }
    assert!(seen.iter().all(|n| *n > 10), "{seen:?}");
}

#[test]
fn a_number_that_passes_through_zero_compiles_nothing() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let extras = Extras {
        reuse: true,
        held: true,
        ..EVERYTHING
    };
    let is_neutral = |f: &&LookFeature| f.module(true).replaces.is_some();
    let neutral = LookFeature::ALL.iter().filter(is_neutral);
    for feature in neutral.clone() {
        let mut plan = preset("mandelbox", &["image.size=[64, 36]"]);
        allow(&mut plan, *feature);
        neutral.clone().for_each(|f| switch(&mut plan, *f, true));
        renderer
            .render(&plan, &assets, extras, &mut |_| true)
            .unwrap();
        switch(&mut plan, *feature, false);
        let frame = renderer.render(&plan, &assets, extras, &mut |_| true);
        let frame = frame.unwrap();
        let traffic = frame.traffic.unwrap();
        assert_eq!(
            (traffic.compilations, traffic.allocations),
            (0, 0),
            "{feature:?}"
        );
        // Another program may round otherwise, and the own one has the bits of the file.
        let alone = Extras {
            held: false,
            ..extras
        };
        let own = renderer
            .render(&plan, &assets, alone, &mut |_| true)
            .unwrap();
        assert!(bits(&own) == whole(&mut adapter::open(), &plan).unwrap());
        assert_eq!(frame.depth, own.depth);
        let pairs = frame
            .radiance
            .iter()
            .flatten()
            .zip(own.radiance.iter().flatten());
        let off = pairs.map(|(a, b)| (a - b).abs() / b.max(1e-3));
        assert!(off.fold(0.0, f32::max) < 1e-5, "{feature:?}");
    }
}

/// The picture of a held program differs from that of the own one only as another safe program's
/// does: without a rotation, other steps are proven.
#[test]
fn a_rotation_or_a_lens_that_passes_through_zero_compiles_nothing() {
    let held = Extras {
        held: true,
        ..EVERYTHING
    };
    for (on, off) in [
        (
            "scene.rotation=[10.0, -20.0, 30.0]",
            "scene.rotation=[0.0, 0.0, 0.0]",
        ),
        ("camera.aperture=0.02", "camera.aperture=0.0"),
    ] {
        for julia in [false, true] {
            let mut renderer = adapter::open();
            let julia = format!("scene.julia={julia}");
            let plan = |setting| {
                let settings = ["image.size=[64, 36]", "image.samples=2", &julia, setting];
                preset("mandelbox", &settings)
            };
            whole(&mut renderer, &plan(on)).unwrap();
            let frame = renderer.render(&plan(off), &Assets::default(), held, &mut |_| true);
            let frame = frame.unwrap();
            assert_eq!(frame.traffic.unwrap().compilations, 0, "{off}");
            let own = renderer.render(&plan(off), &Assets::default(), EVERYTHING, &mut |_| true);
            let own = own.unwrap();
            let pairs = frame.depth.iter().zip(&own.depth);
            let off_by = |(a, b): (&f32, &f32)| (a - b).abs() > 0.01 * b;
            let far = pairs.filter(|pair| off_by(*pair)).count();
            assert!(far < 64 * 36 / 100, "{far} depths, {off}");
        }
    }
}
