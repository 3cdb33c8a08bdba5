//! Asks a formula for distances, then a rendered frame: `cargo run --release --example distance`.

use anyhow::{Result, anyhow};
use conemarch::cpu;
use conemarch::formula::mandelbox::Mandelbox;
use conemarch::formula::{DistanceEstimate as _, Formula};
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;
use conemarch::scene::Scene;
use glam::DVec3;

fn main() -> Result<()> {
    let mandelbox = Mandelbox {
        scale: -1.5,
        ..Mandelbox::default()
    };
    println!("bounds: {:?}", mandelbox.bounds());
    for x in [8.0, 4.0, 2.0] {
        let (estimate, iterations) = mandelbox.estimate(DVec3::splat(x), 100);
        println!("({x}, {x}, {x}): estimate {estimate:.4} after {iterations} iterations");
    }

    // The CPU renders in f64. A frame has a depth and a state for every pixel, row by row.
    let mut plan = Plan::new(Scene::from(Formula::Mandelbox(mandelbox)));
    plan.size = [64, 36];
    plan.check().map_err(|fault| anyhow!(fault.why))?;
    let frame = cpu::render(&plan, &Assets::default(), Extras::default(), &mut |_| true)?;
    let [sky, hit, unconverged] = frame.census();
    println!("{hit} pixels hit, {sky} show sky, {unconverged} did not converge");
    println!("depth in the middle: {}", frame.depth[18 * 64 + 32]);
    Ok(())
}
