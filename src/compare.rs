//! Two Frames to an error report (docs/method.md, 5).
//!
//! Errors are in footprints: `e = (t - t_ref) / footprint(t_ref)`, where a footprint is
//! half a pixel's width at the reference's distance.
//!
//! Fronts of cones are allowed to lie beyond the reference's hit by the hit threshold of
//! the pixel, `detail` footprints, and by no more. A hit is where the estimate falls under
//! that threshold, so the reference stops in a skin up to so thick before the surface;
//! what is proven free may reach into that skin (docs/method.md, 2). A ray that grazes the
//! surface crosses the skin aslant, over more than its thickness: it gets no more allowance,
//! so that a few such pixels may count whose proof is right. Roundings are far smaller than
//! the threshold and get none of their own.

use crate::frame::{Frame, State};
use crate::plan::Plan;
use crate::view::View;

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
    /// Per cone level: divisor, and pixels whose front lies beyond the reference's hit by
    /// more than their hit threshold.
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
pub fn compare(frame: &Frame, reference: &Frame, plan: &Plan) -> Report {
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
    report.start_violations = violations(frame, reference, view, plan.march.detail);
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

/// Per kept cone level, pixels whose cell's front lies beyond their reference hit by more
/// than the hit threshold there, `detail` footprints.
fn violations(frame: &Frame, reference: &Frame, view: &View, detail: f64) -> Vec<(u32, u64)> {
    let width = frame.size[0] as usize;
    let kept = frame.levels.iter().filter(|l| !l.front.is_empty());
    kept.map(|level| {
        let mut count = 0;
        for (i, (&t, &s)) in reference.depth.iter().zip(&reference.state).enumerate() {
            if s != State::Hit as u8 {
                continue;
            }
            let (x, y) = (i % width, i / width);
            let d = level.divisor as usize;
            let front = level.front[(y / d) * level.cells[0] as usize + x / d];
            let grain = view.view_ray([x as u32, y as u32]).grain;
            let t = f64::from(t);
            count += u64::from(f64::from(front) > t + detail * grain * t);
        }
        (level.divisor, count)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::LevelLayer;
    use crate::plan::Subject;
    use crate::scene::slab::SlabShape;

    /// A plan of so many pixels in a row.
    fn row(pixels: u32) -> Plan {
        let mut plan = Plan::new(Subject::Slab(SlabShape::default()));
        plan.size = [pixels, 1];
        plan
    }

    #[test]
    fn a_front_in_the_skin_is_no_violation_and_one_beyond_it_is() {
        let mut plan = row(8);
        let grain = |plan: &Plan, x: u32| plan.view().view_ray([x, 0]).grain;
        let reference = Frame {
            size: plan.size,
            depth: vec![5.0; 8],
            state: [1, 1, 1, 1, 1, 1, 0, 2].to_vec(),
            ..Frame::default()
        };
        for detail in [0.5, 1.0, 3.0] {
            plan.march.detail = detail;
            // In thresholds beyond the hit; the last two pixels are no hits.
            let beyond = [-9.0, 0.0, 0.9, 1.1, 1.9, 9.0, 9.0, 9.0];
            let front = (0..).zip(beyond).map(|(x, n)| {
                let threshold = detail * grain(&plan, x) * 5.0;
                (5.0 + n * threshold) as f32
            });
            let level = LevelLayer {
                divisor: 1,
                cells: [8, 1],
                front: front.collect(),
                ..LevelLayer::default()
            };
            let frame = Frame {
                levels: vec![level],
                ..reference.clone()
            };
            let report = compare(&frame, &reference, &plan);
            assert_eq!(report.start_violations, [(1, 3)], "detail {detail}");
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
        let report = compare(&frame(&two), &frame(&one), &plan);
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
