//! Cone maps through files: every rounding to the safe side, labels that keep a map from
//! what it was not made for, and a sentence for everything that is wrong.

use std::path::Path;

use conemarch::heightfield::conemap::MapKind;
use conemarch::heightfield::conemap::file::{
    Bits, Foreign, Form, Layout, MapFile, Ratios, Slopes, Wanted, decode, decode_bytes, encode,
    has_map, read_map,
};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::pattern::Pattern;
use png::{BitDepth, ColorType};
use proptest::prelude::*;

#[allow(dead_code, reason = "other files use the rest")]
mod common {
    pub mod every_pair;
    pub mod folder;
    pub mod pictures;
}
use common::every_pair::{Places, map};
use common::folder::Folder;
use common::pictures::png;

const KINDS: [MapKind; 5] = [
    MapKind::Samples,
    MapKind::Quad,
    MapKind::Relaxed,
    MapKind::Walk,
    MapKind::WalkRelaxed,
];

fn made(heights: &Heights, kind: MapKind) -> MapFile {
    let map = map(heights, kind, 1.5);
    MapFile::new(map, heights, Patches::Bilinear, "every pair")
}

fn field(size: [u32; 2], wrap: [bool; 2]) -> Heights {
    Heights::new(size, wrap, Pattern::Fbm.heights(size, 5, 2.6)).expect("heights")
}

