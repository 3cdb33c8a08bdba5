//! `conemarch animate PRESET -o out-%05d.png`

use std::fs;
use std::io::{Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;

use anyhow::{Context, Result, anyhow};
use clap::{Args, ValueHint};

use crate::command::arguments::{bits, noise, pixel_samples, size};
use crate::command::executor::{Executor, device};
use crate::command::failure::usage;
use crate::command::frames::{Pattern, changed, is_there};
use crate::command::interrupt::{self, POLL};
use crate::command::output::Format;
use crate::command::print::{counted, say};
use crate::command::progress::Reporter;
use crate::command::render::{at_fault, loaded, moment};
use crate::command::sink::{Results, Sink, ending, folder_of, spared};
use crate::command::{completions, memory};
use crate::gpu::RenderError;
use crate::gpu::adapters::Choice;
use crate::pass::progress::Progress;
use crate::picture::{BitDepth, Layer, Shades, set_unfinished, write_png};
use crate::plan::{Extras, Plan};
use crate::preset;
use crate::scene::Assets;

/// The most frames of one run: nine hours at 30 per second.
const MOST_FRAMES: u32 = 1_000_000;

/// What `animate` takes.
#[derive(Args, Debug)]
pub struct Animate {
    /// A built-in preset, a .toml file, or a .png or .exr file that this program wrote, with [[track]]s
    #[arg(value_name = "PRESET", add = completions::presets())]
    preset: PathBuf,

    /// Where to write: a .png whose name has %05d, or another width, for the number of the frame
    ///
    /// A frame that exists already, with the same settings, is left as it is. So the same command
    /// goes on after an interrupt.
    #[arg(short, long, value_name = "PATTERN", value_hint = ValueHint::FilePath)]
    output: PathBuf,

    /// The first and the last frame, like 0..99 [default: all of the film]
    #[arg(long, value_name = "A..B", value_parser = range)]
    frames: Option<[u32; 2]>,

    /// Render only one part in N of the frames, from 1/N to N/N, for jobs on many machines
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "video")]
    shard: Option<[u32; 2]>,

    /// Join the frames to a video too; this needs ffmpeg
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    video: Option<PathBuf>,

    /// Width and height in pixels [default: the preset's]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,

    /// Samples, which are rays through each pixel: 1 is quick, 16 is smooth [default: the preset's]
    #[arg(long, value_name = "N", value_parser = pixel_samples())]
    samples: Option<u32>,

    /// Stop sampling a tile of a frame when its error is below this, from 0 to 1; 0.004 is one level
    /// of 8 bits [default: the preset's]
    #[arg(long, value_name = "NOISE", value_parser = noise, allow_negative_numbers = true)]
    until: Option<f64>,

    /// Set one value of the preset; may be given again
    #[arg(long, value_name = "SECTION.KEY=VALUE", allow_hyphen_values = true)]
    #[arg(add = completions::settings())]
    set: Vec<String>,

    /// Who renders: auto, gpu, software, cpu, or an index or part of a name from `devices`
    #[arg(long, value_name = "DEVICE", default_value = "auto", value_parser = device)]
    device: Choice,

    /// Bits of each colour; 16 leave no steps in smooth shades [default: 8]
    #[arg(long, value_name = "BITS", value_parser = bits())]
    depth: Option<BitDepth>,
}

/// Reads `A..B`.
fn range(text: &str) -> Result<[u32; 2], String> {
    let pair = text.split_once("..");
    let read = pair.and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    read.filter(|[a, b]| a <= b)
        .ok_or_else(|| "must be the first and the last frame, like 0..99".into())
}

/// Reads `I/N`.
fn shard(text: &str) -> Result<[u32; 2], String> {
    let pair = text.split_once('/');
    let read = pair.and_then(|(i, n)| Some([i.parse().ok()?, n.parse().ok()?]));
    read.filter(|[i, n]| (1..=*n).contains(i))
        .ok_or_else(|| "must be a part of so many, from 1/4 to 4/4 for example".into())
}

