//! Pictures of linear light: Radiance HDR and OpenEXR.

use std::io::{ErrorKind, Read, Seek};
use std::path::Path;

use image::codecs::hdr::{HdrDecoder, HdrMetadata};
use image::{DynamicImage, ImageDecoder, ImageError};

use crate::raster::exr;
use crate::raster::open::{Format, check_size, open};

/// Columns and rows of a Radiance HDR or an OpenEXR, and its red, green and blue, row by row.
///
/// # Errors
/// In words, without the file's name: it cannot be read, is neither, is broken, or too large.
pub fn light(path: &Path) -> Result<([u32; 2], Vec<[f32; 3]>), String> {
    let mut opened = open(path)?;
    if opened.format == Format::Exr {
        exr::head(&mut opened.file, "")?;
        exr::whole(&mut opened.file)?;
        return exr::light(opened.file);
    }
    let mut mark = [0; 2];
    let read = opened.file.read_exact(&mut mark);
    read.and_then(|()| opened.file.rewind())
        .map_err(|e| format!("cannot be read: {e}"))?;
    if &mark != b"#?" {
        return Err("is no Radiance HDR and no OpenEXR; save it as one of these".into());
    }
    let broken = |e: ImageError| match e {
        ImageError::IoError(e) if e.kind() == ErrorKind::UnexpectedEof => {
            "is an HDR that ends before its end; fetch or save it again".to_string()
        }
        e => format!("is an HDR that cannot be read: {e}; save it as RGB, from the upper left"),
    };
    let decoder = HdrDecoder::new(opened.file).map_err(broken)?;
    let divisor = divisor(&HdrDecoder::metadata(&decoder))?;
    let (width, height) = decoder.dimensions();
    let size = check_size(width.into(), height.into())?;
    let image = DynamicImage::from_decoder(decoder)
        .map_err(broken)?
        .into_rgb32f();
    let light = image
        .pixels()
        .map(|p| [0, 1, 2].map(|i| p.0[i] / divisor[i]));
    Ok((size, light.collect()))
}

/// What the pixels of a Radiance HDR are divided by: its exposure and its corrections of the colours.
///
/// # Errors
/// In words: not all of them are above 0 and finite.
fn divisor(told: &HdrMetadata) -> Result<[f32; 3], String> {
    let exposure = told.exposure.unwrap_or(1.0);
    let (r, g, b) = told.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let all = [r, g, b].map(|c| exposure * c);
    match all.iter().find(|x| !x.is_normal() || **x < 0.0) {
        None => Ok(all),
        Some(x) => Err(format!(
            "is an HDR whose EXPOSURE and COLORCORR come to {x}; each must be above 0"
        )),
    }
}
