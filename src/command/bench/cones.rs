//! `conemarch bench cones`: cone maps and tracers of heightfields, map by map and view by
//! view. No scene, no picture: what generators and tracers do by themselves.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Result;
use clap::Args;
use serde::Serialize;

use crate::command::bench::common::Common;
use crate::command::bench::cone_rows::{GeneratorRow, TracerRow};
use crate::command::bench::table;
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::print::say;
use crate::command::{interrupt, size};
use crate::gpu::conemap::generate::Maker;
use crate::gpu::device::{Choice, Device, PROMISED_BUFFERS};
use crate::gpu::render::RenderError;
use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::cpu;
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::max_mip::MaxMip;
use crate::heightfield::pattern::Pattern;
use crate::heightfield::tracer::cones::{Cones, Manner};
use crate::heightfield::tracer::linear::{LINEAR_ROUNDS, LINEAR_STEPS, LinearBinary};
use crate::heightfield::tracer::max_mip::MaxMipTracer;
use crate::heightfield::tracer::oracle::Oracle;
use crate::heightfield::tracer::relaxed::WalkRelaxed;
use crate::heightfield::tracer::walk::Walk;
use crate::heightfield::tracer::{AnyTracer, TraceError};
use crate::measure::tracer_stats::{first_hits, survey, view_rays};

/// Fields where none is named.
const FIELDS: [Pattern; 5] = [
    Pattern::Fbm,
    Pattern::Ridges,
    Pattern::Spikes,
    Pattern::Checker,
    Pattern::Sine,
];
/// Sizes where none is given.
const SIZES: [[u32; 2]; 2] = [[128, 128], [256, 256]];
/// Angles of view, in degrees from the vertical.
const VIEWS: [u32; 3] = [30, 60, 80];
/// Rays of a view: a share of 0.01 % is two rays.
const RAYS: u32 = 20_000;
/// What a generator may take for one map: with it all defaults stay under five minutes.
const BUDGET: Duration = Duration::from_secs(10);
/// Seed and power of the fields: rough terrain.
const SEED: u32 = 7;
const POWER: f64 = 2.6;

