//! Settings of a heightfield's tracer: which one it is, its cones, and its numbers.

use std::path::Path;
use std::sync::{Arc, LazyLock, OnceLock};

use thiserror::Error;

use crate::base::key::{Fault, Key, auto_count, auto_number, number, text, word};
use crate::heightfield::conemap::file::{MapUse, read_map};
use crate::heightfield::conemap::generate::generator::{LEAST_OFFSET, MOST_OFFSET};
use crate::heightfield::conemap::generate::{GenerateError, Generator, Options, cpu::generate};
use crate::heightfield::tracer::walk_mip::NodeCones;
use crate::heightfield::tracer::{Accuracy, Steps, Tracer, TracerKind, cones::Lookup};
use crate::heightfield::{
    ConeMap, HeightSurface, Heights, MapKind, Patches, height_surface::MOST_LEVELS,
};
use crate::keys;

/// Most steps that a tracer may count itself: as many as a shadow may have.
const MOST_STEPS: u32 = 2048;
/// Most rounds of refinement. After 32 bisections a bracket is below the resolution of f32.
const MOST_ROUNDS: u32 = 32;

/// Makes cones, on the CPU or on a device.
pub type Make<'a> =
    &'a mut dyn FnMut(Generator, &Heights, Patches, &Options) -> Result<ConeMap, GenerateError>;

