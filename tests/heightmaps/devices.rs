//! Cone maps from a device: the CPU's, however the work is divided, or an error.

use std::sync::Arc;

use conemarch::gpu::conemap::generate::{Division, Maker};
use conemarch::gpu::device::Device;
use conemarch::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use conemarch::heightfield::conemap::generate::min3x3::min3x3;
use conemarch::heightfield::conemap::{ConeMap, WIDEST};
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::max_mip::MaxMip;
use conemarch::heightfield::pattern::Pattern;
use wgpu::naga::valid::Capabilities;

use crate::adapter;
use crate::fields::{
    WRAPS, assert_same, field, large, least_of_nine, make, plain, searching, small,
};
use crate::programs::map_programs;

/// A device of its own: makers borrow one.
fn device() -> Arc<Device> {
    adapter::open().device
}

/// A map from a device.
fn made(
    maker: &mut Maker<'_>,
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> ConeMap {
    let map = maker.generate(generator, heights, patches, options, &mut |_| true);
    map.unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that a device makes the CPU's map.
fn assert_cpus(
    maker: &mut Maker<'_>,
    name: &str,
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) {
    let here = make(generator, heights, patches, options);
    let there = made(maker, generator, heights, patches, options);
    let name = format!("{name} {generator:?}");
    assert_same(&name, &there.ratios, &here.ratios);
}

#[test]
fn every_generators_program_is_valid() {
    let all = map_programs();
    assert_eq!(all.len(), 2 + Generator::ALL.len());
    for program in all {
        let valid = program.validate(Capabilities::default());
        valid.unwrap_or_else(|e| panic!("{e}\n{}", program.describe()));
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
fn by_costs() -> impl Iterator<Item = Generator> {
    let all = Generator::ALL.into_iter();
    all.filter(|g| *g != Generator::RelaxedSearch)
}

#[test]
fn the_devices_maps_are_the_cpus_to_the_last_bit() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = Options::default();
    let small = small().into_iter().enumerate();
    let small = small.map(|(i, (name, heights))| (name, heights, Patches::ALL[i % 2]));
    let large = large().into_iter();
    let large = large.map(|(name, heights)| (name, heights, Patches::Bilinear));
    for (name, heights, patches) in small.chain(large) {
        for generator in by_costs() {
            assert_cpus(&mut maker, &name, generator, &heights, patches, &options);
        }
    }
}

#[test]
fn few_places_are_searched_again_on_the_cpu() {
    // What the device leaves open must not become the bulk of the work: the searches of
    // a rough field rarely end in a near tie.
    let device = device();
    let mut maker = Maker::new(&device);
    let heights = field(Pattern::Fbm, [128, 128], [true, true]);
    for generator in [Generator::Exact, Generator::Improved, Generator::Walk] {
        let (patches, options) = (Patches::default(), Options::default());
        made(&mut maker, generator, &heights, patches, &options);
        let share = maker.refined as f64 / 16_384.0;
        println!("{}: {share:.5} of all places", generator.name());
        assert!(share < 0.01, "{generator:?}: {share}");
    }
}

#[test]
fn near_ties_are_decided_in_f64() {
    // On a ramp all places ahead cost the same but for the rounding of their heights,
    // which f32 cannot tell from that of its own arithmetic.
    let device = device();
    let mut maker = Maker::new(&device);
    let (patches, options) = (Patches::default(), Options::default());
    for steps in [97, 150, 211] {
        let height = |i: u32| (i % 64 + 3 * (i / 64)) as f32 / steps as f32;
        let data = (0..64 * 11).map(height).collect();
        let heights = Heights::new([64, 11], [false, false], data).unwrap();
        for generator in by_costs() {
            let name = steps.to_string();
            assert_cpus(&mut maker, &name, generator, &heights, patches, &options);
            assert!(generator != Generator::Exact || maker.refined > 100);
        }
    }
}

#[test]
fn the_devices_least_of_nine_is_the_cpus() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = least_of_nine();
    let patches = Patches::default();
    for (i, (name, heights)) in small().into_iter().step_by(3).enumerate() {
        // Whole maps, and a row at a time.
        maker.division.band = [1 << 16, 1][i % 2];
        for generator in [Generator::Exact, Generator::Quad, Generator::Walk] {
            assert_cpus(&mut maker, &name, generator, &heights, patches, &options);
        }
    }
    // Ratios that f32 cannot tell apart, none at all, the least of all and the widest.
    for wrap in WRAPS {
        let (denormal, least) = (f64::from_bits(1), f64::MIN_POSITIVE);
        let odd = [0.0, denormal, least, 1e-300, 1.0, WIDEST];
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
            maker.division.band = band;
            let there = maker.min3x3(&map).unwrap();
            let what = format!("{wrap:?}, bands of {band}");
            assert_same(&what, &there.ratios, &min3x3(&map).ratios);
        }
    }
}

#[test]
fn how_the_work_is_divided_changes_no_map() {
    let device = device();
    let mut maker = Maker::new(&device);
    let options = searching(20);
    for f in [Pattern::Sine, Pattern::Spikes] {
        let heights = field(f, [37, 29], [true, false]);
        for generator in Generator::ALL {
            let mut with = |division| {
                maker.division = division;
                made(&mut maker, generator, &heights, Patches::Bilinear, &options)
            };
            let whole = with(Division::default());
            let parts = with(Division { band: 1, rounds: 3 });
            let what = format!("{f:?} {generator:?}");
            assert_same(&what, &parts.ratios, &whole.ratios);
        }
    }
}

#[test]
fn the_devices_search_along_rays_agrees_but_for_a_step_now_and_then() {
    let device = device();
    let mut maker = Maker::new(&device);
    let (search, patches) = (Generator::RelaxedSearch, Patches::Bilinear);
    let options = searching(64);
    for f in Pattern::ALL {
        let heights = field(f, [32, 32], [true, false]);
        let here = make(search, &heights, patches, &options);
        let there = made(&mut maker, search, &heights, patches, &options);
        let pairs = here.ratios.iter().zip(&there.ratios);
        let off = pairs.filter(|(a, b)| (*a - *b).abs() > 1e-5 * *a).count();
        println!("{}: {off} of 1024 differ", f.name());
        assert!(off <= 10, "{f:?}: {off}");
    }
}

#[test]
fn the_device_cancels_and_reports() {
    let device = device();
    let mut maker = Maker::new(&device);
    maker.division.band = 1;
    let heights = field(Pattern::Fbm, [64, 64], [false, false]);
    let mut make = |watch: &mut dyn FnMut(f64) -> bool| {
        let (patches, options) = (Patches::default(), Options::default());
        let made = maker.generate(Generator::Exact, &heights, patches, &options, watch);
        made.unwrap_err()
    };
    let mut reports = 0;
    let error = make(&mut |_| {
        reports += 1;
        reports < 3
    });
    assert!(matches!(error, GenerateError::Cancelled));
    assert_eq!(reports, 3);
    device.device.destroy();
    let error = make(&mut |_| true);
    assert!(matches!(error, GenerateError::Device(_)), "{error}");
    assert!(error.to_string().contains("was lost"), "{error}");
}
