//! Compares a frame with a reference (docs/method.md, 5).
//!
//! Errors are in footprints: `e = (t - t_ref) / footprint(t_ref)`, where a footprint is half
//! a pixel's width at the reference's distance.
//!
//! A *start violation* is a pixel whose cell has a front beyond the first place where the
//! pixel's ray reaches the surface. The reference's hit is not that place. It lies in a skin
//! before the surface, where the estimate is below the hit threshold, and cones keep clear of
//! a share of that skin only. A ray that grazes the surface stays in the skin for long. So
//! where a front is beyond the reference's hit by more than the threshold, the ray is followed
//! from that hit. The front is a violation if the ray comes nearer to the surface than cones
//! may come, before it reaches the front.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::base::outcome::State;
use crate::base::view::{Beam, footprint};
use crate::picture::frame::{Frame, errors};
use crate::plan::Plan;
use crate::scene::AnySolid;
use crate::scene::{Solid, Task};

/// Quantiles of |e| in footprints, over pixels that hit in both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DepthError {
    /// 50 % of the pixels are closer.
    pub median: f64,
    /// 95 % are.
    pub p95: f64,
    /// 99 % are.
    pub p99: f64,
    /// All are.
    pub max: f64,
}

/// The errors of a frame. Shares are of all pixels, 0..1.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Report {
    /// Quantiles of the depth error.
    pub depth_error: DepthError,
    /// Share of hits in both frames with e > 2.
    pub behind: f64,
    /// Share of hits in both frames with e < -2.
    pub front: f64,
    /// Share of hits in both frames with e > 8.
    pub behind8: f64,
    /// Share of hits in both frames with e < -8.
    pub front8: f64,
    /// Share of hits in the reference that are sky in the frame.
    pub holes: f64,
    /// Share of sky in the reference that is a hit in the frame.
    pub false_hits: f64,
    /// The pixels of each cone level, coarse to fine, that are start violations.
    pub start_violations: Vec<u64>,
    /// Share that reached a limit.
    pub unconverged: f64,
    /// Share that is a hit in one frame only.
    #[serde(skip)]
    pub mask: f64,
}

impl Report {
    /// Share of pixels that are wrong: too deep, lost, or not finished.
    pub fn wrong(&self) -> f64 {
        self.behind + self.holes + self.unconverged
    }
}

/// Compares a frame with a reference of the same plan; mode and steps may differ. `solid` is
/// the plan's scene.
pub fn compare(frame: &Frame, reference: &Frame, plan: &Plan, solid: &AnySolid) -> Report {
    let errors = errors(frame, reference, &plan.view());
    let hit = |frame: &Frame, i: usize| frame.state[i] == State::Hit as u8;
    let sky = |frame: &Frame, i: usize| frame.state[i] == State::Sky as u8;
    let both = |i: usize| hit(frame, i) && hit(reference, i);
    let share = |counts: &dyn Fn(usize) -> bool| {
        let count = (0..errors.len()).filter(|i| counts(*i)).count();
        count as f64 / errors.len().max(1) as f64
    };
    let hits = (0..errors.len()).filter(|i| both(*i));
    let mut depths: Vec<f64> = hits.map(|i| errors[i].abs()).collect();
    depths.sort_by(f64::total_cmp);
    Report {
        depth_error: DepthError {
            median: quantile(&depths, 0.5),
            p95: quantile(&depths, 0.95),
            p99: quantile(&depths, 0.99),
            max: quantile(&depths, 1.0),
        },
        behind: share(&|i| both(i) && errors[i] > 2.0),
        front: share(&|i| both(i) && errors[i] < -2.0),
        behind8: share(&|i| both(i) && errors[i] > 8.0),
        front8: share(&|i| both(i) && errors[i] < -8.0),
        holes: share(&|i| hit(reference, i) && sky(frame, i)),
        false_hits: share(&|i| sky(reference, i) && hit(frame, i)),
        start_violations: solid.run(Violations {
            frame,
            reference,
            plan,
        }),
        unconverged: share(&|i| frame.state[i] == State::Unconverged as u8),
        mask: share(&|i| hit(frame, i) != hit(reference, i)),
    }
}

/// The q-quantile of sorted values; 0 if there are none.
pub fn quantile<T: Copy + Default>(sorted: &[T], q: f64) -> T {
    let last = sorted.len().saturating_sub(1) as f64;
    let found = sorted.get((q * last).round() as usize);
    found.copied().unwrap_or_default()
}

