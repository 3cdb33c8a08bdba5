//! Cone maps from a device: the CPU's, however the work is cut, or an error.

use super::maps::{PATCHES, WRAPS, assert_same, field, large, make, plain, small};
use crate::adapter;
use conemarch::gpu::conemap::generate::{Cutting, Maker};
use conemarch::gpu::device::Device;
use conemarch::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use conemarch::heightfield::conemap::generate::min3x3::min3x3;
use conemarch::heightfield::conemap::generate::mips::{self, rounded_down};
use conemarch::heightfield::conemap::generate::slopes::slopes;
use conemarch::heightfield::conemap::generate::task::every_program;
use conemarch::heightfield::conemap::{ConeMap, WIDEST};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::max_mip::MaxMip;
use conemarch::heightfield::pattern::Pattern;
use wgpu::naga::valid::Capabilities;

/// A device of its own: makers borrow one.
fn device() -> Device {
    adapter::open().device
}

#[test]
fn every_generators_program_is_valid() {
    let all = every_program();
    assert_eq!(all.len(), 4 + Generator::ALL.len());
    for program in all {
        let result = program.validate(Capabilities::default());
        assert!(
            result.is_ok(),
            "{}\n{}",
            result.unwrap_err(),
            program.describe()
        );
    }
}

#[test]
fn the_devices_maxima_are_the_same() {
    let device = device();
    let mut maker = Maker::new(&device);
    for (name, heights) in small().into_iter().chain(large()) {
        let here = MaxMip::new(heights.size(), heights.data().to_vec());
        let there = maker.max_mip(heights.size(), heights.data()).unwrap();
        assert_eq!(here, there, "{name}");
    }
}

/// All generators that decide by costs alone.
fn settled() -> impl Iterator<Item = Generator> {
    let all = Generator::ALL.into_iter();
    all.filter(|g| *g != Generator::RelaxedSearch)
}

#[test]
fn the_devices_maps_are_the_cpus_to_the_last_bit() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = Options::default();
    for (i, (name, heights)) in small().into_iter().enumerate() {
        let patches = PATCHES[i % 2];
        for generator in settled() {
            let here = make(generator, &heights, patches, &options);
            let there = maker.generate(generator, &heights, patches, &options, &mut |_| true);
            let name = format!("{name} {generator:?}");
            assert_same(&name, &there.unwrap().ratios, &here.ratios);
        }
    }
}

#[test]
fn larger_maps_of_the_device_are_the_cpus_too() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = Options::default();
    for (name, heights) in large() {
        for generator in settled() {
            let here = make(generator, &heights, Patches::Bilinear, &options);
            let there = maker.generate(
                generator,
                &heights,
                Patches::Bilinear,
                &options,
                &mut |_| true,
            );
            let name = format!("{name} {generator:?}");
            assert_same(&name, &there.unwrap().ratios, &here.ratios);
        }
    }
}

#[test]
fn few_places_are_settled_on_the_cpu() {
    // What the device leaves open must not become the bulk of the work: the searches of
    // a rough field end in a near tie now and then only.
    let device = device();
    let mut maker = Maker::new(&device);
    let heights = field(Pattern::Fbm, [128, 128], [true, true]);
    for generator in [Generator::Exact, Generator::Improved, Generator::Walk] {
        let (patches, options) = (Patches::default(), Options::default());
        let made = maker.generate(generator, &heights, patches, &options, &mut |_| true);
        made.unwrap();
        let share = maker.settled as f64 / 16_384.0;
        println!("{}: {share:.5} of all places", generator.name());
        assert!(share < 0.01, "{generator:?}: {share}");
    }
}

#[test]
fn near_ties_are_settled() {
    // On a ramp all places ahead cost the same but for the rounding of their heights,
    // which f32 cannot tell from that of its own arithmetic.
    let device = device();
    let mut maker = Maker::new(&device);
    for steps in [97, 150, 211] {
        let height = |i: u32| (i % 64 + 3 * (i / 64)) as f32 / steps as f32;
        let data = (0..64 * 11).map(height).collect();
        let heights = Heights::new([64, 11], [false, false], data).unwrap();
        for generator in settled() {
            let (patches, options) = (Patches::default(), Options::default());
            let here = make(generator, &heights, patches, &options);
            let there = maker.generate(generator, &heights, patches, &options, &mut |_| true);
            let name = format!("{steps} {generator:?}");
            assert_same(&name, &there.unwrap().ratios, &here.ratios);
            assert!(generator != Generator::Exact || maker.settled > 100);
        }
    }
}

#[test]
fn the_devices_least_of_nine_is_the_cpus() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = Options {
        min3x3: true,
        ..Options::default()
    };
    for (i, (name, heights)) in small().into_iter().step_by(3).enumerate() {
        // Whole maps, and a row at a time.
        maker.cutting.band = [1 << 16, 1][i % 2];
        for generator in [Generator::Exact, Generator::Quad, Generator::Walk] {
            let (patches, name) = (Patches::default(), format!("{name} {generator:?}"));
            let here = make(generator, &heights, patches, &options);
            let there = maker.generate(generator, &heights, patches, &options, &mut |_| true);
            assert_same(&name, &there.unwrap().ratios, &here.ratios);
        }
    }
    // Ratios that f32 cannot tell apart, none at all, the least of all and the widest.
    for wrap in WRAPS {
        let odd = [
            0.0,
            f64::from_bits(1),
            f64::MIN_POSITIVE,
            1e-300,
            1.0,
            WIDEST,
        ];
        let ratio = |i: u32| match i * 7919 % 100 {
            n @ 0..6 => odd[n as usize],
            n => 1.0 + f64::EPSILON * f64::from(n),
        };
        let map = ConeMap {
            ratios: (0..31 * 23).map(ratio).collect(),
            size: [31, 23],
            wrap,
            ..plain(Generator::Exact, &field(Pattern::Sine, [2, 2], wrap))
        };
        for band in [1 << 16, 100] {
            maker.cutting.band = band;
            let there = maker.min3x3(&map).unwrap();
            let what = format!("{wrap:?}, bands of {band}");
            assert_same(&what, &there.ratios, &min3x3(&map).ratios);
        }
    }
}

