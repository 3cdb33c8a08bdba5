//! Options that the verbs of `conemap` share: how heights are read, what the map of another
//! program is, and how a map is written.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Context, Result};
use clap::Args;
use clap::builder::TypedValueParser;

use crate::command::arguments::{bits, samples, words};
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::print::say;
use crate::command::progress::Reporter;
use crate::command::sink::{Sink, ending, is_stdout};
use crate::heightfield::conemap::MapKind;
use crate::heightfield::conemap::file::{
    Channel, ForeignFormat, Layout, MapFile, MapFormat, RatioScale, Slopes, decode, decode_bytes,
    encode, has_map,
};
use crate::heightfield::heights::wrap_name;
use crate::heightfield::load::{LoadOptions, Loaded, load};
use crate::raster::png::BitDepth;

/// How heights are read.
#[derive(Args, Clone, Copy, Debug)]
pub struct Reading {
    /// Axes along which the map repeats
    #[arg(long, value_name = "AXES", default_value = "none", value_parser = wraps())]
    pub wrap: [bool; 2],

    /// Read the numbers as depths instead of heights
    #[arg(long)]
    pub invert: bool,

    /// Scale the lowest height to 0 and the highest to 1
    #[arg(long)]
    pub normalize: bool,

    /// Columns and rows of a raw file whose name does not say them
    #[arg(long, value_name = "WxH", value_parser = samples)]
    pub size: Option<[u32; 2]>,
}

impl Reading {
    /// Reads heights as a step of a work, and says what was left out of them.
    pub fn load(
        &self,
        argument: &OsStr,
        (progress, step): (&mut Reporter, &str),
    ) -> Result<Loaded> {
        let options = LoadOptions {
            wrap: self.wrap,
            invert: self.invert,
            normalize: self.normalize,
            size: self.size,
        };
        let watch = &mut |share| progress.report_step(share, step);
        let loaded = load(argument, &options, watch);
        interrupt::check()?;
        let loaded = loaded?;
        if let Some(note) = &loaded.note {
            say(&format!("note: {note}"));
        }
        Ok(loaded)
    }

    /// An option that was given and is only for heights; `wraps` if `--wrap` has another use.
    pub fn given(&self, wraps: bool) -> Option<&'static str> {
        first_given(&[
            (self.wrap != [false; 2] && !wraps, "--wrap"),
            (self.invert, "--invert"),
            (self.normalize, "--normalize"),
            (self.size.is_some(), "--size"),
        ])
    }
}

