//! Where a render writes its picture, and in which format.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;

use crate::command::arguments::{bits, whole};
use crate::command::failure::usage;
use crate::command::print::say;
use crate::command::render::Render;
use crate::command::sink::{ending, is_stdout};
use crate::picture::frame::Frame;
use crate::picture::{
    BitDepth, LAYER_KEYWORD, Layer, OutputError, Shades, write_exr, write_jpeg, write_png,
    write_webp,
};
use crate::plan::{Extras, Plan};
use crate::preset;
use crate::raster::text_chunk::{SIGNATURE, text};
use crate::raster::{self, open::open};

/// The format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 or 16 bits, with the preset.
    Png,
    /// 8 bits, with losses.
    Jpeg,
    /// 8 bits.
    WebP,
    /// All layers in 32 bits, with the preset.
    Exr,
}

/// How a picture is written.
#[derive(Args, Clone, Copy, Debug)]
pub struct Options {
    /// Bits of each colour of a PNG; 16 leave no steps in smooth shades [default: 8]
    #[arg(long, value_name = "BITS", value_parser = bits())]
    pub(crate) depth: Option<BitDepth>,

    /// Quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "QUALITY", value_parser = whole(1_u8, 100))]
    pub(crate) quality: Option<u8>,

    /// What the picture shows.
    #[arg(skip)]
    pub(crate) layer: Layer,
}

/// Formats by the extensions of file names.
const FORMATS: [(&str, Format); 5] = [
    ("png", Format::Png),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
    ("webp", Format::WebP),
    ("exr", Format::Exr),
];

/// Quality of a JPEG: nobody sees its losses, and higher ones double the file.
const QUALITY: u8 = 92;

impl Format {
    /// The format that the name of the output asks for, if the other options fit it.
    ///
    /// # Errors
    /// The extension is unknown, or an option, the size or the background does not fit the format.
    pub fn of(output: &Path, args: &Options, plan: &Plan) -> Result<Self> {
        let size = plan.size;
        let extension = ending(output);
        let known = FORMATS.iter().find(|(known, _)| *known == extension);
        let format = match known {
            _ if is_stdout(output) => Self::Png,
            Some((_, format)) => *format,
            None => {
                return Err(usage(format!(
                    "`{}` does not say what to write: name a .png, .jpg, .jpeg, .webp or .exr file, or - for PNG on standard output",
                    output.display()
                )));
            }
        };
        let is = |f| format == f;
        let wrong = if is(Self::Exr) && args.layer != Layer::Color {
            "an EXR has all layers; leave --layer out, or write a .png"
        } else if is(Self::Exr) && args.depth.is_some() {
            "an EXR has 32 bits per channel; leave --depth out, or write a .png"
        } else if !is(Self::Png) && args.depth.is_some() {
            "JPEG and WebP have 8 bits per channel; leave --depth out, or write a .png"
        } else if !is(Self::Jpeg) && args.quality.is_some() {
            "only JPEG has a quality; leave --quality out, or write a .jpg"
        } else if is(Self::Jpeg) && args.layer.has_alpha(plan) {
            "a JPEG has no alpha, and image.background is transparent; write a PNG, WebP or EXR, or set image.background=sky"
        } else if is(Self::WebP) && size.iter().any(|n| *n > 16_383) {
            "a WebP has at most 16383 pixels along each side; write a .png"
        } else if is(Self::Jpeg) && size.iter().any(|n| *n > 65_535) {
            "a JPEG has at most 65535 pixels along each side; write a .png"
        } else {
            return Ok(format);
        };
        Err(usage(wrong))
    }

    /// Most memory that a render takes at once, per pixel.
    pub fn bytes_per_pixel(self, layer: Layer, plan: &Plan, extras: Extras) -> u64 {
        // Peaks of 8 million pixels, rounded up. Both executors take about as much: the CPU
        // 51 bytes for colours and 102 for an EXR, which holds its channels beside the frame,
        // and a software device 54 and 132. A pair takes no more than one view: its frames are halves.
        // The truth is a second frame, on the CPU.
        let with = |asked: bool, more: u64| if asked { more } else { 0 };
        let truth = with(layer == Layer::Error, 20);
        let picture = match self {
            Self::Exr => 135,
            _ => 60 + with(extras.normals, 15) + truth,
        };
        // An f32, and a channel that is encoded.
        picture
            + with(extras.count, 25)
            + with(plan.is_transparent(extras), 8)
            + with(plan.has_variance(extras), 8)
    }

