//! Plans that come while the maps of another one are made, which would take minutes.

use std::thread::sleep;
use std::time::{Duration, Instant};

use conemarch::gpu::render::Renderer;
use conemarch::gpu::work::Work;
use conemarch::pass::pick::At;
use conemarch::plan::{Extras, Plan};
#[cfg(feature = "preview")]
use conemarch::preview::pictures::Pictures;
use conemarch::scene::Assets;

use super::common::plans::{preset, sized};
use super::work::bits;
use crate::adapter::{self, EVERYTHING, finish};

/// Far longer than anything here takes but a slow map.
const SOON: Duration = Duration::from_secs(20);

fn slow(nth: u32) -> Plan {
    let field = format!("scene.field=sine:2048x{}", 2048 - nth);
    let changes = [&field, "scene.tracer=quad", "image.size=[64, 36]"];
    preset("terrain", &changes)
}

/// A work whose cone map is being made.
fn begun(renderer: &mut Renderer, assets: &Assets) -> Work {
    let work = renderer.begin(&slow(1), assets, EVERYTHING).unwrap();
    let began = Instant::now();
    while !work.progress().pass.starts_with("cone map") {
        assert!(began.elapsed() < SOON, "{:?}", work.progress());
        sleep(Duration::from_millis(2));
    }
    work
}

#[test]
fn a_renderer_that_is_dropped_before_its_work_stops_the_map() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let mut work = begun(&mut renderer, &assets);
    let began = Instant::now();
    drop(renderer);
    assert!(began.elapsed() < SOON);
    assert!(work.advance(1.0).is_err());
}

#[test]
fn another_plan_need_not_wait_for_the_map_of_the_last() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let run = sized("mandelbox", [64, 36]);
    let mut work = renderer.begin(&run, &assets, EVERYTHING).unwrap();
    finish(&mut work);
    let began = Instant::now();
    for nth in 1..20 {
        renderer.set(&mut work, &slow(nth), &assets).unwrap();
        sleep(Duration::from_millis(5));
    }
    let other = preset("terrain", &["image.size=[64, 36]"]);
    renderer.set(&mut work, &other, &assets).unwrap();
    let frame = finish(&mut work);
    assert!(began.elapsed() < SOON);
    assert!(bits(&frame) == bits(&adapter::render(&other, EVERYTHING)));
}

/// Before there is any picture too.
#[test]
fn the_first_plan_need_not_be_rendered() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let mut work = begun(&mut renderer, &assets);
    let began = Instant::now();
    let other = preset("terrain", &["image.size=[64, 36]"]);
    renderer.set(&mut work, &other, &assets).unwrap();
    finish(&mut work);
    assert!(began.elapsed() < SOON);
}

#[test]
fn a_pick_makes_the_maps_that_are_missing_and_stops_when_it_is_dropped() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let plan = preset("terrain", &["image.size=[64, 36]"]);
    let mut pick = renderer.pick(&plan, &assets, At::Pixel([32, 30])).unwrap();
    let picked = loop {
        if let Some(picked) = pick.poll().unwrap() {
            break picked;
        }
    };
    let frame = adapter::render(&plan, Extras::default());
    let depth = f64::from(frame.depth[30 * 64 + 32]);
    assert!(
        (picked.distance - depth).abs() < 1e-4 * depth,
        "{picked:?} {depth}"
    );
    let began = Instant::now();
    drop(
        renderer
            .pick(&slow(1), &assets, At::Pixel([32, 30]))
            .unwrap(),
    );
    drop(renderer);
    assert!(began.elapsed() < SOON);
}

#[cfg(feature = "preview")]
#[test]
fn a_window_leaves_a_plan_whose_map_takes_long() {
    let before = preset("terrain", &["image.size=[64, 36]"]);
    for before in [Some(&before), None] {
        let mut pictures = Pictures::new(adapter::open().device);
        let began = Instant::now();
        let mut show = |plan: &Plan, until: &dyn Fn(&Pictures) -> bool| {
            pictures.want(plan);
            while !until(&pictures) {
                pictures.advance().unwrap();
                assert!(began.elapsed() < SOON);
            }
        };
        if let Some(plan) = before {
            show(plan, &Pictures::is_full);
        }
        show(&slow(1), &|pictures| {
            let progress = pictures.progress().unwrap_or_default();
            progress.pass.starts_with("cone map")
        });
        // Ctrl+Z, or another preset.
        let after = before
            .cloned()
            .unwrap_or_else(|| sized("mandelbox", [64, 36]));
        show(&after, &Pictures::is_full);
    }
}
