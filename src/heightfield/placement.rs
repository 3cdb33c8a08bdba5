//! The place of a block in the world, and the conversion between world and local units.
//!
//! The block stands on a base rectangle. Local coordinates are those of the height map: x and y
//! in texels from the block's corner, z = 0 at the base and 1 at the top. The parameter of a ray
//! stays the distance in the world, so that the local axis of a ray is not of length 1.

use glam::{DMat3, DVec2, DVec3, EulerRot};

/// Where a block stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Turns world directions to local ones.
    turn: DMat3,
    /// The world position of the corner that is the local origin.
    corner: DVec3,
    /// Length of a texel.
    pub texel: f64,
    /// Length of the whole height.
    pub depth: f64,
    /// Texels along the block's sides.
    pub sides: DVec2,
}

impl Placement {
    /// A block of `sides` texels whose longer side is `width` long. The middle of its base is at
    /// `centre`, and it is turned by angles in degrees about x, then y, then z.
    pub fn new(sides: DVec2, width: f64, depth: f64, centre: DVec3, angles: DVec3) -> Self {
        let a = angles * (std::f64::consts::PI / 180.0);
        let out = DMat3::from_euler(EulerRot::ZYX, a.z, a.y, a.x);
        let texel = width / sides.max_element();
        let middle = 0.5 * texel * sides;
        Self {
            turn: out.transpose(),
            corner: centre - out * middle.extend(0.0),
            texel,
            depth,
            sides,
        }
    }

    /// World lengths of the local units.
    pub fn units(&self) -> DVec3 {
        DVec3::new(self.texel, self.texel, self.depth)
    }

    /// A world direction in local units.
    pub fn direction(&self, v: DVec3) -> DVec3 {
        self.turn * v / self.units()
    }

    /// A world position in local units.
    pub fn position(&self, p: DVec3) -> DVec3 {
        self.direction(p - self.corner)
    }

    /// The world's unit normal of a surface whose height changes by `slope` per texel.
    pub fn normal(&self, slope: DVec2) -> DVec3 {
        let up = (-slope * (self.depth / self.texel)).extend(1.0);
        self.turn.transpose() * up.normalize()
    }

    /// The world direction of a local one, with the same length.
    pub fn side(&self, local: DVec3) -> DVec3 {
        self.turn.transpose() * local
    }

    /// Rows of the matrix that takes world directions to local units.
    pub fn rows(&self) -> [DVec3; 3] {
        let m = self.turn.transpose();
        [
            m.x_axis / self.texel,
            m.y_axis / self.texel,
            m.z_axis / self.depth,
        ]
    }

    /// Distance in the world from a local position to the block; negative inside.
    pub fn distance(&self, local: DVec3) -> f64 {
        let half = 0.5 * self.sides.extend(1.0);
        let o = ((local - half).abs() - half) * self.units();
        o.max(DVec3::ZERO).length() + o.max_element().min(0.0)
    }

    /// Distance from a world position to the farthest corner of the block.
    pub fn farthest(&self, p: DVec3) -> f64 {
        let half = 0.5 * self.sides.extend(1.0);
        (((self.position(p) - half).abs() + half) * self.units()).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: DVec3 = DVec3::new(1.0, -2.0, 3.0);

    fn askew() -> Placement {
        let (sides, angles) = (DVec2::new(63.0, 31.0), DVec3::new(20.0, -35.0, 50.0));
        Placement::new(sides, 8.0, 0.7, CENTRE, angles)
    }

    fn same(a: DVec3, b: DVec3) {
        assert!(a.distance(b) < 1e-12, "{a} for {b}");
    }

    #[test]
    fn the_middle_of_the_base_is_where_it_was_put() {
        same(askew().position(CENTRE), DVec3::new(31.5, 15.5, 0.0));
    }

    #[test]
    fn local_units_are_texels_and_heights() {
        let placed = askew();
        same(placed.direction(placed.side(DVec3::Z)), DVec3::Z / 0.7);
        same(
            placed.direction(placed.side(DVec3::X)),
            DVec3::X * 63.0 / 8.0,
        );
        let v = DVec3::new(0.3, -0.4, 0.5);
        let rows = placed.rows().map(|row| row.dot(v));
        same(placed.direction(v), rows.into());
    }

    #[test]
    fn normals_stand_on_the_surface() {
        let placed = askew();
        let slope = DVec2::new(0.02, -0.05);
        let normal = placed.normal(slope);
        for step in [DVec2::X, DVec2::Y, DVec2::new(2.0, -3.0)] {
            let local = step.extend(slope.dot(step)) * placed.units();
            assert!(placed.side(local).dot(normal).abs() < 1e-12);
        }
        assert!((normal.length() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn distances_are_the_worlds() {
        let placed = askew();
        for (above, wanted) in [(2.0, 1.3), (0.3, -0.3)] {
            let local = placed.position(CENTRE + above * placed.side(DVec3::Z));
            assert!((placed.distance(local) - wanted).abs() < 1e-12);
        }
    }
}