/// Renders the frames of a film.
///
/// # Errors
/// A wrong preset or option, a device that fails, an unwritable file, no ffmpeg, an interrupt.
/// Frames that are complete stay.
pub fn run(args: &Animate) -> Result<()> {
    interrupt::listen();
    let (preset, assets) = loaded(&args.preset, &args.set)?;
    let mut film = preset.plan;
    film.size = args.size.unwrap_or(film.size);
    film.samples = args.samples.unwrap_or(film.samples);
    film.until = args.until.unwrap_or(film.until);
    film.check_stereo().map_err(at_fault)?;
    if film.tracks.is_empty() {
        return Err(usage(format!(
            "`{}` has no [[track]], so that nothing moves; docs/presets.md tells how to write one, and `render` makes a still",
            args.preset.display()
        )));
    }
    let text = args.output.to_str().ok_or_else(|| {
        usage(format!(
            "-o `{}` is not UTF-8; give the frames a name in UTF-8",
            args.output.display()
        ))
    })?;
    let pattern = Pattern::read(text).map_err(|why| usage(format!("-o `{text}` {why}")))?;
    if ending(&args.output) != "png" {
        return Err(usage(format!(
            "-o `{text}` must name .png files; only these carry their preset, so that frames which are there can be told from others"
        )));
    }
    let all = film.time.frames();
    let [first, last] = args.frames.unwrap_or([0, all - 1]);
    if last >= all {
        return Err(usage(format!(
            "--frames {first}..{last}: the film has the frames 0..{}",
            all - 1
        )));
    }
    let [part, parts] = args.shard.unwrap_or([1, 1]);
    if (last - first) / parts >= MOST_FRAMES {
        return Err(usage(format!(
            "the film has {all} frames, of which at most {MOST_FRAMES} can be made at once; --frames or --shard names some"
        )));
    }
    if let Some(video) = &args.video {
        if ending(video).is_empty() {
            return Err(usage(format!(
                "--video `{}` does not say which format to write; name a file like film.mp4",
                video.display()
            )));
        }
        if Layer::Color.has_alpha(&film) {
            return Err(usage(
                "--video has no alpha, and image.background is transparent; leave --video out, or set image.background=sky",
            ));
        }
        find_ffmpeg()?;
        Sink::prepare(video)?;
    }
    // A film that fails does so before its first frame.
    let frames: Vec<u32> = (first..=last).filter(|f| f % parts == part - 1).collect();
    // A frame must not take the place of what the film is made from.
    let preset = preset::file(&args.preset).map(|file| ("the preset", file));
    let mut inputs = film.files();
    inputs.extend(preset);
    spared(&[("--video", args.video.as_deref())], &inputs)?;
    let mut missing = Vec::new();
    for frame in &frames {
        let name = pattern.name(*frame);
        spared(&[("a frame", Some(&name))], &inputs)?;
        if !is_there(&name, &plan_of(&film, *frame)?, args.depth) {
            missing.push(*frame);
        }
    }
    render(args, &film, &pattern, &missing, &assets)?;
    let kept = frames.len() - missing.len();
    let made = counted(missing.len(), "frame");
    say(&match kept {
        0 => made,
        _ => format!("{made}; {kept} there already"),
    });
    match &args.video {
        Some(video) => join(&film, &pattern, [first, last], video),
        None => Ok(()),
    }
}

/// The plan of a frame.
fn plan_of(film: &Plan, frame: u32) -> Result<Plan> {
    moment(film, film.time.beat_of(frame)).with_context(|| format!("frame {frame}"))
}