/// Factor on the share of the skin that cones keep clear of. The rest is left to the rounding
/// of f32.
const CLEAR: f64 = 0.9;
/// The smallest share that counts, for plans whose cones keep clear of none.
const LEAST_CLEAR: f64 = 1e-3;
/// A followed ray steps by this share of the clearance, too little to miss a thin part that
/// the reference would hit.
const FOLLOW: f64 = 0.1;
/// A followed ray steps by at least this share of the hit threshold, so that it does not creep
/// along the surface.
const LEAST_FOLLOW: f64 = 0.01;
/// A ray that is followed for more steps counts as a violation.
const MOST_FOLLOWED: u32 = 4_000;

/// Counts the start violations of each kept cone level.
struct Violations<'a> {
    frame: &'a Frame,
    reference: &'a Frame,
    plan: &'a Plan,
}

impl Task for Violations<'_> {
    type Output = Vec<u64>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let (plan, reference) = (self.plan, self.reference);
        let view = plan.view();
        let width = self.frame.size[0] as usize;
        // The shell of the mode: some march without one, whatever the preset says.
        let shell = plan.march.stepping().shell;
        let least = (CLEAR * shell).max(LEAST_CLEAR) / plan.scene.lipschitz();
        // Whether a ray reaches the surface between the hit and the front.
        let met = |ray: &Beam, hit: f64, front: f64| {
            let mut t = hit;
            for _ in 0..MOST_FOLLOWED {
                let threshold = plan.march.detail * footprint(ray, t);
                let clear = solid.clearance(ray.at(t));
                if t >= front {
                    return false;
                }
                if clear <= least * threshold {
                    return true;
                }
                t += (FOLLOW * clear).max(LEAST_FOLLOW * threshold);
            }
            true
        };
        let kept = self.frame.levels.iter().filter(|l| !l.front.is_empty());
        let levels = kept.map(|level| {
            let wrong = |i: &usize| {
                if reference.state[*i] != State::Hit as u8 {
                    return false;
                }
                let (x, y) = (i % width, i / width);
                let d = level.divisor as usize;
                let front = level.front[(y / d) * level.cells[0] as usize + x / d];
                let (front, hit) = (f64::from(front), f64::from(reference.depth[*i]));
                let ray = view.view_ray([x as u32, y as u32]);
                front > hit + plan.march.detail * footprint(&ray, hit) && met(&ray, hit, front)
            };
            let all = (0..reference.depth.len()).into_par_iter();
            all.filter(wrong).count() as u64
        });
        levels.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::frame::LevelLayer;
    use crate::plan::march::Mode;
    use crate::scene::Assets;
    use crate::scene::slab::SlabSettings;
    use glam::DVec3;

    fn solid(plan: &Plan) -> AnySolid {
        plan.scene
            .solid(&plan.viewpoint(), &Assets::default())
            .expect("it names no file")
    }

    fn rendered(plan: &Plan) -> Frame {
        let assets = Assets::default();
        crate::cpu::render(plan, &assets, Default::default(), &mut |_| true).expect("rendered")
    }

    /// A frame with one level of single pixels and given fronts.
    fn with_fronts(reference: &Frame, front: Vec<f32>) -> Frame {
        let level = LevelLayer {
            divisor: 1,
            cells: reference.size,
            front,
            ..LevelLayer::default()
        };
        Frame {
            levels: vec![level],
            ..reference.clone()
        }
    }

    /// Several solids, with a unit ball at the origin, seen from a distance of 6.
    fn ball(size: [u32; 2]) -> Plan {
        use crate::formula::{Formula, balls::Balls};
        let mut plan = Plan::new(Formula::Balls(Balls::default()));
        plan.reference = None;
        plan.camera.eye = DVec3::new(0.0, -6.0, 0.3);
        plan.camera.target = DVec3::ZERO;
        plan.size = size;
        plan
    }

    /// Steep rays cross the skin at once. A front may lie in the outer part of the skin, but not
    /// beyond it.
    #[test]
    fn a_front_in_the_skin_is_no_violation_and_one_beyond_it_is() {
        let mut plan = ball([8, 1]);
        plan.camera.fov = 1.0;
        for (mode, detail, shell) in [
            (Mode::Safe, 1.0, 0.45),
            (Mode::Safe, 3.0, 0.45),
            (Mode::Safe, 1.0, 0.0),
            (Mode::Safe, 0.5, 0.9),
            // The cones of the slides keep clear of nothing, whatever the preset says.
            (Mode::SlidesDeep, 1.0, 0.45),
        ] {
            plan.march.mode = mode;
            plan.march.detail = detail;
            plan.march.shell = Some(shell);
            let shell = if mode == Mode::Safe { shell } else { 0.0 };
            let mut reference = rendered(&plan);
            // The last two pixels are no hits.
            reference.state[6] = State::Sky as u8;
            reference.state[7] = State::Unconverged as u8;
            // In thresholds beyond the nearest place that a front may reach.
            let beyond = [-9.0, -0.6, -0.02, 2.0, 3.0, 9.0, 9.0, 9.0];
            let front = (0..).zip(beyond).map(|(x, n)| {
                let ray = plan.view().view_ray([x, 0]);
                let near = -plan.camera.eye.dot(ray.axis);
                let off = plan.camera.eye.length_squared() - near * near;
                let top = near - (1.0 - off).sqrt();
                let threshold = detail * footprint(&ray, top);
                (top + (n - shell) * threshold) as f32
            });
            let frame = with_fronts(&reference, front.collect());
            let report = compare(&frame, &reference, &plan, &solid(&plan));
            assert_eq!(report.start_violations, [3], "{mode:?} {detail} {shell}");
        }
    }

    /// A ray that grazes a ball stays in the skin for long and passes it, so a front behind the
    /// skin is right if the ray keeps clear of the shell. The slides' modes have no shell.
    #[test]
    fn a_front_beyond_a_grazed_skin_is_right() {
        let mut plan = ball([240, 160]);
        plan.march.shell = Some(0.45);
        // The pixel whose ray passes the ball at a distance of so many thresholds.
        let view = plan.view();
        let past = |share: f64| {
            let pixels = (0..plan.size[1]).flat_map(|y| (0..plan.size[0]).map(move |x| [x, y]));
            let miss = |p: [u32; 2]| {
                let ray = view.view_ray(p);
                let near = -plan.camera.eye.dot(ray.axis);
                let at = plan.camera.eye + near * ray.axis;
                (at.length() - 1.0) / (plan.march.detail * footprint(&ray, near)) - share
            };
            pixels.min_by(|a, b| miss(*a).abs().total_cmp(&miss(*b).abs()))
        };
        let reference = rendered(&plan);
        let width = plan.size[0] as usize;
        let cases = [
            (0.75, Mode::Safe, 0),
            (0.3, Mode::Safe, 1),
            (0.3, Mode::SlidesEven, 0),
            (-2.0, Mode::SlidesEven, 1),
            (-2.0, Mode::Safe, 1),
        ];
        for (share, mode, wrong) in cases {
            let p = past(share).expect("a picture has pixels");
            let i = p[1] as usize * width + p[0] as usize;
            assert_eq!(reference.state[i], State::Hit as u8, "{p:?}");
            // Far behind the skin.
            let mut front = vec![0.0; reference.depth.len()];
            front[i] = reference.depth[i] + 0.5;
            let mut compared = plan.clone();
            compared.march.mode = mode;
            let frame = with_fronts(&reference, front);
            let report = compare(&frame, &reference, &compared, &solid(&compared));
            assert_eq!(report.start_violations, [wrong], "{share} {mode:?}");
        }
    }

    #[test]
    fn errors_are_counted_on_their_side_of_the_thresholds() {
        let mut plan = Plan::new(SlabSettings::default());
        (plan.size, plan.reference) = ([11, 1], None);
        let view = plan.view();
        let grain = |x: u32| view.view_ray([x, 0]).grain;
        let frame = |pixels: &[(State, f64)]| Frame {
            size: [11, 1],
            depth: pixels.iter().map(|p| p.1 as f32).collect(),
            state: pixels.iter().map(|p| p.0 as u8).collect(),
            ..Frame::default()
        };
        let offsets = [0.0, 1.9, 2.1, 8.1, -1.9, -2.1, -8.1];
        let mut one = vec![(State::Hit, 5.0); offsets.len()];
        let moved = (0..).zip(offsets).map(|(x, e)| 5.0 * (1.0 + e * grain(x)));
        let mut two: Vec<_> = moved.map(|t| (State::Hit, t)).collect();
        one.extend([State::Hit, State::Sky, State::Sky, State::Hit].map(|s| (s, 5.0)));
        two.extend([State::Sky, State::Hit, State::Sky, State::Unconverged].map(|s| (s, 5.0)));
        let report = compare(&frame(&two), &frame(&one), &plan, &solid(&plan));
        let pixels = |share: f64| (share * 11.0).round() as u32;
        assert_eq!([report.behind, report.behind8].map(pixels), [2, 1]);
        assert_eq!([report.front, report.front8].map(pixels), [2, 1]);
        assert_eq!([report.holes, report.false_hits].map(pixels), [1, 1]);
        assert_eq!([report.unconverged, report.mask].map(pixels), [1, 3]);
        let DepthError { median, max, .. } = report.depth_error;
        assert!((median - 2.1).abs() < 0.01, "{median}");
        assert!((max - 8.1).abs() < 0.01, "{max}");
    }
}
