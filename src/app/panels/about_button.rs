//! The button beside a choice that tells about what is chosen.

use egui::{Align, Button, Label, Layout, Popup, PopupCloseBehavior, RichText, Ui, vec2};

use crate::app::about::About;
use crate::app::theme;

/// Width of the button.
pub const WIDTH: f32 = 16.0;
/// Width of what it opens.
const TEXT_WIDTH: f32 = 360.0;

/// Shows the button; `name` is the choice that it belongs to.
pub fn show(ui: &mut Ui, name: &str, about: About) {
    let mark = RichText::new("?").small().color(theme::of(ui).weak);
    let button = Button::new(mark).frame_when_inactive(false).min_size(vec2(WIDTH, theme::ROW));
    let padding = std::mem::replace(&mut ui.spacing_mut().button_padding, vec2(2.0, 0.0));
    let response = ui.add(button).accessible_name(format!("About: {name}")).on_hover_text("About this method");
    ui.spacing_mut().button_padding = padding;
    let popup = Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClick);
    popup.show(|ui| ui.with_layout(Layout::top_down(Align::LEFT), |ui| contents(ui, about)));
}

fn contents(ui: &mut Ui, about: About) {
    let palette = theme::of(ui);
    ui.set_width(TEXT_WIDTH);
    ui.add_space(theme::GRID);
    ui.spacing_mut().item_spacing.y = 2.0 * theme::GRID;
    let text = |text: RichText| Label::new(text).wrap();
    ui.add(text(RichText::new(about.title).heading().color(palette.strong)));
    ui.add(text(RichText::new(about.text).color(palette.text)));
    egui::Frame::new().fill(palette.faint).inner_margin(8).corner_radius(4).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.add(text(RichText::new(about.equation).monospace().color(palette.strong)));
    });
    ui.add(text(RichText::new(about.source).small().color(palette.weak)));
}
