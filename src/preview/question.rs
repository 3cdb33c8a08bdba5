//! What there is at a pixel, and by how much its distance is wrong.

use crate::base::outcome::State;
use crate::base::view::footprint;
use crate::gpu::pick::Pick;
use crate::measure::truth;
use crate::pass::pick::{At, Picked};
use crate::plan::Plan;
use crate::preview::live::Live;
use crate::preview::probe::{self, Probed};

/// A question to the device, and what the CPU knows already.
pub struct Question {
    pick: Pick,
    plan: Plan,
    pixel: [u32; 2],
    /// Evaluations of a ray in f64.
    evaluations: u32,
    truth: Probed,
}

impl Question {
    /// The answer in words.
    fn text(&self, found: &Picked) -> String {
        let [x, y] = self.pixel;
        let word = |state: State| format!("{state:?}").to_lowercase();
        let exact = self.truth.distance;
        let error = match (found.state, self.truth.state) {
            (Some(State::Hit), State::Hit) => {
                let ray = self.plan.view().view_ray(self.pixel);
                let off = (found.distance - exact) / footprint(&ray, exact);
                format!("{off:+.3} footprints from the truth")
            }
            (_, truth) => format!("the truth is {}", word(truth)),
        };
        format!(
            "pixel {x}, {y}: {} at {:.6}, {error}, {} evaluations by a ray alone",
            found.state.map_or_else(String::new, word),
            found.distance,
            self.evaluations
        )
    }
}

impl Live {
    /// Asks what there is at the pixel under the cursor.
    pub fn ask(&mut self, plan: Plan) {
        let pixel = self.pixel();
        let found = probe::pixel(&plan, self.assets(), pixel);
        let truth = probe::pixel(&truth::asked(&plan), self.assets(), pixel);
        let (Some(found), Some(truth)) = (found, truth) else {
            self.tell("the scene is not ready yet", false);
            return;
        };
        let pictures = &mut self.pictures;
        let pick = pictures
            .renderer
            .pick(&plan, &pictures.assets, At::Pixel(pixel));
        match pick {
            Ok(pick) => {
                self.question = Some(Question {
                    pick,
                    plan,
                    pixel,
                    evaluations: found.evaluations,
                    truth,
                });
            }
            Err(e) => self.tell(e.to_string(), true),
        }
    }

    /// Tells the answer, once there is one.
    pub fn answer_question(&mut self) {
        let Some(question) = &mut self.question else {
            return;
        };
        let (text, is_error) = match question.pick.poll() {
            Ok(None) => return,
            Ok(Some(found)) => (question.text(&found), false),
            Err(e) => (e.to_string(), true),
        };
        self.question = None;
        self.tell(text, is_error);
    }
}
