//! What lies over the picture of the surface: names of the methods, the selected texel, the wipe.

use egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};

use super::PanelContext;
use super::map_panel::badge;
use super::surface_panel::{WIDE, project};
use crate::app::theme;
use crate::filter::Method;
use crate::filter::vmf::{FitSettings, Fold, Selection};
use crate::lit_surface::LitSurface;
use crate::session::fitting::LevelState;

/// The names of both methods on their sides, with what there is to say of each.
pub fn badges(painter: &Painter, context: &PanelContext<'_>, picture: Rect) {
    let comparison = context.session.comparison;
    let both = comparison.left != comparison.right;
    if comparison.wipe > 0.02 || !both {
        method_badges(painter, context, comparison.left, picture.left_top() + vec2(12.0, 12.0), Align2::LEFT_TOP);
    }
    if comparison.wipe < 0.98 && both {
        let corner = picture.right_top() + vec2(-12.0, 12.0);
        method_badges(painter, context, comparison.right, corner, Align2::RIGHT_TOP);
    }
    if picture.width() < WIDE {
        return;
    }
    let hint = "drag: orbit · L + drag: light · wheel: dolly · click: select";
    badge(painter, picture.left_bottom() + vec2(12.0, -12.0), Align2::LEFT_BOTTOM, hint, theme::WEAK);
}

fn method_badges(painter: &Painter, context: &PanelContext<'_>, method: Method, at: Pos2, align: Align2) {
    let text = match method {
        Method::Truth => {
            let report = context.surroundings.target.status.get();
            let (label, samples) = (method.label(), report.truth_samples);
            // Without the finest levels it is the truth of a smoother map.
            let level = if report.left_out > 0 { format!(" of level {}", report.left_out) } else { String::new() };
            format!("{label}{level} · {samples} of {} samples per pixel", context.session.truth_samples)
        }
        Method::Rival(_) => method.label(),
        Method::Vmf | Method::VmfUnaligned => {
            format!("{} · J = {}", method.label(), lobe_count(context.session.fit_settings()))
        }
    };
    let rect = badge(painter, at, align, &text, theme::STRONG);
    let note = if method.shows_lobes() { lobes_note(context) } else { channels_note(context, method) };
    if let Some((note, color)) = note {
        let below = pos2(if align == Align2::LEFT_TOP { rect.left() } else { rect.right() }, rect.bottom() + 4.0);
        badge(painter, below, align, &note, color);
    }
}

/// What keeps a rival from being shown.
fn channels_note(context: &PanelContext<'_>, method: Method) -> Option<(String, Color32)> {
    let rival = method.rival()?;
    let text = if !rival.is_drawn() {
        "too many bands to draw"
    } else if context.session.is_building() && context.session.channels_of(method).is_none() && rival.kind.has_channels
    {
        "being built"
    } else {
        return None;
    };
    Some((text.to_owned(), theme::WARNING))
}

/// How many lobes a texel gets, as the badge says it.
fn lobe_count(settings: &FitSettings) -> String {
    match settings.selection {
        Selection::Fixed => settings.lobes.to_string(),
        Selection::BrdfError { percent } => format!("auto {percent} %"),
        Selection::Bic => "BIC".to_owned(),
    }
}

/// What keeps the lobes shown from being the fit that was asked for.
fn lobes_note(context: &PanelContext<'_>) -> Option<(String, Color32)> {
    let fitting = context.session.fitting();
    let count = |state| fitting.levels().iter().filter(|level| level.state == state).count();
    let done = count(LevelState::Done);
    let levels = fitting.levels().len();
    if fitting.is_complete() {
        return None;
    }
    let text = if fitting.fold() != Fold::default() || count(LevelState::Earlier) > 0 {
        format!("preview · {done} of {levels} levels fitted")
    } else if count(LevelState::Unaligned) > 0 {
        format!("preview, not aligned · {done} of {levels} levels fitted")
    } else {
        format!("{done} of {levels} levels fitted")
    };
    Some((text, theme::WARNING))
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

/// The outline of the selected texel's footprint on the surface.
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
    let (position, normal) = (glam::Vec3::from(vertex.position), glam::Vec3::from(vertex.normal));
    let facing = normal.dot(surface.camera.eye_in_world() - position) > 0.0;
    facing.then(|| project(surface, picture, position)).flatten()
}
