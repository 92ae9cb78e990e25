//! Every action with its keys, and what the pointer does.

use egui::{Context, Grid, Id, Label, Modal, RichText, ScrollArea, Ui};

use super::{PanelContext, heading};
use crate::app::actions::{self, Action, Menu};
use crate::app::theme;
use crate::app::view_state::Overlay;

/// What the pointer does, and keys that are held.
const GESTURES: [(&str, &str); 8] = [
    ("Drag on the surface", "orbit"),
    ("L + drag, or right drag", "move the light"),
    ("Wheel", "dolly, or zoom the map"),
    ("Hold the space bar", "see the right method alone"),
    ("Shift + drag on the surface", "choose the figures' region; Esc clears it"),
    ("Click on surface, map or level", "select the texel"),
    ("Drag on the sphere", "turn it"),
    ("Double click a control", "reset it"),
];

/// Rows of a column, headings included.
const ROWS: usize = 29;

/// Shows the list until it is dismissed.
pub fn show(ctx: &Context, context: &mut PanelContext<'_>) {
    let room = ctx.content_rect().size() - egui::vec2(60.0, 110.0);
    let modal = Modal::new(Id::unique("keys")).show(ctx, |ui| {
        ui.set_width(room.x);
        ui.set_height(room.y);
        ui.horizontal(|ui| {
            ui.label(RichText::new("Keys and gestures").heading().color(theme::of(ui).strong));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.button("Close").accessible_name("Close the keys").clicked()
            })
            .inner
        })
        .inner
            | ScrollArea::both().auto_shrink(false).show(ui, columns).inner
    });
    if modal.inner || modal.should_close() {
        context.view.overlay = Overlay::None;
    }
}

fn columns(ui: &mut Ui) -> bool {
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 18.0;
        ui.vertical(|ui| {
            gestures(ui);
            section(ui, Menu::File, None);
            section(ui, Menu::Edit, None);
        });
        ui.vertical(|ui| {
            section(ui, Menu::View, None);
            section(ui, Menu::Help, None);
        });
        for column in submenu_columns() {
            ui.vertical(|ui| column.iter().for_each(|&(menu, name)| section(ui, menu, Some(name))));
        }
    });
    false
}

/// The menus within menus by columns of so many rows.
fn submenu_columns() -> Vec<Vec<(Menu, &'static str)>> {
    let mut columns: Vec<(usize, Vec<(Menu, &'static str)>)> = vec![(0, Vec::new())];
    for (menu, name) in submenus() {
        let rows = 2 + actions::all().iter().filter(|action| action.submenu == Some(name)).count();
        match columns.last_mut() {
            Some((filled, column)) if *filled + rows <= ROWS => {
                *filled += rows;
                column.push((menu, name));
            }
            _ => columns.push((rows, vec![(menu, name)])),
        }
    }
    columns.into_iter().map(|(_, column)| column).collect()
}

/// Every menu within a menu, in order.
fn submenus() -> Vec<(Menu, &'static str)> {
    let mut found: Vec<_> = actions::all().iter().filter_map(|action| Some((action.menu, action.submenu?))).collect();
    found.dedup();
    found
}

fn gestures(ui: &mut Ui) {
    heading(ui, "Gestures");
    grid(ui, "gestures", GESTURES.into_iter().map(|(gesture, effect)| (effect.to_owned(), gesture.to_owned())));
}

fn section(ui: &mut Ui, menu: Menu, submenu: Option<&'static str>) {
    let name = submenu.unwrap_or(menu.label());
    heading(ui, name);
    let inside = |action: &&Action| action.menu == menu && action.submenu == submenu;
    let ctx = ui.ctx().clone();
    let keys =
        |action: &Action| action.keys.iter().map(|key| actions::key_words(&ctx, key)).collect::<Vec<_>>().join(", ");
    grid(ui, name, actions::all().iter().filter(inside).map(|action| (action.label.clone(), keys(action))));
}

fn grid(ui: &mut Ui, name: &str, rows: impl Iterator<Item = (String, String)>) {
    Grid::new(("keys", name)).num_columns(2).spacing([16.0, 2.0]).show(ui, |ui| {
        for (effect, keys) in rows {
            ui.add(Label::new(RichText::new(effect).color(theme::of(ui).text)).extend());
            ui.add(Label::new(RichText::new(keys).color(theme::of(ui).accent)).extend());
            ui.end_row();
        }
    });
    ui.add_space(2.0 * theme::GRID);
}
