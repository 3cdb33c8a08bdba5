//! Assets: the heights, cone maps and textures that a heightfield needs.
//!
//! Heights and cone maps take long to make. [`Assets`] loads or makes each of them once, and
//! keeps the last one of each kind until its settings change. Clones share what is kept.

use std::path::PathBuf;
use std::sync::Arc;

use bytemuck::cast_slice;
use glam::DVec2;

use crate::base::key::Fault;
use crate::base::one_value_cache::{OneValueCache, is_last, last_or_new, snapshot};
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, ShareWatch};
use crate::heightfield::load::PatternSpec;
use crate::heightfield::paint::{Colors, Paint};
use crate::heightfield::tracer::settings::{
    Make, PrepareError, TracerCones, on_cpu, without_cones,
};
use crate::heightfield::tracer::{Tracer, TracerKind};
use crate::heightfield::{
    HeightSurface, Patches, height_surface::HeightSurfaceError, placement::Placement,
    settings::HeightfieldSettings, source::Source, texture::Texture,
};

/// What decides a surface.
type SurfaceKey = (Source, Patches, [u32; 2]);
/// What decides a tracer's cones: surface, tracer, map and offset.
type ConesKey = (SurfaceKey, TracerKind, String, f64);
/// What decides a paint: surface, generator and offset.
type PaintKey = (SurfaceKey, Generator, f64);

/// What decides all that a heightfield loads and makes.
#[derive(Clone, Debug, PartialEq)]
pub struct AssetKeys {
    surface: SurfaceKey,
    cones: Option<ConesKey>,
    paint: Option<PaintKey>,
    texture: Option<PathBuf>,
}

impl AssetKeys {
    /// Those of a heightfield.
    pub fn of(settings: &HeightfieldSettings) -> Self {
        let needs_map = settings.tracer_settings.kind().needs_map();
        let texture = || settings.source.folder.join(&settings.texture);
        Self {
            surface: surface_key(settings),
            cones: needs_map.then(|| cones_key(settings)),
            paint: settings.paint.map(|by| paint_key(settings, by)),
            texture: settings.is_textured().then(texture),
        }
    }
}

/// Loaded heights, made cone maps and read textures.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    surfaces: OneValueCache<SurfaceKey, Ground>,
    cones: OneValueCache<ConesKey, Option<TracerCones>>,
    paints: OneValueCache<PaintKey, Paint>,
    textures: OneValueCache<PathBuf, Texture>,
}

/// A surface, and a note about the file of its heights.
#[derive(Debug)]
struct Ground {
    surface: Arc<HeightSurface>,
    note: Option<String>,
}

/// A cone map that is made before the first pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preparation {
    /// Its generator.
    pub generator: Generator,
    /// Places of the map along each axis.
    pub places: [u32; 2],
}

/// A heightfield with all assets.
#[derive(Clone, Debug)]
pub struct Ready {
    /// Heights, and the pyramid of their maxima.
    pub surface: Arc<HeightSurface>,
    /// The tracer of rays, with its cones.
    pub tracer: Arc<Tracer>,
    /// What picks the colours.
    pub colors: Colors,
    /// The place in the world.
    pub placement: Placement,
    /// The tracer's kind.
    pub kind: TracerKind,
    /// The most steps that a ray can take.
    pub most_steps: u32,
}

impl Assets {
    /// What is there now. What others make and drop does not change it. What others are making is
    /// left out, unless this may wait for them.
    #[must_use]
    pub fn snapshot(&self, may_wait: bool) -> Self {
        Self {
            surfaces: snapshot(&self.surfaces, may_wait),
            cones: snapshot(&self.cones, may_wait),
            paints: snapshot(&self.paints, may_wait),
            textures: snapshot(&self.textures, may_wait),
        }
    }

    /// Reads the named files and checks that they fit together. Patterns are made later, as
    /// they cannot fail.
    ///
    /// # Errors
    /// A file cannot be read, has other contents, or does not fit.
    pub fn load(&self, settings: &HeightfieldSettings) -> Result<(), Fault> {
        if settings.reads_heights() {
            self.surface(settings)?;
        }
        self.texture(settings)?;
        if settings.reads_cones() {
            let surface = self.surface(settings)?;
            match self.cones(settings, &surface, &mut on_cpu) {
                Ok(cones) => {
                    settings
                        .tracer_settings
                        .tracer(&surface, (*cones).as_ref(), 0.0)?;
                }
                Err(PrepareError::Fault(fault)) => return Err(fault),
                // No generator runs for a map that is read.
                Err(PrepareError::Generate(_)) => {}
            }
        }
        Ok(())
    }

