//! The view: rays go through their pixels, and the rays of a cell's pixels lie within
//! its cone, at every image size and field of view, in every projection.

use conemarch::base::filter::RADIUS;
use conemarch::base::projection::Projection;
use conemarch::base::view::{Beam, View, footprint};
use conemarch::plan::camera::Camera;
use glam::{DVec2, DVec3};

use super::common::random::Random;

const SIZES: [[u32; 2]; 5] = [[1, 1], [33, 17], [1366, 768], [1, 400], [200, 1]];
const FOVS: [f64; 4] = [1.0, 48.5, 90.0, 170.0];

fn view(size: [u32; 2], fov: f64) -> View {
    let camera = Camera {
        eye: DVec3::new(1.0, 2.0, -3.0),
        target: DVec3::new(-2.0, 0.5, 4.0),
        up: DVec3::Y,
        fov,
        ..Camera::default()
    };
    camera.view(size)
}

/// All cells of a level, or a sample that holds the corners and the middle.
fn cells(size: [u32; 2], divisor: u32, random: &mut Random) -> Vec<[u32; 2]> {
    let [w, h] = size.map(|n| n.div_ceil(divisor));
    if w * h <= 1000 {
        return (0..w * h).map(|i| [i % w, i / w]).collect();
    }
    let corners = [[0, 0], [w - 1, 0], [0, h - 1], [w - 1, h - 1]];
    let at = |n: u32, r: f64| (f64::from(n) * r) as u32;
    let sample = (0..200).map(|_| [at(w, random.unit()), at(h, random.unit())]);
    corners
        .into_iter()
        .chain([[w / 2, h / 2]])
        .chain(sample)
        .collect()
}

/// Pixels of a cell, cut by the image.
fn pixels(cell: [u32; 2], divisor: u32, size: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let low = cell.map(|c| c * divisor);
    let high = [0, 1].map(|i| (low[i] + divisor).min(size[i]));
    (low[1]..high[1]).flat_map(move |y| (low[0]..high[0]).map(move |x| [x, y]))
}

/// Pixels whose ray lies outside the cone of their cell, its chord multiplied by a
/// factor, or whose footprint is coarser than the cone's.
fn outside(size: [u32; 2], fov: f64, factor: f64) -> (usize, usize) {
    let view = view(size, fov);
    let random = &mut Random::new(11);
    let (mut seen, mut out) = (0, 0);
    for level in 1..7 {
        let divisor = 1 << level;
        for cell in cells(size, divisor, random) {
            let cone = view.view_cone(cell, divisor);
            assert!((cone.axis.length() - 1.0).abs() < 1e-12);
            assert!(cone.k > 0.0 && cone.k <= 2.0);
            for pixel in pixels(cell, divisor, size) {
                let ray = view.view_ray(pixel);
                let within = (ray.axis - cone.axis).length() <= factor * cone.k;
                let finer = ray.grain <= cone.grain * (1.0 + 1e-12);
                seen += 1;
                out += usize::from(!(within && finer));
            }
        }
    }
    (seen, out)
}

#[test]
fn every_ray_lies_in_the_cone_of_its_cell_at_every_size() {
    for size in SIZES {
        for fov in FOVS {
            let (seen, out) = outside(size, fov, 1.0);
            assert!(seen >= 6);
            assert_eq!(out, 0, "{size:?} at {fov} degrees, of {seen}");
            // The cones are not much wider than that: a little narrower, and rays fall out.
            let (_, out) = outside(size, fov, 0.95);
            assert!(
                out > 0 || size == [1, 1],
                "{size:?} at {fov} degrees, of {seen}"
            );
        }
    }
}

