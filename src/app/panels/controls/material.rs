//! The material: its model, that model's own parameter, strengths and colours, and how lobes are convolved with it.

use std::path::{Path, PathBuf};

use egui::{Align, Layout, RichText, TextEdit, Ui};

use super::{OPEN_WIDTH, PanelContext, color, parameters as p};
use crate::app::drying_view::DryingView;
use crate::app::panels::{heading, toggle};
use crate::app::parameter::{Parameter, choice_row, explained_choice, label};
use crate::app::{Command, about, theme};
use crate::brdf::{ConvolutionRule, DiffuseRule, Material, Model};

pub(super) fn show(ui: &mut Ui, material: &mut Material, context: &mut PanelContext<'_>) {
    let view = &mut context.view.drying;
    ui.horizontal(|ui| {
        heading(ui, "Material");
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            toggle(
                ui,
                &mut view.is_shown,
                false,
                "Drying",
                "A track from wet to dry, along which the material changes",
            );
        });
    });
    if view.is_shown {
        drying(ui, material, view);
    }
    let models = Model::ALL.map(|model| (model, model.kind().label, model.kind().tooltip));
    if let Some(model) = explained_choice(ui, "Model", p::MODEL, material.model, &models) {
        material.model = model;
    }
    if let Some(parameter) = &material.model.kind().parameter {
        Parameter::from(parameter).show_f32(ui, (parameter.field)(material));
    }
    if material.model == Model::Measured {
        measured(ui, material, context);
    }
    p::SPECULAR.show_f32(ui, &mut material.specular);
    p::DIFFUSE.show_f32(ui, &mut material.diffuse);
    p::FRESNEL.show_f32(ui, &mut material.fresnel);
    ui.horizontal(|ui| {
        label(ui, "Colours");
        ui.spacing_mut().interact_size.x = 28.0;
        color(ui, "Specular colour", &mut material.specular_color, Material::DEFAULT.specular_color);
        ui.label(RichText::new("specular").small().color(theme::of(ui).weak));
        color(ui, "Diffuse colour", &mut material.diffuse_color, Material::DEFAULT.diffuse_color);
        ui.label(RichText::new("diffuse").small().color(theme::of(ui).weak));
    });
    rules(ui, material);
}

/// The time on the track, its play, and what its ends are.
fn drying(ui: &mut Ui, material: &mut Material, view: &mut DryingView) {
    if p::DRYING_TIME.show_f32(ui, &mut view.time) {
        material.set_moment(view.track.at(view.time));
    }
    ui.horizontal(|ui| {
        label(ui, "Track");
        let play = if view.is_playing { "Stop" } else { "Play" };
        if ui.button(play).accessible_name(format!("{play} drying")).clicked() {
            if view.is_playing {
                view.is_playing = false;
            } else {
                view.start();
            }
        }
        for (name, moment) in [("Set wet", &mut view.track.wet), ("Set dry", &mut view.track.dry)] {
            let button = ui.button(name).on_hover_text("Takes Ks, Kd and the width of the material for this end");
            if button.clicked() {
                *moment = material.moment();
            }
        }
    });
}

/// Which file was measured, and what its factors leave out.
fn measured(ui: &mut Ui, material: &Material, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - OPEN_WIDTH - ui.spacing().item_spacing.x;
        let field =
            TextEdit::singleline(&mut context.view.typed_measured).hint_text("Path of a MERL file, or drop one");
        let response = ui.add_sized([width, theme::ROW], field).accessible_name("Path of a MERL file");
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if entered && !context.view.typed_measured.trim().is_empty() {
            context.push(Command::OpenMeasured(PathBuf::from(context.view.typed_measured.trim())));
        }
        let button = ui.add_sized([OPEN_WIDTH, theme::ROW], egui::Button::new("Open…"));
        if button.accessible_name("Open a MERL file").clicked() {
            context.push(Command::OpenMeasuredDialog);
        }
    });
    let text = match material.measured {
        _ if context.session.is_measuring() => "Reading a measured reflectance".to_owned(),
        None => "None is read yet: Blinn-Phong stands in.".to_owned(),
        Some(measured) => {
            let of = measured.measurement();
            let name = Path::new(&of.name).file_name().unwrap_or_default().to_string_lossy();
            let [r, g, b] = of.residual.map(|residual| 100.0 * residual);
            format!("{name}: f(theta_h) g(theta_d) leaves {r:.1}, {g:.1}, {b:.1} % (R, G, B)")
        }
    };
    ui.add(egui::Label::new(RichText::new(text).small().color(theme::of(ui).weak)).wrap());
}

fn rules(ui: &mut Ui, material: &mut Material) {
    let rules = ConvolutionRule::ALL.map(|rule| (rule, rule.label(), p::convolution(rule)));
    let about = Some(about::convolution(material.convolution));
    if let Some(rule) = choice_row(ui, "Convolution", p::CONVOLUTION, material.convolution, &rules, about) {
        material.convolution = rule;
    }
    let rules = DiffuseRule::ALL.map(|rule| (rule, rule.label(), p::diffuse(rule)));
    let about = Some(about::diffuse(material.diffuse_rule));
    if let Some(rule) = choice_row(ui, "Diffuse rule", p::DIFFUSE_RULE, material.diffuse_rule, &rules, about) {
        material.diffuse_rule = rule;
    }
}