    /// Makes the heights of a pattern, or loads those of a file.
    ///
    /// # Errors
    /// A file does not fit, or `watch` returns `false`; it is told the share that is made.
    pub fn make_heights(
        &self,
        settings: &HeightfieldSettings,
        watch: ShareWatch<'_>,
    ) -> Result<(), PrepareError> {
        let mut goes_on = true;
        let made = self.ground(settings, &mut |share| {
            goes_on = watch(share);
            goes_on
        });
        if !goes_on {
            return Err(GenerateError::Cancelled.into());
        }
        Ok(made.map(|_| ())?)
    }

    /// Makes the cone maps by `make`.
    ///
    /// # Errors
    /// A file does not fit, or `make` fails.
    pub fn prepare(
        &self,
        settings: &HeightfieldSettings,
        make: Make<'_>,
    ) -> Result<(), PrepareError> {
        let surface = self.surface(settings)?;
        self.cones(settings, &surface, make)?;
        self.paint(settings, &surface, make).map(|_| ())
    }

    /// Whether everything is loaded and made. It never waits for a thread that does it.
    pub fn has(&self, settings: &HeightfieldSettings) -> bool {
        let keys = AssetKeys::of(settings);
        is_last(&self.surfaces, &keys.surface)
            && keys.cones.is_none_or(|key| is_last(&self.cones, &key))
            && keys.paint.is_none_or(|key| is_last(&self.paints, &key))
            && keys.texture.is_none_or(|key| is_last(&self.textures, &key))
    }

    /// All assets of a heightfield. Cone maps that were not prepared are made on the CPU.
    /// `grain` is half a pixel's width at distance 1, where pixels are finest.
    ///
    /// # Errors
    /// As [`Assets::prepare`].
    pub fn ready(&self, settings: &HeightfieldSettings, grain: f64) -> Result<Ready, PrepareError> {
        self.assembled(settings, grain, &mut on_cpu)
    }

    /// As [`Assets::ready`], with empty maps in place of maps that a generator makes. The
    /// programs are the same.
    ///
    /// # Errors
    /// As [`Assets::load`].
    pub fn outline(
        &self,
        settings: &HeightfieldSettings,
        grain: f64,
    ) -> Result<Ready, PrepareError> {
        let without_maps = Self {
            cones: OneValueCache::default(),
            paints: OneValueCache::default(),
            ..self.clone()
        };
        without_maps.assembled(settings, grain, &mut without_cones)
    }

    /// The cone maps that a generator makes; none if the heights cannot be loaded.
    pub fn preparations(&self, settings: &HeightfieldSettings) -> Vec<Preparation> {
        let one = |generator| {
            let places = self.places(settings, generator)?;
            Some(Preparation { generator, places })
        };
        settings.generators().into_iter().filter_map(one).collect()
    }

    /// Notes about the named files: what was ignored in them, and what could not be checked.
    pub fn notes(&self, settings: &HeightfieldSettings) -> Vec<String> {
        let mut notes = Vec::new();
        // Errors here are reported where the files are needed. No pattern is made only for notes.
        if (settings.reads_heights() || settings.reads_cones())
            && let Ok(ground) = self.ground(settings, &mut |_| true)
        {
            notes.extend(ground.note.clone());
            if settings.reads_cones()
                && let Ok(cones) = self.cones(settings, &ground.surface, &mut on_cpu)
            {
                notes.extend(cones.iter().filter_map(|s| s.note.clone()));
            }
        }
        if let Ok(Some(texture)) = self.texture(settings) {
            let path = settings.source.folder.join(&settings.texture);
            let note = texture.note();
            notes.extend(note.map(|note| format!("{} {note}", path.display())));
        }
        notes
    }

    /// The numbers in the named files of heights and colours.
    pub fn contents(&self, settings: &HeightfieldSettings) -> Vec<u8> {
        let mut all = Vec::new();
        if settings.reads_heights()
            && let Ok(surface) = self.surface(settings)
        {
            let heights = surface.heights();
            all.extend_from_slice(cast_slice(&heights.size()));
            all.extend_from_slice(cast_slice(heights.data()));
        }
        if let Ok(Some(texture)) = self.texture(settings) {
            all.extend(texture.bytes());
        }
        all
    }

