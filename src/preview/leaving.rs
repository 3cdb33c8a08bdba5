//! What leaving a scene drops, and how the user is asked first.

use crate::plan::Plan;
use crate::preview::live::Live;

/// What was asked for and not done yet, because it drops something.
#[derive(Debug, PartialEq)]
pub struct Leaving {
    /// The preset to open; `None` to close the window.
    to: Option<String>,
    /// Changes that cannot be kept for the next start.
    work: Option<Plan>,
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
            work: (!self.keep_now()).then(|| self.document.plan.clone()),
            // A still goes on over another preset.
            still: to.is_none() && self.still.is_some(),
        };
        if (asked.work.is_none() && !asked.still) || self.leaving.as_ref() == Some(&asked) {
            return true;
        }
        let again = match to {
            None => "Ctrl+Q again drops",
            Some(_) => "the same choice again drops",
        };
        let text = match (asked.work.is_some(), asked.still) {
            (true, true) => format!("changes and a still are not saved; {again} both"),
            (true, false) => format!("changes are not saved; Ctrl+S saves them, {again} them"),
            _ => format!("the window closes when the still is written; {again} the still"),
        };
        self.leaving = Some(asked);
        self.tell(text, false);
        false
    }

    /// After a still was written, or could not be: closes the window that waits for it.
    pub fn after_still(&mut self, is_written: bool) {
        let waits = self.leaving.take_if(|asked| asked.still);
        self.closed |= is_written && waits.is_some() && self.keep_now();
    }
}
