//! Figures: every chosen method against the truth, along one quantity, measured in the background.

use std::path::PathBuf;

use egui::{Frame, Margin, ProgressBar, RichText, ScrollArea, TextEdit, Ui};

use super::{PanelContext, segmented};
use crate::app::Command;
use crate::app::figures_file::{FileKind, Target};
use crate::app::figures_plot::FiguresPlot;
use crate::app::parameter::checkbox;
use crate::app::theme::{self, Palette};
use crate::app::view_state::FiguresView;
use crate::filter::{Method, Rival};
use crate::measure::{Axis, Metric, Sweep, SweepRun};

mod table;

/// Least height of the plot; the panel scrolls where there is less room.
const LEAST_HEIGHT: f32 = 200.0;

/// Shows the choices, the plot, the values and the ways to save them.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let frame = Frame::new().fill(theme::of(ui).panel).inner_margin(Margin { left: 14, right: 6, top: 10, bottom: 6 });
    frame.show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.set_max_width(ui.available_width() - 8.0);
            choices(ui, context);
            progress(ui, context);
            ui.add_space(theme::GRID);
            figures(ui, context);
        });
    });
}

fn choices(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let view = &mut context.view.figures;
    ui.horizontal(|ui| {
        caption(ui, "Figure");
        segmented(
            ui,
            "Figure",
            &mut view.metric,
            Metric::default(),
            &Metric::ALL.map(|metric| (metric, metric.label())),
        );
    })
    .response
    .on_hover_text(view.metric.explanation());
    ui.horizontal(|ui| {
        caption(ui, "Against");
        segmented(ui, "Against", &mut view.axis, Axis::default(), &Axis::ALL.map(|axis| (axis, axis.label())));
    });
    ui.horizontal_wrapped(|ui| {
        caption(ui, "Methods");
        for method in Method::offered().filter(|&method| is_measured(method)) {
            let mut on = view.methods.contains(&method);
            let name = method.label();
            let default = FiguresView::default().methods.contains(&method);
            let was = on;
            checkbox(ui, &mut on, default, &name, "Whether it is measured.").accessible_name(format!("Measure {name}"));
            if on != was {
                // In the order they are offered, whatever the order of the clicks.
                let chosen = |other: &Method| if *other == method { on } else { view.methods.contains(other) };
                view.methods = Method::offered().filter(chosen).collect();
            }
        }
    });
}

fn is_measured(method: Method) -> bool {
    method != Method::Truth && method.rival().is_none_or(Rival::is_drawn)
}

fn caption(ui: &mut Ui, text: &str) {
    let size = egui::vec2(52.0, theme::ROW);
    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_size(size);
        ui.label(RichText::new(text).color(theme::of(ui).weak));
    });
}

/// The button that starts or cancels, how far it is, and what is to be said of what is shown.
fn progress(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let (axis, temporal) = (context.view.figures.axis, context.view.figures.metric == Metric::TemporalChange);
    let fit = context.session.fit_settings();
    let sweep = Sweep::new(axis, fit, &context.view.figures.methods, temporal);
    let run = context.figures.run(axis);
    ui.horizontal(|ui| {
        if context.figures.is_running() {
            if button(ui, "Cancel", "Cancel figures", true) {
                context.commands.push(Command::CancelFigures);
            }
        } else if button(ui, "Start", "Start figures", sweep.steps() > 0) {
            context.commands.push(Command::MeasureFigures(sweep.clone()));
        }
        let (done, all) = run.map_or((0, sweep.steps()), SweepRun::steps);
        let is_running = run.is_some_and(SweepRun::is_running);
        let color = if is_running { theme::of(ui).selection } else { theme::of(ui).widgets[1] };
        let fraction = done as f32 / all.max(1) as f32;
        let text = RichText::new(format!("{done} of {all}")).small().color(theme::of(ui).strong);
        let bar = ProgressBar::new(fraction).desired_width(110.0).desired_height(theme::ROW).corner_radius(4);
        ui.add(bar.fill(color).text(text)).on_hover_text("How many figures are found");
        let (sentence, color) = sentence(theme::of(ui), context, &sweep);
        ui.add(egui::Label::new(RichText::new(sentence).small().color(color)).truncate());
    });
}

fn button(ui: &mut Ui, text: &str, name: &str, enabled: bool) -> bool {
    let button = egui::Button::new(text).min_size(egui::vec2(56.0, theme::ROW));
    ui.add_enabled(enabled, button).accessible_name(name).clicked()
}

/// What is to be said of what is shown.
fn sentence(palette: &Palette, context: &PanelContext<'_>, sweep: &Sweep) -> (String, egui::Color32) {
    let weak = |text: &str| (text.to_owned(), palette.weak);
    let warning = |text: &str| (text.to_owned(), palette.warning);
    let Some(run) = context.figures.run(sweep.axis) else {
        return match (sweep.values.is_empty(), sweep.settings.methods.is_empty()) {
            (true, _) => warning("Alignment is none: choose one that has a strength."),
            (_, true) => warning("Choose a method at least."),
            _ => weak("Measures on the open map in the background; nothing that is open changes."),
        };
    };
    let settings = &run.sweep().settings;
    if run.is_running() {
        (run.at().to_owned(), palette.accent)
    } else if run.is_stale(context.session) {
        warning("Stale: map, material, light or fit have changed since.")
    } else if !run.is_complete() {
        weak("Cancelled: what was found stays.")
    } else if sweep.settings.dolly_frames > settings.dolly_frames {
        warning("Temporal change was not measured: start again.")
    } else if sweep.settings.methods != settings.methods {
        weak("Other methods are chosen by now: start again.")
    } else {
        (FiguresPlot::new(run, context.view.figures.metric).title().to_owned(), palette.weak)
    }
}

fn figures(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let (axis, metric) = (context.view.figures.axis, context.view.figures.metric);
    let Some(run) = context.figures.run(axis) else { return };
    let plot = FiguresPlot::new(run, metric);
    let below = table::height(run) + 2.0 * theme::ROW + 6.0 * theme::GRID;
    let height = (ui.available_height() - below).max(LEAST_HEIGHT);
    if plot.is_empty() {
        ui.allocate_space(egui::vec2(ui.available_width(), height));
    } else {
        ui.scope(|ui| {
            // What was found of something else is shown, but not as if it held.
            ui.set_opacity(if run.is_stale(context.session) { 0.5 } else { 1.0 });
            plot.show(ui, height);
        });
    }
    table::show(ui, run, metric);
    ui.add_space(theme::GRID);
    save(ui, context);
}

/// A path to be typed, and the system's dialog for each kind of file.
fn save(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        caption(ui, "Save");
        let width = ui.available_width() - 190.0;
        let hint = "Path that ends in .csv, .json or .png";
        let field = TextEdit::singleline(&mut context.view.figures.typed_path).hint_text(hint);
        let response = ui.add_sized([width, theme::ROW], field).accessible_name("Path to save figures to");
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let path = context.view.figures.typed_path.trim();
        let target = (entered && !path.is_empty()).then(|| Target::Path(PathBuf::from(path)));
        let asked = FileKind::ALL.into_iter().find(|kind| {
            let text = format!("{}…", kind.label());
            let name = format!("Save figures as {}", kind.label());
            button(ui, &text, &name, !context.figures.is_saving())
        });
        if let Some(target) = target.or(asked.map(Target::Dialog)) {
            let view = &context.view.figures;
            context.commands.push(Command::SaveFigures(view.axis, view.metric, target));
        }
    });
}
