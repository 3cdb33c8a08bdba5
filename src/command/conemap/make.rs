//! `conemarch conemap make HEIGHTS`

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};

use crate::command::conemap::common::{Output, Reading, Writing, of_map, shown};
use crate::command::conemap::convert::kept;
use crate::command::conemap::generate::{Maker, generate, slopes};
use crate::command::executor::device;
use crate::command::failure::usage;
use crate::command::print::say;
use crate::command::sink::{Sink, spared};
use crate::command::{interrupt, memory};
use crate::gpu::device::Choice;
use crate::heightfield::conemap::file::{MapFile, Slopes, decode_bytes, encode, kind_word};
use crate::heightfield::conemap::generate::generator::{Generator, Options};
use crate::heightfield::heights::Patches;
use crate::heightfield::load::PatternSpec;

/// What `make` takes.
#[derive(Args, Debug)]
pub struct Make {
    /// A height map (PNG, EXR, TIFF or .raw), or a field like fbm:512x512,seed=7,power=2.2
    ///
    /// Of several channels the first is the height. Numbers of floats must be 0 to 1, or
    /// --normalize brings them there. Of a cone map the heights in it count. Fields are fbm,
    /// ridges, spikes, checker, sine, noise, stones and bricks; size, seed and power may be
    /// left out.
    #[arg(value_name = "HEIGHTS", value_hint = ValueHint::FilePath)]
    heights: String,

    #[command(flatten)]
    output: Output,

    /// How to make it
    #[arg(long, value_name = "NAME", default_value = "exact", value_parser = generators())]
    generator: Generator,

    #[command(flatten)]
    reading: Reading,

    #[command(flatten)]
    writing: Writing,

    /// Take each sample for a flat box instead of joining four by a patch
    ///
    /// Only the maps of walks depend on it.
    #[arg(long)]
    boxes: bool,

    /// Room in texels that the cones of walk and walk-relaxed leave
    #[arg(long, value_name = "TEXELS")]
    offset: Option<f64>,

    /// Steps along each ray of relaxed-search
    #[arg(long, value_name = "COUNT")]
    search_steps: Option<u32>,

    /// Make every cone as narrow as the narrowest of its eight neighbours
    #[arg(long)]
    min3x3: bool,

    /// auto, gpu, software, cpu, an index, or part of a name
    ///
    /// auto is a hardware adapter, or the CPU in f64 where there is none.
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,
}

fn generators() -> impl TypedValueParser<Value = Generator> {
    let values = Generator::ALL.map(|g| PossibleValue::new(g.name()));
    PossibleValuesParser::new(values)
        .map(|word| Generator::named(&word).unwrap_or(Generator::Exact))
}

/// Makes a map.
///
/// # Errors
/// No heights, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &Make) -> Result<()> {
    let generator = args.generator;
    let options = options(args)?;
    // What is made by name need not be made to know that it is too large.
    if let Some(Ok(named)) = PatternSpec::read(&args.heights) {
        room(generator, named.size)?;
    }
    let loaded = args.reading.load(&args.heights)?;
    let heights = &loaded.heights;
    room(generator, heights.size())?;
    let output = match &args.output.output {
        Some(path) => path.clone(),
        // Never the name of the heights themselves, and the format that keeps all.
        None => PathBuf::from(format!("{}-cones.exr", loaded.name)),
    };
    spared(
        &[("the map", Some(&output))],
        &[("its heights", PathBuf::from(&args.heights))],
    )?;
    let form = args.writing.form(&output, generator.kind())?;
    interrupt::listen();
    let sink = Sink::prepare(&output)?;
    let patches = if args.boxes {
        Patches::Boxes
    } else {
        Patches::Bilinear
    };
    let (maker, who) = Maker::open(&args.device)?;
    say(&format!("making cones on {who}"));
    let start = Instant::now();
    let map = generate(&maker, generator, heights, patches, &options)?;
    let took = start.elapsed().as_secs_f64() * 1e3;
    let mut file = MapFile::new(map, heights, patches, &made_by(generator, &options));
    if form.layout.has_slopes() && form.slopes == Slopes::Whole {
        file.slopes = Some(slopes(&maker, heights)?);
    }
    let bytes = encode(&file, &form).map_err(of_map)?;
    let again = decode_bytes(&bytes).map_err(anyhow::Error::msg);
    let again = again.context("the map could not be read back")?;
    if interrupt::asked() {
        return Err(crate::gpu::render::RenderError::Cancelled.into());
    }
    sink.finish(&bytes)?;
    let [w, h] = file.map.size;
    say(&format!(
        "{}  {w} x {h}  {} by {}, layout {}  {took:.0} ms  {}",
        shown(&output),
        kind_word(file.map.kind),
        generator.name(),
        form.layout.name(),
        kept(&file, &again)
    ));
    Ok(())
}

/// That there is memory for a map of heights of a size.
fn room(generator: Generator, [w, h]: [u32; 2]) -> Result<()> {
    let ratios = u64::from(w) * u64::from(h) * generator.channels() as u64;
    match memory::lacking_maps(ratios, memory::available()) {
        Some(why) => anyhow::bail!(why),
        None => Ok(()),
    }
}

/// What the generator is told; options that it does not know are wrong usage.
fn options(args: &Make) -> Result<Options> {
    let generator = args.generator;
    let strange = |option: &str, whose: &str| {
        let name = generator.name();
        usage(format!(
            "--{option} is for {whose}, and the generator is {name}; leave it out"
        ))
    };
    let mut options = Options {
        min3x3: args.min3x3,
        ..Options::default()
    };
    if let Some(offset) = args.offset {
        if !generator.over_cells() {
            return Err(strange("offset", "walk and walk-relaxed"));
        }
        options.offset = offset;
    }
    if args.boxes && !generator.over_cells() {
        return Err(strange("boxes", "walk and walk-relaxed"));
    }
    if let Some(steps) = args.search_steps {
        if generator != Generator::RelaxedSearch {
            return Err(strange("search-steps", "relaxed-search"));
        }
        options.search_steps = steps;
    }
    options.check().map_err(|e| usage(e.to_string()))?;
    Ok(options)
}

/// The generator as a label calls it, with what it was told.
fn made_by(generator: Generator, options: &Options) -> String {
    let mut words = generator.name().to_string();
    if generator == Generator::RelaxedSearch {
        words.push_str(&format!(", {} steps", options.search_steps));
    }
    if options.min3x3 {
        words.push_str(", least of nine");
    }
    words
}
