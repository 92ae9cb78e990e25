//! What the pointer does on the picture: orbit, light, dolly, and the choice of a texel.

use egui::{PointerButton, Response, Ui};

use super::cells::Cells;
use crate::app::Command;
use crate::app::light_view::LightView;
use crate::app::panels::{PanelContext, light_dome};
use crate::lit_surface::LitSurface;
use crate::reference::raster;

/// Drag orbits, L + drag or right drag moves the selected light, the wheel dollies.
pub fn steer(ui: &Ui, response: &Response, surface: &mut LitSurface, light: &LightView) {
    let delta = response.drag_delta();
    let light_key = ui.input(|input| input.key_down(egui::Key::L));
    let moves_light =
        response.dragged_by(PointerButton::Secondary) || light_key && response.dragged_by(PointerButton::Primary);
    if moves_light {
        light_dome::drag(surface, light, delta);
    } else if response.dragged() {
        surface.camera.orbit(-0.4 * delta.x, 0.4 * delta.y);
    }
    if response.hovered() {
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        if scroll != 0.0 {
            surface.camera.dolly((-0.003 * scroll).exp());
        }
    }
}

/// A click selects the texel that is shaded there, in whichever cell, at the level in use.
pub fn pick(context: &mut PanelContext<'_>, response: &Response, cells: &Cells) {
    let Some(position) = response.interact_pointer_pos().filter(|_| response.clicked()) else { return };
    let Some(cell) = cells.at(position) else { return };
    let surface = &context.session.surface;
    let map = context.session.map();
    let coarsest = (map.level_sizes().len() - 1) as f32;
    let levels = context.surroundings.target.status.get().lobe_levels.unwrap_or([0.0, coarsest]);
    if let Some(point) = raster::pick(surface, cells.cell_size(), cells.pixel(cell, position)) {
        context.view.pinned_repeat = [point.uv.x, point.uv.y].map(|v| v.floor() as i32);
        let texel = raster::texel_at(surface, map, &point, levels);
        context.push(Command::Select(texel));
    }
}
