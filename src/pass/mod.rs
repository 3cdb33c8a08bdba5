//! Passes: the steps of a render. They contain all loops and know nothing of the scene.
//!
//! - [`prepare`]: makes cone maps before a heightfield's first frame
//! - [`march`]: the cones of one level; [`trace`]: one ray per pixel
//! - [`queue`]: which cells a dispatch on a GPU visits
//! - [`color`]: light and colour, with [`look`], [`shadow`], [`occlusion`] and [`fog`]
//! - [`features`]: the parts of a look that can be absent
//! - [`progress`]: how far a render has come; `explain`: its programs, without a GPU
//!
//! Each pass declares its program ([`program`]) and what it writes ([`outputs`]). The GPU
//! executor allocates, binds and reads back what is declared.

pub mod color;
mod explain;
pub mod features;
pub mod fog;
pub mod look;
pub mod march;
pub mod occlusion;
pub mod prepare;
pub mod progress;
pub mod queue;
pub mod shadow;
pub mod trace;

use crate::base::shader::Program;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::AnySolid;
use crate::wgsl;
pub use explain::explain;
pub use features::LookFeature;

/// The program of a pass over cells or pixels.
pub fn program(plan: &Plan, solid: &AnySolid, pass: Pass, extras: Extras) -> Program {
    let mut modules = solid.twin().modules();
    modules.extend([wgsl!("base/view.wgsl"), wgsl!("pass/shared.wgsl")]);
    modules.push(match extras.count && pass.marches() {
        true => wgsl!("base/counters.wgsl"),
        false => wgsl!("base/counters_off.wgsl"),
    });
    let entry = match pass {
        Pass::Color => {
            modules.push(wgsl!("pass/look.wgsl"));
            let features = LookFeature::ALL.iter();
            modules.extend(features.map(|f| f.module(f.is_on(&plan.look))));
            modules.push(wgsl!(
                "pass/color.wgsl",
                "COLOR_KEEPS_NORMALS" = f64::from(u8::from(extras.normals)),
                "COLOR_IS_PIGMENT" = f64::from(u8::from(solid.is_colored()))
            ));
            "color"
        }
        Pass::Trace => {
            modules.extend([wgsl!("pass/queue.wgsl"), wgsl!("pass/trace.wgsl")]);
            "trace"
        }
        Pass::March(_) | Pass::Prepare(_) => {
            modules.extend([wgsl!("pass/queue.wgsl"), wgsl!("pass/march.wgsl")]);
            "march"
        }
    };
    Program::new(entry, modules)
}

/// What an output buffer holds before its pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Before {
    /// Any values: every element is written before it is read.
    Anything,
    /// Zeros.
    Zero,
    /// Ones in all bits: a state that no shader writes. It marks cells that were not visited.
    Unwritten,
}

/// A buffer that a pass writes, with one element per cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// The WGSL variable.
    pub name: &'static str,
    /// Bytes of an element; 0 for a buffer that is bound but never written.
    pub stride: u64,
    /// What it holds before the pass.
    pub before: Before,
}

/// What a pass writes. The front or the colour is first. `marked` is whether hits carry an id
/// and a place, and `walk` is the size of a ray's state in bytes.
pub fn outputs(pass: Pass, extras: Extras, marked: bool, walk: u64) -> Vec<Output> {
    let plain = |name, stride| Output {
        name,
        stride,
        before: Before::Anything,
    };
    let state = Output {
        before: Before::Unwritten,
        ..plain("state", 4)
    };
    let mut all = match pass {
        Pass::Color => vec![
            plain("radiance", 16),
            plain("normals", if extras.normals { 16 } else { 0 }),
        ],
        Pass::Trace => vec![
            plain("depth", 4),
            state,
            plain("walks", walk),
            plain("marks", if marked { 12 } else { 0 }),
        ],
        Pass::March(_) | Pass::Prepare(_) => vec![plain("front", 4), state],
    };
    if extras.count && pass.marches() {
        all.push(Output {
            before: Before::Zero,
            ..plain("tally", 8)
        });
    }
    all
}
