//! The picture on a device through each tone map, against the file of the same light.

use conemarch::picture::{Layer, Shades};
use conemarch::plan::look::{DAYLIGHT, ToneMap};
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;

use super::common::plans::sized;
use crate::adapter::{self, finish};

#[test]
fn a_device_shows_the_bytes_of_the_file_through_every_tone_map() {
    let (mut renderer, assets) = (adapter::open(), Assets::default());
    let extras = Extras {
        reuse: true,
        shown: true,
        time: true,
        ..Extras::default()
    };
    let mut plan = sized("mandelbox", [320, 180]);
    // A blue sky and coloured light: no two channels are alike.
    plan.look.palette[1] = [0.9, 0.1, 0.0].into();
    let mut shown = |plan: &Plan| {
        let mut work = renderer.begin(plan, &assets, extras).unwrap();
        let frame = finish(&mut work);
        let file = Shades::new(Layer::Color, &frame, plan).bytes();
        (work.pixels().unwrap(), file)
    };
    let mut first = Vec::new();
    for map in ToneMap::ALL {
        let (mut differing, mut channels) = (0, 0);
        for (exposure, white, saturation) in [
            (0.0, DAYLIGHT, 1.0),
            (3.0, DAYLIGHT, 1.0),
            (-2.0, 4000.0, 1.0),
            (1.0, DAYLIGHT, 1.6),
            (0.5, 9000.0, 0.0),
        ] {
            plan.look.tone = map;
            plan.look.exposure = exposure;
            plan.look.white = white;
            plan.look.saturation = saturation;
            let (picture, file) = shown(&plan);
            let pairs = picture.chunks(4).zip(file.chunks(3));
            let pairs = pairs.flat_map(|(a, b)| a.iter().zip(b));
            let apart: Vec<u8> = pairs.map(|(a, b)| a.abs_diff(*b)).collect();
            let one = apart.iter().filter(|d| **d == 1).count();
            assert!(apart.iter().all(|d| *d <= 1), "{:?}", plan.look);
            let is_plain = white == DAYLIGHT && saturation == 1.0;
            let is_exact = is_plain && matches!(map, ToneMap::Filmic | ToneMap::None);
            assert!(!is_exact || one == 0, "{map:?}: {one}");
            differing += one;
            channels += apart.len();
            if exposure == 0.0 {
                assert!(!first.contains(&file), "{map:?} is another map");
                first.push(file);
            }
            // Grey is grey.
            let pixels = &mut picture.chunks(4);
            let spread = |p: &[u8]| p[..3].iter().max().unwrap() - p[..3].iter().min().unwrap();
            let most = pixels.map(spread).max().unwrap();
            assert_eq!(saturation == 0.0, most <= 1, "{map:?} {most}");
        }
        println!("{map:?}: {differing} of {channels} channels differ");
        assert!(
            differing * 10_000 <= channels,
            "{map:?}: {differing} of {channels}"
        );
    }
}
