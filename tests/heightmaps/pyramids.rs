//! What is made from heights and cones besides the maps: maxima, planes, mips, the 3 x 3
//! minimum, slopes, and the ratios that devices read.

use conemarch::heightfield::conemap::WIDEST;
use conemarch::heightfield::conemap::file::share_down;
use conemarch::heightfield::conemap::generate::generator::Generator;
use conemarch::heightfield::conemap::generate::min3x3::min3x3;
use conemarch::heightfield::conemap::generate::mips;
use conemarch::heightfield::conemap::generate::planes::Planes;
use conemarch::heightfield::conemap::generate::slopes::slopes;
use conemarch::heightfield::height_surface::HeightSurface;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::max_mip::{MaxMip, Places};
use conemarch::heightfield::pattern::Pattern;
use conemarch::heightfield::tracer::Tracer;

use crate::fields::{WRAPS, field, least_of_nine, make, plain, small};
use crate::reference_maps::Grid;

#[test]
fn planes_lie_above_all_heights() {
    for (name, heights) in small() {
        let mip = MaxMip::new(heights.size(), heights.data().to_vec());
        let planes = Planes::new(&mip);
        for level in 1..mip.levels.len() {
            let [w, h] = mip.levels[level].size;
            for at in (0..h).flat_map(|y| (0..w).map(move |x| [x, y])) {
                let plane = planes.get(level, at);
                let Places { low, high } = mip.places(level, at);
                let mut touches = f64::INFINITY;
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        let room = plane.at([x, y]) - heights.at(x.into(), y.into());
                        assert!(room >= -1e-12, "{name}: level {level}, node {at:?}");
                        touches = room.min(touches);
                    }
                }
                // The lowest planes lie on their heights.
                assert!(level > 1 || touches < 1e-12, "{name}: {touches}");
            }
        }
    }
}

#[test]
fn a_window_is_as_high_as_the_highest_of_its_four_nodes() {
    for (name, heights) in small() {
        let mip = MaxMip::new(heights.size(), heights.data().to_vec());
        for round in [[false, false], [true, false], [false, true], [true, true]] {
            let all = mip.windows(round, 1);
            assert_eq!(all[0].max, [0.0; 0]);
            for (level, windows) in mip.levels.iter().zip(&all).skip(1) {
                assert_eq!(windows.size, level.size.map(|n| n + 1));
                let [w, h] = level.size.map(i64::from);
                for (x, y) in (0..=h).flat_map(|y| (0..=w).map(move |x| (x, y))) {
                    let beside = |at: i64, n: i64, round: bool| match round {
                        true => vec![(at - 1).rem_euclid(n), at % n],
                        false => [at - 1, at]
                            .into_iter()
                            .filter(|i| (0..n).contains(i))
                            .collect(),
                    };
                    let mut highest = f32::NEG_INFINITY;
                    for i in beside(x, w, round[0]) {
                        for j in beside(y, h, round[1]) {
                            highest = highest.max(level.at(i as u32, j as u32));
                        }
                    }
                    assert_eq!(windows.at(x as u32, y as u32), highest, "{name}: {x}, {y}");
                }
            }
        }
    }
}

#[test]
fn the_least_of_nine_is_the_least_around_a_place() {
    for wrap in WRAPS {
        let heights = field(Pattern::Spikes, [7, 5], wrap);
        for generator in [Generator::Exact, Generator::Quad, Generator::Walk] {
            let raw = plain(generator, &heights);
            let map = make(generator, &heights, Patches::default(), &least_of_nine());
            assert_eq!(map, min3x3(&raw));
            let channels = generator.channels();
            let grid = Grid {
                size: raw.size.map(i64::from),
                wrap,
                values: Vec::new(),
            };
            for (i, ratio) in map.ratios.iter().enumerate() {
                let (place, channel) = ((i / channels) as i64, i % channels);
                let [x, y] = [place % grid.size[0], place / grid.size[0]];
                let around = (0..9).filter_map(|k| grid.index([x + k % 3 - 1, y + k / 3 - 1]));
                let ratios = around.map(|other| raw.ratios[other * channels + channel]);
                let least = ratios.fold(f64::INFINITY, f64::min);
                assert_eq!(*ratio, least, "{generator:?} {wrap:?} {i}");
            }
        }
    }
}

