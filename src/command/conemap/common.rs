//! Options that the sub-verbs of `conemap` share: how heights are read, what a foreign
//! map is, and how a map is written.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueHint};

use crate::command::failure::usage;
use crate::command::print::say;
use crate::command::size;
use crate::heightfield::conemap::MapKind;
use crate::heightfield::conemap::file::{
    Bits, Foreign, Form, Layout, MapError, MapFile, Slopes, decode, has_map,
};
use crate::heightfield::heights::MOST_SAMPLES;
use crate::heightfield::load::{LoadError, LoadOptions, Loaded, load};

/// How heights are read.
#[derive(Args, Clone, Copy, Debug)]
pub struct Reading {
    /// Which axes wrap
    #[arg(long, value_name = "AXES", default_value = "none", value_parser = wraps())]
    pub wrap: [bool; 2],

    /// Turn depths into heights
    #[arg(long)]
    pub invert: bool,

    /// Bring the lowest height to 0 and the highest to 1
    #[arg(long)]
    pub normalize: bool,

    /// Columns and rows of a raw file whose name does not tell
    #[arg(long, value_name = "WxH", value_parser = samples)]
    pub size: Option<[u32; 2]>,
}

impl Reading {
    /// Reads heights, and says what was left out of them.
    pub fn load(&self, argument: &str) -> Result<Loaded> {
        let options = LoadOptions {
            wrap: self.wrap,
            invert: self.invert,
            normalize: self.normalize,
            size: self.size,
        };
        let loaded = load(argument, &options).map_err(of_load)?;
        if let Some(note) = &loaded.note {
            say(&format!("note: {note}"));
        }
        Ok(loaded)
    }

    /// An option that was given and that only heights have a use for; `wraps` if something
    /// else has one for `--wrap`.
    pub fn given(&self, wraps: bool) -> Option<&'static str> {
        let given = [
            (self.wrap != [false; 2] && !wraps, "--wrap"),
            (self.invert, "--invert"),
            (self.normalize, "--normalize"),
            (self.size.is_some(), "--size"),
        ];
        given.iter().find(|(given, _)| *given).map(|(_, o)| *o)
    }
}

fn samples(text: &str) -> Result<[u32; 2], String> {
    let fits = |s: &[u32; 2]| s.iter().all(|n| *n <= MOST_SAMPLES);
    let read = size::read(text).ok().filter(fits);
    read.ok_or_else(|| {
        format!("must be columns x rows, each from 1 to {MOST_SAMPLES}, like 512x256")
    })
}

