//! What a render costs beside its kernels, in two builds of this program; `scripts/overhead`
//! makes the builds and calls it: `cargo bench --bench overhead -- OLD NEW [--rivals] [--write]`.
//!
//! Times are medians of warm runs. The overhead is march and trace on the clock less the
//! device's own time for them.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, OnceLock};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use as_sharp::as_sharp;
use conemarch::command::executor::Executor;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::measure::sharpness::{self, sharpness};
use conemarch::pass::progress::Progress;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Pass, Plan};
use conemarch::preset::{self, Override};
use conemarch::scene::Assets;
use median::median;
use one_sample::one_sample;
use publish::publish;
use serde_json::Value;
use tempfile::TempDir;
use views::VIEWS;

#[path = "common/as_sharp.rs"]
mod as_sharp;
#[path = "common/markdown.rs"]
mod markdown;
#[path = "common/median.rs"]
mod median;
#[path = "common/one_sample.rs"]
mod one_sample;
#[path = "common/publish.rs"]
mod publish;
#[path = "common/views.rs"]
mod views;

/// The marks around the tables in the page.
const MARKS: [&str; 2] = [
    "<!-- scripts/overhead COMMIT --write: begin -->",
    "<!-- scripts/overhead COMMIT --write: end -->",
];
const RIVAL_MARKS: [&str; 2] = ["<!-- rivals -->", "<!-- /rivals -->"];
/// Processes of each build per row; each has warm runs of its own.
const RUNS: usize = 3;
/// The same of the overhead at a small size, which is tenths of a millisecond.
const SMALL_RUNS: usize = 15;
/// Today's settings of the march.
const TODAY: [&str; 2] = ["march.coarsest=auto", "march.shell=auto"];
/// The factor on the steps to the set.
const STRIDE: f64 = 0.1;
/// The old build's strongest way without cones, in views of Mandelboxes.
const RIVAL: [&str; 2] = ["march.mode=ray-relaxed", "march.clip=on"];
const RIVAL_SIZE: [u32; 2] = [1920, 1080];
/// Presets whose second frame is looked at.
const LIVE: [&str; 3] = ["mandelbox", "mandelbox-gate", "terrain"];
/// Its sizes: kernels take little at the first, and rays tell whether cones pay at the others.
const FRAMES: [[u32; 2]; 3] = [[64, 36], [640, 360], [1280, 720]];

fn main() -> Result<()> {
    // Cargo adds `--bench` to what it is given.
    let args = std::env::args().skip(1).filter(|a| a != "--bench");
    let args: Vec<String> = args.collect();
    if args == [CANCELS] {
        println!("{}", cancels()?);
        return Ok(());
    }
    ensure!(args.len() >= 2, "give the old and the new program");
    let presets = old_presets(&args[0])?;
    if args.iter().any(|a| a == RIVALS) {
        let table = rivals(&args, presets.path())?;
        return publish("benchmarks.md", RIVAL_MARKS, &table);
    }
    let text = [
        small(&args, presets.path())?,
        large(&args, presets.path())?,
        processes(&args, presets.path())?,
        frames()?,
        cancels_of_first_starts()?,
    ]
    .join("\n");
    publish("architecture.md", MARKS, &text)
}

/// Files of the old build's presets. Both builds render these, as today's may differ.
fn old_presets(program: &str) -> Result<TempDir> {
    let folder = tempfile::tempdir()?;
    for (name, _) in preset::BUILTIN {
        let said = Command::new(program).args(["presets", name]).output()?;
        // Newer ones are unknown to it.
        if said.status.success() {
            std::fs::write(folder.path().join(name).with_extension("toml"), said.stdout)?;
        }
    }
    Ok(folder)
}

/// The overhead of march and trace by both builds in turns, in milliseconds.
fn overheads(args: &[String], preset: &Path) -> Result<[f64; 2]> {
    let mut all = [vec![], vec![]];
    for _ in 0..SMALL_RUNS {
        for (runs, program) in all.iter_mut().zip(args) {
            let times = run(program, preset, "64x36", &[])?;
            runs.push(times.marched - times.device);
        }
    }
    Ok(all.map(median))
}

