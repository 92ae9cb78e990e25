//! The trace of the selected texel's fit: log-likelihood over iterations, and what became of its lobes.

use egui::{RichText, Ui};
use egui_plot::{Line, PlotPoints};

use super::{PanelContext, small_plot, toggle};
use crate::app::theme;
use crate::color::LOBE_COLORS;
use crate::filter::vmf::trace::Trace;

const HEIGHT: f32 = 110.0;

/// Shows a switch, and the trace where it is on.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let tooltip =
        "The log-likelihood of each iteration; lobes retired and capped. The texel is fitted again to see it.";
    toggle(ui, &mut context.view.show_trace, false, "Trace of the fit", tooltip);
    if !context.view.show_trace {
        return;
    }
    match context.trace.trace() {
        Some(trace) => plot(ui, trace),
        None if context.trace.is_running() => weak(ui, "Fitting the texel again…"),
        None => weak(ui, "Only a texel of a fitted level above the base has a trace."),
    }
}

fn plot(ui: &mut Ui, trace: &Trace) {
    let Trace { iterations, retired, capped, .. } = trace;
    weak(ui, &format!("iterations {iterations} · empty slots {retired} · capped lobes {capped}"));
    let axes = (small_plot::x_axis("iteration"), small_plot::y_axis("mean ln density"));
    small_plot::new("trace", HEIGHT, axes.0, axes.1).show(ui, |plot| {
        let mut first = 0;
        for (run, color) in trace.runs.iter().zip(LOBE_COLORS.iter().cycle()) {
            let values = run.log_likelihood.iter().enumerate();
            let points: PlotPoints<'_> = values.map(|(i, &value)| [(first + i) as f64, value]).collect();
            let [r, g, b] = *color;
            plot.line(Line::new(run.name, points).color(egui::Color32::from_rgb(r, g, b)).width(1.5));
            first += run.log_likelihood.len().saturating_sub(1);
        }
    });
}

fn weak(ui: &mut Ui, text: &str) {
    ui.label(RichText::new(text).small().color(theme::of(ui).weak));
}
