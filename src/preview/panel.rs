//! The panel: every key of the plan, made from the lists of keys.

use egui::{
    Align, Button, CollapsingHeader, ComboBox, DragValue, Label, Layout, Popup, Response, RichText,
    Slider, Ui,
};
use toml::Value;

use crate::base::key::{Key, Kind, Redo};
use crate::plan::Plan;
use crate::preset::SECTIONS;
use crate::preview::gui::small;

/// Widths of the names of keys, of one number of three, of the same beside `auto`, of a colour among
/// others, and of the buttons after the value, in points.
const NAME_WIDTH: f32 = 92.0;
const NUMBER_WIDTH: f32 = 48.0;
const NARROW_WIDTH: f32 = 36.0;
const COLOR_WIDTH: f32 = 18.0;
const BUTTONS_WIDTH: f32 = 44.0;

/// What the panel asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelRequest {
    /// A new value for a key, as `section` and `name`.
    pub set: Option<(&'static str, &'static str, Value)>,
    /// The setting, as `section.key`, that gets a key of the timeline.
    pub key: Option<String>,
    /// A drag is under way, so that all values until its end are one step.
    pub dragging: bool,
    /// A number is typed in a box of colours, digit by digit.
    pub typing: bool,
}

/// Shows all keys.
pub fn show(ui: &mut Ui, plan: &Plan, defaults: &Plan) -> PanelRequest {
    let mut asked = PanelRequest::default();
    let (mut plan, mut defaults) = (plan.clone(), defaults.clone());
    for section in SECTIONS {
        let open = matches!(section, "scene" | "look");
        let header = CollapsingHeader::new(RichText::new(section).strong());
        header.default_open(open).show(ui, |ui| {
            let usual = defaults.keys(section).unwrap_or_default();
            for (key, usual) in plan
                .keys(section)
                .unwrap_or_default()
                .into_iter()
                .zip(usual)
            {
                row(ui, section, &key, &usual.slot.get(), &mut asked);
            }
        });
    }
    // A drag in a box of colours is not one of the button that opened it.
    let boxed = Popup::is_any_open(ui.ctx());
    asked.dragging |= boxed && ui.input(|i| i.pointer.any_down());
    asked.typing = boxed && ui.ctx().text_edit_focused();
    asked
}

/// One key: its name, its value and, if it is not the default, a button to reset it.
fn row(ui: &mut Ui, section: &'static str, key: &Key<'_>, usual: &Value, asked: &mut PanelRequest) {
    let now = key.slot.get();
    let help = format!("{}\n\n{}\n{}", key.help, key.slot.expects(), cost(key.redo));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().interact_size.x = NUMBER_WIDTH;
        let left = Layout::left_to_right(Align::Center);
        let name = ui.allocate_ui_with_layout([NAME_WIDTH, 18.0].into(), left, |ui| {
            ui.set_min_width(NAME_WIDTH);
            ui.add(Label::new(key.name.replace('_', " ")).truncate())
        });
        name.inner.on_hover_text(&help);
        if let Some(value) = editor(ui, (section, key.name), &key.slot.kind(), &now, asked) {
            asked.set = Some((section, key.name, value));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // Its place stays, so that the column of `k` is straight.
            let reset = ui.add_visible(now != *usual, Button::new("x").small());
            if reset.on_hover_text("back to the default").clicked() {
                asked.set = Some((section, key.name, usual.clone()));
            }
            let fixed = ["time", "image"].contains(&section);
            if !fixed
                && is_tracked(&key.slot.kind(), &now)
                && small(ui, "k", "set a key of the timeline")
            {
                asked.key = Some(format!("{section}.{}", key.name));
            }
        });
    });
}

/// Whether a value is one that a track can hold.
fn is_tracked(kind: &Kind, now: &Value) -> bool {
    match kind {
        Kind::Auto(kind) => !now.is_str() && is_tracked(kind, now),
        kind => matches!(kind, Kind::Number(_) | Kind::Count(_) | Kind::Triple(_)),
    }
}

fn cost(redo: Option<Redo>) -> &'static str {
    match redo {
        None | Some(Redo::Nothing) => "changes no pixel",
        Some(Redo::Tone) => "a change makes the bytes again, from kept colours",
        Some(Redo::Color) => "a change makes the colours again, from kept rays",
        Some(Redo::March) => "a change makes cones and rays again",
        Some(Redo::Program) => "a change may compile programs",
        Some(Redo::Assets) => "a change loads or makes heights, maps or textures",
    }
}

/// Whether a slider is logarithmic: over a large range, of both signs too.
fn is_wide([low, high]: [f64; 2]) -> bool {
    match low < 0.0 {
        true => high >= 100.0,
        false => high / low.max(high * 1e-4) >= 100.0,
    }
}

