//! A search for oversteps: points whose empty balls reach a point of the set.
//!
//! Points of the set are found by marching to them. Then a climb starts near each, and moves the
//! centre of the ball to where it reaches farther past the point.

use conemarch::formula::DistanceEstimate;
use conemarch::formula::mandelbox::Mandelbox;
use glam::DVec3;

use super::random::Random;

/// Iterations after which an estimate in f64 no longer changes.
const MANY: u32 = 120;

/// A climb: a point of the set, and the centre of a ball near it.
#[derive(Clone, Copy, Debug)]
pub struct Climb {
    /// The point of the set.
    pub set: DVec3,
    /// The centre of the ball.
    pub centre: DVec3,
    /// The radius of the ball over the distance: over 1 is an overstep.
    pub ratio: f64,
    /// The size of the next change.
    stride: f64,
}

/// Points that belong to the set but for a few roundings: where rays between random points end.
/// Each is with the direction of its ray.
pub fn of_the_set(m: &Mandelbox, count: usize, random: &mut Random) -> Vec<(DVec3, DVec3)> {
    let (evaluator, half) = (m.evaluator(), m.bounds().half);
    let mut found = Vec::new();
    for _ in 0..100 * count {
        let [from, to] = [1.0, 0.8].map(|share| share * half * random.cube(1.0));
        let axis = (to - from).normalize();
        let mut t = 0.0;
        for _ in 0..400 {
            let (d, _) = evaluator.value(from + t * axis, MANY);
            if d < 1e-12 * half.x {
                found.push((from + t * axis, axis));
                break;
            }
            t += 0.7 * d;
            if t > 4.0 * half.x {
                break;
            }
        }
        if found.len() == count {
            break;
        }
    }
    assert_eq!(found.len(), count, "points of {m:?}");
    found
}

/// A point of the set in Julia mode, with any direction. All inverses of an iteration bring points
/// nearer to each other, so whatever inverses are taken of any point tend to points of the set.
fn of_the_julia_set(m: &Mandelbox, random: &mut Random) -> (DVec3, DVec3) {
    let [low, high] = [m.min_radius, m.fixed_radius];
    let mut z = random.cube(1.0);
    for _ in 0..MANY {
        let folded = (z - m.julia_constant) / m.scale;
        let l = folded.length();
        let scaled = (low / high).powi(2) * folded;
        let inverses = [
            (l >= high, folded),
            (
                l >= high && l * low <= high * high,
                (high / l).powi(2) * folded,
            ),
            (l * low <= high * high, scaled),
        ];
        let inverses: Vec<DVec3> = inverses.iter().filter(|i| i.0).map(|i| i.1).collect();
        let b = inverses[random.between(0.0, inverses.len() as f64) as usize];
        let side = m.fold_limit;
        z = DVec3::from_array(b.to_array().map(|b| {
            let sides = [
                (b.abs() <= side, b),
                (b <= side, 2.0 * side - b),
                (b >= -side, -2.0 * side - b),
            ];
            let sides: Vec<f64> = sides.iter().filter(|i| i.0).map(|i| i.1).collect();
            sides[random.between(0.0, sides.len() as f64) as usize]
        }));
    }
    (z, random.direction())
}

/// As [`start`], for a set in Julia mode that may be dust.
pub fn start_in_julia_mode(m: &Mandelbox, count: usize, random: &mut Random) -> Vec<Climb> {
    let points = (0..count.div_ceil(4)).map(|_| of_the_julia_set(m, random));
    let points: Vec<_> = points.collect();
    start_at(&points, m, count, random)
}

/// Starts so many climbs, from 1e-4 to 1 limits off the points. Half of them start on the ray that
/// ended there, before the point.
pub fn start(m: &Mandelbox, count: usize, random: &mut Random) -> Vec<Climb> {
    let points = of_the_set(m, count.div_ceil(4), random);
    start_at(&points, m, count, random)
}

fn start_at(
    points: &[(DVec3, DVec3)],
    m: &Mandelbox,
    count: usize,
    random: &mut Random,
) -> Vec<Climb> {
    let off = |i: usize, random: &mut Random| {
        let (set, axis) = points[i / 4];
        let distance = m.fold_limit * 10.0_f64.powf(random.between(-4.0, 0.0));
        let away = if i.is_multiple_of(2) {
            random.direction()
        } else {
            -axis
        };
        Climb {
            set,
            centre: set + distance * away,
            ratio: 0.0,
            stride: random.between(0.1, 1.0),
        }
    };
    (0..count).map(|i| off(i, random)).collect()
}

/// Climbs by so many rounds. `radii` tells the radius that is claimed at each centre, given how far
/// off the set it is.
pub fn climb(
    climbs: &mut [Climb],
    rounds: u32,
    random: &mut Random,
    mut radii: impl FnMut(&[(DVec3, f64)]) -> Vec<f64>,
) {
    for round in 0..rounds {
        let tried: Vec<(DVec3, f64)> = climbs
            .iter()
            .map(|c| {
                let off = c.centre.distance(c.set);
                let change = match round {
                    0 => DVec3::ZERO,
                    _ => c.stride * off * random.unit() * random.direction(),
                };
                let centre = c.centre + change;
                (centre, centre.distance(c.set))
            })
            .collect();
        for (c, ((centre, off), radius)) in climbs.iter_mut().zip(tried.iter().zip(radii(&tried))) {
            let ratio = radius / off;
            if ratio > c.ratio {
                (c.centre, c.ratio) = (*centre, ratio);
            } else {
                c.stride = (0.85 * c.stride).max(1e-4);
            }
        }
    }
}

/// The largest ratio of all climbs.
pub fn largest(climbs: &[Climb]) -> Climb {
    let largest = climbs.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio));
    *largest.expect("there are climbs")
}

/// Mandelboxes of both signs, and of all sizes of scale, limit and radii.
pub fn settings() -> Vec<Mandelbox> {
    let of = |&(scale, fold_limit, min_radius, fixed_radius)| Mandelbox {
        scale,
        fold_limit,
        min_radius,
        fixed_radius,
        ..Mandelbox::default()
    };
    [
        (1.3, 0.5, 0.4, 1.0),
        (1.7, 1.0, 0.25, 1.0),
        (2.0, 1.0, 0.5, 1.0),
        (2.0, 0.5, 0.4, 1.0),
        (2.0, 1.0, 0.25, 1.0),
        (2.5, 1.0, 0.5, 1.0),
        (3.0, 1.0, 0.5, 1.0),
        (4.0, 2.0, 0.3, 1.0),
        (-1.5, 1.0, 0.5, 1.0),
        (-3.0, 1.0, 0.5, 1.0),
    ]
    .iter()
    .map(of)
    .collect()
}
