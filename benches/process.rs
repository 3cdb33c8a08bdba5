//! Where the time of a whole process goes: `cargo bench --bench process -- --write`.
//!
//! Each run is a process of its own, with a warm cache of the driver. It does in turn what `render`
//! does, and times the parts. The program itself is timed beside it. `--write` puts the table into
//! docs/architecture.md.

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::Choice;
use conemarch::picture::{BitDepth, Layer, Shades, write_png};
use conemarch::plan::{Extras, Pass};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use median::median;
use publish::publish;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/median.rs"]
mod median;
#[path = "common/publish.rs"]
mod publish;

const MARKS: [&str; 2] = ["<!-- process -->", "<!-- /process -->"];
/// Presets and settings. Without a setting, so few rays have no cone map.
const PRESETS: [(&str, &str); 5] = [
    ("bench-outside", ""),
    ("mandelbox", ""),
    ("mandelbox-gate", ""),
    ("terrain", ""),
    ("terrain", "scene.tracer=walk"),
];
const SIZE: [u32; 2] = [640, 360];
/// The details are those of the picture's own size.
const REFERENCE: &str = "image.reference=auto";
/// What is timed of a run.
const PARTS: usize = 7;
/// Processes of each kind, of which the median is taken, after one that warms the driver's cache.
const RUNS: usize = 9;
/// Asks a process for one run.
const ONE: &str = "--one";

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().collect();
    if let [_, one, name, set] = &args[..]
        && one == ONE
    {
        let parts = parts(name, set)?.map(|part| part.to_string());
        println!("{}", parts.join(" "));
        return Ok(());
    }
    let mut rows = Vec::new();
    for (name, set) in PRESETS {
        eprintln!("{name} {set}");
        let mut columns = vec![Vec::new(); PARTS + 1];
        for run in 0..=RUNS {
            let own = Command::new(&args[0])
                .args([ONE, name, set])
                .stderr(Stdio::inherit())
                .output()?;
            ensure!(own.status.success(), "a run of {name} failed");
            let said = String::from_utf8(own.stdout)?;
            let mut times: Vec<f64> = said
                .split_whitespace()
                .map(str::parse)
                .collect::<Result<_, _>>()?;
            times.push(whole(name, set)?);
            // The first run warms the cache.
            if run > 0 {
                columns.iter_mut().zip(times).for_each(|(c, t)| c.push(t));
            }
        }
        let medians: Vec<f64> = columns.into_iter().map(median).collect();
        let (whole, parts) = medians.split_last().context("there are no parts")?;
        let cells: Vec<String> = parts.iter().map(|ms| format!("{ms:.0}")).collect();
        let rest = whole - parts.iter().sum::<f64>();
        let with = if set.is_empty() { "" } else { ", " };
        rows.push(format!(
            "{name}{with}{set} | {} | {rest:.0} | {whole:.0}",
            cells.join(" | ")
        ));
    }
    let table = markdown::table(
        "640 x 360, one sample, ms | device opened | heights | cone map | programs and buffers | kernels | a render beside them | file | the rest of the process | in all",
        "lr",
        rows,
    );
    publish("architecture.md", MARKS, &table)
}

/// Milliseconds of the program, from nothing to a file.
fn whole(name: &str, set: &str) -> Result<f64> {
    let folder = tempfile::tempdir()?;
    let begun = Instant::now();
    let [width, height] = SIZE;
    let done = Command::new(env!("CARGO_BIN_EXE_conemarch"))
        .args(["render", name, "--samples", "1"])
        .args(["--set", REFERENCE])
        .args(
            [set]
                .iter()
                .filter(|set| !set.is_empty())
                .flat_map(|set| ["--set", set]),
        )
        .args(["--size", &format!("{width}x{height}"), "-o"])
        .arg(folder.path().join("a.png"))
        .stderr(Stdio::null())
        .status()?;
    ensure!(done.success(), "a render of {name} failed");
    Ok(begun.elapsed().as_secs_f64() * 1e3)
}

/// Milliseconds of the parts of one render in this process.
fn parts(name: &str, set: &str) -> Result<[f64; PARTS]> {
    let set = [REFERENCE, set].into_iter().filter(|set| !set.is_empty());
    let set: Result<Vec<_>, _> = set.map(Override::read).collect();
    let mut plan = preset::load(name, &set?)?.plan.one_sample();
    plan.size = SIZE;
    let begun = Instant::now();
    let (mut executor, _) = Executor::open(&Choice::Auto)?;
    let opened = begun.elapsed();
    let extras = Extras {
        time: true,
        rays: Some(plan.rays()),
        ..Extras::default()
    };
    let assets = Assets::default();
    plan.scene.make_heights(&assets, &mut |_| true)?;
    let raised = begun.elapsed();
    let mut render = || executor.render(&plan, &assets, extras, &mut |_| true);
    let maps = render()?;
    let first = begun.elapsed();
    let maps = maps
        .passes
        .iter()
        .filter(|p| matches!(p.pass, Pass::Prepare(_)));
    let maps = maps.map(|p| p.wall_ms).fold(0.0, f64::max);
    let frame = render()?;
    let second = begun.elapsed();
    let kernels: f64 = frame.passes.iter().filter_map(|p| p.gpu_ms).sum();
    let folder = tempfile::tempdir()?;
    let mut file = std::fs::File::create(folder.path().join("a.png"))?;
    let shades = Shades::new(Layer::Color, &frame, &plan);
    write_png(&mut file, &shades, BitDepth::Eight, name, "")?;
    let written = begun.elapsed();
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let warm = ms(second - first);
    Ok([
        ms(opened),
        ms(raised - opened),
        maps,
        ms(first - raised) - warm - maps,
        kernels,
        warm - kernels,
        ms(written - second),
    ])
}
