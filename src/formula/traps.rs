//! How near an orbit comes to some shapes. Twins: `wgsl/formula/traps.wgsl`, and by formula
//! `traps_plain.wgsl` and `traps_folds.wgsl`.

use glam::DVec3;

/// What an orbit has come to.
#[derive(Clone, Copy, Debug)]
pub struct Traps {
    /// Least distances to a point, a line, a plane, a sphere and a cross.
    near: [f64; 5],
    /// Iterations until it escaped.
    pub iterations: f64,
    /// How often it was folded.
    pub folds: u32,
}

impl Traps {
    /// An orbit without points.
    pub const FAR: Self = Self {
        near: [1e10; 5],
        iterations: 0.0,
        folds: 0,
    };

    /// Adds a point of the orbit; the sphere has this radius.
    pub fn add(&mut self, z: DVec3, radius: f64) {
        let (a, length) = (z.abs(), z.length());
        let (xy, yz, zx) = (a.x.hypot(a.y), a.y.hypot(a.z), a.z.hypot(a.x));
        let distances = [length, xy, a.z, (length - radius).abs(), xy.min(yz).min(zx)];
        for (near, d) in self.near.iter_mut().zip(distances) {
            *near = near.min(d);
        }
    }

    /// The numbers that pick colours: point, line, plane, sphere, cross, iterations, folds. A
    /// distance of `size` becomes 1/2.
    pub fn numbers(&self, size: f64) -> [f64; 7] {
        let [point, line, plane, sphere, cross] = self.near.map(|d| d / (d + size));
        let [iterations, folds] = [self.iterations, f64::from(self.folds)].map(|n| 0.1 * n);
        [point, line, plane, sphere, cross, iterations, folds]
    }
}
