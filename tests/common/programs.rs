//! Programs that only tests make.

use conemarch::base::shader::{Module, Program};
use conemarch::heightfield::conemap::generate::{Generator, min3x3, pyramid, task};
use conemarch::wgsl;

/// Every program that a device makes cone maps with.
pub fn map_programs() -> Vec<Program> {
    let shared = [pyramid::program(), min3x3::program()];
    let generators = Generator::ALL.into_iter().map(task::program_of);
    shared.into_iter().chain(generators).collect()
}

/// The same program with f64 in the place of f32 wherever it uses `wgsl/base/real.wgsl`.
pub fn in_f64(program: &Program) -> Program {
    let wide = |module: &Module| match module.path {
        "wgsl/base/real.wgsl" => wgsl!("base/real64.wgsl"),
        _ => module.clone(),
    };
    Program::new(program.entry, program.modules.iter().map(wide).collect())
}
