//! The lobes of the selected texel in numbers, as Mikkelsen's tables have them.

use egui::{Align2, Color32, FontId, Rect, Sense, Ui, pos2, vec2};

use crate::app::texel_report::TexelFit;
use crate::app::theme;
use crate::color::LOBE_COLORS;
use crate::sphere::Lobe;
use crate::sphere::direction::polar_deg;

/// Height of a row.
const ROW: f32 = 18.0;

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

/// Shows the table.
pub fn show(ui: &mut Ui, fit: &TexelFit) {
    row(ui, |ui, rect| {
        for (index, (heading, meaning)) in COLUMNS.iter().enumerate() {
            let cell = cell(rect, index);
            ui.painter().text(
                cell.right_center(),
                Align2::RIGHT_CENTER,
                heading,
                FontId::proportional(11.0),
                theme::WEAK,
            );
            ui.interact(cell, ui.scope_id().with(*heading), Sense::hover()).on_hover_text(*meaning);
        }
    });
    for (slot, lobe) in &fit.mixture.lobes {
        row(ui, |ui, rect| lobe_row(ui, rect, *slot, lobe));
    }
}

fn row(ui: &mut Ui, contents: impl FnOnce(&mut Ui, Rect)) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    contents(ui, rect);
    ui.spacing_mut().item_spacing.y = theme::GRID;
}

/// The place of a column: what is left of the row behind the number, in equal parts.
fn cell(row: Rect, index: usize) -> Rect {
    let first = row.left() + 26.0;
    let width = (row.right() - first) / COLUMNS.len() as f32;
    let left = first + index as f32 * width;
    Rect::from_min_max(pos2(left, row.top()), pos2(left + width, row.bottom()))
}

fn lobe_row(ui: &Ui, rect: Rect, slot: usize, lobe: &Lobe) {
    let painter = ui.painter();
    painter.circle_filled(rect.left_center() + vec2(6.0, 0.0), 5.0, slot_color(slot));
    let number = rect.left_center() + vec2(17.0, 0.0);
    painter.text(number, Align2::LEFT_CENTER, slot + 1, FontId::proportional(11.0), theme::WEAK);
    let (theta, phi) = polar_deg(lobe.mean_direction.as_vec3());
    let width = lobe.concentration.sqrt().recip().to_degrees().min(180.0);
    let texts = [
        format!("{:.3}", lobe.weight),
        format!("{theta:.1}°"),
        format!("{phi:.1}°"),
        kappa_text(lobe.concentration),
        format!("{width:.1}°"),
    ];
    for (index, text) in texts.into_iter().enumerate() {
        let at = cell(rect, index).right_center();
        painter.text(at, Align2::RIGHT_CENTER, text, FontId::monospace(11.5), theme::TEXT);
    }
}

fn kappa_text(kappa: f64) -> String {
    match kappa {
        k if k >= 1e6 => "delta".to_owned(),
        k if k >= 1000.0 => format!("{k:.0}"),
        k if k >= 10.0 => format!("{k:.1}"),
        k => format!("{k:.2}"),
    }
}
