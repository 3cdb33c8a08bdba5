//! The CPU executor in two builds of this program; `scripts/executor` makes the builds and calls it:
//! `cargo bench --bench executor -- OLD NEW [--write]`.
//!
//! Whole processes, from nothing to a PNG. The builds run in turns, and figures are medians.
//! Processor time is that of all threads: other programs on the machine do not count in it.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use conemarch::preset;
use one_sample::one_sample;

#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/one_sample.rs"]
mod one_sample;

/// The marks around the table in the page.
const MARKS: [&str; 2] = [
    "<!-- scripts/executor COMMIT --write: begin -->",
    "<!-- scripts/executor COMMIT --write: end -->",
];
/// Runs of each build per row.
const RUNS: usize = 3;
const SIZE: &str = "640x360";
/// The old estimate, where a preset has a formula, and the old settings of the march.
const SAME: [&str; 3] = [
    "scene.estimate=scalar",
    "march.coarsest=16",
    "march.shell=0.45",
];
/// Today's settings of the march.
const TODAY: [&str; 2] = ["march.coarsest=auto", "march.shell=auto"];
/// Ticks of the processor times that Linux tells, per second.
const TICKS: f64 = 100.0;

fn main() -> Result<()> {
    // Cargo adds `--bench` to what it is given.
    let args = std::env::args().skip(1).filter(|a| a != "--bench");
    let args: Vec<String> = args.collect();
    ensure!(args.len() >= 2, "give the old and the new program");
    let text = table(&args[0], &args[1])?;
    println!("{text}");
    if args.iter().any(|a| a == "--write") {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/benchmarks.md");
        let mut page = std::fs::read_to_string(&path)?;
        markdown::replace(&mut page, MARKS, &text)?;
        std::fs::write(path, page)?;
    }
    Ok(())
}

/// Seconds of a run: of all its threads, and on the clock.
type Seconds = [f64; 2];

/// Every preset of the old build in three ways: by the old build, and by the new one with the old
/// estimate and settings, and with those of today.
fn table(old: &str, new: &str) -> Result<String> {
    let folder = tempfile::tempdir()?;
    let (mut rows, mut formulas, mut maps) = (Vec::new(), Vec::new(), Vec::new());
    for (name, _) in preset::BUILTIN {
        let said = Command::new(old).args(["presets", name]).output()?;
        // Newer ones are unknown to it.
        if !said.status.success() {
            continue;
        }
        let file = folder.path().join(name).with_extension("toml");
        std::fs::write(&file, &said.stdout)?;
        let has_formula = String::from_utf8_lossy(&said.stdout).contains("formula");
        let (same, today) = match has_formula {
            true => (&SAME[..], &TODAY[..]),
            // Heightfields have no estimate, and their presets no settings that changed.
            false => (&["scene.tracer=walk"][..], &[][..]),
        };
        let mut runs = [vec![], vec![], vec![]];
        for _ in 0..RUNS {
            let of = [(old, &[][..]), (new, same), (new, today)];
            for (runs, (program, settings)) in runs.iter_mut().zip(of) {
                runs.push(run(program, &file, settings)?);
            }
        }
        let [cpu, clock] = [0, 1].map(|of| runs.each_ref().map(|runs| median(runs, of)));
        let ratios = [&cpu, &clock].map(|[old, same, now]| [old / same, old / now]);
        rows.push(row(name, &cpu.map(|s| format!("{s:.2}")), &ratios));
        if has_formula {
            &mut formulas
        } else {
            &mut maps
        }
        .push(ratios);
    }
    let all = [&formulas[..], &maps].concat();
    for (name, all) in [
        ("mean of formulas", formulas),
        ("mean of heightfields", maps),
        ("mean of all", all),
    ] {
        let mean = |of: usize, at: usize| {
            let logs: f64 = all
                .iter()
                .map(|ratios: &[[f64; 2]; 2]| ratios[of][at].ln())
                .sum();
            (logs / all.len() as f64).exp()
        };
        let means = [0, 1].map(|of| [0, 1].map(|at| mean(of, at)));
        rows.push(row(name, &[const { String::new() }; 3], &means));
    }
    Ok(markdown::table(
        &format!(
            "{SIZE} | before, s | same estimate, s | now, s | before / same | before / now | on the clock: before / same | before / now"
        ),
        "lr",
        rows,
    ))
}

fn row(name: &str, seconds: &[String; 3], ratios: &[[f64; 2]; 2]) -> String {
    let ratios = ratios.as_flattened().iter().map(|r| format!("{r:.2}"));
    let cells = [name.to_string()]
        .into_iter()
        .chain(seconds.iter().cloned());
    cells.chain(ratios).collect::<Vec<_>>().join(" | ")
}

fn median(runs: &[Seconds], of: usize) -> f64 {
    let mut all: Vec<f64> = runs.iter().map(|run| run[of]).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

fn run(program: &str, preset: &Path, settings: &[&str]) -> Result<Seconds> {
    let mut command = Command::new(program);
    command
        .arg("render")
        .arg(preset)
        .args(["--size", SIZE, "--device", "cpu", "-o", "-"]);
    command.args(one_sample(program)?);
    for setting in settings {
        command.args(["--set", setting]);
    }
    let (before, start) = (children()?, Instant::now());
    let status = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    ensure!(
        status.success(),
        "{program} cannot render {}",
        preset.display()
    );
    Ok([children()? - before, start.elapsed().as_secs_f64()])
}

/// The processor time of all processes that have ended and were waited for, in seconds (Linux).
fn children() -> Result<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    // The name of the program, in brackets, may have spaces.
    let (_, fields) = stat.rsplit_once(')').context("a line without a name")?;
    let ticks = fields
        .split_whitespace()
        .skip(13)
        .take(2)
        .map(str::parse::<f64>);
    Ok(ticks.sum::<Result<f64, _>>()? / TICKS)
}
