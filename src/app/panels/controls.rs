//! The controls on the left: map, fit, material, light, surface.

use std::path::PathBuf;

use egui::{ProgressBar, RichText, ScrollArea, TextEdit, Ui};
use glam::Vec3;

use super::{PanelContext, heading, rule};
use crate::app::parameter::{Parameter, about_choice, checkbox, choice, label};
use crate::app::{Command, about, theme};
use crate::filter::LevelChoice;
use crate::filter::vmf::{Alignment, EStep, FitSettings, Objective, Selection};
use crate::lit_surface::LitSurface;
use crate::normal_map::{Addressing, GreenChannel, MapSource, SlopeKernel};
use crate::sphere::vmf::KappaRule;

mod doctor;
mod level_figures;
mod light;
mod material;
mod parameters;
mod shape;
mod sky;
use parameters as p;

/// Width of a button that opens a file, no less than its words take: a row that is wider than the panel widens it.
const OPEN_WIDTH: f32 = 64.0;

/// Shows all groups, scrolling where the window is low.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        ui.set_max_width(ui.available_width() - 6.0);
        doctor::title(ui, context);
        map(ui, context);
        rule(ui);
        heading(ui, "Fit");
        fit(ui, context);
        let mut surface = context.session.surface.clone();
        rule(ui);
        material::show(ui, &mut surface.material, context);
        rule(ui);
        light::show(ui, &mut surface.lights, &mut context.view.light);
        rule(ui);
        sky::show(ui, context, &mut surface.sky);
        rule(ui);
        heading(ui, "Surface");
        shape::show(ui, context, &mut surface.shape);
        seeing(ui, &mut surface, context.session.map().level_sizes().len());
        truth_samples(ui, context);
        ui.add_space(2.0 * theme::GRID);
        if surface != context.session.surface {
            context.push(Command::SetSurface(surface));
        }
    });
}

fn map(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - OPEN_WIDTH - ui.spacing().item_spacing.x;
        let field = TextEdit::singleline(&mut context.view.typed_path).hint_text("Path of an image, or drop one");
        let response = ui.add_sized([width, theme::ROW], field).accessible_name("Path of an image");
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if entered && !context.view.typed_path.trim().is_empty() {
            context.push(Command::OpenPath(PathBuf::from(context.view.typed_path.trim())));
        }
        if ui.add_sized([OPEN_WIDTH, theme::ROW], egui::Button::new("Open…")).clicked() {
            context.push(Command::OpenDialog);
        }
    });
    if context.session.is_opening() {
        ui.label(RichText::new("Reading a map").small().color(theme::of(ui).accent));
    }
    reading(ui, context);
    doctor::findings(ui, context);
    for warning in context.session.map().warnings.iter().filter(|warning| !warning.is_found_by_the_doctor()) {
        let text = RichText::new(format!("{warning}.")).small().color(theme::of(ui).warning);
        ui.add(egui::Label::new(text).wrap());
    }
}

/// How the file is read.
fn reading(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let map = context.session.map();
    let mut options = map.options.clone();
    ui.add_enabled_ui(matches!(map.source, MapSource::File(_)), |ui| {
        let greens = [(GreenChannel::Up, "+Y up (OpenGL)"), (GreenChannel::Down, "+Y down (DirectX)")];
        if let Some(green) = choice(ui, "Green channel", p::GREEN, options.green, &greens) {
            options.green = green;
        }
        ui.horizontal(|ui| {
            label(ui, "Read as");
            checkbox(ui, &mut options.two_channel, false, "two-channel", p::TWO_CHANNEL);
            let mut is_height = options.height_scale.is_some();
            checkbox(ui, &mut is_height, false, "heights", p::HEIGHTS);
            if is_height != options.height_scale.is_some() {
                options.height_scale = is_height.then_some(p::HEIGHT_SCALE.default as f32);
            }
        });
        if map.stored.has_alpha {
            let uses = [(false, "not used"), (true, "x (DXT5nm)")];
            if let Some(x_in_alpha) = choice(ui, "Alpha", p::X_IN_ALPHA, options.x_in_alpha, &uses) {
                options.x_in_alpha = x_in_alpha;
            }
        }
        if let Some(scale) = &mut options.height_scale {
            p::HEIGHT_SCALE.show_f32(ui, scale);
            let kernels = [(SlopeKernel::Central, "central differences"), (SlopeKernel::Sobel, "Sobel")];
            if let Some(kernel) = choice(ui, "Slopes", p::SLOPES, options.slopes, &kernels) {
                options.slopes = kernel;
            }
        }
    });
    let edges = [(Addressing::Wrap, "wrap (the map tiles)"), (Addressing::Clamp, "clamp")];
    if let Some(addressing) = choice(ui, "Edges", p::EDGES, options.addressing, &edges) {
        options.addressing = addressing;
    }
    if options != map.options {
        context.push(Command::Reopen(options));
    }
}

