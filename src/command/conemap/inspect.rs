//! `conemarch conemap inspect FILE`

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, ValueHint};

use crate::command::conemap::common::{Reading, Strange, of_map, shown};
use crate::command::conemap::describe::{describe_heights, describe_map};
use crate::command::conemap::panels::{heights_panels, map_panels};
use crate::command::failure::usage;
use crate::command::print::{print, say};
use crate::command::sink::{Sink, spared};
use crate::heightfield::conemap::file::{MapFile, Wanted, has_map};

/// What `inspect` takes.
#[derive(Args, Debug)]
pub struct Inspect {
    /// A cone map, a height map, or a field like fbm:512x512,seed=7
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    file: String,

    /// Draw the channels side by side into a .png file
    #[arg(short, long, value_name = "PICTURE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Check that the cone map belongs to these heights, read with the options below
    #[arg(long, value_name = "HEIGHTS", value_hint = ValueHint::FilePath)]
    heights: Option<String>,

    #[command(flatten)]
    reading: Reading,

    #[command(flatten)]
    strange: Strange,
}

/// Tells what is in a file, and draws it.
///
/// # Errors
/// Neither a map nor heights, a map of other heights, an unwritable picture.
pub fn run(args: &Inspect) -> Result<()> {
    let heights = args
        .heights
        .iter()
        .map(|h| ("the heights", PathBuf::from(h)));
    let read = std::iter::once(("what it shows", PathBuf::from(&args.file)));
    spared(
        &[("the picture", args.output.as_deref())],
        &read.chain(heights).collect::<Vec<_>>(),
    )?;
    let picture = args.output.as_deref().map(prepared).transpose()?;
    let path = Path::new(&args.file);
    // Fields have no file; what is neither is told by the reader of heights.
    let is_map = args.strange.is_said() || has_map(path).unwrap_or(false);
    let canvas = if is_map {
        let needless = args.reading.given(args.strange.is_said());
        if let (None, Some(option)) = (&args.heights, needless) {
            return Err(usage(format!(
                "{option} says how heights are read, and `{}` is a cone map; leave it out, or name its heights with --heights",
                args.file
            )));
        }
        let file = args.strange.decode(path, args.reading.wrap)?;
        if let Some(heights) = &args.heights {
            belongs(args, &file, path, heights)?;
        }
        print(describe_map(&args.file, &file).as_bytes())?;
        picture.is_some().then(|| map_panels(&file))
    } else {
        if args.heights.is_some() {
            return Err(usage(format!(
                "`{}` is no cone map, so that --heights has nothing to check; leave it out",
                args.file
            )));
        }
        let loaded = args.reading.load(&args.file)?;
        print(describe_heights(&args.file, &loaded).as_bytes())?;
        picture.is_some().then(|| heights_panels(&loaded.heights))
    };
    if let (Some((path, sink)), Some(canvas)) = (picture, canvas) {
        sink.finish(&canvas.png().map_err(anyhow::Error::msg)?)?;
        let [w, h] = canvas.size();
        say(&format!("{}  {w} x {h}", shown(&path)));
    }
    Ok(())
}

/// A picture's name that can be written.
fn prepared(path: &Path) -> Result<(PathBuf, Sink)> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if path.as_os_str() == "-" || ending.to_lowercase() != "png" {
        return Err(usage(format!(
            "`{}` does not end in .png, which is what pictures of maps are",
            path.display()
        )));
    }
    Ok((path.to_path_buf(), Sink::prepare(path)?))
}

/// Checks that a map belongs to heights.
fn belongs(args: &Inspect, file: &MapFile, path: &Path, heights: &str) -> Result<()> {
    let loaded = args.reading.load(heights)?;
    let wanted = Wanted {
        who: "this check",
        kinds: &[],
        heights: &loaded.heights,
        // A map of boxes is as good a map as one of patches; nothing is traced here.
        patches: file.label.patches,
    };
    file.fit(path, &wanted).map_err(of_map)?;
    let verb = match file.unknown() {
        Some(_) => "may belong",
        None => "belongs",
    };
    say(&format!("{} {verb} to {heights}", path.display()));
    Ok(())
}
