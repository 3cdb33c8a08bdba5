//! `conemarch render PRESET`

use std::io::{Cursor, IsTerminal};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};
use indicatif::{ProgressBar, ProgressStyle};

use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::print::{print, say};
use crate::command::sink::{Parcel, Sink, apart, is_stdout, spared};
use crate::command::stats::{Stats, shares, undecided};
use crate::command::{interrupt, memory, size};
use crate::gpu::RenderError;
use crate::gpu::device::Choice;
use crate::measure::truth::{self, Cache};
use crate::pass;
use crate::pass::progress::Progress;
use crate::picture::frame::Frame;
use crate::picture::{BitDepth, Layer, Shades, write_exr, write_png};
use crate::plan::{Extras, Pass, Plan};
use crate::preset::{self, Override, Preset};
use crate::scene::Assets;

/// What `render` takes.
#[derive(Args, Debug)]
pub struct Render {
    /// A built-in preset, a .toml file, or a .png that this program wrote
    #[arg(value_name = "PRESET", value_hint = ValueHint::FilePath)]
    preset: String,

    /// Where to write: a .png or .exr file, or - for PNG on standard output
    ///
    /// Left out, it is the preset's name with .png in the current folder. A PNG carries
    /// its preset and can be rendered again. An EXR has the channels R, G, B (linear),
    /// depth.Z, normal.X/Y/Z, position.X/Y/Z, state.Y (0 sky, 1 hit, 2 unconverged), and
    /// steps.Y with --stats.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Width and height in pixels, in place of the preset's
    #[arg(long, value_name = "WxH", value_parser = size::read)]
    size: Option<[u32; 2]>,

    /// Set one value of the preset; may be given again
    ///
    /// Values are TOML; words, fields like fbm:64x64,seed=3 and paths like maps/d8.png need
    /// no quotes. Another scene.kind or scene.formula drops the preset's other values of the
    /// scene.
    #[arg(long, value_name = "SECTION.KEY=VALUE", allow_hyphen_values = true)]
    set: Vec<String>,

    /// auto, gpu, software, cpu, an index, or part of a name
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,

    /// What the PNG shows
    #[arg(long, value_name = "LAYER", default_value = "color", value_parser = layers())]
    layer: Layer,

    /// Bits per channel of the PNG [default: 8]
    #[arg(long, value_name = "BITS", value_parser = depths())]
    depth: Option<BitDepth>,

    /// Count work and write the figures as JSON, - for standard output
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    stats: Option<PathBuf>,

    /// Print the passes and programs of this very command, and render nothing
    #[arg(long)]
    explain: bool,
}

const LAYERS: [(&str, Layer, &str); 7] = [
    ("color", Layer::Color, "light, tone-mapped"),
    (
        "depth",
        Layer::Depth,
        "grey: nearest black, farthest 95 % white, linear between, sky white",
    ),
    (
        "normal",
        Layer::Normal,
        "world normals, x y z as red green blue, -1..1 to 0..1; sky mid grey",
    ),
    (
        "position",
        Layer::Position,
        "world positions, each axis from its least to its greatest in the picture; sky black",
    ),
    (
        "steps",
        Layer::Steps,
        "evaluations: violet none, yellow the 99th percentile and above",
    ),
    (
        "state",
        Layer::State,
        "sky dark blue, hit light grey, unconverged magenta",
    ),
    (
        "error",
        Layer::Error,
        "depth against the truth: grey none, red 8 footprints too deep or lost, blue too near",
    ),
];

