//! Every action with its keys, and what the pointer does.

use egui::{Context, Grid, Id, Label, Modal, RichText, ScrollArea, Ui};

use super::{PanelContext, heading};
use crate::app::actions::{self, Action};
use crate::app::theme;
use crate::app::view_state::Overlay;

/// What the pointer does, and keys that are held.
const GESTURES: [(&str, &str); 9] = [
    ("orbit", "Drag the surface"),
    ("move the light", "L + drag"),
    ("dolly, or zoom the map", "Wheel"),
    ("right method alone", "Hold space"),
    ("region of a picture", "Shift + drag"),
    ("the whole again", "Esc"),
    ("select the texel", "Click"),
    ("turn the sphere", "Drag it"),
    ("reset a control", "Double click"),
];

/// The height of a row: as high as its text, so that all rows fit a window of 1280 x 800.
const ROW: f32 = 16.0;

/// The width of a column, and how many there are at most.
const COLUMN: f32 = 244.0;
const MOST_COLUMNS: usize = 5;

/// A heading with what stands under it: an effect and its keys.
struct Section {
    title: &'static str,
    rows: Vec<(String, String)>,
}

impl Section {
    /// In rows, with the heading and the gap below.
    fn height(&self) -> usize {
        self.rows.len() + 2
    }
}

/// Shows the list until it is dismissed.
pub fn show(ctx: &Context, context: &mut PanelContext<'_>) {
    let room = ctx.content_rect().size() - egui::vec2(60.0, 110.0);
    let modal = Modal::new(Id::unique("keys")).show(ctx, |ui| {
        let count = ((room.x / COLUMN) as usize).clamp(1, MOST_COLUMNS);
        ui.set_width(count as f32 * COLUMN);
        let heading = ui.horizontal(|ui| {
            ui.label(RichText::new("Keys and gestures").heading().color(theme::of(ui).strong));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.button("Close").accessible_name("Close the keys").clicked()
            })
            .inner
        });
        ScrollArea::vertical().min_scrolled_height(room.y).show(ui, |ui| columns(ui, count));
        heading.inner
    });
    if modal.inner || modal.should_close() {
        context.view.overlay = Overlay::None;
    }
}

fn columns(ui: &mut Ui, count: usize) {
    let sections = sections(ui);
    let columns = spread(&sections, count);
    ui.columns(count, |columns_of_ui| {
        for (ui, column) in columns_of_ui.iter_mut().zip(&columns) {
            for section in column {
                show_section(ui, section);
            }
        }
    });
}

/// Gestures first, then every menu and every menu within one, in order.
fn sections(ui: &Ui) -> Vec<Section> {
    let keys = |action: &Action| {
        let keys = action.keys.iter().map(|key| actions::key_words(ui.ctx(), key));
        (action.label.clone(), keys.collect::<Vec<_>>().join(", "))
    };
    let gestures = GESTURES.map(|(effect, gesture)| (effect.to_owned(), gesture.to_owned()));
    let mut sections = vec![Section { title: "Gestures", rows: gestures.into() }];
    let mut titles: Vec<_> = actions::all().iter().map(|action| (action.menu, action.submenu)).collect();
    titles.sort_by_key(|(_, submenu)| submenu.is_some());
    titles.dedup();
    for (menu, submenu) in titles {
        let inside = actions::all().iter().filter(|action| (action.menu, action.submenu) == (menu, submenu));
        sections.push(Section { title: submenu.unwrap_or(menu.label()), rows: inside.map(keys).collect() });
    }
    sections
}

/// The sections in so many columns, in order and as low as they can be.
fn spread(sections: &[Section], count: usize) -> Vec<Vec<&Section>> {
    let whole: usize = sections.iter().map(Section::height).sum();
    let mut columns = (whole.div_ceil(count)..=whole).map(|limit| fill(sections, limit));
    columns.find(|columns| columns.len() <= count).unwrap_or_default()
}

/// The sections in columns of so many rows, and higher ones where a section is.
fn fill(sections: &[Section], limit: usize) -> Vec<Vec<&Section>> {
    let mut columns: Vec<Vec<&Section>> = Vec::new();
    let mut filled = limit;
    for section in sections {
        filled += section.height();
        match columns.last_mut() {
            Some(column) if filled <= limit => column.push(section),
            _ => {
                filled = section.height();
                columns.push(vec![section]);
            }
        }
    }
    columns
}

fn show_section(ui: &mut Ui, section: &Section) {
    heading(ui, section.title);
    Grid::new(("keys", section.title)).num_columns(2).min_row_height(ROW).spacing([12.0, 1.0]).show(ui, |ui| {
        for (effect, keys) in &section.rows {
            ui.add(Label::new(RichText::new(effect).color(theme::of(ui).text)).extend());
            ui.add(Label::new(RichText::new(keys).color(theme::of(ui).accent)).extend());
            ui.end_row();
        }
    });
    ui.add_space(2.0 * theme::GRID);
}