/// Renders and writes the missing frames.
fn render(
    args: &Animate,
    film: &Plan,
    pattern: &Pattern,
    missing: &[u32],
    assets: &Assets,
) -> Result<()> {
    let Some(first) = missing.first() else {
        return Ok(());
    };
    let plan = plan_of(film, *first)?;
    let stamps = || -> Vec<_> { film.files().iter().map(|(_, file)| changed(file)).collect() };
    let loaded = stamps();
    // As `render` makes each of them.
    let extras = Extras {
        rays: Some(plan.rays()),
        ..Extras::default()
    };
    let per_pixel = Format::Png.bytes_per_pixel(Layer::Color, &plan, extras);
    memory::check(
        &plan.resolved(extras, assets),
        per_pixel,
        assets,
        &args.device,
    )?;
    // A folder that cannot be written is found before the first frame.
    Sink::prepare(&pattern.name(*first))?;
    let (mut executor, who) = Executor::open(&args.device)?;
    say(&format!("rendering on {who}"));
    let mut progress = Reporter::start("rendering");
    for (done, frame) in missing.iter().enumerate() {
        let plan = &plan_of(film, *frame)?;
        let all = counted(missing.len(), "frame");
        let kept = format!("{done} of {all} written; the same command goes on");
        interrupt::keeps(Some(kept.clone()));
        let mut watch = |now: &Progress| {
            let share = (done as f64 + now.done) / missing.len() as f64;
            progress.report_part(now, share, &format!("frame {frame}, {}", now.pass))
        };
        let rendered = executor.picture(plan, assets, extras, &mut watch);
        let rendered = rendered.context(kept)?;
        let mut content = Vec::new();
        let picture = Shades::new(Layer::Color, &rendered, plan);
        let depth = args.depth.unwrap_or_default();
        let to = &mut Cursor::new(&mut content);
        let name = pattern.name(*frame);
        let text = preset::write_beside(plan, &name);
        write_png(to, &picture, depth, &plan.title, &text)?;
        // Else it would pass for a frame of the new file.
        if stamps() != loaded {
            let why = "a file that the preset names changed meanwhile; the same command renders all frames from the new one";
            return Err(anyhow!("{why}")).context(format!("frame {frame}"));
        }
        let mut results = Results::default();
        results.put(Sink::prepare(&name)?, &content)?;
        results.hand_over()?;
    }
    Ok(())
}

/// Looks for ffmpeg before anything is rendered.
fn find_ffmpeg() -> Result<()> {
    let mut asked = Command::new("ffmpeg");
    asked
        .arg("-version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    match asked.status() {
        Ok(status) if status.success() => Ok(()),
        _ => Err(anyhow!(
            "--video needs ffmpeg, and it does not run here; install it, or leave --video out and join the frames elsewhere"
        )),
    }
}

/// Joins the frames to a video.
fn join(film: &Plan, pattern: &Pattern, [first, last]: [u32; 2], video: &Path) -> Result<()> {
    let _progress = Reporter::start("joining the frames");
    let kept = "the frames are written; the same command joins them";
    interrupt::keeps(Some(kept.into()));
    let Pattern {
        before,
        digits,
        after,
    } = pattern;
    // ffmpeg knows the format by the ending, so its file needs a folder of its own.
    let folder = tempfile::Builder::new()
        .prefix(".")
        .suffix(".tmp")
        .tempdir_in(folder_of(video))?;
    let made = folder.path().join("video").with_extension(ending(video));
    let is_unfinished = |is| [folder.path(), &made].map(|path| set_unfinished(path, is));
    is_unfinished(true);
    let mut said = tempfile::tempfile()?;
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg
        .args(["-loglevel", "error", "-y", "-framerate"])
        .arg(film.time.fps.to_string())
        .args(["-start_number", &first.to_string()])
        .args(["-i", &format!("file:{before}%0{digits}d{after}")])
        .args(["-frames:v", &(last - first + 1).to_string()])
        // Players want even sides and this format of pixels.
        .args([
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-pix_fmt",
            "yuv420p",
        ])
        .arg(&made)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(said.try_clone()?);
    let mut ffmpeg = ffmpeg.spawn().context("ffmpeg does not start")?;
    let status = loop {
        if let Some(status) = ffmpeg.try_wait()? {
            break status;
        }
        if interrupt::asked() {
            ffmpeg.kill()?;
            ffmpeg.wait()?;
            return Err(RenderError::Cancelled).context(kept);
        }
        sleep(POLL);
    };
    let shown = video.display();
    if !status.success() {
        let mut why = String::new();
        said.rewind()?;
        said.read_to_string(&mut why)?;
        return Err(anyhow!("ffmpeg did not write `{shown}`: {why}"));
    }
    fs::rename(&made, video).with_context(|| format!("`{shown}` cannot be written"))?;
    is_unfinished(false);
    say(&shown.to_string());
    Ok(())
}
