//! What keeps a session going: files that change or are opened, stills, unsaved work, and lost devices.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::base::key::Fault;
use crate::gpu::RenderError;
use crate::gpu::device::DeviceError;
use crate::plan::Plan;
use crate::preset;
use crate::preview::document::Document;
use crate::preview::error::PreviewError;
use crate::preview::gui;
use crate::preview::keep::{self, Slot};
use crate::preview::live::Live;
use crate::preview::notice::Ends;
use crate::preview::pictures::Pictures;
use crate::preview::play::has_still_of;
use crate::preview::reload::{Watched, files_in, sources};
use crate::preview::still::Still;

/// Time after a change until it is kept.
const KEEP: Duration = Duration::from_secs(1);
/// So often a device is opened again before there is a full picture.
const MOST_LOSSES: u32 = 3;

impl Live {
    /// After an error: a lost device is opened again, and everything else is told.
    pub fn failed(&mut self, error: RenderError) -> Result<(), PreviewError> {
        let lost = match error {
            RenderError::Device(lost @ DeviceError::Lost { .. }) => lost,
            RenderError::Kernel(_) if self.options.wgsl.is_some() => {
                self.look_at_shaders();
                let tried = self.shader_error.as_mut().map(|(_, tried)| tried);
                match tried.map(|tried| std::mem::replace(tried, true)) {
                    // The last shaders that worked make the picture.
                    Some(false) => self.pictures.again(),
                    Some(true) => {}
                    None => self.warn(error.to_string()),
                }
                return Ok(());
            }
            _ => {
                self.warn(error.to_string());
                return Ok(());
            }
        };
        self.keep_now();
        self.losses += 1;
        if self.losses > MOST_LOSSES {
            return Err(lost.into());
        }
        self.stage.reopen()?;
        let mut pictures = Pictures::new(self.stage.screen.device().clone());
        pictures.assets = self.pictures.assets.clone();
        self.pictures = pictures;
        self.question = None;
        // The new device has no textures of the panel.
        let device = &self.stage.screen.device().device;
        let most = device.limits().max_texture_dimension_2d as usize;
        let memory = self.ctx.memory(Clone::clone);
        self.ctx = gui::context();
        self.ctx.memory_mut(|new| *new = memory);
        self.gui = egui_winit::State::new(
            self.ctx.clone(),
            egui::ViewportId::ROOT,
            &self.stage.window,
            Some(self.stage.window.scale_factor() as f32),
            None,
            Some(most),
        );
        let shaders = match self.options.wgsl {
            Some(_) => "; it has the program's own shaders until a file of --wgsl changes",
            None => "",
        };
        self.tell(
            format!("the device was lost and is open again{shaders}"),
            false,
        );
        // A still begins again.
        if let Some(still) = self.still.take() {
            let pictures = &mut self.pictures;
            match still.again(&mut pictures.renderer, &pictures.assets) {
                Ok(still) => self.still = Some(still),
                Err(why) => {
                    self.after_still(false);
                    self.tell(why, true);
                }
            }
        }
        Ok(())
    }

    /// Waits for another plan, since this one does not fit.
    ///
    /// # Errors
    /// The device was lost, and does not open again.
    pub fn rest_on(&mut self, fault: &Fault) -> Result<(), PreviewError> {
        self.warn(format!("{}: {}", fault.key, fault.why));
        self.pictures.rest();
        self.go_on_with_still();
        match self.pictures.advance() {
            Ok(_) => Ok(()),
            Err(lost) => self.failed(lost),
        }
    }

    /// Goes on with what a hidden window does.
    ///
    /// # Errors
    /// The device was lost, and does not open again.
    pub fn go_on_hidden(&mut self) -> Result<(), PreviewError> {
        self.go_on_with_still();
        match self.pictures.renderer.device.check() {
            Ok(()) => Ok(()),
            Err(lost) => self.failed(lost.into()),
        }
    }

    /// Goes on with a still, and tells when it is written.
    pub fn go_on_with_still(&mut self) {
        let Some(said) = self.still.as_mut().and_then(Still::advance) else {
            return;
        };
        self.still = None;
        match said {
            Ok(path) => {
                self.tell(format!("wrote {}", path.display()), false);
                self.after_still(true);
            }
            Err(why) => {
                self.after_still(false);
                self.tell(why, true);
            }
        }
    }

    /// Takes in files that have changed.
    pub fn look_at_files(&mut self) {
        let folder = self.options.wgsl.as_ref();
        let there = folder.map(|folder| files_in(folder)).unwrap_or_default();
        let others = self.shader_files.others(&there);
        if others {
            self.shader_files = Watched::new(there);
        }
        if self.shader_files.changed() || others {
            // After a loss they were set aside.
            self.pictures.renderer.sources = self.options.wgsl.clone().map(sources);
            self.pictures.again();
            self.shader_error = None;
            self.tell("shaders read again", false);
        }
        if let Some(gone) = self.preset_file.vanished() {
            let text = format!("{} is gone; Ctrl+S writes it again", gone.display());
            self.tell_until(text, true, Ends::WithFile);
        }
        if !self.preset_file.changed() {
            return;
        }
        let Some(path) = self.document.path.clone() else {
            return;
        };
        let loaded = preset::load(&path, &self.options.sets);
        self.unread = loaded.is_err();
        if !self.unread {
            self.end_notice(Ends::WithFile);
        }
        match loaded {
            Ok(preset) if preset.plan == *self.document.saved() => {}
            Ok(preset) => {
                let was_changed = self.document.is_changed();
                if was_changed {
                    // It stays for the next start.
                    self.keep_now();
                    self.release_kept();
                }
                self.document.reload(preset.plan);
                self.show_moment();
                let undo = if was_changed {
                    "; Ctrl+Z returns to your changes"
                } else {
                    ""
                };
                self.tell(format!("read {} again{undo}", path.display()), false);
            }
            Err(e) => self.tell_until(e.to_string(), true, Ends::WithFile),
        }
    }

