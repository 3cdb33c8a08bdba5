//! How a preset says by which tracer a heightfield is traced, and with which cones.

use std::path::Path;
use std::sync::Arc;

use thiserror::Error;

use crate::base::key::{AutoCount, AutoNumber, Fault, Key, Number, Text, Word};
use crate::heightfield::conemap::file::{MapUse, read_map};
use crate::heightfield::conemap::generate::cpu::generate;
use crate::heightfield::conemap::generate::generator::{
    GenerateError, Generator, LEAST_OFFSET, MOST_OFFSET, Options,
};
use crate::heightfield::conemap::{ConeMap, MapKind};
use crate::heightfield::height_surface::HeightSurface;
use crate::heightfield::heights::{Heights, Patches};
use crate::heightfield::tracer::cones::{Budget, Cones, Lookup, Manner};
use crate::heightfield::tracer::linear::LinearBinary;
use crate::heightfield::tracer::max_mip::MaxMipTracer;
use crate::heightfield::tracer::refine::Refine;
use crate::heightfield::tracer::relaxed::WalkRelaxed;
use crate::heightfield::tracer::walk::Walk;
use crate::heightfield::tracer::walk_mip::{NodeCones, WalkMip, node_cones};
use crate::heightfield::tracer::{AnyTracer, TraceError};

/// Steps of `linear-binary` where none are given (Policarpo, Oliveira, Comba 2005).
const LINEAR_STEPS: u32 = 32;
/// Halvings after them.
const LINEAR_ROUNDS: u32 = 6;
/// Most steps of its own that a tracer may be given, as many as shadows have at most, and most
/// rounds of refinement.
const MOST_STEPS: u32 = 2048;
const MOST_ROUNDS: u32 = 32;

/// Makes cones, on the CPU or on a device.
pub type Make<'a> =
    &'a mut dyn FnMut(Generator, &Heights, Patches, &Options) -> Result<ConeMap, GenerateError>;

