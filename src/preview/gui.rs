//! The panel, the timeline and what else lies over the picture, painted when something changed.

use std::time::{Duration, Instant};

use egui::{Button, ComboBox, Context, Order, Panel, Rect, ScrollArea, Ui};

use winit::dpi::PhysicalPosition;

use crate::plan::Plan;
use crate::preset::BUILTIN;
use crate::preview::flight::Pace;
use crate::preview::live::Live;
use crate::preview::play::set_key;
use crate::preview::window::REST;
use crate::preview::{overlay, panel, timeline};

/// Width of the panel in points: the name of a key and three numbers, and of the bar that scrolls it.
const WIDTH: f32 = 350.0;
const BAR: f32 = 10.0;

/// The state of the panels, without a cursor that blinks: each blink would paint all again.
pub fn context() -> Context {
    let ctx = Context::default();
    ctx.all_styles_mut(|style| style.visuals.text_cursor.blink = false);
    ctx
}

/// What the user asked for in one painting.
#[derive(Default)]
struct Requests {
    panel: panel::PanelRequest,
    timeline: timeline::TimelineRequest,
    open: Option<&'static str>,
    restore: Option<bool>,
    /// Where panels are.
    parts: Vec<Rect>,
}

impl Live {
    /// Paints the panel as soon as it may be painted: the user waits for it.
    pub fn paint_now(&mut self) {
        self.paint_soon(Duration::ZERO);
        self.urgent = true;
    }

    /// Paints the panel after a time, or earlier if that was asked for already.
    pub fn paint_soon(&mut self, after: Duration) {
        let at = Instant::now() + after;
        self.panel_due = Some(self.panel_due.map_or(at, |due| due.min(at)));
    }

    /// Runs the panel and paints it.
    pub fn paint(&mut self) {
        (self.panel_due, self.urgent) = (None, false);
        if !self.stage.screen.works() {
            return;
        }
        let input = self.gui.take_egui_input(&self.stage.window);
        let mut asked = Requests::default();
        let ctx = self.ctx.clone();
        let output = ctx.run_ui(input, |ui| self.lay_out(ui, &mut asked));
        self.gui
            .handle_platform_output(&self.stage.window, output.platform_output);
        let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
        self.panels = pixels(&asked.parts, output.pixels_per_point);
        asked.parts.extend(areas(&ctx));
        self.over = pixels(&asked.parts, output.pixels_per_point);
        let textures = output.textures_delta;
        let screen = &mut self.stage.screen;
        screen.paint_panel(textures, &primitives, output.pixels_per_point);
        self.redraw = true;
        let root = output.viewport_output.get(&egui::ViewportId::ROOT);
        // Much later is never.
        if let Some(delay) = root.map(|v| v.repaint_delay).filter(|d| *d < 10 * REST) {
            self.paint_soon(delay.max(Duration::from_millis(10)));
        }
        self.answer(asked);
    }

