//! The least cost of all places by branch and bound over the maxima, in f64.
//! Twin: `wgsl/heightfield/conemap/generate/search.wgsl`.
//!
//! A node of the pyramid can be skipped if its maximum does not rise above the apex, or
//! if a place as high as its maximum and as near as its nearest would cost no less than
//! what is already known (research of 2024; METHOD 4). The eight neighbours come first.
//! From there the search climbs: at each level it looks at the three siblings of its own
//! ancestor, cheapest first, and stops as soon as nothing outside that ancestor can
//! matter. On rough fields that takes some tens of nodes per place whatever the size;
//! on smooth ones it grows like the length of a crest, which planes above the heights
//! keep in bounds ([`crate::heightfield::conemap::generate::planes`]; here alone, as they only save time).

use crate::heightfield::conemap::generate::cost::Cost;
use crate::heightfield::conemap::generate::grid_distance::{GridDistance, Places};
use crate::heightfield::conemap::generate::planes::Planes;
use crate::heightfield::max_mip::MaxMip;

/// Nodes after which a search asks the planes, too. Most searches of rough fields end
/// sooner, and planes would cost them more than they save; on smooth fields long searches
/// are the rule, and planes take away most of them.
const PATIENCE: u32 = 64;

/// What is known so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    /// Least cost.
    pub cost: f64,
    /// Nodes looked at.
    pub nodes: u32,
}

/// A search over one pyramid.
pub struct Search<'a> {
    /// Maxima of the heights that bound cones; where a place does not, less than 0.
    pub mip: &'a MaxMip,
    /// Planes above the same.
    pub planes: Option<&'a Planes>,
    /// Which places count.
    pub reach: GridDistance,
    /// What they cost.
    pub cost: Cost,
}

/// A node that is worth a visit, and the least that any place under it can cost.
type Child = (f64, [u32; 2]);

impl Search<'_> {
    /// Lowers the best to the least cost for a cone over a place, whose apex is `height`.
    pub fn run(&self, from: [u32; 2], height: f64, best: &mut Best) {
        if f64::from(self.mip.top()) <= height {
            return;
        }
        self.seed(from, height, best);
        // Level 0 is done: the siblings of a place are neighbours of it.
        for level in 1..self.mip.levels.len() {
            let own = from.map(|i| i >> level);
            let (low, high) = self.mip.places(level, own[0], own[1]);
            if let Some(steps) = self.reach.outside(from, Places { low, high }) {
                let rise = f64::from(self.mip.top()) - height;
                if self.cost.of(steps * steps, rise) >= best.cost {
                    return;
                }
            } else {
                return;
            }
            let parent = own.map(|i| i / 2);
            self.children(from, height, level, parent, Some(own), best);
        }
    }

    /// The eight neighbours.
    fn seed(&self, from: [u32; 2], height: f64, best: &mut Best) {
        let along = |a: usize, step: u32| {
            let axis = self.reach.axes[a];
            // Steps are -1, 0 and 1, moved up by one.
            match (from[a] + step).checked_sub(1) {
                Some(i) if i < axis.count => Some(i),
                Some(_) => axis.wrap.then_some(0),
                None => axis.wrap.then(|| axis.count - 1),
            }
        };
        for dy in 0..3 {
            for dx in 0..3 {
                let (Some(x), Some(y)) = (along(0, dx), along(1, dy)) else {
                    continue;
                };
                if [x, y] != from {
                    self.offer(from, height, [x, y], best);
                }
            }
        }
    }

    /// Takes one place into account.
    fn offer(&self, from: [u32; 2], height: f64, at: [u32; 2], best: &mut Best) {
        if let Some(cost) = self.bound(from, height, 0, at, best) {
            best.cost = cost;
        }
    }

    /// The least that any place under a node can cost, if that is less than the best.
    fn bound(
        &self,
        from: [u32; 2],
        height: f64,
        level: usize,
        at: [u32; 2],
        best: &mut Best,
    ) -> Option<f64> {
        best.nodes += 1;
        let rise = f64::from(self.mip.levels[level].at(at[0], at[1])) - height;
        if rise <= 0.0 {
            return None;
        }
        let (low, high) = self.mip.places(level, at[0], at[1]);
        let squared = self.reach.squared(from, Places { low, high })?;
        let cost = self.cost.of(squared, rise);
        if cost >= best.cost {
            return None;
        }
        if level > 0
            && best.nodes > PATIENCE
            && let Some(planes) = self.planes
        {
            let rules = (&self.reach, self.cost);
            let to = Places { low, high };
            if planes.rule_out(rules, (from, height), (level, at), to, best.cost) {
                return None;
            }
        }
        Some(cost)
    }

    /// Visits the children of a node, which lie on `level`, but for one; cheapest first.
    fn children(
        &self,
        from: [u32; 2],
        height: f64,
        level: usize,
        parent: [u32; 2],
        without: Option<[u32; 2]>,
        best: &mut Best,
    ) {
        let size = self.mip.levels[level].size;
        let mut list: [Child; 4] = [(f64::INFINITY, [0; 2]); 4];
        let mut count = 0;
        for i in 0..4 {
            let at = [2 * parent[0] + i % 2, 2 * parent[1] + i / 2];
            if at[0] >= size[0] || at[1] >= size[1] || without == Some(at) {
                continue;
            }
            if level == 0 {
                self.offer(from, height, at, best);
            } else if let Some(cost) = self.bound(from, height, level, at, best) {
                // Insertion keeps the cheapest first.
                let place = list[..count].iter().take_while(|c| c.0 <= cost).count();
                list.copy_within(place..count, place + 1);
                list[place] = (cost, at);
                count += 1;
            }
        }
        for (cost, at) in &list[..count] {
            // What was found since may have ruled it out.
            if *cost < best.cost {
                self.children(from, height, level - 1, *at, None, best);
            }
        }
    }
}
