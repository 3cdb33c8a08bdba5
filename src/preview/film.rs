//! What the open window does with the film of its document.

use crate::plan::Plan;
use crate::preview::document::Document;
use crate::preview::live::{Live, PANEL};
use crate::preview::play::{overwrite, remove, shows_film};

impl Live {
    /// Shows the moment of the film under the playhead.
    pub fn show_moment(&mut self) {
        // Another program may have made the film shorter.
        self.play.fit(self.document.plan.time.length);
        if let Some(wrong) = self.document.go_to(self.play.beat) {
            self.warn(wrong);
        }
        self.paint_soon(PANEL);
    }

    /// Shows another moment after the playhead has moved. At the same one, a view that is not of the
    /// film stays.
    pub fn follow_playhead(&mut self) {
        if self.play.beat != self.document.beat {
            // What is flown so far is a step; a drag of a key goes on.
            if !self.panel_drag {
                self.document.end();
            }
            self.show_moment();
        }
    }

    /// Undoes or redoes a step. Under another playhead than that of the step, its film is shown at
    /// the present one, unless it showed another view than that of the film.
    pub fn go_back(&mut self, step: fn(&mut Document) -> Option<f64>) {
        // Else the next moment of the film would take the place of what comes back.
        self.play.playing = false;
        let tracks = self.document.plan.tracks.clone();
        let Some(beat) = step(&mut self.document) else {
            return;
        };
        self.unkept = None;
        let plan = &self.document.plan;
        // The film may be shorter than before.
        self.play.fit(plan.time.length);
        if beat != self.play.beat && (tracks != plan.tracks || shows_film(plan, beat)) {
            // A view that comes back with other tracks stays a step.
            self.document.beat = beat;
            self.show_moment();
        }
    }

    /// Changes keys, and shows the moment again if that made a step. A view that is not of the film
    /// stays otherwise.
    pub fn change_keys(&mut self, change: impl FnOnce(&mut Plan)) {
        // What is flown so far is a step.
        self.document.end();
        let before = self.document.plan.clone();
        self.document.change(change);
        if self.document.plan != before {
            self.show_moment();
        }
    }

    /// Overwrites the chosen key with what is shown.
    pub fn overwrite_key(&mut self) {
        let chosen = self.play.chosen.clone();
        let mut done = false;
        self.change_keys(|plan| done = chosen.is_some_and(|place| overwrite(plan, &place)));
        if !done {
            self.tell("no key of the timeline is chosen; click one", true);
        }
    }

    /// Takes the chosen key away.
    pub fn remove_key(&mut self) {
        if let Some(place) = self.play.chosen.take() {
            self.change_keys(|plan| remove(plan, &place));
        }
    }
}
