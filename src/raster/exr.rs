//! OpenEXR by channel: only what is asked for is kept in memory.
//!
//! Reads parts without deep data, in scan lines or tiles, at the finest level. Halves and
//! whole numbers become f32. A size is checked before memory is allocated for it.

use std::io::{BufRead, Read, Seek};
use std::sync::{Mutex, PoisonError};

use exr::block::BlockIndex;
use exr::image::write::channels::{ChannelsWriter, WritableChannels};
use exr::math::{RoundingMode, Vec2};
use exr::meta::MetaData;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, ChannelList, LevelMode, SampleType, Text,
};
use exr::meta::header::Header;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, ReadChannels, ReadLayers, ReadSpecificChannel,
};

use crate::raster::open::check_size;
use crate::raster::text_chunk::MOST_TEXT;

/// What the head of a file tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Columns and rows of the first part.
    pub size: [u32; 2],
    /// Names of its channels, sorted.
    pub channels: Vec<String>,
    /// The text of the attribute that was asked for.
    pub text: Option<String>,
}

/// Reads the head of a file and puts the reader back to its start.
///
/// # Errors
/// In words: broken, deep, or too large.
pub fn head(from: &mut (impl Read + Seek), attribute: &str) -> Result<Head, String> {
    let meta = MetaData::read_from_buffered(&mut *from, false).map_err(|e| broken(&e))?;
    from.rewind().map_err(|e| format!("cannot be read: {e}"))?;
    let mut size = None;
    for header in &meta.headers {
        // Memory is taken for every part, so every part must be sane.
        let (w, h) = (header.layer_size.width(), header.layer_size.height());
        let found = check_size(w as u64, h as u64)?;
        size.get_or_insert(found);
    }
    let (Some(size), Some(first)) = (size, meta.headers.first()) else {
        return Err("is an EXR without an image".into());
    };
    if first.deep {
        return Err(
            "is an EXR of deep data, which has many numbers in a place; save it flat".into(),
        );
    }
    let channels = first.channels.list.iter();
    Ok(Head {
        size,
        channels: channels.map(|c| c.name.to_string()).collect(),
        text: attribute_of(&meta, attribute),
    })
}

/// The text of an attribute of a picture of any size.
///
/// # Errors
/// In words: broken.
pub fn text(from: impl Read, attribute: &str) -> Result<Option<String>, String> {
    let meta = MetaData::read_from_buffered(from, false).map_err(|e| broken(&e))?;
    Ok(attribute_of(&meta, attribute))
}

fn attribute_of(meta: &MetaData, attribute: &str) -> Option<String> {
    let first = meta.headers.first()?;
    match first.own_attributes.other.get(&Text::from(attribute)) {
        Some(AttributeValue::Text(text)) if text.as_slice().len() <= MOST_TEXT => utf8(text),
        _ => None,
    }
}

/// Reads one channel of the first part that has it, row by row.
///
/// # Errors
/// In words: broken or cut short, or without that channel.
pub fn channel(from: impl BufRead + Seek, name: &str) -> Result<Vec<f32>, String> {
    // Pedantic: a part that is missing must not turn into zeros.
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required(name)
        .collect_pixels(
            |size, _| (size.width(), vec![f32::NAN; size.area()]),
            |(width, values): &mut (usize, Vec<f32>), at, (value,): (f32,)| {
                values[at.y() * *width + at.x()] = value;
            },
        )
        .first_valid_layer()
        .all_attributes()
        .pedantic();
    let image: Image<_> = read.from_buffered(from).map_err(|e| broken(&e))?;
    Ok(image.layer_data.channel_data.pixels.1)
}

/// What the head of a file tells that holds a part of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct PartHead {
    /// Columns and rows of the whole image.
    pub whole: [u32; 2],
    /// The first pixel of the part, and its columns and rows.
    pub origin: [u32; 2],
    /// See `origin`.
    pub size: [u32; 2],
    /// Names of its channels, sorted.
    pub channels: Vec<String>,
    /// The text of the attribute that was asked for.
    pub text: String,
    /// The comments.
    pub comments: String,
}

/// Reads the head of a file of one part of an image, and puts the reader back to its start.
///
/// # Errors
/// In words: broken, or no such file.
pub fn part_head(from: &mut (impl Read + Seek), attribute: &str) -> Result<PartHead, String> {
    let meta = MetaData::read_from_buffered(&mut *from, false).map_err(|e| broken(&e))?;
    from.rewind().map_err(|e| format!("cannot be read: {e}"))?;
    let none = "is no part of a picture that `render --tile` wrote";
    let [first] = &meta.headers[..] else {
        return Err(none.into());
    };
    let own = &first.own_attributes;
    let (window, place) = (first.shared_attributes.display_window, own.layer_position);
    let number = |n: usize| u32::try_from(n).map_err(|_| none);
    let from_zero = |n: i32| u32::try_from(n).map_err(|_| none);
    let (Some(AttributeValue::Text(text)), Some(comments)) =
        (own.other.get(&Text::from(attribute)), &own.comments)
    else {
        return Err(none.into());
    };
    let found = PartHead {
        whole: [number(window.size.x())?, number(window.size.y())?],
        origin: [from_zero(place.x())?, from_zero(place.y())?],
        size: [number(first.layer_size.x())?, number(first.layer_size.y())?],
        channels: first
            .channels
            .list
            .iter()
            .map(|c| c.name.to_string())
            .collect(),
        text: utf8(text).ok_or(none)?,
        comments: utf8(comments).ok_or(none)?,
    };
    let inside = |axis: usize| {
        let end = u64::from(found.origin[axis]) + u64::from(found.size[axis]);
        found.size[axis] > 0 && end <= u64::from(found.whole[axis])
    };
    match inside(0) && inside(1) && !first.deep {
        true => Ok(found),
        false => Err(none.into()),
    }
}