fn noted(response: &Response, asked: &mut PanelRequest) -> bool {
    asked.dragging |= response.dragged();
    response.changed()
}

/// Edits a value. Returns a new one. A typed number is taken as a whole, so that it is one step.
fn editor(
    ui: &mut Ui,
    id: (&str, &str),
    kind: &Kind,
    now: &Value,
    asked: &mut PanelRequest,
) -> Option<Value> {
    match kind {
        Kind::Number(range) => number(ui, *range, now.as_float()?, asked).map(Value::Float),
        Kind::Count([low, high]) => {
            let mut n = now.as_integer()?;
            let drag = DragValue::new(&mut n)
                .range(*low..=*high)
                .update_while_editing(false);
            let response = ui.add(drag);
            noted(&response, asked).then_some(Value::Integer(n))
        }
        Kind::Switch => {
            let mut on = now.as_bool()?;
            let response = ui.checkbox(&mut on, "");
            noted(&response, asked).then_some(Value::Boolean(on))
        }
        Kind::Word(words) => word(ui, id, words, now.as_str()?),
        Kind::Triple(range) => triple(ui, *range, now, asked),
        Kind::Triples(most, range) => triples(ui, *most, *range, now, asked),
        Kind::Auto(kind) => auto(ui, id, kind, now, asked),
        Kind::Other => other(ui, id, now),
    }
}

fn number(ui: &mut Ui, range: [f64; 2], now: f64, asked: &mut PanelRequest) -> Option<f64> {
    let [low, high] = range;
    let mut x = now;
    // A slider over a large range of both signs has no useful places; such numbers are dragged.
    let response = if low >= 0.0 || high - low <= 1000.0 {
        let mut slider = Slider::new(&mut x, low..=high);
        ui.spacing_mut().slider_width = 100.0;
        if is_wide(range) {
            // Of both signs, half of the places are left for each.
            let smallest = match low < 0.0 {
                true => 1e-3 * high,
                false => low.max(1e-4 * high.min(100.0)),
            };
            let wide = slider.logarithmic(true).smallest_positive(smallest);
            // A step of a linear number would leap over small ones.
            slider = wide.drag_value_speed(speed(now));
        }
        ui.add(
            slider
                .update_while_editing(false)
                .custom_formatter(short)
                .custom_parser(typed(now)),
        )
    } else {
        let drag = DragValue::new(&mut x).range(low..=high);
        ui.add(
            drag.speed(speed(now))
                .update_while_editing(false)
                .custom_formatter(short)
                .custom_parser(typed(now)),
        )
    };
    noted(&response, asked).then_some(x)
}

/// Reads what is typed in the place of a number. A field that is left as it was shown keeps all digits
/// of its number.
fn typed(now: f64) -> impl Fn(&str) -> Option<f64> {
    move |text| {
        let text: String = text.split_whitespace().collect();
        match text == short(now, 0..=0) {
            true => Some(now),
            false => text.replace('\u{2212}', "-").parse().ok(),
        }
    }
}

/// A number in few letters. What is typed or dragged has all its digits.
fn short(x: f64, _: std::ops::RangeInclusive<usize>) -> String {
    let digits = match x.abs() {
        a if a >= 1000.0 => 0,
        a if a >= 100.0 => 1,
        a if a >= 10.0 => 2,
        a if a >= 0.1 => 3,
        0.0 => 0,
        _ => return format!("{x:.2e}"),
    };
    let text = format!("{x:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').into(),
        false => text,
    }
}

/// How fast a drag changes a number: by a hundredth of it for a pixel.
fn speed(now: f64) -> f64 {
    0.01 * now.abs().max(0.01)
}

fn word(ui: &mut Ui, id: (&str, &str), words: &[&str], now: &str) -> Option<Value> {
    let mut chosen = None;
    ComboBox::from_id_salt(id)
        .selected_text(now)
        .width(110.0)
        .show_ui(ui, |ui| {
            for word in words {
                if ui.selectable_label(now == *word, *word).clicked() {
                    chosen = Some(Value::String(word.to_string()));
                }
            }
        });
    chosen
}

fn floats(value: &Value) -> Option<[f64; 3]> {
    let all = value.as_array()?.iter();
    let all: Option<Vec<f64>> = all.map(Value::as_float).collect();
    all?.try_into().ok()
}

/// Whether three numbers are a colour.
fn is_color(range: [f64; 2]) -> bool {
    range == [0.0, 1.0]
}