fn fit(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let mut settings = *context.session.fit_settings();
    selection(ui, &mut settings);
    objective(ui, &mut settings);
    alignment(ui, &mut settings);
    p::ITERATIONS.show_count(ui, &mut settings.iterations);
    let rules = [(KappaRule::Exact, "exact"), (KappaRule::Banerjee, "Banerjee (closed form)")];
    if let Some(rule) =
        about_choice(ui, "Kappa from r", p::KAPPA, (settings.kappa, about::kappa(settings.kappa)), &rules)
    {
        settings.kappa = rule;
    }
    if settings.objective == Objective::Em || settings.align.pull().is_some() {
        let steps = [(EStep::WithAlpha, "with alpha"), (EStep::AsPrinted, "as printed")];
        if let Some(step) =
            about_choice(ui, "E-step", p::E_STEP, (settings.e_step, about::e_step(settings.e_step)), &steps)
        {
            settings.e_step = step;
        }
    }
    if settings != *context.session.fit_settings() {
        context.push(Command::SetFit(settings));
    }
    progress(ui, context);
    level_figures::show(ui, context.session);
}

/// How many lobes a texel gets.
fn selection(ui: &mut Ui, settings: &mut FitSettings) {
    #[derive(Clone, Copy, PartialEq)]
    enum Kind {
        Fixed,
        BrdfError,
        Bic,
    }
    let kind = match settings.selection {
        Selection::Fixed => Kind::Fixed,
        Selection::BrdfError { .. } => Kind::BrdfError,
        Selection::Bic => Kind::Bic,
    };
    let kinds = [(Kind::Fixed, "J in every texel"), (Kind::BrdfError, "auto: BRDF error"), (Kind::Bic, "auto: BIC")];
    if let Some(kind) =
        about_choice(ui, "Lobe count", p::SELECTION, (kind, about::selection(settings.selection)), &kinds)
    {
        settings.selection = match kind {
            Kind::Fixed => Selection::Fixed,
            Kind::BrdfError => Selection::AUTO,
            Kind::Bic => Selection::Bic,
        };
        settings.lobes = settings.selection.default_most();
    }
    let lobes = if kind == Kind::Fixed { p::LOBES } else { p::MOST_LOBES };
    lobes.show_count(ui, &mut settings.lobes);
    if let Selection::BrdfError { percent } = &mut settings.selection {
        p::BRDF_ERROR.show_f32(ui, percent);
    }
}

/// What each texel's own fit strives for.
fn objective(ui: &mut Ui, settings: &mut FitSettings) {
    #[derive(Clone, Copy, PartialEq)]
    enum Kind {
        Appearance,
        Em,
        Likelihood,
    }
    let kind = match settings.objective {
        Objective::Appearance { .. } => Kind::Appearance,
        Objective::Em => Kind::Em,
        Objective::Likelihood => Kind::Likelihood,
    };
    let kinds = [(Kind::Appearance, "appearance"), (Kind::Em, "EM (Algorithm 1)"), (Kind::Likelihood, "likelihood")];
    if let Some(kind) =
        about_choice(ui, "Objective", p::OBJECTIVE, (kind, about::objective(settings.objective)), &kinds)
    {
        settings.objective = match kind {
            Kind::Appearance => Objective::APPEARANCE,
            Kind::Em => Objective::Em,
            Kind::Likelihood => Objective::Likelihood,
        };
    }
    if let Objective::Appearance { steps } = &mut settings.objective {
        let mut count = usize::from(*steps);
        if p::STEPS.show_count(ui, &mut count) {
            *steps = count as u8;
        }
    }
}

