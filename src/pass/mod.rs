//! Passes: the steps of a render. They contain all loops and know nothing of the scene.
//!
//! - [`prepare`]: makes cone maps before a heightfield's first frame
//! - [`march`]: the cones of one level; [`trace`]: one ray per pixel
//! - [`turn`]: the stages of a frame on a GPU, and which cells a dispatch visits
//! - [`color`]: light and colour, with [`look`], [`shadow`], [`occlusion`] and [`fog`]
//! - [`features`]: the parts of a look that can be absent
//! - [`progress`]: how far a render has come; `explain`: its programs, without a GPU
//!
//! Each pass declares its program ([`program`]), and [`turn::Layout`] where its results are.

pub mod color;
mod explain;
pub mod features;
pub mod fog;
pub mod look;
pub mod march;
pub mod occlusion;
pub mod prepare;
pub mod progress;
pub mod shadow;
pub mod trace;
pub mod turn;

use crate::base::shader::{Module, Program};
use crate::base::view;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::AnySolid;
use crate::wgsl;
pub use explain::explain;
pub use features::LookFeature;

/// The program of a pass over cells or pixels.
pub fn program(plan: &Plan, solid: &AnySolid, pass: Pass, extras: Extras) -> Program {
    let mut modules = solid.twin().modules();
    modules.extend([view::module(), wgsl!("pass/shared.wgsl")]);
    modules.extend(turn::modules());
    modules.push(counters(extras.count && pass.marches()));
    let entry = match pass {
        Pass::Color => {
            modules.push(look::module());
            let features = LookFeature::ALL.iter();
            modules.extend(features.map(|f| f.module(f.is_on(&plan.look))));
            modules.push(color::module(extras.normals, solid.is_colored()));
            "color"
        }
        Pass::Trace => {
            modules.push(trace::module());
            "trace"
        }
        Pass::March(_) | Pass::Prepare(_) => {
            modules.push(march::module());
            "march"
        }
    };
    Program::new(entry, modules)
}

fn counters(on: bool) -> Module {
    if on {
        wgsl!("pass/counters.wgsl")
    } else {
        wgsl!("pass/counters_off.wgsl")
    }
}
