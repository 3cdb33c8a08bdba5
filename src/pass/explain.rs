//! The text of `--explain`: what a render would run. It needs no GPU.

use std::fmt::Write as _;

use super::program;
use crate::base::shader::Program;
use crate::heightfield::tracer::settings::PrepareError;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::Assets;

/// Lists the passes, programs, modules and constants of a render.
///
/// # Errors
/// A file that the plan names cannot be read or does not fit.
pub fn explain(plan: &Plan, assets: &Assets, extras: Extras) -> Result<String, PrepareError> {
    // Heights decide about cones.
    plan.scene.outline(&plan.viewpoint(), assets)?;
    let plan = &*plan.resolved(extras, assets);
    let solid = plan.scene.outline(&plan.viewpoint(), assets)?;
    let mut text = String::new();
    let [w, h] = plan.pixels().size;
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{w} x {h}, mode {}", plan.march.mode.name());
    let _ = writeln!(text, "{}", solid.twin().describe());
    let mut programs: Vec<Program> = Vec::new();
    text.push_str("passes\n");
    let prepared = plan.scene.preparations(assets);
    let prepared = prepared.into_iter().map(Pass::Prepare);
    for pass in prepared.chain(plan.passes(extras)) {
        let limit = match pass {
            Pass::March(level) => level.steps.to_string(),
            Pass::Trace => plan.ray_steps(&solid).to_string(),
            Pass::Prepare(_) | Pass::Color => "-".into(),
        };
        let [w, h] = pass.cells(plan.pixels().size);
        let _ = writeln!(text, "  {:<12} {w:>6} x {h:<6} steps {limit}", pass.name());
        let program = program(plan, &solid, pass, extras);
        if !programs.contains(&program) {
            programs.push(program);
        }
    }
    if plan.march.may_drop_cones() && !plan.levels().is_empty() {
        text.push_str("  a discrete GPU has no march passes here (march.coarsest)\n");
    }
    text.push_str("programs\n");
    for program in &programs {
        let _ = write!(text, "  {}\n{}", program.entry, program.describe());
    }
    Ok(text)
}
