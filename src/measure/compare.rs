//! Two Frames to an error report (docs/method.md, 5).
//!
//! Errors are in footprints: `e = (t - t_ref) / footprint(t_ref)`, where a footprint is
//! half a pixel's width at the reference's distance.
//!
//! A hit is where the estimate falls under the hit threshold, so the reference stops in a
//! skin before the surface, and what is proven free may reach into that skin, up to the
//! share of it that cones keep clear of (docs/method.md, 2); a ray that grazes the surface
//! stays in the skin for long. Where a front lies beyond the reference's hit by more than
//! the threshold, the ray is therefore followed on from that hit: the front is a violation if
//! the ray comes as near to the surface as cones must not, before it is there. (Less is left to
//! fronts that start where rays enter the bounds, which may lie in the skin.)

use rayon::prelude::*;

use crate::base::view::{Beam, View, footprint};
use crate::base::work::State;
use crate::picture::frame::Frame;
use crate::plan::Plan;
use crate::scene::AnySolid;
use crate::scene::{Solid, Task};

/// How far one frame's depth is from another's. Shares are of all pixels.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// |e| over pixels that both hit: median, 95 %, 99 %, largest.
    pub depth_error: [f64; 4],
    /// Share with e > 2.
    pub behind: f64,
    /// Share with e < -2.
    pub front: f64,
    /// Share with e > 8.
    pub behind8: f64,
    /// Share with e < -8.
    pub front8: f64,
    /// Share of hits of the reference that are shown as sky.
    pub holes: f64,
    /// Share of sky of the reference that is shown as a hit.
    pub false_hits: f64,
    /// Share that reached a limit.
    pub unconverged: f64,
    /// Share whose state, hit or not, differs.
    pub mask: f64,
    /// Per cone level: divisor, and pixels whose ray comes to the surface before the front
    /// that was proven free.
    pub start_violations: Vec<(u32, u64)>,
}

/// Signed depth error of each pixel in footprints: infinite where a hit is shown as sky,
/// minus infinite where sky is shown as a hit, 0 where both are sky, none where the frame
/// or the reference reached a limit.
pub fn errors(frame: &Frame, reference: &Frame, view: &View) -> Vec<f64> {
    let width = frame.size[0] as usize;
    let (sky, hit) = (State::Sky as u8, State::Hit as u8);
    let states = frame.state.iter().zip(&reference.state).enumerate();
    let error = |(i, (&s, &r)): (usize, (&u8, &u8))| match (s, r) {
        _ if s == sky && r == sky => 0.0,
        _ if s == sky && r == hit => f64::INFINITY,
        _ if s == hit && r == sky => f64::NEG_INFINITY,
        _ if s == hit && r == hit => {
            let t = f64::from(reference.depth[i]);
            let ray = view.view_ray([(i % width) as u32, (i / width) as u32]);
            (f64::from(frame.depth[i]) - t) / (ray.grain * t).max(f64::MIN_POSITIVE)
        }
        _ => f64::NAN,
    };
    states.map(error).collect()
}

/// Compares a frame with a reference of the same plan, its modes and steps apart.
/// `solid` is the plan's scene.
pub fn compare(frame: &Frame, reference: &Frame, plan: &Plan, solid: &AnySolid) -> Report {
    let view = &plan.view();
    let hit = State::Hit as u8;
    let sky = State::Sky as u8;
    let mut report = Report::default();
    let mut depths = Vec::new();
    for (i, e) in errors(frame, reference, view).into_iter().enumerate() {
        let (s, r) = (frame.state[i], reference.state[i]);
        report.unconverged += f64::from(u8::from(s == State::Unconverged as u8));
        report.holes += f64::from(u8::from(r == hit && s == sky));
        report.false_hits += f64::from(u8::from(r == sky && s == hit));
        report.mask += f64::from(u8::from((r == hit) != (s == hit)));
        if s != hit || r != hit {
            continue;
        }
        report.behind += f64::from(u8::from(e > 2.0));
        report.front += f64::from(u8::from(e < -2.0));
        report.behind8 += f64::from(u8::from(e > 8.0));
        report.front8 += f64::from(u8::from(e < -8.0));
        depths.push(e.abs());
    }
    let n = frame.state.len().max(1) as f64;
    for share in [
        &mut report.behind,
        &mut report.front,
        &mut report.behind8,
        &mut report.front8,
        &mut report.holes,
        &mut report.false_hits,
        &mut report.unconverged,
        &mut report.mask,
    ] {
        *share /= n;
    }
    depths.sort_by(f64::total_cmp);
    report.depth_error = [0.5, 0.95, 0.99, 1.0].map(|q| quantile(&depths, q));
    report.start_violations = solid.run(Violations {
        frame,
        reference,
        plan,
    });
    report
}

/// The q-quantile of sorted values; 0 of none.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted
        .get((q * last).round() as usize)
        .copied()
        .unwrap_or(0.0)
}

/// Share of the skin that cones keep clear of, of which fronts may use so much: f32 decides
/// a little otherwise than f64.
const CLEAR: f64 = 0.9;
/// The least share that is looked for, where cones keep clear of none.
const LEAST_CLEAR: f64 = 1e-3;
/// Share of the clearance that the ray is followed on by, small enough to miss no thin part
/// that the reference would hit.
const FOLLOW: f64 = 0.1;
/// Share of the hit threshold that it is followed on by at least: a ray that creeps along
/// the surface within that is decided soon.
const LEAST_FOLLOW: f64 = 0.01;
/// Steps after which a ray is no longer followed, and counts.
const MOST_FOLLOWED: u32 = 4_000;

