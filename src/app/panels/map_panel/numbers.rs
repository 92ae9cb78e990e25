//! The values of texels, written into them where they are large enough.

use egui::{Align2, Color32, FontId, Painter, Rect, pos2};

use crate::app::map_picture::MapProjection;
use crate::app::texel_values::TexelValues;
use crate::normal_map::pyramid::Texel;

/// The smallest side of a texel that holds numbers, points.
const LEAST_SIDE: f32 = 44.0;
/// Height of a line, points.
const LINE: f32 = 13.0;

/// Writes the values of the texels of a level that lie in `view`.
pub fn draw(painter: &Painter, values: &TexelValues<'_>, projection: &MapProjection, level: usize, view: Rect) {
    let size = values.session().map().level_size(level);
    let first = projection.texel_rect((0, 0), size);
    if first.width().min(first.height()) < LEAST_SIDE {
        return;
    }
    let in_sight = |from: f32, to: f32, start: f32, side: f32, count: usize| {
        let index = |at: f32| (((at - start) / side).floor().max(0.0) as usize).min(count - 1);
        index(from)..=index(to)
    };
    for y in in_sight(view.top(), view.bottom(), first.top(), first.height(), size.1) {
        for x in in_sight(view.left(), view.right(), first.left(), first.width(), size.0) {
            write(painter, values, Texel { level, x, y }, projection.texel_rect((x, y), size));
        }
    }
}

fn write(painter: &Painter, values: &TexelValues<'_>, texel: Texel, rect: Rect) {
    let lines = values.lines(texel);
    let color = on(values.color(texel));
    let top = rect.center().y - 0.5 * LINE * (lines.len() as f32 - 1.0);
    for (index, line) in lines.iter().enumerate() {
        let at = pos2(rect.center().x, top + LINE * index as f32);
        painter.text(at, Align2::CENTER_CENTER, line, FontId::monospace(11.0), color);
    }
}

/// Black or white, whichever reads better on a colour.
fn on(background: Color32) -> Color32 {
    let [r, g, b, _] = background.to_array().map(f32::from);
    if 0.299 * r + 0.587 * g + 0.114 * b > 128.0 { Color32::BLACK } else { Color32::WHITE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_dark_on_bright_and_bright_on_dark() {
        assert_eq!(on(Color32::from_rgb(252, 255, 164)), Color32::BLACK);
        assert_eq!(on(Color32::from_rgb(85, 15, 109)), Color32::WHITE);
    }
}
