//! Undo, redo, the fit, and settings brought back to their defaults.

use egui::{Key, Modifiers};

use super::{Action, Facts, Menu};
use crate::app::Command;
use crate::filter::vmf::FitSettings;
use crate::lit_surface::LitSurface;

pub fn actions() -> Vec<Action> {
    vec![
        Action::new(Menu::Edit, "undo", "Undo", |facts| facts.history.can_undo().then_some(Command::Undo))
            .key(Modifiers::COMMAND, Key::Z)
            .repeating(),
        Action::new(Menu::Edit, "redo", "Redo", |facts| facts.history.can_redo().then_some(Command::Redo))
            .key(Modifiers::COMMAND, Key::Y)
            .key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z)
            .repeating(),
        Action::new(Menu::Edit, "refit", "Refit", |_| Some(Command::Refit)).after_rule(),
        Action::new(Menu::Edit, "cancel-fit", "Cancel fit", |facts| {
            facts.session.fitting().is_running().then_some(Command::CancelFit)
        }),
        Action::new(Menu::Edit, "reset-fit", "Reset fit settings", |facts| {
            let settings = FitSettings::default();
            (*facts.session.fit_settings() != settings).then_some(Command::SetFit(settings))
        })
        .after_rule(),
        Action::new(Menu::Edit, "reset-material", "Reset material", |facts| {
            reset(facts, |surface, default| surface.material = default.material)
        }),
        Action::new(Menu::Edit, "reset-lights", "Reset lights", |facts| {
            reset(facts, |surface, default| surface.lights = default.lights)
        }),
        Action::new(Menu::Edit, "reset-surface", "Reset surface", |facts| {
            reset(facts, |surface, default| {
                (surface.shape, surface.level, surface.anisotropy) = (default.shape, default.level, default.anisotropy);
            })
        }),
    ]
}

/// The command that takes a part of the surface from the default one; `None` where it is that already.
fn reset(facts: &Facts<'_>, take: fn(&mut LitSurface, LitSurface)) -> Option<Command> {
    let mut surface = facts.session.surface.clone();
    take(&mut surface, LitSurface::default());
    (surface != facts.session.surface).then_some(Command::SetSurface(surface))
}
