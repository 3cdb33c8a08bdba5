//! `conemarch conemap inspect FILE`

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, ValueHint};

use crate::command::conemap::describe::{describe_heights, describe_map};
use crate::command::conemap::options::{Foreign, Reading};
use crate::command::conemap::panels::{heights_panels, map_panels};
use crate::command::conemap::sheet::png;
use crate::command::failure::usage;
use crate::command::interrupt;
use crate::command::print::{print, say};
use crate::command::progress::Reporter;
use crate::command::sink::{Sink, ending, shown, spared};
use crate::heightfield::Heights;
use crate::heightfield::conemap::file::{MapFile, MapUse, has_map};

/// What `inspect` takes.
#[derive(Args, Debug)]
pub struct Inspect {
    /// A cone map, a height map, or a field like fbm:512x512,seed=7
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    file: OsString,

    /// Draw the channels side by side into a .png file
    #[arg(short, long, value_name = "PICTURE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,

    /// Check that the cone map belongs to these heights, read with the options below
    #[arg(long, value_name = "HEIGHTS", value_hint = ValueHint::FilePath)]
    heights: Option<OsString>,

    #[command(flatten)]
    reading: Reading,

    #[command(flatten)]
    foreign: Foreign,
}

/// Tells what is in a file, and draws it.
///
/// # Errors
/// The file is neither a map nor heights, the map belongs to other heights, or the picture
/// cannot be written.
pub fn run(args: &Inspect) -> Result<()> {
    let path = Path::new(&args.file);
    let mut inputs = vec![("what it shows", path.to_path_buf())];
    inputs.extend(args.heights.iter().map(|h| ("the heights", h.into())));
    spared(&[("the picture", args.output.as_deref())], &inputs)?;
    interrupt::listen();
    let picture = args.output.as_deref().map(picture_sink).transpose()?;
    let mut progress = Reporter::start("inspecting");
    progress.report(0.0, "reading");
    // Fields have no file. The reader of heights reports a file that is neither.
    let is_map = args.foreign.is_given() || has_map(path);
    let name = path.display().to_string();
    let (text, panels) = if is_map {
        let needless = args.reading.given(args.foreign.is_given());
        if let (None, Some(option)) = (&args.heights, needless) {
            return Err(usage(format!(
                "{option} is for heights, and `{name}` is a cone map; leave it out, or name its heights with --heights"
            )));
        }
        let file = args.foreign.decode(path, args.reading.wrap)?;
        if let Some(heights) = &args.heights {
            let loaded = args.reading.load(heights, (&mut progress, "heights"))?;
            check_heights(&file, path, heights, &loaded.heights)?;
        }
        progress.report(0.0, "describing");
        let text = describe_map(&name, &file);
        (text, picture.is_some().then(|| map_panels(&file)))
    } else {
        if args.heights.is_some() {
            return Err(usage(format!(
                "`{name}` is not a cone map, so --heights has nothing to check; leave it out"
            )));
        }
        let loaded = args.reading.load(&args.file, (&mut progress, "heights"))?;
        progress.report(0.0, "describing");
        let text = describe_heights(&name, &loaded);
        let panels = picture.is_some().then(|| heights_panels(&loaded.heights));
        (text, panels)
    };
    drop(progress);
    interrupt::check()?;
    print(text.as_bytes())?;
    if let (Some((path, sink)), Some(panels)) = (picture, panels) {
        let (bytes, [w, h]) = png(&panels)?;
        sink.finish(&bytes)?;
        say(&format!("{}  {w} x {h}", shown(&path)));
    }
    Ok(())
}

/// The name of a picture and where it goes, checked to be writable.
fn picture_sink(path: &Path) -> Result<(PathBuf, Sink)> {
    if ending(path) != "png" {
        return Err(usage(format!(
            "`{}` must end in .png, the format of these pictures",
            path.display()
        )));
    }
    Ok((path.to_path_buf(), Sink::prepare(path)?))
}

/// Checks that a map belongs to heights.
fn check_heights(file: &MapFile, path: &Path, name: &OsString, heights: &Heights) -> Result<()> {
    let wanted = MapUse {
        who: "this check",
        kinds: &[],
        heights,
        // Nothing is traced here, so any surface will do.
        patches: file.label.patches,
    };
    file.check_use(path, &wanted)?;
    let verb = match file.unknown() {
        Some(_) => "may belong",
        None => "belongs",
    };
    say(&format!(
        "{} {verb} to {}",
        path.display(),
        Path::new(name).display()
    ));
    Ok(())
}