/// The times of one render in milliseconds.
struct Times {
    /// March and trace on the clock.
    marched: f64,
    /// The same on the device.
    device: f64,
    /// Colour on the clock. Today this ends when the host has the picture; before, the host asked
    /// for it afterwards.
    colored: f64,
    /// The same on the device.
    device_colored: f64,
}

fn run(program: &str, preset: &Path, size: &str, settings: &[&str]) -> Result<Times> {
    let file = std::env::temp_dir().join(format!("overhead-{}.json", std::process::id()));
    let picture = file.with_extension("png");
    let mut command = Command::new(program);
    command.arg("render").arg(preset).args(["--size", size]);
    command.args(one_sample(program)?);
    command
        .args(settings)
        .arg("--stats")
        .arg(&file)
        .arg("-o")
        .arg(&picture);
    let status = command.stderr(Stdio::null()).status()?;
    ensure!(
        status.success(),
        "{program} cannot render {}",
        preset.display()
    );
    let stats: Value = serde_json::from_str(&std::fs::read_to_string(&file)?)?;
    std::fs::remove_file(file)?;
    std::fs::remove_file(picture)?;
    let wall = stats["wall_ms"].as_f64().context("no wall_ms")?;
    let passes = stats["passes"].as_array().context("no passes")?;
    let marched = passes.iter().filter(|p| {
        let name = p["name"].as_str().unwrap_or_default();
        name.starts_with("march") || name == "trace"
    });
    let device: Option<f64> = marched.map(|p| p["gpu_ms"].as_f64()).sum();
    let color = passes.last().context("no colour pass")?;
    Ok(Times {
        marched: wall,
        device: device.context("the device has no timestamps")?,
        colored: color["wall_ms"].as_f64().context("no wall_ms")?,
        device_colored: color["gpu_ms"]
            .as_f64()
            .context("the device has no timestamps")?,
    })
}

/// The overhead at a size at which kernels take little.
fn small(args: &[String], presets: &Path) -> Result<String> {
    let mut rows = Vec::new();
    for preset in LIVE {
        let file = presets.join(preset).with_extension("toml");
        let [old, new] = overheads(args, &file)?;
        rows.push(format!("{preset} | {old:.2} | {new:.2} | {:.2}", new / old));
    }
    Ok(markdown::table(
        "march and trace, 64 x 36 | overhead before, ms | now, ms | ratio",
        "lr",
        rows,
    ))
}

/// March and trace, and whole frames, at 1280 x 720: with the old estimate and the old settings,
/// and with those of today.
fn large(args: &[String], presets: &Path) -> Result<String> {
    let scalar = ["--set", "scene.estimate=scalar"];
    let today = TODAY.map(|setting| ["--set", setting]).concat();
    let (mut rows, mut sharp_rows) = (Vec::new(), Vec::new());
    let (mut ratios, mut gains) = (Vec::new(), Vec::new());
    for (preset, _) in preset::BUILTIN {
        let file = presets.join(preset).with_extension("toml");
        if !file.exists() {
            continue;
        }
        // Heightfields have no estimate.
        let has_formula = std::fs::read_to_string(&file)?.contains("formula");
        let same = scalar.get(..if has_formula { 2 } else { 0 });
        let before = || detail_before(&file, [1280, 720], &[]);
        let detail = has_formula.then(before).transpose()?;
        let detail = detail.map(|d| format!("march.detail={d:.3}"));
        let as_sharp = detail.as_ref().map(|d| ["--set", d]);
        let runs = [
            (&args[0], &[][..]),
            (&args[1], same.unwrap_or_default()),
            (&args[1], &today[..]),
            (&args[0], as_sharp.as_ref().map_or(&[][..], |d| d)),
        ];
        let mut all = [vec![], vec![], vec![], vec![]];
        for _ in 0..RUNS {
            for (times, (program, settings)) in all.iter_mut().zip(runs) {
                times.push(run(program, &file, "1280x720", settings)?);
            }
        }
        let middle =
            |of: usize, figure: fn(&Times) -> f64| median(all[of].iter().map(figure).collect());
        let [old, same, new] = [0, 1, 2].map(|of| middle(of, |t| t.marched));
        let [whole_old, whole_same, whole, whole_sharp] =
            [0, 1, 2, 3].map(|of| middle(of, |t| t.marched + t.colored));
        let [device, device_sharp] = [2, 3].map(|of| middle(of, |t| t.device + t.device_colored));
        let own = [
            same / old,
            new / old,
            whole_same / whole_old,
            whole / whole_old,
        ];
        let [a, b, c, d] = own;
        rows.push(format!(
            "{preset} | {old:.0} | {same:.0} | {new:.0} | {a:.2} | {b:.2} | {whole_old:.0} | {whole_same:.0} | {whole:.0} | {c:.2} | {d:.2}",
        ));
        ratios.push(own);
        let detail = detail.as_deref().unwrap_or("the same");
        let [gain, device_gain] = [whole_sharp / whole, device_sharp / device];
        sharp_rows.push(format!(
            "{preset} | {} | {whole_sharp:.0} | {whole:.0} | {gain:.2} | {device_sharp:.0} | {device:.0} | {device_gain:.2}",
            detail.trim_start_matches("march.detail=")
        ));
        gains.push([gain, device_gain]);
    }
    let [a, b, c, d] = means(&ratios);
    let [gain, device_gain] = means(&gains);
    sharp_rows.push(format!(
        "geometric mean | | | | {gain:.2} | | | {device_gain:.2}"
    ));
    rows.push(format!(
        "geometric mean | | | | {a:.2} | {b:.2} | | | | {c:.2} | {d:.2}"
    ));
    let equal = markdown::table(
        "march and trace, 1280 x 720 | before, ms | same estimate | now | same / before | now / before | whole frame before | same estimate | now | same / before | now / before",
        "lr",
        rows,
    );
    let sharp = markdown::table(
        "whole frames as sharp, 1280 x 720 | detail before | before, ms | now, ms | times faster | on the device before, ms | now, ms | times faster",
        "lr",
        sharp_rows,
    );
    Ok(format!("{equal}\n{sharp}"))
}

