//! Renders a preset to a PNG file: `cargo run --release --example still`.

use anyhow::{Context, Result, anyhow};
use conemarch::cpu;
use conemarch::gpu::adapters::Adapters;
use conemarch::gpu::render::Renderer;
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
    let (assets, extras) = (Assets::default(), Extras::default());
    let frame = match Adapters::find().open_first(true) {
        Ok((device, _)) => Renderer::new(device).render(&plan, &assets, extras, &mut |_| true)?,
        Err(_) => cpu::render(&plan, &assets, extras, &mut |_| true)?,
    };

    let mut file = std::fs::File::create("still.png").context("still.png")?;
    let shades = Shades::new(Layer::Color, &frame, &plan);
    let text = preset::write(&plan);
    write_png(&mut file, &shades, BitDepth::Eight, &plan.title, &text)?;
    println!("still.png is written");
    Ok(())
}
