//! Parsers of arguments: sizes, and words that stand for values.

use std::fmt::Display;
use std::str::FromStr;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::base::units;
use crate::heightfield::heights::MOST_SAMPLES;
use crate::plan::{MOST_PIXEL_SAMPLES, MOST_PIXELS};
use crate::raster::png::BitDepth;

/// Reads the size of a picture, like `1280x720`.
///
/// # Errors
/// The text has another form, or a side is out of range.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    units::size(text, MOST_PIXELS).ok_or_else(|| {
        format!("must be width x height in pixels, each from 1 to {MOST_PIXELS}, like 1280x720")
    })
}

/// Reads the size of a height map.
///
/// # Errors
/// As [`size`]; maps have fewer samples than pictures have pixels.
pub fn samples(text: &str) -> Result<[u32; 2], String> {
    units::size(text, MOST_SAMPLES).ok_or_else(|| {
        format!("must be columns x rows, each from 1 to {MOST_SAMPLES}, like 512x256")
    })
}

/// A parser of whole numbers in a range.
pub fn whole<N>(least: N, most: N) -> impl TypedValueParser<Value = N>
where
    N: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    move |text: &str| {
        let within = text.parse().ok().filter(|n| (least..=most).contains(n));
        within.ok_or_else(|| format!("must be a whole number from {least} to {most}"))
    }
}

/// Reads how many samples a pixel has.
pub fn pixel_samples() -> impl TypedValueParser<Value = u32> {
    whole(1, MOST_PIXEL_SAMPLES)
}

/// Reads the error at which a tile has enough samples.
///
/// # Errors
/// It is no number from 0 to 1.
pub fn noise(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let within = number.filter(|n| (0.0..=1.0).contains(n));
    within.ok_or_else(|| "must be a number from 0 to 1, like 0.004".into())
}

/// Reads how many bits a channel of a PNG has.
pub fn bits() -> impl TypedValueParser<Value = BitDepth> {
    words([(BitDepth::Eight, "8", ""), (BitDepth::Sixteen, "16", "")])
}

/// A parser of words that stand for values; each value comes with its word and its help.
pub fn words<T: Clone + Send + Sync + 'static>(
    list: impl IntoIterator<Item = (T, &'static str, &'static str)>,
) -> impl TypedValueParser<Value = T> {
    let list: Vec<_> = list.into_iter().collect();
    let shown = list.iter().map(|(_, word, help)| match *help {
        "" => PossibleValue::new(*word),
        help => PossibleValue::new(*word).help(help),
    });
    let shown: Vec<_> = shown.collect();
    PossibleValuesParser::new(shown).try_map(move |chosen| {
        let found = list.iter().find(|(_, word, _)| *word == chosen);
        found.map(|(value, ..)| value.clone()).ok_or("unknown word")
    })
}
