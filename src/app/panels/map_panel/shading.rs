//! What the levels show of their texels: the choice, the method whose error it is, the scale, what is under way.

use egui::{Align, Layout, RichText, Ui, vec2};

use super::worst;
use crate::app::map_shading::MapShading;
use crate::app::panels::{PanelContext, judged_method, scale_bar};
use crate::app::parameter::explained_combo;
use crate::app::{theme, view_state};

/// Width of the drop-downs, points.
const COMBO_WIDTH: f32 = 126.0;
/// Width of the scale, points.
const SCALE_WIDTH: f32 = 96.0;

/// Shows the controls in the row that is open.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.spacing_mut().item_spacing.x = 2.0 * theme::GRID;
    let shading = &mut context.view.map.shading;
    in_width(ui, |ui| {
        let meaning = MapShading::ALL.iter().find(|(one, ..)| one == shading).map_or("", |(.., meaning)| meaning);
        let tooltip = format!("What the levels show of their texels.\n{meaning}");
        explained_combo(ui, "Texels as", shading, &MapShading::ALL).on_hover_text(tooltip);
    });
    let shading = *shading;
    if shading == MapShading::Error {
        in_width(ui, |ui| judged_method::show(ui, context, "Error of"));
    }
    match shading.scale(context.session) {
        Some(scale) => drop(scale_bar::show(ui, &scale, SCALE_WIDTH)),
        None => drop(ui.label(RichText::new("a click selects the texel under it").small().color(theme::of(ui).weak))),
    }
    if shading == MapShading::Error {
        if context.view.layout != view_state::Layout::Map {
            ui.menu_button("Worst texels", |ui| worst::list(ui, context));
        }
        if let Some(progress) = context.errors.progress() {
            ui.label(RichText::new(progress).small().color(theme::of(ui).accent));
        }
    }
}

fn in_width(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let size = vec2(COMBO_WIDTH, theme::ROW);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), contents);
}
