//! The least cost of all places by branch and bound over the maxima, in f64.
//! Twin: `wgsl/heightfield/conemap/generate/search.wgsl`.
//!
//! A node of the pyramid can be skipped if its maximum does not rise above the apex, or
//! if a place as high as its maximum and as near as its nearest would cost no less than
//! the best so far (docs/method.md, 4). The eight neighbours come first.
//! From there the search climbs: at each level it looks at the three siblings of its own
//! ancestor, cheapest first, and stops as soon as nothing outside that ancestor can
//! matter. On rough fields that takes some tens of nodes per place at any size;
//! on smooth ones it grows like the length of a crest, which planes above the heights
//! keep short ([`planes`](super::planes); only here, as they only save time).

use crate::base::shader::Module;
use crate::heightfield::conemap::generate::grid_distance::{GridDistance, Sector, neighbours};
use crate::heightfield::conemap::generate::{
    Apex, ConeSearch, Cost, MapTask, falling, planes::Planes,
};
use crate::heightfield::{Heights, MaxMip, Patches};
use crate::wgsl;

/// Branch and bound: which places each search looks at.
pub struct BranchAndBound(&'static [Sector]);

/// One search for places in all directions.
pub const ALL: BranchAndBound = BranchAndBound(&[Sector::All]);
/// A search for each side, one cone each.
pub const SIDES: BranchAndBound = BranchAndBound(&Sector::SIDES);
/// A search for each quadrant. Only places behind which the surface falls limit its cones, and
/// these differ between the quadrants.
pub const FALLING: BranchAndBound = BranchAndBound(&Sector::QUADRANTS);

impl BranchAndBound {
    fn distance(&self, task: &MapTask<'_>, search: usize) -> GridDistance {
        GridDistance {
            axes: task.axes(),
            sector: self.0[search],
            cells: task.generator.over_cells(),
        }
    }
}

impl ConeSearch for BranchAndBound {
    fn sectors(&self) -> &'static [Sector] {
        self.0
    }

    fn pyramids(&self, heights: &Heights, cells: Option<Patches>, values: &[f32]) -> Vec<Vec<f32>> {
        let quadrants = self.0.iter().filter_map(|sector| match sector {
            Sector::Quadrant(up) => Some(falling::limits(heights, cells, values, *up)),
            _ => None,
        });
        let quadrants: Vec<_> = quadrants.collect();
        match quadrants.is_empty() {
            true => vec![values.to_vec()],
            false => quadrants,
        }
    }

    fn uses_planes(&self) -> bool {
        self.0 == [Sector::All]
    }

    fn modules(&self, task: &MapTask<'_>) -> Vec<Module> {
        vec![
            task.cost().module(1.0),
            wgsl!("heightfield/conemap/generate/least_cost.wgsl"),
            self.distance(task, 0).module(),
            wgsl!("heightfield/conemap/generate/search.wgsl"),
        ]
    }

    fn search(&self, task: &MapTask<'_>, search: usize, from: Apex, best: &mut Best) {
        let search = Search {
            mip: &task.mips[task.pyramid(search)],
            planes: task.planes.as_ref(),
            distance: self.distance(task, search),
            cost: task.cost(),
            from,
        };
        search.run(best);
    }
}

/// Nodes after which a search asks the planes, too. Most searches of rough fields end
/// sooner, and planes would cost them more than they save; on smooth fields long searches
/// are the rule, and planes take away most of them.
const PATIENCE: u32 = 64;

/// The best of a search so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    /// Least cost.
    pub cost: f64,
    /// Nodes looked at.
    pub nodes: u32,
    /// The place of that cost; before a search, one that may cost little.
    pub at: [u32; 2],
}

/// A search over one pyramid.
struct Search<'a> {
    /// Maxima of the heights that bound cones; less than 0 for a place that does not.
    mip: &'a MaxMip,
    /// Planes above the same heights.
    planes: Option<&'a Planes>,
    distance: GridDistance,
    cost: Cost,
    from: Apex,
}

/// A node that is worth a visit, and the least that any place under it can cost.
type Child = (f64, [u32; 2]);

impl Search<'_> {
    /// Lowers the best to the least cost of all places.
    fn run(&self, best: &mut Best) {
        let most = f64::from(self.mip.top()) - self.from.height;
        if most <= 0.0 {
            return;
        }
        if best.at != self.from.place {
            self.consider(best.at, best);
        }
        for neighbour in neighbours(self.distance.axes, 0, self.from.place) {
            self.consider(neighbour.at, best);
        }
        // Level 0 is done: the siblings of a place are neighbours of it.
        for level in 1..self.mip.levels.len() {
            let own = self.from.place.map(|i| i >> level);
            let block = self.mip.places(level, own);
            let outside = self.distance.outside(self.from.place, block);
            let Some(steps) = outside else { return };
            if self.cost.of(steps * steps, most) >= best.cost {
                return;
            }
            let parent = own.map(|i| i / 2);
            self.children(level, parent, Some(own), best);
        }
    }

    /// Takes one place into account.
    fn consider(&self, at: [u32; 2], best: &mut Best) {
        if let Some(cost) = self.bound(0, at, best) {
            (best.cost, best.at) = (cost, at);
        }
    }

    /// The least that any place under a node can cost, if that is less than the best.
    fn bound(&self, level: usize, at: [u32; 2], best: &mut Best) -> Option<f64> {
        best.nodes += 1;
        let rise = f64::from(self.mip.levels[level].at(at[0], at[1])) - self.from.height;
        if rise <= 0.0 {
            return None;
        }
        let to = self.mip.places(level, at);
        let squared = self.distance.squared(self.from.place, to)?;
        if self.cost.exceeds(squared, rise, best.cost) {
            return None;
        }
        let cost = self.cost.of(squared, rise);
        if cost >= best.cost {
            return None;
        }
        if level > 0
            && best.nodes > PATIENCE
            && let Some(planes) = self.planes
            && planes.rule_out(
                (&self.distance, self.cost),
                self.from,
                (level, at),
                to,
                best.cost,
            )
        {
            return None;
        }
        Some(cost)
    }

    /// Visits the children of a node, which lie on `level`, but for one; cheapest first.
    fn children(&self, level: usize, parent: [u32; 2], without: Option<[u32; 2]>, best: &mut Best) {
        let size = self.mip.levels[level].size;
        let mut list: [Child; 4] = [(f64::INFINITY, [0; 2]); 4];
        for (i, child) in (0..4).zip(&mut list) {
            let at = [2 * parent[0] + i % 2, 2 * parent[1] + i / 2];
            if at[0] >= size[0] || at[1] >= size[1] || without == Some(at) {
                continue;
            }
            if level == 0 {
                self.consider(at, best);
            } else if let Some(cost) = self.bound(level, at, best) {
                *child = (cost, at);
            }
        }
        // A network that sorts four is quicker than a general sort.
        for (i, k) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
            if list[k].0 < list[i].0 {
                list.swap(i, k);
            }
        }
        for (cost, at) in list {
            // What was found since may have ruled it out.
            if cost < best.cost {
                self.children(level - 1, at, None, best);
            }
        }
    }
}
