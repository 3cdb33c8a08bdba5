//! The timeline: a row for each track, its keys, and the moment that is shown.

use egui::{Align2, Color32, CursorIcon, FontId, Pos2, Rect, ScrollArea, Sense, Stroke, Ui, Vec2};

use crate::plan::Plan;
use crate::preview::play::{Play, TimelineKey, retime};
use crate::time::track::Track;

/// Height of a row and of the ruler, and width of the names, in points.
const ROW: f32 = 18.0;
const RULER: f32 = 20.0;
const NAMES: f32 = 110.0;
/// Rows that are shown at once; the others are scrolled to.
const ROWS: usize = 8;
/// Half the size of a key's mark.
const MARK: f32 = 5.0;

/// What the timeline asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimelineRequest {
    /// The plan with other keys.
    pub plan: Option<Plan>,
    /// Whether a key is dragged, so that all places until its end are one step.
    pub dragging: bool,
    /// Whether another moment is shown.
    pub moved: bool,
}

/// The height that the timeline needs.
pub fn height(plan: &Plan) -> f32 {
    RULER + ROW * (plan.tracks.len().clamp(1, ROWS)) as f32 + 6.0
}

/// Places of beats in a rectangle.
struct Scale {
    rect: Rect,
    length: f64,
}

impl Scale {
    fn x(&self, beat: f64) -> f32 {
        self.rect.left() + (beat / self.length) as f32 * self.rect.width()
    }

    fn beat(&self, x: f32) -> f64 {
        let share = f64::from((x - self.rect.left()) / self.rect.width());
        share.clamp(0.0, 1.0) * self.length
    }
}

/// Beats between two marks of the ruler, so that about ten fit.
fn step(length: f64) -> f64 {
    let least = length / 12.0;
    let ten = 10f64.powf(least.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0].into_iter();
    factors
        .map(|f| f * ten)
        .find(|step| *step >= least)
        .unwrap_or(least)
}

/// Shows the timeline and edits it.
pub fn show(ui: &mut Ui, plan: &Plan, play: &mut Play) -> TimelineRequest {
    let mut asked = TimelineRequest::default();
    let all = ui.available_rect_before_wrap();
    let scale = Scale {
        rect: Rect::from_min_max(
            Pos2::new(all.left() + NAMES, all.top()),
            Pos2::new(all.right() - 12.0, all.bottom()),
        ),
        length: plan.time.length,
    };
    ruler(ui, plan, play, &scale, &mut asked);
    let below = Rect::from_min_max(Pos2::new(all.left(), all.top() + RULER), all.max);
    let mut rows = ui.new_child(egui::UiBuilder::new().max_rect(below));
    ScrollArea::vertical().show(&mut rows, |ui| {
        let size = Vec2::new(below.width(), ROW * plan.tracks.len() as f32);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        for (index, track) in plan.tracks.iter().enumerate() {
            let middle = rect.top() + ROW * (index as f32 + 0.5);
            row(ui, plan, play, &scale, (track, middle), &mut asked);
        }
    });
    let x = scale.x(play.beat);
    let line = Stroke::new(1.5, Color32::from_rgb(240, 160, 60));
    ui.painter().vline(x, all.y_range(), line);
    ui.advance_cursor_after_rect(all);
    asked
}

/// The name of a track and its keys.
fn row(
    ui: &mut Ui,
    plan: &Plan,
    play: &mut Play,
    scale: &Scale,
    (track, middle): (&Track, f32),
    asked: &mut TimelineRequest,
) {
    ui.painter().text(
        Pos2::new(scale.rect.left() - NAMES + 4.0, middle),
        Align2::LEFT_CENTER,
        track.of.replace('.', " "),
        FontId::proportional(11.5),
        Color32::LIGHT_GRAY,
    );
    let line = Stroke::new(1.0, Color32::from_gray(60));
    ui.painter().hline(scale.rect.x_range(), middle, line);
    for (index, key) in track.keys.iter().enumerate() {
        let place = TimelineKey {
            of: track.of.clone(),
            time: key.time,
        };
        mark(ui, plan, play, scale, (place, index, middle), asked);
    }
}