    fn assembled(
        &self,
        settings: &HeightfieldSettings,
        grain: f64,
        make: Make<'_>,
    ) -> Result<Ready, PrepareError> {
        let surface = self.surface(settings)?;
        let cones = self.cones(settings, &surface, &mut *make)?;
        let paint = self.paint(settings, &surface, make)?;
        let domain = surface.domain();
        let [w, h] = domain.map(f64::from);
        let placement = settings.placement(DVec2::new(w, h));
        let pixel = placement.texel / (2.0 * grain);
        let colors = match (paint, self.texture(settings)?) {
            (Some(paint), _) => Colors::Cones(paint),
            (None, Some(texture)) => Colors::Texture(texture),
            (None, None) => Colors::Height,
        };
        Ok(Ready {
            tracer: settings
                .tracer_settings
                .tracer(&surface, (*cones).as_ref(), pixel)?,
            colors,
            placement,
            surface,
            kind: settings.tracer_settings.kind(),
            most_steps: settings
                .tracer_settings
                .most_steps(domain.map(i32::unsigned_abs)),
        })
    }

    /// The samples of the heights along each axis. Those of a file are loaded.
    pub fn samples(&self, settings: &HeightfieldSettings) -> Option<[u32; 2]> {
        // The size of a pattern is known before its heights are made.
        match PatternSpec::read(&settings.source.field) {
            Some(pattern) => Some(pattern.ok()?.size),
            None => Some(self.surface(settings).ok()?.heights().size()),
        }
    }

    /// Places of a generator's map along each axis.
    fn places(&self, settings: &HeightfieldSettings, generator: Generator) -> Option<[u32; 2]> {
        let size = self.samples(settings)?;
        let kind = generator.kind();
        Some(kind.places(size, settings.source.options.wrap, settings.patches))
    }

    fn surface(&self, settings: &HeightfieldSettings) -> Result<Arc<HeightSurface>, Fault> {
        Ok(self.ground(settings, &mut |_| true)?.surface.clone())
    }

    fn ground(
        &self,
        settings: &HeightfieldSettings,
        watch: ShareWatch<'_>,
    ) -> Result<Arc<Ground>, Fault> {
        let make = |(source, patches, tiles): &SurfaceKey| {
            let loaded = source.load(watch)?;
            let made = HeightSurface::new(loaded.heights, *patches, *tiles);
            Ok(Ground {
                surface: Arc::new(made.map_err(tiles_fault)?),
                note: loaded.note,
            })
        };
        last_or_new(&self.surfaces, surface_key(settings), make)
    }

    fn texture(&self, settings: &HeightfieldSettings) -> Result<Option<Arc<Texture>>, Fault> {
        if !settings.is_textured() {
            return Ok(None);
        }
        let path = settings.source.folder.join(&settings.texture);
        let read = last_or_new(&self.textures, path, |path| Texture::read(path));
        read.map(Some)
            .map_err(|why| Fault::new("scene.texture", why))
    }

    fn cones(
        &self,
        settings: &HeightfieldSettings,
        surface: &HeightSurface,
        make: Make<'_>,
    ) -> Result<Arc<Option<TracerCones>>, PrepareError> {
        // The map of another tracer stays.
        if !settings.tracer_settings.kind().needs_map() {
            return Ok(Arc::new(None));
        }
        last_or_new(&self.cones, cones_key(settings), |_| {
            let folder = &settings.source.folder;
            settings.tracer_settings.cones(surface, folder, make)
        })
    }

    fn paint(
        &self,
        settings: &HeightfieldSettings,
        surface: &HeightSurface,
        make: Make<'_>,
    ) -> Result<Option<Arc<Paint>>, PrepareError> {
        let Some(by) = settings.paint else {
            return Ok(None);
        };
        let tracing = &settings.tracer_settings;
        let made = last_or_new(
            &self.paints,
            paint_key(settings, by),
            |_| -> Result<_, PrepareError> {
                if tracing.generator() == Some(by)
                    && let Some(cones) = &*self.cones(settings, surface, make)?
                {
                    return Ok(Paint::new(cones.map()));
                }
                Ok(Paint::new(&tracing.made(by, surface, make)?))
            },
        );
        made.map(Some)
    }
}

fn surface_key(settings: &HeightfieldSettings) -> SurfaceKey {
    (settings.source.clone(), settings.patches, settings.tiles)
}

fn cones_key(settings: &HeightfieldSettings) -> ConesKey {
    let t = &settings.tracer_settings;
    (surface_key(settings), t.kind(), t.map.clone(), t.offset)
}

fn paint_key(settings: &HeightfieldSettings, by: Generator) -> PaintKey {
    (surface_key(settings), by, settings.tracer_settings.offset)
}

/// A fault of `scene.tiles`.
pub(super) fn tiles_fault(e: HeightSurfaceError) -> Fault {
    Fault::new("scene.tiles", e.to_string())
}
