//! The top bar: menus, what is open, and what the middle of the window shows.

use egui::{Align, Layout as Flow, MenuBar, RichText, Ui};

use super::{PanelContext, segmented};
use crate::app::view_state::Layout;
use crate::app::{Command, ViewState, theme};
use crate::normal_map::procedural::SAMPLES;
use crate::session::MapRequest;

/// Shows the bar.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    MenuBar::new().ui(ui, |ui| {
        ui.label(RichText::new("NDF Inspector").strong().color(theme::STRONG));
        ui.add_space(theme::GRID);
        ui.menu_button("File", |ui| file_menu(ui, context));
        ui.menu_button("View", |ui| view_menu(ui, context));
        ui.menu_button("Help", help_menu);
        ui.add_space(2.0 * theme::GRID);
        ui.label(RichText::new(context.session.map().name()).strong());
        ui.label(RichText::new(facts(context)).color(theme::WEAK));
        ui.with_layout(Flow::right_to_left(Align::Center), |ui| {
            let reversed: Vec<_> = Layout::ALL.into_iter().rev().collect();
            segmented(ui, "Layout", &mut context.view.layout, &reversed);
        });
    });
}

fn facts(context: &PanelContext<'_>) -> String {
    let map = context.session.map();
    let stored = &map.stored;
    format!("{} × {} · {} {}", map.width, map.height, stored.depth.label(), stored.format)
}

fn file_menu(ui: &mut Ui, context: &mut PanelContext<'_>) {
    if ui.button("Open…").clicked() {
        context.push(Command::OpenDialog);
    }
    ui.menu_button("Open recent", |ui| {
        let paths = context.session.recent().paths();
        if paths.is_empty() {
            ui.label(RichText::new("Nothing opened yet").color(theme::WEAK));
        }
        for path in paths {
            if ui.button(path.display().to_string()).clicked() {
                context.commands.push(Command::OpenPath(path.clone()));
            }
        }
    });
    ui.menu_button("Open bundled map", |ui| {
        for sample in SAMPLES {
            if ui.button(sample.name).on_hover_text(sample.description).clicked() {
                let options = context.session.map().options.clone();
                context.push(Command::Open(MapRequest::Bundled { name: sample.name.to_owned(), options }));
            }
        }
    });
    ui.separator();
    if ui.button("Quit").clicked() {
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

fn view_menu(ui: &mut Ui, context: &mut PanelContext<'_>) {
    if ui.button("Reset view").on_hover_text("Panels, zoom and sphere as on the first start").clicked() {
        *context.view = ViewState::default();
    }
    if ui.button("Reset camera").clicked() {
        let camera = crate::scene::Camera::default();
        context.push(Command::SetSurface(crate::lit_surface::LitSurface { camera, ..context.session.surface.clone() }));
    }
}

fn help_menu(ui: &mut Ui) {
    let rows = [
        ("Drag on the surface", "orbit"),
        ("L + drag, or right drag", "move the light"),
        ("Wheel", "dolly, or zoom the map"),
        ("Click on surface, map or level", "select the texel"),
        ("Drag on the sphere", "turn it"),
        ("Double click a control", "reset it"),
    ];
    egui::Grid::new("help").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (gesture, effect) in rows {
            ui.label(RichText::new(gesture).color(theme::STRONG));
            ui.label(effect);
            ui.end_row();
        }
    });
}