fn triple(ui: &mut Ui, range: [f64; 2], now: &Value, asked: &mut PanelRequest) -> Option<Value> {
    let mut three = floats(now)?;
    let changed = match is_color(range) {
        true => color(ui, &mut three, asked),
        false => {
            let mut any = false;
            let largest = three.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for x in &mut three {
                let now = *x;
                let drag = DragValue::new(x).range(range[0]..=range[1]);
                let drag = drag.speed(speed(largest)).update_while_editing(false);
                let drag = drag.custom_formatter(short).custom_parser(typed(now));
                let response = ui.add(drag);
                any |= noted(&response, asked);
            }
            any
        }
    };
    changed.then(|| three.to_vec().into())
}

fn color(ui: &mut Ui, three: &mut [f64; 3], asked: &mut PanelRequest) -> bool {
    let mut rgb = three.map(|x| x as f32);
    let mut bytes = rgb.map(|x| (255.0 * x).round() as u8);
    let response = ui.color_edit_button_srgb(&mut bytes);
    rgb = bytes.map(|b| f32::from(b) / 255.0);
    let changed = noted(&response, asked);
    if changed {
        // Thousandths are finer than bytes and short in a file.
        *three = rgb.map(|x| (f64::from(x) * 1000.0).round() / 1000.0);
    }
    changed
}

fn triples(
    ui: &mut Ui,
    most: usize,
    range: [f64; 2],
    now: &Value,
    asked: &mut PanelRequest,
) -> Option<Value> {
    let mut all: Vec<[f64; 3]> = now.as_array()?.iter().filter_map(floats).collect();
    let mut changed = false;
    let size = [
        ui.available_width() - BUTTONS_WIDTH,
        ui.spacing().interact_size.y,
    ];
    let rows = Layout::left_to_right(Align::Center).with_main_wrap(true);
    ui.allocate_ui_with_layout(size.into(), rows, |ui| {
        ui.spacing_mut().item_spacing = [2.0, 2.0].into();
        ui.spacing_mut().interact_size.x = COLOR_WIDTH;
        if is_color(range) {
            for three in &mut all {
                changed |= color(ui, three, asked);
            }
        }
        if all.len() > 1 && ui.small_button("-").clicked() {
            all.pop();
            changed = true;
        }
        if all.len() < most && ui.small_button("+").clicked() {
            all.extend(all.last().copied());
            changed = true;
        }
    });
    let list: Vec<Value> = all.iter().map(|three| three.to_vec().into()).collect();
    changed.then(|| list.into())
}

fn auto(
    ui: &mut Ui,
    id: (&str, &str),
    kind: &Kind,
    now: &Value,
    asked: &mut PanelRequest,
) -> Option<Value> {
    let is_auto = now.as_str() == Some("auto");
    if *kind == Kind::Other {
        return other(ui, id, now);
    }
    let mut on = is_auto;
    if ui.checkbox(&mut on, "auto").changed() {
        return Some(match (on, kind) {
            (true, _) => Value::String("auto".into()),
            (false, Kind::Count([low, high])) => {
                Value::Integer(i64::from((*low).max(16).min(*high)))
            }
            (false, Kind::Number([low, high])) => Value::Float(1.0_f64.clamp(*low, *high)),
            (false, Kind::Triple([low, high])) => vec![0.0_f64.clamp(*low, *high); 3].into(),
            _ => return None,
        });
    }
    if is_auto {
        return None;
    }
    ui.spacing_mut().interact_size.x = NARROW_WIDTH;
    editor(ui, id, kind, now, asked)
}

/// Edits any value as TOML. It is taken when the field is left, unless by Escape.
fn other(ui: &mut Ui, id: (&str, &str), now: &Value) -> Option<Value> {
    let id = ui.scope_id().with(id);
    let shown = match now {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    };
    let mut text = ui
        .data_mut(|data| data.get_temp::<String>(id))
        .unwrap_or(shown.clone());
    let response = ui.add(egui::TextEdit::singleline(&mut text).desired_width(110.0));
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(id));
        let kept = !ui.input(|input| input.key_pressed(egui::Key::Escape));
        return (kept && text != shown).then(|| read(&text));
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    }
    None
}

/// Words need no quotes.
fn read(text: &str) -> Value {
    let table: Result<toml::Table, _> = format!("x = {text}").parse();
    let value = table.ok().and_then(|mut table| table.remove("x"));
    value.unwrap_or_else(|| Value::String(text.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_that_is_left_as_it_was_keeps_all_digits() {
        let now = -1.765_432_1;
        let typed = typed(now);
        assert_eq!(typed(&short(now, 0..=0)), Some(now));
        assert_eq!(typed(" -1.77"), Some(-1.77));
        assert_eq!(typed("\u{2212}2 "), Some(-2.0));
        assert_eq!(typed("two"), None);
    }
}
