//! `conemarch render PRESET`

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use clap::builder::TypedValueParser;
use clap::{Args, ValueHint};

use crate::base::key::Fault;
use crate::command::arguments::{noise, pixel_samples, size, words};
use crate::command::bands::{Bands, BigPicture};
use crate::command::bench::common::of_how_many;
use crate::command::bench::runner::{Runner, TIMED};
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::output::{Format, Options, default_name};
use crate::command::print::{deliver, print, say};
use crate::command::progress::Reporter;
use crate::command::sink::{Results, Sink, apart, rescued, spared};
use crate::command::stats::{Figures, Stats, summary};
use crate::command::tile::Tile;
use crate::command::unfinished::{beside, is_left};
use crate::command::{completions, interrupt, memory, tile};
use crate::gpu::adapters::Choice;
use crate::measure::truth::{Cache, MOST_ROUNDS, cached};
use crate::pass;
use crate::picture::Layer;
use crate::picture::frame::{Frame, errors};
use crate::plan::{Extras, Plan};
use crate::preset::{self, Override, Preset};
use crate::scene::Assets;

/// What `render` takes.
#[derive(Args, Debug)]
pub struct Render {
    /// A built-in preset, a .toml file, or a .png or .exr file that this program wrote
    #[arg(value_name = "PRESET", add = completions::presets())]
    pub(crate) preset: PathBuf,

    /// Where to write: a .png, .jpg, .webp or .exr file, or - for PNG on standard output
    ///
    /// Without -o the picture goes to the current folder as NAME.png, with --set as
    /// NAME-camera.fov=60.png, with another --size as NAME-640x360.png, with --samples as
    /// NAME-samples=16.png, with --until as NAME-until=0.004.png, with --at as NAME-at=2.png, and with
    /// another --layer as NAME.depth.png. Only a picture of the same layer, depth and settings is
    /// replaced, or one that is older than the preset's .toml file. A picture that another
    /// program has changed counts as the same, if that program kept the preset in it.
    ///
    /// PNG and EXR files carry their preset and can be rendered again; JPEG and WebP carry none.
    /// WebP is without loss.
    ///
    /// An EXR has linear light in R, G and B: twice the number is twice the light. Alpha is 1, or the
    /// share of hits where image.background is transparent. Z is the depth along the view axis, and
    /// depth.Z the one along the ray. Both are 1e10 for sky. There are normals and positions, which
    /// are 0 for sky, and states (0 sky, 1 hit, 2 unconverged: the ray reached its step limit).
    /// Pictures of two or more samples have variance.Y, the variance of the luminance. With --until
    /// there is samples.Y, and with --stats there is steps.Y. The attributes contain the preset and
    /// the camera.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Width and height in pixels [default: the preset's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,

    /// Samples, which are rays through each pixel: 1 is quick, 16 is smooth [default: the preset's]
    #[arg(long, value_name = "N", value_parser = pixel_samples())]
    pub(crate) samples: Option<u32>,

    /// Stop sampling a tile when its error is below this, from 0 to 1 [default: the preset's]
    ///
    /// A tile has 64 x 64 pixels. Its error is measured after 8, 16, 32 and so on samples. It has at
    /// most --samples. 0.004 is one level of 8 bits; 0 takes all samples everywhere.
    #[arg(long, value_name = "NOISE", value_parser = noise, allow_negative_numbers = true)]
    pub(crate) until: Option<f64>,

    /// Set one value of the preset; may be given again
    ///
    /// Values are TOML. Words, fields like fbm:64x64,seed=3 and paths like maps/d8.png need
    /// no quotes. If you set another scene.kind or scene.formula, all other keys of [scene] return
    /// to their defaults.
    #[arg(long, value_name = "SECTION.KEY=VALUE", allow_hyphen_values = true)]
    #[arg(add = completions::settings())]
    pub(crate) set: Vec<String>,

    /// Who renders: auto, gpu, software, cpu, or an index or part of a name from `devices`
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,

    /// What the picture shows
    #[arg(long, value_name = "LAYER", default_value = "color", value_parser = layers())]
    pub(crate) layer: Layer,

    #[command(flatten)]
    pub(crate) options: Options,

