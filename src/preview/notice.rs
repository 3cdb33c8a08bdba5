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
        if !self.standing.iter().any(|n| n.text == text) {
            self.tell_until(text, true, Ends::WithPicture);
        }
    }

    /// Tells the user something. What ends with time stands beside what does not.
    pub fn tell_until(&mut self, text: String, is_error: bool, ends: Ends) {
        let notice = Notice {
            text,
            is_error,
            ends,
            since: Instant::now(),
        };
        match ends {
            Ends::Later => self.notice = Some(notice),
            _ => {
                self.standing.retain(|n| n.ends != ends);
                self.standing.push(notice);
            }
        }
        self.paint_now();
    }

    /// Takes in whether a shader text is wrong, which is told until it is right.
    pub fn look_at_shaders(&mut self) {
        let now = self.pictures.renderer.shader_error();
        if now.as_ref() != self.shader_error.as_ref().map(|(text, _)| text) {
            self.shader_error = now.map(|text| (text, false));
            self.paint_now();
        }
    }

    /// What is told now, and whether it is an error.
    pub fn told(&self) -> Option<(String, bool)> {
        let notices = self.standing.iter().chain(&self.notice);
        let lines = notices.clone().map(|n| &n.text);
        let lines: Vec<&str> = self
            .shader_error
            .iter()
            .map(|(text, _)| text)
            .chain(lines)
            .map(String::as_str)
            .collect();
        let is_error = self.shader_error.is_some() || notices.clone().any(|n| n.is_error);
        (!lines.is_empty()).then(|| (lines.join("\n"), is_error))
    }

    /// Ends the notices whose end has come.
    pub fn end_notice(&mut self, come: Ends) {
        self.look_at_shaders();
        let stand = self.standing.len();
        self.standing.retain(|n| n.ends != come);
        let is_over = |n: &mut Notice| {
            let most = if n.is_error { ERROR } else { NOTICE };
            n.since.elapsed() > most
        };
        if self.notice.take_if(is_over).is_some() || self.standing.len() < stand {
            self.paint_now();
        }
    }
}
