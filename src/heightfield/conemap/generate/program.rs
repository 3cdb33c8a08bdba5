//! The program of each generator: which modules are joined, with which constants.

use crate::base::shader::{Module, Program};
use crate::heightfield::conemap::generate::generator::{Generator, Options};
use crate::heightfield::conemap::generate::grid_distance::Aim;
use crate::heightfield::conemap::generate::quick::Rule;
use crate::heightfield::conemap::generate::relaxed::START;
use crate::heightfield::conemap::generate::task::MapTask;
use crate::heightfield::heights::{Heights, Patches};
use crate::wgsl;

/// Costs that are closer than this, relative to them, may compare wrongly in f32. WGSL
/// allows 4.5 units in the last place for a root and 2.5 for a division; with one half
/// for each of the other operations two costs are apart by 2^-19 at the worst.
const MARGIN: f64 = 1.0 / 262_144.0;

/// The least rise that is looked at: a place of the least distance that counts, a
/// thousandth of a texel, with this rise costs far more than the widest cone. Its
/// square, 2^-80, is no denormal, which devices may take for 0.
const LEAST_RISE: f64 = 1.0 / (1_u64 << 40) as f64;

/// What the kernels' cost is: the module and its constants.
fn cost(prepared: &MapTask<'_>, units: f64) -> Module {
    let walk = f64::from(u8::from(prepared.generator.over_cells()));
    wgsl!(
        "heightfield/conemap/generate/cost.wgsl",
        "COST_WALK" = walk,
        "COST_UNITS" = units,
        "COST_WIDEST" = prepared.cost().widest(),
        "COST_MARGIN" = MARGIN,
        "COST_LEAST_RISE" = LEAST_RISE,
    )
}

/// The program of a generator made ready.
pub fn program(prepared: &MapTask<'_>) -> Program {
    let mut modules = vec![wgsl!("heightfield/conemap/generate/shared.wgsl")];
    let offer = wgsl!("heightfield/conemap/generate/offer.wgsl");
    match prepared.generator {
        Generator::Brute => {
            let scan = wgsl!("heightfield/conemap/generate/scan.wgsl");
            let brute = wgsl!("heightfield/conemap/generate/brute.wgsl");
            modules.extend([cost(prepared, 1.0), offer, scan, brute]);
        }
        Generator::RelaxedSearch => {
            let scan = wgsl!("heightfield/conemap/generate/scan.wgsl");
            let relaxed = wgsl!(
                "heightfield/conemap/generate/relaxed.wgsl",
                "RELAXED_START" = START
            );
            modules.extend([cost(prepared, 1.0), scan, relaxed]);
        }
        Generator::Naive | Generator::Improved | Generator::Center => {
            let rule = match prepared.rule() {
                Rule::Naive => 0.0,
                Rule::Improved => 1.0,
                Rule::Center => 2.0,
            };
            let quick = wgsl!(
                "heightfield/conemap/generate/quick.wgsl",
                "QUICK_RULE" = rule
            );
            // Centres lie half-way between places.
            modules.extend([cost(prepared, 2.0), offer, quick]);
        }
        _ => {
            let aim = match prepared.aims().first() {
                Some((_, Aim::Quadrant(_))) => 1.0,
                Some((_, Aim::Side { .. })) => 2.0,
                _ => 0.0,
            };
            let cells = f64::from(u8::from(prepared.generator.over_cells()));
            let reach = wgsl!(
                "heightfield/conemap/generate/grid_distance.wgsl",
                "REACH_AIM" = aim,
                "REACH_CELLS" = cells,
            );
            let search = wgsl!("heightfield/conemap/generate/search.wgsl");
            modules.extend([cost(prepared, 1.0), offer, reach, search]);
        }
    }
    Program::new("generate", modules)
}

/// The program of a generator, whatever it is used on.
///
/// # Panics
/// Never: a map of one sample can always be made.
pub fn program_of(generator: Generator) -> Program {
    let one = Heights::new([1, 1], [false, false], vec![0.0]).expect("one sample is a map");
    let options = Options::default();
    let prepared = MapTask::new(generator, &one, Patches::default(), &options);
    program(&prepared.expect("the default options are in range"))
}

/// Every program that a generator can be made of.
pub fn every_program() -> Vec<Program> {
    let pyramids = [
        crate::heightfield::conemap::generate::pyramid::tiles_program(),
        crate::heightfield::conemap::generate::pyramid::mips_program(),
        crate::heightfield::conemap::generate::min3x3::nine_program(),
        crate::heightfield::conemap::generate::slopes::slopes_program(),
    ];
    let generators = Generator::ALL.into_iter().map(program_of);
    pyramids.into_iter().chain(generators).collect()
}
