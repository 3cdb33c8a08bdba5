//! Two frames side by side: the views of two eyes as one picture.

use crate::base::outcome::Counts;
use crate::picture::frame::{Frame, PassFigures};

/// Joins the frames of two views of the same size and the same layers, from left to right. Of their
/// cones only the work remains: the steps of a pixel contain those of the cells above it.
pub fn beside(left: Frame, right: Frame) -> Frame {
    let width = left.size[0] as usize;
    Frame {
        size: [2 * left.size[0], left.size[1]],
        origin: left.origin,
        work: rows(width, &steps(&left), &steps(&right)),
        radiance: rows(width, &left.radiance, &right.radiance),
        alpha: rows(width, &left.alpha, &right.alpha),
        variance: rows(width, &left.variance, &right.variance),
        depth: rows(width, &left.depth, &right.depth),
        state: rows(width, &left.state, &right.state),
        normal: rows(width, &left.normal, &right.normal),
        samples: rows(width, &left.samples, &right.samples),
        undecided: left.undecided + right.undecided,
        levels: Vec::new(),
        passes: passes(left.passes, right.passes),
        march_ms: left.march_ms + right.march_ms,
        traffic: left.traffic.zip(right.traffic).map(|(mut sum, right)| {
            sum.add(&right);
            sum
        }),
    }
}

/// The rows of two layers in turns. A layer that was not asked for is empty in both.
fn rows<T: Copy>(width: usize, left: &[T], right: &[T]) -> Vec<T> {
    let pairs = left.chunks(width).zip(right.chunks(width));
    pairs.flat_map(|(l, r)| [l, r].concat()).collect()
}

/// The work of each pixel with that of the cells above it.
fn steps(frame: &Frame) -> Vec<Counts> {
    let all = frame.steps();
    let of = |(work, steps): (&Counts, f32)| Counts {
        evaluations: steps as u32,
        ..*work
    };
    frame.work.iter().zip(all).map(of).collect()
}

/// The figures of both. One view may have cones where the other has none.
fn passes(mut all: Vec<PassFigures>, more: Vec<PassFigures>) -> Vec<PassFigures> {
    for (i, other) in more.into_iter().enumerate() {
        match all.iter_mut().find(|one| one.pass == other.pass) {
            Some(one) => one.add(&other),
            None => all.insert(i.min(all.len()), other),
        }
    }
    all
}
