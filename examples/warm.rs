#![allow(missing_docs)]
use conemarch::gpu::{
    adapters::{Adapters, Choice},
    device::Device,
    render::Renderer,
};
use conemarch::plan::Extras;
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let sets: Vec<Override> = args[2..]
        .iter()
        .map(|s| Override::read(s).unwrap())
        .collect();
    let mut plan = preset::load(std::path::Path::new(&args[1]), &sets)
        .unwrap()
        .plan;
    plan.size = [960, 540];
    plan.samples = 1;
    plan.until = 0.0;
    let adapters = Adapters::find();
    let (adapter, _) = adapters.choose(&Choice::Auto).unwrap().unwrap();
    let mut renderer = Renderer::new(Device::open(&adapter).unwrap());
    let assets = Assets::default();
    let mut all: Vec<Vec<(f64, f64)>> = vec![];
    let mut names = vec![];
    let mut subs = 0;
    let mut walls = vec![];
    for i in 0..13 {
        let t = std::time::Instant::now();
        let frame = renderer
            .render(
                &plan,
                &assets,
                Extras {
                    time: std::env::var("TIME").is_ok(),
                    shown: std::env::var("SHOWN").is_ok(),
                    unread: true,
                    ..Extras::default()
                },
                &mut |_| true,
            )
            .unwrap();
        if i < 4 {
            println!(
                "  {i} {:.1} {}",
                t.elapsed().as_secs_f64() * 1e3,
                frame
                    .passes
                    .iter()
                    .map(|p| format!(
                        "{} {:.1}/{:.1}",
                        p.pass.name(),
                        p.gpu_ms.unwrap_or(0.0),
                        p.wall_ms
                    ))
                    .collect::<Vec<_>>()
                    .join(" ")
            );
        }
        if i > 1 {
            walls.push(t.elapsed().as_secs_f64() * 1e3);
        }
        subs = frame.traffic.unwrap().submissions;
        names = frame.passes.iter().map(|p| p.pass.name()).collect();
        if i > 1 {
            all.push(
                frame
                    .passes
                    .iter()
                    .map(|p| (p.gpu_ms.unwrap_or(0.0), p.wall_ms))
                    .collect(),
            );
        }
    }
    for (k, n) in names.iter().enumerate() {
        let mut g: Vec<f64> = all.iter().map(|f| f[k].0).collect();
        g.sort_by(f64::total_cmp);
        let mut w: Vec<f64> = all.iter().map(|f| f[k].1).collect();
        w.sort_by(f64::total_cmp);
        print!(
            "{n} gpu {:.1} wall {:.1} | ",
            g[g.len() / 2],
            w[w.len() / 2]
        );
    }
    walls.sort_by(f64::total_cmp);
    println!("subs {subs} frame {:.1}", walls[walls.len() / 2]);
}
