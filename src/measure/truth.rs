//! The truth of a plan: the picture that others are compared with (docs/method.md, 5).
//!
//! Truths take long, so they are kept in the user's cache folder. The file is named by a
//! hash of everything that decides the truth: the plan's text, the contents of the files that
//! it names, and this program itself. A cut or changed file is ignored.

use std::fs::{self, DirEntry};
use std::path::{Path, PathBuf};

use bytemuck::{cast_slice, pod_collect_to_vec};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::base::outcome::State;
use crate::base::view::footprint;
use crate::cpu;
use crate::gpu::RenderError;
use crate::pass::progress::{Progress, Watch};
use crate::picture::frame::Frame;
use crate::picture::{self, Place};
use crate::plan::march::{Marching, Mode};
use crate::plan::{Extras, Plan};
use crate::preset;
use crate::scene::{Assets, Hit};

/// The reference frame of a plan, and how accurate it is.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Depth and states.
    pub frame: Frame,
    /// How converged it is.
    pub note: TruthNote,
}

/// How converged a truth is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TruthNote {
    /// Factor on the steps: their length over the estimate.
    pub stride: f64,
    /// Share of sampled pixels that move by more than 2 footprints or change state when the
    /// stride is halved.
    pub moved: f64,
}

/// The truth has converged if a smaller share of pixels moves.
const CONVERGED: f64 = 5e-5;
/// One in so many pixels is sampled.
const SAMPLE: usize = 16;
/// So often the truth is rendered, with half the stride each time. The result then tells how
/// many pixels still move.
pub const MOST_ROUNDS: u32 = 5;

/// The plan of a plan's truth. Settings that only say how work is spent get fixed values, so
/// that all modes share one truth.
pub fn asked(plan: &Plan) -> Plan {
    let mut asked = plan.clone();
    if let Some(exact) = plan.scene.exact() {
        asked.scene = exact;
    }
    asked.march = Marching {
        mode: Mode::Truth,
        detail: plan.march.detail,
        // This saves time and loses nothing, as the shape lies within the bounds.
        clip: Some(true),
        ..Marching::default()
    };
    asked
}

/// Renders a plan's truth in f64, with no cones, no relaxation and the same hit rule. The
/// factor on the steps starts at 0.1 and is halved until the picture converges.
///
/// # Errors
/// [`RenderError::Cancelled`] if `watch` returns `false`. A named file cannot be read.
pub fn truth(plan: &Plan, assets: &Assets, watch: Watch<'_>) -> Result<Truth, RenderError> {
    let mut plan = asked(plan);
    let view = plan.view();
    let [width, height] = plan.size.map(|n| n as usize);
    let sampled = (0..width * height).step_by(SAMPLE);
    let sampled = sampled.map(|i| [(i % width) as u32, (i / width) as u32]);
    let pixels: Vec<_> = sampled.collect();
    let (mut stride, mut round) = (0.1, 1);
    loop {
        let watch = &mut |now: &Progress| {
            let pass = format!("round {round} of at most {MOST_ROUNDS}, {}", now.pass);
            watch(&Progress {
                pass,
                done: now.done,
                is_step: true,
            })
        };
        plan.march.stride = Some(stride);
        let frame = cpu::render(&plan, assets, Extras::default(), watch)?;
        let mut finer = plan.clone();
        finer.march.stride = Some(0.5 * stride);
        let check = Progress {
            pass: "check".into(),
            done: 1.0,
            is_step: true,
        };
        if !watch(&check) {
            return Err(RenderError::Cancelled);
        }
        let sample = cpu::sample(&finer, assets, &pixels)?;
        let changed = |(n, (hit, state)): (usize, &(Hit, State))| {
            let (i, t) = (n * SAMPLE, hit.t);
            let before = f64::from(frame.depth[i]);
            let size = footprint(&view.view_ray(pixels[n]), t);
            let far = *state == State::Hit && (before - t).abs() > 2.0 * size;
            frame.state[i] != *state as u8 || far
        };
        let moved = sample.iter().enumerate().filter(|s| changed(*s)).count();
        let moved = moved as f64 / sample.len().max(1) as f64;
        if moved < CONVERGED || round == MOST_ROUNDS {
            let note = TruthNote { stride, moved };
            return Ok(Truth { frame, note });
        }
        (stride, round) = (0.5 * stride, round + 1);
    }
}

