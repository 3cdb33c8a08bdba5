use conemarch::{frame::Work, plan::*, scene::*};
#[path = "scratch_plans.rs"]
mod plans;
fn main() {
    for (name, px) in [
        ("far", [250u32, 120u32]),
        ("far", [301, 171]),
        ("far", [60, 50]),
        ("thin", [300, 200]),
    ] {
        let mut plan = plans::plan(name);
        plan.march.mode = conemarch::mode::Mode::Ray;
        let view = plan.view();
        let Scene::Distance(d) = plan.scene() else {
            panic!()
        };
        let ray = view.view_ray(px);
        println!(
            "{name} {px:?} iterations {} interval {:?} fp at 8: {}",
            d.iterations,
            d.bounds_interval(&ray, 0.0),
            ray.grain * 8.0
        );
        let mut w = Work::default();
        let mut walk = d.begin(&ray, 0.0, d.bounds_far(), &mut w);
        for _ in 0..60 {
            let s = d.walk_step(&ray, &mut walk, &mut w);
            let t = d.walk_hit(&walk).t;
            let p = plan.camera.eye + ray.at(t);
            print!(
                "  t {t:.5} p {:.3} {:.3} {:.3} est {:.5} {s:?};",
                p.x,
                p.y,
                p.z,
                d.shape.estimate(p, d.iterations).0
            );
            if s != Step::Moving {
                break;
            }
        }
        println!();
        // estimate approaching the face from outside
        for dt in [4.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01] {
            let t = d.bounds_interval(&ray, 0.0).0 - dt;
            let p = plan.camera.eye + ray.at(t);
            print!(" [{dt}: {:.4}]", d.shape.estimate(p, d.iterations).0);
        }
        println!();
    }
}
