//! Pictures of linear light: Radiance HDR and OpenEXR.

use std::io::{ErrorKind, Read, Seek};
use std::path::Path;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader};

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
        e => format!("is a broken HDR: {e}; fetch or save it again"),
    };
    let mut reader = ImageReader::with_format(opened.file, ImageFormat::Hdr);
    // The size is checked below.
    reader.no_limits();
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let size = check_size(width.into(), height.into())?;
    let image = DynamicImage::from_decoder(decoder)
        .map_err(broken)?
        .into_rgb32f();
    Ok((size, image.pixels().map(|p| p.0).collect()))
}