/// Every form that can hold a kind.
fn forms(kind: MapKind) -> Vec<Form> {
    let layouts = Layout::ALL.into_iter().filter(|l| l.lacks(kind).is_none());
    layouts
        .flat_map(|layout| {
            let usual = Form::new(layout);
            let all = [Bits::Eight, Bits::Sixteen].into_iter();
            all.flat_map(move |bits| {
                [true, false].map(move |root| Form {
                    bits,
                    root,
                    ..usual
                })
            })
        })
        .collect()
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
        for kind in KINDS {
            let file = made(&heights, kind);
            for form in forms(kind) {
                let bytes = encode(&file, &form).expect("a file");
                let read = decode_bytes(&bytes).expect("a map");
                prop_assert_eq!(&read.label, &file.label);
                prop_assert_eq!(read.map.kind, kind);
                prop_assert_eq!(read.map.wrap, heights.wrap());
                prop_assert_eq!(read.map.offset, file.map.offset);
                for (after, before) in read.map.ratios.iter().zip(&file.map.ratios) {
                    prop_assert!(after <= before, "{after} after {before}: {form:?}");
                }
                let full = form.layout == Layout::Full;
                let step = if full { 0.0 } else { 1.0 / f32::from(form.bits.steps().most) };
                let pairs = read.heights.iter().flatten().zip(file.heights.iter().flatten());
                for (after, before) in pairs {
                    prop_assert!(after >= before && after - before <= step * 1.0001);
                }
                // What was read once is held as it is.
                let again = encode(&read, &form).map(|b| decode_bytes(&b));
                let again = again.expect("a file").expect("a map");
                prop_assert_eq!(&again.map, &read.map, "{:?}", form);
                prop_assert_eq!(&again.heights, &read.heights);
            }
        }
    }

    #[test]
    fn cones_in_a_file_are_empty_over_the_heights_in_it(heights in any_heights()) {
        // Eight bits move heights by far more than any cone has to spare.
        for kind in [MapKind::Samples, MapKind::Walk] {
            let file = made(&heights, kind);
            for form in forms(kind) {
                let bytes = encode(&file, &form).expect("a file");
                let read = decode_bytes(&bytes).expect("a map");
                let mut places = Places::of(&heights, kind, 1.5);
                prop_assert!(places.widest(&read.map.ratios) <= 1.0);
                places.heights = read.heights.expect("heights");
                let widest = places.widest(&read.map.ratios);
                prop_assert!(widest <= 1.0 + 1e-12, "{widest} times too wide: {form:?}");
            }
        }
    }

    #[test]
    fn a_broken_map_is_an_error_and_nothing_worse(at in 0.0f64..1.0, bit in 0u8..8, cut in 0.0f64..1.2) {
        for layout in [Layout::Dummer, Layout::Full] {
            let file = made(&field([6, 5], [false, true]), MapKind::Samples);
            let mut bytes = encode(&file, &Form::new(layout)).expect("a file");
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
fn what_a_form_keeps() {
    // Sharp enough that a form that narrows everything to nothing is found out.
    let heights = field([32, 32], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    let kept = |form: Form| {
        let bytes = encode(&file, &form).expect("a file");
        decode_bytes(&bytes).expect("a map").mean_share() / file.mean_share()
    };
    let pair = Form::new(Layout::Pair);
    assert!(kept(Form::new(Layout::Full)) > 0.999_999_8);
    assert!(kept(pair) > 0.999, "{}", kept(pair));
    let narrow = Form {
        bits: Bits::Eight,
        ..pair
    };
    assert!(
        kept(narrow) > 0.93 && kept(narrow) < kept(pair),
        "{}",
        kept(narrow)
    );
    // Heights of 8 bits are held as they are, and take nothing from the cones.
    let stepped = heights.data().iter().map(|z| (z * 255.0).round() / 255.0);
    let stepped = Heights::new([32, 32], [false; 2], stepped.collect()).expect("heights");
    let file = made(&stepped, MapKind::Samples);
    let bytes = encode(&file, &Form::new(Layout::Dummer)).expect("a file");
    let read = decode_bytes(&bytes).expect("a map");
    assert_eq!(read.heights, file.heights);
    let ratios = Ratios {
        steps: Bits::Eight.steps(),
        root: true,
        scale: 32.0,
        again: false,
    };
    let down = file
        .map
        .ratios
        .iter()
        .map(|r| ratios.ratio(ratios.ratio_down(*r)));
    assert!(read.map.ratios.iter().copied().eq(down));
}

#[test]
fn channels_are_those_of_the_papers() {
    // A peak beside flat ground: a ratio of one texel, an eighth of the longer axis.
    let mut z = vec![0.0; 8 * 4];
    z[8 + 3] = 1.0;
    let heights = Heights::new([8, 4], [false; 2], z).expect("heights");
    let file = made(&heights, MapKind::Samples);
    let pixels = |form: Form| {
        let bytes = encode(&file, &form).expect("a file");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("pixels");
        (reader.info().color_type, pixels)
    };
    let (color, rgba) = pixels(Form::new(Layout::Dummer));
    assert_eq!(color, ColorType::Rgba);
    // Left of the peak: height 0; the square root of 1/8, rounded down; the surface rises
    // by half its height over one texel; flat along y.
    let root = (255.0 * (1.0f64 / 8.0).sqrt()).floor() as u8;
    assert_eq!(rgba[4 * 10..4 * 11], [0, root, 255, 128]);
    // Above it: it rises downwards in the picture, which is down where y goes up.
    assert_eq!(rgba[4 * 3..4 * 4], [0, root, 128, 0]);
    // The peak: nothing is higher, so the cone is as wide as the channel goes.
    assert_eq!(rgba[4 * 11..4 * 11 + 2], [255, 255]);
    let (color, relief) = pixels(Form::new(Layout::HeightSurface));
    assert_eq!(color, ColorType::Rgba);
    // Normal, ratio as it is, depth: the normal leans left by the slope of 0.5 x 2 texels.
    let lean = (0.5 - 0.5 * 0.5f64.sqrt()) * 255.0;
    let expected = [(lean + 0.5) as u8, 128, 31, 255];
    assert_eq!(relief[4 * 10..4 * 11], expected);
    assert_eq!(relief[4 * 11 + 3], 0, "the highest has no depth");
    let (color, pair) = pixels(Form {
        bits: Bits::Eight,
        ..Form::new(Layout::Pair)
    });
    assert_eq!(color, ColorType::GrayscaleAlpha);
    assert_eq!(pair[2 * 10..2 * 11], [0, root]);
}

/// The slopes of Dummer's program (appendix B), written out as it is but for names.
fn published(heights: &[i32], [w, h]: [i32; 2]) -> Vec<[i32; 2]> {
    let at = |x: i32, y: i32| heights[(y * w + x) as usize];
    let one = |i: i32| {
        let (x, y) = (i % w, i / w);
        let across = if x == 0 {
            (at(x + 1, y) - at(x, y)) / 2
        } else if x == w - 1 {
            (at(x, y) - at(x - 1, y)) / 2
        } else {
            (at(x + 1, y) - at(x - 1, y)) / 2
        };
        let down = if y == 0 {
            (at(x, y + 1) - at(x, y)) / 2
        } else if y == h - 1 {
            (at(x, y) - at(x, y - 1)) / 2
        } else {
            (at(x, y + 1) - at(x, y - 1)) / 2
        };
        [127 + across / 2, 127 - down / 2]
    };
    (0..w * h).map(one).collect()
}

#[test]
fn half_slopes_are_the_bytes_of_the_published_program() {
    // What 8 bits hold as it is, both steep and flat; the program knows no wrapping.
    let numbers: Vec<i32> = (0..13 * 9).map(|i| i * 7919 % 256).collect();
    let data = numbers.iter().map(|n| (f64::from(*n) / 255.0) as f32);
    let heights = Heights::new([13, 9], [true, true], data.collect()).expect("heights");
    let form = Form {
        slopes: Slopes::Half,
        ..Form::new(Layout::Dummer)
    };
    let bytes = encode(&made(&heights, MapKind::Samples), &form).expect("a file");
    let read = decode_bytes(&bytes).expect("a map");
    assert_eq!(read.form, form);
    let shares = |i: usize| {
        read.extra
            .iter()
            .map(move |e| (e.shares[i] * 255.0).round() as i32)
    };
    for (i, wanted) in published(&numbers, [13, 9]).into_iter().enumerate() {
        assert_eq!(shares(i).collect::<Vec<_>>(), wanted, "sample {i}");
    }
    // The others are twice as steep, but for what whole numbers lose.
    let whole = encode(
        &made(&heights, MapKind::Samples),
        &Form::new(Layout::Dummer),
    );
    let whole = decode_bytes(&whole.expect("a file")).expect("a map");
    assert_eq!(whole.form.slopes, Slopes::Whole);
    let inside = 4 * 13 + 6;
    let steep = |file: &MapFile| f64::from(file.extra[0].shares[inside]) - 0.5;
    assert!(
        (steep(&whole) / steep(&read) - 2.0).abs() < 0.1,
        "{} {}",
        steep(&whole),
        steep(&read)
    );
}

#[test]
fn a_map_is_refused_for_what_it_was_not_made_for() {
    let folder = Folder::new();
    let heights = field([12, 10], [true, false]);
    let path = folder.0.join("a.png");
    let file = made(&heights, MapKind::Samples);
    folder.write(
        "a.png",
        encode(&file, &Form::new(Layout::Dummer)).expect("a file"),
    );
    assert_eq!(folder.files(), ["a.png"]);
    let read = read_map(&path).expect("a map");
    let wanted = Wanted {
        who: "the tracer `csm-exact`",
        kinds: &[MapKind::Samples],
        heights: &heights,
        patches: Patches::Bilinear,
    };
    read.fit(&path, &wanted).expect("its own heights");
    let refuse = |wanted: &Wanted<'_>, words: &[&str]| {
        let why = read.fit(&path, wanted).expect_err("a misfit").to_string();
        assert!(why.contains("a.png") && !why.contains('\n'), "{why}");
        for word in words {
            assert!(why.contains(word), "`{word}` not in: {why}");
        }
    };
    let kinds = &[MapKind::Walk, MapKind::WalkRelaxed];
    let words = ["`samples`", "csm-exact", "needs `walk` or `walk-relaxed`"];
    refuse(&Wanted { kinds, ..wanted }, &words);
    let remade = |wrap, data: Vec<f32>| Heights::new([12, 10], wrap, data).expect("heights");
    let data = heights.data().to_vec();
    let other = remade([false; 2], data.clone());
    let words = ["wrap along x", "wrap along none", "--wrap none"];
    refuse(
        &Wanted {
            heights: &other,
            ..wanted
        },
        &words,
    );
    let mut touched = data.clone();
    touched[77] = touched[77].next_down();
    let other = remade([true, false], touched);
    refuse(
        &Wanted {
            heights: &other,
            ..wanted
        },
        &["other heights", "--invert"],
    );
    let other = field([10, 12], [true, false]);
    refuse(
        &Wanted {
            heights: &other,
            ..wanted
        },
        &["12 x 10", "10 x 12"],
    );

    // Only a walk depends on what lies between the samples.
    let boxes = Patches::Boxes;
    read.fit(
        &path,
        &Wanted {
            patches: boxes,
            ..wanted
        },
    )
    .expect("samples are samples");
    let walk = made(&heights, MapKind::Walk);
    let bytes = encode(&walk, &Form::new(Layout::Full)).expect("a file");
    let walk = decode_bytes(&bytes).expect("a map");
    let wanted = Wanted {
        kinds: &[],
        patches: boxes,
        ..wanted
    };
    let why = walk.fit(&path, &wanted).expect_err("boxes").to_string();
    assert!(
        why.contains("bilinear patches") && why.contains("boxes"),
        "{why}"
    );
}

#[test]
fn a_map_goes_with_the_heights_in_its_own_file() {
    let fits = |file: &MapFile, heights: &Heights| {
        let wanted = Wanted {
            who: "this test",
            kinds: &[],
            heights,
            patches: Patches::Bilinear,
        };
        file.fit(Path::new("a.png"), &wanted).is_ok()
    };
    let heights = field([12, 10], [true, false]);
    for (kind, layout) in [
        (MapKind::Samples, Layout::Dummer),
        (MapKind::Samples, Layout::Pair),
        (MapKind::Relaxed, Layout::HeightSurface),
    ] {
        let form = Form {
            bits: Bits::Eight,
            ..Form::new(layout)
        };
        let bytes = encode(&made(&heights, kind), &form).expect("a file");
        let read = decode_bytes(&bytes).expect("a map");
        let own = read.heights.clone().expect("heights");
        assert_ne!(own, heights.data(), "8 bits move them");
        let of = |wrap, z: &[f32]| Heights::new([12, 10], wrap, z.to_vec()).expect("heights");
        assert!(fits(&read, &heights), "the true ones");
        assert!(fits(&read, &of([true, false], &own)), "its own");
        // One of them a little higher, or going round elsewhere, they are others.
        assert!(!fits(&read, &of([false; 2], &own)));
        let mut touched = own;
        let low = touched.iter_mut().find(|z| **z < 1.0).expect("a height");
        *low = low.next_up();
        assert!(!fits(&read, &of([true, false], &touched)));
    }
    // A walk's file has the heights of cells, which are no samples, be they as many.
    let heights = field([8, 8], [true; 2]);
    let walk = encode(&made(&heights, MapKind::Walk), &Form::new(Layout::Full)).expect("a file");
    let walk = decode_bytes(&walk).expect("a map");
    let cells = walk.heights.clone().expect("heights");
    let cells = Heights::new([8, 8], [true; 2], cells).expect("heights");
    assert!(fits(&walk, &heights) && !fits(&walk, &cells));
}

#[test]
fn many_trips_cost_no_more_than_the_first() {
    let heights = field([13, 9], [false, true]);
    for kind in KINDS {
        let all = forms(kind);
        for first in all.iter().filter(|f| f.layout != Layout::Full) {
            // Every form that holds what the first one does: floats, and at least as many
            // steps that are roots or are not.
            let most = first.bits.steps().most;
            let holds = |f: &&Form| {
                let alike = f.root == first.root && f.bits.steps().most >= most;
                f.layout == Layout::Full || alike
            };
            let stops: Vec<&Form> = all.iter().filter(holds).collect();
            assert!(stops.len() > 2);
            let through = |file: &MapFile, form: &Form| {
                let bytes = encode(file, form).expect("a file");
                decode_bytes(&bytes).expect("a map")
            };
            let start = through(&made(&heights, kind), first);
            let mut now = start.clone();
            for form in std::iter::repeat_n(&stops, 10).flatten() {
                now = through(&now, form);
                assert_eq!(now.map, start.map, "{first:?}, then {form:?}");
                assert_eq!(now.heights, start.heights, "{first:?}, then {form:?}");
            }
        }
    }
}

#[test]
fn a_map_of_another_program_is_read_as_what_it_is_said_to_be() {
    let folder = Folder::new();
    let heights = field([8, 8], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    let ours = encode(&file, &Form::new(Layout::Dummer)).expect("a file");
    let mut reader = png::Decoder::new(std::io::Cursor::new(ours))
        .read_info()
        .expect("a PNG");
    let mut rgba = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut rgba).expect("pixels");
    folder.write(
        "theirs.png",
        png([8, 8], ColorType::Rgba, BitDepth::Eight, &rgba),
    );
    let path = folder.0.join("theirs.png");
    assert!(!has_map(&path).expect("a file"));
    let why = read_map(&path).expect_err("no label").to_string();
    assert!(
        why.contains("theirs.png") && why.contains("--from"),
        "{why}"
    );
    let foreign = Foreign {
        layout: Layout::Dummer,
        kind: MapKind::Samples,
        root: true,
        wrap: [false; 2],
    };
    let read = decode(&path, Some(&foreign)).expect("a map");
    let same = encode(&file, &Form::new(Layout::Dummer)).expect("a file");
    assert_eq!(read.map, decode_bytes(&same).expect("a map").map);
    // Its heights are all that tells whose it is.
    let wanted = |heights| Wanted {
        who: "this test",
        kinds: &[],
        heights,
        patches: Patches::Bilinear,
    };
    read.fit(&path, &wanted(&heights)).expect("its heights");
    let other = Pattern::Noise.heights([8, 8], 1, 0.0);
    let other = Heights::new([8, 8], [false; 2], other).expect("heights");
    assert!(read.fit(&path, &wanted(&other)).is_err());
    // A map is four channels wide.
    folder.write(
        "three.png",
        png([1, 1], ColorType::Rgb, BitDepth::Eight, &[1, 2, 3]),
    );
    let why = decode(&folder.0.join("three.png"), Some(&foreign)).expect_err("three");
    assert!(why.to_string().contains("3 channels"), "{why}");
}

#[test]
fn a_map_that_was_cut_or_says_nonsense_is_refused() {
    let folder = Folder::new();
    let heights = field([8, 8], [false; 2]);
    let file = made(&heights, MapKind::Samples);
    // A label of 8 x 8 samples on an image of 4 x 4.
    let mut cut = file.clone();
    cut.map.size = [4, 4];
    cut.map.ratios.truncate(16);
    cut.heights = cut.heights.map(|z| z[..16].to_vec());
    for layout in [Layout::Pair, Layout::Full] {
        let bytes = encode(&cut, &Form::new(layout)).expect("a file");
        let why = decode_bytes(&bytes).expect_err("cut");
        assert!(why.contains("4 x 4") && why.contains("8 x 8"), "{why}");
    }
    let mut wrong = file.clone();
    wrong.label.scale = f64::NAN;
    let bytes = encode(&wrong, &Form::new(Layout::Pair)).expect("a file");
    let why = decode_bytes(&bytes).expect_err("no scale");
    assert!(why.contains("scale"), "{why}");
    folder.write("a.txt", "nothing");
    let why = read_map(&folder.0.join("a.txt"))
        .expect_err("no map")
        .to_string();
    assert!(why.contains("a.txt") && why.contains("PNG or EXR"), "{why}");
}

/// A PNG whose label says something else.
fn relabelled(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut pixels).expect("pixels");
    let info = reader.info();
    let label = &info.uncompressed_latin1_text[0];
    assert!(label.text.contains(from), "{}", label.text);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, info.width, info.height);
    encoder.set_color(info.color_type);
    encoder.set_depth(info.bit_depth);
    let text = label.text.replace(from, to);
    encoder
        .add_text_chunk(label.keyword.clone(), text)
        .expect("a text");
    let mut writer = encoder.write_header().expect("a head");
    writer.write_image_data(&pixels).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn a_label_that_contradicts_itself_is_refused() {
    let heights = field([8, 6], [false; 2]);
    let dummer = encode(
        &made(&heights, MapKind::Samples),
        &Form::new(Layout::Dummer),
    );
    let dummer = dummer.expect("a file");
    let quad = encode(&made(&heights, MapKind::Quad), &Form::new(Layout::Quad)).expect("a file");
    let walk = encode(&made(&heights, MapKind::Walk), &Form::new(Layout::Pair)).expect("a file");
    // The text of an EXR has no sum to check it.
    let floats = encode(&made(&heights, MapKind::Walk), &Form::new(Layout::Full));
    let mut floats = floats.expect("a file");
    let at = floats
        .windows(6)
        .position(|w| w == b"\"full\"")
        .expect("a layout");
    floats[at..at + 6].copy_from_slice(b"\"pair\"");
    let why = decode_bytes(&floats).expect_err("an EXR of numbers");
    assert!(why.contains("PNG") && why.contains("EXR"), "{why}");
    for (bytes, from, to, word) in [
        (&dummer, "\"samples\"", "\"quad\"", "kind"),
        (&dummer, "\"samples\"", "\"walk\"", "kind"),
        (&dummer, "\"dummer\"", "\"quad\"", "layout quad"),
        (&quad, "\"quad\"\nlayout", "\"samples\"\nlayout", "kind"),
        (&dummer, "scale = 8.0", "scale = 16.0", "scale"),
        (&dummer, "\"whole\"", "\"most\"", "slopes"),
        (&dummer, "\"sqrt\"", "\"cube\"", "ratio"),
        (
            &dummer,
            "slopes",
            "from_ratio = \"cube\"\nslopes",
            "from_ratio",
        ),
        (
            &dummer,
            "slopes",
            "from_ratio = \"sqrt\"\nslopes",
            "from_ratio",
        ),
        (&dummer, "offset = 0.0", "offset = 2.0", "offset"),
        (&dummer, "\"dummer\"\n", "\"full\"\n", "slopes"),
        (&quad, "layout = \"quad\"", "layout = \"full\"", "EXR"),
        (
            &quad,
            "samples = ",
            "slopes = \"half\"\nsamples = ",
            "slopes",
        ),
        (&walk, "offset = 1.5", "offset = 0.0", "offset"),
    ] {
        decode_bytes(&relabelled(bytes, from, from)).expect("a map");
        let why = decode_bytes(&relabelled(bytes, from, to)).expect_err(to);
        assert!(why.contains(word) && !why.contains('\n'), "{why}");
    }
}

#[test]
fn a_ratio_that_was_no_number_is_never_rounded_up() {
    // The ratios that numbers are read as, which lie a hair under what these stand for: to
    // fresh ones, and to such as were read from other numbers, that is a whole step.
    let form = Form {
        bits: Bits::Eight,
        ..Form::new(Layout::Pair)
    };
    let steps = Bits::Eight.steps();
    for root in [true, false] {
        let form = Form { root, ..form };
        let ratios = Ratios {
            steps,
            root,
            scale: 16.0,
            again: false,
        };
        // Of one height, so that none is narrowed for the heights' sake.
        let flat = Heights::new([16, 16], [false; 2], vec![1.0; 256]).expect("heights");
        let mut fresh = made(&flat, MapKind::Samples);
        for (n, ratio) in fresh.map.ratios.iter_mut().enumerate() {
            *ratio = ratios.ratio(n as u16);
        }
        let stands = |n: usize| {
            let share = n as f64 / 255.0;
            16.0 * if root { share * share } else { share }
        };
        let through = |file: &MapFile, form: &Form| {
            decode_bytes(&encode(file, form).expect("a file")).expect("a map")
        };
        let numbers = |file: &MapFile| -> Vec<usize> {
            let number = |r: &f64| (0..256).find(|n| ratios.ratio(*n as u16) == *r);
            file.map
                .ratios
                .iter()
                .map(|r| number(r).expect("a number"))
                .collect()
        };
        let small = through(&fresh, &form);
        let held = numbers(&small);
        let above = |(n, r): (&usize, &f64)| stands(*n) > *r;
        assert!(!held.iter().zip(&fresh.map.ratios).any(above));
        assert!((0..256).any(|n| held[n] < n), "none lies under its number");
        // From there on nothing is lost, through floats either.
        let floats = through(&small, &Form::new(Layout::Full));
        assert_eq!(floats.origin, small.origin);
        assert_eq!(numbers(&through(&floats, &form)), held);
        // Floats that came from numbers of the other sort are fresh to these.
        let mut others = fresh.clone();
        others.origin = Some(!root);
        let floats = through(&others, &Form::new(Layout::Full));
        assert_eq!(numbers(&through(&floats, &form)), held);
    }
}

#[test]
fn layouts_say_what_they_cannot_hold() {
    let heights = field([4, 4], [false; 2]);
    for (kind, layout, words) in [
        (MapKind::Quad, Layout::Dummer, "take quad or full"),
        (MapKind::Walk, Layout::Dummer, "take pair or full"),
        (
            MapKind::WalkRelaxed,
            Layout::HeightSurface,
            "take pair or full",
        ),
        (MapKind::Samples, Layout::Quad, "four ratios"),
    ] {
        let why = encode(&made(&heights, kind), &Form::new(layout)).expect_err("no place");
        assert!(why.is_usage() && why.to_string().contains(words), "{why}");
    }
    // A map without heights cannot become one with them.
    let bytes = encode(&made(&heights, MapKind::Quad), &Form::new(Layout::Quad)).expect("a file");
    let read = decode_bytes(&bytes).expect("a map");
    assert!(read.heights.is_none());
}
