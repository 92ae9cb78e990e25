//! The scale of the difference, drawn on the picture: the colours, and the numbers they stand for.

use egui::{Align2, Color32, CornerRadius, FontId, Mesh, Painter, Pos2, Rect, Shape, pos2, vec2};

use crate::app::theme;
use crate::color::{COLOR_STOPS, color_stops};
use crate::comparison::{Difference, DifferenceKind};

const SIZE: egui::Vec2 = egui::vec2(280.0, 50.0);
const MARGIN: f32 = 12.0;

/// Draws the scale with its bottom left corner at `at`.
pub fn show(painter: &Painter, difference: Difference, at: Pos2) {
    let rect = Align2::LEFT_BOTTOM.anchor_size(at, SIZE);
    painter.rect_filled(rect, CornerRadius::same(4), theme::of(painter).badge);
    let caption = match difference.kind {
        DifferenceKind::Absolute => "mean of |right − left|, linear colour",
        DifferenceKind::Signed => "luminance of right − left, linear",
    };
    let small = FontId::proportional(11.0);
    let corner = rect.min + vec2(MARGIN, 4.0);
    painter.text(corner, Align2::LEFT_TOP, caption, small.clone(), theme::of(painter).text);
    let bar = Rect::from_min_size(corner + vec2(0.0, 17.0), vec2(rect.width() - 2.0 * MARGIN, 8.0));
    painter.add(colors(bar, difference.kind));
    for (part, number) in numbers(difference) {
        let x = bar.left() + part * bar.width();
        painter.vline(x, bar.bottom()..=bar.bottom() + 3.0, egui::Stroke::new(1.0, theme::of(painter).weak));
        let align = if part == 0.0 {
            Align2::LEFT_TOP
        } else if part == 1.0 {
            Align2::RIGHT_TOP
        } else {
            Align2::CENTER_TOP
        };
        painter.text(pos2(x, bar.bottom() + 3.0), align, number, small.clone(), theme::of(painter).text);
    }
}

/// The numbers along the scale, each at its part of the length.
fn numbers(difference: Difference) -> [(f32, String); 5] {
    let [low, high] = difference.ends();
    [0.0, 0.25, 0.5, 0.75, 1.0].map(|part: f32| {
        let value = low + part * (high - low);
        // Three significant digits of the range; what lies beyond an end has its colour.
        let decimals = (2.0 - high.log10().floor()).clamp(0.0, 5.0) as usize;
        let number = format!("{value:.decimals$}");
        let number = number.trim_end_matches('0').trim_end_matches('.');
        let number = if number.is_empty() || number == "-" { "0" } else { number };
        let beyond = match (part, difference.kind) {
            (1.0, _) => "≥ ",
            (0.0, DifferenceKind::Signed) => "≤ ",
            _ => "",
        };
        (part, format!("{beyond}{}", number.replace('-', "−")))
    })
}

/// A strip of the scale's stops, blended in between as the picture's are.
fn colors(bar: Rect, kind: DifferenceKind) -> Shape {
    let mut mesh = Mesh::default();
    for (index, stop) in color_stops(|t| kind.color(t)).into_iter().enumerate() {
        let [r, g, b] = [0, 1, 2].map(|channel| (255.0 * stop[channel]).round() as u8);
        let x = bar.left() + index as f32 / (COLOR_STOPS - 1) as f32 * bar.width();
        mesh.colored_vertex(pos2(x, bar.top()), Color32::from_rgb(r, g, b));
        mesh.colored_vertex(pos2(x, bar.bottom()), Color32::from_rgb(r, g, b));
        if index > 0 {
            let corner = 2 * index as u32;
            mesh.add_triangle(corner - 2, corner - 1, corner);
            mesh.add_triangle(corner - 1, corner, corner + 1);
        }
    }
    Shape::mesh(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_numbered_from_end_to_end() {
        let numbers = |kind, range| numbers(Difference { kind, range }).map(|(_, number)| number);
        assert_eq!(numbers(DifferenceKind::Absolute, 0.2), ["0", "0.05", "0.1", "0.15", "≥ 0.2"]);
        assert_eq!(numbers(DifferenceKind::Signed, 0.2), ["≤ −0.2", "−0.1", "0", "0.1", "≥ 0.2"]);
        assert_eq!(numbers(DifferenceKind::Absolute, 10.0), ["0", "2.5", "5", "7.5", "≥ 10"]);
        assert_eq!(numbers(DifferenceKind::Signed, 0.001), ["≤ −0.001", "−0.0005", "0", "0.0005", "≥ 0.001"]);
    }
}
