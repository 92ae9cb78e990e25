//! The lights on a dome over the surface, seen from above with the camera at the bottom: a handle for each, which a
//! click selects and a drag moves.

use egui::{Id, Painter, Pos2, Rect, Sense, Stroke, Ui, Vec2, vec2};

use super::PanelContext;
use crate::app::light_view::LightView;
use crate::app::{Command, theme};
use crate::lighting::Light;
use crate::lit_surface::LitSurface;
use crate::scene::Camera;

/// The dome's radius in points.
const RADIUS: f32 = 22.0;
/// From the dome to the picture's corner.
const MARGIN: f32 = 14.0;
/// How near a click has to be to a handle.
const REACH: f32 = 9.0;
/// How far a drag over the surface moves a light by the dome's radius.
const DRAG: f32 = 220.0;

/// Shows the dome in the lower right corner of the picture.
pub fn show(ui: &Ui, context: &mut PanelContext<'_>, picture: Rect) {
    let center = picture.right_bottom() - Vec2::splat(RADIUS + MARGIN);
    let area = Rect::from_center_size(center, Vec2::splat(2.0 * (RADIUS + REACH)));
    let response = ui.interact(area, Id::unique("light dome"), Sense::click_and_drag());
    let response = response.accessible_name("Light dome");
    let mut surface = context.session.surface.clone();
    let pressed = ui.input(|input| input.pointer.press_origin());
    if let Some(at) = pressed.filter(|_| response.is_pointer_button_down_on())
        && let Some(index) = handle_at(&surface, center, at)
    {
        context.view.light.selected = index;
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        let point = (at - center) / RADIUS;
        move_selected(&mut surface, &context.view.light, vec2(point.x, -point.y));
    }
    paint(&ui.painter_at(picture), &surface, &context.view.light, center);
    response.on_hover_text("The lights, seen from above: click a handle to select its light, drag to move it");
    if surface != context.session.surface {
        context.push(Command::SetSurface(surface));
    }
}

/// Moves the selected light by a drag over the surface.
pub fn drag(surface: &mut LitSurface, view: &LightView, delta: Vec2) {
    let Some(index) = view.index(&surface.lights) else { return };
    let point = dome_point(&surface.lights.as_slice()[index], &surface.camera);
    move_selected(surface, view, point + vec2(delta.x, -delta.y) / DRAG);
}

/// Moves the selected light's point on the dome; it stays above or below the horizon.
fn move_selected(surface: &mut LitSurface, view: &LightView, point: Vec2) {
    let Some(index) = view.index(&surface.lights) else { return };
    let light = &mut surface.lights.as_mut_slice()[index];
    let length = point.length().clamp(1e-4, 0.9999);
    light.elevation_deg = length.acos().to_degrees().copysign(light.elevation_deg);
    let turned = point.y.atan2(point.x).to_degrees() + surface.camera.azimuth_deg;
    light.azimuth_deg = (turned + 180.0).rem_euclid(360.0) - 180.0;
}

/// A light on the dome of radius 1: x right, y away from the camera.
fn dome_point(light: &Light, camera: &Camera) -> Vec2 {
    let radius = light.elevation_deg.to_radians().cos();
    let (sin, cos) = (light.azimuth_deg - camera.azimuth_deg).to_radians().sin_cos();
    radius * vec2(cos, sin)
}

/// The middle of a light's handle.
fn handle(light: &Light, camera: &Camera, center: Pos2) -> Pos2 {
    let point = dome_point(light, camera);
    center + RADIUS * vec2(point.x, -point.y)
}

/// The light whose handle is nearest to a click, if that is near.
fn handle_at(surface: &LitSurface, center: Pos2, at: Pos2) -> Option<usize> {
    let away = |light: &Light| handle(light, &surface.camera, center).distance(at);
    let handles = surface.lights.as_slice().iter().map(away).enumerate();
    handles.filter(|(_, away)| *away < REACH).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

fn paint(painter: &Painter, surface: &LitSurface, view: &LightView, center: Pos2) {
    painter.circle_filled(center, RADIUS, theme::of(painter).badge);
    painter.circle_stroke(center, RADIUS, Stroke::new(1.0, theme::of(painter).weak.gamma_multiply(0.7)));
    painter.circle_stroke(center, 0.5 * RADIUS, Stroke::new(1.0, theme::of(painter).weak.gamma_multiply(0.3)));
    let several = surface.lights.as_slice().len() > 1;
    for (index, light) in surface.lights.as_slice().iter().enumerate() {
        let at = handle(light, &surface.camera, center);
        let color = if light.elevation_deg >= 0.0 { theme::of(painter).warning } else { theme::of(painter).weak };
        // A point light is no direction: it has a ring, and no ray.
        match light.distance {
            Some(_) => painter.circle_stroke(at, 6.0, Stroke::new(1.0, color)),
            None => painter.line_segment([center, at], Stroke::new(1.0, color.gamma_multiply(0.6))),
        };
        painter.circle_filled(at, 4.0, color);
        if several && view.index(&surface.lights) == Some(index) {
            painter.circle_stroke(at, 4.0, Stroke::new(1.5, theme::of(painter).accent));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dragging_the_light_right_moves_it_right_whatever_the_camera() {
        for camera_azimuth in [-120.0, 0.0, 75.0] {
            let mut surface = LitSurface::default();
            surface.camera.azimuth_deg = camera_azimuth;
            let point = |surface: &LitSurface| dome_point(&surface.lights.as_slice()[0], &surface.camera);
            let before = point(&surface);
            drag(&mut surface, &LightView::default(), vec2(30.0, 0.0));
            let moved = point(&surface) - before;
            assert!(moved.x > 0.1 && moved.y.abs() < 1e-3, "{camera_azimuth}: {moved:?}");
        }
    }

    #[test]
    fn the_nearest_handle_in_reach_is_the_one_that_is_clicked() {
        let mut surface = LitSurface::default();
        let near = Light { azimuth_deg: -40.0, ..Light::DEFAULT };
        assert!(surface.lights.push(near));
        let at = handle(&near, &surface.camera, Pos2::ZERO) + vec2(3.0, -2.0);
        assert_eq!(handle_at(&surface, Pos2::ZERO, at), Some(1));
        assert_eq!(handle_at(&surface, Pos2::ZERO, Pos2::new(200.0, 0.0)), None);
    }
}
