//! Paths of cameras through random poses at uneven times.

use conemarch::time::pose::Pose;
use glam::DVec3;

use crate::common::random::Random;

fn level(eye: DVec3, target: DVec3) -> Pose {
    Pose::new(eye, target, DVec3::Z)
}

/// Times that follow each other after 0.01 to 10 beats.
fn times(random: &mut Random) -> [f64; 4] {
    let mut time = 0.0;
    [0; 4].map(|_| {
        time += 10f64.powf(random.between(-2.0, 1.0));
        time
    })
}

/// How far a camera goes and turns from one pose to another, in distances to its target and
/// radians.
fn way(a: &Pose, b: &Pose) -> [f64; 2] {
    let least = a.distance.min(b.distance);
    [a.eye.distance(b.eye) / least, a.turn.angle_between(b.turn)]
}

#[test]
fn uneven_times_make_no_camera_swing() {
    let mut random = Random::new(5);
    for _ in 0..2000 {
        let times = times(&mut random);
        let mut eye = DVec3::new(0.0, -5.0, 1.0);
        let poses = times.map(|time| {
            eye += random.cube(1.0);
            let target = eye + DVec3::new(0.0, 5.0, -1.0) + random.cube(2.0);
            (time, level(eye, target))
        });
        let [(from, here), (to, there)] = [poses[1], poses[2]];
        let [nearest, farthest] = [
            here.distance.min(there.distance),
            here.distance.max(there.distance),
        ];
        let [moved, turned] = way(&here, &there);
        let mut last = here;
        for i in 1..=64 {
            let at = from + (to - from) * f64::from(i) / 64.0;
            let now = Pose::on_spline(poses, at);
            assert!(
                (nearest * 0.999_999..farthest * 1.000_001).contains(&now.distance),
                "{now:?}"
            );
            // A cubic whose slopes at its ends are at most twice its mean has at most twice its
            // mean speed. Turns and moves share their weights, so that one may lend to the other.
            let [step, turn] = way(&last, &now);
            let most = 64.0f64.recip() * 4.0 * (moved + turned + (farthest / nearest).ln());
            assert!(step < most && turn < most, "{step} {turn} {most} {poses:?}");
            last = now;
        }
    }
}

#[test]
fn a_path_keeps_the_target_or_the_eye_that_all_its_poses_share() {
    let mut random = Random::new(6);
    let shared = DVec3::new(5.0, 1.0, 0.2);
    for _ in 0..1000 {
        let times = times(&mut random);
        let at = random.between(times[1], times[2]);
        let ways = times.map(|time| {
            let way = DVec3::new(random.between(-1.0, 1.0), 1.5, random.between(-1.0, 1.0));
            (time, way.normalize())
        });
        let zooms = ways.map(|(time, way)| {
            let far = 10f64.powf(random.between(-3.0, 1.0));
            (time, level(shared + far * way, shared))
        });
        let there = Pose::on_spline(zooms, at);
        assert!(there.target().distance(shared) < 1e-9, "{there:?}");
        let turns = ways.map(|(time, way)| (time, level(shared, shared + 3.0 * way)));
        let there = Pose::on_spline(turns, at);
        assert!(there.eye.distance(shared) < 1e-9, "{there:?}");
    }
}
