//! The texels whose error is highest; a click goes there.

use egui::{Align2, FontId, RichText, Sense, Ui, WidgetInfo, vec2};

use crate::app::level_places::LevelPlaces;
use crate::app::panels::PanelContext;
use crate::app::{Command, theme};
use crate::filter::worst_texels::WorstTexel;

/// Size of a row, points.
const ROW: [f32; 2] = [188.0, 18.0];

/// Shows the list, the worst first, as far as errors are known.
pub fn list(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let worst = context.errors.worst().to_vec();
    if worst.is_empty() {
        ui.label(RichText::new("No error is known yet.").small().color(theme::of(ui).weak));
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    for (index, worst) in worst.into_iter().enumerate() {
        if row(ui, context, index + 1, worst) {
            go_to(context, worst);
        }
    }
}

/// A row as a button, the texel on the left, its error on the right; true when it is clicked.
fn row(ui: &mut Ui, context: &PanelContext<'_>, place: usize, WorstTexel { texel, error }: WorstTexel) -> bool {
    let (rect, response) = ui.allocate_exact_size(ROW.into(), Sense::click());
    let name = format!("Worst texel {place}");
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &name));
    if response.hovered() {
        ui.painter().rect_filled(rect, 2.0, ui.visuals().widgets.hovered.bg_fill);
    }
    let color = if context.session.selected() == texel { theme::of(ui).accent } else { theme::of(ui).text };
    let inside = rect.shrink2(vec2(theme::GRID, 0.0));
    let font = FontId::proportional(12.0);
    let where_it_is = format!("level {} ({}, {})", texel.level, texel.x, texel.y);
    ui.painter().text(inside.left_center(), Align2::LEFT_CENTER, where_it_is, font.clone(), color);
    let error = format!("{:.1} %", 100.0 * error);
    ui.painter().text(inside.right_center(), Align2::RIGHT_CENTER, error, font, color);
    response.clicked()
}

/// Selects the texel and brings it to the middle of the map view.
fn go_to(context: &mut PanelContext<'_>, worst: WorstTexel) {
    let map = context.session.map();
    let places = LevelPlaces::new(context.view.map.levels, map, worst.texel.level);
    context.view.map.center = places.middle(worst.texel, map.level_size(worst.texel.level)).into();
    context.push(Command::Select(worst.texel));
}
