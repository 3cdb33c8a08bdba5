//! Cone maps as pictures: the kinds of figure 18-8 of Policarpo and Oliveira (2007), and
//! how far the quick maps are from the exact one (figure 3 of Valasek and Ban 2022).

use std::path::Path;

use anyhow::{Context, Result};
use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;

use crate::picture::Picture;

/// Samples along either axis, as many as the relief of the chapter has.
const SIDE: usize = 256;
/// The relief: the stones of the preset.
const SEED: u32 = 3;
const POWER: f64 = 2.8;

/// Draws both figures into a folder.
pub fn draw(folder: &Path) -> Result<()> {
    let size = [SIDE as u32; 2];
    let data = Pattern::Stones.heights(size, SEED, POWER);
    let heights = Heights::new(size, [true; 2], data)?;
    let make = |generator| {
        let (patches, options) = (Patches::default(), Options::default());
        cpu::generate(generator, &heights, patches, &options, &mut |_| true)
    };
    let exact = make(Generator::Exact)?;
    let height = |x: usize, y: usize| [shade(heights.data()[y * SIDE + x].into()); 3];
    let kinds = [
        Picture::of([SIDE; 2], height),
        ratios(&exact),
        sides(&make(Generator::Quad)?),
        ratios(&make(Generator::RelaxedSearch)?),
        ratios(&make(Generator::RelaxedExact)?),
        ratios(&make(Generator::Walk)?),
    ];
    Picture::grid(&kinds, 3).write(&folder.join("kinds.png"))?;
    let quick = [Generator::Naive, Generator::Improved, Generator::Center];
    let apart = |generator| -> Result<Picture> { Ok(differences(&make(generator)?, &exact)) };
    let apart: Vec<Picture> = quick.into_iter().map(apart).collect::<Result<_>>()?;
    Picture::grid(&apart, 3)
        .write(&folder.join("quick-maps.png"))
        .context("the quick maps")
}

fn shade(share: f64) -> u8 {
    // The cast saturates.
    (share * 255.0 + 0.5) as u8
}

/// A ratio in texture widths as the papers store it: its root, no more than 1.
fn stored(ratio: f64) -> u8 {
    shade((ratio / SIDE as f64).min(1.0).sqrt())
}

/// A map of one cone per place in grey.
fn ratios(map: &ConeMap) -> Picture {
    Picture::of([SIDE; 2], |x, y| [stored(map.ratios[y * SIDE + x]); 3])
}

/// A map of four cones in the colours of the chapter's figure: red for +x, green for -x, blue
/// for +y; what is wide to -y alone is dark.
fn sides(map: &ConeMap) -> Picture {
    Picture::of([SIDE; 2], |x, y| {
        let at = 4 * (y * SIDE + x);
        [0, 1, 2].map(|side| stored(map.ratios[at + side]))
    })
}

/// How much narrower than exact cones are, in green, or how much wider, in red; as a share
/// of the exact ratio, full from all of it on.
fn differences(map: &ConeMap, exact: &ConeMap) -> Picture {
    Picture::of([SIDE; 2], |x, y| {
        let at = y * SIDE + x;
        let off = map.ratios[at] / exact.ratios[at].max(f64::MIN_POSITIVE) - 1.0;
        [shade(off), shade(-off), 0]
    })
}
