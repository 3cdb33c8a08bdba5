//! Whether a map is for these heights and this tracer.
//!
//! A map of other heights, of another kind or for another wrapping gives pictures that
//! are wrong in places and look right in others; it is refused instead.
//!
//! A map over samples is for two sets of heights: those that it was made from, by their
//! digest, and those in its own file, which may be rounded. What its ratios promise over
//! the latter is told in `round.rs`.

use std::path::Path;

use crate::heightfield::conemap::MapKind;
use crate::heightfield::conemap::file::error::MapError;
use crate::heightfield::conemap::file::form::{MapFile, digest};
use crate::heightfield::conemap::file::label::places;
use crate::heightfield::conemap::file::words::{is_walk, kind_word, promise, wrap_word};
use crate::heightfield::heights::{Heights, Patches};

/// What a map is wanted for.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// Who wants it, in words: the tracer `walk`, say.
    pub who: &'a str,
    /// Kinds that will do; empty for any.
    pub kinds: &'a [MapKind],
    /// The heights to trace.
    pub heights: &'a Heights,
    /// What lies between them.
    pub patches: Patches,
}

/// How far heights of another program's 8-bit map may be from the true ones: it may have
/// rounded them either way.
const ONE_STEP: f32 = 1.001 / 255.0;

impl MapFile {
    /// Checks that the map, read from `path`, may be used as wanted.
    ///
    /// # Errors
    /// It is of another kind, wraps another way, or was made for other heights.
    pub fn fit(&self, path: &Path, wanted: &Wanted<'_>) -> Result<(), MapError> {
        match self.misfit(wanted) {
            None => Ok(()),
            Some(why) => Err(MapError::Misfit {
                path: path.display().to_string(),
                why,
            }),
        }
    }

    fn misfit(&self, wanted: &Wanted<'_>) -> Option<String> {
        let kind = self.map.kind;
        if !wanted.kinds.is_empty() && !wanted.kinds.contains(&kind) {
            let words: Vec<&str> = wanted.kinds.iter().map(|k| kind_word(*k)).collect();
            return Some(format!(
                "its cones are of the kind `{}` ({}), and {} needs `{}`; make such a map",
                kind_word(kind),
                promise(kind),
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
                wrap_word(self.map.wrap),
                wrap_word(heights.wrap()),
                wrap_word(heights.wrap())
            ));
        }
        if is_walk(kind) && self.label.patches != wanted.patches {
            let word = |p: Patches| match p {
                Patches::Bilinear => "bilinear patches",
                Patches::Boxes => "boxes",
            };
            return Some(format!(
                "it was made for a surface of {}, and this one is of {}; make it again",
                word(self.label.patches),
                word(wanted.patches)
            ));
        }
        if self.map.size != places(samples, self.map.wrap, kind, self.label.patches) {
            return Some("it has another number of cones than the heights have places".into());
        }
        self.foreign(heights)
    }

    /// Whether the heights are those in the file itself.
    fn holds(&self, heights: &Heights) -> bool {
        !is_walk(self.map.kind) && self.heights.as_deref() == Some(heights.data())
    }

    /// Why nothing tells for which heights the map was made, if so: any of its size are
    /// taken for them.
    pub fn unknown(&self) -> Option<String> {
        let told = self.heights.is_some() && !is_walk(self.map.kind);
        let known = told || self.label.digest.is_some();
        let [w, h] = self.label.samples;
        (!known).then(|| {
            format!(
                "does not tell what heights it was made for; any of {w} x {h} samples are taken for them"
            )
        })
    }

    /// Whether the heights are others than those that the map was made for.
    fn foreign(&self, heights: &Heights) -> Option<String> {
        let same = match (&self.label.digest, &self.heights) {
            (Some(known), _) => self.holds(heights) || *known == digest(heights),
            (None, Some(places)) if !is_walk(self.map.kind) => {
                let mut pairs = places.iter().zip(heights.data());
                pairs.all(|(a, b)| (a - b).abs() <= ONE_STEP)
            }
            // Nothing is known of them.
            (None, _) => true,
        };
        (!same).then(|| {
            "it was made for other heights; make it again from these, and give --invert and --normalize to both or to neither"
                .to_string()
        })
    }
}
