//! The lobes of the selected texel in numbers, as Mikkelsen's tables have them.

use egui::{Align2, Color32, FontId, Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2};
use glam::Vec3;

use crate::app::texel_report::TexelFit;
use crate::app::theme;
use crate::color::{LOBE_COLORS, srgb8_from_linear};
use crate::sphere::Lobe;
use crate::sphere::direction::polar_deg;

/// Height of a row.
const ROW: f32 = 18.0;

/// Side of a swatch and of the space around it.
const SWATCH: f32 = 13.0;

/// What a swatch means.
const COLOR: &str = "Colour of the normals that the lobe stands for (Han et al. 2007, eq. 22)";

/// Heading and meaning of the columns behind the lobe's number.
const COLUMNS: [(&str, &str); 5] = [
    ("alpha", "Weight, 0 to 1"),
    ("theta", "Angle of the mean direction from +z, degrees"),
    ("phi", "Its angle from +x towards +y, degrees"),
    ("kappa", "Concentration"),
    ("width", "One standard deviation, about 57° / sqrt(kappa)"),
];

/// The colour of a slot.
pub fn slot_color(slot: usize) -> Color32 {
    let [r, g, b] = LOBE_COLORS[slot % LOBE_COLORS.len()];
    Color32::from_rgb(r, g, b)
}

/// Shows the table; with a swatch of each lobe's colour y where there are colours.
pub fn show(ui: &mut Ui, fit: &TexelFit) {
    row(ui, |ui, rect| {
        let (swatch, numbers) = split(rect, fit.colors.is_some());
        if fit.colors.is_some() {
            heading(ui, swatch, swatch.center(), Align2::CENTER_CENTER, ("y", COLOR));
        }
        for (index, column) in COLUMNS.into_iter().enumerate() {
            let cell = cell(numbers, index);
            heading(ui, cell, cell.right_center(), Align2::RIGHT_CENTER, column);
        }
    });
    for (index, (slot, lobe)) in fit.mixture.lobes.iter().enumerate() {
        let color = fit.colors.as_ref().and_then(|colors| colors.get(index));
        row(ui, |ui, rect| lobe_row(ui, rect, *slot, lobe, color));
    }
}

fn heading(ui: &Ui, cell: Rect, at: Pos2, align: Align2, (text, meaning): (&str, &str)) {
    ui.painter().text(at, align, text, FontId::proportional(11.0), theme::of(ui).weak);
    ui.interact(cell, ui.scope_id().with(text), Sense::hover()).on_hover_text(meaning);
}

fn row(ui: &mut Ui, contents: impl FnOnce(&mut Ui, Rect)) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    contents(ui, rect);
    ui.spacing_mut().item_spacing.y = theme::GRID;
}

/// The places of the swatch, empty without colours, and of the numbers: what is left of the row behind the lobe's
/// number.
fn split(row: Rect, colored: bool) -> (Rect, Rect) {
    let rest = row.with_min_x(row.left() + 26.0);
    rest.split_left_right_at_x(rest.left() + if colored { SWATCH + 2.0 } else { 0.0 })
}

/// The place of a column: equal parts.
fn cell(numbers: Rect, index: usize) -> Rect {
    let width = numbers.width() / COLUMNS.len() as f32;
    let left = numbers.left() + index as f32 * width;
    Rect::from_min_max(pos2(left, numbers.top()), pos2(left + width, numbers.bottom()))
}

/// A lobe's colour y, linear RGB; what lies beyond white is shown as white.
fn swatch(ui: &Ui, cell: Rect, slot: usize, color: Vec3) {
    let [r, g, b] = srgb8_from_linear(color);
    let square = Rect::from_center_size(cell.center(), Vec2::splat(SWATCH - 2.0));
    ui.painter().rect(
        square,
        2.0,
        Color32::from_rgb(r, g, b),
        Stroke::new(1.0, theme::of(ui).line),
        StrokeKind::Outside,
    );
    let text = format!("y = {:.3}, {:.3}, {:.3} (linear RGB)", color.x, color.y, color.z);
    let response = ui.interact(cell, ui.scope_id().with(("colour", slot)), Sense::hover());
    let name = format!("Colour of lobe {}", slot + 1);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    response.on_hover_text(text);
}

fn lobe_row(ui: &Ui, rect: Rect, slot: usize, lobe: &Lobe, color: Option<&Vec3>) {
    let (swatch_cell, numbers) = split(rect, color.is_some());
    if let Some(&color) = color {
        swatch(ui, swatch_cell, slot, color);
    }
    let painter = ui.painter();
    painter.circle_filled(rect.left_center() + vec2(6.0, 0.0), 5.0, slot_color(slot));
    let number = rect.left_center() + vec2(17.0, 0.0);
    painter.text(number, Align2::LEFT_CENTER, slot + 1, FontId::proportional(11.0), theme::of(ui).weak);
    let (theta, phi) = polar_deg(lobe.mean_direction.as_vec3());
    let width = lobe.concentration.sqrt().recip().to_degrees().min(180.0);
    let texts = [
        alpha_text(lobe.weight),
        format!("{theta:.1}°"),
        format!("{phi:.1}°"),
        kappa_text(lobe.concentration),
        format!("{width:.1}°"),
    ];
    for (index, text) in texts.into_iter().enumerate() {
        let at = cell(numbers, index).right_center();
        painter.text(at, Align2::RIGHT_CENTER, text, FontId::monospace(11.5), theme::of(ui).text);
    }
}

/// Three decimals; a lobe that they would show as nothing is written by its power of ten.
fn alpha_text(alpha: f64) -> String {
    if alpha < 0.0005 { format!("{alpha:.0e}") } else { format!("{alpha:.3}") }
}

fn kappa_text(kappa: f64) -> String {
    match kappa {
        k if k >= 1e6 => "delta".to_owned(),
        k if k >= 1000.0 => format!("{k:.0}"),
        k if k >= 10.0 => format!("{k:.1}"),
        k => format!("{k:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_lobe_in_use_is_shown_with_a_weight_of_nothing() {
        assert_eq!([1.0, 0.4264, 0.0005, 0.000_499, 3e-7].map(alpha_text), ["1.000", "0.426", "0.001", "5e-4", "3e-7"]);
    }
}
