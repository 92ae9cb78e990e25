//! The top bar: menus, what is open, and what the window is used for.

use egui::{Align, Button, Layout as Flow, MenuBar, RichText, Ui};

use super::{PanelContext, segmented};
use crate::app::actions::{self, Action, Menu};
use crate::app::dock::Preset;
use crate::app::view_state::Overlay;
use crate::app::{Command, theme};

/// Shows the bar.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    MenuBar::new().ui(ui, |ui| {
        ui.label(RichText::new("NDF Inspector").strong().color(theme::of(ui).strong));
        ui.add_space(theme::GRID);
        for (menu, label) in Menu::ALL {
            ui.menu_button(label, |ui| show_menu(ui, context, menu));
        }
        ui.add_space(2.0 * theme::GRID);
        ui.label(RichText::new(context.session.map().name()).strong());
        ui.label(RichText::new(facts(context)).color(theme::of(ui).weak));
        ui.with_layout(Flow::right_to_left(Align::Center), |ui| {
            search(ui, context);
            presets(ui, context);
        });
    });
}

fn facts(context: &PanelContext<'_>) -> String {
    let map = context.session.map();
    let stored = &map.stored;
    format!("{} × {} · {} {}", map.width, map.height, stored.depth.label(), stored.format)
}

/// What the window is used for.
fn presets(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let reversed: Vec<_> = Preset::ALL.into_iter().rev().collect();
    let current = context.view.dock.preset;
    let mut preset = current;
    ui.spacing_mut().button_padding.x = 2.0 * theme::GRID;
    if segmented(ui, "Preset", &mut preset, current, &reversed) || preset != current {
        context.view.choose(preset);
    }
}

/// The way to every action, for whoever does not know the key.
fn search(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let key = actions::find("palette").map_or_else(String::new, |action| action.key_text(ui.ctx()));
    let button = Button::new(RichText::new("Search").color(theme::of(ui).weak)).shortcut_text(key);
    if ui.add(button).accessible_name("Search actions").clicked() {
        context.view.overlay = Overlay::Palette;
    }
    ui.add_space(theme::GRID);
}

/// The actions of a menu, in their order; those of a kind go into a menu of their own.
fn show_menu(ui: &mut Ui, context: &mut PanelContext<'_>, menu: Menu) {
    let mut shown = None;
    for action in actions::all().iter().filter(|action| action.menu == menu) {
        if action.starts_group {
            ui.separator();
        }
        match action.submenu {
            None => item(ui, context, action, menu.label()),
            Some(name) if shown != Some(name) => {
                shown = Some(name);
                let opened = ui.menu_button(name, |ui| show_submenu(ui, context, menu, name));
                opened.response.accessible_name(format!("{}: {name}", menu.label()));
            }
            Some(_) => {}
        }
        if action.name == "open" {
            ui.menu_button("Open recent", |ui| recent(ui, context));
        }
    }
}

fn show_submenu(ui: &mut Ui, context: &mut PanelContext<'_>, menu: Menu, name: &str) {
    let inside = |action: &&Action| action.menu == menu && action.submenu == Some(name);
    actions::all().iter().filter(inside).for_each(|action| item(ui, context, action, name));
}

fn item(ui: &mut Ui, context: &mut PanelContext<'_>, action: &Action, menu: &str) {
    let command = action.command(&context.facts());
    let button = Button::new(&action.label).shortcut_text(action.key_text(ui.ctx()));
    let response = ui.add_enabled(command.is_some(), button).accessible_name(format!("{menu}: {}", action.label));
    if response.clicked() {
        context.commands.extend(command);
    }
}

/// Maps and sessions opened lately.
fn recent(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let paths = context.session.recent().paths();
    if paths.is_empty() {
        ui.label(RichText::new("Nothing opened yet").color(theme::of(ui).weak));
    }
    for path in paths {
        if ui.button(path.display().to_string()).clicked() {
            context.commands.push(Command::OpenPath(path.clone()));
        }
    }
}
