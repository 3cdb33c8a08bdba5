//! A rotation between the folds of a formula.
//! Twins: `wgsl/formula/rotation.wgsl`, and `rotation_off.wgsl` for the identity.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};

use crate::base::shader::Module;
use crate::wgsl;

/// The rows of the matrix as WGSL reads them.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct RotationUniform {
    /// First row.
    pub row0: Vec3,
    /// Unused.
    pub pad0: f32,
    /// Second row.
    pub row1: Vec3,
    /// Unused.
    pub pad1: f32,
    /// Third row.
    pub row2: Vec3,
    /// Unused.
    pub pad2: f32,
}

/// A matrix counts as the identity if no entry differs from it by more. This is a few rounding
/// errors of sines and cosines. The smallest angle that still counts, 6e-14 degrees, is far
/// below the precision of f32.
const IDENTITY: f64 = 1e-15;

/// Rotation about x, then y, then z, by angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation(DMat3);

impl Rotation {
    /// The rotation by three angles; `None` if it is the identity.
    pub fn new(degrees: DVec3) -> Option<Self> {
        // Without whole turns, whose radians are rounded.
        let [x, y, z] = degrees.to_array().map(|a| (a % 360.0).to_radians());
        let matrix =
            DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        // Three half turns are also the identity.
        let same = matrix.abs_diff_eq(DMat3::IDENTITY, IDENTITY);
        (!same).then_some(Self(matrix))
    }

    /// The WGSL module of a rotation, or of none.
    pub fn module(rotation: Option<&Self>) -> Module {
        match rotation {
            Some(_) => wgsl!("formula/rotation.wgsl").neutral(),
            None => wgsl!("formula/rotation_off.wgsl"),
        }
    }

    /// The WGSL module of the Jacobian of an orbit with a rotation, or without.
    pub fn jacobian(rotation: Option<&Self>) -> Module {
        match rotation {
            Some(_) => {
                wgsl!("formula/jacobian.wgsl").replacing("wgsl/formula/jacobian_diagonal.wgsl")
            }
            None => wgsl!("formula/jacobian_diagonal.wgsl"),
        }
    }

    /// The values of the WGSL struct; the identity for none.
    pub fn uniform(rotation: Option<&Self>) -> RotationUniform {
        let matrix = rotation.map_or(DMat3::IDENTITY, |r| r.0);
        let [row0, row1, row2] = [0, 1, 2].map(|i| matrix.row(i).as_vec3());
        RotationUniform {
            row0,
            row1,
            row2,
            ..Zeroable::zeroed()
        }
    }

    /// The columns of the matrix.
    pub(super) fn columns(&self) -> [DVec3; 3] {
        [self.0.x_axis, self.0.y_axis, self.0.z_axis]
    }

    /// The rotated vector.
    pub fn rotate(&self, v: DVec3) -> DVec3 {
        self.0 * v
    }
}
