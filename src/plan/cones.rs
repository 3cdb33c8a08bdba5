//! Whether cones make a render faster (docs/method.md, 2).
//!
//! Cones save the steps that the rays of a block share. Close to the surface every pixel needs
//! its own steps, and after cones these differ more between neighbours, which wait for each other.
//! So cones over a distance estimate are faster where a ray alone needs many steps, and cones over
//! heights where they leave a ray few of its steps. A few rays tell.

use crate::base::outcome::Counts;
use crate::base::view::{Beam, View};
use crate::plan::pyramid::Level;
use crate::scene::{Advance, Solid, Step, Task};

/// Rays along each axis of the picture.
const RAYS: [u32; 2] = [16, 9];
/// Cones pay from this mean number of evaluations per ray on. Over all built-in Mandelboxes from
/// 640 x 360 to 1920 x 1080, rays alone are faster or equal up to 9, and cones from 11 on.
const EVALUATIONS: u32 = 10;
/// Cones over heights pay if they leave rays less than this share of their evaluations alone, with one
/// sample of each pixel and with several, for which the cones are marched once. Over the built-in
/// heightfields from 640 x 360 on, cones are faster up to 0.81 and rays alone from 0.845 on; with 16
/// samples cones up to 0.90, and rays alone from 0.97 on.
const SHARES: [f64; 2] = [0.84, 0.9];

/// Follows a few rays.
pub struct Probe {
    /// The view.
    pub view: View,
    /// Its width and height in pixels.
    pub size: [u32; 2],
    /// The step limit of a ray.
    pub steps: u32,
    /// Cones of these levels prepare rays over heights.
    pub levels: Option<Vec<Level>>,
    /// Whether a pixel has several samples.
    pub has_samples: bool,
}

impl Probe {
    /// A pixel in the middle of a part of the picture.
    fn pixel(&self, i: u32) -> [u32; 2] {
        let middle = |axis: usize, i: u32| {
            let at = u64::from(2 * i + 1) * u64::from(self.size[axis]);
            (at / u64::from(2 * RAYS[axis])) as u32
        };
        [middle(0, i % RAYS[0]), middle(1, i / RAYS[0])]
    }

    /// Follows a ray from a front until it ends or has `enough` evaluations.
    fn follow<S: Solid>(
        &self,
        (solid, ray): (&S, &Beam),
        front: f64,
        work: &mut Counts,
        enough: u32,
    ) {
        let mut walk = solid.begin(ray, front, solid.bounds_far(), work);
        for _ in 0..self.steps {
            if solid.walk_step(ray, &mut walk, work) != Step::Moving || work.evaluations >= enough {
                break;
            }
        }
    }

    /// The front of a pixel's finest cone.
    fn front<S: Solid>(&self, solid: &S, pixel: [u32; 2], levels: &[Level]) -> f64 {
        let mut front = 0.0;
        for level in levels {
            let cone = self
                .view
                .view_cone(pixel.map(|n| n / level.divisor), level.divisor);
            let mut at = Advance::at(front, true);
            for _ in 0..level.steps {
                at = solid.advance(&cone, at, &mut Counts::default());
                if !at.going || at.front > solid.bounds_far() {
                    break;
                }
            }
            front = at.front;
        }
        front
    }
}

impl Task for Probe {
    /// Whether cones pay.
    type Output = bool;

    fn run<S: Solid>(self, solid: &S) -> bool {
        let [mut alone, mut left] = [Counts::default(); 2];
        let enough = match self.levels {
            None => RAYS[0] * RAYS[1] * EVALUATIONS,
            Some(_) => u32::MAX,
        };
        for i in 0..RAYS[0] * RAYS[1] {
            let pixel = self.pixel(i);
            let ray = self.view.view_ray(pixel);
            self.follow((solid, &ray), 0.0, &mut alone, enough);
            if alone.evaluations >= enough {
                return true;
            }
            if let Some(levels) = &self.levels {
                let front = self.front(solid, pixel, levels);
                if front <= solid.bounds_far() {
                    self.follow((solid, &ray), front, &mut left, enough);
                }
            }
        }
        let share = SHARES[usize::from(self.has_samples)];
        self.levels.is_some() && f64::from(left.evaluations) < share * f64::from(alone.evaluations)
    }
}
