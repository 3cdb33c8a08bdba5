//! Passes: the steps of a render. They contain all loops and know nothing of the scene.
//!
//! - [`prepare`]: makes cone maps before a heightfield's first frame
//! - [`march`]: the cones of one level; [`trace`]: one ray per pixel; [`follow`]: rays to their ends
//! - [`turn`]: the stages of a frame on a GPU, and which cells a dispatch visits; [`layout`]: where
//!   their results are
//! - [`color`]: light and colour, with [`look`], [`layers`] and [`fog`], which may thin out with the height
//!   ([`fog_height`]), and [`glow`]: by formulas, [`quick`] with [`shadow`] and [`occlusion`], or by paths,
//!   [`path`]; [`material`], [`shafts`], [`lamp`], [`aim`], [`sky`] and [`emission`] for both
//! - [`pick`]: what there is at a pixel or at a point
//! - [`tone_map`], [`tone`]: from light to display values, and from these to the bytes of a picture
//! - [`until`]: which tiles have enough samples; [`variance`]: how much the samples of a pixel differ
//! - [`features`]: the parts of a look that can be absent
//! - [`progress`]: how far a render has come; `explain`: its programs, without a GPU
//!
//! Each pass declares its program in its own file, and its bindings in WGSL, where kernels read them.
//! [`layout`] says which cells a stage visits, and where its results are.

pub mod aim;
pub mod color;
pub mod emission;
mod explain;
pub mod features;
pub mod fog;
pub mod fog_height;
pub mod follow;
pub mod glow;
pub mod lamp;
pub mod layers;
pub mod layout;
pub mod look;
pub mod march;
pub mod material;
pub mod occlusion;
pub mod path;
pub mod pick;
pub mod prepare;
pub mod progress;
pub mod quick;
pub mod shadow;
pub mod shafts;
pub mod sky;
pub mod tone;
pub mod tone_map;
pub mod trace;
pub mod turn;
pub mod until;
pub mod variance;

use crate::base::outcome;
use crate::base::shader::Program;
use crate::heightfield::conemap::generate::task::program_of;
use crate::plan::{Extras, Pass, Plan};
use crate::scene::AnySolid;
use crate::wgsl;
pub use explain::explain;
pub use features::LookFeature;

/// The program of a pass.
pub fn program(plan: &Plan, solid: &AnySolid, pass: Pass, extras: Extras) -> Program {
    let (entry, own) = match pass {
        Pass::Prepare(map) => return program_of(map.generator),
        Pass::March(_) => march::program(),
        Pass::Trace => trace::program(plan),
        Pass::Color => color::program(plan, solid, extras),
    };
    let mut modules = solid.twin().modules();
    modules.extend(plan.view().modules());
    modules.extend(outcome::modules(extras.count && pass.marches()));
    modules.extend([wgsl!("scene/contract.wgsl"), wgsl!("pass/shared.wgsl")]);
    modules.extend(turn::modules());
    modules.extend(own);
    Program::new(entry, modules)
}
