//! Whether a map can be used with given heights and by a given tracer.
//!
//! A map of other heights, of another kind or for another wrapping gives pictures that
//! are wrong in places and look right in others. So it is refused.
//!
//! A map over samples fits two sets of heights: those that it was made from, recognised by
//! their digest, and those in its own file, which may be rounded. `rounding.rs` says what its
//! ratios promise over the latter.

use std::path::Path;

use crate::heightfield::conemap::file::{MapFile, digest};
use crate::heightfield::{FileError, Heights, MapKind, Patches, heights::wrap_name};

/// What a map shall be used for.
#[derive(Clone, Copy, Debug)]
pub struct MapUse<'a> {
    /// Who uses it, in words: the tracer `walk`, say.
    pub who: &'a str,
    /// Kinds that can be used; empty for any.
    pub kinds: &'a [MapKind],
    /// The heights to trace.
    pub heights: &'a Heights,
    /// What lies between them.
    pub patches: Patches,
}

/// How far heights in the 8-bit map of another program may be from the true ones, because it
/// may have rounded them either way.
const ONE_STEP: f32 = 1.001 / 255.0;

impl MapFile {
    /// Checks that the map, read from `path`, can be used.
    ///
    /// # Errors
    /// It is of another kind, wraps another way, or was made for other heights.
    pub fn check_use(&self, path: &Path, wanted: &MapUse<'_>) -> Result<(), FileError> {
        let misfit = self.misfit(wanted);
        misfit.map_or(Ok(()), |why| Err(FileError::file(path, why)))
    }

    fn misfit(&self, wanted: &MapUse<'_>) -> Option<String> {
        let kind = self.map.kind;
        if !wanted.kinds.is_empty() && !wanted.kinds.contains(&kind) {
            let words: Vec<&str> = wanted.kinds.iter().map(|k| k.name()).collect();
            return Some(format!(
                "its cones are of the kind `{}` ({}), and {} needs `{}`; make such a map",
                kind.name(),
                kind.facts().promise,
                wanted.who,
                words.join("` or `")
            ));
        }
        let (samples, heights) = (self.label.samples, wanted.heights);
        if samples != heights.size() {
            let [w, h] = heights.size();
            return Some(format!(
                "it was made for {} x {} samples, and these heights are {w} x {h}; make a map for them",
                samples[0], samples[1]
            ));
        }
        if self.map.wrap != heights.wrap() {
            return Some(format!(
                "it was made for heights that wrap along {}, and these wrap along {}; make it again with --wrap {}",
                wrap_name(self.map.wrap),
                wrap_name(heights.wrap()),
                wrap_name(heights.wrap())
            ));
        }
        if kind.over_cells() && self.label.patches != wanted.patches {
            return Some(format!(
                "it was made for a surface of {}, and this one is of {}; make it again",
                self.label.patches.surface(),
                wanted.patches.surface()
            ));
        }
        if self.map.size != kind.places(samples, self.map.wrap, self.label.patches) {
            return Some("it has another number of cones than the heights have places".into());
        }
        self.other_heights(heights)
    }

    /// Whether the heights are those in the file itself.
    fn holds(&self, heights: &Heights) -> bool {
        !self.map.kind.over_cells() && self.heights.as_deref() == Some(heights.data())
    }

    /// A note if the file does not tell for which heights the map was made. Then any heights
    /// of its size are accepted.
    pub fn unknown(&self) -> Option<String> {
        let told = self.heights.is_some() && !self.map.kind.over_cells();
        let known = told || self.label.digest.is_some();
        let [w, h] = self.label.samples;
        (!known).then(|| {
            format!(
                "does not tell what heights it was made for; any heights of {w} x {h} samples are accepted"
            )
        })
    }

    /// Why the heights are not those that the map was made for, if so.
    fn other_heights(&self, heights: &Heights) -> Option<String> {
        let same = match (&self.label.digest, &self.heights) {
            (Some(known), _) => self.holds(heights) || *known == digest(heights),
            (None, Some(places)) if !self.map.kind.over_cells() => {
                let mut pairs = places.iter().zip(heights.data());
                pairs.all(|(a, b)| (a - b).abs() <= ONE_STEP)
            }
            // Nothing is known about them.
            (None, _) => true,
        };
        (!same).then(|| {
            "it was made for other heights; make it again from these, and give --invert and --normalize to both or to neither"
                .to_string()
        })
    }
}
