//! `conemarch merge PART... -o FILE`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use clap::{Args, ValueHint};

use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::memory::{self, FINER};
use crate::command::output::{Format, Options};
use crate::command::print::{counted, say};
use crate::command::progress::Reporter;
use crate::command::sink::{Results, Sink, shown, spared};
use crate::command::tile::Note;
use crate::picture::frame::Frame;
use crate::picture::{
    Layer, Named, PngHead, Shades, SummedLight, exr_row_bytes, exr_rows_of, write_exr_rows,
    write_png_rows,
};
use crate::plan::Plan;
use crate::preset::{self, PNG_KEYWORD};
use crate::raster::exr::{PartHead, all_channels, channel, light, part_head};
use crate::raster::open::{self, Stream, open};

/// What `merge` takes.
#[derive(Args, Debug)]
pub struct Merge {
    /// The .exr files of all parts of one picture, which `render --tile` wrote
    #[arg(value_name = "PART", required = true, value_hint = ValueHint::FilePath)]
    parts: Vec<PathBuf>,

    /// Where to write: a .png, .jpg, .webp or .exr file, or - for PNG on standard output
    ///
    /// The file has the bytes of the picture that `render` makes at once on the same device.
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: PathBuf,

    #[command(flatten)]
    options: Options,
}

/// A file of a part.
#[derive(Debug)]
struct Part {
    path: PathBuf,
    head: PartHead,
    note: Note,
}

/// Joins parts to a picture.
///
/// # Errors
/// A file is no part, the parts do not fit together, an unwritable file, an interrupt.
pub fn run(args: &Merge) -> Result<()> {
    interrupt::listen();
    let parts: Vec<Part> = args
        .parts
        .iter()
        .map(|path| Part::open(path))
        .collect::<Result<_>>()?;
    let plan = one_plan(&parts)?;
    let format = Format::of(&args.output, &args.options, &plan)?;
    let inputs: Vec<_> = args
        .parts
        .iter()
        .map(|path| ("a part", path.clone()))
        .collect();
    spared(&[("the picture", Some(args.output.as_path()))], &inputs)?;
    let mut devices = BTreeMap::new();
    for part in &parts {
        *devices.entry(part.note.device.clone()).or_insert(0) += 1;
    }
    let count = parts.len();
    let rows = in_rows(parts, plan.size)?;
    let row = rows.iter().map(|row| row[0].head.size[1]).max();
    let (row, all) = (row.unwrap_or(1), plan.size[1]);
    // Bytes per pixel of what is held at a time: light or channels, their bytes, and the part that is
    // read.
    let (what, height, bytes, helps) = match format {
        Format::Png => ("a row of parts", row, 40, FINER),
        Format::Exr => ("a row of parts", row, 280, FINER),
        _ => (
            "a picture",
            all,
            40,
            "join them to a .png or .exr, which takes a row of parts at a time",
        ),
    };
    let bytes = bytes + if Layer::Color.has_alpha(&plan) { 8 } else { 0 };
    memory::check_pixels(what, [plan.size[0], height], bytes, helps)?;
    let mut sink = Sink::prepare(&args.output)?;
    let mut progress = Reporter::start("joining the parts");
    let all = rows.len();
    let mut tell = |nth: usize| {
        progress.report(nth as f64 / all as f64, "reading and encoding");
        interrupt::check()
    };
    let text = preset::write_beside(&plan, &args.output);
    let head = PngHead {
        size: plan.size,
        layer: Layer::Color,
        alpha: Layer::Color.has_alpha(&plan),
        depth: args.options.depth.unwrap_or_default(),
        ppi: plan.ppi,
        title: &plan.title,
        preset: &text,
    };
    let mut results = Results::default();
    match (format, &mut sink) {
        (Format::Png, sink) => {
            // With bloom, each pixel's colour needs the light of all parts.
            let mut gathered = SummedLight::new(&plan);
            if let Some(all) = &mut gathered {
                for row in &rows {
                    tell(0)?;
                    all.add(&light_of(row, &plan)?.radiance);
                }
            }
            let bloom = gathered.map(SummedLight::blurred);
            let lines = rows.iter().enumerate().map(|(nth, row)| {
                tell(nth)?;
                let frame = light_of(row, &plan)?;
                let part = (Layer::Color, &frame, &plan);
                Ok(Shades::of_part(part, bloom.clone()).rows(head.depth))
            });
            match sink {
                Sink::File(place) => place.write(|to| write_png_rows(to, &head, lines))?,
                Sink::Stdout => {
                    let mut content = Vec::new();
                    write_png_rows::<anyhow::Error>(&mut content, &head, lines)?;
                    results.print(&content);
                }
            }
        }
        (Format::Exr, Sink::File(place)) => {
            let names = rows[0][0].head.channels.clone();
            let bytes = exr_row_bytes(&plan, names.len());
            let mut held = (usize::MAX, Vec::new());
            let lines = |first: usize, count: usize| -> Result<Vec<u8>> {
                let begin = |nth: usize| rows[nth][0].head.origin[1] as usize;
                let nth = (0..all).rfind(|nth| begin(*nth) <= first).unwrap_or(0);
                if held.0 != nth {
                    tell(nth)?;
                    // Rows are large: the one before goes first.
                    drop(std::mem::take(&mut held.1));
                    held = (nth, channels_of(&rows[nth], plan.size[0])?);
                }
                let at = (first - begin(nth)) * bytes;
                let lines = held.1.get(at..at + count * bytes);
                let fault = "its height is no multiple of 32; render it again";
                Ok(lines.ok_or_else(|| rows[nth][0].fault(fault))?.to_vec())
            };
            place.write(|to| write_exr_rows(to, (&plan, names), &text, lines))?;
        }
        (_, sink) => {
            let mut whole = Frame {
                size: plan.size,
                ..Frame::default()
            };
            for (nth, row) in rows.iter().enumerate() {
                tell(nth)?;
                let row = light_of(row, &plan)?;
                whole.radiance.extend(row.radiance);
                whole.alpha.extend(row.alpha);
            }
            let content =
                format.encode(&args.options, &plan, &whole, (Vec::new(), &args.output))?;
            match sink {
                Sink::File(place) => place.write_all(&content)?,
                Sink::Stdout => results.print(&content),
            }
        }
    }
    drop(progress);
    interrupt::check()?;
    if let Sink::File(place) = sink {
        results.add(place);
    }
    results.hand_over()?;
    for (device, count) in devices {
        say(&format!("{} by {device}", counted(count, "part")));
    }
    let [w, h] = plan.size;
    say(&format!(
        "{}  {w} x {h}  of {}",
        shown(&args.output),
        counted(count, "part")
    ));
    Ok(())
}

