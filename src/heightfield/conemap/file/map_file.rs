//! A cone map together with what its file knows of it.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::heightfield::conemap::file::{Layout, MapFormat, RatioScale};
use crate::heightfield::{ConeMap, Heights, Patches};

/// A channel of a file that is only used for shading, as shares of 0..=1.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadingChannel {
    /// What it holds.
    pub name: &'static str,
    /// Its numbers, row by row.
    pub shares: Vec<f32>,
}

/// What the numbers of a map do not say.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// Samples of the heights along each axis.
    pub samples: [u32; 2],
    /// What lies between them; only maps over cells depend on it.
    #[serde(rename = "surface")]
    pub patches: Patches,
    /// [`digest`] of the heights; unknown if another program wrote the file.
    #[serde(
        rename = "heights_sha256",
        default,
        skip_serializing_if = "Option::is_none"
    )]
    pub digest: Option<String>,
    /// What made the map; unknown if another program wrote the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generator: Option<String>,
}

impl Label {
    /// Texels that a ratio of 1 in the file means: the longer axis.
    pub fn scale(&self) -> f64 {
        f64::from(self.samples[0].max(self.samples[1]))
    }
}

/// SHA-256 of the size and the bits of heights, in hexadecimal, which identifies them.
/// Wrapping is not part of it.
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
    /// A height for each place, if the file has them: of the sample, or of the cell's
    /// highest point.
    pub heights: Option<Vec<f32>>,
    /// Slopes or normals that were read with it.
    pub shading: Vec<ShadingChannel>,
    /// How whole numbers stood for the ratios when they were read, here or before they were
    /// converted to floats; `None` for fresh ratios. Written as such numbers, of any bits,
    /// they become again what they were.
    pub origin: Option<RatioScale>,
    /// How the map was read, or will be written.
    pub format: MapFormat,
    /// What the file says of the map.
    pub label: Label,
}

impl MapFile {
    /// A map without heights and shading.
    pub(crate) fn bare(map: ConeMap, format: MapFormat, label: Label) -> Self {
        Self {
            map,
            heights: None,
            shading: Vec::new(),
            origin: None,
            format,
            label,
        }
    }

    /// A fresh map of some heights. `generator` is the word for what made it.
    pub fn new(map: ConeMap, heights: &Heights, patches: Patches, generator: &str) -> Self {
        let (_, places) = heights.places(map.kind.over_cells().then_some(patches));
        let label = Label {
            samples: heights.size(),
            patches,
            digest: Some(digest(heights)),
            generator: Some(generator.into()),
        };
        Self {
            heights: Some(places),
            ..Self::bare(map, MapFormat::new(Layout::Full), label)
        }
    }

    /// Mean ratio in units of the scale, with ratios above 1 counted as 1: cones wider than
    /// the whole texture are of no use, and would outweigh all others.
    pub fn mean_share(&self) -> f64 {
        let ratios = self.map.ratios.iter();
        let shares: f64 = ratios.map(|r| (r / self.label.scale()).min(1.0)).sum();
        shares / self.map.ratios.len().max(1) as f64
    }
}
