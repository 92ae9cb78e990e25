//! Sliders built from a parameter's description: name, range, default, unit, tooltip.
//!
//! A row reads label, slider, typed value. Double click on any of them resets. The slider is named after the
//! parameter in the accessibility tree, the typed value after it with "value" behind.

use egui::{DragValue, Label, Response, Sense, Slider, Ui};

use super::about::About;
use super::panels::about_button;
use super::theme;
use crate::brdf::ModelParameter;

/// A number that the user may set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// What it is called, symbol after the word, as in "Shininess s".
    pub name: &'static str,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// The value that a double click brings back.
    pub default: f64,
    /// Written behind the value; may be empty.
    pub unit: &'static str,
    /// Digits behind the decimal point.
    pub decimals: usize,
    /// True where ratios matter to the eye rather than differences.
    pub logarithmic: bool,
    /// What it does, with the number of the equation where there is one.
    pub tooltip: &'static str,
}

impl From<&ModelParameter> for Parameter {
    fn from(parameter: &ModelParameter) -> Self {
        Self {
            name: parameter.label,
            range: parameter.range.map(f64::from),
            default: parameter.default.into(),
            unit: "",
            decimals: parameter.decimals,
            logarithmic: true,
            tooltip: parameter.tooltip,
        }
    }
}

/// Width of the labels, so that sliders stand in one column.
const LABEL_WIDTH: f32 = 92.0;
/// Width of the typed values.
const VALUE_WIDTH: f32 = 52.0;
/// Height from which on a drop-down's list scrolls: the longest list is as long as there are methods.
const LIST_HEIGHT: f32 = 480.0;

impl Parameter {
    /// Shows the row; true if the value changed.
    pub fn show(&self, ui: &mut Ui, value: &mut f64) -> bool {
        let before = *value;
        let row = ui.horizontal(|ui| {
            let label = label(ui, self.name);
            let slider = self.slider(ui, value).labelled_by(label.id);
            let typed = self.typed(ui, value);
            [label, slider, typed]
        });
        for response in row.inner {
            if response.double_clicked() {
                *value = self.default;
            }
            response.on_hover_text(self.explanation());
        }
        *value != before
    }

    /// As [`Parameter::show`], for a value kept in single precision.
    pub fn show_f32(&self, ui: &mut Ui, value: &mut f32) -> bool {
        let mut wide = f64::from(*value);
        let changed = self.show(ui, &mut wide);
        if changed {
            *value = wide as f32;
        }
        changed
    }

    /// As [`Parameter::show`], for a whole number.
    pub fn show_count(&self, ui: &mut Ui, value: &mut usize) -> bool {
        let mut wide = *value as f64;
        let changed = self.show(ui, &mut wide);
        if changed {
            *value = wide.round() as usize;
        }
        changed
    }

    fn slider(&self, ui: &mut Ui, value: &mut f64) -> Response {
        let [low, high] = self.range;
        let gaps = ui.spacing().item_spacing.x;
        ui.spacing_mut().slider_width = (ui.available_width() - VALUE_WIDTH - gaps).max(40.0);
        let height = std::mem::replace(&mut ui.spacing_mut().interact_size.y, theme::HANDLE);
        let slider = Slider::new(value, low..=high).show_value(false).logarithmic(self.logarithmic);
        let slider = if self.decimals == 0 { slider.integer() } else { slider.max_decimals(self.decimals) };
        let response = ui.add(slider).interact(Sense::click());
        ui.spacing_mut().interact_size.y = height;
        response
    }

    fn typed(&self, ui: &mut Ui, value: &mut f64) -> Response {
        let [low, high] = self.range;
        // A drag of 150 points spans the range, or a factor of e where the range is logarithmic.
        let speed = if self.logarithmic { value.abs().max(low.max(1e-3)) / 150.0 } else { (high - low) / 150.0 };
        let typed = DragValue::new(value)
            .range(low..=high)
            .speed(speed)
            .max_decimals(self.decimals)
            .suffix(self.unit)
            .update_while_editing(false);
        ui.add_sized([VALUE_WIDTH, theme::ROW], typed).accessible_name(format!("{} value", self.name))
    }

    fn explanation(&self) -> String {
        let [low, high] = self.range;
        let unit = self.unit;
        let default = format!("{:.*}", self.decimals, self.default);
        format!("{}\n{low}{unit} to {high}{unit}, default {default}{unit}. Double click resets.", self.tooltip)
    }
}

