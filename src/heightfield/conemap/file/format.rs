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

/// What is particular to a layout.
#[derive(Clone, Copy, Debug)]
pub struct LayoutFacts {
    /// What its channels hold, in words.
    pub about: &'static str,
    /// Channels of a PNG, or 0 for an EXR.
    pub channels: usize,
}

named_enum! {
    /// Which channels a file has, and what they mean.
    pub enum Layout: LayoutFacts {
        /// Height, ratio and slopes (Dummer 2006).
        Dummer = "dummer" => LayoutFacts {
            about: "RGBA: height, ratio, slope x, slope y",
            channels: 4,
        },
        /// Normal, ratio and depth (Policarpo and Oliveira 2007).
        Relief = "relief" => LayoutFacts {
            about: "RGBA: normal x, normal y, ratio, depth",
            channels: 4,
        },
        /// Height and ratio.
        Pair = "pair" => LayoutFacts { about: "grey and alpha: height, ratio", channels: 2 },
        /// Four ratios.
        Quad = "quad" => LayoutFacts { about: "RGBA: ratios to +x, -x, +y, -y", channels: 4 },
        /// Everything in f32.
        Full = "full" => LayoutFacts { about: "EXR: everything", channels: 0 },
    }
}

impl Layout {
    /// The PNG layout that a kind of map has by default.
    pub fn usual(kind: MapKind) -> Self {
        match kind {
            MapKind::Samples => Self::Dummer,
            MapKind::Relaxed => Self::Relief,
            MapKind::Quad => Self::Quad,
            MapKind::Walk | MapKind::WalkRelaxed => Self::Pair,
        }
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
        let quad = kind == MapKind::Quad;
        match self {
            Self::Full => None,
            Self::Quad => (!quad).then_some("holds four ratios, and the map has one"),
            _ if quad => Some("holds one ratio, and the map has four; take quad or full"),
            Self::Dummer | Self::Relief if kind.over_cells() => Some(
                "holds what belongs to samples, and a walk's map is of cells; take pair or full",
            ),
            _ => None,
        }
    }
}

/// Bits of a PNG channel, whose whole numbers stand for 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bits {
    /// 0 to 255.
    Eight,
    /// 0 to 65535.
    Sixteen,
}

impl Bits {
    /// The number of bits.
    pub fn count(self) -> u32 {
        match self {
            Self::Eight => 8,
            Self::Sixteen => 16,
        }
    }
}

named_enum! {
    /// What the slopes of [`Layout::Dummer`] mean.
    pub enum Slopes {
        /// As Dummer's text and shader take them: 0.5 is flat, and 0 and 1 are half
        /// the height down or up over one texel.
        Whole = "whole",
        /// As his program stores them (appendix B): half of the differences of the file's own
        /// heights, and half of that at borders, which never wrap; 127 of 255 is flat.
        Half = "half",
    }
}

named_enum! {
    /// How whole numbers stand for ratios.
    pub enum RatioScale {
        /// By their square root, which keeps more of the small ratios that most are.
        Sqrt = "sqrt",
        /// As they are.
        Linear = "linear",
    }
}

/// How a map is stored in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFormat {
    /// The channels.
    pub layout: Layout,
    /// Their bits, where they are whole numbers.
    pub bits: Bits,
    /// How they stand for ratios.
    pub ratio: RatioScale,
    /// Height of 1 in texture widths, for normals.
    pub depth: f64,
    /// What slopes mean.
    pub slopes: Slopes,
}

impl MapFormat {
    /// A layout as in the papers: 8 bits and a square root, but for `relief`, whose
    /// shader takes the ratio as it is. `pair` is in no paper and has 16 bits.
    pub fn new(layout: Layout) -> Self {
        Self {
            layout,
            bits: match layout {
                Layout::Pair => Bits::Sixteen,
                _ => Bits::Eight,
            },
            ratio: match layout {
                Layout::Relief | Layout::Full => RatioScale::Linear,
                _ => RatioScale::Sqrt,
            },
            // The surface is a quarter as deep as it is wide; deeper ones are rare.
            depth: 0.25,
            slopes: Slopes::Whole,
        }
    }
}
