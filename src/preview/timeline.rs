//! The timeline: a row for each track, its keys, and the moment that is shown.

use egui::{Align2, Color32, CursorIcon, FontId, Pos2, Rect, Sense, Stroke, Ui, Vec2};

use crate::plan::Plan;
use crate::preview::play::{Place, Play, retime};

/// Height of a row and of the ruler, and width of the names, in points.
const ROW: f32 = 18.0;
const RULER: f32 = 20.0;
const NAMES: f32 = 110.0;
/// Half the size of a key's mark.
const MARK: f32 = 5.0;

/// What the timeline asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The plan with other keys.
    pub plan: Option<Plan>,
    /// Whether a key is dragged, so that all places until its end are one step.
    pub dragging: bool,
    /// Whether another moment is shown.
    pub moved: bool,
}

/// The height that the timeline needs.
pub fn height(plan: &Plan) -> f32 {
    RULER + ROW * (plan.tracks.len().clamp(1, 8)) as f32 + 6.0
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
pub fn show(ui: &mut Ui, plan: &Plan, play: &mut Play) -> Asked {
    let mut asked = Asked::default();
    let all = ui.available_rect_before_wrap();
    let scale = Scale {
        rect: Rect::from_min_max(
            Pos2::new(all.left() + NAMES, all.top()),
            Pos2::new(all.right() - 12.0, all.bottom()),
        ),
        length: plan.time.length,
    };
    ruler(ui, plan, play, &scale, &mut asked);
    for (index, track) in plan.tracks.iter().enumerate() {
        let top = all.top() + RULER + ROW * index as f32;
        let middle = top + 0.5 * ROW;
        if top + ROW > all.bottom() + 1.0 {
            break;
        }
        let painter = ui.painter();
        painter.text(
            Pos2::new(all.left() + 4.0, middle),
            Align2::LEFT_CENTER,
            track.of.replace('.', " "),
            FontId::proportional(11.5),
            Color32::LIGHT_GRAY,
        );
        painter.hline(
            scale.rect.x_range(),
            middle,
            Stroke::new(1.0, Color32::from_gray(60)),
        );
        for key in 0..track.keys.len() {
            let place = Place { track: index, key };
            mark(ui, plan, play, &scale, (place, middle), &mut asked);
        }
    }
    let x = scale.x(play.beat);
    let line = Stroke::new(1.5, Color32::from_rgb(240, 160, 60));
    ui.painter().vline(x, all.y_range(), line);
    ui.advance_cursor_after_rect(all);
    asked
}

/// Marks of beats, the played part, and where the moment is dragged.
fn ruler(ui: &mut Ui, plan: &Plan, play: &mut Play, scale: &Scale, asked: &mut Asked) {
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
    (place, y): (Place, f32),
    asked: &mut Asked,
) {
    let time = plan.tracks[place.track].keys[place.key].time;
    let center = Pos2::new(scale.x(time), y);
    let rect = Rect::from_center_size(center, Vec2::splat(2.0 * MARK + 4.0));
    let id = ui.scope_id().with(("key", place.track, place.key));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    if response.clicked() || response.drag_started() {
        play.chosen = Some(place);
        play.beat = time;
        asked.moved = true;
    }
    // The mark under the pointer changes its number on its way, so the chosen one is moved.
    if response.dragged()
        && let (Some(at), Some(chosen)) = (ui.input(|i| i.pointer.interact_pos()), play.chosen)
    {
        asked.dragging = true;
        let copy = response.drag_started() && ui.input(|input| input.modifiers.alt);
        let to = scale.beat(at.x);
        let mut plan = plan.clone();
        play.chosen = Some(retime(&mut plan, chosen, to, copy));
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
