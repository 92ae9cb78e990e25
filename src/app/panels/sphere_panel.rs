//! The selected texel on the sphere of directions, and in numbers.

use egui::{Align2, FontId, Pos2, Rect, Response, RichText, ScrollArea, Sense, Ui, Vec2, vec2};
use glam::{DVec2, DVec3};

use super::scale_bar::gradient;
use super::{PanelContext, brdf_section, lobe_table, segmented, toggle, trace_plot};
use crate::app::theme;
use crate::app::viewport::SpherePaint;
use crate::color::heat;
use crate::gpu::passes::sphere::{FILL, LOG_DECADES, SphereLayers};
use crate::scene::SphereOrbit;
use crate::sphere::direction::polar_deg;

const BRDF_ERROR: &str = "How far the lobes' effective BRDF m is from the truth t of all normals, over the hemisphere of \
                          half vectors: sqrt(int (m - t)^2 / int t^2)";

/// Shows the panel.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - 6.0);
        heading(ui, context);
        let side = ui.available_width().min(420.0);
        let reading = sphere(ui, context, side);
        layers(ui, context);
        scale_bar(ui, context);
        ui.label(RichText::new(reading).small().monospace().color(theme::of(ui).weak));
        numbers(ui, context);
        brdf_section::show(ui, context);
        trace_plot::show(ui, context);
    });
}

fn heading(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let texel = context.session.selected();
    ui.horizontal(|ui| {
        super::heading(ui, &format!("Texel {}, {} of level {}", texel.x, texel.y, texel.level));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let choices = [(SphereOrbit::default(), "Free"), (SphereOrbit::SIDE, "Side"), (SphereOrbit::TOP, "Top")];
            segmented(ui, "Sphere from", &mut context.view.sphere_orbit, SphereOrbit::default(), &choices);
        });
    });
    let text = match context.report.data() {
        _ if context.report.is_gathering() => "gathering its normals".to_owned(),
        Some(data) if data.normals == 0 => "no valid normal: a flat one stands in".to_owned(),
        Some(data) if data.normals == 1 => "1 normal".to_owned(),
        Some(data) => format!("{} normals · mean length {:.3}", data.normals, data.mean_length),
        None => String::new(),
    };
    ui.label(RichText::new(text).small().color(theme::of(ui).weak));
}

/// The view itself; the reading under the pointer, or a hint.
fn sphere(ui: &mut Ui, context: &mut PanelContext<'_>, side: f32) -> String {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click_and_drag());
    let response = response.accessible_name("Sphere view");
    if response.dragged() {
        let degrees = 180.0 / f64::from(side);
        let delta = response.drag_delta();
        context.view.sphere_orbit.turn(f64::from(delta.x) * degrees, f64::from(-delta.y) * degrees);
    }
    if response.double_clicked() {
        context.view.sphere_orbit = SphereOrbit::default();
    }
    ui.painter().rect_filled(rect, 4.0, theme::of(ui).canvas);
    paint(ui, context, rect);
    axis_labels(ui, context.view.sphere_orbit, rect);
    reading(context, rect, &response).unwrap_or_else(|| "point at the sphere to read a value".to_owned())
}

fn paint(ui: &Ui, context: &PanelContext<'_>, rect: Rect) {
    let Some(data) = context.report.data() else { return };
    let px_per_point = ui.pixels_per_point();
    let size = rect.size() * px_per_point;
    let lobes = context.report.fit().map(|fit| fit.mixture.lobes.clone()).unwrap_or_default();
    let sphere = SpherePaint {
        data: std::sync::Arc::clone(data),
        data_revision: context.report.data_revision(),
        lobes,
        orbit: context.view.sphere_orbit,
        layers: context.view.sphere_layers,
        size_px: [size.x.round(), size.y.round()],
        px_per_point,
        format: context.surroundings.target.format,
    };
    ui.painter().add(sphere.shape(rect));
}

fn radius(rect: Rect) -> f32 {
    0.5 * rect.width().min(rect.height()) * FILL as f32
}