/// The geometric mean of each figure.
fn means<const N: usize>(rows: &[[f64; N]]) -> [f64; N] {
    std::array::from_fn(|of| {
        let logs: f64 = rows.iter().map(|own| own[of].ln()).sum();
        (logs / rows.len() as f64).exp()
    })
}

/// March and trace of the old build's rival, with pictures as sharp as those of today's default.
fn rivals(args: &[String], presets: &Path) -> Result<String> {
    let (mut rows, mut ratios) = (Vec::new(), Vec::new());
    let [w, h] = RIVAL_SIZE;
    let size = format!("{w}x{h}");
    let today = TODAY.map(|setting| ["--set", setting]).concat();
    for name in VIEWS {
        let file = presets.join(name).with_extension("toml");
        let detail = detail_before(&file, RIVAL_SIZE, &RIVAL)?;
        let sharp = format!("march.detail={detail:.3}");
        let rival = [RIVAL[0], RIVAL[1], &sharp].map(|setting| ["--set", setting]);
        let runs = [(&args[0], &rival.concat()), (&args[1], &today)];
        let mut all = [vec![], vec![]];
        for _ in 0..RUNS {
            for (times, (program, settings)) in all.iter_mut().zip(runs) {
                times.push(run(program, &file, &size, settings)?.device);
            }
        }
        let [old, new] = all.map(median);
        rows.push(format!(
            "{name} | {detail:.3} | {old:.0} | {new:.0} | {:.2}",
            old / new
        ));
        if name.starts_with("bench-") {
            ratios.push([old / new]);
        }
    }
    let [mean] = means(&ratios);
    rows.push(format!("mean of `bench-*` | | | | {mean:.2}"));
    let head = format!(
        "march and trace on the device, {w} x {h} | detail before | rival before, ms | `safe` now, ms | ratio"
    );
    Ok(markdown::table(&head, "lr", rows))
}