    fn lay_out(&mut self, ui: &mut Ui, asked: &mut Requests) {
        let ctx = ui.ctx().clone();
        if std::mem::take(&mut self.leaves_field) {
            ctx.memory_mut(|memory| memory.stop_text_input());
        }
        let plan = self.document.plan.clone();
        if self.visible.panel {
            let panel = Panel::right("panel")
                .resizable(false)
                .exact_size(WIDTH)
                .show_separator_line(false)
                .show(ui, |ui| {
                    self.head(ui, asked);
                    let usual = Plan::new(plan.scene.usual());
                    // Else it lies over the buttons.
                    ui.spacing_mut().scroll.floating_allocated_width = BAR;
                    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                        asked.panel = panel::show(ui, &plan, &usual);
                    });
                });
            asked.parts.push(panel.response.rect);
        }
        if self.visible.timeline {
            let line = Panel::bottom("timeline")
                .resizable(false)
                .exact_size(timeline::height(&plan))
                .show_separator_line(false)
                .show(ui, |ui| {
                    asked.timeline = timeline::show(ui, &plan, &mut self.play);
                });
            asked.parts.push(line.response.rect);
        }
        // Without the panel only what is to be told lies over the picture.
        if self.visible.panel || self.told().is_some() {
            let free = ui.available_rect_before_wrap();
            overlay::status(&ctx, free, &self.status());
        }
        if self.visible.figures
            && let Some(finished) = self.pictures.finished()
        {
            overlay::figures(&ctx, finished.frame);
        }
        if self.visible.help {
            overlay::help(&ctx);
        }
        if self.offered.is_some() {
            overlay::offer(&ctx, &self.document.name, &mut asked.restore);
        }
    }

    fn status(&self) -> overlay::Status {
        let progress = self.pictures.progress();
        let still = self
            .still
            .as_ref()
            .map(|still| ("still".into(), still.done()));
        overlay::Status {
            size: self.stage.screen.size(),
            shot: self.shot.name(),
            progress: progress.map(|p| (p.pass, p.done)).or(still),
            times: self.pictures.times(),
            notice: self.told(),
        }
    }

    /// The preset, and how one flies.
    fn head(&mut self, ui: &mut Ui, asked: &mut Requests) {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let mark = if self.document.is_changed() { " *" } else { "" };
            ComboBox::from_id_salt("presets")
                .selected_text(format!("{}{mark}", self.document.name))
                .width(150.0)
                .show_ui(ui, |ui| {
                    for (name, _) in BUILTIN {
                        if ui
                            .selectable_label(*name == self.document.name, *name)
                            .clicked()
                        {
                            asked.open = Some(name);
                        }
                    }
                });
            ui.label("F1 shows the keys");
        });
        ui.horizontal(|ui| {
            let flight = &mut self.flight;
            let mut constant = flight.pace == Pace::Constant;
            ui.checkbox(&mut constant, "constant speed").on_hover_text(
                "otherwise the speed of flight follows the empty space about the eye",
            );
            flight.pace = if constant {
                Pace::Constant
            } else {
                Pace::Clearance
            };
            ui.checkbox(&mut flight.through_walls, "through walls");
        });
        ui.separator();
    }

    fn answer(&mut self, asked: Requests) {
        let dragging = asked.panel.dragging || asked.timeline.dragging;
        if dragging && !self.panel_drag {
            // What is flown so far is a step of its own.
            self.document.end();
        }
        self.panel_drag = dragging;
        self.panel_typing = asked.panel.typing;
        if let Some(name) = asked.open {
            self.open(name);
            return;
        }
        if let Some((section, name, value)) = asked.panel.set {
            self.set(section, name, &value);
        }
        if let Some(of) = asked.panel.key {
            let beat = self.play.beat;
            self.document.change(|plan| _ = set_key(plan, &of, beat));
            self.visible.timeline = true;
        }
        if let Some(plan) = asked.timeline.plan {
            if self.panel_drag {
                self.document.begin();
            }
            self.document.change(|now| *now = plan);
            self.show_moment();
        }
        if asked.timeline.moved {
            self.play.playing = false;
            self.follow_playhead();
        }
        if let Some(restore) = asked.restore {
            self.take_offer(restore);
        }
    }
}

/// Rectangles in pixels: x, y, width and height. Those that meet are one.
fn pixels(rects: &[Rect], pixels_per_point: f32) -> Vec<[u32; 4]> {
    let mut parts: Vec<Rect> = Vec::new();
    for rect in rects {
        let mut part = *rect;
        while let Some(i) = parts
            .iter()
            .position(|other| other.intersect(part).is_positive())
        {
            part |= parts.swap_remove(i);
        }
        parts.push(part);
    }
    let pixels = |part: Rect| {
        let low = (part.min.to_vec2() * pixels_per_point).floor();
        let high = (part.max.to_vec2() * pixels_per_point).ceil();
        let whole = |x: f32| x.max(0.0) as u32;
        let [x, y] = [whole(low.x), whole(low.y)];
        [
            x,
            y,
            whole(high.x).saturating_sub(x),
            whole(high.y).saturating_sub(y),
        ]
    };
    parts.into_iter().map(pixels).collect()
}

/// The areas that lie over everything else: lists, hints and boxes, with their shadows.
fn areas(ctx: &Context) -> Vec<Rect> {
    const SHADOW: f32 = 16.0;
    ctx.memory(|memory| {
        let layers = memory.areas().visible_layer_ids();
        let over = layers
            .iter()
            .filter(|layer| layer.order != Order::Background);
        let rects = over.filter_map(|layer| memory.area_rect(layer.id));
        rects.map(|rect| rect.expand(SHADOW)).collect()
    })
}

/// Whether one of some rectangles, of x, y, width and height, holds a point.
pub fn is_in(rects: &[[u32; 4]], at: PhysicalPosition<f64>) -> bool {
    let [px, py] = [at.x, at.y].map(|x| x.max(0.0) as u32);
    let holds = |[x, y, w, h]: &[u32; 4]| (*x..x + w).contains(&px) && (*y..y + h).contains(&py);
    rects.iter().any(holds)
}

/// A button of a few letters.
pub fn small(ui: &mut Ui, text: &str, help: &str) -> bool {
    ui.add(Button::new(text).small())
        .on_hover_text(help)
        .clicked()
}