/// So many truths are kept. Older ones are removed.
const MOST_KEPT: usize = 64;

/// A folder of truths.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
    program: [u8; 32],
}

/// The folder for what may be lost, which may not exist; `None` if the user has none.
pub fn cache_folder() -> Option<PathBuf> {
    let set = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty());
    let named = set("XDG_CACHE_HOME").or_else(|| set("LOCALAPPDATA"));
    let hidden = || Some(Path::new(&set("HOME")?).join(".cache"));
    Some(Path::new(&named.map(PathBuf::from).or_else(hidden)?).join("conemarch"))
}

impl Cache {
    /// The user's cache; `None` if there is none, or if this program cannot read itself.
    pub fn user() -> Option<Self> {
        Self::at(cache_folder()?)
    }

    /// A cache in a folder, which is made when needed; `None` if this program cannot read itself.
    pub fn at(folder: PathBuf) -> Option<Self> {
        let program = fs::read(std::env::current_exe().ok()?).ok()?;
        Some(Self {
            folder,
            program: Sha256::digest(program).into(),
        })
    }

    fn file(&self, plan: &Plan, assets: &Assets) -> PathBuf {
        let mut hash = Sha256::new();
        hash.update(self.program);
        hash.update(preset::write(&asked(plan)));
        hash.update(assets.contents(plan));
        let name: String = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        self.folder.join(format!("truth-{name}"))
    }

    /// The kept truth of a plan, if there is one and its file is intact.
    pub fn find(&self, plan: &Plan, assets: &Assets) -> Option<Truth> {
        unpack(&fs::read(self.file(plan, assets)).ok()?, plan.size)
    }

    /// Keeps a truth. Failure is ignored.
    pub fn keep(&self, plan: &Plan, assets: &Assets, truth: &Truth) {
        let write = || {
            let mut place = Place::prepare(&self.file(plan, assets))?;
            place.write_all(&pack(truth))?;
            picture::commit(vec![place])
        };
        if fs::create_dir_all(&self.folder).is_ok() && write().is_ok() {
            self.forget();
        }
    }

    /// Removes the oldest truths.
    fn forget(&self) {
        let Ok(entries) = fs::read_dir(&self.folder) else {
            return;
        };
        let is_truth = |e: &DirEntry| e.file_name().to_string_lossy().starts_with("truth-");
        let dated = |e: DirEntry| Some((e.metadata().ok()?.modified().ok()?, e.path()));
        let truths = entries.flatten().filter(is_truth);
        let mut all: Vec<_> = truths.filter_map(dated).collect();
        all.sort();
        for (_, path) in all.iter().rev().skip(MOST_KEPT) {
            let _ = fs::remove_file(path);
        }
    }
}

/// The truth of a plan, and whether the cache had it. If not, it is rendered and kept.
///
/// # Errors
/// [`RenderError::Cancelled`] if `watch` returns `false`. A named file cannot be read.
pub fn cached(
    cache: Option<&Cache>,
    plan: &Plan,
    assets: &Assets,
    watch: Watch<'_>,
) -> Result<(Truth, bool), RenderError> {
    if let Some(found) = cache.and_then(|c| c.find(plan, assets)) {
        return Ok((found, true));
    }
    let made = truth(plan, assets, watch)?;
    if let Some(cache) = cache {
        cache.keep(plan, assets, &made);
    }
    Ok((made, false))
}

/// The bytes of a truth's file: numbers, depth, colours, states, and a hash of all before it.
fn pack(truth: &Truth) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend(truth.note.stride.to_le_bytes());
    bytes.extend(truth.note.moved.to_le_bytes());
    bytes.extend(cast_slice::<f32, u8>(&truth.frame.depth));
    bytes.extend(cast_slice::<[f32; 3], u8>(&truth.frame.radiance));
    bytes.extend(&truth.frame.state);
    let hash = Sha256::digest(&bytes);
    bytes.extend(hash);
    bytes
}