/// The `detail` with which the old estimate, with other settings, shows as sharp a picture of a preset
/// as today's default.
fn detail_before(file: &Path, size: [u32; 2], others: &[&str]) -> Result<f64> {
    let load = |settings: &[&str]| -> Result<Plan> {
        let settings: Result<Vec<_>, _> = settings.iter().map(|s| Override::read(s)).collect();
        let mut plan = preset::load(file, &settings?)?.plan.one_sample();
        plan.size = size;
        Ok(plan)
    };
    let (now, before) = (
        load(&TODAY)?,
        load(&[&["scene.estimate=scalar"], others].concat())?,
    );
    let [mut executor, mut old] = [
        Executor::open(&Choice::Auto)?.0,
        Executor::open(&Choice::Auto)?.0,
    ];
    let Executor::Gpu(renderer) = &mut old else {
        bail!("hits of the old program need a device");
    };
    renderer.sources = Some(Arc::new(old_hits));
    let assets = Assets::default();
    let extras = Extras {
        depth_only: true,
        ..Extras::default()
    };
    let set = sharpness::sample(&now, &assets, STRIDE)?;
    let frame = executor.render(&now, &assets, extras, &mut |_| true)?;
    let seen = sharpness(&frame, &set, &now);
    let render = |plan: &Plan| Ok(old.render(plan, &assets, extras, &mut |_| true)?);
    as_sharp(&before, &set, seen.before_set.median, render)
}

/// The shaders with hits where the old build has them: at the first point within the threshold.
fn old_hits(path: &str) -> Option<String> {
    let text = include_str!("../wgsl/scene/distance.wgsl");
    let met = "if above > 0.0 {";
    assert!(text.contains(met));
    (path == "wgsl/scene/distance.wgsl").then(|| text.replace(met, "if false {"))
}

