//! Cone maps through files: every rounding is to the safe side, and channels are those of the
//! papers.

use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::conemap::file::{
    Layout, MapFile, MapFormat, RatioScale, Ratios, Slopes, decode_bytes, encode,
};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use conemarch::raster::png::BitDepth as Bits;
use png::ColorType;
use proptest::prelude::*;

use crate::pictures::pixels;
use crate::reference_maps::{self, Grid};

/// Room that the walks' cones of these tests leave.
const OFFSET: f64 = 1.5;

/// The exact map of some heights.
pub fn made(heights: &Heights, kind: MapKind) -> MapFile {
    let map = reference_maps::of(heights, Patches::Bilinear, kind, OFFSET);
    MapFile::new(map, heights, Patches::Bilinear, "every pair")
}

/// Rough terrain.
pub fn field(size: [u32; 2], wrap: [bool; 2]) -> Heights {
    Heights::new(size, wrap, Pattern::Fbm.heights(size, 5, 2.6)).expect("heights")
}

/// The bytes of a map in a format.
pub fn encoded(file: &MapFile, format: &MapFormat) -> Vec<u8> {
    encode(file, format).expect("a file")
}

/// A map after a trip through a file.
pub fn through(file: &MapFile, format: &MapFormat) -> MapFile {
    decode_bytes(&encoded(file, format)).expect("a map")
}

/// A layout with 8 bits.
pub fn eight(layout: Layout) -> MapFormat {
    MapFormat {
        bits: Bits::Eight,
        ..MapFormat::new(layout)
    }
}

/// Every format that can hold a kind.
fn formats(kind: MapKind) -> Vec<MapFormat> {
    let mut all = Vec::new();
    for layout in Layout::ALL.into_iter().filter(|l| l.lacks(kind).is_none()) {
        for bits in [Bits::Eight, Bits::Sixteen] {
            all.extend(RatioScale::ALL.map(|ratio| MapFormat {
                bits,
                ratio,
                ..MapFormat::new(layout)
            }));
        }
    }
    all
}

/// The largest number of a format's channels.
fn most(format: &MapFormat) -> u16 {
    format.bits.most()
}

