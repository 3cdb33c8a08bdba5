//! Big pictures: rendered in bands of rows, kept beside the picture, and joined at the end. Memory
//! hardly grows with the height.

use std::path::Path;

use anyhow::{Result, anyhow};
use bytemuck::{cast_slice, pod_collect_to_vec};

use crate::command::executor::Executor;
use crate::command::output::Format;
use crate::command::progress::Reporter;
use crate::command::render::Render;
use crate::command::sink::is_stdout;
use crate::command::stats::Figures;
use crate::command::tile::{BUILD, fingerprint};
use crate::command::unfinished::{Owner, Unfinished};
use crate::command::{failure::usage, interrupt};
use crate::pass::progress::Progress;
use crate::picture::frame::Frame;
use crate::picture::{
    BitDepth, Bloom, Layer, Place, PngHead, Shades, SummedLight, exr_names, exr_row_bytes,
    exr_rows, write_exr_rows, write_png_rows,
};
use crate::plan::pyramid::Block;
use crate::plan::{Extras, Plan, WINDOW_STEP};
use crate::preset;
use crate::scene::Assets;

/// A picture of more pixels is rendered in bands. Smaller ones take at most a gigabyte.
const MOST_AT_ONCE: u64 = 1 << 24;
/// Pixels of a band, about: some blocks of a device, and a quarter of a gigabyte.
const BAND: u32 = 1 << 22;
/// Bands of a picture at least, if it is high enough, so that little is lost.
const LEAST_BANDS: u32 = 16;

/// How a picture is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bands {
    size: [u32; 2],
    rows: u32,
}

impl Bands {
    /// The bands of a size.
    pub fn new(size: [u32; 2]) -> Self {
        let rows = (BAND / size[0]).min(size[1] / LEAST_BANDS);
        Self {
            size,
            rows: (rows / WINDOW_STEP).max(1) * WINDOW_STEP,
        }
    }

    /// The bands that a picture is rendered in, if it is big or is to be resumed.
    ///
    /// # Errors
    /// It is to be resumed, and it has no bands.
    pub fn of(args: &Render, plan: &Plan, format: Format, output: &Path) -> Result<Option<Self>> {
        let can = Self::can(args, plan, format, output);
        if args.resume && !can {
            let local = Layer::ALL
                .into_iter()
                .filter(|layer| layer.facts().is_local);
            let local: Vec<&str> = local.map(Layer::name).collect();
            return Err(usage(format!(
                "only an .exr file, or a .png file of one of the layers {}, can be resumed; leave --resume out, or write such a file",
                local.join(", ")
            )));
        }
        let is_big = plan.size.map(u64::from).iter().product::<u64>() > MOST_AT_ONCE;
        let has_bands = can && (is_big || args.resume);
        Ok(has_bands.then(|| Self::new(plan.size)))
    }

    /// Whether a picture can be rendered in bands.
    pub fn can(args: &Render, plan: &Plan, format: Format, output: &Path) -> bool {
        let whole = output.metadata().is_ok_and(|m| !m.is_file()) || is_stdout(output);
        let is_local = match format {
            Format::Png => args.layer.facts().is_local,
            format => format == Format::Exr,
        };
        is_local && !whole && plan.window.is_none()
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.size[1].div_ceil(self.rows) as usize
    }

    /// The pixels of a band.
    pub fn block(&self, band: usize) -> Block {
        let first = band as u32 * self.rows;
        Block {
            origin: [0, first],
            size: [self.size[0], self.rows.min(self.size[1] - first)],
        }
    }
}

/// A big picture under way.
pub struct BigPicture<'a> {
    plan: &'a Plan,
    extras: Extras,
    format: Format,
    layer: Layer,
    depth: BitDepth,
    bands: Bands,
    preset: String,
    kept: Unfinished,
}

