//! What a file holds besides its ratios, and the layouts that it may have.
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
//! distance per whole height. Papers are silent about other than square maps; here the
//! width is the longer axis of the heights, so that the channel never holds less than
//! it could. The label says the texels that it means.
//!
//! Heights are those of the samples, or for walks those of the cells' highest points.

use sha2::{Digest, Sha256};

use crate::heightfield::conemap::file::round::Steps;
use crate::heightfield::conemap::file::words::is_walk;
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::heights::{Heights, Patches};

/// Which channels a file has, and what they mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Height, ratio and slopes (Dummer 2006).
    Dummer,
    /// Normal, ratio and depth (Policarpo and Oliveira 2007).
    HeightSurface,
    /// Height and ratio.
    Pair,
    /// Four ratios.
    Quad,
    /// Everything as it is, in f32.
    Full,
}

impl Layout {
    /// Every layout.
    pub const ALL: [Self; 5] = [
        Self::Dummer,
        Self::HeightSurface,
        Self::Pair,
        Self::Quad,
        Self::Full,
    ];

    /// The word that chooses it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dummer => "dummer",
            Self::HeightSurface => "relief",
            Self::Pair => "pair",
            Self::Quad => "quad",
            Self::Full => "full",
        }
    }

    /// The layout of a word.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.name() == name)
    }

    /// The PNG layout that a kind has unless told otherwise.
    pub fn usual(kind: MapKind) -> Self {
        match kind {
            MapKind::Samples => Self::Dummer,
            MapKind::Relaxed => Self::HeightSurface,
            MapKind::Quad => Self::Quad,
            MapKind::Walk | MapKind::WalkRelaxed => Self::Pair,
        }
    }

    /// Whether slopes, or normals made from them, are in it.
    pub fn has_slopes(self) -> bool {
        matches!(self, Self::Dummer | Self::HeightSurface)
    }

    /// Why a kind has no place in the layout, if so.
    pub fn lacks(self, kind: MapKind) -> Option<&'static str> {
        let quad = kind == MapKind::Quad;
        match self {
            Self::Full => None,
            Self::Quad => (!quad).then_some("holds four ratios, and the map has one"),
            _ if quad => Some("holds one ratio, and the map has four; take quad or full"),
            Self::Dummer | Self::HeightSurface if is_walk(kind) => Some(
                "holds what belongs to samples, and a walk's map is of cells; take pair or full",
            ),
            _ => None,
        }
    }
}

/// Bits of a PNG channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bits {
    /// 0 to 255.
    Eight,
    /// 0 to 65535.
    Sixteen,
}

impl Bits {
    /// How many there are.
    pub fn count(self) -> u32 {
        match self {
            Self::Eight => 8,
            Self::Sixteen => 16,
        }
    }

    /// The numbers of a channel.
    pub fn steps(self) -> Steps {
        Steps {
            most: match self {
                Self::Eight => u16::from(u8::MAX),
                Self::Sixteen => u16::MAX,
            },
        }
    }
}

/// What the slopes of [`Layout::Dummer`] stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// What Dummer's text and his shader take them for: 0.5 is flat, and 0 and 1 are half
    /// the height down or up over one texel.
    Whole,
    /// What his program stores (appendix B): differences of the file's own heights, half of
    /// that, and half of it again at borders, which never wrap; 127 of 255 is flat.
    Half,
}

impl Slopes {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Whole, Self::Half];

    /// The word for it in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::Half => "half",
        }
    }

    /// The slopes of a word.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.name() == name)
    }
}

/// How a map is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// The channels.
    pub layout: Layout,
    /// Their bits, where they are whole numbers.
    pub bits: Bits,
    /// Whether the ratio's channel holds its square root, which keeps more of the small
    /// ratios that most are.
    pub root: bool,
    /// Height of 1 in texture widths, for normals.
    pub depth: f64,
    /// What slopes stand for.
    pub slopes: Slopes,
}

impl Form {
    /// A layout as the papers have it: 8 bits; a square root, but for `relief`, whose
    /// shader takes the ratio as it is. `pair` is no paper's, and has 16 bits.
    pub fn new(layout: Layout) -> Self {
        Self {
            layout,
            bits: if layout == Layout::Pair {
                Bits::Sixteen
            } else {
                Bits::Eight
            },
            root: !matches!(layout, Layout::HeightSurface | Layout::Full),
            // A relief a quarter as deep as it is wide; deeper ones are rare.
            depth: 0.25,
            slopes: Slopes::Whole,
        }
    }
}

/// A channel of a file that only shades, as shares of 0..=1.
#[derive(Clone, Debug, PartialEq)]
pub struct Extra {
    /// What it is.
    pub name: &'static str,
    /// Its numbers, row by row.
    pub shares: Vec<f32>,
}

/// What the numbers of a map do not say.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Samples of the heights along each axis.
    pub samples: [u32; 2],
    /// What lies between them; only the cells of walks depend on it.
    pub patches: Patches,
    /// Texels that a ratio of 1 in the file means.
    pub scale: f64,
    /// [`digest`] of the heights; unknown where another program wrote the file.
    pub digest: Option<String>,
    /// What made the map; unknown where another program wrote the file.
    pub generator: Option<String>,
}

/// A number that tells heights from all others: SHA-256 of their size and bits, in
/// hexadecimal. Wrapping is no part of it.
pub fn digest(heights: &Heights) -> String {
    let mut hash = Sha256::new();
    for n in heights.size() {
        hash.update(n.to_le_bytes());
    }
    for z in heights.data() {
        hash.update(z.to_le_bytes());
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// A cone map with what its file knows of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    /// The cones.
    pub map: ConeMap,
    /// A height for each place, where the file has one: of the sample, or of the cell's
    /// highest point.
    pub heights: Option<Vec<f32>>,
    /// Slopes or normals that were read with it.
    pub extra: Vec<Extra>,
    /// Rise per texel along both axes at each sample, where it was made already; a file
    /// that holds slopes or normals is written with them.
    pub slopes: Option<Vec<[f32; 2]>>,
    /// Whether its ratios were read from whole numbers that are square roots, or such that are
    /// not, here or before they were converted to floats: as numbers of that sort, of whatever
    /// bits, they become again what they were. None for fresh ratios.
    pub origin: Option<bool>,
    /// How it is, was or will be written.
    pub form: Form,
    /// What the file says of the map.
    pub label: Label,
}

impl MapFile {
    /// A fresh map of some heights. `generator` is the word for what made it.
    pub fn new(map: ConeMap, heights: &Heights, patches: Patches, generator: &str) -> Self {
        let form = Form::new(Layout::Full);
        let places = if is_walk(map.kind) {
            heights.apexes(patches)
        } else {
            heights.data().to_vec()
        };
        let label = Label {
            samples: heights.size(),
            patches,
            scale: scale(heights.size()),
            digest: Some(digest(heights)),
            generator: Some(generator.into()),
        };
        Self {
            map,
            heights: Some(places),
            extra: Vec::new(),
            slopes: None,
            origin: None,
            form,
            label,
        }
    }

    /// Mean ratio in units of the scale, none counting for more than 1: cones wider than
    /// the whole texture serve nobody, and would drown all others.
    pub fn mean_share(&self) -> f64 {
        let shares = self
            .map
            .ratios
            .iter()
            .map(|r| (r / self.label.scale).min(1.0));
        shares.sum::<f64>() / self.map.ratios.len().max(1) as f64
    }
}

/// Texels that a ratio of 1 in a file means: the longer axis.
pub(crate) fn scale(samples: [u32; 2]) -> f64 {
    f64::from(samples[0].max(samples[1]))
}