impl Part {
    fn open(path: &Path) -> Result<Self> {
        let read = || {
            let mut file = stream(path)?;
            let head = part_head(&mut file, PNG_KEYWORD)?;
            let note = Note::read(&head.comments);
            let note = note.ok_or("is no part of a picture that `render --tile` wrote")?;
            Ok((head, note))
        };
        let (head, note) = read().map_err(|why: String| anyhow!("{}: {why}", path.display()))?;
        // What the head claims is read at once.
        memory::check_pixels("a part", head.size, 12, FINER)?;
        Ok(Self {
            path: path.into(),
            head,
            note,
        })
    }

    fn shown(&self) -> std::path::Display<'_> {
        self.path.display()
    }

    fn fault(&self, why: &str) -> anyhow::Error {
        anyhow!("{}: {why}", self.shown())
    }

    /// Puts values of the part into those of a row of parts, so many pixels wide, from a row of the
    /// picture on.
    fn place<T: Copy>(&self, values: &[T], to: &mut [T], width: u32, first: u32) {
        let [x, y] = self.head.origin;
        let own = self.head.size[0] as usize;
        for (row, values) in (y - first..).zip(values.chunks(own)) {
            let at = row as usize * width as usize + x as usize;
            to[at..at + own].copy_from_slice(values);
        }
    }
}

fn stream(path: &Path) -> Result<Stream, String> {
    let opened = open(path)?;
    match opened.format {
        open::Format::Exr => Ok(opened.file),
        _ => Err("is no EXR; `render --tile` writes the parts of a picture".into()),
    }
}