/// From nothing to a file: whole processes.
fn processes(args: &[String], presets: &Path) -> Result<String> {
    let mut rows = Vec::new();
    for preset in LIVE {
        let file = presets.join(preset).with_extension("toml");
        let mut all = [vec![], vec![]];
        for _ in 0..2 * RUNS {
            for (runs, program) in all.iter_mut().zip(args) {
                let plain = one_sample(program)?;
                let start = Instant::now();
                let mut command = Command::new(program);
                command.arg("render").arg(&file);
                command.args(["--size", "64x36", "-o", "-"]);
                command.args(&plain);
                let output = command.stdin(Stdio::null()).output()?;
                ensure!(output.status.success(), "{program} cannot render {preset}");
                runs.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        let [old, new] = all.map(median);
        rows.push(format!("{preset} | {old:.0} | {new:.0} | {:.2}", new / old));
    }
    Ok(markdown::table(
        "from nothing to a file, 64 x 36 | before, ms | now, ms | ratio",
        "lr",
        rows,
    ))
}

/// What the host does for the first frame of a scene, and for frames from other eyes, which a host
/// would show and not read.
fn frames() -> Result<String> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut rows = Vec::new();
    for name in LIVE {
        for size in FRAMES {
            let mut renderer = Renderer::new(Device::open(adapter)?);
            let assets = Assets::default();
            let mut plan = preset::load(name, &[])?.plan.one_sample();
            plan.size = size;
            let mut render = |plan: &Plan| -> Result<(Frame, f64)> {
                let extras = Extras {
                    time: true,
                    shown: true,
                    unread: true,
                    ..Extras::default()
                };
                let start = Instant::now();
                let frame = renderer.render(plan, &assets, extras, &mut |_| true)?;
                Ok((frame, start.elapsed().as_secs_f64() * 1e3))
            };
            let (first, _) = render(&plan)?;
            let mut later = Vec::new();
            for _ in 0..21 {
                plan.camera.eye *= 1.0001;
                let (frame, ms) = render(&plan)?;
                let kernels: f64 = frame.passes.iter().filter_map(|p| p.gpu_ms).sum();
                later.push((ms - kernels, frame));
            }
            later.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (ms, again) = &later[later.len() / 2];
            for (what, frame, ms) in [
                ("first", &first, "-".to_string()),
                ("from another eye", again, format!("{ms:.2}")),
            ] {
                let t = frame.traffic.context("no device")?;
                let [width, height] = size;
                rows.push(format!(
                    "{name}, {width} x {height} | {what} | {} | {} | {} | {} | {} | {ms}",
                    t.drains, t.submissions, t.uploads, t.compilations, t.allocations
                ));
            }
        }
    }
    Ok(markdown::table(
        "preset | frame | drains | submissions | bytes uploaded | programs compiled | sets of buffers created | overhead, ms",
        "llr",
        rows,
    ))
}

/// A render is cancelled so long after its pass has begun, or in another pass if that takes longer
/// to come.
const CANCEL_AFTER: Duration = Duration::from_millis(5);
const CANCELLED_WITHIN: Duration = Duration::from_millis(4000);
/// The argument that asks for the table of cancelled renders alone.
const CANCELS: &str = "--cancels";
/// The argument that asks for the table of rivals alone, which is in another page.
const RIVALS: &str = "--rivals";

/// The table of cancelled renders from a process in which Mesa keeps no compiled program, so that each
/// render is that of a first start.
fn cancels_of_first_starts() -> Result<String> {
    let made = Command::new(std::env::current_exe()?)
        .arg(CANCELS)
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stderr(Stdio::inherit())
        .output()?;
    ensure!(made.status.success(), "the cancelled renders failed");
    Ok(String::from_utf8(made.stdout)?.trim_end().to_string() + "\n")
}

/// How soon a render that another thread cancels returns, and its renderer ends, which waits for its
/// threads. Every preset is rendered with its own samples and light, by a renderer that has rendered
/// nothing yet, and cancelled in each pass, those that prepare it included.
fn cancels() -> Result<String> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = chosen.context("there is no adapter")?;
    let mut rows = Vec::new();
    for (name, _) in preset::BUILTIN {
        let mut plan = preset::load(name, &[])?.plan;
        let mut wanted = prepared_in(adapter, &plan)?;
        plan.size = [1280, 720];
        let resolved = plan.resolved(Extras::default(), &Assets::default());
        wanted.extend(resolved.passes(Extras::default()).iter().map(Pass::name));
        let mut times: [Vec<f64>; 2] = Default::default();
        let mut passes = BTreeSet::new();
        for wanted in wanted {
            let mut renderer = Renderer::new(Device::open(adapter)?);
            let asked: OnceLock<Instant> = OnceLock::new();
            let pass = Mutex::new(String::new());
            let now_in = |name: &str| pass.lock().is_ok_and(|pass| *pass == name);
            let returned = std::thread::scope(|scope| {
                scope.spawn(|| {
                    let begun = Instant::now();
                    while begun.elapsed() < CANCELLED_WITHIN && !now_in(&wanted) {
                        std::thread::sleep(Duration::from_micros(200));
                    }
                    std::thread::sleep(CANCEL_AFTER);
                    asked.get_or_init(Instant::now);
                });
                let watch = &mut |now: &Progress| {
                    if let Ok(mut pass) = pass.lock() {
                        pass.clone_from(&now.pass);
                    }
                    asked.get().is_none()
                };
                let assets = Assets::default();
                let rendered = renderer.render(&plan, &assets, Extras::default(), watch);
                let returned = asked.get().map(Instant::elapsed);
                rendered.is_err().then_some(returned).flatten()
            });
            drop(renderer);
            // A render that was over by then cannot be cancelled.
            if let (Some(returned), Some(asked)) = (returned, asked.get()) {
                for (times, time) in times.iter_mut().zip([returned, asked.elapsed()]) {
                    times.push(time.as_secs_f64() * 1e3);
                }
                passes.extend(pass.into_inner());
            }
        }
        times
            .iter_mut()
            .for_each(|times| times.sort_by(f64::total_cmp));
        let [returned, ended] = &times;
        let [Some(most), Some(end)] = [returned, ended].map(|times| times.last()) else {
            bail!("no render of {name} was cancelled");
        };
        let passes: Vec<String> = passes.into_iter().collect();
        rows.push(format!(
            "{name} | {} | {:.0} | {most:.0} | {end:.0}",
            passes.join(", "),
            returned[returned.len() / 2]
        ));
    }
    Ok(markdown::table(
        "preset, 1280 x 720 | cancelled in | returned after, median, ms | the longest, ms | renderer ended after, the longest, ms",
        "llr",
        rows,
    ))
}

/// The names of the passes that prepare a preset.
fn prepared_in(adapter: &wgpu::Adapter, plan: &Plan) -> Result<Vec<String>> {
    let mut plan = plan.one_sample();
    plan.size = [64, 36];
    let passes: Vec<String> = plan
        .passes(Extras::default())
        .iter()
        .map(Pass::name)
        .collect();
    let mut names = BTreeSet::new();
    let watch = &mut |now: &Progress| {
        names.insert(now.pass.clone());
        true
    };
    let mut renderer = Renderer::new(Device::open(adapter)?);
    renderer.render(&plan, &Assets::default(), Extras::default(), watch)?;
    Ok(names
        .into_iter()
        .filter(|name| !passes.contains(name))
        .collect())
}
