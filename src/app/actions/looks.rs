//! How the window looks: themes, and the size of everything in it.

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::Command;
use crate::app::settings::Settings;
use crate::app::theme::Theme;

/// The submenu of themes.
const THEME: &str = "Theme";
/// The submenu of sizes.
const SCALE: &str = "Interface scale";

pub fn actions() -> Vec<Action> {
    vec![
        of_settings("theme-dark", "Dark", |settings| settings.theme = Theme::Dark).inside(THEME),
        of_settings("theme-light", "Light", |settings| settings.theme = Theme::Light).inside(THEME),
        of_settings("theme-high-contrast", "High contrast", |settings| settings.theme = Theme::HighContrast)
            .inside(THEME),
        of_settings("scale-up", "Larger", |settings| settings.rescale(1.0))
            .key(Modifiers::COMMAND, Key::Plus)
            .key(Modifiers::COMMAND, Key::Equals)
            .repeating()
            .inside(SCALE),
        of_settings("scale-down", "Smaller", |settings| settings.rescale(-1.0))
            .key(Modifiers::COMMAND, Key::Minus)
            .repeating()
            .inside(SCALE),
        of_settings("scale-75", "75 %", |settings| settings.scale = 0.75).inside(SCALE),
        of_settings("scale-100", "100 %", |settings| settings.scale = 1.0)
            .key(Modifiers::COMMAND, Key::Num0)
            .inside(SCALE),
        of_settings("scale-125", "125 %", |settings| settings.scale = 1.25).inside(SCALE),
        of_settings("scale-150", "150 %", |settings| settings.scale = 1.5).inside(SCALE),
        of_settings("scale-200", "200 %", |settings| settings.scale = 2.0).inside(SCALE),
        of_settings("scale-300", "300 %", |settings| settings.scale = 3.0).inside(SCALE),
    ]
}

/// An action that changes what the user prefers.
fn of_settings(name: &str, label: &str, change: fn(&mut Settings)) -> Action {
    Action::new(Menu::View, name, label, move |_| Some(Command::ChangeSettings(change)))
}
