#![allow(missing_docs)]
use conemarch::gpu::{
    adapters::{Adapters, Choice},
    device::Device,
    render::Renderer,
};
use conemarch::plan::Extras;
use conemarch::preset;
use conemarch::preview::pictures::Pictures;
use conemarch::scene::Assets;
use std::time::{Duration, Instant};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let mut plan = preset::load(std::path::Path::new(&args[1]), &[])
        .unwrap()
        .plan;
    plan.size = [960, 540];
    plan.samples = 1;
    plan.until = 0.0;
    plan.tracks.clear();
    let adapters = Adapters::find();
    let (adapter, _) = adapters.choose(&Choice::Auto).unwrap().unwrap();
    let device = std::sync::Arc::new(Device::open(&adapter).unwrap());
    let mut renderer = Renderer::sharing(device.clone());
    let mut second = Renderer::sharing(device.clone());
    let mut third = Renderer::sharing(device.clone());
    let assets = Assets::default();
    let mut pics = Pictures::new(device.clone());
    pics.assets = assets.clone();
    pics.keep(
        Extras {
            unread: true,
            ..Extras::default()
        },
        true,
    );
    let mut rows = vec![];
    for i in 0..25 {
        plan.camera.eye *= 1.001;
        pics.want(&plan);
        pics.moving = false;
        let t = Instant::now();
        let mut small = 0.0;
        let mut turns = 0;
        let mut inside = 0.0;
        let mut longest = 0.0f64;
        loop {
            let u = Instant::now();
            let f = pics.advance().unwrap();
            turns += 1;
            let e = u.elapsed().as_secs_f64() * 1e3;
            inside += e;
            longest = longest.max(e);
            if f && !pics.is_full() {
                small = t.elapsed().as_secs_f64() * 1e3;
            }
            if pics.is_full() {
                break;
            }
            std::thread::sleep(Duration::from_micros(500));
        }
        let full = t.elapsed().as_secs_f64() * 1e3;
        let u = Instant::now();
        renderer
            .render(
                &plan,
                &assets,
                Extras {
                    time: false,
                    ..Extras::default()
                },
                &mut |_| true,
            )
            .unwrap();
        let r = u.elapsed().as_secs_f64() * 1e3;
        let u = Instant::now();
        second
            .render(
                &plan,
                &assets,
                Extras {
                    unread: true,
                    shown: true,
                    ..Extras::default()
                },
                &mut |_| true,
            )
            .unwrap();
        let _ = &u;
        let q = u.elapsed().as_secs_f64() * 1e3;
        let u = Instant::now();
        third
            .render(
                &plan,
                &assets,
                Extras {
                    unread: true,
                    ..Extras::default()
                },
                &mut |_| true,
            )
            .unwrap();
        let q2 = u.elapsed().as_secs_f64() * 1e3;
        if i > 4 {
            rows.push([small, full, inside, longest, r, q, q2, turns as f64]);
        }
    }
    for (k, n) in [
        "small", "full", "inside", "longest", "render", "shown", "unread", "turns",
    ]
    .iter()
    .enumerate()
    {
        let mut v: Vec<f64> = rows.iter().map(|r| r[k]).collect();
        v.sort_by(f64::total_cmp);
        print!("{n} {:.1}  ", v[v.len() / 2]);
    }
    println!();
}
