//! `conemarch bench flight`: how quickly a preview answers, without its window.
//!
//! The pictures are those of the window: small ones while the plan changes, full ones when it
//! rests. What a screen adds is not in the times.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::Result;
use clap::{Args, ValueHint};
use serde::Serialize;

use crate::command::arguments::{size, whole};
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::print::{print, say};
use crate::command::progress::Reporter;
use crate::command::render::loaded;
use crate::command::sink::{Results, Sink};
use crate::command::table::table;
use crate::command::{completions, interrupt, memory};
use crate::gpu::adapters::Choice;
use crate::gpu::device::Device;
use crate::plan::{Extras, Plan};
use crate::preview::flight::orbit;
use crate::preview::pictures::Pictures;

/// So many places of the flight have a full picture.
const EYES: usize = 10;

/// What `bench flight` takes.
#[derive(Args, Debug)]
pub struct FlightBench {
    /// Presets to fly through [default: mandelbox mandelbox-gate terrain]
    #[arg(value_name = "PRESET", add = completions::presets())]
    presets: Vec<PathBuf>,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = size)]
    size: [u32; 2],

    /// Pictures of the flight
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = whole(20_u32, 100_000))]
    frames: u32,

    /// Who renders: auto, gpu, software, or an index or part of a name from `devices`
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,

    /// Write the rows as JSON too, - for standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    json: Option<PathBuf>,
}

/// The figures of one preset. Times are medians in milliseconds.
#[derive(Debug, Serialize)]
struct Row {
    preset: String,
    size: [u32; 2],
    device: String,
    /// From a change to its first picture, and 95 of 100 of them.
    answer_ms: f64,
    answer_p95_ms: f64,
    /// Pictures per second in a flight.
    frames_per_second: f64,
    /// The longest turn: so long does an event wait for work that was submitted.
    turn_p99_ms: f64,
    /// In calls of the renderer, for each picture of the flight. Software Vulkan computes in these
    /// calls.
    host_ms: f64,
    /// Sets of buffers that the second half of the flight made.
    allocations: u32,
    /// Memory of the process after a tenth of the flight and after all of it, in MiB, if the system
    /// tells.
    memory_mib: [Option<u64>; 2],
    /// A render without a preview, again on a warm device.
    render_ms: f64,
    /// From rest to the full picture from another eye, with another light, and with another
    /// exposure.
    full_ms: f64,
    look_ms: f64,
    exposure_ms: f64,
    /// So long does the device go on at most with a full picture that nobody wants any more.
    stop_ms: f64,
}

/// Times the pictures of one preset.
struct FlightRun<'a> {
    pictures: Pictures,
    progress: &'a mut Reporter,
    turns: Vec<f64>,
}

fn ms(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}

/// One of the sorted times.
fn at(times: &[f64], share: f64) -> f64 {
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    let last = times.len().saturating_sub(1);
    times
        .get((share * last as f64).round() as usize)
        .copied()
        .unwrap_or(f64::NAN)
}

impl FlightRun<'_> {
    /// Milliseconds until there is a picture of a plan: a full one, unless the plan moves.
    fn time(&mut self, plan: &Plan, moving: bool) -> Result<f64> {
        let began = Instant::now();
        self.pictures.moving = moving;
        self.pictures.want(plan);
        loop {
            interrupt::check()?;
            let turn = Instant::now();
            let finished = self.pictures.advance()?;
            self.turns.push(ms(turn));
            if self.pictures.is_full() || (finished && moving) {
                return Ok(ms(began));
            }
            // The window, which draws too, asks every millisecond.
            sleep(Duration::from_micros(500));
        }
    }

    /// Milliseconds from giving up a picture, after so many, until the device has nothing to do.
    fn stop(&mut self, plan: &Plan, after_ms: f64) -> Result<f64> {
        self.pictures.moving = false;
        self.pictures.want(plan);
        let began = Instant::now();
        while ms(began) < after_ms {
            self.pictures.advance()?;
        }
        let given_up = Instant::now();
        self.pictures.renderer.device.wait()?;
        Ok(ms(given_up))
    }

    /// Milliseconds of a render of the plan without a preview.
    fn render(&mut self, plan: &Plan) -> Result<f64> {
        let began = Instant::now();
        let Pictures {
            renderer, assets, ..
        } = &mut self.pictures;
        renderer.render(plan, assets, Extras::default(), &mut |_| true)?;
        Ok(ms(began))
    }

    fn median(&mut self, plans: &[Plan]) -> Result<f64> {
        let times: Result<Vec<f64>> = plans.iter().map(|plan| self.time(plan, false)).collect();
        Ok(at(&times?, 0.5))
    }
}

/// The plans of a flight: along the tracks, or a quarter around the target.
fn flight(plan: &Plan, frames: u32) -> Result<Vec<Plan>> {
    let share = |i: u32| f64::from(i) / f64::from(frames);
    let one = |i: u32| {
        if plan.tracks.is_empty() {
            let mut plan = plan.clone();
            let about = plan.camera.target;
            orbit(&mut plan.camera, about, 1.5 * share(i), 0.0);
            return Ok(plan);
        }
        let at = plan.at(share(i) * plan.time.length);
        at.map_err(|fault| usage(format!("{}: {}", fault.key, fault.why)))
    };
    (0..frames).map(one).collect()
}

