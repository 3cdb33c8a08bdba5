use conemarch::formula::mandelbox::Mandelbox;
use conemarch::{compare::*, cpu, formula::*, gpu::device::*, mode::*, plan::*, render::*};
use glam::DVec3;
fn bench(name: &str) -> Plan {
    let (e, t, s) = match name {
        "far" => ((0., 0., -14.), (0., 0., 0.), 2.0),
        "outside" => ((4., 2.5, -6.), (0., 0., 0.), -1.5),
        "inside" => ((1., 0.4, -3.5), (0.2, 0.1, 0.), -1.5),
        "graze" => ((6.5, 6.4, -7.5), (0., 5.5, 0.), 2.0),
        _ => ((3., 3., -9.), (0., 0., 0.), 3.0),
    };
    let mut p = Plan::new(Subject::Distance {
        shape: Shape::Mandelbox(Mandelbox {
            scale: s,
            ..Default::default()
        }),
        iterations: None,
    });
    p.camera.eye = DVec3::new(e.0, e.1, e.2);
    p.camera.target = DVec3::new(t.0, t.1, t.2);
    p.camera.up = DVec3::Y;
    p.camera.fov = 48.5;
    p.size = [640, 360];
    p
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let ads = Adapters::find();
    let (ad, _) = ads.choose(&Choice::Auto).unwrap().unwrap();
    let mut r = Renderer::new(Device::open(ad).unwrap());
    let coarsest: u32 = a.get(1).map_or(16, |s| s.parse().unwrap());
    let shell: f64 = a.get(2).map_or(0.5, |s| s.parse().unwrap());
    let mut base = vec![];
    for name in ["far", "outside", "inside", "graze", "thin"] {
        let mut plan = bench(name);
        plan.march.coarsest = coarsest;
        plan.march.shell = shell;
        let file = format!("/tmp/truth-{name}.bin");
        let truth = if let Ok(b) = std::fs::read(&file) {
            let v: Vec<f32> = b
                .chunks(4)
                .map(|c| f32::from_le_bytes(c.try_into().unwrap()))
                .collect();
            let mut f = conemarch::frame::Frame {
                size: plan.size,
                ..Default::default()
            };
            f.state = v
                .iter()
                .map(|t| {
                    if t.is_infinite() {
                        0
                    } else if *t < 0.0 {
                        2
                    } else {
                        1
                    }
                })
                .collect();
            f.depth = v;
            f
        } else {
            let t0 = std::time::Instant::now();
            let t = truth(&plan, &mut |_| true).unwrap();
            println!(
                "truth {name} stride {} moved {} {:?} {:?}",
                t.stride,
                t.moved,
                t.frame.census(),
                t0.elapsed()
            );
            let v: Vec<u8> = t
                .frame
                .depth
                .iter()
                .zip(&t.frame.state)
                .flat_map(|(d, s)| (if *s == 2 { -1.0 } else { *d }).to_le_bytes())
                .collect();
            std::fs::write(file, v).unwrap();
            t.frame
        };
        let mut rayfig = (0.0, 0.0, 0.0);
        for mode in [Mode::Ray, Mode::RayRelaxed, Mode::Safe, Mode::SlidesDeep] {
            plan.march.mode = mode;
            let ex = Extras {
                count: true,
                levels: true,
                depth_only: true,
                ..Default::default()
            };
            let f = r.render(&plan, ex, &mut |_| true).unwrap();
            let rep = compare(&f, &truth, &plan.view());
            let (e, _) = f.work_per_pixel().unwrap();
            let ex = Extras {
                depth_only: true,
                ..Default::default()
            };
            let mut ms: Vec<f64> = (0..6)
                .map(|_| r.render(&plan, ex, &mut |_| true).unwrap().march_ms)
                .collect();
            ms.remove(0);
            ms.sort_by(f64::total_cmp);
            let bad = 100.0 * (rep.behind + rep.holes);
            if mode == Mode::Ray {
                rayfig = (e, ms[2], bad);
            }
            println!(
                "{name:8} {:12} e/px {e:6.2} ({:4.2}x) ms {:6.1} ({:4.2}x) behind+holes {bad:7.4} front {:.4} holes {:.4} false {:.4} unc {:.4} med {:.3} p99 {:.3} {:?}",
                mode.name(),
                rayfig.0 / e,
                ms[2],
                rayfig.1 / ms[2],
                100. * rep.front,
                100. * rep.holes,
                100. * rep.false_hits,
                100. * rep.unconverged,
                rep.depth_error[0],
                rep.depth_error[2],
                rep.start_violations
            );
            if mode == Mode::Safe {
                base.push((rayfig.0 / e, rayfig.1 / ms[2]));
                for p in &f.passes {
                    print!(
                        "   {} {:?}/{:.1}ms",
                        p.name,
                        p.evaluations.unwrap() as f64 / 230400.,
                        p.wall_ms
                    );
                }
                println!();
            }
        }
    }
    let g = |f: fn(&(f64, f64)) -> f64| (base.iter().map(|b| f(b).ln()).sum::<f64>() / 5.).exp();
    println!("geomean evals {:.2} time {:.2}", g(|b| b.0), g(|b| b.1));
    let _ = cpu::sample;
}
