//! Both normals of a bump-mapped surface as needles on its picture: the exact one and Blinn's.

use egui::{Color32, Painter, Rect, Stroke};
use glam::{DVec2, Vec3};

use super::PanelContext;
use super::surface_overlay::project;
use crate::color::LOBE_COLORS;
use crate::normal_map::height;
use crate::scene::bump::{BumpRule, perturbed_normal};

/// Points along each side of the surface.
const POINTS: u32 = 12;
/// Length of the needles in world space.
const LENGTH: f32 = 0.15;

/// True where there are heights on a surface whose curvature is known.
pub fn can_show(context: &PanelContext<'_>) -> bool {
    let is_relief = context.session.map().options.height_scale.is_some();
    is_relief && context.session.surface.shape.jet(0.5, 0.5).is_some()
}

/// Draws the needles of the points that face the eye, the exact normal over Blinn's.
pub fn show(painter: &Painter, context: &PanelContext<'_>, picture: Rect) {
    if !(context.view.needles.shown && can_show(context)) {
        return;
    }
    let (surface, map) = (&context.session.surface, context.session.map());
    let change = surface.shape.texture_from_surface();
    let place = |index: u32| (f64::from(index) + 0.5) / f64::from(POINTS);
    for (u, v) in (0..POINTS).flat_map(|i| (0..POINTS).map(move |j| (place(i), place(j)))) {
        let Some(jet) = surface.shape.jet(u, 1.0 - v) else { continue };
        let foot = (surface.shape.scale() * jet.position).as_vec3();
        let faces = jet.normal().as_vec3().dot(surface.camera.eye_in_world() - foot) > 0.0;
        let Some(start) = project(surface, picture, foot).filter(|_| faces) else { continue };
        let texture = change * DVec2::new(u, -v);
        let uv = DVec2::new(texture.x, -texture.y);
        let sample = height::sample(&map.stored, uv, map.options.addressing, map.options.slopes);
        let sample = sample.scaled(context.view.needles.scale.into());
        for (rule, slot) in [(BumpRule::Blinn, 1), (BumpRule::Exact, 0)] {
            let normal: Vec3 = perturbed_normal(&jet, change, sample, rule).as_vec3();
            if let Some(end) = project(surface, picture, foot + LENGTH * normal) {
                let [r, g, b] = LOBE_COLORS[slot];
                painter.line_segment([start, end], Stroke::new(1.5, Color32::from_rgb(r, g, b)));
            }
        }
    }
}
