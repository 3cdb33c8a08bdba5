//! `conemarch render PRESET`

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use clap::builder::TypedValueParser;
use clap::{Args, ValueHint, value_parser};

use crate::command::arguments::{bits, pixel_samples, size, words};
use crate::command::bench::common::of_how_many;
use crate::command::bench::runner::{Runner, TIMED};
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::output::{Format, default_name};
use crate::command::print::{print, say};
use crate::command::progress::Reporter;
use crate::command::sink::{Parcel, Sink, apart, spared};
use crate::command::stats::{Stats, summary};
use crate::command::{completions, interrupt, memory};
use crate::gpu::adapters::Choice;
use crate::measure::truth::{Cache, MOST_ROUNDS, cached};
use crate::pass;
use crate::picture::frame::{Frame, errors};
use crate::picture::{BitDepth, Layer};
use crate::plan::{Extras, Plan};
use crate::preset::{self, Override, Preset};
use crate::scene::Assets;

/// What `render` takes.
#[derive(Args, Debug)]
pub struct Render {
    /// A built-in preset, a .toml file, or a .png that this program wrote
    #[arg(value_name = "PRESET", add = completions::presets())]
    pub(crate) preset: PathBuf,

    /// Where to write: a .png, .jpg, .webp or .exr file, or - for PNG on standard output
    ///
    /// Without -o the picture goes to the current folder as NAME.png, with --set as
    /// NAME-camera.fov=60.png, with another --size as NAME-640x360.png, with --samples as
    /// NAME-samples=16.png, and with another --layer as NAME.depth.png. Only a picture of the same
    /// layer and settings is replaced, or one that is older than a preset's file.
    ///
    /// A PNG carries its preset and can be rendered again; JPEG and WebP carry none. WebP is
    /// without loss. An EXR has the channels R, G, B (linear), A (1), Z (along the view
    /// axis), depth.Z (along the ray), normal.X/Y/Z, position.X/Y/Z, state.Y (0 sky, 1 hit,
    /// 2 unconverged), and steps.Y with --stats. Both depths are 1e10 for sky. Its
    /// attributes hold the preset and the camera.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Width and height in pixels, in place of the preset's
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,

    /// Rays through each pixel, in place of the preset's: 1 is quick, 16 is smooth
    #[arg(long, value_name = "N", value_parser = pixel_samples())]
    pub(crate) samples: Option<u32>,

    /// Set one value of the preset; may be given again
    ///
    /// Values are TOML. Words, fields like fbm:64x64,seed=3 and paths like maps/d8.png need
    /// no quotes. Another scene.kind or scene.formula drops the preset's other values of the
    /// scene.
    #[arg(long, value_name = "SECTION.KEY=VALUE", allow_hyphen_values = true)]
    #[arg(add = completions::settings())]
    pub(crate) set: Vec<String>,

    /// Who renders: auto, gpu, software, cpu, or an index or part of a name from `devices`
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,

    /// What the picture shows
    #[arg(long, value_name = "LAYER", default_value = "color", value_parser = layers())]
    pub(crate) layer: Layer,

    /// Bits of each colour of a PNG; 16 leave no steps in smooth shades [default: 8]
    #[arg(long, value_name = "BITS", value_parser = bits())]
    pub(crate) depth: Option<BitDepth>,

    /// Quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "QUALITY", value_parser = value_parser!(u8).range(1..=100))]
    pub(crate) quality: Option<u8>,

    /// Count the work and write its figures as JSON, - for standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    stats: Option<PathBuf>,

    /// The moment of the film that the preset's tracks describe, in beats; at the default of 60
    /// beats per minute these are seconds
    ///
    /// Without it, tracks are ignored.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    pub(crate) at: Option<f64>,

    /// Print the passes and shader programs of this render, and render nothing
    #[arg(long)]
    explain: bool,
}

fn layers() -> impl TypedValueParser<Value = Layer> {
    words(Layer::ALL.map(|layer| (layer, layer.name(), layer.facts())))
}