/// Makes cones on the CPU, to the end.
pub fn on_cpu(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> Result<ConeMap, GenerateError> {
    generate(generator, heights, patches, options, &mut |_| true)
}

/// Makes a map of the right kind and size that lets no ray go anywhere, at once.
pub(crate) fn without_cones(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> Result<ConeMap, GenerateError> {
    let size = if generator.over_cells() {
        heights.cells(patches)
    } else {
        heights.size()
    };
    let places = size[0] as usize * size[1] as usize;
    Ok(ConeMap {
        kind: generator.kind(),
        size,
        wrap: heights.wrap(),
        ratios: vec![0.0; places * generator.channels()],
        offset: if generator.over_cells() {
            options.offset
        } else {
            0.0
        },
    })
}

/// Why a heightfield cannot be made ready.
#[derive(Debug, Error)]
pub enum PrepareError {
    /// Settings, or files that they name.
    #[error("{}: {}", .0.key, .0.why)]
    Fault(Fault),
    /// Its cones could not be made.
    #[error(transparent)]
    Generate(#[from] GenerateError),
}

impl From<Fault> for PrepareError {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// Cones to trace by.
#[derive(Clone, Debug)]
pub struct Supply {
    /// The map.
    pub map: Arc<ConeMap>,
    /// The cones of nodes, for the tracer that steps by them.
    pub nodes: Option<NodeCones>,
    /// What is taken on trust of a file; with the file's name.
    pub note: Option<String>,
}

impl From<ConeMap> for Supply {
    fn from(map: ConeMap) -> Self {
        Self {
            map: Arc::new(map),
            nodes: None,
            note: None,
        }
    }
}

/// The tracers' names.
pub const TRACERS: &[(&str, &str)] = &[
    ("walk", "walk"),
    ("walk-relaxed", "walk-relaxed"),
    ("walk-mip", "walk-mip"),
    ("cone-mip", "cone-mip"),
    ("max-mip", "max-mip"),
    ("linear-binary", "linear-binary"),
    ("csm-exact", "csm-exact"),
    ("csm-loop", "csm-loop"),
    ("csm-fixed", "csm-fixed"),
    ("csm-scaled", "csm-scaled"),
    ("quad", "quad"),
    ("rcs-binary", "rcs-binary"),
    ("secant", "secant"),
];

/// How rays are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct TracerSettings {
    /// One of [`TRACERS`].
    pub tracer: &'static str,
    /// `auto`, a generator's name, or the file of a cone map.
    pub map: String,
    /// How ratios are read between samples.
    pub lookup: Lookup,
    /// Steps that the tracer has of its own, where it counts them.
    pub steps: Option<u32>,
    /// Rounds of its refinement.
    pub rounds: Option<u32>,
    /// Factor on the steps that cones give.
    pub stretch: Option<f64>,
    /// Distance at which `csm-loop` has half as many steps, and a texel is as wide as a pixel
    /// to `walk-mip` and `cone-mip`; 0 for never. Where none is given `csm-loop` never has
    /// fewer, and these go by the camera.
    pub lod: Option<f64>,
    /// Room that the walks' cones leave, in texels.
    pub offset: f64,
}

impl Default for TracerSettings {
    fn default() -> Self {
        Self {
            tracer: "walk",
            map: "auto".into(),
            lookup: Lookup::Bilinear,
            steps: None,
            rounds: None,
            stretch: None,
            lod: None,
            offset: Options::default().offset,
        }
    }
}

impl TracerSettings {
    /// The keys that a heightfield's tracer reads in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        vec![
            Key::new(
                "tracer",
                Word(&mut self.tracer, TRACERS),
                "how rays find the surface: walk, walk-relaxed and max-mip miss nothing, walk-mip and cone-mip are off by a pixel at most",
            ),
            Key::new(
                "map",
                Text(&mut self.map),
                "auto, a generator's name, or the file of a cone map",
            ),
            Key::new(
                "lookup",
                Word(
                    &mut self.lookup,
                    &[("bilinear", Lookup::Bilinear), ("nearest", Lookup::Nearest)],
                ),
                "how ratios are read between samples",
            ),
            Key::new(
                "tracer_steps",
                AutoCount(&mut self.steps, 1, MOST_STEPS),
                "steps of a tracer that counts its own",
            ),
            Key::new(
                "tracer_rounds",
                AutoCount(&mut self.rounds, 1, MOST_ROUNDS),
                "rounds of its refinement",
            ),
            Key::new(
                "stretch",
                AutoNumber(&mut self.stretch, 0.01, 100.0),
                "factor on the steps that cones give",
            ),
            Key::new(
                "lod",
                AutoNumber(&mut self.lod, 0.0, 1e6),
                "distance at which a texel is as wide as a pixel to walk-mip and cone-mip, and csm-loop has half its steps; 0 for never; auto goes by the camera for the first two and is never for csm-loop",
            ),
            Key::new(
                "offset",
                Number(&mut self.offset, LEAST_OFFSET, MOST_OFFSET),
                "room that the walks' cones leave, in texels, where they are made",
            ),
        ]
    }

    /// The manner of a tracer that steps by cones over samples, with the preset's numbers.
    fn manner(&self) -> Option<Manner> {
        let mut manner = Manner::ALL.into_iter().find(|m| m.name == self.tracer)?;
        manner.lookup = self.lookup;
        manner.scale = self.stretch.unwrap_or(manner.scale);
        manner.budget = match (manner.budget, self.steps) {
            (Budget::View { steps, .. }, own) => Budget::View {
                steps: own.unwrap_or(steps),
                lod: self.lod.unwrap_or(0.0),
            },
            (_, Some(steps)) => Budget::Fixed(steps),
            (budget, None) => budget,
        };
        manner.refine = match (manner.refine, self.rounds) {
            (Refine::Binary(_), Some(n)) => Refine::Binary(n),
            (Refine::Secant(_), Some(n)) => Refine::Secant(n),
            (refine, _) => refine,
        };
        Some(manner)
    }

    /// The equal steps of `linear-binary`.
    pub fn linear_steps(&self) -> u32 {
        self.steps.unwrap_or(LINEAR_STEPS)
    }

    /// Kinds of cones that the tracer can use, the one it makes itself first; none for a
    /// tracer without cones.
    fn kinds(&self) -> &'static [MapKind] {
        match self.tracer {
            "walk" | "walk-mip" | "cone-mip" => &[MapKind::Walk],
            "walk-relaxed" => &[MapKind::WalkRelaxed],
            _ => self.manner().map_or(&[], |m| m.kinds()),
        }
    }

    /// The generator whose cones are used; none where a file has them, or nobody.
    pub fn generator(&self) -> Option<Generator> {
        if self.map != "auto" {
            return Generator::named(&self.map);
        }
        let made = [
            Generator::Walk,
            Generator::WalkRelaxed,
            Generator::Exact,
            Generator::Quad,
            Generator::RelaxedExact,
        ];
        let first = self.kinds().first()?;
        made.into_iter().find(|g| g.kind() == *first)
    }

    /// Whether tracer and cones fit together, as far as names tell.
    pub fn check(&self) -> Result<(), Fault> {
        let kinds = self.kinds();
        if self.map == "auto" {
            return Ok(());
        }
        let fits = |generator: Generator| kinds.contains(&generator.kind());
        // What a file holds is asked when it is read, if anybody reads it.
        if self.generator().map_or(!kinds.is_empty(), fits) {
            return Ok(());
        }
        let fit = Generator::ALL.iter().filter(|g| kinds.contains(&g.kind()));
        let names: Vec<&str> = fit.map(|g| g.name()).collect();
        let why = if names.is_empty() {
            format!(
                "the tracer {} needs no cones; \"auto\" would do",
                self.tracer
            )
        } else {
            format!(
                "the tracer {} cannot use such cones; it can those of {}",
                self.tracer,
                names.join(", ")
            )
        };
        Err(Fault::new("scene.map", why))
    }

    /// The cones, made or read; none for a tracer that needs none.
    ///
    /// # Errors
    /// A file that holds no cones for this relief and tracer; what `make` fails with.
    pub fn cones(
        &self,
        relief: &HeightSurface,
        folder: &Path,
        make: Make<'_>,
    ) -> Result<Option<Supply>, PrepareError> {
        if self.kinds().is_empty() {
            return Ok(None);
        }
        let (heights, patches) = (relief.heights(), relief.patches());
        let mut supply = match self.generator() {
            Some(generator) => Supply::from(self.made(generator, relief, make)?),
            None => self.read(folder, heights, patches)?,
        };
        if self.tracer == "cone-mip" {
            let nodes = node_cones(relief, &supply.map).map_err(|e| fault(e.to_string()))?;
            supply.nodes = Some(nodes);
        }
        Ok(Some(supply))
    }

    /// The cones of a file.
    fn read(&self, folder: &Path, heights: &Heights, patches: Patches) -> Result<Supply, Fault> {
        let path = folder.join(&self.map);
        let file = read_map(&path).map_err(|e| fault(e.to_string()))?;
        let wanted = MapUse {
            who: &format!("the tracer {}", self.tracer),
            kinds: self.kinds(),
            heights,
            patches,
        };
        file.check_use(&path, &wanted)
            .map_err(|e| fault(e.to_string()))?;
        let note = file.unknown();
        Ok(Supply {
            note: note.map(|note| format!("{} {note}", path.display())),
            ..Supply::from(file.map)
        })
    }

    /// The cones of a generator.
    ///
    /// # Errors
    /// What `make` fails with.
    pub fn made(
        &self,
        generator: Generator,
        relief: &HeightSurface,
        make: Make<'_>,
    ) -> Result<ConeMap, GenerateError> {
        let options = Options {
            offset: self.offset,
            ..Options::default()
        };
        make(generator, relief.heights(), relief.patches(), &options)
    }

    /// The tracer itself. `pixel` is the distance from the eye at which a texel is as wide as
    /// a pixel.
    pub fn tracer(
        &self,
        relief: &Arc<HeightSurface>,
        cones: Option<&Supply>,
        pixel: f64,
    ) -> Result<AnyTracer, Fault> {
        let relief = relief.clone();
        let Some(Supply { map, nodes, .. }) = cones.cloned() else {
            return Ok(match self.tracer {
                "linear-binary" => AnyTracer::LinearBinary(LinearBinary::new(
                    relief,
                    self.linear_steps(),
                    self.rounds.unwrap_or(LINEAR_ROUNDS),
                )),
                _ => AnyTracer::MaxMip(MaxMipTracer::new(relief)),
            });
        };
        let made = match (self.manner(), self.tracer) {
            (Some(manner), _) => Cones::new(relief, map, manner).map(AnyTracer::Cones),
            (None, "walk") => Walk::new(relief, map).map(AnyTracer::Walk),
            (None, "walk-mip" | "cone-mip") => {
                let lod = self.lod.unwrap_or(pixel);
                let made = match nodes {
                    Some(nodes) => WalkMip::of_nodes(relief, map, nodes, lod),
                    None => WalkMip::new(relief, map, lod),
                };
                made.map(AnyTracer::WalkMip)
            }
            (None, _) => WalkRelaxed::new(relief, map).map(AnyTracer::WalkRelaxed),
        };
        made.map_err(|e: TraceError| fault(e.to_string()))
    }
}

fn fault(why: String) -> Fault {
    Fault::new("scene.map", why)
}
