//! What leaving a scene drops, and how the user is asked first.

use crate::preview::live::Live;

/// What was asked for and not done yet, because it drops something.
#[derive(Debug, PartialEq, Eq)]
pub struct Leaving {
    /// The preset to open; `None` to close the window.
    to: Option<String>,
    /// Whether changes are lost that cannot be kept for the next start.
    work: bool,
    /// Whether a still is not written yet.
    still: bool,
}

impl Live {
    /// Closes the window. Unsaved work is offered at the next start.
    pub fn close(&mut self) {
        self.leave_field();
        // Without the film, the still is written sooner.
        self.play.playing = false;
        self.closed = self.may_leave(None);
    }

    /// Whether nothing is dropped, or this was asked for before. Else says what would be dropped.
    pub fn may_leave(&mut self, to: Option<&str>) -> bool {
        let asked = Leaving {
            to: to.map(String::from),
            work: !self.keep_now(),
            // A still goes on over another preset.
            still: to.is_none() && self.still.is_some(),
        };
        if (!asked.work && !asked.still) || self.leaving.as_ref() == Some(&asked) {
            return true;
        }
        let again = match to {
            None => "Ctrl+Q again drops",
            Some(_) => "the same choice again drops",
        };
        let text = match (asked.work, asked.still) {
            (true, true) => format!("changes and a still are not saved; {again} both"),
            (true, false) => format!("changes are not saved; {again} them"),
            _ => format!("the window closes when the still is written; {again} the still"),
        };
        self.leaving = Some(asked);
        self.tell(text, false);
        false
    }

    /// After a change of the document or its file: what was said of it holds no longer.
    pub fn stay(&mut self) {
        self.leaving.take_if(|asked| asked.work);
    }

    /// After a still was written: closes the window that waits for it.
    pub fn leave_after_still(&mut self) {
        let waits = self.leaving.take_if(|asked| asked.still);
        self.closed |= waits.is_some() && self.keep_now();
    }
}