/// Renders a preset.
///
/// # Errors
/// A wrong preset or option, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &Render) -> Result<()> {
    interrupt::listen();
    let (preset, assets) = loaded(&args.preset, &args.set)?;
    let Preset { name, mut plan, .. } = preset;
    if let Some(beat) = args.at {
        plan = moment(&plan, beat)?;
    }
    let own_size = plan.size;
    plan.size = args.size.unwrap_or(own_size);
    plan.samples = args.samples.unwrap_or(plan.samples);
    let output = match &args.output {
        Some(path) => path.clone(),
        None => default_name(args, &plan, own_size)?,
    };
    let format = Format::of(&output, args, plan.size)?;
    let stats = args.stats.as_deref();
    let outputs = [("the picture", Some(output.as_path())), ("--stats", stats)];
    apart(&outputs)?;
    spared(&outputs, &plan.scene.files())?;
    // A picture may take the place of the one whose preset it was rendered from.
    let preset = preset::file(&args.preset).map(|file| ("the preset", file));
    spared(&outputs[1..], preset.as_slice())?;
    let extras = extras(args, format);
    let per_pixel = format.bytes_per_pixel(args.layer, extras);
    memory::check(&plan.resolved(extras), per_pixel, &assets)?;
    for note in plan.scene.notes(&assets) {
        say(&format!("note: {note}"));
    }
    if args.explain {
        let _progress = Reporter::start("explaining");
        return explain(args, &plan, &assets, extras);
    }
    let picture = Sink::prepare(&output)?;
    let figures = stats.map(Sink::prepare).transpose()?;
    let (mut executor, who) = Executor::open(&args.device)?;
    say(&format!("rendering on {who}"));
    if args.layer == Layer::Error {
        say(&format!(
            "the truth, a slow reference in f64 on the CPU, is rendered too, unless it is kept from before: up to {MOST_ROUNDS} rounds of ever finer steps, which take much longer than the picture"
        ));
    }
    if let Some(warning) = executor.precision_warning(&plan) {
        say(&format!("warning: {warning}"));
    }
    let mut progress = Reporter::start("rendering");
    let mut frame = executor.render(&plan, &assets, extras, &mut progress.watch())?;
    drop(progress);
    let errors = match args.layer {
        Layer::Error => {
            let mut progress = Reporter::start("rendering the truth");
            let watch = &mut progress.watch();
            let (truth, _) = cached(Cache::user().as_ref(), &plan, &assets, watch)?;
            errors(&frame, &truth.frame, &plan.view())
        }
        _ => Vec::new(),
    };
    let mut parcel = Parcel::default();
    let mut progress = Reporter::start("writing the picture");
    progress.report(0.0, "encoding");
    parcel.put(picture, &format.encode(args, &plan, &frame, errors)?)?;
    drop(progress);
    let summary = summary(&output, &frame);
    let is_inside = ends_at_the_eye(&frame, &plan);
    if let Some(figures) = figures {
        warm_times(&mut executor, &plan, &assets, &mut frame)?;
        let stats = Stats::new(&name, &plan, &executor, &frame);
        parcel.put_json(figures, &stats)?;
    }
    interrupt::check()?;
    parcel.hand_over()?;
    say(&summary);
    if is_inside {
        say(
            "warning: every ray ends at the eye, so the picture shows nothing: camera.eye lies inside the solid, or touches it; move it away",
        );
    }
    Ok(())
}

/// A preset with overrides, and the files that it names.
///
/// # Errors
/// The preset, an override or a file is wrong, or an interrupt came.
pub fn loaded(preset: &Path, sets: &[String]) -> Result<(Preset, Assets)> {
    let overrides: Result<Vec<Override>, _> = sets.iter().map(|s| Override::read(s)).collect();
    let preset = preset::load(preset, &overrides?)?;
    let assets = Assets::default();
    let mut progress = Reporter::start("loading");
    progress.report(0.0, "the files of the preset");
    preset.load_assets(&assets)?;
    drop(progress);
    interrupt::check()?;
    Ok((preset, assets))
}

/// The plan at a beat of its film.
///
/// # Errors
/// The film has no such beat, or the plan does not fit there.
pub fn moment(plan: &Plan, beat: f64) -> Result<Plan> {
    let length = plan.time.length;
    if !(0.0..=length).contains(&beat) {
        return Err(usage(format!(
            "the film has no beat {beat}; it lasts from 0 to {length} (time.length)"
        )));
    }
    let at = plan.at(beat);
    at.map_err(|fault| anyhow!("at beat {beat}: {}: {}", fault.key, fault.why))
}

/// Whether no ray comes farther than a hundred-thousandth of the way to the target.
fn ends_at_the_eye(frame: &Frame, plan: &Plan) -> bool {
    let near = 1e-5 * plan.camera.eye.distance(plan.camera.target);
    frame.depth.iter().all(|t| f64::from(*t) <= near)
}

/// Prints what would be run, once all arguments are known to be right: those that a
/// render would refuse are refused here too. No device is opened.
fn explain(args: &Render, plan: &Plan, assets: &Assets, extras: Extras) -> Result<()> {
    for path in args.output.iter().chain(&args.stats) {
        // Nothing is written: what was prepared goes again at once.
        Sink::prepare(path)?;
    }
    Executor::check(&args.device)?;
    let mut text = String::new();
    if args.device == Choice::Cpu {
        text += "on the CPU: the same passes in f64, by the Rust twins of these programs\n";
    }
    if args.layer == Layer::Error {
        text += "compared with the truth: a slow render of the same plan in f64 on the CPU\n";
    }
    text += &pass::explain(plan, assets, extras)?;
    print(text.as_bytes())
}

fn extras(args: &Render, format: Format) -> Extras {
    let mut extras = args.layer.extras();
    extras.normals |= format == Format::Exr;
    extras.count |= args.stats.is_some();
    extras.time = args.stats.is_some();
    extras
}

/// Longest march that is done again for its time, in milliseconds.
const MOST_AGAIN: f64 = 5_000.0;
/// Warm runs that a median is taken of.
const AGAIN: usize = 3;

/// Puts the times of warm runs into a frame, as the first one compiled its programs and
/// counted; only what takes very long keeps the times of that one.
fn warm_times(
    executor: &mut Executor,
    plan: &Plan,
    assets: &Assets,
    frame: &mut Frame,
) -> Result<()> {
    // The warm runs are of one sample.
    if frame.march_ms > MOST_AGAIN || plan.samples > 1 {
        return Ok(());
    }
    let mut runner = Runner::new(executor, assets, "warm runs", AGAIN);
    let runs = (0..AGAIN).map(|i| runner.render(plan, TIMED, &of_how_many("run", i, AGAIN)));
    let mut runs: Vec<Frame> = runs.collect::<Result<_, _>>()?;
    runs.sort_by(|a, b| a.march_ms.total_cmp(&b.march_ms));
    let middle = &runs[AGAIN / 2];
    frame.march_ms = middle.march_ms;
    // What was prepared is kept: only the first time tells what it takes.
    let passes = frame.passes.iter_mut().filter(|p| p.pass.marches());
    for (pass, warm) in passes.zip(middle.marched()) {
        pass.gpu_ms = warm.gpu_ms;
        pass.wall_ms = warm.wall_ms;
    }
    Ok(())
}
