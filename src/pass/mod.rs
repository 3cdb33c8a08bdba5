//! The steps of a Plan. Every loop belongs to a pass; no pass knows what it marches.
//!
//! Each pass declares its program ([`program`]) and what it writes ([`outputs`]). An
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
    modules.push(counters(extras.count && pass.marches()));
    let entry = match pass {
        Pass::Color => {
            modules.push(look::module());
            modules.extend(
                LookFeature::ALL
                    .iter()
                    .map(|f| f.module(f.is_on(&plan.look))),
            );
            modules.push(color::module(extras.normals, solid.is_colored()));
            "color"
        }
        Pass::Trace => {
            modules.extend([queue::module(), trace::module()]);
            "trace"
        }
        Pass::March(_) | Pass::Prepare(_) => {
            modules.extend([queue::module(), march::module()]);
            "march"
        }
    };
    Program::new(entry, modules)
}

fn counters(on: bool) -> Module {
    if on {
        wgsl!("base/counters.wgsl")
    } else {
        wgsl!("base/counters_off.wgsl")
    }
}

/// What an output buffer holds before its pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Before {
    /// Anything: every element that is read is written first.
    Anything,
    /// Zeros.
    Zero,
    /// Ones in all bits: a state that no shader writes, by which cells are found that were
    /// not visited.
    Unwritten,
}

/// A buffer that a pass writes, with one element per cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// The WGSL variable.
    pub name: &'static str,
    /// Bytes of an element; 0 for a stand-in that is bound and never written.
    pub stride: u64,
    /// What it holds before.
    pub before: Before,
}

/// What a pass writes, its front or colour first. `walk` is the bytes of a ray on its way.
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