/// A box to be ticked; a double click brings the default back.
pub fn checkbox(ui: &mut Ui, on: &mut bool, default: bool, text: &str, tooltip: &str) -> Response {
    let state = if default { "on" } else { "off" };
    let tooltip = format!("{tooltip}\nDefault {state}. Double click resets.");
    let response = ui.checkbox(on, text).on_hover_text(tooltip);
    if response.double_clicked() {
        *on = default;
    }
    response
}

/// A label of the column's width, in front of a control.
pub fn label(ui: &mut Ui, text: &str) -> Response {
    label_with(ui, text, |_| {})
}

/// A label of the column's width with something at its right end.
fn label_with(ui: &mut Ui, text: &str, end: impl FnOnce(&mut Ui)) -> Response {
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    let size = egui::vec2(LABEL_WIDTH, theme::ROW);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_min_size(size);
        ui.spacing_mut().item_spacing.x = 0.0;
        let label = ui.add(Label::new(text).truncate().selectable(false).sense(Sense::click()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), end);
        label
    })
    .inner
}

/// A labelled drop-down over named choices, the default one first; the new choice, if one was made. A double click on
/// the label brings the default back.
pub fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    current: T,
    choices: &[(T, &str)],
) -> Option<T> {
    let choices: Vec<_> = choices.iter().map(|&(value, text)| (value, text, "")).collect();
    explained_choice(ui, name, tooltip, current, &choices)
}

/// As [`choice`], each choice with a tooltip of its own, which the row shows of the current one.
pub fn explained_choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    current: T,
    choices: &[(T, &str, &str)],
) -> Option<T> {
    choice_row(ui, name, tooltip, current, choices, None)
}

/// As [`choice`], with a button that tells about the current one.
pub fn about_choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    (current, about): (T, About),
    choices: &[(T, &str)],
) -> Option<T> {
    let choices: Vec<_> = choices.iter().map(|&(value, text)| (value, text, "")).collect();
    choice_row(ui, name, tooltip, current, &choices, Some(about))
}

/// A row of label, drop-down and, where there is something to tell, the button that does.
pub fn choice_row<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    tooltip: &str,
    current: T,
    choices: &[(T, &str, &str)],
    about: Option<About>,
) -> Option<T> {
    let mut chosen = current;
    let explanation = choices.iter().find(|(value, ..)| *value == current).map_or("", |(.., text)| text);
    let (default, default_text, _) = *choices.first()?;
    let gap = if explanation.is_empty() { "" } else { "\n" };
    let reset = format!("Default {default_text}. Double click the name to reset.");
    let tooltip = format!("{tooltip}\n{explanation}{gap}{reset}");
    ui.horizontal(|ui| {
        let label = label_with(ui, name, |ui| {
            if let Some(about) = about {
                about_button::show(ui, name, about);
            }
        })
        .on_hover_text(&tooltip);
        explained_combo(ui, name, &mut chosen, choices).labelled_by(label.id).on_hover_text(&tooltip);
        if label.double_clicked() {
            chosen = default;
        }
    });
    (chosen != current).then_some(chosen)
}

/// A drop-down without a label, as wide as what is left of the row.
pub fn combo<T: Copy + PartialEq>(ui: &mut Ui, name: &str, chosen: &mut T, choices: &[(T, &str)]) -> Response {
    let choices: Vec<_> = choices.iter().map(|&(value, text)| (value, text, "")).collect();
    explained_combo(ui, name, chosen, &choices)
}

/// A drop-down without a label, each choice with a tooltip of its own.
pub fn explained_combo<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    chosen: &mut T,
    choices: &[(T, &str, &str)],
) -> Response {
    let text = choices.iter().find(|(value, ..)| value == chosen).map_or("", |(_, text, _)| text);
    let combo = egui::ComboBox::from_id_salt(name).selected_text(text).width(ui.available_width()).truncate();
    let combo = combo.height(LIST_HEIGHT);
    let shown = combo.show_ui(ui, |ui| {
        for &(value, text, tooltip) in choices {
            let response = ui.selectable_value(chosen, value, text);
            if !tooltip.is_empty() {
                response.on_hover_text(tooltip);
            }
        }
    });
    shown.response.accessible_name(name)
}