fn layers() -> impl TypedValueParser<Value = Layer> {
    let values = LAYERS.map(|(name, _, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(values).map(|name| {
        let found = LAYERS.iter().find(|(n, _, _)| *n == name);
        found.map_or(Layer::Color, |(_, layer, _)| *layer)
    })
}

fn depths() -> impl TypedValueParser<Value = BitDepth> {
    PossibleValuesParser::new(["8", "16"]).map(|bits| match bits.as_str() {
        "16" => BitDepth::Sixteen,
        _ => BitDepth::Eight,
    })
}

/// What becomes of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
}

/// Renders a preset.
pub fn run(args: &Render) -> Result<()> {
    let overrides: Result<Vec<Override>, _> = args.set.iter().map(|s| Override::read(s)).collect();
    let preset = preset::load(&args.preset, &overrides?)?;
    let assets = Assets::default();
    preset.load_assets(&assets)?;
    let Preset { name, mut plan, .. } = preset;
    if let Some(size) = args.size {
        plan.size = size;
    }
    let output = match &args.output {
        Some(path) => path.clone(),
        None => PathBuf::from(format!("{name}.png")),
    };
    let format = format(args, &output)?;
    let stats = args.stats.as_deref();
    let outputs = [("the picture", Some(output.as_path())), ("--stats", stats)];
    apart(&outputs)?;
    spared(&outputs, &plan.scene.files())?;
    // A picture may take the place of the one whose preset it was rendered from.
    let preset = preset::file(&args.preset).map(|file| ("the preset", file));
    spared(&outputs[1..], preset.as_slice())?;
    let extras = extras(args, format);
    let per_pixel = bytes_per_pixel(format, args.device == Choice::Cpu);
    if let Some(why) = memory::lacking(plan.size, per_pixel, memory::available()) {
        anyhow::bail!(why);
    }
    if let Some(why) = memory::lacking_for(&plan.lean(extras), &assets, memory::available()) {
        anyhow::bail!(why);
    }
    for note in plan.scene.notes(&assets) {
        say(&format!("note: {note}"));
    }
    if args.explain {
        return explain(args, &plan, &assets, extras);
    }
    interrupt::listen();
    let picture = Sink::prepare(&output)?;
    let figures = stats.map(Sink::prepare).transpose()?;
    let (mut executor, who) = Executor::open(&args.device)?;
    say(&format!("rendering on {who}"));
    if let Some(warning) = executor.precision_warning(&plan) {
        say(&format!("warning: {warning}"));
    }
    let frame = march(&mut executor, &plan, &assets, extras)?;
    let preset = preset::write(&plan);
    let truth = match args.layer {
        Layer::Error => {
            say("rendering the truth to compare with, in f64");
            let watch = &mut |_: &_| !interrupt::asked();
            Some(truth::cached(Cache::user().as_ref(), &plan, &assets, watch)?.0)
        }
        _ => None,
    };
    let view = plan.view();
    let draw = || {
        let shades = Shades::new(args.layer, &frame, &plan);
        match &truth {
            Some(truth) => shades.against(&truth.frame, &view),
            None => shades,
        }
    };
    let depth = args.depth.unwrap_or_default();
    let mut parcel = Parcel::default();
    let mut content = Vec::new();
    let to = &mut Cursor::new(&mut content);
    match format {
        Format::Png => write_png(to, &draw(), depth, &preset)?,
        Format::Exr => write_exr(to, &frame, &plan)?,
    }
    parcel.put(picture, &content)?;
    drop(content);
    if let Some(figures) = figures {
        let mut frame = frame.clone();
        warm_times(&mut executor, &plan, &assets, &mut frame)?;
        let stats = Stats::new(&name, &plan, &executor, &frame);
        let mut text = serde_json::to_vec_pretty(&stats)?;
        text.push(b'\n');
        parcel.put(figures, &text)?;
    }
    if interrupt::asked() {
        return Err(RenderError::Cancelled.into());
    }
    parcel.hand_over()?;
    say(&summary(&output, &frame));
    if ends_at_the_eye(&frame, &plan) {
        say(
            "warning: every ray ends at the eye: camera.eye lies inside the solid, or against it, and there is nothing to see; move it away",
        );
    }
    Ok(())
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
        text += "on the CPU: the same passes in f64, by the twins in Rust of these programs\n";
    }
    if args.layer == Layer::Error {
        text += "compared with: the truth of the same plan, in f64 on the CPU\n";
    }
    text += &pass::explain(plan, assets, extras)?;
    print(text.as_bytes())
}

