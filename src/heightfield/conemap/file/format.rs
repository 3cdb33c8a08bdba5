//! The layouts of cone map files.
//!
//! | layout | file | channels |
//! |---|---|---|
//! | `dummer` | PNG, RGBA | height, ratio, slope along x, slope along y ([`Slopes`]) |
//! | `relief` | PNG, RGBA | normal x, normal y, ratio, depth (1 less the height) |
//! | `pair` | PNG, grey and alpha | height, ratio |
//! | `quad` | PNG, RGBA | ratios to +x, -x, +y, -y |
//! | `full` | EXR, f32 | `height`, and `ratio` or `ratio.E`, `.W`, `.S`, `.N` |
//!
//! A ratio of 1 in a file is that of the papers: one texture width of horizontal
//! distance per whole height. The papers only have square maps; here the width is the longer
//! axis of the heights, so that the channel never holds less than it could. The label says
//! how many texels that is.
//!
//! The heights are those of the samples, or for cones over cells those of the cells' highest
//! points.

use crate::base::named::named_enum;
use crate::heightfield::{FileError, MapKind};
use crate::raster::png::BitDepth;

named_enum! {
    /// What a channel of a PNG holds. Slopes and normals are only used for shading.
    pub enum Channel {
        /// A height.
        Height = "height",
        /// 1 less the height.
        Depth = "depth",
        /// A ratio.
        Ratio = "ratio",
        /// The slope along x.
        SlopeX = "slope x",
        /// The slope along y.
        SlopeY = "slope y",
        /// The normal's x.
        NormalX = "normal x",
        /// The normal's y.
        NormalY = "normal y",
    }
}

/// What is particular to a layout.
#[derive(Clone, Copy, Debug)]
pub struct LayoutFacts {
    /// What its channels hold, in words.
    pub about: &'static str,
    /// What each channel of a PNG holds; none for an EXR.
    pub channels: &'static [Channel],
    /// The channel with the heights, in words.
    pub heights: &'static str,
    /// What the cones of other programs promise in this layout.
    pub foreign: MapKind,
    /// Bits by default.
    pub bits: BitDepth,
    /// How numbers stand for ratios by default.
    pub ratio: RatioScale,
}

use Channel::{Depth, Height, NormalX, NormalY, Ratio, SlopeX, SlopeY};

/// As in most papers: 8 bits and a square root.
const USUAL: LayoutFacts = LayoutFacts {
    about: "",
    channels: &[],
    heights: "red",
    foreign: MapKind::Samples,
    bits: BitDepth::Eight,
    ratio: RatioScale::Sqrt,
};

named_enum! {
    /// Which channels a file has, and what they mean.
    pub enum Layout: LayoutFacts {
        /// Height, ratio and slopes (Dummer 2006).
        Dummer = "dummer" => LayoutFacts {
            about: "RGBA: height, ratio, slope x, slope y, as in Dummer's paper on cone step mapping, 2006",
            channels: &[Height, Ratio, SlopeX, SlopeY],
            ..USUAL
        },
        /// Normal, ratio and depth (Policarpo and Oliveira 2007), whose shader takes the ratio
        /// as it is.
        Relief = "relief" => LayoutFacts {
            about: "RGBA: normal x, normal y, ratio, depth, as in Policarpo and Oliveira's paper on relaxed cones, 2007",
            channels: &[NormalX, NormalY, Ratio, Depth],
            heights: "alpha, which holds depths",
            foreign: MapKind::Relaxed,
            ratio: RatioScale::Linear,
            ..USUAL
        },
        /// Height and ratio: in no paper, and with 16 bits.
        Pair = "pair" => LayoutFacts {
            about: "grey and alpha: height, ratio",
            channels: &[Height, Ratio],
            heights: "grey",
            bits: BitDepth::Sixteen,
            ..USUAL
        },
        /// Four ratios.
        Quad = "quad" => LayoutFacts {
            about: "RGBA: ratios to +x, -x, +y, -y",
            channels: &[Ratio; 4],
            foreign: MapKind::Quad,
            ..USUAL
        },
        /// Everything in f32.
        Full = "full" => LayoutFacts {
            about: "EXR: everything",
            heights: "the channel height",
            ratio: RatioScale::Linear,
            ..USUAL
        },
    }
}

impl Layout {
    /// Whether it is that of an EXR.
    pub fn is_exr(self) -> bool {
        self.facts().channels.is_empty()
    }

    /// Whether a PNG has a channel.
    pub fn has(self, channel: Channel) -> bool {
        self.facts().channels.contains(&channel)
    }

    /// Checks that the layout can hold a kind of map.
    ///
    /// # Errors
    /// It cannot.
    pub fn check(self, kind: MapKind) -> Result<(), FileError> {
        self.lacks(kind).map_or(Ok(()), |why| Err(self.error(why)))
    }

    pub(crate) fn error(self, why: &str) -> FileError {
        FileError::Usage(format!("the layout `{}` {why}", self.name()))
    }

    /// Why the layout cannot hold a kind of map, if it cannot.
    pub fn lacks(self, kind: MapKind) -> Option<&'static str> {
        let ratios = self.facts().channels.iter().filter(|c| **c == Ratio);
        match (ratios.count(), kind.channels()) {
            (0, _) => None,
            (4, 1) => Some("holds four ratios, and the map has one"),
            (1, 4) => Some("holds one ratio, and the map has four; take quad or full"),
            _ if kind.over_cells() && (self.has(SlopeX) || self.has(NormalX)) => Some(
                "holds what belongs to samples, and a walk's map is of cells; take pair or full",
            ),
            _ => None,
        }
    }
}

named_enum! {
    /// What slopes mean.
    pub enum Slopes: &'static str {
        /// As Dummer's text and shader take them: 0.5 is flat, and 0 and 1 are half
        /// the height down or up over one texel.
        Whole = "whole" => "slopes, as the shader in Dummer's paper takes them",
        /// As his program stores them (appendix B): half of the differences of the file's own
        /// heights, and half of that at borders, which never wrap; 127 of 255 is flat.
        Half = "half" => "half slopes, as the program in Dummer's paper stores them",
    }
}

named_enum! {
    /// How whole numbers stand for ratios.
    pub enum RatioScale: &'static str {
        /// By their square root, which keeps more of the small ratios that most are.
        Sqrt = "sqrt" => "as square roots, which store narrow cones more exactly",
        /// As they are.
        Linear = "linear" => "as they are",
    }
}

/// How a map is stored in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFormat {
    /// The channels.
    pub layout: Layout,
    /// Their bits, where they are whole numbers.
    pub bits: BitDepth,
    /// How they stand for ratios.
    pub ratio: RatioScale,
    /// Height of 1 in texture widths, for normals.
    pub depth: f64,
    /// What slopes mean.
    pub slopes: Slopes,
}

impl MapFormat {
    /// A layout with its defaults.
    pub fn new(layout: Layout) -> Self {
        Self {
            layout,
            bits: layout.facts().bits,
            ratio: layout.facts().ratio,
            // The surface is a quarter as deep as it is wide; deeper ones are rare.
            depth: 0.25,
            slopes: Slopes::Whole,
        }
    }
}
