//! The lobes of the selected texel in numbers, as Mikkelsen's tables have them, and how well they fit.

use egui::{Color32, Grid, RichText, Sense, Ui, vec2};

use crate::app::texel_report::TexelFit;
use crate::app::theme;
use crate::color::LOBE_COLORS;
use crate::sphere::Lobe;
use crate::sphere::direction::polar_deg;

/// The colour of a slot.
pub fn slot_color(slot: usize) -> Color32 {
    let [r, g, b] = LOBE_COLORS[slot % LOBE_COLORS.len()];
    Color32::from_rgb(r, g, b)
}

/// Shows the table.
pub fn show(ui: &mut Ui, fit: &TexelFit) {
    let columns = [("", ""), ("α", "Weight"), ("θ°", "Angle from +z, degrees"), ("φ°", "Angle from +x towards +y"), (
        "κ",
        "Concentration: the lobe's width is about 57° / sqrt(κ)",
    )];
    Grid::new("lobes").num_columns(columns.len()).spacing([10.0, 3.0]).min_row_height(17.0).show(ui, |ui| {
        for (symbol, meaning) in columns {
            right(ui, RichText::new(symbol).small().color(theme::WEAK)).on_hover_text(meaning);
        }
        ui.end_row();
        for (slot, lobe) in &fit.mixture.lobes {
            row(ui, *slot, lobe);
        }
    });
}

fn row(ui: &mut Ui, slot: usize, lobe: &Lobe) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(10.0, 12.0), Sense::hover());
        ui.painter().circle_filled(rect.center(), 4.5, slot_color(slot));
        ui.label(RichText::new(format!("{}", slot + 1)).small().color(theme::WEAK));
    });
    let (theta, phi) = polar_deg(lobe.mean_direction.as_vec3());
    for text in [
        format!("{:.3}", lobe.weight),
        format!("{theta:.1}"),
        format!("{phi:.1}"),
        kappa_text(lobe.concentration),
    ] {
        right(ui, RichText::new(text).monospace());
    }
    ui.end_row();
}

fn kappa_text(kappa: f64) -> String {
    match kappa {
        k if k >= 1e6 => "delta".to_owned(),
        k if k >= 1000.0 => format!("{k:.0}"),
        k if k >= 10.0 => format!("{k:.1}"),
        k => format!("{k:.2}"),
    }
}

fn right(ui: &mut Ui, text: RichText) -> egui::Response {
    ui.allocate_ui_with_layout(vec2(52.0, 14.0), egui::Layout::right_to_left(egui::Align::Center), |ui| {
        ui.set_min_width(44.0);
        ui.label(text)
    })
    .inner
}
