//! Bars that say which colour stands for which number.

use egui::{Color32, Painter, Rect, Response, RichText, Sense, Ui, pos2, vec2};

use crate::app::texel_scale::TexelScale;
use crate::app::theme;

/// Height of the bar, points.
const HEIGHT: f32 = 8.0;

/// What the colours beside the scale mean.
const OFF_SCALE: &str = "Teal: none, for no normal is valid or all reflect below the horizon. Grey: not known.";

/// A scale in a row, `width` points for the bar, with the numbers at its ends.
pub fn show(ui: &mut Ui, scale: &TexelScale, width: f32) -> Response {
    let color = theme::of(ui).weak;
    let weak = |text: String| RichText::new(text).small().color(color);
    let row = ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GRID;
        let [low, high] = scale.ends();
        ui.label(weak(low));
        let (rect, _) = ui.allocate_exact_size(vec2(width, HEIGHT), Sense::hover());
        gradient(ui.painter(), rect, |t| scale.color_at(t));
        ui.label(weak(format!("{high}{}", if scale.logarithmic { ", log" } else { "" })));
    });
    row.response.on_hover_text(format!("{}; what lies beyond takes the end's colour.\n{OFF_SCALE}", scale.words()))
}

/// A bar of the colours from 0 to 1, left to right.
pub fn gradient(painter: &Painter, rect: Rect, color: impl Fn(f32) -> [u8; 3]) {
    let mut mesh = egui::Mesh::default();
    for i in 0..=32_u32 {
        let t = i as f32 / 32.0;
        let [r, g, b] = color(t);
        let x = rect.left() + t * rect.width();
        mesh.colored_vertex(pos2(x, rect.top()), Color32::from_rgb(r, g, b));
        mesh.colored_vertex(pos2(x, rect.bottom()), Color32::from_rgb(r, g, b));
        if i > 0 {
            mesh.add_triangle(2 * i - 2, 2 * i - 1, 2 * i);
            mesh.add_triangle(2 * i - 1, 2 * i, 2 * i + 1);
        }
    }
    painter.add(mesh);
}
