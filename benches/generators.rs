//! Measures the generators of cone maps: `cargo bench --bench generators -- [TABLE]`.
//!
//! Prints tables: `nodes` is how many nodes a place takes by field and size, `quality` how
//! the maps compare with the exact one, and `device SIZE [GENERATOR]...` how long generators
//! take on the CPU and on the device that `auto` chooses. Without arguments it prints these
//! three. `sizes` is how long the device takes for maps of 256 x 256 up to 4096 x 4096. All but
//! `quality` also write their rows as JSON, if `--json FILE` follows. A generator that is not
//! done within a minute is given as an estimate, with a tilde.

use std::fs;
use std::time::Instant;

use anyhow::{Context, Result};
use conemarch::base::parallel::collect;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::conemap::generate::Maker;
use conemarch::gpu::device::Device;
use conemarch::heightfield::conemap::ConeMap;
use conemarch::heightfield::conemap::generate::cpu;
use conemarch::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use conemarch::heightfield::conemap::generate::pyramid::Tiles;
use conemarch::heightfield::conemap::generate::task::MapTask;
use conemarch::heightfield::heights::{Heights, Patches};
use conemarch::heightfield::max_mip::MaxMip;
use conemarch::heightfield::pattern::Pattern;

#[path = "common/rows.rs"]
mod rows;
use rows::{NodesRow, SizesRow, TimesRow};

/// Rough terrain.
const POWER: f64 = 2.6;
/// Longest that a generator may take, in seconds.
const PATIENCE: f64 = 60.0;

fn main() -> Result<()> {
    // Cargo adds this word.
    let args = std::env::args().skip(1).filter(|a| a != "--bench");
    let args: Vec<String> = args.collect();
    let mut args: Vec<&str> = args.iter().map(String::as_str).collect();
    let mut json = None;
    if let [.., "--json", file] = args[..] {
        json = Some(file);
        args.truncate(args.len() - 2);
    }
    match args[..] {
        [] if json.is_none() => {
            nodes()?;
            quality()?;
            device(1024, &Generator::ALL)?;
            Ok(())
        }
        ["nodes"] => write(json, &nodes()?),
        ["quality"] if json.is_none() => quality(),
        ["device", size, ref names @ ..] => {
            let named = |name: &&str| Generator::named(name).context("a generator's name");
            let chosen: Vec<Generator> = names.iter().map(named).collect::<Result<_>>()?;
            let all = match chosen[..] {
                [] => &Generator::ALL[..],
                _ => &chosen,
            };
            write(json, &device(size.parse().context("a size")?, all)?)
        }
        ["sizes"] => write(json, &sizes()?),
        _ => anyhow::bail!(
            "usage: generators [nodes | quality | device SIZE [GENERATOR]... | sizes] [--json FILE]"
        ),
    }
}

/// Writes rows where a file is named.
fn write<T: serde::Serialize>(file: Option<&str>, rows: &[T]) -> Result<()> {
    if let Some(file) = file {
        fs::write(file, serde_json::to_string_pretty(rows)?).with_context(|| file.to_string())?;
    }
    Ok(())
}

fn field(field: Pattern, size: u32) -> Result<Heights> {
    let size = [size, size];
    let data = field.heights(size, 7, POWER);
    Ok(Heights::new(size, [false, false], data)?)
}

