//! A small picture with panels: values as colours, captions, and bars that say what the
//! colours mean.

use glam::DVec3;

use crate::command::conemap::glyphs::{GLYPH, dots};
use crate::heightfield::raster::png;

/// Pixels of a dot of the captions.
const DOT: usize = 2;
/// Edges that panels have where their content allows: small maps are magnified by whole
/// numbers up to here, large ones averaged down to here.
const PANEL: [usize; 2] = [320, 640];
/// Space round panels.
const GAP: usize = 24;
/// Height of a caption with the space under it, and of a bar with those around it.
const CAPTION: usize = GLYPH[1] * DOT + 8;
const BAR: usize = 12;

const PAPER: DVec3 = DVec3::splat(0.965);
const INK: DVec3 = DVec3::splat(0.15);
const FRAME: DVec3 = DVec3::splat(0.55);

/// What a panel shows.
pub struct Panel<'a> {
    /// Over it.
    pub caption: String,
    /// Columns and rows of its values.
    pub size: [u32; 2],
    /// The colour of a place: column, row.
    pub color: Box<dyn Fn(u32, u32) -> DVec3 + 'a>,
    /// Colours of a bar from left to right, and what its ends and middle mean.
    pub bar: Option<Bar<'a>>,
}

/// A bar of colours.
pub struct Bar<'a> {
    /// The colour of a share of 0..=1.
    pub color: Box<dyn Fn(f64) -> DVec3 + 'a>,
    /// What the left end, the middle and the right end mean.
    pub marks: [String; 3],
}

/// Pixels, sRGB.
pub struct Canvas {
    size: [usize; 2],
    pixels: Vec<DVec3>,
}

impl Canvas {
    /// Draws panels side by side.
    pub fn of(panels: &[Panel<'_>]) -> Self {
        let drawn: Vec<[usize; 2]> = panels.iter().map(|p| Scale::of(p.size).drawn).collect();
        let tallest = drawn.iter().map(|d| d[1]).max().unwrap_or(0);
        let width = GAP + drawn.iter().map(|d| d[0] + GAP).sum::<usize>();
        let height = GAP + CAPTION + tallest + BAR * 2 + CAPTION + GAP / 2;
        let mut canvas = Self {
            size: [width, height],
            pixels: vec![PAPER; width * height],
        };
        let mut left = GAP;
        for (panel, drawn) in panels.iter().zip(&drawn) {
            canvas.panel(panel, [left, GAP], tallest);
            left += drawn[0] + GAP;
        }
        canvas
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    fn set(&mut self, x: usize, y: usize, color: DVec3) {
        if x < self.size[0] && y < self.size[1] {
            self.pixels[y * self.size[0] + x] = color;
        }
    }

    fn text(&mut self, text: &str, [left, top]: [usize; 2]) {
        for [x, y] in dots(text) {
            for (i, j) in (0..DOT).flat_map(|j| (0..DOT).map(move |i| (i, j))) {
                self.set(left + x * DOT + i, top + y * DOT + j, INK);
            }
        }
    }

    fn frame(&mut self, [left, top]: [usize; 2], [w, h]: [usize; 2]) {
        for x in left - 1..=left + w {
            self.set(x, top - 1, FRAME);
            self.set(x, top + h, FRAME);
        }
        for y in top - 1..=top + h {
            self.set(left - 1, y, FRAME);
            self.set(left + w, y, FRAME);
        }
    }

    fn panel(&mut self, panel: &Panel<'_>, [left, top]: [usize; 2], tallest: usize) {
        let scale = Scale::of(panel.size);
        let [w, h] = scale.drawn;
        self.text(&panel.caption, [left, top]);
        let top = top + CAPTION;
        for (x, y) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))) {
            self.set(left + x, top + y, scale.color(panel, x, y));
        }
        self.frame([left, top], [w, h]);
        let Some(bar) = &panel.bar else { return };
        // Bars of panels of different heights stand in one row.
        let top = top + tallest + BAR;
        for (x, y) in (0..BAR).flat_map(|y| (0..w).map(move |x| (x, y))) {
            let share = (x as f64 + 0.5) / w as f64;
            self.set(left + x, top + y, (bar.color)(share));
        }
        self.frame([left, top], [w, BAR]);
        let under = top + BAR + 6;
        let long = |text: &str| text.chars().count() * (GLYPH[0] + 1) * DOT - DOT;
        for (i, mark) in bar.marks.iter().enumerate() {
            if !mark.is_empty() {
                let room = w.saturating_sub(long(mark));
                self.text(mark, [left + room * i / 2, under]);
            }
        }
    }

    /// The picture as a PNG.
    ///
    /// # Errors
    /// In words: what the encoder said.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        let numbers = self.pixels.iter().flat_map(|c| c.to_array());
        // The cast saturates.
        let numbers = numbers.map(|v| u16::from((v * 255.0 + 0.5) as u8));
        let mut bytes = Vec::new();
        let pixels = png::Pixels {
            size: self.size.map(|n| n as u32),
            kept: 3,
            channels: 3,
            most: 255,
            numbers: numbers.collect(),
            is_grey: false,
            is_opaque: true,
            text: None,
        };
        png::write(&mut bytes, &pixels, "")?;
        Ok(bytes)
    }
}

/// How places become pixels.
struct Scale {
    /// Pixels along each axis.
    drawn: [usize; 2],
    /// Pixels per place; 1 where places are averaged.
    times: usize,
    /// Places averaged along each axis of a pixel; 1 where they are magnified.
    over: usize,
}

impl Scale {
    fn of(size: [u32; 2]) -> Self {
        let size = size.map(|n| n as usize);
        let longest = size[0].max(size[1]).max(1);
        let times = (PANEL[0] / longest).max(1);
        let over = longest.div_ceil(PANEL[1]);
        Self {
            drawn: size.map(|n| (n * times).div_ceil(over)),
            times,
            over,
        }
    }

    /// The colour of a pixel: of its place, or the mean of its places.
    fn color(&self, panel: &Panel<'_>, x: usize, y: usize) -> DVec3 {
        let [x, y] = [x, y].map(|i| i / self.times * self.over);
        let end = panel.size.map(|n| n as usize);
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        for j in y..(y + self.over).min(end[1]) {
            for i in x..(x + self.over).min(end[0]) {
                sum += (panel.color)(i as u32, j as u32);
                count += 1.0;
            }
        }
        sum / f64::max(count, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_any_size_are_drawn() {
        for size in [[1, 1], [1, 900], [2000, 3], [33, 17], [641, 640]] {
            let panel = |caption: &str| Panel {
                caption: caption.into(),
                size,
                color: Box::new(|_, _| DVec3::ONE),
                bar: Some(Bar {
                    color: Box::new(DVec3::splat),
                    marks: ["0".into(), String::new(), "much more than fits".into()],
                }),
            };
            let canvas = Canvas::of(&[panel("one"), panel("two")]);
            let [w, h] = canvas.size();
            assert!(w <= 2 * PANEL[1] + 3 * GAP && h < PANEL[1] + 200, "{w} {h}");
            assert!(canvas.pixels.contains(&DVec3::ONE));
        }
    }
}
