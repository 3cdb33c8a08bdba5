//! A heightfield as a preset says it: heights, where they lie in the world, and how they are
//! traced.

use std::path::PathBuf;
use std::sync::Arc;

use bytemuck::cast_slice;
use glam::{DVec2, DVec3};

use crate::base::key::{Counts, Fault, Key, Number, Text, Triple, Word};
use crate::heightfield::cache::Cache;
use crate::heightfield::conemap::generate::generator::Generator;
use crate::heightfield::height_surface::{HeightSurface, HeightSurfaceError, MOST_CELLS};
use crate::heightfield::heights::{Patches, cells};
use crate::heightfield::load::PatternSpec;
use crate::heightfield::paint::{Colors, PAINTS, Paint};
use crate::heightfield::placement::Placement;
use crate::heightfield::texture::Texture;
use crate::heightfield::tracer::settings::{
    Make, PrepareError, Supply, TracerSettings, on_cpu, without_cones,
};
use crate::heightfield::tracer::{Tracer, TracerKind};

pub use crate::heightfield::source::{Source, Wrap};

/// What the key of the texture says where there is none.
const NO_TEXTURE: &str = "none";

/// What a relief is made from.
type ReliefKey = (Source, Patches, [u32; 2]);
/// What a cone map is made from, beside: tracer, map and offset.
type MapKey = (ReliefKey, TracerKind, String, f64);
/// What a paint is made from: a generator's map, with an offset.
type PaintKey = (ReliefKey, Generator, f64);

/// A heightfield: heights, their place in the world, and how they are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightfieldSettings {
    /// What its heights are made from.
    pub source: Source,
    /// What lies between the samples.
    pub patches: Patches,
    /// How often the map is repeated along wrapping axes.
    pub tiles: [u32; 2],
    /// Length of the longer side of the block, all tiles together.
    pub width: f64,
    /// Length of the whole height.
    pub depth: f64,
    /// The middle of the base.
    pub centre: DVec3,
    /// Degrees about x, then y, then z.
    pub turn: DVec3,
    /// How rays are traced.
    pub tracing: TracerSettings,
    /// Whose cones it is painted by; `None` by its height.
    pub paint: Option<Generator>,
    /// The path of a picture that colours it instead; `none` for none.
    pub texture: String,
    reliefs: Cache<ReliefKey, Ground>,
    maps: Cache<MapKey, Option<Supply>>,
    paints: Cache<PaintKey, Paint>,
    textures: Cache<PathBuf, Texture>,
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
            tracing: TracerSettings::default(),
            paint: None,
            texture: NO_TEXTURE.into(),
            reliefs: Cache::default(),
            maps: Cache::default(),
            paints: Cache::default(),
            textures: Cache::default(),
        }
    }
}

/// A relief with what is to be told of the file that its heights are from.
#[derive(Clone, Debug)]
struct Ground {
    relief: Arc<HeightSurface>,
    note: Option<String>,
}

/// A heightfield made ready.
#[derive(Clone, Debug)]
pub struct Ready {
    /// Heights and maxima.
    pub relief: Arc<HeightSurface>,
    /// What traces rays, with its cones.
    pub tracer: Arc<dyn Tracer>,
    /// What colours it.
    pub colors: Colors,
    /// Where it stands.
    pub placed: Placement,
    /// The tracer's name.
    pub name: &'static str,
}

