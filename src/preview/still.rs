//! A still that is rendered while the window rests.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::gpu::RenderError;
use crate::gpu::device::DeviceError;
use crate::gpu::render::Renderer;
use crate::gpu::work::Work;
use crate::picture::frame::Frame;
use crate::picture::{BitDepth, Layer, Place, Shades, write_png};
use crate::plan::{Extras, Plan};
use crate::preset;
use crate::preview::document::{unused, write};
use crate::scene::Assets;

/// Milliseconds of work in each turn of the loop.
const SLICE_MS: f64 = 20.0;

/// A still under way.
pub struct Still {
    plan: Plan,
    /// Its file is called after this.
    name: String,
    work: Option<Work>,
    written: Option<Receiver<Result<PathBuf, String>>>,
}

impl Still {
    /// Begins a still of a plan that passes [`Plan::check`].
    ///
    /// # Errors
    /// The device failed or has no room, or the file cannot be written.
    pub fn begin(
        renderer: &mut Renderer,
        plan: Plan,
        assets: &Assets,
        name: String,
    ) -> Result<Self, String> {
        if plan.is_stereo() {
            return Err(
                "camera.stereo: the window writes no pairs; save the preset and use `conemarch render`, or set stereo to off".into(),
            );
        }
        // A folder that cannot be written is found before the work.
        Place::prepare(&unused(Path::new("."), &name, "png")).map_err(|e| e.to_string())?;
        // As `render` makes the same picture.
        let extras = Extras {
            rays: Some(plan.rays()),
            ..Extras::default()
        };
        let work = renderer.begin(&plan, assets, extras);
        Ok(Self {
            work: Some(work.map_err(|e| e.to_string())?),
            plan,
            name,
            written: None,
        })
    }

    /// The same on another device, unless the picture is made already.
    ///
    /// # Errors
    /// As [`Still::begin`].
    pub fn again(self, renderer: &mut Renderer, assets: &Assets) -> Result<Self, String> {
        match self.work {
            Some(_) => Self::begin(renderer, self.plan, assets, self.name),
            None => Ok(self),
        }
    }

    /// How much is done.
    pub fn done(&self) -> f64 {
        self.work.as_ref().map_or(1.0, |work| work.progress().done)
    }

    /// Goes on. Returns the file once it is written, or why it is not.
    pub fn advance(&mut self) -> Option<Result<PathBuf, String>> {
        if let Some(work) = &mut self.work {
            let advanced = work.advance(SLICE_MS).and_then(|()| work.poll());
            match advanced {
                Ok(None) => return None,
                Ok(Some(frame)) => self.write(frame),
                // The window opens the device again, and then this begins again.
                Err(RenderError::Device(DeviceError::Lost { .. })) => return None,
                Err(e) => return Some(Err(e.to_string())),
            }
            self.work = None;
        }
        match self.written.as_ref()?.try_recv() {
            Ok(written) => Some(written),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the still was not written".into())),
        }
    }

    /// Writes the file on a thread of its own.
    fn write(&mut self, frame: Frame) {
        let (send, receive) = channel();
        let (plan, name) = (self.plan.clone(), self.name.clone());
        std::thread::spawn(move || {
            // Another window may have written a still since this one began.
            let path = unused(Path::new("."), &name, "png");
            let mut content = Vec::new();
            let shades = Shades::new(Layer::Color, &frame, &plan);
            let text = preset::write_beside(&plan, &path);
            let to = &mut Cursor::new(&mut content);
            let encoded = write_png(to, &shades, BitDepth::Eight, &plan.title, &text);
            let written = encoded.and_then(|()| write(&path, &content));
            // The window may be closed by now.
            let _ = send.send(written.map(|()| path).map_err(|e| e.to_string()));
        });
        self.written = Some(receive);
    }
}