#[test]
fn rays_go_through_the_middles_of_their_pixels() {
    for size in SIZES {
        for fov in FOVS {
            let view = view(size, fov);
            let [w, h] = size.map(f64::from);
            // From the upper to the lower edge it is the field of view.
            let [top, bottom] = [0.0, h].map(|y| view.view_direction(0.5 * w, y));
            let angle = top.angle_between(bottom).to_degrees();
            assert!((angle - fov).abs() < 1e-9 * fov + 1e-6, "{angle} {fov}");
            let middle = view.view_direction(0.5 * w, 0.5 * h);
            let to_target = (DVec3::new(-2.0, 0.5, 4.0) - DVec3::new(1.0, 2.0, -3.0)).normalize();
            assert!(middle.distance(to_target) < 1e-12);
            assert!(top.y > bottom.y, "up is down");
            // Right-handed: right is forward x up.
            let right = view.view_direction(w, 0.5 * h) - middle;
            let square = middle.cross(DVec3::Y).normalize();
            assert!(right.normalize().distance(square) < 1e-9);
            let [last_x, last_y] = size.map(|n| n - 1);
            for pixel in [[0, 0], [size[0] / 2, size[1] / 3], [last_x, last_y]] {
                let [x, y] = pixel.map(|n| f64::from(n) + 0.5);
                let u = view.view_direction(x, y);
                let ray = view.view_ray(pixel);
                assert!(ray.axis.distance(u.normalize()) < 1e-12);
                assert_eq!((ray.k, ray.r0, ray.origin), (0.0, 0.0, DVec3::ZERO));
                // Half the distance to the next pixel's ray, seen at distance 1.
                let next = view.view_direction(x + 1.0, y);
                let half = 0.5 * next.distance(u) / u.length();
                assert!((ray.grain / half - 1.0).abs() < 1e-9);
            }
        }
    }
}

/// The views that differ in all that cones depend on.
fn views(projection: Projection) -> Vec<View> {
    let fovs = [1.0, 48.5, 170.0, 250.0, 360.0];
    let fovs = fovs.into_iter().filter(|fov| *fov <= projection.widest());
    let all = fovs.flat_map(|fov| SIZES.map(|size| (fov, size)));
    let of = |(fov, size): (f64, [u32; 2])| {
        let camera = Camera {
            eye: DVec3::new(1.0, 2.0, -3.0),
            target: DVec3::new(-2.0, 0.5, 4.0),
            up: DVec3::new(0.2, 1.0, 0.1),
            fov,
            projection,
            aperture: 0.1,
            ..Camera::default()
        };
        let view = camera.view(size);
        let lens = camera.lens().filter(|_| projection.has_lens());
        let samples = View {
            filter_radius: RADIUS,
            ..view
        };
        [view, samples, View { lens, ..samples }]
    };
    all.flat_map(of).collect()
}

