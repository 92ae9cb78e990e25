//! Sentences for the user, over everything, until they are dismissed.

use egui::{Align2, Area, Context, Frame, Id, RichText, Stroke, vec2};

use crate::app::theme;
use crate::session::{MapRequest, Message};

/// The most sentences shown at once; older ones give way.
const SHOWN: usize = 4;

/// Shows the sentences and takes away those that are dismissed; returns what was accepted of what they offer.
pub fn show(ctx: &Context, messages: &mut Vec<Message>) -> Option<MapRequest> {
    let excess = messages.len().saturating_sub(SHOWN);
    messages.drain(..excess);
    if messages.is_empty() {
        return None;
    }
    let (mut dismissed, mut accepted) = (None, None);
    Area::new(Id::unique("messages")).anchor(Align2::CENTER_TOP, vec2(0.0, 44.0)).show(ctx, |ui| {
        for (index, message) in messages.iter().enumerate() {
            let color = if message.is_error { theme::of(ui).error } else { theme::of(ui).accent };
            let frame = Frame::popup(ui.style()).stroke(Stroke::new(1.0, color)).inner_margin(8);
            frame.show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.set_max_width(560.0);
                    let kind = if message.is_error { "Error" } else { "Note" };
                    ui.label(RichText::new(kind).strong().color(color));
                    ui.add(egui::Label::new(&message.text).wrap());
                    if let Some(offer) = &message.offer
                        && ui.button(offer.label).accessible_name(format!("{} {}", offer.label, index + 1)).clicked()
                    {
                        (accepted, dismissed) = (Some(offer.request.clone()), Some(index));
                    }
                    let close = ui.button("Dismiss").accessible_name(format!("Dismiss message {}", index + 1));
                    if close.clicked() {
                        dismissed = Some(index);
                    }
                });
            });
        }
    });
    if let Some(index) = dismissed {
        messages.remove(index);
    }
    accepted
}