/// Heights in a grid that is often tiny, on steps of 8 bits or not.
fn any_heights() -> impl Strategy<Value = Heights> {
    let size = (1u32..9, 1u32..9);
    (size, any::<[bool; 2]>(), any::<bool>()).prop_flat_map(|((w, h), wrap, stepped)| {
        let one = prop_oneof![4 => 0.0f32..1.0, 1 => Just(0.0f32), 1 => Just(1.0f32)];
        proptest::collection::vec(one, (w * h) as usize).prop_map(move |mut z| {
            for z in z.iter_mut().filter(|_| stepped) {
                *z = (f64::from((*z * 255.0).round()) / 255.0) as f32;
            }
            Heights::new([w, h], wrap, z).expect("heights")
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_cone_is_wider_and_no_height_lower_after_a_round_trip(heights in any_heights()) {
        for kind in MapKind::ALL {
            let file = made(&heights, kind);
            for format in formats(kind) {
                let read = through(&file, &format);
                prop_assert_eq!(&read.label, &file.label);
                prop_assert_eq!(read.map.kind, kind);
                prop_assert_eq!(read.map.wrap, heights.wrap());
                prop_assert_eq!(read.map.offset, file.map.offset);
                for (after, before) in read.map.ratios.iter().zip(&file.map.ratios) {
                    prop_assert!(after <= before, "{after} after {before}: {format:?}");
                }
                let full = format.layout == Layout::Full;
                let step = if full { 0.0 } else { 1.0 / f32::from(most(&format)) };
                let pairs = read.heights.iter().flatten().zip(file.heights.iter().flatten());
                for (after, before) in pairs {
                    prop_assert!(after >= before && after - before <= step * 1.0001);
                }
                // What was read once is held exactly.
                let again = through(&read, &format);
                prop_assert_eq!(&again.map, &read.map, "{:?}", format);
                prop_assert_eq!(&again.heights, &read.heights);
            }
        }
    }

    #[test]
    fn cones_in_a_file_are_empty_over_the_heights_in_it(heights in any_heights()) {
        // Eight bits move heights by far more than any cone has to spare.
        for kind in [MapKind::Samples, MapKind::Walk] {
            let file = made(&heights, kind);
            let (offset, mut grid) = match kind.over_cells() {
                true => (Some(OFFSET), Grid::cells(&heights, Patches::Bilinear)),
                false => (None, Grid::samples(&heights)),
            };
            for format in formats(kind) {
                let read = through(&file, &format);
                grid.values = read.heights.iter().flatten().map(|z| f64::from(*z)).collect();
                let widest = grid.cones(offset, false, |_, _| true);
                for (read, widest) in read.map.ratios.iter().zip(widest) {
                    prop_assert!(*read <= widest * (1.0 + 1e-12), "{read} {widest}: {format:?}");
                }
            }
        }
    }

    #[test]
    fn a_broken_map_is_an_error_and_nothing_worse(at in 0.0f64..1.0, bit in 0u8..8, cut in 0.0f64..1.2) {
        for layout in [Layout::Dummer, Layout::Full] {
            let file = made(&field([6, 5], [false, true]), MapKind::Samples);
            let mut bytes = encoded(&file, &MapFormat::new(layout));
            let i = (at * (bytes.len() - 1) as f64) as usize;
            bytes[i] ^= 1 << bit;
            bytes.truncate((cut * bytes.len() as f64) as usize);
            if let Err(why) = decode_bytes(&bytes) {
                prop_assert!(!why.contains('\n'), "{}", why);
            }
        }
    }
}

#[test]
fn what_a_format_keeps() {
    // Sharp enough that a format that narrows everything to nothing is found out.
    let heights = field([32, 32], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    let kept = |format| through(&file, &format).mean_share() / file.mean_share();
    assert!(kept(MapFormat::new(Layout::Full)) > 0.999_999_8);
    let pair = kept(MapFormat::new(Layout::Pair));
    let narrow = kept(eight(Layout::Pair));
    assert!(pair > 0.999, "{pair}");
    assert!(narrow > 0.93 && narrow < pair, "{narrow}");
    // Heights of 8 bits are held exactly, and take nothing from the cones.
    let stepped = heights.data().iter().map(|z| (z * 255.0).round() / 255.0);
    let stepped = Heights::new([32, 32], [false; 2], stepped.collect()).expect("heights");
    let file = made(&stepped, MapKind::Samples);
    let read = through(&file, &MapFormat::new(Layout::Dummer));
    assert_eq!(read.heights, file.heights);
    let ratios = fresh_ratios(RatioScale::Sqrt, 32.0);
    let ratios_before = file.map.ratios.iter();
    let down = ratios_before.map(|r| ratios.ratio(ratios.ratio_down(*r)));
    assert!(read.map.ratios.iter().copied().eq(down));
}

/// How 8 bits stand for ratios that were not read from them.
fn fresh_ratios(scaling: RatioScale, scale: f64) -> Ratios {
    Ratios {
        bits: Bits::Eight,
        scaling,
        scale,
        reread: false,
    }
}

#[test]
fn channels_are_those_of_the_papers() {
    // A peak beside flat ground: a ratio of one texel, an eighth of the longer axis.
    let mut z = vec![0.0; 8 * 4];
    z[8 + 3] = 1.0;
    let heights = Heights::new([8, 4], [false; 2], z).expect("heights");
    let file = made(&heights, MapKind::Samples);
    let pixels = |format| {
        let (info, pixels) = pixels(encoded(&file, &format));
        (info.color_type, pixels)
    };
    let (color, rgba) = pixels(MapFormat::new(Layout::Dummer));
    assert_eq!(color, ColorType::Rgba);
    // Left of the peak: height 0; the square root of 1/8, rounded down; the surface rises
    // by half its height over one texel; flat along y.
    let root = (255.0 * (1.0f64 / 8.0).sqrt()).floor() as u8;
    assert_eq!(rgba[4 * 10..4 * 11], [0, root, 255, 128]);
    // Above it: it rises downwards in the picture, which is down where y goes up.
    assert_eq!(rgba[4 * 3..4 * 4], [0, root, 128, 0]);
    // The peak: nothing is higher, so the cone is as wide as the channel goes.
    assert_eq!(rgba[4 * 11..4 * 11 + 2], [255, 255]);
    let (color, relief) = pixels(MapFormat::new(Layout::Relief));
    assert_eq!(color, ColorType::Rgba);
    // Normal, linear ratio, depth: the normal leans left by the slope of 0.5 x 2 texels.
    let lean = (0.5 - 0.5 * 0.5f64.sqrt()) * 255.0;
    let expected = [(lean + 0.5) as u8, 128, 31, 255];
    assert_eq!(relief[4 * 10..4 * 11], expected);
    assert_eq!(relief[4 * 11 + 3], 0, "the highest has no depth");
    let (color, pair) = pixels(eight(Layout::Pair));
    assert_eq!(color, ColorType::GrayscaleAlpha);
    assert_eq!(pair[2 * 10..2 * 11], [0, root]);
}

/// The slopes of Dummer's program (appendix B), with its three cases for each axis.
fn published(heights: &[i32], size: [i32; 2]) -> Vec<[i32; 2]> {
    let one = |i: i32| {
        let at = [i % size[0], i / size[0]];
        let difference = |axis: usize| {
            let beside = |step: i32| {
                let mut at = at;
                at[axis] += step;
                heights[(at[1] * size[0] + at[0]) as usize]
            };
            if at[axis] == 0 {
                (beside(1) - beside(0)) / 2
            } else if at[axis] == size[axis] - 1 {
                (beside(0) - beside(-1)) / 2
            } else {
                (beside(1) - beside(-1)) / 2
            }
        };
        [127 + difference(0) / 2, 127 - difference(1) / 2]
    };
    (0..size[0] * size[1]).map(one).collect()
}

#[test]
fn half_slopes_are_the_bytes_of_the_published_program() {
    // Heights that 8 bits hold exactly, steep and flat; the program does not wrap.
    let numbers: Vec<i32> = (0..13 * 9).map(|i| i * 7919 % 256).collect();
    let data = numbers.iter().map(|n| (f64::from(*n) / 255.0) as f32);
    let heights = Heights::new([13, 9], [true, true], data.collect()).expect("heights");
    let file = made(&heights, MapKind::Samples);
    let format = MapFormat {
        slopes: Slopes::Half,
        ..MapFormat::new(Layout::Dummer)
    };
    let read = through(&file, &format);
    assert_eq!(read.format, format);
    for (i, wanted) in published(&numbers, [13, 9]).into_iter().enumerate() {
        let shares = read.shading.iter();
        let found: Vec<i32> = shares
            .map(|e| (e.shares[i] * 255.0).round() as i32)
            .collect();
        assert_eq!(found, wanted, "sample {i}");
    }
    // Whole slopes are twice as steep, but for what whole numbers lose.
    let whole = through(&file, &MapFormat::new(Layout::Dummer));
    assert_eq!(whole.format.slopes, Slopes::Whole);
    let inside = 4 * 13 + 6;
    let [half, whole] = [&read, &whole].map(|file| f64::from(file.shading[0].shares[inside]) - 0.5);
    assert!((whole / half - 2.0).abs() < 0.1, "{whole} {half}");
}

#[test]
fn many_trips_cost_no_more_than_the_first() {
    let heights = field([13, 9], [false, true]);
    for kind in MapKind::ALL {
        let all = formats(kind);
        for first in all.iter().filter(|f| f.layout != Layout::Full) {
            // Every format that holds what the first one does: floats, and at least as many
            // steps of the same scaling.
            let holds = |f: &&MapFormat| {
                let alike = f.ratio == first.ratio && most(f) >= most(first);
                f.layout == Layout::Full || alike
            };
            let stops: Vec<&MapFormat> = all.iter().filter(holds).collect();
            assert!(stops.len() > 2);
            let start = through(&made(&heights, kind), first);
            let mut now = start.clone();
            for format in std::iter::repeat_n(&stops, 10).flatten() {
                now = through(&now, format);
                assert_eq!(now.map, start.map, "{first:?}, then {format:?}");
                assert_eq!(now.heights, start.heights, "{first:?}, then {format:?}");
            }
        }
    }
}

#[test]
fn a_fresh_ratio_is_never_rounded_up() {
    // The ratios that numbers are read as lie a hair below what the numbers stand for. As fresh
    // ratios, or read from numbers of another sort, they lose a whole step.
    for scaling in RatioScale::ALL {
        let format = MapFormat {
            ratio: scaling,
            ..eight(Layout::Pair)
        };
        let ratios = fresh_ratios(scaling, 16.0);
        // Of one height, so that rounding heights narrows none.
        let flat = Heights::new([16, 16], [false; 2], vec![1.0; 256]).expect("heights");
        let mut fresh = made(&flat, MapKind::Samples);
        fresh.map.ratios = (0..256).map(|n| ratios.ratio(n)).collect();
        let stands = |n: usize| {
            let share = n as f64 / 255.0;
            16.0 * if scaling == RatioScale::Sqrt {
                share * share
            } else {
                share
            }
        };
        let numbers = |file: &MapFile| -> Vec<usize> {
            let number = |r: &f64| (0..256).find(|n| ratios.ratio(*n as u16) == *r);
            let all = file.map.ratios.iter();
            all.map(|r| number(r).expect("a number")).collect()
        };
        let small = through(&fresh, &format);
        let held = numbers(&small);
        let above = |(n, r): (&usize, &f64)| stands(*n) > *r;
        assert!(!held.iter().zip(&fresh.map.ratios).any(above));
        assert!((0..256).any(|n| held[n] < n), "none lies under its number");
        // From there on nothing is lost, through floats either.
        let floats = through(&small, &MapFormat::new(Layout::Full));
        assert_eq!(floats.origin, small.origin);
        assert_eq!(numbers(&through(&floats, &format)), held);
        // Floats that came from numbers of the other sort are fresh to these.
        let mut others = fresh.clone();
        others.origin = RatioScale::ALL.into_iter().find(|s| *s != scaling);
        let floats = through(&others, &MapFormat::new(Layout::Full));
        assert_eq!(numbers(&through(&floats, &format)), held);
    }
}