/// The first option of a list that was given.
fn first_given(options: &[(bool, &'static str)]) -> Option<&'static str> {
    let found = options.iter().find(|(given, _)| *given);
    found.map(|(_, name)| *name)
}

/// `none`, `x`, `y` or `xy`.
pub fn wraps() -> impl TypedValueParser<Value = [bool; 2]> {
    let values = [
        ([false, false], "both axes end"),
        ([true, false], "rows wrap"),
        ([false, true], "columns wrap"),
        ([true, true], "the map is a tile"),
    ];
    words(values.map(|(wrap, help)| (wrap, wrap_name(wrap), help)))
}

/// What a map of another program is.
#[derive(Args, Clone, Copy, Debug)]
pub struct Foreign {
    /// Read a PNG of another program as a map of this layout
    #[arg(long, value_name = "LAYOUT", value_parser = layouts())]
    from: Option<Layout>,

    /// How that PNG stores the ratios of cones [default: sqrt, for relief linear]
    #[arg(long, value_name = "HOW", value_parser = ratio_scales(), requires = "from")]
    from_ratio: Option<RatioScale>,
}

impl Foreign {
    /// Reads a map, and says what is unknown about it. `wrap` is for maps of other programs.
    pub fn decode(&self, path: &Path, wrap: [bool; 2]) -> Result<MapFile> {
        // If the file cannot be read, `decode` reports it below.
        if self.is_given() && has_map(path) {
            return Err(usage(format!(
                "{} has a label that says what its cones are, and --from is for the maps of other programs; leave it out",
                path.display()
            )));
        }
        let foreign = self.from.map(|layout| ForeignFormat {
            layout,
            ratio: self.from_ratio.unwrap_or(MapFormat::new(layout).ratio),
            wrap,
        });
        let file = decode(path, foreign.as_ref())?;
        if let Some(why) = file.unknown() {
            say(&format!("note: {} {why}", path.display()));
        }
        Ok(file)
    }

    /// Whether the file is said to be a map of another program.
    pub fn is_given(&self) -> bool {
        self.from.is_some()
    }
}

/// How a map is written.
#[derive(Args, Clone, Copy, Debug)]
pub struct Writing {
    /// Channels of a PNG [default: depends on the kind of map]
    #[arg(long, value_name = "LAYOUT", value_parser = layouts())]
    layout: Option<Layout>,

    /// Bits per channel of a PNG [default: 8, for pair 16]
    #[arg(long, value_name = "BITS", value_parser = bits())]
    bits: Option<BitDepth>,

    /// How a PNG stores the ratios of cones [default: sqrt, for relief linear]
    #[arg(long, value_name = "HOW", value_parser = ratio_scales())]
    ratio: Option<RatioScale>,

    /// How deep the surface is, in widths of the map, for the normals of layout relief [default: 0.25]
    #[arg(long, value_name = "WIDTHS", value_parser = depth)]
    depth: Option<f64>,

    /// Whether the slopes of layout dummer are those of the surface or half of them [default: whole]
    #[arg(long, value_name = "WHAT", value_parser = slopes())]
    slopes: Option<Slopes>,
}

impl Writing {
    /// The format for a file's name and a kind of map.
    pub fn format(&self, output: &Path, kind: MapKind) -> Result<MapFormat> {
        let layout = match ending(output).as_str() {
            "exr" => Layout::Full,
            other if other == "png" || is_stdout(output) => {
                self.layout.unwrap_or(kind.facts().layout)
            }
            _ => {
                return Err(usage(format!(
                    "`{}` must end in .png or .exr, which is the format to write; - writes PNG to standard output",
                    output.display()
                )));
            }
        };
        let given = first_given(&[
            (self.layout.is_some(), "--layout"),
            (self.bits.is_some(), "--bits"),
            (self.ratio.is_some(), "--ratio"),
            (self.depth.is_some(), "--depth"),
            (self.slopes.is_some(), "--slopes"),
        ]);
        if let (true, Some(option)) = (layout.is_exr(), given) {
            return Err(usage(format!(
                "an EXR holds everything in 32 bits; leave out {option}, or write a .png"
            )));
        }
        layout.check(kind)?;
        for (is_given, option, whose, channel) in [
            (self.depth.is_some(), "--depth", "normals", Channel::NormalX),
            (self.slopes.is_some(), "--slopes", "slopes", Channel::SlopeX),
        ] {
            if is_given && !layout.has(channel) {
                let owner = Layout::ALL.into_iter().find(|l| l.has(channel));
                let (owner, layout) = (owner.map_or("", Layout::name), layout.name());
                return Err(usage(format!(
                    "{option} is for the {whose} of {owner}, and the layout is {layout}; leave it out, or add --layout {owner}"
                )));
            }
        }
        let usual = MapFormat::new(layout);
        Ok(MapFormat {
            layout,
            bits: self.bits.unwrap_or(usual.bits),
            ratio: self.ratio.unwrap_or(usual.ratio),
            depth: self.depth.unwrap_or(usual.depth),
            slopes: self.slopes.unwrap_or(usual.slopes),
        })
    }
}

/// Writes a map and reads it back: how much of its ratios the file keeps, in words.
pub fn write(file: &MapFile, format: &MapFormat, sink: Sink) -> Result<String> {
    let bytes = encode(file, format)?;
    let again = decode_bytes(&bytes).map_err(anyhow::Error::msg);
    let again = again.context("the map could not be read back")?;
    sink.finish(&bytes)?;
    let [was, is] = [file, &again].map(MapFile::mean_share);
    let share = if was > 0.0 { is / was } else { 1.0 };
    // Rounded down, but for a loss that nobody could notice.
    let share = if share > 0.999_999 { 1.0 } else { share };
    let share = (share * 1e4).floor() / 1e2;
    Ok(format!(
        "mean ratio (radius over height) of the cones {is:.4} map widths, {share} % of the ratio before the file rounded it"
    ))
}

fn depth(text: &str) -> Result<f64, String> {
    let read: Option<f64> = text.parse().ok().filter(|d| (1e-3..=1e3).contains(d));
    read.ok_or_else(|| "must be a number from 0.001 to 1000, like 0.25".into())
}

/// The layouts of PNGs.
fn layouts() -> impl TypedValueParser<Value = Layout> {
    let png = Layout::ALL.into_iter().filter(|l| !l.is_exr());
    words(png.map(|l| (l, l.name(), l.facts().about)))
}

fn slopes() -> impl TypedValueParser<Value = Slopes> {
    words(Slopes::ALL.map(|slopes| (slopes, slopes.name(), slopes.facts())))
}

fn ratio_scales() -> impl TypedValueParser<Value = RatioScale> {
    words(RatioScale::ALL.map(|scale| (scale, scale.name(), scale.facts())))
}
