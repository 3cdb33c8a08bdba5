//! How the camera moves: held keys fly it, drags turn it.

use glam::{DQuat, DVec3};

use crate::plan::camera::Camera;

/// The largest share of the clearance that one step goes, so that no step leaves the empty ball.
const MOST_OF_CLEARANCE: f64 = 0.5;
/// The least speed through walls, as a share of the constant one: there is no empty space in them.
const IN_WALLS: f64 = 0.2;
/// The largest coordinate that a preset can have.
const FARTHEST: f64 = 1e9;
/// How much faster the camera flies with Shift.
const FAST: f64 = 5.0;
/// Degrees of roll per second.
const ROLL: f64 = 60.0;
/// A view comes so near to `up` or down at most, in radians: beyond it right and left would swap.
const NEAREST_TO_UP: f64 = 0.01;

/// What the speed follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// The empty space about the eye.
    #[default]
    Clearance,
    /// The distance from eye to target, which flight keeps.
    Constant,
}

/// What the keys ask for, each axis from -1 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thrust {
    /// To the right, upward and forward.
    pub way: DVec3,
    /// Clockwise.
    pub roll: f64,
    /// Faster.
    pub fast: bool,
}

/// How the camera flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// What the speed follows.
    pub pace: Pace,
    /// A factor on the speed.
    pub speed: f64,
    /// Whether steps may leave the space that is proven empty.
    pub through_walls: bool,
}

impl Default for Flight {
    fn default() -> Self {
        Self {
            pace: Pace::default(),
            speed: 1.0,
            through_walls: false,
        }
    }
}

/// The axes of a camera: right, up and forward.
fn axes(camera: &Camera) -> [DVec3; 3] {
    let view = camera.view([1, 1]);
    [view.right, view.up, view.forward]
}

impl Flight {
    /// Flies for some seconds. `clearance` is the radius of an empty ball about the eye.
    pub fn step(&self, camera: &mut Camera, thrust: &Thrust, clearance: f64, seconds: f64) {
        let old = camera.clone();
        let [right, up, forward] = axes(camera);
        let way = thrust.way.x * right + thrust.way.y * up + thrust.way.z * forward;
        let speed = self.speed * if thrust.fast { FAST } else { 1.0 };
        let constant = 0.25 * camera.eye.distance(camera.target);
        let per_second = match self.pace {
            Pace::Clearance if self.through_walls => clearance.max(IN_WALLS * constant),
            Pace::Clearance => clearance,
            Pace::Constant => constant,
        };
        let mut length = speed * per_second * seconds;
        if !self.through_walls {
            length = length.min(MOST_OF_CLEARANCE * clearance);
        }
        let step = way.clamp_length_max(1.0) * length;
        camera.eye += step;
        camera.target += step;
        if thrust.roll != 0.0 {
            let angle = (thrust.roll * ROLL * seconds).to_radians();
            camera.up = DQuat::from_axis_angle(forward, angle) * camera.up;
        }
        let far = camera.eye.abs().max(camera.target.abs()).max_element();
        // Beyond, there is nothing to be seen.
        if camera.check().is_err() || far > FARTHEST {
            *camera = old;
        }
    }
}

/// The turn by an angle to the right about `up` and one upward, in radians, of a direction. It
/// stops before `up`.
fn turn(camera: &Camera, direction: DVec3, right: f64, upward: f64) -> DQuat {
    let up = camera.up.normalize();
    let from_up = direction.angle_between(up);
    let range = [NEAREST_TO_UP, std::f64::consts::PI - NEAREST_TO_UP];
    let upward = from_up - (from_up - upward).clamp(range[0], range[1]);
    let across = direction.cross(up).normalize_or(axes(camera)[0]);
    DQuat::from_axis_angle(up, -right) * DQuat::from_axis_angle(across, upward)
}

/// Turns the camera in its place, in radians to the right and upward.
pub fn look(camera: &mut Camera, right: f64, upward: f64) {
    let way = camera.target - camera.eye;
    camera.target = camera.eye + turn(camera, way.normalize(), right, upward) * way;
}

