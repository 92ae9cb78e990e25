//! What was said since the start, the latest first.

use egui::{Align, Context, Id, Label, Layout, Modal, RichText, ScrollArea, vec2};

use super::PanelContext;
use crate::app::theme;
use crate::app::view_state::Overlay;

const SIZE: egui::Vec2 = vec2(640.0, 360.0);

/// Shows the sentences until they are dismissed.
pub fn show(ctx: &Context, context: &mut PanelContext<'_>) {
    let modal = Modal::new(Id::unique("messages so far")).show(ctx, |ui| {
        ui.set_width(SIZE.x);
        let closes = ui.horizontal(|ui| {
            ui.label(RichText::new("Messages").heading().color(theme::of(ui).strong));
            let right = Layout::right_to_left(Align::Center);
            ui.with_layout(right, |ui| ui.button("Close").accessible_name("Close the messages").clicked()).inner
        });
        ScrollArea::vertical().max_height(SIZE.y).auto_shrink([false, true]).show(ui, |ui| {
            if context.said.is_empty() {
                ui.label(RichText::new("Nothing was said yet.").color(theme::of(ui).weak));
            }
            for message in context.said.iter().rev() {
                let color = if message.is_error { theme::of(ui).error } else { theme::of(ui).text };
                ui.add(Label::new(RichText::new(&message.text).color(color)).wrap());
            }
        });
        closes.inner
    });
    if modal.inner || modal.should_close() {
        context.view.overlay = Overlay::None;
    }
}