/// A text of this program. The crate takes texts for Latin-1.
fn utf8(text: &Text) -> Option<String> {
    String::from_utf8(text.as_slice().to_vec()).ok()
}

/// Checks that the first part with red, green and blue holds the whole picture, and puts the reader back
/// to its start.
///
/// # Errors
/// In words: broken, without them, or with a part of the picture alone.
pub fn whole(from: &mut (impl Read + Seek)) -> Result<(), String> {
    let meta = MetaData::read_from_buffered(&mut *from, false).map_err(|e| broken(&e))?;
    from.rewind().map_err(|e| format!("cannot be read: {e}"))?;
    let has = |header: &Header, name: &str| header.channels.list.iter().any(|c| c.name == *name);
    let mut headers = meta.headers.iter();
    let Some(header) = headers.find(|h| ["R", "G", "B"].iter().all(|name| has(h, name))) else {
        return Err("is an EXR without channels R, G and B; save it with these".into());
    };
    let whole = header.shared_attributes.display_window;
    if (header.own_attributes.layer_position, header.layer_size) != (whole.position, whole.size) {
        let [own, all] = [header.layer_size, whole.size].map(|s| (s.width(), s.height()));
        return Err(format!(
            "is an EXR with {} x {} pixels of a picture of {} x {}; save the whole picture",
            own.0, own.1, all.0, all.1
        ));
    }
    Ok(())
}

/// Columns and rows of the first part that has red, green and blue, and these, row by row.
///
/// # Errors
/// In words: broken or cut short, or without them.
pub fn light(from: impl BufRead + Seek) -> Result<([u32; 2], Vec<[f32; 3]>), String> {
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |size, _| (size, vec![[f32::NAN; 3]; size.area()]),
            |(size, values): &mut (Vec2<usize>, Vec<[f32; 3]>), at, (r, g, b)| {
                values[at.y() * size.width() + at.x()] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .pedantic();
    let image: Image<_> = read.from_buffered(from).map_err(|e| broken(&e))?;
    let (size, values) = image.layer_data.channel_data.pixels;
    // The head of a file limits the sizes of its parts.
    Ok(([size.width() as u32, size.height() as u32], values))
}

/// Reads all channels of a file that have f32, row by row.
///
/// # Errors
/// In words: broken or cut short.
pub fn all_channels(from: impl BufRead + Seek) -> Result<Vec<(String, Vec<f32>)>, String> {
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .pedantic();
    let image: Image<Layer<AnyChannels<FlatSamples>>> =
        read.from_buffered(from).map_err(|e| broken(&e))?;
    let list = image.layer_data.channel_data.list.into_iter();
    let named = list.map(|channel| match channel.sample_data {
        FlatSamples::F32(values) => Ok((channel.name.to_string(), values)),
        _ => Err("has channels of other numbers than f32".to_string()),
    });
    named.collect()
}

fn broken(e: &exr::error::Error) -> String {
    format!("is an EXR that cannot be read: {e}; fetch or save it again")
}

/// Named f32 channels, in the order of a file.
pub fn channels(named: Vec<(String, Vec<f32>)>) -> AnyChannels<FlatSamples> {
    let named = named.into_iter();
    let list = named.map(|(name, values)| AnyChannel::new(name.as_str(), FlatSamples::F32(values)));
    AnyChannels::sort(list.collect())
}

/// f32 channels whose rows are asked for when they are written.
pub struct Rows<R> {
    names: Vec<String>,
    read: Mutex<R>,
}

impl<R: FnMut(usize, usize) -> Vec<u8>> Rows<R> {
    /// Channels with these names. `read` is told the first row and how many, in ascending order. It
    /// returns for each row that of each channel, in the order of their sorted names.
    pub fn new(names: Vec<String>, read: R) -> Self {
        let read = Mutex::new(read);
        Self { names, read }
    }
}

impl<'a, R: FnMut(usize, usize) -> Vec<u8> + Send + 'a> WritableChannels<'a> for Rows<R> {
    type Writer = &'a Self;

    fn infer_channel_list(&self) -> ChannelList {
        let names = self.names.iter();
        let list = names.map(|name| ChannelDescription::named(name.as_str(), SampleType::F32));
        ChannelList::new(list.collect())
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_writer(&'a self, _: &Header) -> &'a Self {
        self
    }
}

impl<R: FnMut(usize, usize) -> Vec<u8> + Send> ChannelsWriter for &Rows<R> {
    fn extract_uncompressed_block(&self, _: &Header, block: BlockIndex) -> Vec<u8> {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read(block.pixel_position.y(), block.pixel_size.height())
    }
}

/// Channels of a size with a text attribute, which are written losslessly and have the same bytes
/// every time.
pub fn image<'a, C: WritableChannels<'a> + 'a>(
    size: [u32; 2],
    channels: C,
    [attribute, text]: [&str; 2],
) -> Image<Layer<C>> {
    let mut attributes = LayerAttributes::default();
    attributes.other.insert(attribute.into(), text_of(text));
    // Lines in their order, so that threads that end in any order give the same bytes.
    let encoding = Encoding {
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
        ..Encoding::SMALL_FAST_LOSSLESS
    };
    let size = (size[0] as usize, size[1] as usize);
    Image::from_layer(Layer::new(size, attributes, encoding, channels))
}

/// A text as an attribute.
pub fn text_of(text: &str) -> AttributeValue {
    AttributeValue::Text(Text::from_slice_unchecked(text.as_bytes()))
}
