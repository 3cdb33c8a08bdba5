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
    /// The shader files, when they are read again.
    WithShaders,
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

    /// Ends a notice whose end has come.
    pub fn end_notice(&mut self, come: Ends) {
        let ends = |n: &mut Notice| {
            let most = if n.is_error { ERROR } else { NOTICE };
            n.ends == come && (come != Ends::Later || n.since.elapsed() > most)
        };
        if self.notice.take_if(ends).is_some() {
            self.paint_now();
        }
    }
}
