//! The figures of a sweep as a plot, in the window and in a picture of its own.
//!
//! Curves look as their methods do everywhere. The key stands right of them, in the order in which they end.

use egui::{Align2, Color32, RichText, Ui, vec2};
use egui_plot::{FilledArea, GridMark, HoverPosition, PlotBounds, PlotPoint, PlotUi, Text};

use super::method_style::MethodStyle;
use super::panels::small_plot;
use super::theme::{self, Palette};
use crate::filter::Method;
use crate::measure::{Metric, SweepRun};

/// Room for the key, points.
const KEY_WIDTH: f32 = 148.0;
/// Height of a row of the key, points.
const KEY_ROW: f32 = 17.0;
/// Room left and right of the curves, points.
const MARGIN: f32 = 14.0;
/// Room for what stands left of and below the curves, points.
const AXES: [f32; 2] = [66.0, 40.0];

/// What is plotted, apart from the sweep: a picture may be drawn of it later.
#[derive(Clone, Debug, PartialEq)]
pub struct FiguresPlot {
    title: String,
    labels: [&'static str; 2],
    is_logarithmic: bool,
    values: Vec<f32>,
    curves: Vec<Curve>,
    /// Below which the truth is not sure of itself.
    band: Vec<[f64; 2]>,
}

/// A method's figures, by position along the axis.
#[derive(Clone, Debug, PartialEq)]
struct Curve {
    method: Method,
    name: String,
    points: Vec<[f64; 2]>,
}

impl FiguresPlot {
    /// What a sweep has found so far, by one metric.
    pub fn new(run: &SweepRun, metric: Metric) -> Self {
        let (sweep, fit) = (run.sweep(), &run.base().fit);
        let is_logarithmic = sweep.axis.is_logarithmic(fit);
        let findings = run.findings();
        let along = |figure: &dyn Fn(usize) -> Option<f64>| -> Vec<[f64; 2]> {
            let positions = sweep.values.iter().map(|&value| position(value, is_logarithmic)).enumerate();
            positions.filter_map(|(index, x)| Some([x, figure(index)?])).collect()
        };
        let truth = along(&|point| metric.of_truth(findings.references[point].as_ref()?));
        let mut curves = Vec::new();
        for (index, choice) in sweep.settings.methods.iter().enumerate() {
            let points = along(&|point| metric.of(findings.figures(point, index)?));
            curves.push(Curve { method: choice.method, name: choice.method.label(), points });
        }
        let mut band = Vec::new();
        if metric == Metric::TemporalChange {
            curves.push(Curve { method: Method::Truth, name: Method::Truth.label(), points: truth });
        } else {
            band = truth;
        }
        curves.retain(|curve| !curve.points.is_empty());
        let [width, height] = sweep.settings.size;
        let title = format!(
            "{}, {}, {width} × {height}, truth of {} samples per pixel",
            run.map(),
            sweep.axis.label().to_lowercase(),
            sweep.settings.truth_samples
        );
        let labels = [sweep.axis.axis_label(fit), metric.axis_label()];
        Self { title, labels, is_logarithmic, values: sweep.values.clone(), curves, band }
    }

    /// What it is of, in a line.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// True where there is nothing to see yet.
    pub fn is_empty(&self) -> bool {
        self.curves.is_empty()
    }

    /// Draws the plot, as wide as there is room.
    pub fn show(&self, ui: &mut Ui, height: f32) {
        let room = vec2(ui.available_width() - AXES[0], height - AXES[1]).max(vec2(KEY_WIDTH + 80.0, 40.0));
        let bounds = self.bounds(room);
        let (ticks, is_logarithmic, label) = (self.ticks(), self.is_logarithmic, self.labels[0]);
        small_plot::still("figures", height)
            .x_axis_label(RichText::new(self.labels[0]).small())
            .y_axis_label(RichText::new(self.labels[1]).small())
            .x_grid_spacer(move |_| ticks.clone())
            .x_axis_formatter(move |mark, _| written(value(mark.value, is_logarithmic)))
            .label_formatter(move |hovered| match hovered {
                HoverPosition::NearDataPoint { plot_name, position, .. } if !plot_name.is_empty() => {
                    let at = written(value(position.x, is_logarithmic));
                    Some(format!("{plot_name}\n{label}: {at}\n{:.5}", position.y))
                }
                _ => None,
            })
            .show(ui, |plot| {
                plot.set_plot_bounds(bounds);
                self.draw_band(plot);
                for curve in &self.curves {
                    curve.draw(plot);
                }
                self.draw_key(plot, bounds, room);
            });
    }

