//! One iteration of the Mandelbox: box fold, ball fold, rotation, scale, translation
//! (docs/method.md, 3).
//! Twin: `wgsl/formula/folds.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use crate::formula::rotation::Rotation;
use crate::formula::traps::Traps;

/// The parameters as WGSL reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FoldsUniform {
    /// The added constant in Julia mode.
    pub julia: Vec3,
    /// s.
    pub scale: f32,
    /// L.
    pub fold_limit: f32,
    /// Inner and outer radius of the ball fold.
    pub min_radius: f32,
    /// See `min_radius`.
    pub fixed_radius: f32,
    /// Their squares.
    pub min2: f32,
    /// See `min2`.
    pub fixed2: f32,
    /// See [`Folds::bail2`].
    pub bail2: f32,
    /// See [`Folds::lipschitz`].
    pub lipschitz: f32,
    /// See [`Folds::lead`].
    pub lead: f32,
    /// See [`Folds::kappa`].
    pub kappa: f32,
    /// See [`Folds::tail`].
    pub tail: f32,
    /// See [`Folds::k_at_zero`].
    pub k_at_zero: f32,
    /// |s - 1|, of the classic estimate.
    pub classic_offset: f32,
    /// |s|^(1 - iterations), of the classic estimate.
    pub classic_skin: f32,
    /// Unused.
    pub pad0: u32,
    /// Unused.
    pub pad1: u32,
    /// Unused.
    pub pad2: u32,
}

/// The numbers of a Mandelbox, resolved.
#[derive(Clone, Debug)]
pub struct Folds {
    /// The added constant in Julia mode.
    pub julia: DVec3,
    /// The rotation after the folds.
    pub rotation: Option<Rotation>,
    /// s.
    pub scale: f64,
    /// L.
    pub fold_limit: f64,
    /// Inner and outer radius of the ball fold.
    pub radii: [f64; 2],
    /// Divisor of the estimate in the steps of rays.
    pub lipschitz: f64,
    /// The squared length at which an orbit ends if its coordinates do not tell.
    pub bail2: f64,
    /// 1/(|s| - 1).
    pub tail: f64,
    /// 2 sqrt(3) L |s| / (|s| - 1): points farther from the origin escape if c = 0.
    pub k_at_zero: f64,
    /// 2 L |s| / (|s| - 1): without a rotation, larger coordinates escape if c = 0.
    pub lead: f64,
    /// 1/(s + 1): the coordinates at which points escape move by this times c.
    pub kappa: f64,
}

/// A box fold and a ball fold of a point.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    /// The point after the box fold.
    pub b: DVec3,
    /// Its length.
    pub length: f64,
    /// The factor of the ball fold.
    pub m: f64,
}

impl Folds {
    /// Folds a point.
    pub fn fold(&self, z: DVec3) -> Fold {
        let limit = DVec3::splat(self.fold_limit);
        let b = 2.0 * z.clamp(-limit, limit) - z;
        let square = b.length_squared();
        let [low, high] = self.radii.map(|r| r * r);
        Fold {
            b,
            length: square.sqrt(),
            m: high / square.clamp(low, high),
        }
    }

    /// Turns, scales and moves a folded point.
    pub fn next(&self, fold: &Fold, c: DVec3) -> DVec3 {
        let turned = self.rotation.as_ref().map_or(fold.b, |r| r.rotate(fold.b));
        self.scale * (fold.m * turned) + c
    }

    /// By how much lengths grow.
    pub fn growth(&self, fold: &Fold) -> f64 {
        self.scale.abs() * fold.m
    }

    /// K for a constant.
    pub fn k(&self, c: DVec3) -> f64 {
        self.k_at_zero + self.tail * c.length()
    }

    /// Where a coordinate escapes, and past which no ball fold inverts again.
    pub fn edges(&self, c: DVec3) -> [f64; 2] {
        let shift = self.kappa.abs() * c.abs().max_element();
        let lead = self.lead + shift;
        let unfolded = self.radii[1] - 2.0 * self.fold_limit * self.tail + shift;
        [lead, lead + unfolded.max(0.0)]
    }