/// The format that a name asks for, if everything else fits it.
fn format(args: &Render, output: &Path) -> Result<Format> {
    let ending = output.extension().and_then(|e| e.to_str());
    let ending = ending.unwrap_or_default().to_lowercase();
    let format = match ending.as_str() {
        _ if is_stdout(output) => Format::Png,
        "png" => Format::Png,
        "exr" => Format::Exr,
        _ => {
            return Err(usage(format!(
                "`{}` ends in neither .png nor .exr, which say what to write; - would be PNG on standard output",
                output.display()
            )));
        }
    };
    if format == Format::Exr && args.layer != Layer::Color {
        return Err(usage(
            "an EXR has all layers; leave --layer out, or write a .png",
        ));
    }
    if format == Format::Exr && args.depth.is_some() {
        return Err(usage(
            "an EXR has 32 bits per channel; leave --depth out, or write a .png",
        ));
    }
    Ok(format)
}

/// Most memory that a render takes at once, per pixel.
fn bytes_per_pixel(format: Format, cpu: bool) -> u64 {
    // Measured on 8 million pixels, and rounded up. The CPU executor holds every
    // pixel's hit in f64 on its way; an EXR its channels beside the frame.
    let rendering = if cpu { 140 } else { 60 };
    let writing = match format {
        Format::Png => 60,
        Format::Exr => 115,
    };
    rendering.max(writing)
}

fn extras(args: &Render, format: Format) -> Extras {
    let mut extras = args.layer.extras();
    extras.normals |= format == Format::Exr;
    extras.count |= args.stats.is_some();
    extras.time = args.stats.is_some();
    extras
}

/// Renders with a bar on terminals, until done or interrupted.
fn march(executor: &mut Executor, plan: &Plan, assets: &Assets, extras: Extras) -> Result<Frame> {
    let bar = if std::io::stderr().is_terminal() {
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left");
        ProgressBar::new(1000).with_style(style.context("the progress bar")?)
    } else {
        ProgressBar::hidden()
    };
    bar.enable_steady_tick(Duration::from_millis(200));
    let mut watch = |progress: &Progress| {
        bar.set_position((progress.done * 1000.0) as u64);
        bar.set_message(progress.pass.clone());
        !interrupt::asked()
    };
    let frame = executor.render(plan, assets, extras, &mut watch);
    bar.finish_and_clear();
    Ok(frame?)
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
    if frame.march_ms > MOST_AGAIN {
        return Ok(());
    }
    let extras = Extras {
        depth_only: true,
        time: true,
        ..Extras::default()
    };
    let watch = &mut |_: &_| !interrupt::asked();
    let mut runs = Vec::new();
    for _ in 0..AGAIN {
        runs.push(executor.render(plan, assets, extras, watch)?);
    }
    runs.sort_by(|a, b| a.march_ms.total_cmp(&b.march_ms));
    let middle = &runs[AGAIN / 2];
    frame.march_ms = middle.march_ms;
    // What was prepared is kept: only the first time tells what it takes.
    let passes = frame.passes.iter_mut().filter(|p| p.pass.marches());
    let warm = middle.marched();
    for (pass, warm) in passes.zip(warm) {
        pass.gpu_ms = warm.gpu_ms;
        pass.wall_ms = warm.wall_ms;
    }
    Ok(())
}

/// One line about a finished picture.
fn summary(output: &Path, frame: &Frame) -> String {
    let [w, h] = frame.size;
    let color = frame.passes.iter().find(|p| p.pass == Pass::Color);
    let color = color.map_or(String::new(), |p| format!(", colour {:.0} ms", p.wall_ms));
    let made: Vec<f64> = frame
        .passes
        .iter()
        .filter(|p| matches!(p.pass, Pass::Prepare(_)))
        .map(|p| p.wall_ms)
        .collect();
    let cones = match made.len() {
        0 => String::new(),
        n => format!(
            "cone map{} {:.0} ms, ",
            if n > 1 { "s" } else { "" },
            made.iter().sum::<f64>()
        ),
    };
    let [sky, hit, unconverged] = shares(frame).map(|s| 100.0 * s);
    let shadows = match 100.0 * undecided(frame) {
        share if share < 0.05 => String::new(),
        share => format!(", shadows cut short {share:.1} %"),
    };
    let name = match output.to_str() {
        Some("-") => "standard output".into(),
        _ => output.display().to_string(),
    };
    format!(
        "{name}  {w} x {h}  {cones}march and trace {:.0} ms{color}  hit {hit:.1} %, sky {sky:.1} %, unconverged {unconverged:.1} %{shadows}",
        frame.march_ms
    )
}
