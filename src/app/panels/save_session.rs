//! The question where the session is saved to: a path to be typed, or the system's dialog.

use std::path::PathBuf;

use egui::{Context, Id, Key, Modal, RichText, TextEdit};

use super::{PanelContext, focus_whole};
use crate::app::view_state::Overlay;
use crate::app::{Command, theme};

/// Shows the question until it is answered.
pub fn show(ctx: &Context, context: &mut PanelContext<'_>) {
    let modal = Modal::new(Id::unique("save session")).show(ctx, |ui| {
        ui.set_width(460.0);
        ui.label(RichText::new("Save session").heading().color(theme::of(ui).strong));
        let field = TextEdit::singleline(&mut context.view.session_path).desired_width(f32::INFINITY);
        let response = ui.add(field).accessible_name("Path of the session");
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if !response.has_focus() && !entered {
            focus_whole(&response, &context.view.session_path);
        }
        let hint = "Map, settings and layout, as JSON; paths in it are relative to it.";
        ui.label(RichText::new(hint).small().color(theme::of(ui).weak));
        ui.add_space(theme::GRID);
        ui.horizontal(|ui| {
            let path = context.view.session_path.trim();
            let saves = ui.add_enabled(!path.is_empty(), egui::Button::new("Save")).accessible_name("Save the session");
            if (saves.clicked() || entered) && !path.is_empty() {
                let path = PathBuf::from(path);
                context.push(Command::SaveSession(path));
                return true;
            }
            if ui.button("Browse…").accessible_name("Browse for the session").clicked() {
                context.push(Command::SaveSessionDialog);
                return true;
            }
            ui.button("Cancel").accessible_name("Cancel saving").clicked()
        })
        .inner
    });
    if modal.inner || modal.should_close() {
        context.view.overlay = Overlay::None;
    }
}
