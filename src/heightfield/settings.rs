//! The settings of a heightfield: its heights, its place in the world, and how it is traced.

use std::path::PathBuf;

use glam::{DVec2, DVec3};

use crate::base::key::{Fault, counts, number, text, triple, word};
use crate::heightfield::conemap::generate::Generator;
use crate::heightfield::load::PatternSpec;
use crate::heightfield::tracer::{TracerKind, settings::TracerSettings};
use crate::heightfield::{
    Normals, Patches, assets::tiles_fault, height_surface::check_tiles, heights::cells,
    paint::PAINTS, placement::Placement,
};
use crate::settings;

pub use super::source::Source;

/// The value of `texture` for none.
const NO_TEXTURE: &str = "none";

settings! {
    /// A heightfield: heights, their place in the world, and how they are traced.
    pub struct HeightfieldSettings {
        /// Where its heights come from.
        ..source: Source;
        patches as "surface": Patches = Patches::Bilinear, word(&Patches::WORDS),
            "the surface between the samples: a bilinear patch over each cell, or each sample as a flat box" => Assets;
        normals: Normals = Normals::Patches, word(&Normals::WORDS),
            "what light sees of a bilinear surface: its patches, or a smooth surface through its samples; hits stay the same, and boxes stay flat" => Program;
        tiles: [u32; 2] = [1, 1], counts(1, 256),
            "number of copies of the map along x and y; more than 1 only where the map wraps, and at most 65536 cells in all along each" => Assets;
        width: f64 = 12.0, number(1e-6, 1e6),
            "world length of the block's longer side";
        depth: f64 = 2.0, number(1e-6, 1e6),
            "world length of the height 1";
        centre: DVec3 = DVec3::ZERO, triple(-1e6, 1e6),
            "the middle of the block's base";
        turn: DVec3 = DVec3::ZERO, triple(-36e3, 36e3),
            "rotation in degrees about x, then y, then z";
        paint: Option<Generator> = None, word(PAINTS),
            "what picks the colour from the palette: the height, or the width of the cones that this generator makes" => Assets;
        texture: String = NO_TEXTURE.into(), text(),
            "a PNG, JPEG or WebP that colours each tile in place of the palette, only with paint = \"height\"; \"none\" for none" => Assets;
        /// How rays are traced.
        ..tracer_settings: TracerSettings;
    }
}

impl HeightfieldSettings {
    /// Checks that all settings fit together. No file is read.
    pub fn check(&self) -> Result<(), Fault> {
        self.tracer_settings.check()?;
        // The size of a file's heights is checked when they are loaded.
        let pattern = PatternSpec::read(&self.source.field).transpose();
        let pattern = pattern.map_err(|why| Fault::new("scene.field", why))?;
        let wrap = self.source.options.wrap;
        let cells = pattern.map_or([1, 1], |p| cells(p.size, wrap, self.patches));
        check_tiles(cells, wrap, self.tiles).map_err(tiles_fault)?;
        Fault::unless(
            !self.is_textured() || self.paint.is_none(),
            "scene.texture",
            "scene.paint colours the surface already; set paint = \"height\"",
        )
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
        let path = |(reads, name): (bool, &String)| reads.then(|| self.source.folder.join(name));
        let heights = path((self.reads_heights(), &self.source.field));
        let texture = path((self.is_textured(), &self.texture));
        let named = [
            ("scene.field", heights),
            ("scene.map", self.map_file()),
            ("scene.texture", texture),
        ];
        let there = named
            .into_iter()
            .filter_map(|(key, path)| Some((key, path?)));
        there.collect()
    }

    /// The names of the files, as the preset has them.
    pub fn file_names(&mut self) -> Vec<&mut String> {
        let read = [self.reads_heights(), self.reads_cones(), self.is_textured()];
        let names = [
            &mut self.source.field,
            &mut self.tracer_settings.map,
            &mut self.texture,
        ];
        let named = read.into_iter().zip(names).filter(|(read, _)| *read);
        named.map(|(_, name)| name).collect()
    }

    /// The file of the cone map, if one is named.
    pub fn map_file(&self) -> Option<PathBuf> {
        let name = &self.tracer_settings.map;
        self.reads_cones().then(|| self.source.folder.join(name))
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

    /// Whether the tracer is free to do without a cone map that nothing else needs.
    pub fn may_drop_map(&self) -> bool {
        let tracing = &self.tracer_settings;
        tracing.tracer.is_none() && tracing.map == "auto" && tracing.generator() != self.paint
    }

    /// The same heightfield with a tracer that finds every first hit and needs no cone map.
    pub fn exact(&self) -> Self {
        Self {
            tracer_settings: TracerSettings {
                tracer: Some(TracerKind::exact_without_map()),
                offset: self.tracer_settings.offset,
                ..TracerSettings::default()
            },
            ..self.clone()
        }
    }
}
