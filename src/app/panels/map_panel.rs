//! The map: every level as a strip, and one level zoomed and panned. Both select texels.

use egui::{Align, Align2, FontId, Layout, Rect, Response, RichText, ScrollArea, Sense, Stroke, StrokeKind, Ui, Vec2};
use egui::{Color32, Painter, pos2, vec2};

use super::{PanelContext, segmented};
use crate::app::map_picture::MapProjection;
use crate::app::view_state::MapShading;
use crate::app::{Command, theme};
use crate::normal_map::pyramid::Texel;
use crate::session::Session;
use crate::session::fitting::LevelState;

/// Longer side of a level in the strip, in points: all levels in sight where that leaves them large enough.
const THUMBNAIL: [f32; 2] = [44.0, 64.0];
/// Between two levels.
const GAP: f32 = 8.0;

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

/// The strip of levels.
pub fn strip(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        super::heading(ui, "Levels");
        ui.label(RichText::new("a click selects the texel under it").small().color(theme::WEAK));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let reversed: Vec<_> = MapShading::ALL.into_iter().rev().collect();
            segmented(ui, "Texels as", &mut context.view.map.shading, &reversed);
        });
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
        let texture = context.textures.thumbnail(ui.ctx(), context.session, context.view.map.shading, level, pixels);
        ui.painter().rect_filled(cell, 0.0, theme::CANVAS);
        ui.painter().image(texture, rect, WHOLE, Color32::WHITE);
        let projection =
            MapProjection::new(rect, (context.session.map().width, context.session.map().height), &Default::default());
        point_at(context, &response, &projection, level);
        frame(ui.painter(), context.session, cell, &projection, level, response.hovered());
        caption(ui, context.session, level, side);
    });
}

fn frame(painter: &Painter, session: &Session, cell: Rect, projection: &MapProjection, level: usize, hovered: bool) {
    let selected = session.selected();
    let is_selected = selected.level == level;
    let color = match (is_selected, hovered) {
        (true, _) => theme::ACCENT,
        (false, true) => theme::WEAK,
        _ => theme::LINE,
    };
    let width = if is_selected { 2.0 } else { 1.0 };
    painter.rect_stroke(cell, 2.0, Stroke::new(width, color), StrokeKind::Outside);
    if is_selected {
        let rect = projection.texel_rect((selected.x, selected.y), session.map().level_sizes()[level]);
        ring(painter, rect, 3.0);
    }
}

/// A ring around a texel, no smaller than `least` points, readable on any colour.
fn ring(painter: &Painter, texel: Rect, least: f32) {
    let rect = Rect::from_center_size(texel.center(), texel.size().max(Vec2::splat(2.0 * least)));
    painter.rect_stroke(rect.expand(1.0), 1.0, Stroke::new(1.0, Color32::from_black_alpha(200)), StrokeKind::Outside);
    painter.rect_stroke(rect, 1.0, Stroke::new(1.5, Color32::WHITE), StrokeKind::Outside);
}

fn caption(ui: &mut Ui, session: &Session, level: usize, side: f32) {
    let size = session.map().level_sizes()[level];
    let state = session.fitting().levels()[level].state;
    let (rect, response) = ui.allocate_exact_size(vec2(side, 3.0), Sense::hover());
    let fraction = session.fitting().progress().and_then(|progress| progress.levels.get(level).copied());
    let (fraction, color, words) = match (state, fraction) {
        (LevelState::Done, _) => (1.0, theme::ACCENT.gamma_multiply(0.55), "fitted"),
        (LevelState::Unaligned, _) => (1.0, theme::WARNING.gamma_multiply(0.6), "fitted, not aligned yet"),
        (LevelState::Earlier, _) => (1.0, theme::WEAK.gamma_multiply(0.6), "lobes of earlier settings"),
        (LevelState::Missing, fraction) => (fraction.unwrap_or(0.0), theme::ACCENT, "not fitted yet"),
    };
    ui.painter().rect_filled(rect, 1.0, theme::LINE);
    let done = Rect::from_min_size(rect.min, vec2(rect.width() * fraction, rect.height()));
    ui.painter().rect_filled(done, 1.0, color);
    response.on_hover_text(words);
    let (rect, _) = ui.allocate_exact_size(vec2(side, 13.0), Sense::hover());
    let painter = ui.painter();
    painter.text(rect.left_top(), Align2::LEFT_TOP, level, FontId::proportional(11.0), theme::TEXT);
    let text = if size.0 == size.1 { format!("{}²", size.0) } else { format!("{}×{}", size.0, size.1) };
    painter.text(rect.right_top(), Align2::RIGHT_TOP, text, FontId::proportional(10.0), theme::WEAK);
}