/// Makes cones on the CPU, without a chance to cancel.
pub fn on_cpu(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> Result<ConeMap, GenerateError> {
    generate(generator, heights, patches, options, &mut |_| true)
}

/// Makes a map of the right kind and size at once, with ratios of 0: programs are the same with
/// it, pictures are not.
pub(crate) fn without_cones(
    generator: Generator,
    heights: &Heights,
    patches: Patches,
    options: &Options,
) -> Result<ConeMap, GenerateError> {
    let (kind, wrap) = (generator.kind(), heights.wrap());
    let [w, h] = kind.places(heights.size(), wrap, patches);
    Ok(ConeMap {
        kind,
        size: [w, h],
        wrap,
        ratios: vec![0.0; w as usize * h as usize * kind.channels()],
        offset: if kind.over_cells() {
            options.offset
        } else {
            0.0
        },
    })
}

/// Why a heightfield cannot be prepared.
#[derive(Debug, Error)]
pub enum PrepareError {
    /// A setting is wrong, or a file that it names.
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

/// The cones that a tracer uses.
#[derive(Clone, Debug)]
pub struct TracerCones {
    /// The map.
    map: Arc<ConeMap>,
    /// The cones of nodes, for a tracer that reads those.
    pub nodes: Option<NodeCones>,
    /// What a file does not tell and is assumed, with the file's name.
    pub note: Option<String>,
    /// The answer of [`TracerCones::wrong_number`], once it was asked for.
    wrong: Arc<OnceLock<Option<f64>>>,
}

impl TracerCones {
    /// The map.
    pub fn map(&self) -> &Arc<ConeMap> {
        &self.map
    }

    /// A number of the map that no map can have. It is looked for once, as a flight makes a tracer
    /// for every step.
    pub fn wrong_number(&self) -> Option<f64> {
        *self.wrong.get_or_init(|| {
            let mut numbers = self.map.ratios.iter().chain([&self.map.offset]);
            numbers.find(|n| !(n.is_finite() && **n >= 0.0)).copied()
        })
    }
}

impl<M: Into<Arc<ConeMap>>> From<M> for TracerCones {
    fn from(map: M) -> Self {
        Self {
            map: map.into(),
            nodes: None,
            note: None,
            wrong: Arc::default(),
        }
    }
}

/// The names of some tracers.
fn names(some: impl Fn(&TracerKind) -> bool) -> String {
    let some = TracerKind::ALL.into_iter().filter(some);
    some.map(TracerKind::name).collect::<Vec<_>>().join(", ")
}

/// The names of the tracers whose numbers follow a setting.
fn readers(change: fn(&mut TracerSettings)) -> String {
    names(|kind| {
        let own = TracerSettings::from(*kind);
        let mut changed = own.clone();
        change(&mut changed);
        let [one, two] = [own, changed].map(|s| kind.facts().method.numbers(&s, 1.0));
        one != two
    })
}

/// Help texts that name tracers.
struct Help {
    tracer: String,
    lookup: String,
    steps: String,
    rounds: String,
    stretch: String,
    lod: String,
}

static HELP: LazyLock<Help> = LazyLock::new(|| {
    let of = |accuracy| names(|kind| kind.facts().accuracy == accuracy);
    let [exact, pixel] = [Accuracy::Exact, Accuracy::Pixel].map(of);
    let samples = names(|kind| kind.facts().kinds.first().is_some_and(|k| !k.over_cells()));
    Help {
        tracer: format!(
            "how rays find the surface: auto is walk, or max-mip in a picture with fewer than three rays for each sample of the heights, for which a cone map seldom pays; the window always takes walk; these find every first hit: {exact}; the hits of these are off by at most a pixel: {pixel}; the others may miss thin parts"
        ),
        lookup: format!(
            "how height and cone are read between samples: interpolated, or from the nearest sample; only for {samples}"
        ),
        steps: format!(
            "step limit of a ray, or for a tracer without cones the number of its steps; auto is the tracer's own, see heightfields.md; only for {}",
            readers(|s| s.steps = Some(7))
        ),
        rounds: format!(
            "rounds of bisection or false position that refine a hit; auto is the tracer's own; only for {}",
            readers(|s| s.rounds = Some(31))
        ),
        stretch: format!(
            "factor on the cone steps; auto is 1.5 for csm-scaled, else 1; only for {}",
            readers(|s| s.stretch = Some(0.9))
        ),
        lod: format!(
            "distance from which walk-mip and cone-mip take texels to be narrower than a pixel, and at which csm-loop has half of its steps; 0 for none; auto follows the camera, and is 0 for csm-loop; only for {}",
            readers(|s| s.lod = Some(7.0))
        ),
    }
});

/// How rays are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct TracerSettings {
    /// The tracer; `None` for the walk, or for no cone map in a picture that is too small for one.
    pub tracer: Option<TracerKind>,
    /// `auto`, a generator's name, or the file of a cone map.
    pub map: String,
    /// How ratios are read between samples.
    pub lookup: Lookup,
    /// Steps that the tracer counts itself; `None` for its default.
    pub steps: Option<u32>,
    /// Rounds of its refinement; `None` for its default.
    pub rounds: Option<u32>,
    /// Factor on the steps that cones give; `None` for its default.
    pub stretch: Option<f64>,
    /// The distance at which a texel is as wide as a pixel to `walk-mip` and `cone-mip`, and at
    /// which `csm-loop` has half of its steps; 0 for never. `None` follows the camera for the
    /// first two, and is never for `csm-loop`.
    pub lod: Option<f64>,
    /// The offset of the walks' cones, in texels.
    pub offset: f64,
}

impl Default for TracerSettings {
    fn default() -> Self {
        Self {
            tracer: None,
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

impl From<TracerKind> for TracerSettings {
    /// A tracer with its defaults.
    fn from(tracer: TracerKind) -> Self {
        Self {
            tracer: Some(tracer),
            ..Self::default()
        }
    }
}

impl TracerSettings {
    /// The keys of the tracer in `[scene]`.
    pub fn keys(&mut self) -> Vec<Key<'_>> {
        keys![
            "tracer" = word(&mut self.tracer, &TracerKind::CHOICES), &HELP.tracer => Assets;
            "map" = text(&mut self.map),
                "the cone map: auto makes one that fits the tracer; a generator's name makes its map; or the file of a map" => Assets;
            "lookup" = word(&mut self.lookup, &Lookup::WORDS),
                &HELP.lookup => Assets;
            "tracer_steps" = auto_count(&mut self.steps, 1, MOST_STEPS),
                &HELP.steps;
            "tracer_rounds" = auto_count(&mut self.rounds, 1, MOST_ROUNDS),
                &HELP.rounds;
            "stretch" = auto_number(&mut self.stretch, 0.01, 100.0),
                &HELP.stretch;
            "lod" = auto_number(&mut self.lod, 0.0, 1e6),
                &HELP.lod;
            "offset" = number(&mut self.offset, LEAST_OFFSET, MOST_OFFSET),
                "texels that are added to each distance when the cones of the walk and its variants are made" => Assets;
        ]
    }

    /// The tracer of a picture with a cone map.
    pub fn kind(&self) -> TracerKind {
        self.tracer.unwrap_or_default()
    }

    /// The steps that the tracer counts itself; 0 for no such limit.
    pub fn own_steps(&self) -> u32 {
        self.steps.unwrap_or(match self.kind().facts().steps {
            Steps::Divided(steps) | Steps::Limited(steps) => steps,
            Steps::Cells | Steps::Pyramid => 0,
        })
    }

    /// The most steps that a ray can take over so many cells along each axis, if nobody limits
    /// them.
    pub fn most_steps(&self, domain: [u32; 2]) -> u32 {
        // The first cell, and a line of either axis for each other one.
        let cells = domain[0] + domain[1];
        match self.kind().facts().steps {
            Steps::Cells | Steps::Limited(_) => cells,
            // A step down for each step up, and those down from the top.
            Steps::Pyramid => 2 * cells + MOST_LEVELS as u32,
            Steps::Divided(_) => self.own_steps(),
        }
    }

    /// Kinds of cones that the tracer can use, the one to make by default first; none for a
    /// tracer without cones.
    pub fn kinds(&self) -> &'static [MapKind] {
        self.kind().facts().kinds
    }

    /// The generator of the cones; `None` if they come from a file, or the tracer needs none.
    pub fn generator(&self) -> Option<Generator> {
        if self.map != "auto" {
            return Generator::named(&self.map);
        }
        self.kinds().first().map(|kind| kind.facts().generator)
    }

    /// Checks that the tracer can use the cones, as far as names tell. Files are checked when
    /// they are read.
    pub fn check(&self) -> Result<(), Fault> {
        if self.map == "auto" {
            return Ok(());
        }
        let fits = |generator: &Generator| self.kinds().contains(&generator.kind());
        let needs_map = self.kind().needs_map();
        if self.generator().map_or(needs_map, |g| fits(&g)) {
            return Ok(());
        }
        let name = self.kind().name();
        if !needs_map {
            return Err(fault(format!(
                "the tracer {name} needs no cones; \"auto\" would do"
            )));
        }
        let usable = Generator::ALL.iter().filter(|g| fits(g));
        let names: Vec<&str> = usable.map(|g| g.name()).collect();
        Err(fault(format!(
            "the tracer `{name}` cannot use the cones of the generator `{}`; it can use those of {}, or auto",
            self.map,
            names.join(", ")
        )))
    }

    /// The cones, made or read; `None` for a tracer that needs none.
    ///
    /// # Errors
    /// The file has no cones that fit the surface and the tracer, or `make` fails.
    pub fn cones(
        &self,
        surface: &HeightSurface,
        folder: &Path,
        make: Make<'_>,
    ) -> Result<Option<TracerCones>, PrepareError> {
        if !self.kind().needs_map() {
            return Ok(None);
        }
        let mut cones = match self.generator() {
            Some(generator) => TracerCones::from(self.made(generator, surface, make)?),
            None => self.read(folder, surface)?,
        };
        cones.nodes = self.kind().facts().method.nodes(surface, &cones);
        Ok(Some(cones))
    }

    /// The cones of a file.
    fn read(&self, folder: &Path, surface: &HeightSurface) -> Result<TracerCones, Fault> {
        let path = folder.join(&self.map);
        let is_path =
            self.map.contains(['.', '/', '\\']) || (cfg!(feature = "cli") && path.exists());
        if !is_path {
            let names = Generator::ALL.map(Generator::name).join(", ");
            let why = format!("there is no such file or generator; generators are {names}");
            return Err(fault(why));
        }
        let file = read_map(&path).map_err(|e| fault(e.to_string()))?;
        let wanted = MapUse {
            who: &format!("the tracer {}", self.kind().name()),
            kinds: self.kinds(),
            heights: surface.heights(),
            patches: surface.patches(),
        };
        file.check_use(&path, &wanted)
            .map_err(|e| fault(e.to_string()))?;
        let note = file.unknown();
        Ok(TracerCones {
            note: note.map(|note| format!("{} {note}", path.display())),
            ..TracerCones::from(file.map)
        })
    }

    /// The cones of a generator.
    ///
    /// # Errors
    /// `make` fails.
    pub fn made(
        &self,
        generator: Generator,
        surface: &HeightSurface,
        make: Make<'_>,
    ) -> Result<ConeMap, GenerateError> {
        let options = Options {
            offset: self.offset,
            ..Options::default()
        };
        make(generator, surface.heights(), surface.patches(), &options)
    }

    /// The tracer itself. `pixel` is the distance from the eye at which a texel is as wide as a
    /// pixel.
    ///
    /// # Errors
    /// The tracer cannot use the cones.
    pub fn tracer(
        &self,
        surface: &Arc<HeightSurface>,
        cones: Option<&TracerCones>,
        pixel: f64,
    ) -> Result<Arc<Tracer>, Fault> {
        let made = self.kind().make(surface, cones, self, pixel);
        made.map_err(|e| fault(e.to_string()))
    }
}

fn fault(why: String) -> Fault {
    Fault::new("scene.map", why)
}
