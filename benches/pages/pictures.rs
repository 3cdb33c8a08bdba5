//! Pictures of cone maps, and several pictures as one.
//!
//! The maps are drawn as in figure 18-8 of Policarpo and Oliveira (2007), and the differences of
//! quick maps from the exact one as in figure 3 of Valasek and Ban (2022).

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use anyhow::{Context, Result};
use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{GenericImage as _, Rgb, RgbImage};

/// White pixels between pictures.
const GAP: u32 = 6;
/// Samples along either axis, as many as the relief of the chapter has.
const SIDE: u32 = 256;
/// The relief: the stones of the preset.
const SEED: u32 = 3;
const POWER: f64 = 2.8;

/// Puts pictures into rows of so many, each place as large as the largest.
fn grid(pictures: &[RgbImage], columns: u32) -> Result<RgbImage> {
    let columns = columns.clamp(1, (pictures.len() as u32).max(1));
    let rows = (pictures.len() as u32).div_ceil(columns);
    let most = |size: fn(&RgbImage) -> u32| pictures.iter().map(size).max().unwrap_or(0) + GAP;
    let (width, height) = (most(RgbImage::width), most(RgbImage::height));
    let white = Rgb([255; 3]);
    let mut all = RgbImage::from_pixel(columns * width - GAP, rows * height - GAP, white);
    for (i, picture) in (0..).zip(pictures) {
        all.copy_from(picture, i % columns * width, i / columns * height)?;
    }
    Ok(all)
}

/// Writes a PNG, compressed as far as possible.
fn write(picture: &RgbImage, path: &Path) -> Result<()> {
    let name = || path.display().to_string();
    let file = BufWriter::new(File::create(path).with_context(name)?);
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
    picture.write_with_encoder(encoder).with_context(name)
}

/// Puts the pictures of files into one file.
pub fn join(to: &Path, columns: u32, files: &[&str]) -> Result<()> {
    let read = |f: &&str| Ok(image::open(f).with_context(|| (*f).to_owned())?.to_rgb8());
    let pictures: Vec<RgbImage> = files.iter().map(read).collect::<Result<_>>()?;
    write(&grid(&pictures, columns)?, to)
}

/// Draws both figures into a folder.
pub fn maps(folder: &Path) -> Result<()> {
    let data = Pattern::Stones.heights([SIDE; 2], SEED, POWER);
    let heights = Heights::new([SIDE; 2], [true; 2], data)?;
    let make = |generator| {
        let (patches, options) = (Patches::default(), Options::default());
        cpu::generate(generator, &heights, patches, &options, &mut |_| true)
    };
    let exact = make(Generator::Exact)?;
    let kinds = [
        draw(|at| [shade(heights.data()[at].into()); 3]),
        ratios(&exact),
        sides(&make(Generator::Quad)?),
        ratios(&make(Generator::RelaxedSearch)?),
        ratios(&make(Generator::RelaxedExact)?),
        ratios(&make(Generator::Walk)?),
    ];
    write(&grid(&kinds, 3)?, &folder.join("kinds.png"))?;
    let quick = [Generator::Naive, Generator::Improved, Generator::Center];
    let apart = |generator| Ok(differences(&make(generator)?, &exact));
    let apart: Vec<RgbImage> = quick.into_iter().map(apart).collect::<Result<_>>()?;
    write(&grid(&apart, 3)?, &folder.join("quick-maps.png"))
}

/// A picture with a pixel to each sample.
fn draw(color: impl Fn(usize) -> [u8; 3]) -> RgbImage {
    RgbImage::from_fn(SIDE, SIDE, |x, y| Rgb(color((y * SIDE + x) as usize)))
}

fn shade(share: f64) -> u8 {
    // The cast saturates.
    (share * 255.0 + 0.5) as u8
}

/// A ratio in texture widths as the papers store it: its root, at most 1.
fn stored(ratio: f64) -> u8 {
    shade((ratio / f64::from(SIDE)).min(1.0).sqrt())
}

/// A map of one cone per place in grey.
fn ratios(map: &ConeMap) -> RgbImage {
    draw(|at| [stored(map.ratios[at]); 3])
}

/// A map of four cones in the colours of the chapter's figure: red for +x, green for -x, blue
/// for +y. The cone to -y is not shown.
fn sides(map: &ConeMap) -> RgbImage {
    draw(|at| [0, 1, 2].map(|side| stored(map.ratios[4 * at + side])))
}

/// How much wider than exact cones are, in red, or how much narrower, in green, as a share of
/// the exact ratio.
fn differences(map: &ConeMap, exact: &ConeMap) -> RgbImage {
    draw(|at| {
        let off = map.ratios[at] / exact.ratios[at].max(f64::MIN_POSITIVE) - 1.0;
        [shade(off), shade(-off), 0]
    })
}
