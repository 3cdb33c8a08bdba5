//! TIFF as numbers: the first image, strips or tiles, uncompressed, deflate or LZW.
//!
//! Unsigned whole numbers are divided by their largest value. All others stay as they are,
//! because elevation models hold metres. Only the first channel is read.

use std::io::{Read, Seek};

use tiff::ColorType;
use tiff::TiffError;
use tiff::decoder::{Decoder, DecodingResult};

use crate::raster::open::check_size;

/// The first channel of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Its numbers, row by row.
    pub values: Vec<f32>,
    /// Channels of the file.
    pub channels: usize,
}

/// Reads the first channel of a file.
///
/// # Errors
/// In words: broken, cut short, compressed or coloured in a way that is not read, or
/// too large.
pub fn read(from: impl Read + Seek) -> Result<Channel, String> {
    let mut decoder = Decoder::new(from).map_err(|e| broken(&e))?;
    let (width, height) = decoder.dimensions().map_err(|e| broken(&e))?;
    let size = check_size(width.into(), height.into())?;
    let color = decoder.colortype().map_err(|e| broken(&e))?;
    if matches!(
        color,
        ColorType::Palette(_)
            | ColorType::CMYK(_)
            | ColorType::CMYKA(_)
            | ColorType::YCbCr(_)
            | ColorType::Lab(_)
    ) {
        let would = "save it as grey";
        return Err(format!(
            "is a TIFF in {color:?}, which holds no heights; {would}"
        ));
    }
    // Planes after the first are left out, so that channels may be planar or not.
    let read = decoder.read_image().map_err(|e| broken(&e))?;
    let all = numbers(read);
    let places = size[0] as usize * size[1] as usize;
    let channels = usize::from(color.num_samples()).max(1);
    let stride = (all.len() / places).max(1);
    let values: Vec<f32> = all.into_iter().step_by(stride).take(places).collect();
    if values.len() != places {
        return Err(format!(
            "is a TIFF with {} of {places} numbers; save it again with 8, 16 or 32 bits",
            values.len()
        ));
    }
    Ok(Channel {
        size,
        values,
        channels,
    })
}

/// Unsigned numbers as shares of their largest, all others as they are.
fn numbers(read: DecodingResult) -> Vec<f32> {
    fn shares<T: Into<f64>>(of: Vec<T>, most: f64) -> Vec<f32> {
        of.into_iter().map(|v| (v.into() / most) as f32).collect()
    }
    match read {
        DecodingResult::U8(v) => shares(v, 255.0),
        DecodingResult::U16(v) => shares(v, 65_535.0),
        DecodingResult::U32(v) => shares(v, f64::from(u32::MAX)),
        DecodingResult::U64(v) => {
            shares(v.into_iter().map(|v| v as f64).collect(), u64::MAX as f64)
        }
        DecodingResult::F16(v) => v.into_iter().map(f32::from).collect(),
        DecodingResult::F32(v) => v,
        DecodingResult::F64(v) => shares(v, 1.0),
        DecodingResult::I8(v) => shares(v, 1.0),
        DecodingResult::I16(v) => shares(v, 1.0),
        DecodingResult::I32(v) => shares(v, 1.0),
        DecodingResult::I64(v) => v.into_iter().map(|v| v as f32).collect(),
    }
}

fn broken(e: &TiffError) -> String {
    match e {
        TiffError::UnsupportedError(e) => {
            format!("is a TIFF of a kind that is not read: {e}; save it as grey, uncompressed")
        }
        TiffError::LimitsExceeded => "is a TIFF that takes too much memory; cut it".into(),
        e => format!("is a TIFF that cannot be read: {e}; fetch or save it again"),
    }
}