/// Options of `bench cones`.
#[derive(Debug, Args)]
pub struct ConesBench {
    /// Fields: fbm, ridges, spikes, checker, sine, noise, stones, bricks; the first five where
    /// none is named
    #[arg(value_name = "FIELD")]
    names: Vec<String>,
    /// Samples, instead of 128x128 and 256x256
    #[arg(long, value_name = "WxH", value_parser = size::read)]
    size: Option<[u32; 2]>,
    /// Take each sample for a flat box instead of joining four by a patch
    #[arg(long)]
    boxes: bool,
    /// Who makes the maps: cpu, auto, gpu, software, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = device)]
    device: Choice,
    /// Write the rows as JSON too
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the rows as CSV too
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// A row of either kind, as a file holds them.
#[derive(Serialize)]
#[serde(untagged)]
enum ConesRow {
    Generator(GeneratorRow),
    Tracer(TracerRow),
}

/// Maps that were finished, by their generators.
type Maps = Vec<(Generator, Arc<ConeMap>)>;

/// Runs the measurement.
///
/// # Errors
/// An unknown field, a device that fails, an unwritable file, an interrupt.
pub fn run(args: &ConesBench) -> Result<()> {
    interrupt::listen();
    let common = Common {
        names: Vec::new(),
        size: None,
        device: args.device.clone(),
        json: args.json.clone(),
        csv: args.csv.clone(),
    };
    let fields = fields(&args.names)?;
    let sizes = args.size.map_or(SIZES.to_vec(), |size| vec![size]);
    for size in &sizes {
        Heights::new(*size, [false; 2], vec![0.0; area(*size)])
            .map_err(|e| usage(e.to_string()))?;
    }
    let patches = if args.boxes {
        Patches::Boxes
    } else {
        Patches::Bilinear
    };
    let files = common.files(None, &[])?;
    let executor = common.executor_with(PROMISED_BUFFERS)?;
    let mut generators = Vec::new();
    let mut tracers = Vec::new();
    for size in sizes {
        for field in &fields {
            let heights = Heights::new(size, [false; 2], field.heights(size, SEED, POWER))?;
            let relief = Arc::new(HeightSurface::new(heights, patches, [1, 1])?);
            let (rows, maps) = generate(&executor, *field, &relief)?;
            files.show(&table::generators(&rows))?;
            generators.extend(rows);
            let rows = trace(*field, &relief, &maps)?;
            files.show(&table::tracers(&rows))?;
            tracers.extend(rows);
        }
    }
    let all = generators.into_iter().map(ConesRow::Generator);
    let all: Vec<_> = all
        .chain(tracers.into_iter().map(ConesRow::Tracer))
        .collect();
    files.write(&all)
}

fn area([w, h]: [u32; 2]) -> usize {
    w as usize * h as usize
}

/// The fields of names, or those that are measured where there are none.
fn fields(names: &[String]) -> Result<Vec<Pattern>> {
    if names.is_empty() {
        return Ok(FIELDS.to_vec());
    }
    let one = |name: &String| {
        let known = Pattern::ALL.map(Pattern::name).join(", ");
        let why = || usage(format!("there is no field `{name}`; there is: {known}"));
        Pattern::named(name).ok_or_else(why)
    };
    names.iter().map(one).collect()
}

/// Every map of a relief, as far as the budget goes.
fn generate(
    executor: &Executor,
    field: Pattern,
    relief: &HeightSurface,
) -> Result<(Vec<GeneratorRow>, Maps)> {
    let device = match executor {
        Executor::Gpu(renderer) => Some(&renderer.device),
        Executor::Cpu => None,
    };
    let mut maker = device.map(Maker::new);
    let mut maps: Maps = Vec::new();
    let mut rows = Vec::new();
    for generator in Generator::ALL {
        let made = one_map(&mut maker, generator, relief)?;
        let mut row = GeneratorRow {
            field: field.name().into(),
            size: relief.heights().size(),
            surface: relief.patches().name().into(),
            generator: generator.name().into(),
            device: executor.name(),
            ms: None,
            mean_ratio: None,
            of_exact: None,
            wider_than_exact: None,
            estimate_ms: None,
        };
        match made {
            Made::Map(map, ms) => {
                row.ms = Some(ms);
                row.mean_ratio = Some(mean_ratio(&map));
                maps.push((generator, Arc::new(map)));
            }
            Made::TooSlow(ms) => row.estimate_ms = Some(ms),
        }
        rows.push(row);
    }
    compare(&mut rows, &maps);
    rows.push(pyramid(executor, device, field, relief)?);
    Ok((rows, maps))
}

/// A map with its time, or the time that it would have taken.
enum Made {
    Map(ConeMap, f64),
    TooSlow(f64),
}

fn one_map(
    maker: &mut Option<Maker<'_>>,
    generator: Generator,
    relief: &HeightSurface,
) -> Result<Made> {
    let start = Instant::now();
    let mut done = 0.0;
    let mut watch = |share: f64| {
        done = share;
        !interrupt::asked() && (share >= 1.0 || start.elapsed() < BUDGET)
    };
    let (heights, patches) = (relief.heights(), relief.patches());
    let options = Options::default();
    let made = match maker {
        Some(maker) => maker.generate(generator, heights, patches, &options, &mut watch),
        None => cpu::generate(generator, heights, patches, &options, &mut watch),
    };
    let ms = start.elapsed().as_secs_f64() * 1e3;
    match made {
        Ok(map) => Ok(Made::Map(map, ms)),
        Err(GenerateError::Cancelled) if interrupt::asked() => Err(RenderError::Cancelled.into()),
        Err(GenerateError::Cancelled) => Ok(Made::TooSlow(ms / done.max(1e-6))),
        Err(e) => Err(e.into()),
    }
}

/// Mean ratio in texture widths, none counted as wider than one.
fn mean_ratio(map: &ConeMap) -> f64 {
    let width = f64::from(map.size[0]);
    let sum: f64 = map.ratios.iter().map(|r| (r / width).min(1.0)).sum();
    sum / map.ratios.len() as f64
}

/// Fills in what is relative to the brute force of Dummer's rule.
fn compare(rows: &mut [GeneratorRow], maps: &Maps) {
    // Branch and bound gives the same bits, should brute force take too long.
    let same = [Generator::Brute, Generator::Exact];
    let Some((_, exact)) = maps.iter().find(|(g, _)| same.contains(g)) else {
        return;
    };
    for (generator, map) in maps {
        let found = rows.iter_mut().find(|r| r.generator == generator.name());
        let Some(row) = found else { continue };
        row.of_exact = Some(mean_ratio(map) / mean_ratio(exact));
        if map.kind == exact.kind {
            let pairs = map.ratios.iter().zip(&exact.ratios);
            let wider = pairs.filter(|(own, exact)| **own > **exact * (1.0 + 1e-6));
            row.wider_than_exact = Some(wider.count() as f64 / map.ratios.len() as f64);
        }
    }
}

/// The row of the pyramid of maxima, which needs no cones.
fn pyramid(
    executor: &Executor,
    device: Option<&Device>,
    field: Pattern,
    relief: &HeightSurface,
) -> Result<GeneratorRow> {
    let apexes = relief.heights().apexes(relief.patches());
    let start = Instant::now();
    match device {
        Some(device) => Maker::new(device).max_mip(relief.cells(), &apexes)?,
        None => MaxMip::new(relief.cells(), apexes),
    };
    Ok(GeneratorRow {
        field: field.name().into(),
        size: relief.heights().size(),
        surface: relief.patches().name().into(),
        generator: "max-mip".into(),
        device: executor.name(),
        ms: Some(start.elapsed().as_secs_f64() * 1e3),
        mean_ratio: None,
        of_exact: None,
        wider_than_exact: None,
        estimate_ms: None,
    })
}

/// Tracers, each with the cones that it is measured with. `exact` has the bits of `brute`.
const PAIRS: [(&str, Option<Generator>); 16] = [
    ("linear-binary", None),
    ("csm-exact", Some(Generator::Exact)),
    ("csm-exact", Some(Generator::Improved)),
    ("csm-exact", Some(Generator::Center)),
    ("csm-loop", Some(Generator::Exact)),
    ("csm-fixed", Some(Generator::Exact)),
    ("csm-scaled", Some(Generator::Exact)),
    ("quad", Some(Generator::Quad)),
    ("rcs-binary", Some(Generator::RelaxedSearch)),
    ("rcs-binary", Some(Generator::RelaxedExact)),
    ("secant", Some(Generator::Exact)),
    ("secant", Some(Generator::Improved)),
    ("secant", Some(Generator::RelaxedExact)),
    ("max-mip", None),
    ("walk", Some(Generator::Walk)),
    ("walk-relaxed", Some(Generator::WalkRelaxed)),
];

/// A tracer of a name over a relief; `None` where its map is missing.
fn tracer(
    name: &str,
    relief: &Arc<HeightSurface>,
    map: Option<&Arc<ConeMap>>,
) -> Result<Option<AnyTracer>, TraceError> {
    let relief = relief.clone();
    match name {
        "linear-binary" => {
            let own = LinearBinary::new(relief, LINEAR_STEPS, LINEAR_ROUNDS);
            return Ok(Some(AnyTracer::LinearBinary(own)));
        }
        "max-mip" => return Ok(Some(AnyTracer::MaxMip(MaxMipTracer::new(relief)))),
        _ => {}
    }
    let Some(map) = map.cloned() else {
        return Ok(None);
    };
    Ok(match name {
        "walk" => Some(AnyTracer::Walk(Walk::new(relief, map)?)),
        "walk-relaxed" => Some(AnyTracer::WalkRelaxed(WalkRelaxed::new(relief, map)?)),
        _ => match Manner::ALL.into_iter().find(|m| m.name == name) {
            Some(manner) => Some(AnyTracer::Cones(Cones::new(relief, map, manner)?)),
            None => None,
        },
    })
}

/// Every tracer over every view of a relief.
fn trace(field: Pattern, relief: &Arc<HeightSurface>, maps: &Maps) -> Result<Vec<TracerRow>> {
    let oracle = Oracle::new(relief.clone());
    let mut rows = Vec::new();
    for view_deg in VIEWS {
        let rays = view_rays(relief, f64::from(view_deg), RAYS);
        let truths = first_hits(&oracle, &rays);
        for (name, generator) in PAIRS {
            if interrupt::asked() {
                return Err(RenderError::Cancelled.into());
            }
            let map = maps.iter().find(|(g, _)| Some(*g) == generator);
            let Some(tracer) = tracer(name, relief, map.map(|(_, m)| m))? else {
                if view_deg == VIEWS[0] {
                    let map = generator.map_or("", Generator::name);
                    say(&format!("{name} is left out: there is no map `{map}`"));
                }
                continue;
            };
            let found = survey(&tracer, &rays, &truths);
            rows.push(TracerRow {
                field: field.name().into(),
                size: relief.heights().size(),
                surface: relief.patches().name().into(),
                view_deg,
                tracer: name.into(),
                map: generator.map_or("none", Generator::name).into(),
                steps_mean: found.steps_mean,
                steps_p99: found.steps_p99,
                skipped: found.skipped,
                unconverged: found.unconverged,
                error_texels: found.error_texels,
            });
        }
    }
    Ok(rows)
}