fn in_disc(rect: Rect, position: Pos2) -> DVec2 {
    let offset = (position - rect.center()) / radius(rect);
    DVec2::new(f64::from(offset.x), f64::from(-offset.y))
}

fn axis_labels(ui: &Ui, orbit: SphereOrbit, rect: Rect) {
    for (axis, name) in [(DVec3::X, "+x"), (DVec3::Y, "+y"), (DVec3::Z, "+z")] {
        let (point, facing) = orbit.place(axis);
        // Inside the disc a label would lie on the data; far behind it would mislead.
        if facing < -0.7 || point.length() < 0.6 {
            continue;
        }
        let point = point.normalize() * 1.1;
        let at = rect.center() + radius(rect) * vec2(point.x as f32, -point.y as f32);
        ui.painter().text(at, Align2::CENTER_CENTER, name, FontId::proportional(11.0), theme::of(ui).weak);
    }
}

fn reading(context: &PanelContext<'_>, rect: Rect, response: &Response) -> Option<String> {
    let pointed = in_disc(rect, response.hover_pos()?);
    let direction = context.view.sphere_orbit.direction_under(pointed)?;
    let data = context.report.data()?;
    let (theta, phi) = polar_deg(direction.as_vec3());
    let density = data.picture.density_at(direction);
    let lobes = context.report.fit().map(|fit| format!(" lobes {:.2}", fit.mixture.density(direction)));
    Some(format!("θ {theta:.1}° φ {phi:.1}° data {density:.2}{}", lobes.unwrap_or_default()))
}

fn layers(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = theme::GRID;
        let (layers, default) = (&mut context.view.sphere_layers, SphereLayers::default());
        toggle(ui, &mut layers.density, default.density, "Density", "The normals' smooth density");
        toggle(ui, &mut layers.points, default.points, "Points", "The normals, their area their weight");
        toggle(
            ui,
            &mut layers.lobes,
            default.lobes,
            "Lobes",
            "Rings at one standard deviation; a pin's length reads as the weight",
        );
        toggle(ui, &mut layers.logarithmic, default.logarithmic, "Log", "The density over four decades");
    });
}

/// The scale of the density, per steradian.
fn scale_bar(ui: &mut Ui, context: &PanelContext<'_>) {
    let Some(data) = context.report.data() else { return };
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 8.0), Sense::hover());
    gradient(ui.painter(), rect, heat);
    let peak = f64::from(data.picture.peak);
    let low = if context.view.sphere_layers.logarithmic { peak / 10f64.powf(f64::from(LOG_DECADES)) } else { 0.0 };
    ui.horizontal(|ui| {
        ui.label(RichText::new(short(low)).small().color(theme::of(ui).weak));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(format!("{} per sr", short(peak))).small().color(theme::of(ui).weak));
        });
    });
}

fn short(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 1.0 => format!("{v:.1}"),
        v => format!("{v:.2e}"),
    }
}

fn numbers(ui: &mut Ui, context: &PanelContext<'_>) {
    ui.add_space(theme::GRID);
    let Some(fit) = context.report.fit() else {
        ui.label(RichText::new("This level is not fitted yet.").color(theme::of(ui).weak));
        return;
    };
    lobe_table::show(ui, fit);
    ui.add_space(theme::GRID);
    let log_likelihood = format!("{:.4}", fit.mean_log_likelihood);
    figure(ui, "Mean log-likelihood", &log_likelihood, "Mean of ln(density) over the normals");
    ui.scope(|ui| {
        // What was found of another texel or material stays until the new figure is there, but not as if it held.
        ui.set_opacity(if context.brdf.is_running() { 0.5 } else { 1.0 });
        let name = format!("Effective BRDF error at s = {:.0}", context.session.surface.material.exponent());
        let error = context.brdf.error().map_or("–".to_owned(), |error| format!("{:.2} %", 100.0 * error));
        figure(ui, &name, &error, BRDF_ERROR);
    });
}

/// What a texel's fit comes to, in one number.
fn figure(ui: &mut Ui, name: &str, value: &str, meaning: &str) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(theme::of(ui).weak)).on_hover_text(meaning);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(value).monospace().color(theme::of(ui).strong));
        });
    });
}
