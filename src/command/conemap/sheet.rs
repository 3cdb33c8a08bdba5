//! A picture with panels side by side, each with a caption and a bar that explains its colours.

use std::convert::Infallible;
use std::io::Cursor;

use embedded_graphics::mono_font::ascii::FONT_7X13;
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::{
    Dimensions, DrawTarget, Drawable, OriginDimensions, Pixel, Point, RgbColor, Size,
};
use embedded_graphics::text::{Alignment, Baseline, Text};
use glam::DVec3;
use image::imageops::{FilterType, replace, resize, thumbnail};
use image::{ImageError, ImageFormat, Rgb, RgbImage};

const FONT: &MonoFont<'_> = &FONT_7X13;
/// Small maps are magnified by whole numbers to at most the first edge, large ones are scaled
/// down to the second.
const EDGES: [u32; 2] = [320, 640];
/// Space around panels, height of a line of text, and height of a bar.
const GAP: u32 = 24;
const LINE: u32 = 18;
const BAR: u32 = 12;

const PAPER: Rgb<u8> = Rgb([246; 3]);
const INK: Rgb888 = Rgb888::new(38, 38, 38);
const FRAME: Rgb<u8> = Rgb([140; 3]);

/// A map of colours with its explanation.
pub struct Panel {
    caption: String,
    image: RgbImage,
    bar: Option<Bar>,
}

/// The colours of a panel's values from left to right.
pub struct Bar {
    /// The colour of a share of 0..=1.
    pub color: fn(f64) -> DVec3,
    /// What the left end, the middle and the right end mean.
    pub marks: [String; 3],
}

impl Panel {
    /// A panel over a grid of places; `color` is asked for each place, row by row.
    pub fn new(
        caption: &str,
        size: [u32; 2],
        color: impl Fn(usize) -> DVec3,
        bar: Option<Bar>,
    ) -> Self {
        let [w, h] = size;
        let whole = RgbImage::from_fn(w, h, |x, y| rgb(color((y * w + x) as usize)));
        let longest = w.max(h).max(1);
        let image = if longest > EDGES[1] {
            let [w, h] = size.map(|n| (n * EDGES[1] / longest).max(1));
            thumbnail(&whole, w, h)
        } else {
            let times = (EDGES[0] / longest).max(1);
            resize(&whole, w * times, h * times, FilterType::Nearest)
        };
        Self {
            caption: caption.into(),
            image,
            bar,
        }
    }

    /// Width with all its text.
    fn width(&self) -> u32 {
        let marks = self.bar.as_ref().map_or(0, |bar| {
            // The middle mark is centred, so both sides need the room of the longer end.
            let [left, middle, right] = bar.marks.each_ref().map(String::len);
            2 * left.max(right) + middle + 2
        });
        let letters = self.caption.len().max(marks) as u32;
        let text = letters * FONT.character_size.width;
        self.image.width().max(text)
    }
}

fn rgb(color: DVec3) -> Rgb<u8> {
    // The cast saturates.
    Rgb(color.to_array().map(|c| (c * 255.0 + 0.5) as u8))
}

/// Draws panels side by side, as the bytes of a PNG with its size.
///
/// # Errors
/// The encoder failed.
pub fn png(panels: &[Panel]) -> Result<(Vec<u8>, [u32; 2]), ImageError> {
    let tallest = panels.iter().map(|p| p.image.height()).max().unwrap_or(0);
    let width = GAP + panels.iter().map(|p| p.width() + GAP).sum::<u32>();
    let bars = GAP + LINE + tallest + BAR;
    let height = bars + BAR + LINE + GAP;
    let mut sheet = Sheet(RgbImage::from_pixel(width, height, PAPER));
    let mut left = GAP;
    for panel in panels {
        let w = panel.width();
        sheet.text(&panel.caption, [left, GAP], Alignment::Left);
        sheet.framed(&panel.image, [left, GAP + LINE]);
        if let Some(bar) = &panel.bar {
            // Bars of panels of different heights are in one row.
            let share = |x: u32| (f64::from(x) + 0.5) / f64::from(w);
            let colors = RgbImage::from_fn(w, BAR, |x, _| rgb((bar.color)(share(x))));
            sheet.framed(&colors, [left, bars]);
            let sides = [Alignment::Left, Alignment::Center, Alignment::Right];
            for ((mark, side), x) in bar.marks.iter().zip(sides).zip([0, w / 2, w]) {
                sheet.text(mark, [left + x, bars + BAR + 4], side);
            }
        }
        left += w + GAP;
    }
    let mut bytes = Cursor::new(Vec::new());
    sheet.0.write_to(&mut bytes, ImageFormat::Png)?;
    Ok((bytes.into_inner(), [width, height]))
}

/// An image that can be drawn on.
struct Sheet(RgbImage);

impl Sheet {
    fn text(&mut self, text: &str, at: [u32; 2], alignment: Alignment) {
        let [x, y] = at.map(|n| n as i32);
        let letters = MonoTextStyle::new(FONT, INK);
        let mut text = Text::with_alignment(text, Point::new(x, y), letters, alignment);
        text.text_style.baseline = Baseline::Top;
        let Ok(_) = text.draw(self);
    }

    fn framed(&mut self, image: &RgbImage, [left, top]: [u32; 2]) {
        let frame = RgbImage::from_pixel(image.width() + 2, image.height() + 2, FRAME);
        replace(&mut self.0, &frame, i64::from(left) - 1, i64::from(top) - 1);
        replace(&mut self.0, image, left.into(), top.into());
    }
}

impl OriginDimensions for Sheet {
    fn size(&self) -> Size {
        Size::new(self.0.width(), self.0.height())
    }
}

impl DrawTarget for Sheet {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        let inside = self.bounding_box();
        for Pixel(at, color) in pixels.into_iter().filter(|p| inside.contains(p.0)) {
            let color = Rgb([color.r(), color.g(), color.b()]);
            self.0.put_pixel(at.x as u32, at.y as u32, color);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_any_size_are_drawn() {
        for size in [[1, 1], [1, 900], [2000, 3], [33, 17], [641, 640]] {
            let panel = |caption| {
                let bar = Bar {
                    color: DVec3::splat,
                    marks: ["0".into(), String::new(), "much more than fits".into()],
                };
                Panel::new(caption, size, |_| DVec3::X, Some(bar))
            };
            let (bytes, [w, h]) = png(&[panel("one"), panel("two")]).expect("a picture");
            assert!(w <= 2 * EDGES[1] + 3 * GAP && h < EDGES[1] + 200, "{w} {h}");
            let drawn = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
            assert!(drawn.pixels().any(|p| *p == Rgb([255, 0, 0])), "{size:?}");
        }
    }
}
