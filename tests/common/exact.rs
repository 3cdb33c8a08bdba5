//! Solids in closed form, written apart from the ones that are tested: their distances,
//! and where a ray first meets them.

use glam::{DVec2, DVec3};

/// A solid whose distance and first meeting with a ray are known.
#[derive(Clone, Copy, Debug)]
pub enum Exact {
    /// Centre and radius.
    Ball(DVec3, f64),
    /// Centre and half edge.
    Cube(DVec3, f64),
    /// Middle, half height along z, radius.
    Rod(DVec3, f64, f64),
    /// Unit normal, half thickness and radius of a disc about the origin.
    Disc(DVec3, f64, f64),
}

/// Three balls, two cubes and a rod, by the sizes that can be set.
pub fn balls(rod_radius: f64, box_size: f64, ball_radius: f64) -> Vec<Exact> {
    vec![
        Exact::Ball(DVec3::ZERO, ball_radius),
        Exact::Ball(DVec3::new(1.6, 0.4, -0.3), 0.45),
        Exact::Ball(DVec3::new(-0.9, -1.3, 0.9), 0.25),
        Exact::Cube(DVec3::new(-1.6, 1.0, -0.4), box_size),
        Exact::Cube(DVec3::new(1.2, -1.5, -0.7), 0.35),
        Exact::Rod(DVec3::new(0.4, -2.0, 0.0), 1.8, rod_radius),
    ]
}

/// Distance to the nearest of several solids, negative inside.
pub fn distance(solids: &[Exact], p: DVec3) -> f64 {
    let all = solids.iter().map(|s| s.distance(p));
    all.fold(f64::INFINITY, f64::min)
}

/// The first distance at which a ray from outside or inside meets one of the solids;
/// infinite if it never does.
pub fn first_hit(solids: &[Exact], origin: DVec3, axis: DVec3) -> f64 {
    let all = solids.iter().map(|s| s.first_hit(origin, axis));
    all.fold(f64::INFINITY, f64::min)
}

/// The two ends of a ray's way through `|s + t ds|^2 <= r^2`, if it has one.
fn round(s_dot: f64, s_square: f64, ds_square: f64, r: f64) -> Option<(f64, f64)> {
    if ds_square < 1e-18 {
        return (s_square <= r * r).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let q = s_dot * s_dot - ds_square * (s_square - r * r);
    (q >= 0.0).then(|| {
        let root = q.sqrt();
        ((-s_dot - root) / ds_square, (-s_dot + root) / ds_square)
    })
}

/// The two ends of a ray's way between two planes at `-half` and `half`.
fn between(z: f64, dz: f64, half: f64) -> Option<(f64, f64)> {
    if dz.abs() < 1e-15 {
        return (z.abs() <= half).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (one, two) = ((-half - z) / dz, (half - z) / dz);
    Some((one.min(two), one.max(two)))
}

/// The nearer end of what several parts of a ray have in common, from 0 on.
fn entry(parts: &[Option<(f64, f64)>]) -> f64 {
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for part in parts {
        let Some((low, high)) = part else {
            return f64::INFINITY;
        };
        near = near.max(*low);
        far = far.min(*high);
    }
    if near <= far { near } else { f64::INFINITY }
}

impl Exact {
    fn distance(&self, p: DVec3) -> f64 {
        match *self {
            Exact::Ball(c, r) => p.distance(c) - r,
            Exact::Cube(c, half) => {
                let q = p - c;
                let off = q.abs() - half;
                off.max(DVec3::ZERO).length() + off.max_element().min(0.0)
            }
            Exact::Rod(c, half, r) => {
                let q = p - c;
                let beyond = (q.z.abs() - half).max(0.0);
                (q.x * q.x + q.y * q.y + beyond * beyond).sqrt() - r
            }
            Exact::Disc(n, half, radius) => {
                let z = p.dot(n).abs() - half;
                let rho = p.cross(n).length() - radius;
                DVec2::new(z.max(0.0), rho.max(0.0)).length() + z.max(rho).min(0.0)
            }
        }
    }

    fn first_hit(&self, o: DVec3, a: DVec3) -> f64 {
        let ball = |c: DVec3, r| {
            let s = o - c;
            round(s.dot(a), s.length_squared(), 1.0, r)
        };
        match *self {
            Exact::Ball(c, r) => entry(&[ball(c, r)]),
            Exact::Cube(c, half) => {
                let part = |i: usize| between(o[i] - c[i], a[i], half);
                entry(&[part(0), part(1), part(2)])
            }
            Exact::Rod(c, half, r) => {
                let (s, d) = ((o - c).truncate(), a.truncate());
                let side = round(s.dot(d), s.length_squared(), d.length_squared(), r);
                let shaft = entry(&[side, between(o.z - c.z, a.z, half)]);
                let caps = [-half, half].map(|z| entry(&[ball(c + z * DVec3::Z, r)]));
                shaft.min(caps[0]).min(caps[1])
            }
            Exact::Disc(n, half, radius) => {
                let (z, dz) = (o.dot(n), a.dot(n));
                let (s, d) = (o - z * n, a - dz * n);
                let side = round(s.dot(d), s.length_squared(), d.length_squared(), radius);
                entry(&[side, between(z, dz, half)])
            }
        }
    }
}