/// Turns the camera about a point, so that the scene follows a drag to the right and upward.
pub fn orbit(camera: &mut Camera, about: DVec3, right: f64, upward: f64) {
    let way = (camera.target - camera.eye).normalize();
    let by = turn(camera, way, right, upward);
    camera.eye = about + by * (camera.eye - about);
    camera.target = about + by * (camera.target - about);
}

/// Looks at a point.
pub fn focus(camera: &mut Camera, point: DVec3) {
    let old = camera.target;
    camera.target = point;
    if camera.check().is_err() {
        camera.target = old;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(0.0, -5.0, 1.0),
            target: DVec3::new(0.0, 1.0, 1.0),
            ..Camera::default()
        }
    }

    const FORWARD: Thrust = Thrust {
        way: DVec3::Z,
        roll: 0.0,
        fast: false,
    };

    #[test]
    fn no_step_exceeds_half_the_clearance_unless_walls_are_open() {
        let mut flight = Flight {
            speed: 1e9,
            ..Flight::default()
        };
        for pace in [Pace::Clearance, Pace::Constant] {
            flight.pace = pace;
            for clearance in [0.0, 1e-9, 0.3] {
                let mut moved = camera();
                let all = Thrust {
                    way: DVec3::ONE,
                    fast: true,
                    ..FORWARD
                };
                flight.step(&mut moved, &all, clearance, 0.1);
                assert!(moved.eye.distance(camera().eye) <= 0.5 * clearance * (1.0 + 1e-9));
                assert_eq!(moved.target - moved.eye, camera().target - camera().eye);
            }
        }
        flight.through_walls = true;
        for pace in [Pace::Clearance, Pace::Constant] {
            flight.pace = pace;
            let mut moved = camera();
            flight.step(&mut moved, &FORWARD, 0.0, 0.1);
            assert!(moved.eye.y > 1e6);
            // It ends where presets end, and where eye and target would be one.
            for clearance in [1.0, 1e12, f64::MAX] {
                flight.step(&mut moved, &FORWARD, clearance, 0.1);
                let ok = moved.check().is_ok() && moved.eye.y <= FARTHEST;
                assert!(ok, "{moved:?}");
            }
        }
    }

    #[test]
    fn turns_keep_eye_distance_and_level_and_stop_before_up() {
        let mut turned = camera();
        look(&mut turned, 0.5, 0.2);
        assert_eq!(turned.eye, camera().eye);
        assert!((turned.eye.distance(turned.target) - 6.0).abs() < 1e-12);
        assert!(turned.target.x > 2.0 && turned.target.z > 2.0, "{turned:?}");
        assert_eq!(turned.up, DVec3::Z);
        for upward in [9.0, -9.0] {
            look(&mut turned, 0.0, upward);
            assert!(turned.check().is_ok());
            look(&mut turned, 0.0, upward);
            assert!(turned.check().is_ok());
        }
    }

    #[test]
    fn an_orbit_keeps_the_distance_to_its_point() {
        let (mut turned, about) = (camera(), DVec3::new(1.0, 2.0, 0.0));
        orbit(&mut turned, about, 0.7, -0.3);
        let before = camera().eye.distance(about);
        assert!((turned.eye.distance(about) - before).abs() < 1e-12);
        assert!(turned.check().is_ok() && turned.eye != camera().eye);
    }

    #[test]
    fn a_roll_turns_what_is_up() {
        let (mut rolled, roll) = (
            camera(),
            Thrust {
                roll: 1.0,
                way: DVec3::ZERO,
                fast: false,
            },
        );
        Flight::default().step(&mut rolled, &roll, 1.0, 1.5);
        // 90 degrees clockwise about the view: up is to the right of the image.
        assert!(rolled.up.distance(DVec3::X) < 1e-9, "{rolled:?}");
    }

    #[test]
    fn nobody_focuses_on_the_own_eye() {
        let mut focused = camera();
        focus(&mut focused, camera().eye);
        assert_eq!(focused, camera());
        focus(&mut focused, DVec3::X);
        assert_eq!(focused.target, DVec3::X);
    }
}
