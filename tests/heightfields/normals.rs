//! Smooth normals of bilinear surfaces.

use conemarch::heightfield::heights::Patches;
use conemarch::heightfield::pattern::Pattern;
use glam::{DVec2, DVec3};

use crate::adapter::{HIT, NORMALS};
use crate::cases::{alone, case, surface};
use crate::common::random::Random;
use crate::scenes::SCENES;
use crate::{both, plan};

/// The largest error of smooth slopes, in heights per texel, over a map of a function of the sample
/// whose slope is known. So many cells at each end are left out.
fn error(ends: u32, height: impl Fn(DVec2) -> f64, slope: impl Fn(DVec2) -> DVec2) -> f64 {
    let size = [12, 9];
    let samples =
        (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| DVec2::new(x.into(), y.into())));
    let made = surface(
        alone(size, Patches::Bilinear),
        samples.map(|at| height(at) as f32).collect(),
    );
    let mut random = Random::new(3);
    let mut most = 0.0_f64;
    for _ in 0..1000 {
        let cell = size.map(|n| (ends as usize + random.index((n - 1 - 2 * ends) as usize)) as i32);
        let place = [random.unit(), random.unit()];
        let at = DVec2::from(cell.map(f64::from)) + DVec2::from(place);
        most = most.max(made.smooth_slope(cell, place).distance(slope(at)));
    }
    most
}

/// Central differences of a polynomial of degree two have no error. At an end, those of a plane have
/// none.
#[test]
fn smooth_slopes_of_planes_and_quadratics_are_exact() {
    let plane = error(
        0,
        |p| 0.1 + 0.05 * p.x + 0.02 * p.y,
        |_| DVec2::new(0.05, 0.02),
    );
    let quadratic = error(
        1,
        |p| 0.2 + 0.004 * p.x * p.x - 0.03 * p.x + 0.002 * p.x * p.y + 0.003 * p.y * p.y,
        |p| DVec2::new(0.008 * p.x - 0.03 + 0.002 * p.y, 0.002 * p.x + 0.006 * p.y),
    );
    assert!(plane < 1e-6 && quadratic < 1e-6, "{plane} {quadratic}");
}

#[test]
fn smooth_slopes_are_continuous_across_cells_and_tiles() {
    let setting = ([7, 5], [true; 2], [3, 2], Patches::Bilinear);
    let made = case(Pattern::Noise, setting).surface;
    let mut random = Random::new(4);
    for _ in 0..500 {
        let [w, h] = made.domain();
        let cell = [w - 1, h - 1].map(|n| random.index(n as usize) as i32);
        let at = random.unit();
        let [x, y] = cell;
        let pairs = [
            (
                made.smooth_slope(cell, [1.0, at]),
                made.smooth_slope([x + 1, y], [0.0, at]),
            ),
            (
                made.smooth_slope(cell, [at, 1.0]),
                made.smooth_slope([x, y + 1], [at, 0.0]),
            ),
        ];
        for (before, behind) in pairs {
            assert!(before.distance(behind) < 1e-12, "{cell:?} {at}");
        }
    }
}

/// Light sees another surface, and rays the same. Both executors agree on both.
#[test]
fn hits_are_those_of_patches_and_the_executors_agree() {
    for scene in SCENES.into_iter().filter(|s| !s.contains("boxes")) {
        let [rough, smooth] =
            ["patches", "smooth"].map(|n| plan(&format!("{scene}\nnormals = '{n}'")));
        let patches = both(&rough, NORMALS);
        let [cpu, gpu] = both(&smooth, NORMALS);
        for (a, b) in patches.iter().zip([&cpu, &gpu]) {
            assert!(a.depth == b.depth && a.state == b.state, "{scene}");
        }
        let (mut hits, mut apart, mut moved) = (0, 0, 0);
        for i in (0..cpu.state.len()).filter(|i| cpu.state[*i] == HIT && gpu.state[*i] == HIT) {
            let normal = |n: &[[f32; 3]]| DVec3::from(n[i].map(f64::from));
            hits += 1;
            apart += usize::from(normal(&cpu.normal).distance(normal(&gpu.normal)) > 2e-3);
            moved += usize::from(normal(&cpu.normal).distance(normal(&patches[0].normal)) > 2e-2);
        }
        println!("{scene}: of {hits} hits {apart} apart, {moved} moved");
        assert!(
            apart * 200 < hits && moved * 4 > hits,
            "{scene}: {hits} {apart} {moved}"
        );
    }
}
