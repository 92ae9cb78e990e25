//! What lies over the picture of the surface: the selected texel, the wipe's handle, the hint.

use egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, StrokeKind, Vec2, vec2};
use glam::Vec3;

use super::PanelContext;
use super::map_panel::badge;
use crate::app::theme;
use crate::lit_surface::LitSurface;

/// From this width on a picture has room for the hint beside the lights.
pub const HINT_ROOM: f32 = 580.0;

/// What the pointer does, in a line with its bottom left corner at `at`.
pub fn hint(painter: &Painter, at: Pos2) -> Rect {
    let text = "drag: orbit · L + drag: light · Shift + drag: region · wheel: dolly · click: select";
    badge(painter, at, Align2::LEFT_BOTTOM, text, theme::WEAK)
}

/// The wipe's handle.
pub fn wipe_handle(painter: &Painter, handle: Rect, hot: bool) {
    let color = if hot { theme::ACCENT } else { Color32::from_white_alpha(210) };
    let grip = Rect::from_center_size(handle.center(), vec2(12.0, 36.0));
    painter.rect_filled(grip, 6.0, theme::BADGE);
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
    let repeat = context.view.pinned_repeat;
    let [across, down] = surface.shape.tiling;
    // Of a repeat that the tiling no longer has, the first is taken.
    let kept = |repeat: u32, tiling: f32| if (repeat as f32) < tiling { repeat as f32 } else { 0.0 };
    let u = |x: f32| (kept(repeat[0], across) + (selected.x as f32 + x) / width as f32) / across;
    let v = |y: f32| (kept(repeat[1], down) + (selected.y as f32 + y) / height as f32) / down;
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
    let mut line = Vec::new();
    for pair in corners.windows(2) {
        for step in 0..12 {
            let t = step as f32 / 12.0;
            let at = (pair[0].0 + t * (pair[1].0 - pair[0].0), pair[0].1 + t * (pair[1].1 - pair[0].1));
            line.extend(seen(surface, picture, u(at.0), v(at.1)));
        }
    }
    let Some(middle) = seen(surface, picture, u(0.5), v(0.5)).filter(|_| line.len() == 48) else { return };
    let extent = Rect::from_points(&line);
    if extent.width().max(extent.height()) < 8.0 {
        painter.circle_stroke(middle, 6.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
        painter.circle_stroke(middle, 6.0, Stroke::new(1.5, Color32::WHITE));
        return;
    }
    painter.add(egui::Shape::closed_line(line.clone(), Stroke::new(3.0, Color32::from_black_alpha(140))));
    painter.add(egui::Shape::closed_line(line, Stroke::new(1.5, Color32::WHITE)));
}

/// Where the surface's point at `(u, v)` is seen; `None` off the surface, behind the eye, or facing away.
fn seen(surface: &LitSurface, picture: Rect, u: f32, v: f32) -> Option<Pos2> {
    if !((0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v)) {
        return None;
    }
    let vertex = surface.shape.kind.vertex(u, v);
    let (position, normal) = (Vec3::from(vertex.position), Vec3::from(vertex.normal));
    let facing = normal.dot(surface.camera.eye_in_world() - position) > 0.0;
    facing.then(|| project(surface, picture, position)).flatten()
}

/// Where a point of the world is seen in the picture; `None` behind the eye.
fn project(surface: &LitSurface, picture: Rect, position: Vec3) -> Option<Pos2> {
    let clip = surface.camera.clip_from_world(picture.width() / picture.height()) * position.extend(1.0);
    let place = vec2(clip.x, -clip.y) / clip.w * 0.5 + Vec2::splat(0.5);
    (clip.w > 0.0).then(|| picture.min + place * picture.size())
}
