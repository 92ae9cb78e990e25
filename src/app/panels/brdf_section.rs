//! The effective BRDF of the selected texel over the half vectors: as pictures, as a slice, in numbers.

use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Color32, FontId, Grid, Layout, Pos2, Rect, RichText, Sense, Ui, Vec2, pos2, vec2};
use egui_plot::{GridMark, HoverPosition};

use super::scale_bar::gradient;
use super::{PanelContext, judged_method, small_plot, toggle};
use crate::app::brdf_report::BrdfShape;
use crate::app::method_style::MethodStyle;
use crate::app::texel_scale::significant;
use crate::app::theme::{self, Palette};
use crate::color::heat;
use crate::filter::Method;
use crate::filter::brdf_shape::Disc;
use crate::sphere::direction::polar_deg;

/// Height of the slice's plot, points.
const PLOT_HEIGHT: f32 = 150.0;

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

/// Headings and meanings of the table behind the method's name.
const COLUMNS: [(&str, &str); 4] = [
    ("theta", "Angle of the peak from +z, degrees"),
    ("phi", "Its angle from +x towards +y, degrees"),
    ("height", "The value at the peak, per steradian"),
    ("error", "Relative L2 error against the truth over the hemisphere of half vectors"),
];

/// Shows a switch, and what it opens.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let tooltip =
        "The texel's BRDF as a function of the half vector: the truth of all its normals and what methods make of it.";
    toggle(ui, &mut context.view.show_brdf, false, "Effective BRDF", tooltip);
    if !context.view.show_brdf {
        return;
    }
    ui.horizontal(|ui| {
        ui.label(RichText::new("Truth beside").small().color(theme::of(ui).weak));
        judged_method::show(ui, context, "Effective BRDF of");
    });
    ui.scope(|ui| {
        // What was found of something else stays until the new figures are there, but not as if it held.
        ui.set_opacity(if context.brdf.is_running() { 0.5 } else { 1.0 });
        discs(ui, context);
        let shapes = context.brdf.shapes();
        if shapes.is_empty() {
            ui.label(RichText::new("working it out…").small().color(theme::of(ui).weak));
        } else {
            slice(ui, shapes);
            table(ui, shapes);
        }
    });
}

/// The pictures beside each other on one scale.
fn discs(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let Some(discs) = context.brdf.discs().cloned() else { return };
    let textures = context.discs.get(ui.ctx(), &discs);
    let side = ((ui.available_width() - theme::GRID) / 2.0).floor();
    let names = ["Truth".to_owned(), discs.method.label()];
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GRID;
        for ((texture, disc), name) in textures.into_iter().zip(&discs.discs).zip(&names) {
            ui.vertical(|ui| {
                ui.label(RichText::new(name).small().color(theme::of(ui).weak));
                let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
                ui.painter().image(texture, rect, WHOLE, Color32::WHITE);
                ui.painter().circle_stroke(rect.center(), 0.5 * side, egui::Stroke::new(1.0, theme::of(ui).line));
                let value = response.hover_pos().and_then(|at| value_at(disc, rect, at));
                response.accessible_name(format!("Hemisphere of {name}"));
                if let Some(text) = value {
                    *context.hover = Some(format!("{name}  {text}"));
                }
            });
        }
    });
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 8.0), Sense::hover());
    gradient(ui.painter(), rect, heat);
    ui.horizontal(|ui| {
        ui.label(RichText::new("0").small().color(theme::of(ui).weak));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let highest = format!("{} per sr, linear", significant(f64::from(discs.highest)));
            ui.label(RichText::new(highest).small().color(theme::of(ui).weak));
        });
    });
}

/// The value under a point of a picture.
fn value_at(disc: &Disc, rect: Rect, at: Pos2) -> Option<String> {
    let index = |offset: f32, length: f32| ((offset / length * disc.side as f32) as usize).min(disc.side - 1);
    let (x, y) = (index(at.x - rect.left(), rect.width()), index(at.y - rect.top(), rect.height()));
    let (theta, phi) = polar_deg(Disc::direction(disc.side, x, y)?.as_vec3());
    let value = significant(f64::from(disc.values[y * disc.side + x]));
    Some(format!("θ {theta:.1}° φ {phi:.1}°  {value} per sr"))
}

/// Truth and methods over one another, along the half circle through the truth's peak.
fn slice(ui: &mut Ui, shapes: &[BrdfShape]) {
    let azimuth = shapes.first().map_or(0.0, |truth| polar_deg(truth.peak.direction.as_vec3()).1);
    let x_axis = small_plot::x_axis(&format!("angle from +z towards phi {azimuth:.0}°, degrees"));
    small_plot::new("brdf slice", PLOT_HEIGHT, x_axis, small_plot::y_axis("per sr"))
        .include_y(0.0)
        .x_grid_spacer(|_| [-90.0, -45.0, 0.0, 45.0, 90.0].map(|value| GridMark { value, step_size: 45.0 }).into())
        .label_formatter(|hovered| match hovered {
            HoverPosition::NearDataPoint { plot_name, position, .. } if !plot_name.is_empty() => {
                Some(format!("{plot_name}\n{:.1}°: {} per sr", position.x, significant(position.y)))
            }
            _ => None,
        })
        .show(ui, |plot| {
            plot.set_plot_bounds_x(-90.0..=90.0);
            for shape in shapes.iter().rev() {
                let style = MethodStyle::of(shape.method, theme::of(plot.ctx()));
                plot.line(style.line(&shape.method.label(), shape.slice.clone()));
            }
        });
}

/// The peaks and errors in numbers.
fn table(ui: &mut Ui, shapes: &[BrdfShape]) {
    ui.spacing_mut().interact_size.y = theme::GRID;
    let right =
        |ui: &mut Ui, text: RichText| ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(text)).inner;
    let number = |ui: &mut Ui, text: String| drop(right(ui, RichText::new(text).size(11.5).monospace()));
    let column = (ui.available_width() / 6.0).floor();
    Grid::new("brdf peaks").num_columns(1 + COLUMNS.len()).min_col_width(column).spacing([0.0, 3.0]).show(ui, |ui| {
        ui.label(RichText::new("peak of").small().color(theme::of(ui).weak));
        for (name, meaning) in COLUMNS {
            right(ui, RichText::new(name).small().color(theme::of(ui).weak)).on_hover_text(meaning);
        }
        ui.end_row();
        for BrdfShape { method, peak, error, .. } in shapes {
            ui.label(name(theme::of(ui), *method));
            let (theta, phi) = polar_deg(peak.direction.as_vec3());
            number(ui, format!("{theta:.1}°"));
            number(ui, format!("{phi:.1}°"));
            number(ui, significant(peak.height));
            number(ui, error.map_or("–".to_owned(), |error| format!("{:.2} %", 100.0 * error)));
            ui.end_row();
        }
    });
}

/// A method's name behind a mark of its curve's colour.
fn name(palette: &Palette, method: Method) -> LayoutJob {
    let mut job = LayoutJob::default();
    let font = FontId::proportional(11.5);
    let mark = TextFormat::simple(FontId::proportional(18.0), MethodStyle::of(method, palette).color);
    job.append("•", 0.0, TextFormat { valign: Align::Center, ..mark });
    job.append(&method.label(), theme::GRID, TextFormat::simple(font, palette.text));
    job
}
