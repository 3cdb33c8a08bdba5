//! `conemarch conemap make HEIGHTS [-o MAP]`

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Result;
use clap::builder::TypedValueParser;
use clap::{Args, ValueHint};

use crate::command::arguments::{whole, words};
use crate::command::conemap::maker::MapMaker;
use crate::command::conemap::options::{Reading, Writing, write};
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::print::say;
use crate::command::progress::Reporter;
use crate::command::sink::{Sink, shown, spared};
use crate::command::{interrupt, memory};
use crate::gpu::adapters::Choice;
use crate::heightfield::conemap::file::MapFile;
use crate::heightfield::conemap::generate::generator::{Generator, MOST_SEARCH_STEPS, Options};
use crate::heightfield::heights::Patches;
use crate::heightfield::load::PatternSpec;

/// What `make` takes.
#[derive(Args, Debug)]
pub struct Make {
    /// A height map (PNG, EXR, TIFF or .raw), or a field like fbm:512x512,seed=7,power=2.2
    ///
    /// The first channel of a file holds the heights. Floats must be 0 to 1, unless
    /// --normalize scales them. A cone map's own heights are used. Fields are fbm,
    /// ridges, spikes, checker, sine, noise, stones and bricks; their size, seed and power are
    /// optional.
    #[arg(value_name = "HEIGHTS", value_hint = ValueHint::FilePath)]
    heights: OsString,

    /// Where to write: a .png or .exr file, or - for PNG on standard output [default: NAME-cones.exr in
    /// the current folder]
    #[arg(short, long, value_name = "MAP", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// How the map is made
    #[arg(long, value_name = "NAME", default_value = "exact", value_parser = generators())]
    generator: Generator,

    #[command(flatten)]
    reading: Reading,

    #[command(flatten)]
    writing: Writing,

    /// Make each sample a flat box, instead of joining four samples by a bilinear patch
    ///
    /// Only the maps of walk and walk-relaxed depend on it.
    #[arg(long)]
    boxes: bool,

    /// Texels that are added to each distance in making the cones of walk and walk-relaxed
    /// [default: 2]
    #[arg(long, value_name = "TEXELS")]
    offset: Option<f64>,

    /// Steps along each ray of relaxed-search [default: 128]
    #[arg(long, value_name = "COUNT", value_parser = whole(1, MOST_SEARCH_STEPS))]
    search_steps: Option<u32>,

    /// Make every cone as narrow as the narrowest of its eight neighbours
    #[arg(long)]
    least_of_nine: bool,

    /// auto, gpu, software, cpu, an index, or part of a name
    ///
    /// auto is a hardware adapter, or the CPU if there is none.
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,
}

fn generators() -> impl TypedValueParser<Value = Generator> {
    words(Generator::ALL.map(|g| (g, g.name(), g.facts().about)))
}

/// Makes a map.
///
/// # Errors
/// There are no heights, the device fails, the file cannot be written, or an interrupt.
pub fn run(args: &Make) -> Result<()> {
    interrupt::listen();
    let generator = args.generator;
    let options = options(args)?;
    // The size of a field is known before its heights are made.
    let field = args.heights.to_str().and_then(PatternSpec::read);
    if let Some(Ok(field)) = field {
        check_memory(args, generator, field.size)?;
    }
    let mut progress = Reporter::start("making cones");
    let step = (&mut progress, "step 1 of 3: heights");
    let loaded = args.reading.load(&args.heights, step)?;
    let heights = &loaded.heights;
    check_memory(args, generator, heights.size())?;
    // The default name is never that of the heights, and its format keeps everything.
    let mut default = loaded.name.clone();
    default.push("-cones.exr");
    let output = args.output.clone().unwrap_or(default.into());
    spared(
        &[("the map", Some(&output))],
        &[("its heights", Path::new(&args.heights).into())],
    )?;
    let format = args.writing.format(&output, generator.kind())?;
    let sink = Sink::prepare(&output)?;
    let patches = match args.boxes {
        true => Patches::Boxes,
        false => Patches::Bilinear,
    };
    // Software adapters run on the same cores, which are faster without them.
    let (executor, who) = Executor::open_with(&args.device, false)?;
    say(&format!("making cones on {who}"));
    let start = Instant::now();
    let cones = format!("step 2 of 3: cones by {}", generator.name());
    let watch = &mut |done| progress.report_step(done, &cones);
    let mut maker = MapMaker::new(&executor);
    let map = maker.generate(generator, heights, patches, &options, watch)?;
    let took = start.elapsed().as_secs_f64() * 1e3;
    progress.report_step(0.0, "step 3 of 3: the file");
    let file = MapFile::new(map, heights, patches, &made_by(generator, &options));
    interrupt::check()?;
    let what_is_kept = write(&file, &format, sink)?;
    drop(progress);
    let [w, h] = file.map.size;
    say(&format!(
        "{}  {w} x {h}  {} by {}, layout {}  {took:.0} ms  {what_is_kept}",
        shown(&output),
        file.map.kind.name(),
        generator.name(),
        format.layout.name(),
    ));
    Ok(())
}

/// Checks that there is memory for a map of heights of a size.
fn check_memory(args: &Make, generator: Generator, [w, h]: [u32; 2]) -> Result<()> {
    let ratios = u64::from(w) * u64::from(h) * generator.channels() as u64;
    memory::check_map(ratios, &args.device)
}

/// Whether an option applies to a generator.
type Fact = fn(Generator) -> bool;

/// The generator's options. An option that the generator does not have is wrong usage.
fn options(args: &Make) -> Result<Options> {
    let generator = args.generator;
    let cells: Fact = Generator::over_cells;
    for (given, option, applies) in [
        (args.offset.is_some(), "offset", cells),
        (args.boxes, "boxes", cells),
        (
            args.search_steps.is_some(),
            "search-steps",
            Generator::counts_steps,
        ),
    ] {
        if given && !applies(generator) {
            let owners = Generator::ALL.into_iter().filter(|g| applies(*g));
            let owners: Vec<&str> = owners.map(Generator::name).collect();
            return Err(usage(format!(
                "--{option} is for {}, and the generator is {}; leave it out",
                owners.join(" and "),
                generator.name()
            )));
        }
    }
    let usual = Options::default();
    let options = Options {
        min3x3: args.least_of_nine,
        offset: args.offset.unwrap_or(usual.offset),
        search_steps: args.search_steps.unwrap_or(usual.search_steps),
    };
    options.check().map_err(|e| usage(e.to_string()))?;
    Ok(options)
}

/// The generator with its options, as the label of a map names it.
fn made_by(generator: Generator, options: &Options) -> String {
    let mut words = generator.name().to_string();
    if generator.counts_steps() {
        words.push_str(&format!(", {} steps", options.search_steps));
    }
    if options.min3x3 {
        words.push_str(", least of nine");
    }
    words
}
