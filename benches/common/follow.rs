//! A ray that is followed through a solid.

use conemarch::base::outcome::Counts;
use conemarch::base::view::Beam;
use conemarch::scene::{Solid, Step};

/// Steps of a ray, and of a cone.
pub const STEPS: u32 = 512;

/// Whether a ray is free from the first distance to the second, and its work.
pub fn follow<S: Solid>(solid: &S, ray: &Beam, [from, far]: [f64; 2]) -> (bool, Counts) {
    let mut work = Counts::default();
    let mut walk = solid.begin(ray, from, far, &mut work);
    let mut step = Step::Moving;
    for _ in 0..STEPS {
        step = solid.walk_step(ray, &mut walk, &mut work);
        if step != Step::Moving {
            break;
        }
    }
    (step == Step::Out, work)
}