    /// The curves with their margins and the key, in positions along the axis and figures.
    fn bounds(&self, room: egui::Vec2) -> PlotBounds {
        let first = self.values.first().map_or(0.0, |&value| position(value, self.is_logarithmic));
        let last = self.values.last().map_or(1.0, |&value| position(value, self.is_logarithmic));
        let per_point = (last - first).max(1e-6) / f64::from(room.x - KEY_WIDTH - 2.0 * MARGIN);
        let figures = self.curves.iter().flat_map(|curve| &curve.points).chain(&self.band).map(|point| point[1]);
        let most = figures.fold(0.0, f64::max);
        let top = if most > 0.0 { 1.08 * most } else { 1.0 };
        let margin = per_point * f64::from(MARGIN);
        PlotBounds::from_min_max([first - margin, 0.0], [last + margin + per_point * f64::from(KEY_WIDTH), top])
    }

    fn ticks(&self) -> Vec<GridMark> {
        let at: Vec<f64> = self.values.iter().map(|&value| position(value, self.is_logarithmic)).collect();
        let step_size = at.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        at.into_iter().map(|value| GridMark { value, step_size }).collect()
    }

    fn draw_band<'a>(&self, plot: &mut PlotUi<'a>) {
        let [x, y] = [0, 1].map(|index| self.band.iter().map(|point| point[index]).collect::<Vec<f64>>());
        if x.len() > 1 {
            let area = FilledArea::new("standard error of the truth", &x, &vec![0.0; x.len()], &y);
            plot.add(area.fill_color(band_color(plot)).allow_hover(false));
        }
    }

    /// A row for each curve, the one that ends highest first, then one for the band.
    fn draw_key<'a>(&'a self, plot: &mut PlotUi<'a>, bounds: PlotBounds, room: egui::Vec2) {
        let palette = theme::of(plot.ctx());
        let per_point = [bounds.width() / f64::from(room.x), bounds.height() / f64::from(room.y)];
        let left = bounds.max()[0] - per_point[0] * f64::from(KEY_WIDTH);
        let x = |points: f32| left + per_point[0] * f64::from(points);
        let y = |row: usize| bounds.max()[1] - per_point[1] * f64::from(KEY_ROW * (row as f32 + 0.8));
        let mut curves: Vec<&Curve> = self.curves.iter().collect();
        curves.sort_by(|a, b| b.last().total_cmp(&a.last()));
        for (row, curve) in curves.iter().enumerate() {
            let sample = |points: [f32; 2]| points.map(|point| [x(point), y(row)]).to_vec();
            let style = MethodStyle::of(curve.method, palette);
            plot.line(style.line("", sample([0.0, 30.0])).allow_hover(false));
            plot.points(style.points("", vec![[x(15.0), y(row)]]).allow_hover(false));
            plot.text(key_text(palette, PlotPoint::new(x(36.0), y(row)), &curve.name));
        }
        if !self.band.is_empty() {
            let row = curves.len();
            let [top, bottom] = [y(row) + 5.0 * per_point[1], y(row) - 5.0 * per_point[1]];
            let area = FilledArea::new("", &[x(0.0), x(30.0)], &[bottom; 2], &[top; 2]);
            plot.add(area.fill_color(band_color(plot)).allow_hover(false));
            plot.text(key_text(palette, PlotPoint::new(x(36.0), y(row)), "truth's std. error"));
        }
    }
}

/// The band lies behind the curves.
fn band_color(plot: &PlotUi<'_>) -> Color32 {
    theme::of(plot.ctx()).text.gamma_multiply(0.16)
}

fn key_text(palette: &Palette, at: PlotPoint, text: &str) -> Text {
    let text = RichText::new(text).size(11.5).color(palette.text);
    Text::new("", at, text).anchor(Align2::LEFT_CENTER).allow_hover(false)
}

impl Curve {
    fn last(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point[1])
    }

    fn draw<'a>(&'a self, plot: &mut PlotUi<'a>) {
        let style = MethodStyle::of(self.method, theme::of(plot.ctx()));
        plot.line(style.line(&self.name, self.points.clone()));
        plot.points(style.points(&self.name, self.points.clone()));
    }
}

/// Where a value stands along the axis.
fn position(value: f32, is_logarithmic: bool) -> f64 {
    if is_logarithmic { f64::from(value).log10() } else { f64::from(value) }
}

/// The value at a position.
fn value(position: f64, is_logarithmic: bool) -> f64 {
    if is_logarithmic { 10.0_f64.powf(position) } else { position }
}

/// A value in as few digits as tell it from its neighbours.
pub fn written(value: f64) -> String {
    ((value * 1000.0).round() / 1000.0).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_written_as_it_was_given() {
        for given in [0.03_f32, 1.5, 10.0, 24.0, 1024.0] {
            assert_eq!(written(value(position(given, true), true)), given.to_string());
            assert_eq!(written(value(position(given, false), false)), given.to_string());
        }
    }
}