impl<'a> BigPicture<'a> {
    /// Begins a picture, or goes on with it.
    ///
    /// # Errors
    /// What is kept beside the picture does not fit.
    pub fn begin(
        (args, plan, extras): (&Render, &'a Plan, Extras),
        (output, format, bands): (&Path, Format, Bands),
        (assets, device): (&Assets, String),
    ) -> Result<Self> {
        let preset = preset::write_beside(plan, output);
        let depth = args.options.depth.unwrap_or_default();
        let more = match format {
            Format::Exr => format!("EXR {extras:?} {}", bands.rows),
            _ => format!("{} {depth:?} {}", args.layer.name(), bands.rows),
        };
        let owner = Owner {
            version: BUILD.into(),
            device,
            picture: fingerprint(plan, assets, &more),
        };
        let row = match format {
            Format::Exr => exr_row_bytes(plan, exr_names(plan, extras).len()),
            _ if keeps_light(plan, args.layer) => plan.size[0] as usize * light_bytes(plan),
            _ => head((plan, args.layer, depth), &preset).row_bytes(),
        };
        let length = |band| bands.block(band).size[1] as usize * row;
        let lengths: Vec<usize> = (0..bands.count()).map(length).collect();
        Ok(Self {
            plan,
            extras,
            format,
            layer: args.layer,
            depth,
            bands,
            kept: Unfinished::open(output, owner, &lengths, args.resume)?,
            preset,
        })
    }

    /// Renders what is missing, and writes the picture. The times are those of the bands rendered
    /// now.
    ///
    /// # Errors
    /// The device failed, the disk is full, or an interrupt came. The bands before stay.
    pub fn make(
        &mut self,
        executor: &mut Executor,
        assets: &Assets,
        place: &mut Place,
    ) -> Result<Figures> {
        let figures = self.render(executor, assets);
        let written = figures.and_then(|figures| {
            let written = match self.format {
                Format::Exr => self.write_exr(place),
                _ => self.write_png(place),
            };
            written.map(|()| figures)
        });
        written.map_err(|e| self.kept.context(e))
    }

    fn render(&mut self, executor: &mut Executor, assets: &Assets) -> Result<Figures> {
        let mut figures: Option<Figures> = None;
        let mut plan = self.plan.clone();
        let (first, all) = (self.kept.count(), self.bands.count());
        let mut progress = Reporter::start("rendering");
        for band in first..all {
            let mut watch = |now: &Progress| {
                // The rest of the time follows from what is rendered now.
                let share = ((band - first) as f64 + now.done) / (all - first) as f64;
                let detail = format!("band {} of {all}, {}", band + 1, now.pass);
                progress.report_part(now, share, &detail)
            };
            plan.window = Some(self.bands.block(band));
            let frame = executor.picture(&plan, assets, self.extras, &mut watch)?;
            let own = Figures::of(&frame);
            let rows = match self.format {
                Format::Exr => exr_rows(&frame, &plan),
                _ if keeps_light(&plan, self.layer) => light(&frame),
                _ => Shades::new(self.layer, &frame, &plan).rows(self.depth),
            };
            drop(frame);
            self.kept.append(rows, own.tally)?;
            match &mut figures {
                Some(sum) => sum.add(&own),
                None => figures = Some(own),
            }
        }
        let tally = self.kept.tally();
        let tally = tally.ok_or_else(|| anyhow!("a picture without rows"))?;
        Ok(Figures {
            tally,
            ..figures.unwrap_or_else(|| Figures::none(tally))
        })
    }

    fn write_exr(&mut self, place: &mut Place) -> Result<()> {
        let mut progress = Reporter::start("writing the picture");
        let (all, height) = (self.bands.count(), self.bands.rows as usize);
        let names = exr_names(self.plan, self.extras);
        let row = exr_row_bytes(self.plan, names.len());
        let (kept, mut read) = (&mut self.kept, (all, Vec::new()));
        let rows = |first: usize, count: usize| {
            let band = first / height;
            if read.0 != band {
                progress.report(band as f64 / all as f64, "encoding");
                interrupt::check()?;
                read = (band, kept.rows(band)?);
            }
            // The encoder's blocks of 32 rows lie in one band, whose height is a multiple of 64.
            let begin = (first - band * height) * row;
            Ok(read.1[begin..begin + count * row].to_vec())
        };
        let of = (self.plan, names);
        place.write(|to| write_exr_rows(to, of, &self.preset, rows))
    }

    fn write_png(&mut self, place: &mut Place) -> Result<()> {
        let mut progress = Reporter::start("writing the picture");
        let (all, bands) = (self.bands.count(), self.bands);
        let bloom = self.bloom(&mut progress)?;
        let head = head((self.plan, self.layer, self.depth), &self.preset);
        let (kept, plan) = (&mut self.kept, self.plan);
        let rows = (0..all).map(|band| {
            progress.report(band as f64 / all as f64, "encoding");
            interrupt::check()?;
            let rows = kept.rows(band)?;
            Ok(match &bloom {
                None => rows,
                Some(bloom) => {
                    let frame = lit(&rows, bands.block(band), plan);
                    let part = (Layer::Color, &frame, plan);
                    Shades::of_part(part, Some(bloom.clone())).rows(head.depth)
                }
            })
        });
        place.write(|to| write_png_rows(to, &head, rows))
    }

    /// The bloom of the picture, from the light of all bands, if its look has any.
    fn bloom(&mut self, progress: &mut Reporter) -> Result<Option<Bloom>> {
        if !keeps_light(self.plan, self.layer) {
            return Ok(None);
        }
        let mut gathered = SummedLight::new(self.plan);
        for band in 0..self.bands.count() {
            progress.report(0.0, "spreading light");
            interrupt::check()?;
            let rows = self.kept.rows(band)?;
            let frame = lit(&rows, self.bands.block(band), self.plan);
            gathered.iter_mut().for_each(|all| all.add(&frame.radiance));
        }
        Ok(gathered.map(SummedLight::blurred))
    }

    /// Ends a picture that `handed` over, or failed to.
    ///
    /// # Errors
    /// It failed.
    pub fn end(self, handed: Result<()>) -> Result<()> {
        handed.map_err(|e| self.kept.context(e))?;
        self.kept.remove();
        Ok(())
    }
}

/// Whether bands keep light: with bloom, each pixel's colour needs all of them.
fn keeps_light(plan: &Plan, layer: Layer) -> bool {
    layer == Layer::Color && plan.look.bloom > 0.0
}

/// Bytes of a pixel's light, with its alpha if there is any.
fn light_bytes(plan: &Plan) -> usize {
    if Layer::Color.has_alpha(plan) { 16 } else { 12 }
}

/// The light of a band as bytes: that of all pixels, and then their alpha if there is any.
fn light(frame: &Frame) -> Vec<u8> {
    [cast_slice(&frame.radiance), cast_slice(&frame.alpha)].concat()
}

/// The light of a band from its bytes.
fn lit(bytes: &[u8], band: Block, plan: &Plan) -> Frame {
    let pixels = bytes.len() / light_bytes(plan);
    let (light, alpha) = bytes.split_at(12 * pixels);
    Frame {
        size: band.size,
        origin: band.origin,
        radiance: pod_collect_to_vec(light),
        alpha: pod_collect_to_vec(alpha),
        ..Frame::default()
    }
}

/// The head of the file, so far as it says something of a render.
fn head<'a>((plan, layer, depth): (&'a Plan, Layer, BitDepth), preset: &'a str) -> PngHead<'a> {
    PngHead {
        size: plan.size,
        layer,
        alpha: layer.has_alpha(plan),
        depth,
        ppi: plan.ppi,
        title: &plan.title,
        preset,
    }
}