/// Nodes per place, mean and worst, of the searches.
fn nodes() -> Result<Vec<NodesRow>> {
    let mut rows = Vec::new();
    let searches = [
        Generator::Exact,
        Generator::RelaxedExact,
        Generator::Walk,
        Generator::WalkRelaxed,
    ];
    for generator in searches {
        let name = generator.name();
        println!("\nNodes per place of `{name}`, mean (worst)\n");
        println!("| field | 64 | 128 | 256 | 512 |\n|---|---:|---:|---:|---:|");
        for f in Pattern::ALL {
            let mut row = format!("| {} |", f.name());
            for size in [64, 128, 256, 512] {
                let heights = field(f, size)?;
                let (patches, options) = (Patches::default(), Options::default());
                let task = MapTask::new(generator, &heights, patches, &options)?;
                let nodes = collect(0..task.values.len(), 64, |place| {
                    task.find(place, &mut [None; 4]).nodes
                });
                let total: u64 = nodes.iter().map(|n| u64::from(*n)).sum();
                let mean = total as f64 / (nodes.len() * generator.channels()) as f64;
                let worst = nodes.into_iter().max().unwrap_or(0);
                row += &format!(" {mean:.1} ({worst}) |");
                rows.push(NodesRow {
                    generator: name.into(),
                    field: f.name().into(),
                    size,
                    mean,
                    worst,
                });
            }
            println!("{row}");
        }
    }
    Ok(rows)
}

/// Mean ratios of the maps over that of the exact one, and the share of places that are
/// wider than it.
fn quality() -> Result<()> {
    println!("\nMean ratio over that of `exact` (share of wider places), 128 x 128\n");
    let others = [
        Generator::Naive,
        Generator::Improved,
        Generator::Center,
        Generator::RelaxedExact,
        Generator::RelaxedSearch,
    ];
    let names: Vec<&str> = others.iter().map(|g| g.name()).collect();
    let names = names.join(" | ");
    println!("| field | {names} |\n|---|{}", "---:|".repeat(5));
    for f in Pattern::ALL {
        let heights = field(f, 128)?;
        let options = Options {
            search_steps: 64,
            ..Options::default()
        };
        let make = |g| cpu::generate(g, &heights, Patches::default(), &options, &mut |_| true);
        let exact: ConeMap = make(Generator::Exact)?;
        let mut row = format!("| {} |", f.name());
        for generator in others {
            let map = make(generator)?;
            let pairs = map.ratios.iter().zip(&exact.ratios);
            let wider = pairs.filter(|(r, e)| **r > **e * (1.0 + 1e-6)).count();
            let share = 100.0 * wider as f64 / exact.ratios.len() as f64;
            row += &format!(" {:.3} ({share:.2} %) |", map.mean() / exact.mean());
        }
        println!("{row}");
    }
    Ok(())
}

fn open() -> Result<Device> {
    let adapters = Adapters::find();
    let found = adapters.choose(&Choice::Auto)?;
    let (adapter, _) = found.context("there is no adapter")?;
    Ok(Device::open(adapter)?)
}

/// Steps along each ray of Listing 18-2 in the paper on quick maps (section 4.1).
const PAPER_STEPS: u32 = 64;

/// Times on the device by size: the table of generation times in section 4.1 of Valasek and
/// Ban (2022), with the exact maps beside. What was given up at one size is left out at all
/// larger ones.
fn sizes() -> Result<Vec<SizesRow>> {
    let device = open()?;
    let mut maker = Maker::new(&device);
    let options = Options {
        search_steps: PAPER_STEPS,
        ..Options::default()
    };
    let mut rows: Vec<SizesRow> = Vec::new();
    let mut add = |generator: &str, size, ms, estimated| {
        println!("{size} {generator} {}{ms:.0} ms", tilde(estimated));
        rows.push(SizesRow {
            generator: generator.into(),
            size,
            ms,
            estimated,
        });
    };
    let mut generators = vec![
        Generator::Brute,
        Generator::RelaxedSearch,
        Generator::Improved,
        Generator::Center,
        Generator::Exact,
    ];
    for size in [256, 512, 1024, 2048, 4096] {
        let heights = field(Pattern::Fbm, size)?;
        for generator in generators.clone() {
            let ([ms, _], estimated) = best(&mut maker, generator, &heights, &options)?;
            add(generator.name(), size, ms, estimated);
            if estimated {
                generators.retain(|g| *g != generator);
            }
        }
        let mut fastest = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            maker.max_mip(heights.size(), heights.data())?;
            fastest = fastest.min(ms(start));
        }
        add("max-mip", size, fastest, false);
    }
    Ok(rows)
}

