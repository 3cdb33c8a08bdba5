//! Renders a preset to a PNG file: `cargo run --release --example still`.

use anyhow::{Context, Result, anyhow};
use conemarch::command::executor::Executor;
use conemarch::gpu::device::Choice;
use conemarch::picture::{BitDepth, Layer, Shades, write_png};
use conemarch::plan::Extras;
use conemarch::preset;
use conemarch::scene::Assets;
use glam::DVec3;

fn main() -> Result<()> {
    // A preset is the text of a plan. A plan holds everything that decides a picture.
    let mut plan = preset::load("mandelbox", &[])?.plan;
    plan.camera.eye = DVec3::new(8.0, -12.0, 4.0);
    plan.size = [640, 360];
    plan.check().map_err(|fault| anyhow!(fault.why))?;

    // The best GPU, or the CPU if there is none. The last argument of `render` is called with
    // the progress; it may return false to cancel.
    let (mut executor, name) = Executor::open(&Choice::Auto)?;
    println!("rendering on {name}");
    let frame = executor.render(&plan, &Assets::default(), Extras::default(), &mut |_| true)?;

    let mut file = std::fs::File::create("still.png").context("still.png")?;
    let shades = Shades::new(Layer::Color, &frame, &plan);
    let text = preset::write(&plan);
    write_png(&mut file, &shades, BitDepth::Eight, &plan.title, &text)?;
    println!("still.png is written");
    Ok(())
}
