//! What single settings cost: `cargo bench --bench switches`.
//!
//! Renders the default preset and the same with one setting changed, in turn, and prints the
//! ratios of the median times for march and trace, and for colour. A feature costs nothing if
//! its ratio is 1 while it is off.

use anyhow::{Result, bail};
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use conemarch::preset;
use conemarch::scene::Assets;
use conemarch::scene::distance_settings::DistanceSettings;

/// A changed setting: its name, and a function that changes it.
type Switch = (&'static str, fn(&mut Plan, &mut Extras));

const SWITCHES: &[Switch] = &[
    ("nothing changed", |_, _| {}),
    ("shadow off", |p, _| p.look.shadow = false),
    ("occlusion off", |p, _| p.look.occlusion = 0.0),
    ("fog on", |p, _| p.look.fog = 0.3),
    ("normals kept", |_, e| e.normals = true),
    ("work counted", |_, e| e.count = true),
    ("levels kept", |_, e| e.levels = true),
    ("relaxation off", |p, _| {
        p.march.relaxation = conemarch::scene::stepping::Relaxation::Off;
    }),
    ("cones from 1/16", |p, _| p.march.coarsest = Some(16)),
    ("cones from 1/32", |p, _| p.march.coarsest = Some(32)),
    ("cones from 1/8", |p, _| p.march.coarsest = Some(8)),
    ("rotation by 0", |p, _| rotate(p, 0.0)),
    ("rotation by 1 degree", |p, _| rotate(p, 1.0)),
];

/// Warm runs, of which the median is taken.
const RUNS: usize = 21;

fn rotate(plan: &mut Plan, degrees: f64) {
    use conemarch::{formula::Formula, scene::Scene};
    if let Scene::Distance(DistanceSettings {
        formula: Formula::Mandelbox(mandelbox),
        ..
    }) = &mut plan.scene
    {
        mandelbox.rotation.z = degrees;
    }
}

fn main() -> Result<()> {
    let mut plan = preset::load("mandelbox", &[])?.plan.one_sample();
    plan.size = [640, 360];
    let (mut executor, who) = Executor::open(&Choice::Auto)?;
    println!("Switches of `mandelbox` at 640 x 360 on {who}\n");
    println!("| switch | march and trace | colour |\n|---|---:|---:|");
    for (name, change) in SWITCHES {
        let (mut changed, mut extras) = (plan.clone(), Extras::default());
        change(&mut changed, &mut extras);
        let mut ratios = [Vec::new(), Vec::new()];
        // The first run compiles.
        for run in 0..=RUNS {
            let base = times(&executor.render(
                &plan,
                &Assets::default(),
                Extras::default(),
                &mut |_| true,
            )?);
            let other =
                times(&executor.render(&changed, &Assets::default(), extras, &mut |_| true)?);
            if run > 0 {
                for i in 0..2 {
                    ratios[i].push(other[i] / base[i]);
                }
            }
        }
        let [march, color] = ratios.map(|mut r| {
            r.sort_by(f64::total_cmp);
            r[r.len() / 2]
        });
        if !(march.is_finite() && color.is_finite()) {
            bail!("{name}: the clock measured no time for a pass");
        }
        println!("| {name} | {march:.2} | {color:.2} |");
    }
    Ok(())
}

/// Milliseconds of march and trace, and of colour.
fn times(frame: &Frame) -> [f64; 2] {
    let color = frame.passes.last().map_or(0.0, |p| p.wall_ms);
    [frame.march_ms, color]
}