    /// After the document was saved: its file is the one to watch.
    pub fn watch_file(&mut self) {
        self.preset_file = Watched::new(self.document.path.iter().cloned().collect());
        self.unread = false;
        self.end_notice(Ends::WithFile);
        // What was set from outside is in the file now.
        self.options.sets.clear();
        self.drop_kept();
    }

    /// Opens another preset in the place of this one.
    pub fn open(&mut self, name: &str) {
        if !self.may_leave(Some(name)) {
            return;
        }
        self.leaving = None;
        match preset::load(Path::new(name), &[]) {
            Ok(preset) => {
                let path: Option<PathBuf> = preset::file(Path::new(name));
                self.stage
                    .window
                    .set_title(&format!("{} - conemarch", preset.name));
                self.visible.timeline = !preset.plan.tracks.is_empty();
                self.play = Default::default();
                self.release_kept();
                self.unread = false;
                self.end_notice(Ends::WithFile);
                self.document = Document::new(preset.name, path, preset.plan);
                self.options.sets.clear();
                self.offer();
                self.preset_file = Watched::new(self.document.path.iter().cloned().collect());
                self.show_moment();
            }
            Err(e) => self.tell(e.to_string(), true),
        }
    }

    /// Keeps unsaved work now and then, so that it survives a crash.
    pub fn keep_work(&mut self) {
        let is_kept = self.kept(self.document.work()) == Some(&self.document.plan);
        if !self.document.is_changed() {
            self.keep_now();
        } else if is_kept {
            self.unkept = None;
        } else if self.unkept.get_or_insert_with(Instant::now).elapsed() > KEEP
            // What does not fit is told as such, and kept when it fits.
            && self.document.plan.check().is_ok()
        {
            let could_keep = self.keeps;
            self.keeps = self.keep_now();
            if could_keep && !self.keeps {
                self.tell(
                    "changes cannot be kept for the next start; Ctrl+S saves them",
                    true,
                );
            }
        }
    }

    /// Offers unsaved work that was kept, or says where there is other work. New work is kept beside it.
    pub fn offer(&mut self) {
        let folder = self.options.kept.as_deref();
        self.offered = keep::find(folder, &self.document);
        let elsewhere = keep::elsewhere(folder, &self.document);
        if let Some(text) = elsewhere.filter(|_| self.offered.is_none()) {
            self.tell(text, false);
        }
    }

    /// Takes or discards the work that is offered. What was changed before is a step, and stays for
    /// the next start.
    pub fn take_offer(&mut self, restore: bool) {
        let Some((slot, plan)) = self.offered.take() else {
            return;
        };
        let kept = self.options.kept.clone();
        let Some(mut slot) = Slot::of(kept.as_deref(), &self.document, slot) else {
            self.tell("another window has taken this work", false);
            return;
        };
        if restore {
            self.keep_now();
            self.document.restore(plan);
            self.play.fit(self.document.plan.time.length);
            self.slots.insert(self.document.work(), slot);
            // Of a film, what was kept was made at some moment of it, or from another view.
            if has_still_of(&self.document.plan, self.document.saved()) {
                self.show_moment();
            }
            self.keep_now();
        } else {
            slot.drop();
        }
        if !restore && !self.document.is_changed() {
            // There may be older work.
            self.offer();
        }
        self.paint_soon(Duration::ZERO);
    }

    /// Leaves what is kept for the next start. New work is kept beside it.
    pub fn release_kept(&mut self) {
        self.slots.clear();
        self.unkept = None;
    }

    fn drop_kept(&mut self) {
        if let Some(mut slot) = self.slots.remove(&self.document.work()) {
            slot.drop();
        }
        self.unkept = None;
    }

    /// Forgets what was kept of work that is saved now. What this window keeps nothing of is the same
    /// work from now on.
    pub fn drop_saved(&mut self) {
        self.drop_kept();
        let kept = |work| self.slots.get(&work).and_then(Slot::kept).is_some();
        self.document.join(|work| !kept(work));
    }

    /// What this window has kept of a work.
    fn kept(&self, work: u32) -> Option<&Plan> {
        self.slots.get(&work).and_then(Slot::kept)
    }

    /// Keeps unsaved work, and returns whether all of it is kept. What cannot be read again takes the
    /// place of nothing.
    pub fn keep_now(&mut self) -> bool {
        self.unkept = None;
        if !self.document.is_changed() {
            // All of it was undone.
            if self.kept(self.document.work()).is_some() {
                self.drop_kept();
            }
            return true;
        }
        let folder = self.options.kept.as_deref();
        let is_right = self.document.plan.check().is_ok();
        let slot = self.slots.entry(self.document.work()).or_default();
        is_right && slot.keep(folder, &self.document).unwrap_or(false)
    }
}
