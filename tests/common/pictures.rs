//! Files of other programs: PNG, EXR, TIFF and raw, as bytes.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
};
use png::{BitDepth, ColorType};

/// A PNG of samples as they stand in the file.
pub fn png(size: [u32; 2], color: ColorType, depth: BitDepth, samples: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 51, 51, 51, 255, 255, 255]);
    }
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(samples).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

/// A PNG with what stands in its head, and its samples.
pub fn pixels(bytes: impl AsRef<[u8]>) -> (png::Info<'static>, Vec<u8>) {
    let decoder = png::Decoder::new(Cursor::new(bytes));
    let mut reader = decoder.read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut pixels).expect("pixels");
    (reader.info().clone(), pixels)
}

/// An 8-bit grey PNG.
pub fn grey(size: [u32; 2], samples: &[u8]) -> Vec<u8> {
    png(size, ColorType::Grayscale, BitDepth::Eight, samples)
}

/// Numbers of 16 bits as a PNG has them.
pub fn wide(samples: &[u16]) -> Vec<u8> {
    samples.iter().flat_map(|n| n.to_be_bytes()).collect()
}

/// An EXR with named channels.
pub fn exr(size: [usize; 2], channels: Vec<(&str, FlatSamples)>) -> Vec<u8> {
    let list = channels.into_iter();
    let list = list.map(|(name, samples)| AnyChannel::new(name, samples));
    let layer = Layer::new(
        (size[0], size[1]),
        LayerAttributes::default(),
        Encoding::SMALL_FAST_LOSSLESS,
        AnyChannels::sort(list.collect()),
    );
    let mut bytes = Cursor::new(Vec::new());
    let image = Image::from_layer(layer);
    image.write().to_buffered(&mut bytes).expect("an EXR");
    bytes.into_inner()
}

/// A TIFF of one image.
pub fn tiff<C>(size: [u32; 2], samples: &[C::Inner]) -> Vec<u8>
where
    C: tiff::encoder::colortype::ColorType,
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).expect("a TIFF");
    let written = encoder.write_image::<C>(size[0], size[1], samples);
    written.expect("an image");
    bytes.into_inner()
}

/// Floats as a raw file has them.
pub fn raw(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|z| z.to_le_bytes()).collect()
}