fn unpack(bytes: &[u8], size: [u32; 2]) -> Option<Truth> {
    let (content, hash) = bytes.split_at_checked(bytes.len().checked_sub(32)?)?;
    if Sha256::digest(content).as_slice() != hash {
        return None;
    }
    let pixels = size[0] as usize * size[1] as usize;
    let mut rest = content;
    let mut take = |n: usize| {
        let (part, after) = rest.split_at_checked(n)?;
        rest = after;
        Some(part)
    };
    let note = TruthNote {
        stride: f64::from_le_bytes(take(8)?.try_into().ok()?),
        moved: f64::from_le_bytes(take(8)?.try_into().ok()?),
    };
    let frame = Frame {
        size,
        depth: pod_collect_to_vec(take(4 * pixels)?),
        radiance: pod_collect_to_vec(take(12 * pixels)?),
        state: take(pixels)?.to_vec(),
        ..Frame::default()
    };
    Some(Truth { frame, note })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{Formula, balls::Balls};
    use crate::heightfield::settings::HeightfieldSettings;
    use crate::heightfield::tracer::TracerKind;
    use crate::scene::Scene;

    /// The truth of a plan, and whether the cache had it.
    fn truth_of(cache: &Cache, plan: &Plan) -> (Truth, bool) {
        cached(Some(cache), plan, &Assets::default(), &mut |_| true).expect("nothing fails")
    }

    fn finds(cache: &Cache, plan: &Plan) -> bool {
        cache.find(plan, &Assets::default()).is_some()
    }

    fn plan(scene: impl Into<Scene>) -> Plan {
        let mut plan = Plan::new(scene);
        plan.size = [20, 15];
        plan
    }

    fn balls() -> Plan {
        plan(Formula::Balls(Balls::default()))
    }

    #[test]
    fn a_truth_of_heights_is_found_while_its_file_is_the_same() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::at(folder.path().join("kept")).expect("this program can be read");
        let file = folder.path().join("slope-4x3.raw");
        let of = |heights: [f32; 12]| {
            fs::write(&file, cast_slice::<f32, u8>(&heights)).expect("can be written");
            let mut shape = HeightfieldSettings::default();
            shape.source.field = file.to_string_lossy().into_owned();
            plan(shape)
        };
        let slope: [f32; 12] = std::array::from_fn(|i| i as f32 / 12.0);
        let first = of(slope);
        assert!(!truth_of(&cache, &first).1 && finds(&cache, &of(slope)));
        // The tracer does not matter.
        let mut other = of(slope);
        if let Scene::Heightfield(shape) = &mut other.scene {
            shape.tracer_settings.tracer = Some(TracerKind::CsmFixed);
        }
        assert!(other != first && finds(&cache, &other));
        // One height of the file does, with the same plan.
        let mut bent = slope;
        bent[5] += 1e-6;
        let second = of(bent);
        assert_eq!(preset::write(&first), preset::write(&second));
        assert!(!finds(&cache, &second));
    }

    #[test]
    fn a_kept_truth_is_found_for_its_own_plan_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::at(folder.path().into()).expect("this program can be read");
        let (made, before) = truth_of(&cache, &balls());
        let (found, after) = truth_of(&cache, &balls());
        assert!(!before && after);
        assert!(made.note.stride <= 0.1 && made.note.moved < CONVERGED);
        assert_eq!(found.frame.depth, made.frame.depth);
        assert_eq!(found.frame.state, made.frame.state);
        assert_eq!(found.frame.radiance, made.frame.radiance);
        assert_eq!(found.note, made.note);
        // The shell does not decide a truth, these settings do.
        let mut other = balls();
        other.march.shell = Some(0.7);
        assert!(finds(&cache, &other));
        let changes: [fn(&mut Plan); 4] = [
            |p| p.march.detail = 2.0,
            |p| p.size = [15, 20],
            |p| p.camera.fov += 1e-9,
            |p| p.look.key += 0.1,
        ];
        for change in changes {
            let mut other = balls();
            change(&mut other);
            assert!(!finds(&cache, &other));
        }
        let mut rebuilt = cache.clone();
        rebuilt.program[7] ^= 1;
        assert!(!finds(&rebuilt, &balls()));
        // A file that was cut or changed by one bit is ignored.
        let file = cache.file(&balls(), &Assets::default());
        let whole = fs::read(&file).expect("kept");
        let mut changed = whole.clone();
        changed[40] ^= 1;
        for wrong in [&whole[..whole.len() - 1], &changed[..], &[]] {
            fs::write(&file, wrong).expect("can be written");
            assert!(!finds(&cache, &balls()));
        }
    }
}