#[test]
fn mips_have_the_highest_apex_and_the_narrowest_cone_of_all_below() {
    for size in [[1, 1], [1, 7], [9, 5], [16, 16], [33, 20]] {
        let heights = field(Pattern::Fbm, size, [false, true]);
        for generator in [Generator::Exact, Generator::Quad] {
            let map = plain(generator, &heights);
            let channels = generator.channels();
            let levels = mips::mips(heights.data(), &map).unwrap();
            assert_eq!(levels.last().unwrap().size, [1, 1]);
            for (n, level) in levels.iter().enumerate() {
                let [w, h] = level.size;
                assert_eq!([w, h], size.map(|s| s.div_ceil(1 << n)));
                for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
                    let under = |i: u32| [(i % size[0]) >> n, (i / size[0]) >> n] == [x, y];
                    let places = (0..size[0] * size[1]).filter(|i| under(*i));
                    let places: Vec<usize> = places.map(|i| i as usize).collect();
                    let at = (y * w + x) as usize;
                    let under = places.iter().map(|i| heights.data()[*i]);
                    assert_eq!(level.heights[at], under.fold(0.0, f32::max));
                    for c in 0..channels {
                        let ratios = places.iter().map(|i| map.ratios[i * channels + c]);
                        let least = ratios.fold(f64::INFINITY, f64::min);
                        assert_eq!(level.ratios[at * channels + c], least);
                    }
                }
            }
        }
        let map = plain(Generator::Exact, &heights);
        assert_eq!(mips::mips(&heights.data()[1..], &map), None);
    }
}

#[test]
fn ratios_are_stored_rounded_down() {
    let heights = field(Pattern::Noise, [64, 64], [false, false]);
    let mut below = 0;
    for r in plain(Generator::Exact, &heights).ratios {
        let stored = share_down(r, 1.0);
        let nearest = f64::from(stored) <= r && f64::from(stored.next_up()) > r;
        assert!(nearest, "{r}");
        below += usize::from(f64::from(stored) < r);
    }
    assert!(below > 2000, "too few ratios need rounding: {below}");
    // So they reach a device, too.
    let map = plain(Generator::Walk, &heights);
    let relief = HeightSurface::new(heights, Patches::Bilinear, [1, 1]).unwrap();
    let mut tracer = Tracer::reference(relief.into());
    tracer.map = map.clone().into();
    let arrays = tracer.arrays();
    let ratios = arrays.iter().find(|array| array.name == "ratios");
    let bytes = ratios.unwrap().bytes();
    let there: &[f32] = bytemuck::cast_slice(&bytes);
    assert_eq!(there.len(), map.ratios.len());
    for (there, ratio) in there.iter().zip(&map.ratios) {
        assert!(f64::from(*there) <= *ratio && f64::from(there.next_up()) > *ratio);
    }
    assert_eq!(f64::from(share_down(WIDEST, 1.0)), WIDEST);
}

#[test]
fn slopes_are_those_of_a_plane() {
    // h = (2 x + 3 y) / 64 on 8 x 6 samples: one slope everywhere, at borders too.
    let data = (0..48).map(|i| (2 * (i % 8) + 3 * (i / 8)) as f32 / 64.0);
    let heights = Heights::new([8, 6], [false, false], data.collect()).unwrap();
    for s in slopes(&heights) {
        assert_eq!(s, [2.0 / 64.0, 3.0 / 64.0]);
    }
    // Where the axes wrap, the far sample is next.
    let heights = Heights::new([8, 6], [true, true], heights.data().to_vec()).unwrap();
    let across = [(2.0 - 14.0) / 128.0, (3.0 - 15.0) / 128.0];
    assert_eq!(slopes(&heights)[0], across);
    let flat = Heights::new([1, 1], [false, true], vec![0.5]).unwrap();
    assert_eq!(slopes(&flat)[0], [0.0; 2]);
}
