//! The map: every level as a strip, and one level or all of them zoomed and panned. Both select texels.

use egui::{Align2, FontId, Frame, Margin, Panel, Rect, Response, Sense, Stroke, StrokeKind, Ui, UiBuilder};
use egui::{Color32, Painter, Vec2, pos2, vec2};

use super::{PanelContext, region};
use crate::app::level_places::{LevelPlaces, MapLevels};
use crate::app::map_picture::MapProjection;
use crate::app::parameter::explained_combo;
use crate::app::texel_values::TexelValues;
use crate::app::view_state::{Layout, MapView, Overlay};
use crate::app::{Command, theme};
use crate::normal_map::pyramid::Texel;
use crate::session::Session;

mod numbers;
mod shading;
mod side;
mod strip;
mod worst;

pub use strip::strip;

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

/// A ring around a texel, no smaller than `least` points, readable on any colour.
fn ring(painter: &Painter, texel: Rect, least: f32) {
    let rect = Rect::from_center_size(texel.center(), texel.size().max(Vec2::splat(2.0 * least)));
    painter.rect_stroke(rect.expand(1.0), 1.0, Stroke::new(1.0, Color32::from_black_alpha(200)), StrokeKind::Outside);
    painter.rect_stroke(rect, 1.0, Stroke::new(1.5, Color32::WHITE), StrokeKind::Outside);
}

/// Reads the texel under the pointer and selects it on a click.
fn point_at(context: &mut PanelContext<'_>, response: &Response, projection: &MapProjection, level: usize) {
    let size = context.session.map().level_sizes()[level];
    let Some(texel) = response.hover_pos().and_then(|position| projection.texel(position, level, size)) else {
        return;
    };
    let value = TexelValues::new(context.session, context.errors, context.view.map.shading).words(texel);
    *context.hover = Some(describe(context.session, texel, value));
    if response.clicked() {
        context.push(Command::Select(texel));
    }
}

/// A texel in numbers: the value that is shown, then stored value, vector, angle from +z, length of the mean normal.
fn describe(session: &Session, texel: Texel, value: Option<String>) -> String {
    let map = session.map();
    let width = map.level_sizes()[texel.level].0;
    let mean = session.mip().levels[texel.level][texel.y * width + texel.x];
    let value = value.map_or(String::new(), |value| format!("  {value}"));
    let place = format!("level {} ({}, {}){value}", texel.level, texel.x, texel.y);
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

/// The selected level, or all of them, zoomed and panned.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let counts = beside(ui, context);
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    let response = response.accessible_name("Map view");
    let selected = context.session.selected().level;
    let view = rect.shrink(12.0);
    let places = LevelPlaces::new(context.view.map.levels, context.session.map(), selected);
    if !(counts && choose_region(ui, context, &response, view, &places)) {
        navigate(ui, context, &response, view, &places);
    }
    let projection = MapProjection::new(view, places.size, &context.view.map);
    for &(level, place) in &places.levels {
        let projection = projection.part(place);
        picture(ui, context, &response, &projection, level);
        if let Some(chosen) = context.view.map_region.chosen.filter(|_| counts) {
            let name = (level == selected).then_some("histogram of this region");
            region::show(&ui.painter_at(rect), chosen, projection.whole(), name);
        }
    }
    let size = context.session.map().level_size(selected);
    let place = places.place(selected).unwrap_or(WHOLE);
    let px = projection.part(place).points_per_texel(size.0 as f32) * ui.pixels_per_point();
    let text = format!("level {selected} · {} × {} · {:.0} %", size.0, size.1, 100.0 * px);
    badge(ui.painter(), rect.left_top() + vec2(12.0, 12.0), Align2::LEFT_TOP, &text, theme::of(ui).text);
    choose_levels(ui, context, rect);
}

