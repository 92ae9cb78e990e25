//! Every level as a strip; a click selects the texel under it.

use egui::{Align2, FontId, Painter, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, Vec2};
use egui::{Color32, vec2};

use super::{WHOLE, point_at, ring, shading};
use crate::app::map_picture::MapProjection;
use crate::app::panels::PanelContext;
use crate::app::texel_values::TexelValues;
use crate::app::theme;
use crate::session::Session;
use crate::session::fitting::LevelState;

/// Longer side of a level in the strip, in points: all levels in sight where that leaves them large enough.
const THUMBNAIL: [f32; 2] = [44.0, 64.0];
/// Between two levels.
const GAP: f32 = 8.0;

/// The strip of levels.
pub fn strip(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        shading::show(ui, context);
    });
    ScrollArea::horizontal().auto_shrink([false, true]).show(ui, |ui| {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            let levels = context.session.map().level_sizes().len();
            let [least, most] = THUMBNAIL;
            let side = ((ui.available_width() - 4.0) / levels as f32 - GAP).floor().clamp(least, most);
            for level in 0..levels {
                thumbnail(ui, context, level, side);
            }
        });
        ui.add_space(theme::GRID);
    });
}

fn thumbnail(ui: &mut Ui, context: &mut PanelContext<'_>, level: usize, side: f32) {
    let size = context.session.map().level_sizes()[level];
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        let (cell, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click());
        let response = response.accessible_name(format!("Level {level}"));
        let longer = size.0.max(size.1) as f32;
        let shown = (vec2(size.0 as f32, size.1 as f32) * side / longer).max(Vec2::splat(2.0));
        let rect = Rect::from_center_size(cell.center(), shown);
        let pixels = (side * ui.pixels_per_point()).round() as usize;
        let values = TexelValues::new(context.session, context.errors, context.view.map.shading);
        let texture = context.textures.thumbnail(ui.ctx(), &values, level, pixels);
        ui.painter().rect_filled(cell, 0.0, theme::of(ui).canvas);
        ui.painter().image(texture, rect, WHOLE, Color32::WHITE);
        let base = vec2(context.session.map().width as f32, context.session.map().height as f32);
        let projection = MapProjection::new(rect, base, &Default::default());
        point_at(context, &response, &projection, level);
        frame(ui.painter(), context.session, cell, &projection, level, response.hovered());
        caption(ui, context.session, level, side);
    });
}

fn frame(painter: &Painter, session: &Session, cell: Rect, projection: &MapProjection, level: usize, hovered: bool) {
    let selected = session.selected();
    let is_selected = selected.level == level;
    let color = match (is_selected, hovered) {
        (true, _) => theme::of(painter).accent,
        (false, true) => theme::of(painter).weak,
        _ => theme::of(painter).line,
    };
    let width = if is_selected { 2.0 } else { 1.0 };
    painter.rect_stroke(cell, 2.0, Stroke::new(width, color), StrokeKind::Outside);
    if is_selected {
        let rect = projection.texel_rect((selected.x, selected.y), session.map().level_sizes()[level]);
        ring(painter, rect, 3.0);
    }
}

fn caption(ui: &mut Ui, session: &Session, level: usize, side: f32) {
    let size = session.map().level_sizes()[level];
    let state = session.fitting().levels()[level].state;
    let (rect, response) = ui.allocate_exact_size(vec2(side, 3.0), Sense::hover());
    let fraction = session.fitting().progress().and_then(|progress| progress.levels.get(level).copied());
    let (fraction, color, words) = match (state, fraction) {
        (LevelState::Done, _) => (1.0, theme::of(ui).accent.gamma_multiply(0.55), "fitted"),
        (LevelState::Unaligned, _) => (1.0, theme::of(ui).warning.gamma_multiply(0.6), "fitted, not aligned yet"),
        (LevelState::Earlier, _) => (1.0, theme::of(ui).weak.gamma_multiply(0.6), "lobes of earlier settings"),
        (LevelState::Missing, fraction) => (fraction.unwrap_or(0.0), theme::of(ui).accent, "not fitted yet"),
    };
    ui.painter().rect_filled(rect, 1.0, theme::of(ui).line);
    let done = Rect::from_min_size(rect.min, vec2(rect.width() * fraction, rect.height()));
    ui.painter().rect_filled(done, 1.0, color);
    response.on_hover_text(words);
    let (rect, _) = ui.allocate_exact_size(vec2(side, 13.0), Sense::hover());
    let painter = ui.painter();
    painter.text(rect.left_top(), Align2::LEFT_TOP, level, FontId::proportional(11.0), theme::of(ui).text);
    let text = if size.0 == size.1 { format!("{}²", size.0) } else { format!("{}×{}", size.0, size.1) };
    painter.text(rect.right_top(), Align2::RIGHT_TOP, text, FontId::proportional(10.0), theme::of(ui).weak);
}
