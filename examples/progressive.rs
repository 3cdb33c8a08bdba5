//! Writes the picture after each slice of a render:
//! `cargo run --release --example progressive -- mandelbox slices`.

use std::path::PathBuf;
use std::time::Duration;

use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::Renderer;
use conemarch::plan::Extras;
use conemarch::preset;
use conemarch::scene::Assets;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "mandelbox".into());
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "slices".into()));
    std::fs::create_dir_all(&folder)?;
    // Each of many samples would have slices of its own.
    let plan = preset::load(&name, &[])?.plan.one_sample();
    let adapters = Adapters::find();
    let (adapter, _) = adapters
        .choose(&Choice::Auto)?
        .ok_or_else(|| anyhow::anyhow!("there is no adapter"))?;
    let mut renderer = Renderer::new(Device::open(adapter)?);
    let extras = Extras {
        shown: true,
        sketched: true,
        ..Extras::default()
    };
    let mut work = renderer.begin(&plan, &Assets::default(), extras)?;
    // Until the first frame begins, a thread makes maps and compiles programs.
    while work.is_preparing() {
        std::thread::sleep(Duration::from_millis(10));
        work.advance(0.0)?;
    }
    anyhow::ensure!(
        work.picture().is_some(),
        "the image is larger than a texture of the device"
    );
    for slice in 0.. {
        work.advance(20.0)?;
        // Waits for the device, as a file needs the picture here. A window would show it there.
        let pixels = work.pixels()?;
        // Takes in what has ended. Later, the time for the file would count as that of the device.
        work.advance(0.0)?;
        let [width, height] = plan.size;
        let path = folder.join(format!("{slice:03}.png"));
        image::save_buffer(&path, &pixels, width, height, image::ColorType::Rgba8)?;
        let progress = work.progress();
        println!(
            "{}  {:3.0} %  {}",
            path.display(),
            100.0 * progress.done,
            progress.pass
        );
        if work.poll()?.is_some() {
            break;
        }
    }
    Ok(())
}
