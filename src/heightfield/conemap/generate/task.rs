//! A generator prepared for one height map, and the search for the cones of one place in f64.
//! Twin: `wgsl/heightfield/conemap/generate/task.wgsl`.

use crate::base::shader::Program;
use crate::heightfield::conemap::generate::{
    Apex, Best, ConeSearch, Cost, GenerateError, Generator, Options, planes::Planes,
};
use crate::heightfield::{ConeMap, Heights, MaxMip, Patches, heights::Axis};
use crate::wgsl;

/// A generator with everything that its searches read.
pub struct MapTask<'a> {
    /// Which generator.
    pub generator: Generator,
    /// How it searches.
    pub method: &'static dyn ConeSearch,
    /// Its options.
    pub options: Options,
    /// The height map.
    pub heights: &'a Heights,
    /// Places along each axis.
    pub size: [u32; 2],
    /// Heights of the samples, or apexes of the cells.
    pub values: Vec<f32>,
    /// Maxima of the heights that bound cones: none, one for all searches or one for each.
    pub mips: Vec<MaxMip>,
    /// Planes above the heights, where they help.
    pub planes: Option<Planes>,
    /// The highest of all values.
    top: f32,
}

/// For each search, a place that may cost little: the one that bounded the cone next to this. With
/// it a search rules out most others at once.
pub type Likely = [Option<[u32; 2]>; 4];

/// The cones of one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Ratios, as many as the map has channels.
    pub ratios: [f64; 4],
    /// Nodes that were looked up: samples, or maxima of any level.
    pub nodes: u32,
}

impl<'a> MapTask<'a> {
    /// Prepares a generator. Only generators over cells depend on the patches.
    ///
    /// # Errors
    /// Options out of range.
    pub fn new(
        generator: Generator,
        heights: &'a Heights,
        patches: Patches,
        options: &Options,
    ) -> Result<Self, GenerateError> {
        options.check()?;
        let method = generator.facts().method;
        let cells = generator.over_cells().then_some(patches);
        let (size, values) = heights.places(cells);
        let limits = method.pyramids(heights, cells, &values).into_iter();
        let mips: Vec<MaxMip> = limits.map(|limits| MaxMip::new(size, limits)).collect();
        let planes = mips.first().filter(|_| method.uses_planes());
        Ok(Self {
            generator,
            method,
            options: *options,
            heights,
            size,
            planes: planes.map(Planes::new),
            mips,
            top: values.iter().copied().fold(0.0, f32::max),
            values,
        })
    }

    /// The axes of the grid of places.
    pub fn axes(&self) -> [Axis; 2] {
        let wrap = self.heights.wrap();
        [0, 1].map(|a| Axis {
            count: self.size[a],
            wrap: wrap[a],
        })
    }

    /// How much places cost.
    pub fn cost(&self) -> Cost {
        if self.generator.over_cells() {
            let offset = self.options.offset;
            Cost::Walk { offset }
        } else {
            Cost::Cone
        }
    }

    /// The pyramid of a search, by its number.
    pub fn pyramid(&self, search: usize) -> usize {
        search.min(self.mips.len().saturating_sub(1))
    }

    /// The highest value that can bound a cone of a search.
    pub fn top(&self, search: usize) -> f32 {
        self.mips
            .get(self.pyramid(search))
            .map_or(self.top, MaxMip::top)
    }

    /// How many searches narrow each cone of a place.
    pub fn searches_per_cone(&self) -> usize {
        self.method.sectors().len() / self.generator.channels()
    }

    /// Searches for the cones of a place, which is given by its index, row by row. Leaves the
    /// places that bound them.
    pub fn find(&self, index: usize, likely: &mut Likely) -> Found {
        let width = self.size[0] as usize;
        let from = Apex {
            place: [(index % width) as u32, (index / width) as u32],
            height: f64::from(self.values[index]),
        };
        let cost = self.cost();
        let (mut ratios, mut nodes) = ([0.0; 4], 0);
        let per_cone = self.searches_per_cone();
        for (cone, ratio) in ratios[..self.generator.channels()].iter_mut().enumerate() {
            let mut best = Best {
                cost: cost.widest(),
                nodes,
                at: from.place,
            };
            let searches = cone * per_cone..(cone + 1) * per_cone;
            for (search, likely) in searches.clone().zip(&mut likely[searches]) {
                best.at = likely.unwrap_or(from.place);
                self.method.search(self, search, from, &mut best);
                *likely = Some(best.at);
            }
            (*ratio, nodes) = (cost.ratio(best.cost), best.nodes);
        }
        Found { ratios, nodes }
    }

    /// The map of the ratios that were found.
    pub fn map(&self, ratios: Vec<f64>) -> ConeMap {
        ConeMap {
            kind: self.generator.kind(),
            size: self.size,
            wrap: self.heights.wrap(),
            offset: match self.cost() {
                Cost::Walk { offset } => offset,
                Cost::Cone => 0.0,
            },
            ratios,
        }
    }

    /// The program that searches on a device.
    pub fn program(&self) -> Program {
        let mut modules = vec![wgsl!("heightfield/conemap/generate/task.wgsl")];
        modules.extend(self.method.modules(self));
        Program::new("generate", modules)
    }
}

/// The program of a generator. It is the same for all heights.
///
/// # Panics
/// Never: a map of one sample can always be made.
pub fn program_of(generator: Generator) -> Program {
    let one = Heights::new([1, 1], [false, false], vec![0.0]).expect("one sample is a map");
    let task = MapTask::new(generator, &one, Patches::default(), &Options::default());
    task.expect("the default options are in range").program()
}
