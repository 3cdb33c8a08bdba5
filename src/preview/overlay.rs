//! What lies over the picture: a line about it, the figures of its passes, and the keys.

use egui::{
    Align, Align2, Area, Color32, Context, Frame, Grid, Id, Label, Margin, Rect, RichText,
    ScrollArea, TextWrapMode, Ui, Vec2,
};

use crate::picture;
use crate::preview::input::HELP;

/// Size of the letters in the list of keys, in points.
const KEYS: f32 = 11.5;

/// What the line tells.
pub struct Status {
    /// Width and height of the window.
    pub size: [u32; 2],
    /// What is shown.
    pub shot: String,
    /// What is under way, and how much of it is done.
    pub progress: Option<(String, f64)>,
    /// The times of the last small and of the last full picture, in milliseconds.
    pub times: [Option<f64>; 2],
    /// What to tell the user, and whether it is an error.
    pub notice: Option<(String, bool)>,
}

/// A dark box at an edge of the window, or so many points above it. Buttons and wheel go through it
/// to the picture, unless it is in the middle.
fn over(ctx: &Context, name: &'static str, anchor: Align2, above: f32, add: impl FnOnce(&mut Ui)) {
    let is_middle = anchor == Align2::CENTER_CENTER;
    // Away from the edges.
    let sign = |align: Align| match align {
        Align::Min => 1.0,
        Align::Center => 0.0,
        Align::Max => -1.0,
    };
    let offset = Vec2::new(8.0 * sign(anchor.x()), 8.0 * sign(anchor.y()) - above);
    let id = Id::unique(name);
    let before = ctx.memory(|memory| memory.area_rect(id));
    let shown = Area::new(id)
        .anchor(anchor, offset)
        .interactable(is_middle)
        .show(ctx, |ui| {
            Frame::new()
                .fill(Color32::from_black_alpha(if is_middle { 230 } else { 190 }))
                .inner_margin(Margin::symmetric(8, 5))
                .corner_radius(3)
                .show(ui, |ui| {
                    ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                    add(ui);
                });
        });
    // It stands where its last size would fit.
    if before.map(|rect| rect.size()) != Some(shown.response.rect.size()) {
        ctx.request_repaint();
    }
}

/// Shows the line at the lower left of the free part of the window.
pub fn status(ctx: &Context, free: Rect, status: &Status) {
    let [width, height] = status.size;
    let time = |name: &str, ms: Option<f64>| ms.map(|ms| format!("{name} {ms:.0} ms"));
    let [small, full] = status.times;
    let progress = status.progress.as_ref();
    let parts = [
        Some(format!("{width}x{height}")),
        (status.shot != "color").then(|| status.shot.clone()),
        time("small", small),
        time("full", full),
        progress.map(|(what, done)| format!("{what} {:.0} %", 100.0 * done)),
    ];
    let line = parts.into_iter().flatten().collect::<Vec<_>>().join("  ");
    let below = ctx.viewport_rect().bottom() - free.bottom();
    over(ctx, "status", Align2::LEFT_BOTTOM, below, |ui| {
        if let Some((text, is_error)) = &status.notice {
            let color = match is_error {
                true => Color32::from_rgb(255, 150, 130),
                false => Color32::WHITE,
            };
            ui.set_max_width(0.9 * free.width());
            ui.add(Label::new(RichText::new(text).color(color)).wrap());
        }
        ui.label(RichText::new(line).color(Color32::LIGHT_GRAY).small());
    });
}

/// Offers unsaved work of another time.
pub fn offer(ctx: &Context, name: &str, restore: &mut Option<bool>) {
    egui::Window::new("Unsaved work")
        .anchor(Align2::CENTER_TOP, [0.0, 20.0])
        .collapsible(false)
        .resizable(false)
        .show(ctx, |ui| {
            ui.label(format!("There is unsaved work on {name}."));
            ui.horizontal(|ui| {
                if ui.button("Restore").clicked() {
                    *restore = Some(true);
                }
                if ui.button("Discard").clicked() {
                    *restore = Some(false);
                }
            });
        });
}

/// Shows time and work of each pass.
pub fn figures(ctx: &Context, frame: &picture::frame::Frame) {
    over(ctx, "figures", Align2::LEFT_TOP, 0.0, |ui| {
        Grid::new("passes").striped(true).show(ui, |ui| {
            for head in ["pass", "ms", "cells", "evaluations per cell"] {
                ui.label(RichText::new(head).strong());
            }
            ui.end_row();
            for pass in &frame.passes {
                ui.label(pass.pass.name());
                let ms = pass.gpu_ms.unwrap_or(pass.wall_ms);
                ui.label(format!("{ms:.1}"));
                ui.label(pass.cells.to_string());
                let each = pass
                    .evaluations
                    .map(|n| n as f64 / pass.cells.max(1) as f64);
                ui.label(each.map_or(String::new(), |n| format!("{n:.2}")));
                ui.end_row();
            }
        });
    });
}

/// Shows the keys, in two columns. A window that is too small for them scrolls.
pub fn help(ctx: &Context) {
    // The frame and the distance from the edges.
    let most = ctx.viewport_rect().size() - Vec2::new(32.0, 26.0);
    over(ctx, "help", Align2::CENTER_CENTER, 0.0, |ui| {
        let scrolled = ScrollArea::both()
            .max_width(most.x)
            .max_height(most.y)
            .min_scrolled_width(most.x)
            .min_scrolled_height(most.y);
        scrolled.show(ui, |ui| {
            ui.spacing_mut().interact_size.y = 0.0;
            Grid::new("keys").spacing([8.0, 3.0]).show(ui, |ui| {
                let half = HELP.len().div_ceil(2);
                for row in 0..half {
                    for (keys, what) in HELP[row..].iter().step_by(half) {
                        ui.label(RichText::new(*keys).size(KEYS).strong());
                        ui.label(RichText::new(*what).size(KEYS));
                    }
                    ui.end_row();
                }
            });
        });
    });
}
