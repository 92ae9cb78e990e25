//! What lies over the picture of the surface: the selected texel, the wipe's handle, the hint.

use egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, StrokeKind, vec2};
use glam::{IVec2, Vec2, Vec3};

use super::PanelContext;
use super::map_panel::badge;
use crate::app::theme;
use crate::lit_surface::LitSurface;
use crate::scene::Vertex;

/// From this width on a picture has room for the hint beside the lights.
pub const HINT_ROOM: f32 = 580.0;

/// What the pointer does, in a line with its bottom left corner at `at`.
pub fn hint(painter: &Painter, at: Pos2) -> Rect {
    let text = "drag: orbit · L + drag: light · Shift + drag: region · wheel: dolly · click: select";
    badge(painter, at, Align2::LEFT_BOTTOM, text, theme::of(painter).weak)
}

/// The wipe's handle.
pub fn wipe_handle(painter: &Painter, handle: Rect, hot: bool) {
    let color = if hot { theme::of(painter).accent } else { theme::of(painter).text };
    let grip = Rect::from_center_size(handle.center(), vec2(12.0, 36.0));
    painter.rect_filled(grip, 6.0, theme::of(painter).badge);
    painter.rect_stroke(grip, 6.0, Stroke::new(1.5, color), StrokeKind::Inside);
    for dx in [-2.0, 2.0] {
        let x = grip.center().x + dx;
        painter.vline(x, grip.center().y - 7.0..=grip.center().y + 7.0, Stroke::new(1.0, color));
    }
}

/// The outline of the selected texel's footprint on the surface, in the picture of one method.
pub fn outline(painter: &Painter, context: &PanelContext<'_>, picture: Rect) {
    let surface = &context.session.surface;
    let selected = context.session.selected();
    let (width, height) = context.session.map().level_sizes()[selected.level];
    let map_size = Vec2::new(width as f32, height as f32);
    let corner = Vec2::new(selected.x as f32, selected.y as f32);
    let surface_from_uv = surface.shape.uv_from_surface().inverse();
    let in_repeat = |repeat: Vec2, x: f32, y: f32| surface_from_uv * (repeat + (corner + Vec2::new(x, y)) / map_size);
    let pinned = IVec2::from(context.view.pinned_repeat).as_vec2();
    // Of a repeat that the surface no longer has, the first is taken.
    let repeat = if is_on_surface(in_repeat(pinned, 0.5, 0.5)) { pinned } else { Vec2::ZERO };
    let place = |x: f32, y: f32| in_repeat(repeat, x, y);
    if surface.shape.jet(0.5, 0.5).is_none() {
        let point = surface.shape.mesh().point_at(place(0.5, 0.5));
        if let Some(middle) = point.and_then(|point| project_facing(surface, picture, point)) {
            ring(painter, middle);
        }
        return;
    }
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
    let mut line = Vec::new();
    for pair in corners.windows(2) {
        for step in 0..12 {
            let t = step as f32 / 12.0;
            let at = (pair[0].0 + t * (pair[1].0 - pair[0].0), pair[0].1 + t * (pair[1].1 - pair[0].1));
            line.extend(seen(surface, picture, place(at.0, at.1)));
        }
    }
    let Some(middle) = seen(surface, picture, place(0.5, 0.5)).filter(|_| line.len() == 48) else { return };
    let extent = Rect::from_points(&line);
    if extent.width().max(extent.height()) < 8.0 {
        ring(painter, middle);
        return;
    }
    painter.add(egui::Shape::closed_line(line.clone(), Stroke::new(3.0, Color32::from_black_alpha(140))));
    painter.add(egui::Shape::closed_line(line, Stroke::new(1.5, Color32::WHITE)));
}

/// A ring around what is too small, or too curved, for an outline.
fn ring(painter: &Painter, middle: Pos2) {
    painter.circle_stroke(middle, 6.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
    painter.circle_stroke(middle, 6.0, Stroke::new(1.5, Color32::WHITE));
}

fn is_on_surface(uv: Vec2) -> bool {
    uv.min_element() >= 0.0 && uv.max_element() <= 1.0
}

/// Where a parametric surface's point at `uv` is seen; `None` off the surface, behind the eye, or facing away.
fn seen(surface: &LitSurface, picture: Rect, uv: Vec2) -> Option<Pos2> {
    let (u, v) = (f64::from(uv.x), f64::from(uv.y));
    let jet = surface.shape.jet(u, 1.0 - v).filter(|_| is_on_surface(uv))?.scaled(surface.shape.scale());
    let vertex = Vertex::of_jet(&jet, 1.0 - v, [u, v]);
    project_facing(surface, picture, [vertex.position, vertex.normal].map(Vec3::from))
}

/// Where a point with this normal is seen; `None` behind the eye, or facing away.
fn project_facing(surface: &LitSurface, picture: Rect, [position, normal]: [Vec3; 2]) -> Option<Pos2> {
    let facing = normal.dot(surface.camera.eye_in_world() - position) > 0.0;
    facing.then(|| project(surface, picture, position)).flatten()
}

/// Where a point of the world is seen in the picture; `None` behind the eye.
pub fn project(surface: &LitSurface, picture: Rect, position: Vec3) -> Option<Pos2> {
    let clip = surface.camera.clip_from_world(picture.width() / picture.height()) * position.extend(1.0);
    let place = vec2(clip.x, -clip.y) / clip.w * 0.5 + egui::Vec2::splat(0.5);
    (clip.w > 0.0).then(|| picture.min + place * picture.size())
}