    /// Continue an unfinished picture. The result has the same bytes as a picture made at once
    ///
    /// A PNG or EXR of more than 16 megapixels is rendered in bands of rows. FILE.part beside the picture
    /// FILE keeps each finished band. It is removed when the picture is complete. After an interrupt, a
    /// full disk or a kill, the same command with --resume continues the picture. Without --resume,
    /// such a file is never overwritten. With --resume a smaller picture has bands too. If there is no
    /// such file, the picture begins at its first row.
    #[arg(long, conflicts_with_all = ["tile", "stats"])]
    pub(crate) resume: bool,

    /// Render one part of the picture to an .exr file: the column and the row of a grid, from 0
    ///
    /// `conemarch merge` joins the parts. Their pixels are those of the whole picture.
    #[arg(long, value_name = "C,R/CxR", value_parser = Tile::read, requires = "output")]
    tile: Option<Tile>,

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
    words(Layer::ALL.map(|layer| (layer, layer.name(), layer.facts().help)))
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
    plan.until = args.until.unwrap_or(plan.until);
    plan.check_stereo().map_err(at_fault)?;
    let output = match &args.output {
        Some(path) => path.clone(),
        None => default_name(args, &plan, own_size)?,
    };
    if args.layer == Layer::Variance && plan.samples == 1 {
        return Err(usage(
            "one sample has no variance; add --samples 16, for example",
        ));
    }
    if args.layer == Layer::Error && plan.is_stereo() {
        return Err(usage(
            "the layer error is of one view, and camera.stereo asks for two; set camera.stereo=off",
        ));
    }
    let options = args.options();
    let format = Format::of(&output, &options, &plan)?;
    if let Some(tile) = args.tile {
        if plan.is_stereo() {
            return Err(usage(
                "a part of a picture has one view, and camera.stereo asks for two; leave --tile out, or set camera.stereo=off",
            ));
        }
        if format != Format::Exr {
            return Err(usage(
                "a part of a picture is an .exr file; name one with -o, and `merge` makes the picture of all parts",
            ));
        }
        plan.window = Some(tile.window(plan.size)?);
    }
    let bands = Bands::of(args, &plan, format, &output)?;
    let stats = args.stats.as_deref();
    let outputs = [("the picture", Some(output.as_path())), ("--stats", stats)];
    apart(&outputs)?;
    spared(&outputs, &plan.files())?;
    // A picture may take the place of the one whose preset it was rendered from.
    let preset = preset::file(&args.preset).map(|file| ("the preset", file));
    spared(&outputs[1..], preset.as_slice())?;
    let extras = extras(args, format, &plan);
    let per_pixel = format.bytes_per_pixel(args.layer, &plan, extras);
    let mut largest = plan.resolved(extras, &assets).into_owned();
    largest.window = plan.window.or(bands.map(|bands| bands.block(0)));
    memory::check(&largest, per_pixel, &assets, &args.device)?;
    for note in plan.scene.notes(&assets) {
        say(&format!("note: {note}"));
    }
    if args.explain {
        let _progress = Reporter::start("explaining");
        return explain(args, &plan, &assets, extras);
    }
    if bands.is_none() && Bands::can(args, &plan, format, &output) && is_left(&output) {
        say(&format!(
            "note: `{}` keeps bands of a picture that was not finished; --resume goes on with them",
            beside(&output).display()
        ));
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
    let mut results = Results::default();
    let mut big = None;
    let mut made = match (bands, picture) {
        (Some(bands), Sink::File(mut place)) => {
            let to = (output.as_path(), format, bands);
            let of = (&assets, executor.identity());
            let begun = BigPicture::begin((args, &plan, extras), to, of)?;
            let made = big.insert(begun).make(&mut executor, &assets, &mut place)?;
            results.add(place);
            made
        }
        (_, picture) => {
            let content = whole(
                args,
                (&plan, &assets, extras),
                &mut executor,
                (format, &output),
            )?;
            let put = match picture {
                Sink::Stdout => deliver(&content.0),
                file => results.put(file, &content.0).map_err(Into::into),
            };
            put.map_err(|fault| rescued(fault, &content.0, &output))?;
            content.1
        }
    };
    let summary = summary(&output, plan.pixels().size, &made);
    let is_inside = ends_at_the_eye(&made, &plan);
    let mut counted = Ok(());
    if let Some(figures) = figures {
        // What has bands takes long.
        if bands.is_none() {
            warm_times(&mut executor, &plan, &assets, &mut made)?;
        }
        let stats = Stats::new(&name, &plan, &executor, &made);
        // The picture is whole without them.
        counted = results.put_json(figures, &stats);
    }
    let handed = interrupt::check()
        .map_err(Into::into)
        .and_then(|()| results.hand_over());
    match big {
        Some(big) => big.end(handed)?,
        None => handed?,
    }
    say(&summary);
    if is_inside {
        say(
            "warning: every ray ends at the eye, so the picture shows nothing: camera.eye lies inside the solid, or touches it; move it away",
        );
    }
    counted
}

/// Renders a picture at once. Returns its file and its figures.
fn whole(
    args: &Render,
    (plan, assets, extras): (&Plan, &Assets, Extras),
    executor: &mut Executor,
    (format, output): (Format, &Path),
) -> Result<(Vec<u8>, Figures)> {
    let mut progress = Reporter::start("rendering");
    let frame = executor.picture(plan, assets, extras, &mut progress.watch())?;
    drop(progress);
    let errors = match args.layer {
        Layer::Error => {
            let mut progress = Reporter::start("rendering the truth");
            let watch = &mut progress.watch();
            let (truth, _) = cached(Cache::user().as_ref(), plan, assets, watch)?;
            errors(&frame, &truth.frame, &plan.view())
        }
        _ => Vec::new(),
    };
    let mut progress = Reporter::start("writing the picture");
    progress.report(0.0, "encoding");
    let content = match plan.window {
        Some(_) => tile::encode((plan, assets), &frame, executor, output)?,
        None => format.encode(&args.options(), plan, &frame, (errors, output))?,
    };
    Ok((content, Figures::of(&frame)))
}

impl Render {
    fn options(&self) -> Options {
        Options {
            layer: self.layer,
            ..self.options
        }
    }
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

/// A fault of settings that an option of the command changed.
pub fn at_fault(fault: Fault) -> anyhow::Error {
    usage(format!("{}: {}", fault.key, fault.why))
}

/// Whether no ray comes farther than a hundred-thousandth of the way to the target.
fn ends_at_the_eye(figures: &Figures, plan: &Plan) -> bool {
    let near = 1e-5 * plan.camera.eye.distance(plan.camera.target);
    f64::from(figures.tally.farthest) <= near
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
    let eyes = plan.eyes();
    if eyes.is_some() {
        text += "two views side by side, each as the left one here:\n";
    }
    let shown = eyes.as_ref().map_or(plan, |[left, _]| left);
    text += &pass::explain(shown, assets, extras)?;
    print(text.as_bytes())
}

fn extras(args: &Render, format: Format, plan: &Plan) -> Extras {
    let mut extras = args.layer.facts().extras;
    extras.normals |= format == Format::Exr;
    extras.variance |= format == Format::Exr;
    extras.count |= args.stats.is_some();
    extras.time = args.stats.is_some();
    extras.rays = Some(plan.rays());
    extras
}

/// Longest march that is done again for its time, in milliseconds.
const MOST_AGAIN: f64 = 5_000.0;
/// Warm runs that a median is taken of.
const AGAIN: usize = 3;

/// Puts the times of warm runs into figures, as the first one compiled its programs and
/// counted; only what takes very long keeps the times of that one.
fn warm_times(
    executor: &mut Executor,
    plan: &Plan,
    assets: &Assets,
    figures: &mut Figures,
) -> Result<()> {
    // The warm runs are of one sample and one view.
    if figures.march_ms > MOST_AGAIN || plan.samples > 1 || plan.is_stereo() {
        return Ok(());
    }
    let mut runner = Runner::new(executor, assets, "warm runs", AGAIN);
    let extras = Extras {
        rays: Some(plan.rays()),
        ..TIMED
    };
    let runs = (0..AGAIN).map(|i| runner.render(plan, extras, &of_how_many("run", i, AGAIN)));
    let mut runs: Vec<Frame> = runs.collect::<Result<_, _>>()?;
    runs.sort_by(|a, b| a.march_ms.total_cmp(&b.march_ms));
    let middle = &runs[AGAIN / 2];
    figures.march_ms = middle.march_ms;
    // What was prepared is kept: only the first time tells what it takes.
    let passes = figures.passes.iter_mut().filter(|p| p.pass.marches());
    for (pass, warm) in passes.zip(middle.marched()) {
        pass.gpu_ms = warm.gpu_ms;
        pass.wall_ms = warm.wall_ms;
    }
    Ok(())
}
