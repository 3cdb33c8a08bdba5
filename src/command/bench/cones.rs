//! `conemarch bench cones`: what generators and tracers of heightfields cost and miss, map by map
//! and view by view. It renders no picture.

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Result;
use clap::Args;
use clap::builder::TypedValueParser;

use crate::command::arguments::{samples, words};
use crate::command::bench::common::open;
use crate::command::bench::cone_rows::{ConesRow, GeneratorRow, SurfaceNote, TracerRow};
use crate::command::bench::files::RowFiles;
use crate::command::bench::table;
use crate::command::conemap::maker::MapMaker;
use crate::command::executor::{Executor, device};
use crate::command::interrupt;
use crate::command::print::say;
use crate::command::progress::Reporter;
use crate::gpu::adapters::Choice;
use crate::heightfield::conemap::generate::generator::{
    GenerateError, Generator, Options, Quality,
};
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::pattern::Pattern;
use crate::heightfield::tracer::settings::{TracerCones, TracerSettings};
use crate::heightfield::tracer::{Accuracy, Tracer, TracerKind};
use crate::measure::tracer_stats::{first_hits, measure, view_rays};

/// Fields by default.
const FIELDS: [Pattern; 5] = [
    Pattern::Fbm,
    Pattern::Ridges,
    Pattern::Spikes,
    Pattern::Checker,
    Pattern::Sine,
];
/// Sizes by default.
const SIZES: [[u32; 2]; 2] = [[128, 128], [256, 256]];
/// Angles of view, in degrees from the vertical.
const VIEWS: [u32; 3] = [30, 60, 80];
/// Rays of a view. With so many, a share of 0.01 % is two rays.
const RAYS: u32 = 20_000;
/// Time limit of a generator for one map. It keeps the defaults below five minutes.
const BUDGET: Duration = Duration::from_secs(10);
/// Seed and power of the fields. The power is that of rough terrain.
const SEED: u32 = 7;
const POWER: f64 = 2.6;

/// The cones of tracers that are measured with more than their default ones. `exact` gives the same
/// bits as `brute`.
const CHOSEN: [(TracerKind, Generator); 8] = [
    (TracerKind::CsmExact, Generator::Exact),
    (TracerKind::CsmExact, Generator::Improved),
    (TracerKind::CsmExact, Generator::Center),
    (TracerKind::RcsBinary, Generator::RelaxedSearch),
    (TracerKind::RcsBinary, Generator::RelaxedExact),
    (TracerKind::Secant, Generator::Exact),
    (TracerKind::Secant, Generator::Improved),
    (TracerKind::Secant, Generator::RelaxedExact),
];

/// Tracers, each with the cones that it is measured with; the exact ones last. Those that may be
/// off by a pixel are left out: they depend on the size of a pixel, and these rays have none.
fn pairs() -> Vec<(TracerKind, Option<Generator>)> {
    let accuracy = |kind: &TracerKind| kind.facts().accuracy;
    let mut kinds = Vec::from(TracerKind::ALL);
    kinds.retain(|kind| accuracy(kind) != Accuracy::Pixel);
    kinds.sort_by_key(|kind| (accuracy(kind) == Accuracy::Exact, kind.needs_map()));
    let mut pairs = Vec::new();
    for kind in kinds {
        let chosen = CHOSEN.iter().filter(|(of, _)| *of == kind);
        let before = pairs.len();
        pairs.extend(chosen.map(|(_, by)| (kind, Some(*by))));
        if pairs.len() == before {
            pairs.push((kind, TracerSettings::from(kind).generator()));
        }
    }
    pairs
}

/// Options of `bench cones`.
#[derive(Debug, Args)]
pub struct ConesBench {
    /// Fields to measure [default: the first five]
    #[arg(value_name = "FIELD", value_parser = fields())]
    fields: Vec<Pattern>,
    /// Columns and rows of the fields [default: 128x128 and 256x256]
    #[arg(long, value_name = "WxH", value_parser = samples)]
    size: Option<[u32; 2]>,
    /// Treat each sample as a flat box, instead of joining four samples by a patch
    #[arg(long)]
    boxes: bool,
    /// The device that makes the maps: cpu, auto, gpu, software, an index or a part of a name
    #[arg(long, value_name = "DEVICE", default_value = "cpu", value_parser = device)]
    device: Choice,
    #[command(flatten)]
    rows: RowFiles,
}

fn fields() -> impl TypedValueParser<Value = Pattern> {
    words(Pattern::ALL.map(|field| (field, field.name(), "")))
}

/// Maps that were finished, by their generators.
type Maps = Vec<(Generator, Arc<ConeMap>)>;

/// One surface to measure, and who makes its maps.
struct Measured<'a> {
    note: SurfaceNote,
    surface: Arc<HeightSurface>,
    executor: &'a Executor,
}

