use conemarch::{gpu::device::*, mode::Mode, plan::*, render::*};
#[path = "scratch_plans.rs"]
mod plans;
fn main() {
    let ads = Adapters::find();
    let (ad, _) = ads.choose(&Choice::Auto).unwrap().unwrap();
    let mut r = Renderer::new(Device::open(ad).unwrap());
    for name in ["far", "outside", "graze"] {
        for mode in [Mode::Ray, Mode::Safe] {
            for chunk in [256] {
                r.cutting.chunk = chunk;
                let mut plan = plans::plan(name);
                plan.march.mode = mode;
                let ex = Extras {
                    depth_only: true,
                    time: true,
                    ..Default::default()
                };
                let mut best: Option<conemarch::frame::Frame> = None;
                for _ in 0..5 {
                    let f = r.render(&plan, ex, &mut |_| true).unwrap();
                    if best.as_ref().is_none_or(|b| f.march_ms < b.march_ms) {
                        best = Some(f);
                    }
                }
                let f = best.unwrap();
                print!(
                    "{name} {} chunk {chunk}: total {:.1}",
                    mode.name(),
                    f.march_ms
                );
                for p in &f.passes {
                    print!("  {} {:.1}/{:.1}", p.name, p.wall_ms, p.gpu_ms.unwrap());
                }
                println!();
            }
        }
    }
}
