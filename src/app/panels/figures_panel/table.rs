//! The plotted figures as numbers: a row for each method, a column for each value.

use egui::{Grid, RichText, ScrollArea, Ui};

use crate::app::figures_plot::written;
use crate::app::theme;
use crate::measure::{Metric, SweepRun};

/// Height of a row, points.
const ROW: f32 = 15.0;

/// How high the table is.
pub fn height(run: &SweepRun) -> f32 {
    (run.sweep().settings.methods.len() + 2) as f32 * (ROW + 2.0) + 10.0
}

/// Shows the table; it scrolls sideways where there are many values.
pub fn show(ui: &mut Ui, run: &SweepRun, metric: Metric) {
    ScrollArea::horizontal().auto_shrink([false, true]).show(ui, |ui| {
        Grid::new("figures").spacing([10.0, 2.0]).min_row_height(ROW).show(ui, |ui| {
            number(ui, run.sweep().axis.label(), theme::of(ui).weak);
            for &value in &run.sweep().values {
                number(ui, &written(f64::from(value)), theme::of(ui).weak);
            }
            ui.end_row();
            let findings = run.findings();
            for (index, choice) in run.sweep().settings.methods.iter().enumerate() {
                let figure = |point| metric.of(findings.figures(point, index)?);
                row(ui, run, &choice.method.label(), &figure);
            }
            let truth = |point: usize| metric.of_truth(findings.references[point].as_ref()?);
            match metric {
                Metric::ColorError => row(ui, run, "truth's std. error", &truth),
                Metric::TemporalChange => row(ui, run, "truth", &truth),
                Metric::Rmse | Metric::Flip => {}
            }
        });
    });
}

fn row(ui: &mut Ui, run: &SweepRun, name: &str, figure: &dyn Fn(usize) -> Option<f64>) {
    number(ui, name, theme::of(ui).text);
    for point in 0..run.sweep().values.len() {
        let text = figure(point).map_or_else(|| "-".to_owned(), |figure| format!("{figure:.4}"));
        number(ui, &text, theme::of(ui).text);
    }
    ui.end_row();
}

fn number(ui: &mut Ui, text: &str, color: egui::Color32) {
    ui.add(egui::Label::new(RichText::new(text).small().monospace().color(color)).extend());
}