/// Runs the measurement.
///
/// # Errors
/// A field is unknown, a device fails, a file cannot be written, or the user interrupts.
pub fn run(args: &ConesBench) -> Result<()> {
    interrupt::listen();
    let fields = match &args.fields[..] {
        [] => &FIELDS,
        named => named,
    };
    let sizes = args.size.map_or(SIZES.to_vec(), |size| vec![size]);
    let patches = match args.boxes {
        true => Patches::Boxes,
        false => Patches::Bilinear,
    };
    let files = args.rows.prepare(None, &[])?;
    let executor = &open(&args.device)?;
    let (mut generators, mut tracers) = (Vec::new(), Vec::new());
    for size in sizes {
        for &field in fields {
            let heights = Heights::new(size, [false; 2], field.heights(size, SEED, POWER))?;
            let measured = Measured {
                note: SurfaceNote {
                    field: field.name().into(),
                    size,
                    surface: patches.name().into(),
                },
                surface: Arc::new(HeightSurface::new(heights, patches, [1, 1])?),
                executor,
            };
            let (rows, maps) = measured.generate()?;
            files.show(&table::generators(&rows))?;
            generators.extend(rows);
            let rows = measured.trace(&maps)?;
            files.show(&table::tracers(&rows))?;
            tracers.extend(rows);
        }
    }
    let mut rows: Vec<_> = generators.into_iter().map(ConesRow::Generator).collect();
    rows.extend(tracers.into_iter().map(ConesRow::Tracer));
    files.write(&rows)
}

impl Measured<'_> {
    /// The row of a generator, without any figures.
    fn row(&self, generator: &str) -> GeneratorRow {
        GeneratorRow {
            over: self.note.clone(),
            generator: generator.into(),
            device: self.executor.name(),
            ..GeneratorRow::default()
        }
    }

    /// Rows of all generators and of the pyramid of maxima, and the maps that were finished in
    /// time.
    fn generate(&self) -> Result<(Vec<GeneratorRow>, Maps)> {
        let (heights, patches) = (self.surface.heights(), self.surface.patches());
        let mut maker = MapMaker::new(self.executor);
        let (mut rows, mut maps) = (Vec::new(), Maps::new());
        let mut progress = Reporter::start(&format!("making maps of {}", self.note.field));
        for (i, generator) in Generator::ALL.into_iter().enumerate() {
            let mut row = self.row(generator.name());
            let (start, mut done) = (Instant::now(), 0.0);
            let watch = &mut |share| {
                done = share;
                let all = (i as f64 + share) / Generator::ALL.len() as f64;
                let goes_on = progress.report(all, generator.name());
                goes_on && (share >= 1.0 || start.elapsed() < BUDGET)
            };
            let made = maker.generate(generator, heights, patches, &Options::default(), watch);
            let ms = start.elapsed().as_secs_f64() * 1e3;
            match made {
                Ok(map) => {
                    row.ms = Some(ms);
                    row.mean_ratio = Some(mean_ratio(&map));
                    maps.push((generator, Arc::new(map)));
                }
                Err(GenerateError::Cancelled) if !interrupt::asked() => {
                    row.estimate_ms = Some(ms / done.max(1e-6));
                }
                Err(e) => return Err(e.into()),
            }
            rows.push(row);
        }
        compare(&mut rows, &maps);
        let apexes = heights.apexes(patches);
        let start = Instant::now();
        maker.max_mip(self.surface.cells(), apexes)?;
        let mut row = self.row("max-mip");
        row.ms = Some(start.elapsed().as_secs_f64() * 1e3);
        rows.push(row);
        Ok((rows, maps))
    }

    /// Rows of all tracers over all views.
    fn trace(&self, maps: &Maps) -> Result<Vec<TracerRow>> {
        let reference = Tracer::reference(self.surface.clone());
        let (mut rows, pairs) = (Vec::new(), pairs());
        let mut progress = Reporter::start(&format!("tracing {}", self.note.field));
        for (i, view_deg) in VIEWS.into_iter().enumerate() {
            let rays = view_rays(&self.surface, f64::from(view_deg), RAYS);
            let truths = first_hits(&reference, &rays);
            for (j, (kind, generator)) in pairs.iter().copied().enumerate() {
                let done = (i * pairs.len() + j) as f64;
                let share = done / (VIEWS.len() * pairs.len()) as f64;
                progress.report(share, kind.name());
                interrupt::check()?;
                let map = maps.iter().find(|(g, _)| Some(*g) == generator);
                if kind.needs_map() && map.is_none() {
                    if view_deg == VIEWS[0] {
                        let (name, map) = (kind.name(), generator.map_or("", Generator::name));
                        say(&format!(
                            "{name} is skipped: the map `{map}` takes too long"
                        ));
                    }
                    continue;
                }
                let cones = map.map(|(_, map)| TracerCones::from(map.clone()));
                let settings = TracerSettings::from(kind);
                let tracer = kind.make(&self.surface, cones.as_ref(), &settings, 0.0)?;
                rows.push(TracerRow {
                    over: self.note.clone(),
                    view_deg,
                    tracer: kind.name().into(),
                    map: generator.map_or("none", Generator::name).into(),
                    stats: measure(&tracer, &rays, &truths),
                });
            }
        }
        Ok(rows)
    }
}

/// The mean ratio in texture widths; none counts as wider than one.
fn mean_ratio(map: &ConeMap) -> f64 {
    let width = f64::from(map.size[0]);
    let sum: f64 = map.ratios.iter().map(|r| (r / width).min(1.0)).sum();
    sum / map.ratios.len() as f64
}

/// Fills in the figures that compare a map with that of Dummer's rule by brute force.
fn compare(rows: &mut [GeneratorRow], maps: &Maps) {
    // Branch and bound gives the same bits if brute force takes too long.
    let same = |g: Generator| g.kind() == MapKind::Samples && g.facts().quality == Quality::Exact;
    let Some((_, exact)) = maps.iter().find(|(g, _)| same(*g)) else {
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
