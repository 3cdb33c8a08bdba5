//! Compares the pictures of two builds of this program bit for bit; `scripts/same-pixels`
//! makes the builds and calls it:
//! `cargo bench --bench same_pixels -- OLD NEW [--size WxH] [PRESET]...`.
//!
//! Every preset is rendered by both builds on the device that `--device auto` chooses and on
//! the CPU. Two files are compared: an EXR, in every channel that both have, and a PNG with 8
//! bits. Depths of the sky are left out: a build may write any far value there.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use exr::prelude::*;
use one_sample::one_sample;

#[path = "common/one_sample.rs"]
mod one_sample;

const DEVICES: [&str; 2] = ["auto", "cpu"];

fn main() -> Result<()> {
    // Cargo adds `--bench` to what it is given.
    let mut args: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    ensure!(args.len() >= 2, "give the old and the new program");
    let mut presets = args.split_off(2);
    let mut more = Vec::new();
    if presets.first().is_some_and(|a| a == "--size") {
        ensure!(presets.len() >= 2, "give a size after --size");
        more = presets.drain(..2).collect();
    }
    if presets.is_empty() {
        let list = Command::new(&args[0]).arg("presets").output()?;
        let names = String::from_utf8(list.stdout)?;
        let first = names.lines().filter_map(|l| l.split_whitespace().next());
        presets = first.map(str::to_string).collect();
    }
    let folder = std::env::temp_dir().join(format!("same-pixels-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    println!("| preset | device | EXR channels | values | different | PNG bytes different |");
    println!("|---|---|---:|---:|---:|---:|");
    let mut all_same = true;
    for preset in &presets {
        for device in DEVICES {
            let render = |name: &str| -> Result<[PathBuf; 2]> {
                let [old, new] = [0, 1].map(|i| {
                    let file = folder.join(format!("{i}-{name}"));
                    render(&args[i], preset, device, &more, &file).map(|()| file)
                });
                Ok([old?, new?])
            };
            let (channels, values, different) = compare_exr(&render("a.exr")?)?;
            let bytes = compare_png(&render("a.png")?)?;
            println!("| {preset} | {device} | {channels} | {values} | {different} | {bytes} |");
            all_same &= different + bytes == 0;
        }
    }
    std::fs::remove_dir_all(&folder)?;
    ensure!(all_same, "the pictures differ");
    Ok(())
}

fn render(program: &str, preset: &str, device: &str, more: &[String], file: &Path) -> Result<()> {
    let mut command = Command::new(program);
    command
        .args(["render", preset, "--device", device])
        .args(one_sample(program)?)
        .args(more);
    command.arg("-o").arg(file).stderr(Stdio::piped());
    if file.extension().is_some_and(|e| e == "exr") {
        // Adds the channel of steps.
        command.arg("--stats").arg(file.with_extension("json"));
    }
    let output = command.output().with_context(|| program.to_string())?;
    if !output.status.success() {
        bail!("{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    Ok(())
}

/// Channels and values that both files have, and how many of the values differ.
fn compare_exr(files: &[PathBuf; 2]) -> Result<(usize, usize, usize)> {
    let read = |file: &PathBuf| -> Result<Vec<(String, Vec<f32>)>> {
        let image = read_first_flat_layer_from_file(file)?;
        let list = image.layer_data.channel_data.list.into_iter();
        let values = |c: AnyChannel<FlatSamples>| {
            (c.name.to_string(), c.sample_data.values_as_f32().collect())
        };
        Ok(list.map(values).collect())
    };
    let [old, new] = [read(&files[0])?, read(&files[1])?];
    let state = old.iter().find(|(name, _)| name == "state.Y");
    let state = &state.context("there is no channel state.Y")?.1;
    let (mut channels, mut values, mut different) = (0, 0, 0);
    for (name, old) in &old {
        let Some((_, new)) = new.iter().find(|(n, _)| n == name) else {
            bail!("the new picture has no channel {name}");
        };
        ensure!(old.len() == new.len(), "the pictures have two sizes");
        channels += 1;
        for ((old, new), state) in old.iter().zip(new).zip(state) {
            if name == "depth.Z" && *state == 0.0 {
                continue;
            }
            values += 1;
            different += usize::from(old.to_bits() != new.to_bits());
        }
    }
    Ok((channels, values, different))
}

/// How many bytes of the pixels differ.
fn compare_png(files: &[PathBuf; 2]) -> Result<usize> {
    let read = |file: &PathBuf| -> Result<Vec<u8>> {
        let file = std::io::BufReader::new(std::fs::File::open(file)?);
        let mut reader = png::Decoder::new(file).read_info()?;
        let mut pixels = vec![0; reader.output_buffer_size().context("too large")?];
        reader.next_frame(&mut pixels)?;
        Ok(pixels)
    };
    let [old, new] = [read(&files[0])?, read(&files[1])?];
    ensure!(old.len() == new.len(), "the pictures have two sizes");
    Ok(old.iter().zip(&new).filter(|(a, b)| a != b).count())
}