    /// The picture as the bytes of the file `output`. `errors` are those of the layer that shows
    /// them.
    ///
    /// # Errors
    /// The encoder failed.
    pub fn encode(
        self,
        args: &Options,
        plan: &Plan,
        frame: &Frame,
        (errors, output): (Vec<f64>, &Path),
    ) -> Result<Vec<u8>, OutputError> {
        let preset = preset::write_beside(plan, output);
        let mut content = Vec::new();
        let to = &mut Cursor::new(&mut content);
        let shades = || Shades::new(args.layer, frame, plan).with_errors(errors);
        match self {
            Self::Exr => write_exr(to, frame, plan, &preset)?,
            Self::Jpeg => write_jpeg(to, &shades(), args.quality.unwrap_or(QUALITY), &plan.title)?,
            Self::WebP => write_webp(to, &shades(), &plan.title)?,
            Self::Png => {
                let depth = args.depth.unwrap_or_default();
                write_png(to, &shades(), depth, &plan.title, &preset)?;
            }
        }
        Ok(content)
    }
}

/// The longest part of a file's name that tells settings. File systems allow 255 bytes in all.
const MOST_SETTINGS: usize = 120;

/// The layer that a PNG of this program shows.
fn layer_of(file: &Path) -> Option<Layer> {
    let mut file = BufReader::new(File::open(file).ok()?);
    file.seek(SeekFrom::Start(SIGNATURE.len() as u64)).ok()?;
    match text(&mut file, LAYER_KEYWORD).ok()? {
        Some(name) => Layer::named(&name),
        None => Some(Layer::Color),
    }
}

/// The bits of each colour of a PNG: they stand behind the signature, the head of the first chunk,
/// width and height.
pub fn bits_of(file: &Path) -> Option<u8> {
    let mut bits = [0];
    let mut file = File::open(file).ok()?;
    file.seek(SeekFrom::Start(24)).ok()?;
    file.read_exact(&mut bits).ok()?;
    Some(bits[0])
}

/// The file that a picture goes to without -o: `NAME.png`, with other settings
/// `NAME-camera.fov=33.png`, at a moment `NAME-at=2.png`, with another size `NAME-640x360.png`, with
/// samples `NAME-samples=16.png`, and of another layer `NAME.depth.png`. Only a picture of this
/// program, of the same layer and settings, is replaced. The preset in a file may have been edited
/// since.
///
/// # Errors
/// The file exists and may not be replaced.
pub fn default_name(args: &Render, plan: &Plan, own_size: [u32; 2]) -> Result<PathBuf> {
    // The bytes of the name are kept, which need not be UTF-8.
    let name = args.preset.file_stem();
    let mut file = name.unwrap_or(OsStr::new("preset")).to_os_string();
    let settings = args
        .set
        .iter()
        .flat_map(|set| ["-", set])
        .collect::<String>();
    let plain = |c: char| match c {
        c if c.is_ascii_alphanumeric() || "-.=".contains(c) => c,
        _ => '_',
    };
    let settings: String = settings.chars().map(plain).take(MOST_SETTINGS).collect();
    file.push(settings);
    if let Some(beat) = args.at {
        file.push(format!("-at={beat}"));
    }
    if plan.size != own_size {
        file.push(format!("-{}x{}", plan.size[0], plan.size[1]));
    }
    if let Some(samples) = args.samples {
        file.push(format!("-samples={samples}"));
    }
    if let Some(noise) = args.until {
        file.push(format!("-until={noise}"));
    }
    if args.layer != Layer::Color {
        file.push(format!(".{}", args.layer.name()));
    }
    file.push(".png");
    let file = PathBuf::from(file);
    if !file.exists() {
        return Ok(file);
    }
    let is_png = open(&file).is_ok_and(|opened| opened.format == raster::open::Format::Png);
    let picture = preset::find(&file).ok().filter(|_| is_png);
    let written = |path: &Path| fs::metadata(path).and_then(|m| m.modified()).ok();
    // A preset file that is not older than the picture was edited. An older one is another preset.
    let edited = |own: PathBuf| ending(&own) == "toml" && written(&own) >= written(&file);
    let may_differ = args.set.is_empty() && preset::file(&args.preset).is_some_and(edited);
    let name = file.display();
    // Whoever wrote the text may have left out defaults.
    let is_same = |old: &str| {
        let own = preset::write_beside(plan, &file);
        old == own || preset::read(old, "").is_ok_and(|old| preset::write(&old) == own)
    };
    let why = match &picture {
        None => "is no picture of this program",
        Some(_) if layer_of(&file) != Some(args.layer) => "shows another layer",
        Some(_) if bits_of(&file) != Some(args.options.depth.unwrap_or_default() as u8) => {
            "has another --depth"
        }
        Some(old) if is_same(&old.text) => return Ok(file),
        Some(_) if may_differ => {
            let own = args.preset.display();
            say(&format!(
                "`{name}` has other settings and is replaced, as `{own}` is newer"
            ));
            return Ok(file);
        }
        Some(_) => "has other settings",
    };
    Err(usage(format!(
        "`{name}` exists and {why}; name the new picture with -o"
    )))
}
