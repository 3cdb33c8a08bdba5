//! Parsers of arguments: sizes, and words that stand for values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::heightfield::heights::MOST_SAMPLES;
use crate::plan::MOST_PIXELS;

/// Reads a size like `1280x720`.
///
/// # Errors
/// The text has another form, or a side is out of range.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |s: &str| {
        // Numbers may have a sign where they are parsed.
        let digits = s.bytes().all(|b| b.is_ascii_digit());
        let n = s.parse().ok().filter(|_| digits);
        n.filter(|n| (1..=MOST_PIXELS).contains(n))
    };
    let (w, h) = text.split_once(['x', 'X']).unwrap_or_default();
    let sides = side(w).zip(side(h)).map(|(w, h)| [w, h]);
    sides.ok_or_else(|| {
        format!("must be width x height in pixels, each from 1 to {MOST_PIXELS}, like 1280x720")
    })
}

/// Reads the size of a height map.
///
/// # Errors
/// As [`size`]; maps have fewer samples than pictures have pixels.
pub fn samples(text: &str) -> Result<[u32; 2], String> {
    let fits = |s: &[u32; 2]| s.iter().all(|n| *n <= MOST_SAMPLES);
    let read = size(text).ok().filter(fits);
    read.ok_or_else(|| {
        format!("must be columns x rows, each from 1 to {MOST_SAMPLES}, like 512x256")
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_two_sane_numbers_are_a_size() {
        assert_eq!(size("1280x720"), Ok([1280, 720]));
        assert_eq!(size("1X1"), Ok([1, 1]));
        let bad = ";x;5;0x5;5x0;abc;99999x1;-4x4;+4x4;4x4x4;4 x4;1e2x4;99999999999999999999x1";
        for bad in bad.split(';') {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
