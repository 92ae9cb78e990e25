//! The lit surface: two methods beside each other, or a grid of them, and what the pointer does there.

use egui::{CursorIcon, Id, Pos2, Rect, Sense, Ui, UiBuilder, vec2};

use super::{PanelContext, light_dome, needles, region, surface_overlay as overlay};
use crate::app::view_state::Overlay;
use crate::app::viewport::SurfacePaint;
use crate::app::{Command, theme};
use crate::comparison::{Arrangement, Comparison};

mod badges;
mod cells;
mod difference_scale;
mod figures;
mod methods;
mod seeing;
mod steering;

pub use cells::Cells;

/// Margin around the bar's rows, and between them.
const MARGIN: f32 = 6.0;
/// From this width on the bar has room for all of its controls.
const ROOMY: f32 = 480.0;

/// Shows the bar and the picture.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let (mut surface, mut comparison) = (context.session.surface.clone(), context.session.comparison);
    let whole = ui.available_rect_before_wrap();
    let (bar, picture) = whole.split_top_bottom_at_y(whole.top() + bar_height(&comparison));
    ui.painter().rect_filled(bar, 0.0, theme::of(ui).panel);
    let flips = ui
        .scope_builder(UiBuilder::new().max_rect(bar.shrink2(vec2(12.0, MARGIN))), |ui| {
            ui.spacing_mut().item_spacing.y = MARGIN;
            seeing::show(ui, context.view, &mut comparison.view, &mut surface.camera);
            context.session.comparison.view.grid_side().is_none() && methods::show(ui, &mut comparison)
        })
        .inner;
    let arrangement = context.session.comparison.arrangement(flips || space_is_held(ui));
    let response = ui.allocate_rect(picture, Sense::click_and_drag()).accessible_name("Surface view");
    let cells = Cells::new(arrangement, picture, ui.pixels_per_point());
    let target = &context.surroundings.target;
    let mut paint = SurfacePaint::new(context.session, arrangement, cells.size, target, ui.ctx());
    paint.against_truth = !context.view.hides_figures;
    ui.painter().add(paint.shape(picture));
    let listens = context.view.overlay == Overlay::None;
    if !region::drag(ui, &mut context.view.region, listens, &response, |position| cells.at(position)) {
        steering::steer(ui, &response, &mut surface, &context.view.light);
    }
    steering::pick(context, &response, &cells);
    draw_over(ui, context, &cells);
    light_dome::show(ui, context, picture);
    if let Arrangement::Wipe(_) = arrangement {
        wipe(ui, &mut comparison, picture);
    }
    cell_methods(ui, &mut comparison, &cells);
    if surface != context.session.surface {
        context.push(Command::SetSurface(surface));
    }
    if comparison != context.session.comparison {
        context.push(Command::SetComparison(comparison));
    }
}

fn bar_height(comparison: &Comparison) -> f32 {
    let rows = if comparison.view.grid_side().is_none() { 2.0 } else { 1.0 };
    MARGIN + rows * (theme::ROW + MARGIN)
}

/// The space bar flips, unless it is typed or presses what has the focus.
fn space_is_held(ui: &Ui) -> bool {
    ui.memory(|memory| memory.focused().is_none()) && ui.input(|input| input.key_down(egui::Key::Space))
}

fn draw_over(ui: &Ui, context: &PanelContext<'_>, cells: &Cells) {
    for (index, cell) in cells.rects().enumerate() {
        let painter = ui.painter_at(cell.intersect(cells.picture));
        needles::show(&painter, context, cell);
        overlay::outline(&painter, context, cell);
        if let Some(region) = context.view.region.chosen {
            region::show(&painter, region, cell, (index == 0).then_some("figures of this region"));
        }
    }
    let painter = ui.painter_at(cells.picture);
    badges::show(ui, context, cells);
    let mut corner = cells.picture.left_bottom() + vec2(12.0, -12.0);
    // In a grid it would lie on what is seen there.
    if cells.picture.width() >= overlay::HINT_ROOM && cells.arrangement.side() == 1 {
        corner = overlay::hint(&painter, corner).left_top() - vec2(0.0, theme::GRID);
    }
    if let Arrangement::Difference(difference) = cells.arrangement {
        difference_scale::show(&painter, difference, corner);
    }
}

/// The handle on the picture that moves the wipe.
fn wipe(ui: &Ui, comparison: &mut Comparison, picture: Rect) {
    if comparison.left == comparison.right {
        return;
    }
    let x = picture.left() + comparison.wipe * picture.width();
    let handle = Rect::from_center_size(Pos2::new(x, picture.center().y), vec2(18.0, 44.0));
    let response = ui.interact(handle, Id::unique("wipe handle"), Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal).accessible_name("Wipe handle");
    if let Some(position) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        comparison.wipe = ((position.x - picture.left()) / picture.width()).clamp(0.0, 1.0);
    }
    if response.double_clicked() {
        comparison.wipe = Comparison::default().wipe;
    }
    overlay::wipe_handle(&ui.painter_at(picture), handle, response.hovered() || response.dragged());
}

/// In a grid, the list of methods at the head of each cell.
fn cell_methods(ui: &mut Ui, comparison: &mut Comparison, cells: &Cells) {
    let Arrangement::Grid { .. } = cells.arrangement else { return };
    for (index, (cell, method)) in cells.rects().zip(&mut comparison.grid).enumerate() {
        let place = Rect::from_min_size(cell.min + badges::CELL_INSET, vec2(methods::COMBO_WIDTH, theme::ROW));
        ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            methods::combo(ui, &format!("Method of cell {}", index + 1), method, methods::COMBO_WIDTH);
        });
    }
}