    /// The coordinate at which orbits end.
    pub fn exit(&self, c: DVec3) -> f64 {
        let [lead, unfolded] = self.edges(c);
        // Beyond 4 L a coordinate that counts later adds little. The share of the rest keeps
        // cancellation in f32 under 2e-6.
        (lead + (4.0 * self.fold_limit).max(0.05 * lead)).max(unfolded)
    }

    /// Whether an orbit has escaped for good. `exit` is that of its constant.
    pub fn ended(&self, z: DVec3, exit: f64) -> bool {
        match self.rotation {
            None => z.abs().max_element() > exit,
            Some(_) => z.length_squared() > self.bail2,
        }
    }

    /// |s|^(1 - N) after N iterations: subtracted in the classic estimate.
    pub fn classic_skin(&self, iterations: u32) -> f64 {
        self.scale.abs().powf(1.0 - f64::from(iterations))
    }

    /// The values of the WGSL struct.
    pub fn uniform(&self, iterations: u32) -> FoldsUniform {
        FoldsUniform {
            julia: self.julia.as_vec3(),
            scale: self.scale as f32,
            fold_limit: self.fold_limit as f32,
            min_radius: self.radii[0] as f32,
            fixed_radius: self.radii[1] as f32,
            min2: self.radii[0].powi(2) as f32,
            fixed2: self.radii[1].powi(2) as f32,
            bail2: self.bail2 as f32,
            lipschitz: self.lipschitz as f32,
            lead: self.lead as f32,
            kappa: self.kappa as f32,
            tail: self.tail as f32,
            k_at_zero: self.k_at_zero as f32,
            classic_offset: (self.scale - 1.0).abs() as f32,
            classic_skin: self.classic_skin(iterations) as f32,
            ..FoldsUniform::zeroed()
        }
    }

    /// How far a point is past where points escape; 0 before.
    pub fn top(&self, z: DVec3, c: DVec3) -> f64 {
        match self.rotation {
            None => {
                let off = (z - self.kappa * c).abs() - DVec3::splat(self.lead);
                off.max(DVec3::ZERO).length()
            }
            Some(_) => (z.length() - self.k(c)).max(0.0),
        }
    }

    /// Three orbit traps from 0 to 1: how near the orbit comes to the origin, to the coordinate
    /// planes and to the fixed sphere.
    pub fn trap(&self, p: DVec3, c: DVec3, most: u32) -> DVec3 {
        let high = self.radii[1].powi(2);
        let (mut origin, mut plane, mut sphere) = (1e10_f64, 1e10_f64, 1e10_f64);
        let mut z = p;
        // Later iterations only add noise to the colour.
        for _ in 0..most.min(10) {
            if z.length_squared() > self.bail2 {
                break;
            }
            let fold = self.fold(z);
            let b2 = fold.b.length_squared();
            origin = origin.min(b2);
            plane = plane.min(fold.b.abs().min_element());
            sphere = sphere.min((b2 - high).abs());
            z = self.next(&fold, c);
        }
        let size = self.fold_limit;
        DVec3::new(
            origin.sqrt() / (origin.sqrt() + size),
            plane / (plane + 0.25 * size),
            sphere / (sphere + high),
        )
    }

    /// The numbers of all traps. Twin: `wgsl/formula/traps_folds.wgsl`.
    pub fn traps(&self, p: DVec3, c: DVec3, most: u32) -> [f64; 7] {
        let mut all = Traps::FAR;
        let (mut z, mut n) = (p, 0);
        while n < most && z.length_squared() <= self.bail2 {
            let fold = self.fold(z);
            // Later iterations only add noise to distances.
            if n < 10 {
                all.add(fold.b, self.radii[1]);
            }
            let over = z.abs().cmpgt(DVec3::splat(self.fold_limit)).bitmask();
            all.folds += over.count_ones() + u32::from(fold.length < self.radii[1]);
            z = self.next(&fold, c);
            n += 1;
        }
        // An orbit that is far past its end has ended earlier.
        let past = 0.5 * (z.length_squared() / self.bail2).max(1.0).ln() / self.scale.abs().ln();
        all.iterations = f64::from(n) - past.min(1.0);
        all.numbers(self.fold_limit)
    }
}