fn row(
    args: &FlightBench,
    (device, name): (&Arc<Device>, &str),
    preset: &Path,
    progress: &mut Reporter,
) -> Result<Row> {
    let (preset, assets) = loaded(preset, &[])?;
    let plan = Plan {
        size: args.size,
        ..preset.plan.one_sample()
    };
    let plans = flight(&plan, args.frames)?;
    let mut pictures = Pictures::new(device.clone());
    pictures.assets = assets;
    let colors = Extras {
        unread: true,
        ..Extras::default()
    };
    pictures.keep(colors, true);
    let mut flown = FlightRun {
        pictures,
        progress,
        turns: Vec::new(),
    };
    let still = Plan {
        tracks: Vec::new(),
        ..plan.clone()
    };
    // Maps are made, programs compiled, and sizes chosen.
    flown.time(&still, false)?;
    for plan in &plans[..10] {
        flown.time(plan, true)?;
    }
    let (mut answers, mut made, mut memory) = (Vec::new(), 0, None);
    flown.turns.clear();
    let began = Instant::now();
    for (i, plan) in plans.iter().enumerate() {
        flown
            .progress
            .report(i as f64 / plans.len() as f64, &preset.name);
        if i == plans.len() / 2 {
            made = flown.pictures.traffic().allocations;
        }
        if i == plans.len() / 10 {
            memory = memory::used();
        }
        answers.push(flown.time(plan, true)?);
    }
    let frames_per_second = plans.len() as f64 / began.elapsed().as_secs_f64();
    let host_ms = flown.turns.iter().sum::<f64>() / plans.len() as f64;
    let allocations = flown.pictures.traffic().allocations - made;
    let memory_mib = [memory, memory::used()].map(|bytes| bytes.map(|n| n >> 20));
    let changed = |change: &dyn Fn(&mut Plan, f64)| {
        let one = |i: i32| {
            let mut plan = still.clone();
            change(&mut plan, f64::from(i));
            plan
        };
        (1..=5).map(one).collect::<Vec<_>>()
    };
    // In turns, as a machine may change its pace.
    let (mut full, mut renders) = (Vec::new(), Vec::new());
    for plan in plans.iter().step_by(plans.len().div_ceil(EYES)) {
        full.push(flown.time(plan, false)?);
        renders.push(flown.render(plan)?);
    }
    let turn_p99_ms = at(&flown.turns, 0.99);
    let full_ms = at(&full, 0.5);
    let mut stop_ms = 0.0_f64;
    for (i, plan) in plans.iter().step_by(plans.len().div_ceil(EYES)).enumerate() {
        let after_ms = full_ms * (i as f64 + 0.5) / EYES as f64;
        stop_ms = stop_ms.max(flown.stop(plan, after_ms)?);
    }
    flown.time(&still, false)?;
    let look_ms = flown.median(&changed(&|plan, i| plan.look.key += 0.1 * i))?;
    flown.time(&still, false)?;
    let exposure_ms = flown.median(&changed(&|plan, i| plan.look.exposure += 0.1 * i))?;
    Ok(Row {
        preset: preset.name,
        size: args.size,
        device: name.into(),
        answer_ms: at(&answers, 0.5),
        answer_p95_ms: at(&answers, 0.95),
        frames_per_second,
        turn_p99_ms,
        host_ms,
        allocations,
        memory_mib,
        // The first one allocates.
        render_ms: at(&renders[1..], 0.5),
        full_ms,
        look_ms,
        exposure_ms,
        stop_ms,
    })
}

/// Measures flights.
///
/// # Errors
/// A wrong preset, no device, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &FlightBench) -> Result<()> {
    interrupt::listen();
    let json = args.json.as_deref().map(Sink::prepare).transpose()?;
    let usual = ["mandelbox", "mandelbox-gate", "terrain"].map(PathBuf::from);
    let presets = match args.presets.is_empty() {
        true => &usual[..],
        false => &args.presets,
    };
    let (executor, who) = Executor::open(&args.device)?;
    let name = executor.name();
    let Executor::Gpu(renderer) = executor else {
        return Err(usage(format!(
            "a preview needs a device, and this would be {who}; `conemarch devices` lists devices"
        )));
    };
    let mut progress = Reporter::start("flying");
    let rows: Result<Vec<Row>> = presets
        .iter()
        .map(|p| row(args, (&renderer.device, &name), p, &mut progress))
        .collect();
    drop(progress);
    let rows = rows?;
    if let Some(row) = rows.first() {
        let [w, h] = row.size;
        say(&format!("{w} x {h} on {}", row.device));
    }
    let whole = |x: f64| format!("{x:.0}");
    let ratio = |x: f64| format!("{x:.2}");
    print(
        table(
            &rows,
            &[
                ("preset", &|r| r.preset.clone()),
                ("answer, ms", &|r| whole(r.answer_ms)),
                ("p95", &|r| whole(r.answer_p95_ms)),
                ("pictures per second", &|r| whole(r.frames_per_second)),
                ("turn p99, ms", &|r| whole(r.turn_p99_ms)),
                ("host, ms", &|r| whole(r.host_ms)),
                ("new buffers", &|r| r.allocations.to_string()),
                ("memory, MiB", &|r| match r.memory_mib {
                    [Some(early), Some(late)] => format!("{early} to {late}"),
                    _ => String::new(),
                }),
                ("render, ms", &|r| whole(r.render_ms)),
                ("full / render", &|r| ratio(r.full_ms / r.render_ms)),
                ("look / render", &|r| ratio(r.look_ms / r.render_ms)),
                ("exposure, ms", &|r| whole(r.exposure_ms)),
                ("stop, ms", &|r| whole(r.stop_ms)),
            ],
        )
        .as_bytes(),
    )?;
    if let Some(json) = json {
        let mut results = Results::default();
        results.put_json(json, &rows)?;
        results.hand_over()?;
    }
    Ok(())
}
