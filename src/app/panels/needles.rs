//! Needles on the surface's picture: both normals of a relief, the exact one and Blinn's; and the frames of the mesh.

use egui::{Color32, Painter, Pos2, Rect, Stroke};
use glam::{DVec2, Vec3};

use super::PanelContext;
use super::surface_overlay::project;
use crate::color::LOBE_COLORS;
use crate::normal_map::height;
use crate::scene::bump::{BumpRule, perturbed_normal};
use crate::scene::mesh::Tangents;

/// Points along each side of the surface.
const POINTS: u32 = 12;
/// Frames that are drawn at most.
const MOST_FRAMES: usize = 500;
/// Length of the normals' needles in world space; frames are half as long.
const LENGTH: f32 = 0.15;

/// True where there are heights on a surface whose curvature is known.
pub fn can_show(context: &PanelContext<'_>) -> bool {
    let is_relief = context.session.map().options.height_scale.is_some();
    is_relief && context.session.surface.shape.jet(0.5, 0.5).is_some()
}

/// Draws the needles that are asked for, of what faces the eye.
pub fn show(painter: &Painter, context: &PanelContext<'_>, picture: Rect) {
    if context.view.needles.frames {
        frames(painter, context, picture);
    }
    if context.view.needles.shown && can_show(context) {
        normals(painter, context, picture);
    }
}

/// Tangent, bitangent and normal of some of the mesh's vertices, evenly chosen.
fn frames(painter: &Painter, context: &PanelContext<'_>, picture: Rect) {
    let surface = &context.session.surface;
    let (mesh, uv_from_surface) = (surface.shape.mesh(), surface.shape.uv_from_surface());
    let step = mesh.vertices.len().div_ceil(MOST_FRAMES).max(1);
    for vertex in mesh.vertices.iter().step_by(step) {
        let [foot, normal] = [vertex.position, vertex.normal].map(Vec3::from);
        let faces = normal.dot(surface.camera.eye_in_world() - foot) > 0.0;
        let Some(start) = project(surface, picture, foot).filter(|_| faces) else { continue };
        let Tangents { tangent, bitangent } = vertex.tangents(uv_from_surface);
        for (axis, slot) in [(normal, 4), (bitangent, 2), (tangent, 5)] {
            if let Some(end) = project(surface, picture, foot + 0.5 * LENGTH * axis) {
                needle(painter, [start, end], slot);
            }
        }
    }
}

fn needle(painter: &Painter, ends: [Pos2; 2], slot: usize) {
    let [r, g, b] = LOBE_COLORS[slot];
    painter.line_segment(ends, Stroke::new(1.5, Color32::from_rgb(r, g, b)));
}

/// The exact normal over Blinn's at points of the surface.
fn normals(painter: &Painter, context: &PanelContext<'_>, picture: Rect) {
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
                needle(painter, [start, end], slot);
            }
        }
    }
}
