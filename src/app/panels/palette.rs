//! The search for an action by its words: typed, chosen by arrow keys, done by Enter or a click.

use egui::{Align2, Area, Button, Context, Id, Key, Modal, Modifiers, Order, RichText, ScrollArea, TextEdit, Ui, vec2};

use super::PanelContext;
use crate::app::actions::{self, Action};
use crate::app::theme;
use crate::app::view_state::{Overlay, PaletteView};

const WIDTH: f32 = 460.0;
const LIST_HEIGHT: f32 = 340.0;

/// Shows the search; it closes once something was chosen.
pub fn show(ctx: &Context, context: &mut PanelContext<'_>) {
    let area = Area::new(Id::unique("palette")).order(Order::Foreground).anchor(Align2::CENTER_TOP, vec2(0.0, 64.0));
    let modal = Modal::new(Id::unique("palette")).area(area).show(ctx, |ui| {
        ui.set_width(WIDTH);
        let moved = arrows(ui);
        let entered = ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
        let field = TextEdit::singleline(&mut context.view.palette.text).desired_width(f32::INFINITY);
        let response = ui.add(field.hint_text("Search actions")).accessible_name("Search for an action");
        response.request_focus();
        let found: Vec<_> = actions::all().iter().filter(|action| action.matches(&context.view.palette.text)).collect();
        let chosen = if response.changed() { 0 } else { context.view.palette.chosen.saturating_add_signed(moved) };
        context.view.palette.chosen = chosen.min(found.len().saturating_sub(1));
        ui.add_space(theme::GRID);
        list(ui, context, &found, entered, moved != 0)
    });
    if modal.inner || modal.should_close() {
        (context.view.overlay, context.view.palette) = (Overlay::None, PaletteView::default());
    }
}

/// How far the arrow keys move the choice.
fn arrows(ui: &Ui) -> isize {
    ui.input_mut(|input| {
        let mut presses = |key| input.count_and_consume_key(Modifiers::NONE, key) as isize;
        presses(Key::ArrowDown) - presses(Key::ArrowUp)
    })
}

/// The actions found; true once one was taken.
fn list(ui: &mut Ui, context: &mut PanelContext<'_>, found: &[&Action], entered: bool, moved: bool) -> bool {
    if found.is_empty() {
        ui.label(RichText::new("No action has these words.").color(theme::of(ui).weak));
    }
    let mut taken = false;
    ScrollArea::vertical().max_height(LIST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        for (index, action) in found.iter().enumerate() {
            let is_chosen = index == context.view.palette.chosen;
            let command = action.command(&context.facts());
            let button = Button::selectable(is_chosen, action.words()).shortcut_text(action.key_text(ui.ctx()));
            let button = button.min_size(vec2(ui.available_width(), theme::ROW));
            let response = ui.add_enabled(command.is_some(), button).accessible_name(format!("Do: {}", action.name));
            if is_chosen && moved {
                response.scroll_to_me(None);
            }
            if command.is_some() && (response.clicked() || is_chosen && entered) {
                context.commands.extend(command);
                taken = true;
            }
        }
    });
    taken
}