#[test]
fn the_devices_slopes_are_the_cpus() {
    let device = device();
    let mut maker = Maker::new(&device);
    for (i, (name, heights)) in small().into_iter().enumerate() {
        // Whole maps, a row at a time, and a few.
        maker.cutting.band = [1 << 16, 1, 100][i % 3];
        let there = maker.slopes(&heights).unwrap();
        assert_eq!(there, slopes(&heights), "{name}");
    }
    // Heights that f32 can hardly tell apart, none at all and the least of all.
    let odd = [0.0, f32::from_bits(1), f32::MIN_POSITIVE, 1e-30, 0.3, 1.0];
    let height = |i: u32| match i * 7919 % 100 {
        n @ 0..6 => odd[n as usize],
        n => 0.5 + f32::EPSILON * n as f32,
    };
    for wrap in WRAPS {
        let data = (0..31 * 23).map(height).collect();
        let heights = Heights::new([31, 23], wrap, data).unwrap();
        maker.cutting.band = 100;
        let there = maker.slopes(&heights).unwrap();
        for (there, here) in there
            .as_flattened()
            .iter()
            .zip(slopes(&heights).as_flattened())
        {
            let tiny = here.abs() <= f32::MIN_POSITIVE && there.abs() <= f32::MIN_POSITIVE;
            assert!(there == here || tiny, "{wrap:?}: {there} {here}");
        }
    }
}

#[test]
fn how_the_work_is_cut_changes_no_map() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = Options {
        search_steps: 20,
        ..Options::default()
    };
    for f in [Pattern::Sine, Pattern::Checker, Pattern::Spikes] {
        let heights = field(f, [50, 43], [true, false]);
        for generator in Generator::ALL {
            let mut make = |cutting| {
                maker.cutting = cutting;
                let map = maker.generate(
                    generator,
                    &heights,
                    Patches::Bilinear,
                    &options,
                    &mut |_| true,
                );
                map.unwrap()
            };
            let whole = make(Cutting::default());
            let cut = make(Cutting { band: 1, rounds: 3 });
            assert_same(&format!("{f:?} {generator:?}"), &cut.ratios, &whole.ratios);
        }
    }
}

#[test]
fn the_devices_search_along_rays_agrees_but_for_a_step_now_and_then() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = Options {
        search_steps: 64,
        ..Options::default()
    };
    for f in Pattern::ALL {
        let heights = field(f, [32, 32], [true, false]);
        let here = make(
            Generator::RelaxedSearch,
            &heights,
            Patches::Bilinear,
            &options,
        );
        let there = maker
            .generate(
                Generator::RelaxedSearch,
                &heights,
                Patches::Bilinear,
                &options,
                &mut |_| true,
            )
            .unwrap();
        let pairs = here.ratios.iter().zip(&there.ratios);
        let off = pairs.filter(|(a, b)| (*a - *b).abs() > 1e-5 * *a).count();
        println!("{}: {off} of 1024 differ", f.name());
        assert!(off <= 10, "{f:?}: {off}");
    }
}

#[test]
fn the_devices_mips_are_the_same_of_ratios_rounded_down() {
    let device = device();
    let mut maker = Maker::new(&device);
    for size in [[1, 1], [1, 7], [9, 5], [33, 20], [64, 64]] {
        let heights = field(Pattern::Fbm, size, [false, true]);
        for generator in [Generator::Exact, Generator::Quad] {
            let mut map = plain(generator, &heights);
            let there = maker.mips(heights.data(), &map).unwrap().unwrap();
            for r in &mut map.ratios {
                *r = f64::from(rounded_down(*r));
            }
            assert_eq!(there, mips::mips(heights.data(), &map).unwrap());
        }
    }
}

#[test]
fn the_device_cancels_and_reports() {
    let device = device();
    let mut maker = Maker::new(&device);
    maker.cutting.band = 1;
    let heights = field(Pattern::Fbm, [64, 64], [false, false]);
    let options = Options::default();
    let mut told = 0;
    let mut watch = |_| {
        told += 1;
        told < 3
    };
    let made = maker.generate(
        Generator::Exact,
        &heights,
        Patches::default(),
        &options,
        &mut watch,
    );
    assert!(matches!(made.unwrap_err(), GenerateError::Cancelled));
    assert_eq!(told, 3);
    device.device.destroy();
    let made = maker.generate(
        Generator::Exact,
        &heights,
        Patches::default(),
        &options,
        &mut |_| true,
    );
    let error = made.unwrap_err();
    assert!(matches!(error, GenerateError::Device(_)), "{error}");
    assert!(error.to_string().contains("was lost"), "{error}");
}