/// Per kept cone level, pixels whose cell's front lies beyond a place where their ray comes
/// to the surface.
struct Violations<'a> {
    frame: &'a Frame,
    reference: &'a Frame,
    plan: &'a Plan,
}

impl Task for Violations<'_> {
    type Output = Vec<(u32, u64)>;

    fn run<S: Solid>(self, solid: &S) -> Self::Output {
        let (plan, reference) = (self.plan, self.reference);
        let view = plan.view();
        let width = self.frame.size[0] as usize;
        let least = (CLEAR * plan.march.shell).max(LEAST_CLEAR) / plan.scene.lipschitz();
        // Where each ray comes to the surface, as far as a front could ask.
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
            (level.divisor, all.filter(wrong).count() as u64)
        });
        levels.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::frame::LevelLayer;
    use crate::scene::Assets;
    use crate::scene::slab::SlabSettings;
    use glam::DVec3;

    fn solid(plan: &Plan) -> AnySolid {
        plan.solid(&Assets::default()).expect("it names no file")
    }

    fn rendered(plan: &Plan) -> Frame {
        let assets = Assets::default();
        crate::cpu::render(plan, &assets, Default::default(), &mut |_| true).expect("rendered")
    }

    /// A plan of so many pixels in a row.
    fn row(pixels: u32) -> Plan {
        let mut plan = Plan::new(SlabSettings::default());
        plan.size = [pixels, 1];
        plan
    }

    /// A frame of one level of single pixels, whose fronts lie so far along their rays.
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

    /// The unit ball at the origin, among others, seen from six lengths away.
    fn ball(size: [u32; 2]) -> Plan {
        use crate::formula::{Formula, balls::Balls};
        let mut plan = Plan::new(Formula::Balls(Balls::default()));
        plan.camera.eye = DVec3::new(0.0, -6.0, 0.3);
        plan.camera.target = DVec3::ZERO;
        plan.size = size;
        plan
    }

    /// Steep rays cross the skin at once: a front in the part of it that cones need not
    /// keep clear of is right, one beyond is not.
    #[test]
    fn a_front_in_the_skin_is_no_violation_and_one_beyond_it_is() {
        let mut plan = ball([8, 1]);
        plan.camera.fov = 1.0;
        for (detail, shell) in [(1.0, 0.45), (3.0, 0.45), (1.0, 0.0), (0.5, 0.9)] {
            plan.march.detail = detail;
            plan.march.shell = shell;
            let mut reference = rendered(&plan);
            // The last two pixels are no hits.
            reference.state[6] = State::Sky as u8;
            reference.state[7] = State::Unconverged as u8;
            // In thresholds beyond where each ray is as near as cones may come.
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
            assert_eq!(report.start_violations, [(1, 3)], "{detail} {shell}");
        }
    }

    /// A ray that grazes a ball stays in the skin for far longer than that is thick, and
    /// passes: a front that lies behind all of it is right.
    #[test]
    fn a_front_beyond_a_grazed_skin_is_right() {
        let plan = ball([240, 160]);
        // Past the ball by a share of the threshold, or through its rim.
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
        for (share, wrong) in [(0.75, 0), (-2.0, 1)] {
            let p = past(share).expect("a picture has pixels");
            let i = p[1] as usize * width + p[0] as usize;
            assert_eq!(reference.state[i], State::Hit as u8, "{p:?}");
            // Half a length on: far behind the skin.
            let mut front = vec![0.0; reference.depth.len()];
            front[i] = reference.depth[i] + 0.5;
            let report = compare(
                &with_fronts(&reference, front),
                &reference,
                &plan,
                &solid(&plan),
            );
            assert_eq!(report.start_violations, [(1, wrong)], "{share}");
        }
    }

    #[test]
    fn errors_are_counted_on_their_side_of_the_thresholds() {
        let plan = row(11);
        let view = plan.view();
        let grain = |x: u32| view.view_ray([x, 0]).grain;
        let frame = |pixels: &[(State, f64)]| Frame {
            size: [11, 1],
            depth: pixels.iter().map(|p| p.1 as f32).collect(),
            state: pixels.iter().map(|p| p.0 as u8).collect(),
            ..Frame::default()
        };
        let offsets = [0.0, 1.9, 2.1, 8.1, -1.9, -2.1, -8.1];
        let mut one = Vec::new();
        let mut two = Vec::new();
        for (x, e) in (0..).zip(offsets) {
            one.push((State::Hit, 5.0));
            two.push((State::Hit, 5.0 * (1.0 + e * grain(x))));
        }
        one.extend([State::Hit, State::Sky, State::Sky, State::Hit].map(|s| (s, 5.0)));
        two.extend([State::Sky, State::Hit, State::Sky, State::Unconverged].map(|s| (s, 5.0)));
        let report = compare(&frame(&two), &frame(&one), &plan, &solid(&plan));
        let pixels = |share: f64| (share * 11.0).round() as u32;
        assert_eq!(pixels(report.behind), 2);
        assert_eq!(pixels(report.behind8), 1);
        assert_eq!(pixels(report.front), 2);
        assert_eq!(pixels(report.front8), 1);
        assert_eq!(pixels(report.holes), 1);
        assert_eq!(pixels(report.false_hits), 1);
        assert_eq!(pixels(report.unconverged), 1);
        assert_eq!(pixels(report.mask), 3);
        assert!(
            (report.depth_error[0] - 2.1).abs() < 0.01,
            "{:?}",
            report.depth_error
        );
        assert!(
            (report.depth_error[3] - 8.1).abs() < 0.01,
            "{:?}",
            report.depth_error
        );
    }
}