/// Reads the texel under the pointer and selects it on a click.
fn point_at(context: &mut PanelContext<'_>, response: &Response, projection: &MapProjection, level: usize) {
    let size = context.session.map().level_sizes()[level];
    let Some(texel) = response.hover_pos().and_then(|position| projection.texel(position, level, size)) else {
        return;
    };
    *context.hover = Some(describe(context.session, texel));
    if response.clicked() {
        context.push(Command::Select(texel));
    }
}

/// A texel in numbers: stored value, vector, angle from +z, length of the mean normal.
fn describe(session: &Session, texel: Texel) -> String {
    let map = session.map();
    let width = map.level_sizes()[texel.level].0;
    let mean = session.mip().levels[texel.level][texel.y * width + texel.x];
    let place = format!("level {} ({}, {})", texel.level, texel.x, texel.y);
    let Some(normal) = mean.try_normalize() else { return format!("{place}  no valid normal") };
    let angle = normal.truncate().length().atan2(normal.z).to_degrees();
    let vector = format!("({:.3}, {:.3}, {:.3})  {angle:.1}°", normal.x, normal.y, normal.z);
    if texel.level > 0 {
        return format!("{place}  {vector}  length {:.3}", mean.length());
    }
    let stored: Vec<String> =
        (0..map.stored.channels).map(|channel| number(map.stored.sample(texel.x, texel.y, channel))).collect();
    format!("{place}  stored {}  {vector}", stored.join(" "))
}

fn number(value: f64) -> String {
    if value.fract() == 0.0 { format!("{value:.0}") } else { format!("{value:.4}") }
}

/// The selected level, zoomed and panned.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let response = response.accessible_name("Map view");
    let base = (context.session.map().width, context.session.map().height);
    let view = rect.shrink(12.0);
    let level = context.session.selected().level;
    navigate(ui, context, &response, view, base);
    let projection = MapProjection::new(view, base, &context.view.map);
    let area = projection.visible();
    if area.is_positive() {
        let px = (area.size() * ui.pixels_per_point()).round().max(Vec2::splat(1.0));
        let key = (projection, area, [px.x as usize, px.y as usize]);
        let shading = (context.view.map.shading, level);
        let texture = context.textures.view(ui.ctx(), context.session, shading, key);
        ui.painter().image(texture, area, WHOLE, Color32::WHITE);
    }
    point_at(context, &response, &projection, level);
    let selected = context.session.selected();
    let size = context.session.map().level_sizes()[level];
    ring(&ui.painter_at(rect), projection.texel_rect((selected.x, selected.y), size), 4.0);
    let text = format!("level {level} · {} × {} · {:.0} %", size.0, size.1, 100.0 * context.view.map.zoom);
    badge(ui.painter(), rect.left_top() + vec2(12.0, 12.0), Align2::LEFT_TOP, &text, theme::TEXT);
}

fn navigate(ui: &Ui, context: &mut PanelContext<'_>, response: &Response, view: Rect, base: (usize, usize)) {
    let projection = MapProjection::new(view, base, &context.view.map);
    if response.dragged() {
        context.view.map = projection.dragged(context.view.map, response.drag_delta());
    }
    if response.double_clicked() {
        let shading = context.view.map.shading;
        context.view.map = crate::app::view_state::MapView { shading, ..Default::default() };
    }
    if let Some(position) = response.hover_pos() {
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        if scroll != 0.0 {
            context.view.map = projection.zoomed(context.view.map, (scroll * 0.005).exp(), position, base);
        }
    }
}

/// A label that lies on a picture; its rectangle.
pub fn badge(painter: &Painter, at: egui::Pos2, align: Align2, text: &str, color: Color32) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), color);
    let rect = align.anchor_size(at, galley.size() + vec2(16.0, 8.0));
    painter.rect_filled(rect, 4.0, theme::BADGE);
    painter.galley(rect.min + vec2(8.0, 4.0), galley, color);
    rect
}

/// How large the label of a text is.
pub fn badge_size(painter: &Painter, text: &str) -> Vec2 {
    painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), theme::TEXT).size() + vec2(16.0, 8.0)
}