/// The plan of all parts.
fn one_plan(parts: &[Part]) -> Result<Plan> {
    let first = &parts[0];
    for part in parts {
        // Their presets may name files by other ways, from other folders.
        let other = |p: &Part| (p.head.whole, p.note.picture.clone());
        if other(part) != other(first) {
            return Err(anyhow!(
                "`{}` and `{}` are parts of different pictures; render all parts with the same program, preset and options",
                first.shown(),
                part.shown()
            ));
        }
        if part.head.channels != first.head.channels {
            return Err(anyhow!(
                "`{}` and `{}` have different channels; render all parts with --stats, or none",
                first.shown(),
                part.shown()
            ));
        }
    }
    let mut plan = preset::read(&first.head.text, &first.path.to_string_lossy())?;
    plan.set_folder(first.path.parent().unwrap_or(&first.path));
    match plan.size == first.head.whole {
        true => Ok(plan),
        false => Err(first.fault("its size is not that of its preset; render it again")),
    }
}

/// The parts as the rows of their grid.
fn in_rows(mut parts: Vec<Part>, [width, height]: [u32; 2]) -> Result<Vec<Vec<Part>>> {
    parts.sort_by_key(|part| (part.head.origin[1], part.head.origin[0]));
    let mut rows: Vec<Vec<Part>> = Vec::new();
    // Where the next part begins, and where its row ends.
    let (mut next, mut end) = ([0, 0], 0);
    let mut last: Option<PathBuf> = None;
    for part in parts {
        let ([x, y], [w, h]) = (part.head.origin, part.head.size);
        if next[0] == width {
            next = [0, end];
        }
        if [y, x] < [next[1], next[0]] {
            let other = last.unwrap_or_default();
            return Err(anyhow!(
                "`{}` and `{}` overlap; give the parts of one --tile grid only, each once",
                other.display(),
                part.shown()
            ));
        }
        if [x, y] != next {
            return Err(hole(next));
        }
        if x == 0 {
            end = y + h;
            rows.push(Vec::new());
        }
        if y + h != end {
            return Err(part.fault(
                "is of another grid than the part to its left; render all parts of one --tile grid",
            ));
        }
        next[0] = x + w;
        last = Some(part.path.clone());
        if let Some(row) = rows.last_mut() {
            row.push(part);
        }
    }
    match next[0] == width && end == height {
        true => Ok(rows),
        false if next[0] == width => Err(hole([0, end])),
        false => Err(hole(next)),
    }
}

fn hole([x, y]: [u32; 2]) -> anyhow::Error {
    usage(format!(
        "no part begins at column {x}, row {y} of the picture; give all parts of one --tile grid"
    ))
}

/// All channels of a row of parts, in a picture of so many columns.
fn channels_of(row: &[Part], width: u32) -> Result<Vec<u8>> {
    let mut list = Named::new();
    for part in row {
        interrupt::check()?;
        let read = stream(&part.path).and_then(all_channels);
        let own = read.map_err(|why| part.fault(&why))?;
        let ([_, first], [_, height]) = (part.head.origin, part.head.size);
        let pixels = width as usize * height as usize;
        if list.is_empty() {
            let empty = |(name, _): &(String, _)| (name.clone(), vec![0.0; pixels]);
            list.extend(own.iter().map(empty));
        }
        for ((_, all), (_, values)) in list.iter_mut().zip(&own) {
            part.place(values, all, width, first);
        }
    }
    Ok(exr_rows_of(&list, width))
}

/// The light of a row of parts, and its alpha if there is any.
fn light_of(row: &[Part], plan: &Plan) -> Result<Frame> {
    let [first, ..] = row else {
        return Ok(Frame::default());
    };
    let (width, height) = (plan.size[0], first.head.size[1]);
    let pixels = width as usize * height as usize;
    let mut radiance = vec![[0.0; 3]; pixels];
    let mut alpha = match Layer::Color.has_alpha(plan) {
        true => vec![0.0; pixels],
        false => Vec::new(),
    };
    for part in row {
        interrupt::check()?;
        let read = stream(&part.path).and_then(light);
        let (_, values) = read.map_err(|why| part.fault(&why))?;
        part.place(&values, &mut radiance, width, part.head.origin[1]);
        if !alpha.is_empty() {
            let read = stream(&part.path).and_then(|from| channel(from, "A"));
            let values = read.map_err(|why| part.fault(&why))?;
            part.place(&values, &mut alpha, width, part.head.origin[1]);
        }
    }
    Ok(Frame {
        size: [width, height],
        origin: [0, first.head.origin[1]],
        radiance,
        alpha,
        ..Frame::default()
    })
}
