//! A generator made ready for one height map: what it needs once, and the cones of one
//! place, in f64.

use crate::heightfield::conemap::ConeMap;
use crate::heightfield::conemap::generate::brute::Scan;
use crate::heightfield::conemap::generate::cost::Cost;
use crate::heightfield::conemap::generate::generator::{GenerateError, Generator, Options};
use crate::heightfield::conemap::generate::grid_distance::{Aim, GridDistance};
use crate::heightfield::conemap::generate::planes::Planes;
use crate::heightfield::conemap::generate::search::{Best, Search};
use crate::heightfield::conemap::generate::{falling, quick, relaxed};
use crate::heightfield::heights::{Axis, Heights, Patches};
use crate::heightfield::max_mip::MaxMip;

/// A generator with all that it needs.
pub struct MapTask<'a> {
    /// Which.
    pub generator: Generator,
    /// What it was told.
    pub options: Options,
    /// The height map.
    pub heights: &'a Heights,
    /// Places along each axis: samples or cells.
    pub size: [u32; 2],
    /// Heights of the samples, or apexes of the cells.
    pub values: Vec<f32>,
    /// The highest of them.
    pub top: f64,
    /// Maxima of what bounds cones, for each of the directions that are searched one by
    /// one; none for generators that need none.
    pub mips: Vec<MaxMip>,
    /// Planes above the heights, for searches all around.
    pub planes: Option<Planes>,
}

/// The cones of one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Ratios; all but the first are of use for a quad map only.
    pub ratios: [f64; 4],
    /// Nodes looked at.
    pub nodes: u32,
}

impl<'a> MapTask<'a> {
    /// Makes a generator ready. Patches matter to the walks.
    ///
    /// # Errors
    /// Options that it cannot be told.
    pub fn new(
        generator: Generator,
        heights: &'a Heights,
        patches: Patches,
        options: &Options,
    ) -> Result<Self, GenerateError> {
        options.check()?;
        let (size, values) = if generator.over_cells() {
            (heights.cells(patches), heights.apexes(patches))
        } else {
            (heights.size(), heights.data().to_vec())
        };
        let quadrants = Aim::QUADRANTS.into_iter().filter_map(|aim| match aim {
            Aim::Quadrant(up) => Some(up),
            _ => None,
        });
        let masked: Vec<Vec<f32>> = match generator {
            Generator::RelaxedExact => quadrants
                .map(|up| falling::of_samples(heights, up))
                .collect(),
            Generator::WalkRelaxed => quadrants
                .map(|up| falling::of_cells(heights, patches, &values, up))
                .collect(),
            Generator::Brute | Generator::RelaxedSearch => Vec::new(),
            _ => vec![values.clone()],
        };
        let mips = masked.into_iter().map(|limits| MaxMip::new(size, limits));
        let mips: Vec<MaxMip> = mips.collect();
        let around = matches!(generator, Generator::Exact | Generator::Walk);
        Ok(Self {
            generator,
            options: *options,
            heights,
            size,
            planes: mips.first().filter(|_| around).map(Planes::new),
            mips,
            top: f64::from(values.iter().copied().fold(0.0, f32::max)),
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

    /// What places cost.
    pub fn cost(&self) -> Cost {
        if self.generator.over_cells() {
            let offset = self.options.offset;
            Cost::Walk { offset }
        } else {
            Cost::Cone
        }
    }

    /// The searches that the generator is made of, if it is made of searches: each
    /// pyramid's number with the places that count.
    pub fn aims(&self) -> Vec<(usize, Aim)> {
        match self.generator {
            Generator::Exact | Generator::Walk => vec![(0, Aim::Around)],
            Generator::Quad => Aim::SIDES.map(|aim| (0, aim)).to_vec(),
            Generator::RelaxedExact | Generator::WalkRelaxed => {
                Aim::QUADRANTS.into_iter().enumerate().collect()
            }
            _ => Vec::new(),
        }
    }

    /// A place by its number, row by row.
    pub fn place(&self, index: usize) -> [u32; 2] {
        let width = self.size[0] as usize;
        [(index % width) as u32, (index / width) as u32]
    }

    /// The cones of one place.
    pub fn find(&self, index: usize) -> Found {
        let from = self.place(index);
        let height = f64::from(self.values[index]);
        let cost = self.cost();
        let mut best = Best {
            cost: cost.widest(),
            nodes: 0,
        };
        let mut ratios = [0.0; 4];
        match self.generator {
            Generator::Brute => self.scan().run(from, height, &mut best),
            Generator::Naive | Generator::Improved | Generator::Center => {
                let rule = self.rule();
                quick::run(&self.mips[0], self.axes(), rule, from, height, &mut best);
            }
            Generator::RelaxedSearch => {
                let steps = self.options.search_steps;
                relaxed::search(self.heights, &self.scan(), steps, from, height, &mut best);
            }
            Generator::Quad => {
                for (ratio, aim) in ratios.iter_mut().zip(Aim::SIDES) {
                    best.cost = cost.widest();
                    self.search(0, aim).run(from, height, &mut best);
                    *ratio = cost.ratio(best.cost);
                }
                let nodes = best.nodes;
                return Found { ratios, nodes };
            }
            _ => {
                for (mip, aim) in self.aims() {
                    self.search(mip, aim).run(from, height, &mut best);
                }
            }
        }
        ratios[0] = cost.ratio(best.cost);
        let nodes = best.nodes;
        Found { ratios, nodes }
    }

    /// How a quick generator places maxima.
    pub fn rule(&self) -> quick::Rule {
        match self.generator {
            Generator::Naive => quick::Rule::Naive,
            Generator::Center => quick::Rule::Center,
            _ => quick::Rule::Improved,
        }
    }

    fn scan(&self) -> Scan<'_> {
        Scan {
            axes: self.axes(),
            values: &self.values,
            top: self.top,
        }
    }

    fn search(&self, mip: usize, aim: Aim) -> Search<'_> {
        Search {
            mip: &self.mips[mip],
            planes: self.planes.as_ref(),
            reach: GridDistance {
                axes: self.axes(),
                aim,
                cells: self.generator.over_cells(),
            },
            cost: self.cost(),
        }
    }

    /// The map of the ratios that were found.
    pub fn map(&self, ratios: Vec<f64>) -> ConeMap {
        let walk = self.generator.over_cells();
        ConeMap {
            kind: self.generator.kind(),
            size: self.size,
            wrap: self.heights.wrap(),
            offset: if walk { self.options.offset } else { 0.0 },
            ratios,
        }
    }
}
