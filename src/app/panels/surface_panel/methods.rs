//! The row above the picture that chooses two methods, and what lies between them: the wipe, the flip, or the scale of
//! the difference.

use egui::{Align, DragValue, Layout, RichText, Sense, Slider, Ui};

use super::ROOMY;
use crate::app::panels::{about_button, segmented};
use crate::app::{about, parameter, theme};
use crate::comparison::{Comparison, Difference, DifferenceKind, View};
use crate::filter::Method;

/// Width of a list of methods.
pub const COMBO_WIDTH: f32 = 144.0;

/// A slider that is narrower is left out: its value can be dragged as well.
const LEAST_SLIDER: f32 = 40.0;
const RANGE: &str = "Difference range";

/// Shows the row; true while the button that flips is held.
pub fn show(ui: &mut Ui, comparison: &mut Comparison) -> bool {
    let roomy = ui.available_width() > ROOMY;
    let width = COMBO_WIDTH.min(0.5 * (ui.available_width() - ui.spacing().item_spacing.x));
    ui.horizontal(|ui| {
        combo(ui, "Left method", &mut comparison.left, width);
        if roomy {
            about_button::show(ui, "Left method", about::method(comparison.left));
        }
        let right_to_left = Layout::right_to_left(Align::Center);
        ui.with_layout(right_to_left, |ui| {
            if roomy {
                about_button::show(ui, "Right method", about::method(comparison.right));
            }
            combo(ui, "Right method", &mut comparison.right, width);
            roomy && between(ui, comparison)
        })
        .inner
    })
    .inner
}

/// A list of every method that is offered.
pub fn combo(ui: &mut Ui, name: &str, method: &mut Method, width: f32) {
    let mut methods: Vec<(Method, String)> = Method::offered().map(|method| (method, method.label())).collect();
    if methods.iter().all(|(offered, _)| offered != method) {
        // A session file may name a parameter that is not offered.
        methods.push((*method, method.label()));
    }
    let methods: Vec<(Method, &str)> = methods.iter().map(|(method, label)| (*method, label.as_str())).collect();
    ui.scope(|ui| {
        ui.set_width(width);
        parameter::combo(ui, name, method, &methods);
    });
}

/// What stands between the methods, from the right; true while the button that flips is held.
fn between(ui: &mut Ui, comparison: &mut Comparison) -> bool {
    let flip = ui.button("Flip").on_hover_text("Shows the right method while held, as the space bar does");
    let flips = flip.is_pointer_button_down_on();
    flip.accessible_name("Hold to flip");
    if ui.button("Swap").on_hover_text("Exchange left and right").clicked() {
        std::mem::swap(&mut comparison.left, &mut comparison.right);
    }
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| match comparison.view {
        View::Wipe => wipe(ui, &mut comparison.wipe),
        View::Difference => difference(ui, &mut comparison.difference),
        View::Flip => {
            ui.label(RichText::new("Hold the space bar to see the right method").color(theme::of(ui).weak));
        }
        View::Grid2x2 | View::Grid3x3 => {}
    });
    flips
}

fn wipe(ui: &mut Ui, wipe: &mut f32) {
    ui.label(RichText::new("Wipe").color(theme::of(ui).weak));
    ui.spacing_mut().slider_width = (ui.available_width() - theme::GRID).max(40.0);
    ui.spacing_mut().interact_size.y = theme::HANDLE;
    let slider = Slider::new(wipe, 0.0..=1.0).show_value(false);
    let response = ui.add(slider).interact(Sense::click()).accessible_name("Wipe");
    let response = response.on_hover_text("How much of the picture the left method gets");
    if response.double_clicked() {
        *wipe = Comparison::default().wipe;
    }
}

fn difference(ui: &mut Ui, difference: &mut Difference) {
    let explanation = match difference.kind {
        DifferenceKind::Absolute => "The mean over red, green and blue of |right - left|, exposed linear colour.",
        DifferenceKind::Signed => "The luminance of the right method less that of the left, exposed linear colour.",
    };
    ui.scope(|ui| segmented(ui, "Difference", &mut difference.kind, Difference::default().kind, &DifferenceKind::ALL))
        .response
        .on_hover_text(explanation);
    let ([low, high], speed) = (Difference::RANGES, 0.01 * difference.range);
    let typed = DragValue::new(&mut difference.range)
        .range(low..=high)
        .speed(speed)
        .max_decimals(4)
        .update_while_editing(false);
    ui.label(RichText::new("Range").color(theme::of(ui).weak));
    let typed = ui.add_sized([52.0, theme::ROW], typed);
    let room = ui.available_width() - theme::GRID;
    let mut responses = vec![typed.accessible_name(if room < LEAST_SLIDER { RANGE } else { "Difference range value" })];
    if room >= LEAST_SLIDER {
        ui.spacing_mut().slider_width = room;
        ui.spacing_mut().interact_size.y = theme::HANDLE;
        let slider = Slider::new(&mut difference.range, low..=high).logarithmic(true).show_value(false);
        responses.push(ui.add(slider).interact(Sense::click()).accessible_name(RANGE));
    }
    for response in responses {
        if response.double_clicked() {
            difference.range = Difference::DEFAULT_RANGE;
        }
        response.on_hover_text("The difference at the end of the scale; 1 is white. Double click resets.");
    }
}
