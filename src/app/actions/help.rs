//! What there is to do.

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::Command;
use crate::app::view_state::Overlay;

pub fn actions() -> Vec<Action> {
    vec![
        Action::of_view(Menu::Help, "palette", "Search actions…", |view| view.overlay = Overlay::Palette)
            .key(Modifiers::COMMAND, Key::P),
        Action::of_view(Menu::Help, "keys", "Keys and gestures", |view| view.overlay = Overlay::Keys)
            .key(Modifiers::NONE, Key::Questionmark)
            .key(Modifiers::SHIFT, Key::Slash)
            .key(Modifiers::NONE, Key::F1),
        Action::new(Menu::Help, "tour", "Tour of the window", |_| Some(Command::StartTour)),
        Action::of_view(Menu::Help, "messages", "Messages so far", |view| view.overlay = Overlay::Log),
    ]
}
