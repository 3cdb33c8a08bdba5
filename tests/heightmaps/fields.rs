//! Height maps that generators are tried on.

use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{Generator, Options};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use proptest::prelude::*;

/// Which axes wrap, in every combination.
pub const WRAPS: [[bool; 2]; 4] = [[false, false], [true, false], [false, true], [true, true]];

/// A pattern of rough terrain as a height map.
pub fn field(pattern: Pattern, size: [u32; 2], wrap: [bool; 2]) -> Heights {
    Heights::new(size, wrap, pattern.heights(size, 7, 2.6)).unwrap()
}

/// Every pattern in every setting, with a name for messages.
fn every_pattern(
    settings: impl IntoIterator<Item = ([u32; 2], [bool; 2])>,
) -> impl Iterator<Item = (String, Heights)> {
    settings.into_iter().flat_map(|(size, wrap)| {
        let one = move |p| (format!("{p:?} {size:?} {wrap:?}"), field(p, size, wrap));
        Pattern::ALL.into_iter().map(one)
    })
}

/// Every pattern, and a flat map, at every small size, with every wrap: single samples and
/// rows, odd sizes, long ones, and sizes that halve to odd ones.
pub fn small() -> Vec<(String, Heights)> {
    let sizes = [
        [1, 1],
        [1, 9],
        [7, 1],
        [2, 2],
        [3, 2],
        [5, 5],
        [16, 16],
        [13, 22],
        [33, 6],
        [4, 41],
    ];
    let settings: Vec<_> = sizes
        .iter()
        .flat_map(|size| WRAPS.map(|wrap| (*size, wrap)))
        .collect();
    let flat = settings.iter().map(|&(size, wrap)| {
        let data = vec![0.25; (size[0] * size[1]) as usize];
        let heights = Heights::new(size, wrap, data).unwrap();
        (format!("flat {size:?} {wrap:?}"), heights)
    });
    every_pattern(settings.clone()).chain(flat).collect()
}

/// Every pattern, at sizes up to 128 and with every wrap.
pub fn large() -> Vec<(String, Heights)> {
    let settings = [
        ([32, 32], WRAPS[3]),
        ([64, 64], WRAPS[0]),
        ([61, 90], WRAPS[1]),
        ([100, 37], WRAPS[2]),
        ([128, 128], WRAPS[3]),
    ];
    every_pattern(settings).collect()
}

/// Any small height map: heights of few different values, so that many are equal, or of
/// many.
pub fn any_heights() -> impl Strategy<Value = Heights> {
    (1_u32..12, 1_u32..12, any::<[bool; 2]>(), 1_u32..300).prop_flat_map(|(w, h, wrap, steps)| {
        let height = (0..=steps).prop_map(move |i| i as f32 / steps as f32);
        let count = (w * h) as usize;
        prop::collection::vec(height, count)
            .prop_map(move |data| Heights::new([w, h], wrap, data).unwrap())
    })
}

/// Options with a room between cells.
pub fn with_offset(offset: f64) -> Options {
    Options {
        offset,
        ..Options::default()
    }
}

/// Options with steps of the search along rays.
pub fn searching(search_steps: u32) -> Options {
    Options {
        search_steps,
        ..Options::default()
    }
}

/// Options for the least of nine.
pub fn least_of_nine() -> Options {
    Options {
        min3x3: true,
        ..Options::default()
    }
}

/// A map from the CPU.
pub fn make(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> ConeMap {
    let map = cpu::generate(generator, heights, patches, options, &mut |_| true);
    map.unwrap_or_else(|e| panic!("{e}"))
}

/// A map from the CPU with default options.
pub fn plain(generator: Generator, heights: &Heights) -> ConeMap {
    make(generator, heights, Patches::default(), &Options::default())
}

/// The first place at which two lists differ, in words.
pub fn difference(a: &[f64], b: &[f64]) -> Option<String> {
    if a.len() != b.len() {
        return Some(format!("{} against {} numbers", a.len(), b.len()));
    }
    let mut pairs = a.iter().zip(b).enumerate();
    let (i, (a, b)) = pairs.find(|(_, (a, b))| a.to_bits() != b.to_bits())?;
    Some(format!("at {i}: {a} against {b}"))
}

/// Asserts that two lists are the same to the last bit.
pub fn assert_same(what: &str, a: &[f64], b: &[f64]) {
    if let Some(how) = difference(a, b) {
        panic!("{what}: {how}");
    }
}

/// Places whose cone is wider on the first map than on the second.
pub fn wider(a: &[f64], b: &[f64]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a > b).count()
}
