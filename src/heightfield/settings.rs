//! The settings of a heightfield: its heights, its place in the world, and how it is traced.

use std::path::PathBuf;

use glam::{DVec2, DVec3};

use crate::base::key::{Fault, Key, counts, number, text, triple, word};
use crate::heightfield::conemap::generate::Generator;
use crate::heightfield::load::PatternSpec;
use crate::heightfield::tracer::{TracerKind, settings::TracerSettings};
use crate::heightfield::{
    Patches, assets::tiles_fault, height_surface::check_tiles, heights::cells, paint::PAINTS,
    placement::Placement,
};
use crate::keys;

pub use super::source::Source;

/// The value of `texture` for none.
const NO_TEXTURE: &str = "none";

/// A heightfield: heights, their place in the world, and how they are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightfieldSettings {
    /// Where its heights come from.
    pub source: Source,
    /// What lies between the samples.
    pub patches: Patches,
    /// Number of copies of the map along x and y.
    pub tiles: [u32; 2],
    /// World length of the block's longer side, with all tiles.
    pub width: f64,
    /// World length of the height 1.
    pub depth: f64,
    /// The middle of the block's base.
    pub centre: DVec3,
    /// Rotation in degrees about x, then y, then z.
    pub turn: DVec3,
    /// How rays are traced.
    pub tracer_settings: TracerSettings,
    /// The generator whose cones pick the colour; `None` for the height.
    pub paint: Option<Generator>,
    /// The path of a picture that colours each tile; `none` for none.
    pub texture: String,
}

impl Default for HeightfieldSettings {
    fn default() -> Self {
        Self {
            source: Source::default(),
            patches: Patches::Bilinear,
            tiles: [1, 1],
            width: 12.0,
            depth: 2.0,
            centre: DVec3::ZERO,
            turn: DVec3::ZERO,
            tracer_settings: TracerSettings::default(),
            paint: None,
            texture: NO_TEXTURE.into(),
        }
    }
}

impl HeightfieldSettings {
    /// Its keys in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        let mut keys = self.source.keys();
        keys.extend(keys![
            "surface" = word(&mut self.patches, &Patches::WORDS),
                "the surface between the samples: a bilinear patch over each cell, or each sample as a flat box" => Assets;
            "tiles" = counts(&mut self.tiles, 1, 256),
                "number of copies of the map along x and y" => Assets;
            "width" = number(&mut self.width, 1e-6, 1e6),
                "world length of the block's longer side";
            "depth" = number(&mut self.depth, 1e-6, 1e6),
                "world length of the height 1";
            "centre" = triple(&mut self.centre, -1e6, 1e6),
                "the middle of the block's base";
            "turn" = triple(&mut self.turn, -360.0, 360.0),
                "rotation in degrees about x, then y, then z";
            "paint" = word(&mut self.paint, PAINTS),
                "what picks the colour from the palette: the height, or the width of the cones that this generator makes" => Assets;
            "texture" = text(&mut self.texture),
                "a PNG, JPEG or WebP that colours each tile in place of the palette; \"none\" for none" => Assets;
        ]);
        keys.extend(self.tracer_settings.keys());
        keys
    }

    /// Checks that all settings fit together. No file is read.
    pub fn check(&self) -> Result<(), Fault> {
        self.tracer_settings.check()?;
        for (axis, name) in [(0, "x"), (1, "y")] {
            if self.tiles[axis] > 1 && !self.source.options.wrap[axis] {
                return Err(Fault::new(
                    "scene.tiles",
                    format!(
                        "the map is repeated along {name}, but it does not wrap there; set wrap = \"xy\""
                    ),
                ));
            }
        }
        match PatternSpec::read(&self.source.field) {
            Some(Err(why)) => return Err(Fault::new("scene.field", why)),
            // Before its heights are made.
            Some(Ok(pattern)) => {
                let cells = cells(pattern.size, self.source.options.wrap, self.patches);
                check_tiles(cells, self.tiles).map_err(tiles_fault)?;
            }
            None => {}
        }
        if self.is_textured() && self.paint.is_some() {
            return Err(Fault::new(
                "scene.texture",
                "scene.paint colours the surface already; set paint = \"height\"",
            ));
        }
        Ok(())
    }

    /// Whether the heights come from a file.
    pub fn reads_heights(&self) -> bool {
        PatternSpec::read(&self.source.field).is_none()
    }

    /// Whether the cone map comes from a file.
    pub fn reads_cones(&self) -> bool {
        self.tracer_settings.map != "auto" && self.tracer_settings.generator().is_none()
    }

    /// Whether a picture colours it.
    pub fn is_textured(&self) -> bool {
        self.texture != NO_TEXTURE
    }

    /// The named files, each with the key that names it.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        let named = [
            (self.reads_heights(), "scene.field", &self.source.field),
            (self.reads_cones(), "scene.map", &self.tracer_settings.map),
            (self.is_textured(), "scene.texture", &self.texture),
        ];
        let file =
            |(read, key, name): (bool, _, _)| read.then(|| (key, self.source.folder.join(name)));
        named.into_iter().filter_map(file).collect()
    }

    /// The generators of the cone maps that it needs: the tracer's and the paint's.
    pub fn generators(&self) -> Vec<Generator> {
        let traced = self.tracer_settings.generator();
        let painted = self.paint.filter(|by| traced != Some(*by));
        traced.into_iter().chain(painted).collect()
    }

    /// The place of a block of so many texels.
    pub fn placement(&self, sides: DVec2) -> Placement {
        Placement::new(sides, self.width, self.depth, self.centre, self.turn)
    }

    /// The same heightfield without what only colours need.
    pub fn colorless(&self) -> Self {
        Self {
            paint: None,
            texture: NO_TEXTURE.into(),
            ..self.clone()
        }
    }

    /// The same heightfield with a tracer that finds every first hit and needs no cone map.
    pub fn exact(&self) -> Self {
        Self {
            tracer_settings: TracerSettings {
                tracer: TracerKind::exact_without_map(),
                offset: self.tracer_settings.offset,
                ..TracerSettings::default()
            },
            ..self.clone()
        }
    }
}