fn alignment(ui: &mut Ui, settings: &mut FitSettings) {
    #[derive(Clone, Copy, PartialEq)]
    enum Kind {
        None,
        Smooth,
        Paper,
        Map,
    }
    let kind = match settings.align {
        Alignment::None => Kind::None,
        Alignment::Smooth { .. } => Kind::Smooth,
        Alignment::Paper { .. } => Kind::Paper,
        Alignment::Map { .. } => Kind::Map,
    };
    let kinds = [
        (Kind::Smooth, "smooth"),
        (Kind::Paper, "paper (eq. 23)"),
        (Kind::Map, "map (exact prior)"),
        (Kind::None, "none"),
    ];
    if let Some(kind) = about_choice(ui, "Alignment", p::ALIGNMENT, (kind, about::alignment(settings.align)), &kinds) {
        settings.align = match kind {
            Kind::None => Alignment::None,
            Kind::Smooth => Alignment::default(),
            Kind::Paper => Alignment::Paper { c: p::STRENGTH.default as f32 },
            Kind::Map => Alignment::Map { c: p::STRENGTH.default as f32 },
        };
    }
    match &mut settings.align {
        Alignment::None => {}
        Alignment::Smooth { blend } => drop(p::BLEND.show_f32(ui, blend)),
        Alignment::Paper { c } | Alignment::Map { c } => drop(p::STRENGTH.show_f32(ui, c)),
    }
}

fn progress(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let fitting = context.session.fitting();
    ui.horizontal(|ui| {
        let width = ui.available_width() - 62.0;
        let (fraction, text) = match fitting.progress() {
            Some(progress) => (progress.fraction, format!("{:.0} %", 100.0 * progress.fraction)),
            None if fitting.is_complete() => (1.0, "fitted".to_owned()),
            None => (0.0, "stopped".to_owned()),
        };
        let palette = theme::of(ui);
        let color = if fitting.is_running() { palette.selection } else { palette.widgets[1] };
        let text = RichText::new(text).small().color(theme::of(ui).strong);
        let bar = ProgressBar::new(fraction).desired_width(width).desired_height(theme::ROW).corner_radius(4);
        ui.add(bar.fill(color).text(text)).on_hover_text("How far the fit is, all levels together");
        let (name, command) =
            if fitting.is_running() { ("Cancel", Command::CancelFit) } else { ("Refit", Command::Refit) };
        if ui.add_sized([56.0, theme::ROW], egui::Button::new(name)).accessible_name(format!("{name} fit")).clicked() {
            context.push(command);
        }
    });
}

/// A colour to be chosen; a double click brings the default back.
fn color(ui: &mut Ui, name: &str, value: &mut Vec3, default: Vec3) {
    let mut rgb = value.to_array();
    let tooltip = format!("{name}. Double click resets.");
    let response = ui.color_edit_button_rgb(&mut rgb).accessible_name(name).on_hover_text(tooltip);
    if response.double_clicked() {
        *value = default;
        egui::Popup::close_all(ui.ctx());
    } else if response.changed() {
        *value = rgb.into();
    }
}

/// What is seen of the surface: levels, probes, exposure.
fn seeing(ui: &mut Ui, surface: &mut LitSurface, levels: usize) {
    level(ui, &mut surface.level, levels);
    let mut probes = surface.anisotropy as usize;
    if !matches!(surface.level, LevelChoice::Fixed(_)) && p::ANISOTROPY.show_count(ui, &mut probes) {
        surface.anisotropy = probes as u32;
    }
    p::EXPOSURE.show_f32(ui, &mut surface.exposure_stops);
}

fn truth_samples(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let mut samples = context.session.truth_samples as usize;
    if p::TRUTH_SAMPLES.show_count(ui, &mut samples) {
        context.push(Command::SetTruthSamples(samples as u32));
    }
}

/// Which level is read: by the pixel's size, or one everywhere.
fn level(ui: &mut Ui, level: &mut LevelChoice, levels: usize) {
    let fixed = if let LevelChoice::Fixed(_) = level { *level } else { LevelChoice::Fixed(0.0) };
    let choices = [(LevelChoice::Auto, "matched"), (LevelChoice::Hardware, "hardware"), (fixed, "fixed")];
    if let Some(chosen) = choice(ui, "Level", p::level(*level), *level, &choices) {
        *level = chosen;
    }
    if let LevelChoice::Fixed(value) = level {
        let parameter = Parameter { range: [0.0, (levels - 1).max(1) as f64], ..p::FIXED_LEVEL };
        parameter.show_f32(ui, value);
    }
}
