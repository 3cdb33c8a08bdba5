//! A rotation between the folds of a formula. Twins: `wgsl/formula/rotation.wgsl`,
//! and `rotation_none.wgsl` for the identity.

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};

use crate::base::shader::Module;
use crate::wgsl;

/// Three rows as WGSL reads them.
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

/// No entry of a rotation is off by more from the identity's than a few roundings of sines
/// and cosines: it is the identity. The least angle that is told from none, 6e-14 degrees,
/// moves nothing by what f32 could hold.
const IDENTITY: f64 = 1e-15;

/// Rotation about x, then y, then z, by angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation(DMat3);

impl Rotation {
    /// The rotation of three angles, or `None` where it is the identity.
    pub fn new(degrees: DVec3) -> Option<Self> {
        // Whole turns leave no rounding of pi behind.
        let [x, y, z] = degrees.to_array().map(|a| (a % 360.0).to_radians());
        let matrix =
            DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        // Three half turns are none, too.
        let same = matrix.abs_diff_eq(DMat3::IDENTITY, IDENTITY);
        (!same).then_some(Self(matrix))
    }

    /// The module to join for a rotation, or for none.
    pub fn module(rotation: Option<&Self>) -> Module {
        match rotation {
            Some(_) => wgsl!("formula/rotation.wgsl"),
            None => wgsl!("formula/rotation_none.wgsl"),
        }
    }

    /// Values for WGSL.
    pub fn uniform(&self) -> RotationUniform {
        let row = |i| self.0.row(i).as_vec3();
        RotationUniform {
            row0: row(0),
            pad0: 0.0,
            row1: row(1),
            pad1: 0.0,
            row2: row(2),
            pad2: 0.0,
        }
    }

    /// The rotated vector.
    pub fn rotate(&self, v: DVec3) -> DVec3 {
        self.0 * v
    }
}
