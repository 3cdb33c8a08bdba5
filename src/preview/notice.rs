//! What the window tells the user, and for how long.

use std::time::{Duration, Instant};

use crate::preview::live::Live;

/// How long a notice stays, and an error that nothing ends.
const NOTICE: Duration = Duration::from_secs(6);
const ERROR: Duration = Duration::from_secs(15);

/// What ends a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Time.
    Later,
    /// A full picture.
    WithPicture,
    /// The preset's file, when it can be read again.
    WithFile,
}

/// A notice to the user.
pub struct Notice {
    pub text: String,
    pub is_error: bool,
    ends: Ends,
    since: Instant,
}

impl Live {
    /// Tells the user something for a while.
    pub fn tell(&mut self, text: impl Into<String>, is_error: bool) {
        self.tell_until(text.into(), is_error, Ends::Later);
    }

    /// Tells what is wrong with the picture, unless that is told already.
    pub fn warn(&mut self, text: String) {
        let told = |n: &Notice| n.text.ends_with(&text);
        if !self.notice.as_ref().is_some_and(told) {
            self.tell_until(text, true, Ends::WithPicture);
        }
    }

    /// Tells the user something.
    pub fn tell_until(&mut self, text: String, is_error: bool, ends: Ends) {
        self.notice = Some(Notice {
            text,
            is_error,
            ends,
            since: Instant::now(),
        });
        self.paint_now();
    }

    /// Takes in whether a shader text is wrong, which is told until it is right. Returns whether that is
    /// new.
    pub fn look_at_shaders(&mut self) -> bool {
        let now = self.pictures.renderer.shader_error();
        let is_new = now != self.shader_error;
        if is_new {
            self.shader_error = now;
            self.paint_now();
        }
        is_new
    }

    /// What is told now, and whether it is an error.
    pub fn told(&self) -> Option<(String, bool)> {
        let notice = self.notice.as_ref();
        let lines = [self.shader_error.as_ref(), notice.map(|n| &n.text)];
        let lines: Vec<&str> = lines.into_iter().flatten().map(String::as_str).collect();
        let is_error = self.shader_error.is_some() || notice.is_some_and(|n| n.is_error);
        (!lines.is_empty()).then(|| (lines.join("\n"), is_error))
    }

    /// Ends a notice whose end has come.
    pub fn end_notice(&mut self, come: Ends) {
        self.look_at_shaders();
        let ends = |n: &mut Notice| {
            let most = if n.is_error { ERROR } else { NOTICE };
            n.ends == come && (come != Ends::Later || n.since.elapsed() > most)
        };
        if self.notice.take_if(ends).is_some() {
            self.paint_now();
        }
    }
}