/// What an estimate is marked with.
fn tilde(estimated: bool) -> &'static str {
    if estimated { "~" } else { "" }
}

/// Times of one map of `fbm`, whole and of the dispatches alone, warm.
fn device(size: u32, generators: &[Generator]) -> Result<Vec<TimesRow>> {
    let device = open()?;
    let mut maker = Maker::new(&device);
    let heights = field(Pattern::Fbm, size)?;
    let name = &device.info.name;
    println!("\n`fbm` {size} x {size} on {name}, milliseconds\n");
    println!("| generator | device, all | dispatches | searched again | CPU in f64 |");
    println!("|---|---:|---:|---:|---:|");
    let start = Instant::now();
    maker.max_mip(heights.size(), heights.data())?;
    let there = ms(start);
    let start = Instant::now();
    MaxMip::new(heights.size(), heights.data().to_vec());
    println!("| max-mip | {there:.0} | | | {:.0} |", ms(start));
    let mut rows = Vec::new();
    for &generator in generators {
        let row = times(&mut maker, generator, &heights, name)?;
        let (own, cpu) = (tilde(row.estimated), tilde(row.cpu_estimated));
        println!(
            "| {} | {own}{:.0} | {own}{:.0} | {:.3} % | {cpu}{:.0} |",
            row.generator,
            row.ms,
            row.dispatches_ms,
            100.0 * row.settled,
            row.cpu_ms
        );
        rows.push(row);
    }
    Ok(rows)
}

/// The least times of up to three runs on the device, whole and of the dispatches alone, and
/// whether they are estimates.
fn best(
    maker: &mut Maker<'_>,
    generator: Generator,
    heights: &Heights,
    options: &Options,
) -> Result<([f64; 2], bool)> {
    // The first run compiles; an estimate needs no second.
    let mut best = [f64::INFINITY; 2];
    for _ in 0..3 {
        let start = Instant::now();
        let part = watched(start, |watch| {
            maker.generate(generator, heights, Patches::default(), options, watch)
        })?;
        let now = [ms(start) / part, maker.device_ms / part];
        best = [best[0].min(now[0]), best[1].min(now[1])];
        if part < 1.0 {
            return Ok((best, true));
        }
        if ms(start) > 10e3 {
            break;
        }
    }
    Ok((best, false))
}

/// One generator: the least of up to three runs on the device, one on the CPU.
fn times(
    maker: &mut Maker<'_>,
    generator: Generator,
    heights: &Heights,
    device: &str,
) -> Result<TimesRow> {
    let size = heights.size();
    let (patches, options) = (Patches::default(), Options::default());
    // Making the heights took memory, too; the peak counts from here. Systems without such a
    // file report none.
    let _ = fs::write("/proc/self/clear_refs", "5");
    let (best, estimated) = best(maker, generator, heights, &options)?;
    let peak = peak();
    let start = Instant::now();
    let part = watched(start, |watch| {
        cpu::generate(generator, heights, patches, &options, watch)
    })?;
    Ok(TimesRow {
        generator: generator.name().into(),
        size: size[0],
        device: device.into(),
        ms: best[0],
        dispatches_ms: best[1],
        estimated,
        settled: maker.refined as f64 / heights.data().len() as f64,
        cpu_ms: ms(start) / part,
        cpu_estimated: part < 1.0,
        largest_binding: u64::from(Tiles::new(size).count) * size_of::<[f32; 4]>() as u64,
        peak,
    })
}

/// The most memory that this process has had, in bytes, where the system tells.
fn peak() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

fn ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// The share of a map that was made before the patience ended.
fn watched(
    start: Instant,
    make: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<ConeMap, GenerateError>,
) -> Result<f64> {
    let mut share = 0.0;
    let made = make(&mut |done| {
        share = done;
        ms(start) < 1e3 * PATIENCE
    });
    match made {
        Ok(_) => Ok(1.0),
        Err(GenerateError::Cancelled) => Ok(share),
        Err(e) => Err(e.into()),
    }
}