impl HeightfieldSettings {
    /// The keys that a heightfield reads in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        let mut keys = self.source.keys();
        keys.extend([
            Key::new(
                "surface",
                Word(
                    &mut self.patches,
                    &[("bilinear", Patches::Bilinear), ("boxes", Patches::Boxes)],
                ),
                "what lies between the samples",
            ),
            Key::new(
                "tiles",
                Counts(&mut self.tiles, 1, 256),
                "how often the map is repeated along x and y",
            ),
            Key::new(
                "width",
                Number(&mut self.width, 1e-6, 1e6),
                "length of the block's longer side",
            ),
            Key::new(
                "depth",
                Number(&mut self.depth, 1e-6, 1e6),
                "length of the whole height",
            ),
            Key::new(
                "centre",
                Triple(&mut self.centre, -1e6, 1e6),
                "the middle of the block's base",
            ),
            Key::new(
                "turn",
                Triple(&mut self.turn, -360.0, 360.0),
                "degrees that the block is turned by about x, then y, then z",
            ),
            Key::new(
                "paint",
                Word(&mut self.paint, PAINTS),
                "what picks the hue: the height, or how wide the cones of a generator's map are",
            ),
            Key::new(
                "texture",
                Text(&mut self.texture),
                "a PNG that colours each tile in place of the palette, a texel to a sample where sizes are the same; none for none",
            ),
        ]);
        keys.extend(self.tracing.keys());
        keys
    }

    /// Whether all settings fit together. Files that are named are read.
    pub fn check(&self) -> Result<(), Fault> {
        self.tracing.check()?;
        for (axis, name) in [(0, "x"), (1, "y")] {
            if self.tiles[axis] > 1 && !self.source.wrap.axes()[axis] {
                return Err(Fault::new(
                    "scene.tiles",
                    format!(
                        "the map is repeated along {name}, where it does not wrap; wrap = \"xy\" would do"
                    ),
                ));
            }
        }
        match PatternSpec::read(&self.source.field) {
            Some(Err(why)) => return Err(Fault::new("scene.field", why)),
            // Heights by name are made when they are needed, and never fail.
            Some(Ok(named)) => self.check_tiles(named.size)?,
            None => drop(self.relief()?),
        }
        if self.is_textured() && self.paint.is_some() {
            return Err(Fault::new(
                "scene.texture",
                "cones paint the relief already (scene.paint); paint = \"height\" would do",
            ));
        }
        self.textured()?;
        if self.tracing.map != "auto" && self.tracing.generator().is_none() {
            let relief = self.relief()?;
            match self.cones(&relief, &mut on_cpu) {
                Ok(supply) => {
                    self.tracing.tracer(&relief, (*supply).as_ref(), 0.0)?;
                }
                Err(PrepareError::Fault(fault)) => return Err(fault),
                // Nothing is generated for a map that is read.
                Err(PrepareError::Generate(_)) => {}
            }
        }
        Ok(())
    }

    /// That so many tiles of heights of a size are not too many cells, which
    /// [`HeightSurface::new`] says of heights that are there.
    fn check_tiles(&self, samples: [u32; 2]) -> Result<(), Fault> {
        let cells = cells(samples, self.source.wrap.axes(), self.patches);
        for axis in 0..2 {
            let (cells, tiles) = (cells[axis], self.tiles[axis]);
            if u64::from(cells) * u64::from(tiles) > u64::from(MOST_CELLS) {
                return Err(of_tiles(&HeightSurfaceError::Tiles { axis, cells, tiles }));
            }
        }
        Ok(())
    }

    /// The files that it names, each with the key that does.
    pub fn files(&self) -> Vec<(&'static str, PathBuf)> {
        let heights = PatternSpec::read(&self.source.field).is_none();
        let map = self.tracing.map != "auto" && self.tracing.generator().is_none();
        let named = [
            (heights, "scene.field", &self.source.field),
            (map, "scene.map", &self.tracing.map),
            (self.is_textured(), "scene.texture", &self.texture),
        ];
        let given = named.into_iter().filter(|(is, ..)| *is);
        given
            .map(|(_, key, name)| (key, self.source.folder.join(name)))
            .collect()
    }

    /// What is to be told of the files that it names: what was left out of them, and what
    /// is taken on trust. Each with the file's name.
    pub fn notes(&self) -> Vec<String> {
        let from_file = PatternSpec::read(&self.source.field).is_none();
        let traced = self.tracing.map != "auto" && self.tracing.generator().is_none();
        if !from_file && !traced && !self.is_textured() {
            return Vec::new();
        }
        // What fails here fails again, with a sentence, where it is needed.
        let Ok(ground) = self.ground() else {
            return Vec::new();
        };
        let mut notes = Vec::from_iter(ground.note.clone());
        if traced && let Ok(supply) = self.cones(&ground.relief, &mut on_cpu) {
            notes.extend(supply.iter().filter_map(|s| s.note.clone()));
        }
        if let Ok(Some(texture)) = self.textured() {
            let path = self.source.folder.join(&self.texture);
            let note = texture.note();
            notes.extend(note.map(|note| format!("{} {note}", path.display())));
        }
        notes
    }

    /// Makes what takes long, which is kept until it changes.
    ///
    /// # Errors
    /// Heights that are none, cones that do not fit, and what `make` fails with.
    pub fn prepare(&self, make: Make<'_>) -> Result<(), PrepareError> {
        let relief = self.relief()?;
        self.cones(&relief, make)?;
        self.painted(&relief, make).map(|_| ())
    }

    /// Everything that a scene needs; on the CPU where it was not prepared. `grain` is half a
    /// pixel's width at distance 1, where pixels are finest.
    ///
    /// # Errors
    /// Heights that are none, cones that do not fit.
    pub fn ready(&self, grain: f64) -> Result<Ready, PrepareError> {
        let relief = self.relief()?;
        let cones = self.cones(&relief, &mut on_cpu)?;
        let paint = self.painted(&relief, &mut on_cpu)?;
        self.assembled(relief, (*cones).as_ref(), paint, grain)
    }

    /// What [`HeightfieldSettings::ready`] gives, with maps of no cones in place of those
    /// that would have to be made: its programs are the same.
    ///
    /// # Errors
    /// As [`HeightfieldSettings::ready`].
    pub fn outline(&self, grain: f64) -> Result<Ready, PrepareError> {
        let relief = self.relief()?;
        let cones = self
            .tracing
            .cones(&relief, &self.source.folder, &mut without_cones)?;
        let paint = |by| -> Result<_, PrepareError> {
            let map = self.tracing.made(by, &relief, &mut without_cones)?;
            Ok(Arc::new(Paint::new(&map)))
        };
        let paint = self.paint.map(paint).transpose()?;
        self.assembled(relief, cones.as_ref(), paint, grain)
    }

    fn assembled(
        &self,
        relief: Arc<HeightSurface>,
        cones: Option<&Supply>,
        paint: Option<Arc<Paint>>,
        grain: f64,
    ) -> Result<Ready, PrepareError> {
        let [w, h] = relief.domain().map(f64::from);
        let sides = DVec2::new(w, h);
        let placed = Placement::new(sides, self.width, self.depth, self.centre, self.turn);
        let pixel = placed.texel / (2.0 * grain);
        let colors = match (paint, self.textured()?) {
            (Some(paint), _) => Colors::Cones(paint),
            (None, Some(texture)) => Colors::Texture(texture),
            (None, None) => Colors::Height,
        };
        Ok(Ready {
            tracer: self.tracing.tracer(&relief, cones, pixel)?,
            colors,
            placed,
            relief,
            name: self.tracing.tracer.name(),
        })
    }

    /// Whose maps it needs: its tracer's, and the one that it is painted by.
    pub fn generators(&self) -> Vec<Generator> {
        let traced = self.tracing.generator();
        let painted = self.paint.filter(|by| traced != Some(*by));
        traced.into_iter().chain(painted).collect()
    }

    /// Places of a generator's map along each axis; `None` where there are no heights.
    pub fn places(&self, generator: Generator) -> Option<[u32; 2]> {
        // What is made by name need not be made to know how large it is.
        let size = match PatternSpec::read(&self.source.field) {
            Some(named) => named.ok()?.size,
            None => self.relief().ok()?.heights().size(),
        };
        Some(if generator.over_cells() {
            cells(size, self.source.wrap.axes(), self.patches)
        } else {
            size
        })
    }

    /// The most steps that a ray can take; `None` where there are no heights. A tracer that
    /// counts its own and stops says so itself.
    pub fn crossing(&self) -> Option<u32> {
        let [w, h] = self.relief().ok()?.domain().map(i32::unsigned_abs);
        Some(self.tracing.most_steps(w + h))
    }

    /// The numbers of its files' heights and colours; none of a field, whose word says
    /// everything.
    pub fn contents(&self) -> Vec<u8> {
        let mut all = Vec::new();
        if PatternSpec::read(&self.source.field).is_none()
            && let Ok(relief) = self.relief()
        {
            all.extend_from_slice(cast_slice(relief.heights().data()));
        }
        if let Ok(Some(texture)) = self.textured() {
            all.extend(texture.buffer().1);
        }
        all
    }

    /// Whether a picture colours it.
    pub fn is_textured(&self) -> bool {
        self.texture != NO_TEXTURE
    }

    /// The same block, without what only colours are picked by.
    pub fn colorless(&self) -> Self {
        Self {
            paint: None,
            texture: NO_TEXTURE.into(),
            ..self.clone()
        }
    }

    fn textured(&self) -> Result<Option<Arc<Texture>>, Fault> {
        if !self.is_textured() {
            return Ok(None);
        }
        let path = self.source.folder.join(&self.texture);
        let read = self.textures.get(path, |path| Texture::read(path));
        read.map(Some)
            .map_err(|why| Fault::new("scene.texture", why))
    }

    /// The same block, every first hit found: by a tracer that needs no cones.
    pub fn exact(&self) -> Self {
        let mut exact = self.clone();
        exact.tracing = TracerSettings {
            tracer: TracerKind::MaxMip,
            offset: self.tracing.offset,
            ..TracerSettings::default()
        };
        exact
    }

    fn relief_key(&self) -> ReliefKey {
        (self.source.clone(), self.patches, self.tiles)
    }

    fn relief(&self) -> Result<Arc<HeightSurface>, Fault> {
        Ok(self.ground()?.relief.clone())
    }

    fn ground(&self) -> Result<Arc<Ground>, Fault> {
        self.reliefs
            .get(self.relief_key(), |(source, patches, tiles)| {
                let loaded = source.load()?;
                let made = HeightSurface::new(loaded.heights, *patches, *tiles);
                Ok(Ground {
                    relief: Arc::new(made.map_err(|e| of_tiles(&e))?),
                    note: loaded.note,
                })
            })
    }

    fn cones(
        &self,
        relief: &HeightSurface,
        make: Make<'_>,
    ) -> Result<Arc<Option<Supply>>, PrepareError> {
        let t = &self.tracing;
        let key = (self.relief_key(), t.tracer, t.map.clone(), t.offset);
        self.maps
            .get(key, |_| t.cones(relief, &self.source.folder, make))
    }

    fn painted(
        &self,
        relief: &HeightSurface,
        make: Make<'_>,
    ) -> Result<Option<Arc<Paint>>, PrepareError> {
        let Some(by) = self.paint else {
            return Ok(None);
        };
        let key = (self.relief_key(), by, self.tracing.offset);
        let made = self.paints.get(key, |_| -> Result<_, PrepareError> {
            if self.tracing.generator() == Some(by)
                && let Some(supply) = &*self.cones(relief, make)?
            {
                return Ok(Paint::new(&supply.map));
            }
            Ok(Paint::new(&self.tracing.made(by, relief, make)?))
        });
        made.map(Some)
    }
}

/// A fault of tiles.
fn of_tiles(e: &HeightSurfaceError) -> Fault {
    Fault::new("scene.tiles", e.to_string())
}