/// Marks of beats, the played part, and where the moment is dragged.
fn ruler(ui: &mut Ui, plan: &Plan, play: &mut Play, scale: &Scale, asked: &mut TimelineRequest) {
    let rect = Rect::from_min_size(scale.rect.min, Vec2::new(scale.rect.width(), RULER));
    let response = ui.interact(rect, ui.scope_id().with("ruler"), Sense::click_and_drag());
    if let Some(at) = response.interact_pointer_pos() {
        play.beat = scale.beat(at.x);
        asked.moved = true;
    }
    let painter = ui.painter();
    painter.rect_filled(rect, 0.0, Color32::from_gray(38));
    let step = step(scale.length);
    for i in 0..=(scale.length / step) as u32 {
        let x = scale.x(f64::from(i) * step);
        painter.vline(x, rect.y_range(), Stroke::new(1.0, Color32::from_gray(90)));
        painter.text(
            Pos2::new(x + 2.0, rect.top() + 1.0),
            Align2::LEFT_TOP,
            // Without the roundings of the product.
            format!("{}", (f64::from(i) * step * 1e6).round() / 1e6),
            FontId::proportional(10.0),
            Color32::GRAY,
        );
    }
    let seconds = play.beat / plan.time.beats(1.0);
    painter.text(
        Pos2::new(scale.rect.left() - NAMES + 4.0, rect.top() + 3.0),
        Align2::LEFT_TOP,
        format!("{:.2} s", seconds),
        FontId::proportional(12.0),
        Color32::WHITE,
    );
    handles(ui, play, scale, rect);
}

/// The two ends of the part that is played again and again.
fn handles(ui: &mut Ui, play: &mut Play, scale: &Scale, rect: Rect) {
    let mut range = play.range.unwrap_or([0.0, scale.length]);
    for end in 0..2 {
        let x = scale.x(range[end]);
        let handle = Rect::from_center_size(Pos2::new(x, rect.bottom() - 4.0), Vec2::splat(9.0));
        let id = ui.scope_id().with(("handle", end));
        let response = ui
            .interact(handle, id, Sense::click_and_drag())
            .on_hover_cursor(CursorIcon::ResizeHorizontal);
        if let Some(at) = response.interact_pointer_pos()
            && response.dragged()
        {
            range[end] = scale.beat(at.x);
            if range[0] < range[1] {
                let whole = range == [0.0, scale.length];
                play.range = (!whole).then_some(range);
            }
        }
        let color = match play.range.is_some() {
            true => Color32::from_rgb(120, 180, 255),
            false => Color32::from_gray(120),
        };
        ui.painter().rect_filled(handle.shrink(1.5), 2.0, color);
    }
}

/// A key: chosen by a click, moved by a drag, copied by a drag with Alt.
fn mark(
    ui: &mut Ui,
    plan: &Plan,
    play: &mut Play,
    scale: &Scale,
    (place, index, y): (TimelineKey, usize, f32),
    asked: &mut TimelineRequest,
) {
    let center = Pos2::new(scale.x(place.time), y);
    let rect = Rect::from_center_size(center, Vec2::splat(2.0 * MARK + 4.0));
    let id = ui.scope_id().with(("key", &place.of, index));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    if response.clicked() || response.drag_started() {
        play.chosen = Some(place.clone());
        play.copies = response.drag_started() && ui.input(|input| input.modifiers.alt);
        play.beat = place.time;
        asked.moved = true;
    }
    // The mark under the pointer changes its number on its way, so the chosen one is moved.
    if response.dragged()
        && let (Some(at), Some(chosen)) = (ui.input(|i| i.pointer.interact_pos()), &play.chosen)
    {
        asked.dragging = true;
        let to = scale.beat(at.x);
        let mut plan = plan.clone();
        let moved = retime(&mut plan, chosen, to, play.copies);
        // The copy is made as soon as it has a place of its own.
        play.copies &= moved == *chosen;
        play.chosen = Some(moved);
        asked.plan = Some(plan);
    }
    let color = match play.chosen == Some(place) {
        true => Color32::from_rgb(255, 190, 90),
        false => Color32::from_rgb(180, 200, 230),
    };
    let corners = [(0.0, -MARK), (MARK, 0.0), (0.0, MARK), (-MARK, 0.0)];
    let points = corners.map(|(x, y)| center + Vec2::new(x, y)).to_vec();
    ui.painter()
        .add(egui::Shape::convex_polygon(points, color, Stroke::NONE));
}