/// `none`, `x`, `y` or `xy`.
pub fn wraps() -> impl TypedValueParser<Value = [bool; 2]> {
    let values = [
        ("none", "both axes end"),
        ("x", "rows go round"),
        ("y", "columns go round"),
        ("xy", "the map is a tile"),
    ];
    let values = values.map(|(name, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(values).map(|word| [word.contains('x'), word.contains('y')])
}

/// What a map of another program is.
#[derive(Args, Clone, Copy, Debug)]
pub struct Strange {
    /// Read a PNG that another program wrote as a map of this layout
    #[arg(long, value_name = "LAYOUT", value_parser = layouts(&[Layout::Full]))]
    from: Option<Layout>,

    /// How its ratios are to be read [default: sqrt, for relief linear]
    #[arg(long, value_name = "HOW", value_parser = roots(), requires = "from")]
    from_ratio: Option<bool>,
}

impl Strange {
    /// Reads a map, and says what is unknown of it. `wrap` is that of another program's.
    pub fn decode(&self, path: &Path, wrap: [bool; 2]) -> Result<MapFile> {
        // A file that cannot be read is told of below.
        if self.is_said() && has_map(path).unwrap_or(false) {
            return Err(usage(format!(
                "{} says itself what its cones are, and --from is for the maps of other programs; leave it out",
                path.display()
            )));
        }
        let foreign = self.from.map(|layout| Foreign {
            layout,
            kind: match layout {
                Layout::HeightSurface => MapKind::Relaxed,
                Layout::Quad => MapKind::Quad,
                _ => MapKind::Samples,
            },
            root: self.from_ratio.unwrap_or(Form::new(layout).root),
            wrap,
        });
        let file = decode(path, foreign.as_ref()).map_err(of_map)?;
        if let Some(why) = file.unknown() {
            say(&format!("note: {} {why}", path.display()));
        }
        Ok(file)
    }

    /// Whether it was said what the file is.
    pub fn is_said(&self) -> bool {
        self.from.is_some()
    }
}

/// How a map is written.
#[derive(Args, Clone, Copy, Debug)]
pub struct Writing {
    /// Channels of a PNG [default: the usual ones of the map's kind]
    #[arg(long, value_name = "LAYOUT", value_parser = layouts(&[Layout::Full]))]
    layout: Option<Layout>,

    /// Bits per channel of a PNG [default: 8, for pair 16]
    #[arg(long, value_name = "BITS", value_parser = bits())]
    bits: Option<Bits>,

    /// How a PNG holds ratios [default: sqrt, for relief linear]
    #[arg(long, value_name = "HOW", value_parser = roots())]
    ratio: Option<bool>,

    /// Height of 1 in texture widths, for the normals of relief [default: 0.25]
    #[arg(long, value_name = "WIDTHS", value_parser = depth)]
    depth: Option<f64>,

    /// What the slopes of dummer stand for [default: whole]
    #[arg(long, value_name = "WHAT", value_parser = slopes())]
    slopes: Option<Slopes>,
}

impl Writing {
    /// The form for a file's name and a kind of map.
    pub fn form(&self, output: &Path, kind: MapKind) -> Result<Form> {
        let ending = output.extension().and_then(|e| e.to_str()).unwrap_or("");
        let layout = match ending.to_lowercase().as_str() {
            "exr" => Layout::Full,
            "png" => self.layout.unwrap_or(Layout::usual(kind)),
            _ if output.as_os_str() == "-" => self.layout.unwrap_or(Layout::usual(kind)),
            _ => {
                return Err(usage(format!(
                    "`{}` ends in neither .png nor .exr, which say what to write; - would be PNG on standard output",
                    output.display()
                )));
            }
        };
        if layout == Layout::Full {
            let given = [
                (self.layout.is_some(), "--layout"),
                (self.bits.is_some(), "--bits"),
                (self.ratio.is_some(), "--ratio"),
                (self.depth.is_some(), "--depth"),
                (self.slopes.is_some(), "--slopes"),
            ];
            if let Some((_, option)) = given.iter().find(|(given, _)| *given) {
                return Err(usage(format!(
                    "an EXR holds everything as it is, in 32 bits; leave {option} out, or write a .png"
                )));
            }
        }
        if let Some(why) = layout.lacks(kind) {
            let layout = layout.name();
            return Err(of_map(MapError::Layout {
                layout,
                why: why.into(),
            }));
        }
        if self.depth.is_some() && layout != Layout::HeightSurface {
            return Err(usage(format!(
                "--depth is for the normals of relief, and the layout is {}; leave it out, or add --layout relief",
                layout.name()
            )));
        }
        if self.slopes.is_some() && layout != Layout::Dummer {
            return Err(usage(format!(
                "--slopes is for the slopes of dummer, and the layout is {}; leave it out, or add --layout dummer",
                layout.name()
            )));
        }
        let usual = Form::new(layout);
        Ok(Form {
            layout,
            bits: self.bits.unwrap_or(usual.bits),
            root: self.ratio.unwrap_or(usual.root),
            depth: self.depth.unwrap_or(usual.depth),
            slopes: self.slopes.unwrap_or(usual.slopes),
        })
    }
}

fn depth(text: &str) -> Result<f64, String> {
    let read: Option<f64> = text.parse().ok().filter(|d| (1e-3..=1e3).contains(d));
    read.ok_or_else(|| "must be a number from 0.001 to 1000, like 0.25".into())
}

fn layouts(but: &'static [Layout]) -> impl TypedValueParser<Value = Layout> {
    let shown = Layout::ALL.into_iter().filter(|l| !but.contains(l));
    let values = shown.map(|l| {
        PossibleValue::new(l.name()).help(match l {
            Layout::Dummer => "RGBA: height, ratio, slope x, slope y",
            Layout::HeightSurface => "RGBA: normal x, normal y, ratio, depth",
            Layout::Pair => "grey and alpha: height, ratio",
            Layout::Quad => "RGBA: ratios to +x, -x, +y, -y",
            Layout::Full => "EXR: everything",
        })
    });
    PossibleValuesParser::new(values).map(|word| Layout::named(&word).unwrap_or(Layout::Full))
}

fn bits() -> impl TypedValueParser<Value = Bits> {
    PossibleValuesParser::new(["8", "16"]).map(|bits| match bits.as_str() {
        "16" => Bits::Sixteen,
        _ => Bits::Eight,
    })
}

fn slopes() -> impl TypedValueParser<Value = Slopes> {
    let values = Slopes::ALL.map(|slopes| {
        PossibleValue::new(slopes.name()).help(match slopes {
            Slopes::Whole => "the slopes, as Dummer's shader takes them",
            Slopes::Half => "half of them, as Dummer's program stores them",
        })
    });
    PossibleValuesParser::new(values).map(|word| Slopes::named(&word).unwrap_or(Slopes::Whole))
}

fn roots() -> impl TypedValueParser<Value = bool> {
    PossibleValuesParser::new(["sqrt", "linear"]).map(|word| word == "sqrt")
}

/// The file option of `make` and `convert`.
#[derive(Args, Clone, Debug)]
pub struct Output {
    /// Where to write: a .png or .exr file, or - for PNG on standard output
    #[arg(short, long, value_name = "MAP", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}

/// A file as summaries call it.
pub fn shown(path: &Path) -> String {
    match path.to_str() {
        Some("-") => "standard output".into(),
        _ => path.display().to_string(),
    }
}

/// An error of loading, wrong usage where the argument is to blame.
fn of_load(e: LoadError) -> anyhow::Error {
    if e.is_usage() {
        usage(e.to_string())
    } else {
        e.into()
    }
}

/// An error of a map, wrong usage where an option is to blame.
pub fn of_map(e: MapError) -> anyhow::Error {
    if e.is_usage() {
        usage(e.to_string())
    } else {
        e.into()
    }
}