/// The largest share of the room in a cone that a ray takes along its way.
fn taken(cone: &Beam, ray: &Beam) -> f64 {
    let room = |t: f64| ray.at(t).distance(cone.at(t)) / (cone.r0 + cone.k * t);
    [1e-3, 0.7, 8.0, 1e4]
        .map(room)
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn every_ray_lies_in_the_cone_of_its_cell_in_every_projection() {
    let random = &mut Random::new(13);
    for (word, projection) in Projection::WORDS {
        let mut most = 0.0_f64;
        for view in views(*projection) {
            for level in 1..7 {
                let divisor = 1 << level;
                for _ in 0..60 {
                    let within = |n: u32, share: f64| (f64::from(n) * share) as u32;
                    let cells = view.size.map(|n| n.div_ceil(divisor));
                    let cell = cells.map(|n| within(n, random.unit()));
                    let cone = view.view_cone(cell, divisor);
                    assert!((cone.axis.length() - 1.0).abs() < 1e-12);
                    assert!(cone.k > 0.0 && cone.k <= 2.0);
                    for n in 0..20 {
                        let low = cell.map(|c| c * divisor);
                        // Corners are the hardest.
                        let share = |random: &mut Random| match n < 10 {
                            true => random.unit(),
                            false => f64::from(u8::from(random.unit() < 0.5)) * (1.0 - 1e-9),
                        };
                        let pixel = [0, 1].map(|i| {
                            let count = (view.size[i] - low[i]).min(divisor);
                            low[i] + within(count, share(random))
                        });
                        let place = DVec2::new(share(random), share(random));
                        let offset = view.filter_radius * (2.0 * place - 1.0);
                        let ray = view.view_ray_from(
                            pixel,
                            offset,
                            DVec2::new(random.unit(), share(random)),
                        );
                        let taken = taken(&cone, &ray);
                        let what = format!("{word} {view:?} {cell:?} {divisor} {pixel:?} {offset}");
                        assert!(taken <= 1.0 + 1e-12, "{taken} {what}");
                        most = most.max(taken);
                        let finer = footprint(&ray, 3.0) <= footprint(&cone, 3.0) * (1.0 + 1e-12);
                        assert!(finer, "{what}");
                        assert!(
                            ray.origin.length() <= view.spacing() * (1.0 + 1e-9),
                            "{what}"
                        );
                    }
                }
            }
        }
        // Nor are the cones wider than they must be.
        assert!(most > 0.98, "{word} {most}");
    }
}

#[test]
fn projections_look_where_they_say() {
    let view = |projection, fov, size| {
        let camera = Camera {
            eye: DVec3::new(0.0, -4.0, 0.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            fov,
            projection,
            ..Camera::default()
        };
        camera.view(size)
    };
    let near = |ray: Beam, origin: DVec3, axis: DVec3| {
        assert!(ray.origin.distance(origin) < 1e-12, "{ray:?}");
        assert!(ray.axis.distance(axis) < 1e-12, "{ray:?}");
    };
    let (right, ahead, up) = (DVec3::X, DVec3::Y, DVec3::Z);
    let half = DVec2::splat(0.5);
    // As high at the target as a perspective view of 60 degrees.
    let flat = view(Projection::Orthographic, 60.0, [200, 100]);
    let high = 4.0 / 3.0_f64.sqrt();
    near(flat.view_ray_at([100, 50], -half), DVec3::ZERO, ahead);
    near(
        flat.view_ray_at([0, 0], -half),
        high * (up - 2.0 * right),
        ahead,
    );
    assert!((flat.view_ray([3, 4]).grain0 / (high / 100.0) - 1.0).abs() < 1e-12);
    // 180 degrees high: the top looks up, and so far to the side the ray looks right.
    let fish = view(Projection::Fisheye, 180.0, [400, 100]);
    near(fish.view_ray_at([200, 50], -half), DVec3::ZERO, ahead);
    near(fish.view_ray_at([200, 0], -half), DVec3::ZERO, up);
    near(fish.view_ray_at([250, 50], -half), DVec3::ZERO, right);
    near(
        fish.view_ray_at([225, 50], -half),
        DVec3::ZERO,
        (ahead + right).normalize(),
    );
    // Beyond 180 degrees from the axis all rays look back.
    near(fish.view_ray_at([390, 10], -half), DVec3::ZERO, -ahead);
    let globe = view(Projection::Equirectangular, 40.0, [400, 100]);
    near(globe.view_ray_at([200, 50], -half), DVec3::ZERO, ahead);
    near(globe.view_ray_at([300, 50], -half), DVec3::ZERO, right);
    near(globe.view_ray_at([0, 50], -half), DVec3::ZERO, -ahead);
    near(globe.view_ray_at([77, 0], -half), DVec3::ZERO, up);
    near(
        globe.view_ray_at([300, 25], -half),
        DVec3::ZERO,
        (up + right).normalize(),
    );
    // Past the seam and past the pole goes on with what is there.
    let there = globe.view_ray([399, 20]).axis;
    near(
        globe.view_ray_at([0, 20], DVec2::new(-1.0, 0.0)),
        DVec3::ZERO,
        there,
    );
    let there = globe.view_ray([230, 0]).axis;
    near(
        globe.view_ray_at([30, 0], DVec2::new(0.0, -1.0)),
        DVec3::ZERO,
        there,
    );
}