/// What there is of numbers, right of the map where that has the middle of the window for itself; true if there is.
fn beside(ui: &mut Ui, context: &mut PanelContext<'_>) -> bool {
    let scale = context.view.map.shading.scale(context.session);
    let shown = scale.filter(|_| context.view.layout == Layout::Map);
    if let Some(scale) = &shown {
        let frame = Frame::new().fill(theme::of(ui).panel).inner_margin(Margin::symmetric(10, 8));
        let side = Panel::right("map side").frame(frame).exact_size(side::WIDTH).resizable(false);
        side.show(ui, |ui| side::show(ui, context, scale));
    }
    shown.is_some()
}

/// Draws the region that the histogram counts, in any of the levels; true while it is being drawn.
fn choose_region(
    ui: &Ui,
    context: &mut PanelContext<'_>,
    response: &Response,
    view: Rect,
    places: &LevelPlaces,
) -> bool {
    let projection = MapProjection::new(view, places.size, &context.view.map);
    let level_at = |position| {
        let mut levels = places.levels.iter().map(|(_, place)| projection.part(*place).whole());
        levels.find(|level| level.contains(position))
    };
    let listens = context.view.overlay == Overlay::None;
    region::drag(ui, &mut context.view.map_region, listens, response, level_at)
}

/// One level, as far as it is in sight.
fn picture(ui: &Ui, context: &mut PanelContext<'_>, response: &Response, projection: &MapProjection, level: usize) {
    let area = projection.visible();
    if !area.is_positive() {
        return;
    }
    let values = TexelValues::new(context.session, context.errors, context.view.map.shading);
    let px = (area.size() * ui.pixels_per_point()).round().max(Vec2::splat(1.0));
    let key = (*projection, area, [px.x as usize, px.y as usize]);
    let texture = context.textures.view(ui.ctx(), &values, level, key);
    ui.painter().image(texture, area, WHOLE, Color32::WHITE);
    numbers::draw(&ui.painter_at(area), &values, projection, level, area);
    point_at(context, response, projection, level);
    let selected = context.session.selected();
    if selected.level == level {
        let size = context.session.map().level_size(level);
        ring(&ui.painter_at(response.rect), projection.texel_rect((selected.x, selected.y), size), 4.0);
    }
}

/// The choice of the levels in the picture's corner.
fn choose_levels(ui: &mut Ui, context: &mut PanelContext<'_>, rect: Rect) {
    let corner = Rect::from_min_size(rect.right_top() + vec2(-140.0, 12.0), vec2(128.0, theme::ROW));
    let mut ui = ui.new_child(UiBuilder::new().max_rect(corner));
    let mut levels = context.view.map.levels;
    explained_combo(&mut ui, "Levels shown", &mut levels, &MapLevels::ALL);
    if levels != context.view.map.levels {
        context.view.map = MapView { levels, ..context.view.map.whole() };
    }
}

fn navigate(ui: &Ui, context: &mut PanelContext<'_>, response: &Response, view: Rect, places: &LevelPlaces) {
    let projection = MapProjection::new(view, places.size, &context.view.map);
    if response.dragged() {
        context.view.map = projection.dragged(context.view.map, response.drag_delta());
    }
    if response.double_clicked() {
        context.view.map = context.view.map.whole();
    }
    if let Some(position) = response.hover_pos() {
        let scroll = ui.input(|input| input.smooth_scroll_delta().y);
        if scroll != 0.0 {
            let across = match context.view.map.levels {
                MapLevels::Selected => context.session.map().level_size(context.session.selected().level).0 as f32,
                MapLevels::EqualSize | MapLevels::ActualSize => places.size.x,
            };
            context.view.map = projection.zoomed(context.view.map, (scroll * 0.005).exp(), position, across);
        }
    }
}

/// A label that lies on a picture; its rectangle.
pub fn badge(painter: &Painter, at: egui::Pos2, align: Align2, text: &str, color: Color32) -> Rect {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), color);
    let rect = align.anchor_size(at, galley.size() + vec2(16.0, 8.0));
    painter.rect_filled(rect, 4.0, theme::of(painter).badge);
    painter.galley(rect.min + vec2(8.0, 4.0), galley, color);
    rect
}

/// How large the label of a text is.
pub fn badge_size(painter: &Painter, text: &str) -> Vec2 {
    painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), theme::of(painter).text).size()
        + vec2(16.0, 8.0)
}
