//! What single settings cost: `cargo bench --bench switches`.
//!
//! Renders the default preset and the same with one setting changed, in turn, and prints the
//! ratios of the median times for march and trace, and for colour. A feature costs nothing if
//! its ratio is 1 while it is off. Then it prints the times of whole processes by samples.

use std::process::Command;
use std::time::Instant;

use anyhow::{Result, bail, ensure};
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use conemarch::scene::distance_settings::DistanceSettings;

/// A changed setting: its name, and a function that changes it. The preset is compared without fog.
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

/// Features with the keys that put them on, over four samples.
const FEATURES: &[(&str, &[&str])] = &[
    ("nothing changed", &[]),
    (
        "details of features that are off",
        &[
            "look.glow_width=0.1",
            "look.lamp_at=[2, -5, 4]",
            "look.fog_height=0.1",
            "look.shafts=1",
            "look.emission_width=0.5",
            "look.layer2_weight=0.9",
            "camera.blades=6",
        ],
    ),
    ("lens", &["camera.aperture=0.004"]),
    (
        "fog that thins out with height",
        &["look.fog=0.3", "look.fog_height=0.1"],
    ),
    ("fog and shafts", &["look.fog=0.3", "look.shafts=1"]),
    ("glow of the air", &["look.glow=0.5"]),
    ("glow of the surface", &["look.emission=2"]),
    ("a lamp", &["look.lamp=1"]),
    (
        "three lamps",
        &["look.lamp=1", "look.lamp2=1", "look.lamp3=1"],
    ),
    ("another trap", &["look.trap=\"sphere\""]),
    ("a second layer", &["look.layer2_trap=\"plane\""]),
    ("no sky", &["image.background=\"transparent\""]),
];

/// The same of light by paths with two bounces.
const PATHS: &[(&str, &[&str])] = &[
    ("nothing changed", &[]),
    (
        "details of features that are off",
        &[
            "look.glow_width=0.1",
            "look.lamp_at=[2, -5, 4]",
            "look.shafts=1",
            "look.emission_width=0.5",
            "camera.blades=6",
        ],
    ),
    (
        "features that only quick light has",
        &["look.shadow=false", "look.occlusion=0.3"],
    ),
    ("fog", &["look.fog=0.3"]),
    ("fog and shafts", &["look.fog=0.3", "look.shafts=1"]),
    ("a lamp", &["look.lamp=1"]),
    ("no bounce", &["look.bounces=0"]),
    ("8 bounces", &["look.bounces=8"]),
    ("quick light", &["look.mode=\"quick\""]),
];
const PATH: &[&str] = &["look.mode=\"path\"", "look.bounces=2"];

/// Warm runs, of which the median is taken.
const RUNS: usize = 21;
/// The same of features, which take longer.
const FEATURE_RUNS: usize = 7;
/// Processes, of which the median is taken.
const PROCESSES: usize = 3;

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
    plan.look.fog = 0.0;
    plan.size = [640, 360];
    let (mut executor, who) = Executor::open(&Choice::Auto)?;
    println!("Switches of `mandelbox` without fog at 640 x 360 on {who}\n");
    println!("| switch | march and trace | colour |\n|---|---:|---:|");
    for (name, change) in SWITCHES {
        let (mut changed, mut extras) = (plan.clone(), Extras::default());
        change(&mut changed, &mut extras);
        row(&mut executor, name, &plan, (&changed, extras), RUNS)?;
    }
    println!("\nFeatures of `mandelbox` without fog at 320 x 180 with 4 samples\n");
    features(&mut executor, "feature", &[], FEATURES)?;
    println!("\nThe same in light by paths with 2 bounces\n");
    features(&mut executor, "feature of light by paths", PATH, PATHS)?;
    println!("\nWhole processes of `mandelbox` at 1280 x 720\n");
    println!("| samples | seconds |\n|---:|---:|");
    for samples in [1, 4, 16, 64] {
        println!("| {samples} | {:.1} |", process(samples)?);
    }
    Ok(())
}

/// Prints a table of features that are added to some keys.
fn features(
    executor: &mut Executor,
    title: &str,
    with: &[&str],
    features: &[(&str, &[&str])],
) -> Result<()> {
    println!("| {title} | march and trace | colour |\n|---|---:|---:|");
    let mut base = None;
    for (name, keys) in features {
        let own = ["image.size=[320, 180]", "image.samples=4", "look.fog=0"];
        let keys = own.iter().chain(with).chain(*keys);
        let keys: Result<Vec<_>, _> = keys.map(|key| Override::read(key)).collect();
        let changed = preset::load("mandelbox", &keys?)?.plan;
        let base = base.get_or_insert_with(|| changed.clone());
        let changed = (&changed, Extras::default());
        row(executor, name, base, changed, FEATURE_RUNS)?;
    }
    Ok(())
}

/// Prints the ratios of a changed plan's times to those of another.
fn row(
    executor: &mut Executor,
    name: &str,
    plan: &Plan,
    (changed, extras): (&Plan, Extras),
    runs: usize,
) -> Result<()> {
    let assets = Assets::default();
    let mut ratios = [Vec::new(), Vec::new()];
    let time = true;
    let [usual, extras] = [Extras::default(), extras].map(|extras| Extras { time, ..extras });
    // The first run compiles.
    for run in 0..=runs {
        let base = times(&executor.render(plan, &assets, usual, &mut |_| true)?);
        let other = times(&executor.render(changed, &assets, extras, &mut |_| true)?);
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
    Ok(())
}

/// Seconds of a process from nothing to a PNG of so many samples.
fn process(samples: u32) -> Result<f64> {
    let folder = tempfile::tempdir()?;
    let mut times = Vec::new();
    for _ in 0..PROCESSES {
        let mut command = Command::new(env!("CARGO_BIN_EXE_conemarch"));
        command.args(["render", "mandelbox", "--size", "1280x720"]);
        command.args(["--samples", &samples.to_string(), "--output"]);
        let begun = Instant::now();
        let ended = command.arg(folder.path().join("out.png")).output()?;
        ensure!(ended.status.success(), "`conemarch render` failed");
        times.push(begun.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}

/// Milliseconds of march and trace, and of colour: the device's, if it tells them.
fn times(frame: &Frame) -> [f64; 2] {
    [true, false].map(|marches| {
        let passes = frame.passes.iter();
        let some = passes.filter(|p| p.pass.marches() == marches);
        some.map(|p| p.gpu_ms.unwrap_or(p.wall_ms)).sum()
    })
}
