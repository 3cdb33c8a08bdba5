//! Pictures of two estimates at equal real sharpness (docs/method.md, 5).

use anyhow::Result;
use conemarch::measure::sharpness::{SetSample, sharpness};
use conemarch::picture::frame::Frame;
use conemarch::plan::Plan;

/// Rounds of halving in the search of a `detail`, from the share LEAST of the plan's own to all of it.
const ROUNDS: u32 = 7;
const LEAST: f64 = 0.2;

/// The `detail` of a plan with which half of the pixels are as far before the set as said.
pub fn as_sharp(
    plan: &Plan,
    set: &SetSample,
    median: f64,
    mut render: impl FnMut(&Plan) -> Result<Frame>,
) -> Result<f64> {
    let own = plan.march.detail;
    let (mut low, mut high) = (LEAST * own, own);
    let mut plan = plan.clone();
    for _ in 0..ROUNDS {
        plan.march.detail = (low * high).sqrt();
        let frame = render(&plan)?;
        match sharpness(&frame, set, &plan).before_set.median > median {
            true => high = plan.march.detail,
            false => low = plan.march.detail,
        }
    }
    Ok((low * high).sqrt())
}
