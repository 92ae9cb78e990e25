//! What the user prefers, whatever session is open: kept in the user's folder, part of no session.

use std::path::PathBuf;

use egui::Context;
use serde::{Deserialize, Serialize};

use super::theme::{self, Theme};
use crate::session::recent::{keep, user_folder};

/// The preferences.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// How the window looks.
    pub theme: Theme,
    /// Size of everything in the window over its usual one.
    pub scale: f32,
    /// True once the tour was taken or dismissed.
    pub knows_tour: bool,
    /// How large the window was when it was closed last.
    pub window: Option<WindowSize>,
}

/// How large a window is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowSize {
    /// Across and down, in the system's own points.
    pub points: [f32; 2],
    /// True where it takes the whole screen up; the size is what it has when it does not.
    pub is_maximized: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { theme: Theme::default(), scale: 1.0, knows_tour: false, window: None }
    }
}

/// The sizes that a window may open with.
const WINDOW_POINTS: [f32; 2] = [200.0, 16384.0];

/// The scales that may be chosen.
pub const SCALES: [f32; 2] = [0.5, 4.0];

impl Settings {
    /// Everything larger or smaller by steps of an eighth.
    pub fn rescale(&mut self, steps: f32) {
        self.scale = ((self.scale * 8.0).round() + steps) / 8.0;
    }

    /// The same with a scale and a window that can be shown.
    fn sound(self) -> Self {
        let scale = if self.scale.is_finite() { self.scale.clamp(SCALES[0], SCALES[1]) } else { 1.0 };
        let can_open =
            |window: &WindowSize| window.points.iter().all(|side| (WINDOW_POINTS[0]..=WINDOW_POINTS[1]).contains(side));
        Self { scale, window: self.window.filter(can_open), ..self }
    }
}

/// The preferences, the file that keeps them, and what the window was dressed in last.
#[derive(Default)]
pub struct KeptSettings {
    settings: Settings,
    dressed: Option<Settings>,
    store: Option<PathBuf>,
}

impl KeptSettings {
    /// The user's own; unreadable ones count as none.
    pub fn of_user() -> Self {
        let store = user_folder().map(|folder| folder.join("settings.json"));
        let bytes = store.as_deref().and_then(|path| std::fs::read(path).ok());
        let read = bytes.map_or_else(|| Ok(Settings::default()), |bytes| serde_json::from_slice(&bytes));
        let settings: Settings = read.unwrap_or_else(|error| {
            log::warn!("the settings are not read: {error}");
            Settings::default()
        });
        Self { settings: settings.sound(), dressed: None, store }
    }

    /// The preferences.
    pub fn get(&self) -> &Settings {
        &self.settings
    }

    /// Changes the preferences, and keeps them.
    pub fn change(&mut self, change: impl FnOnce(&mut Settings)) {
        let before = self.settings.clone();
        change(&mut self.settings);
        self.settings = std::mem::take(&mut self.settings).sound();
        if self.settings != before
            && let Some(store) = &self.store
            && let Err(error) = keep(store, &self.settings)
        {
            log::warn!("{error}");
        }
    }

    /// Another window is open, in which nothing is dressed yet.
    pub fn undress(&mut self) {
        self.dressed = None;
    }

    /// Dresses the window where the preferences have changed.
    pub fn dress(&mut self, ctx: &Context) {
        let (theme, scale) = (self.settings.theme, self.settings.scale);
        let before = self.dressed.replace(self.settings.clone());
        if before.as_ref().is_none_or(|before| before.theme != theme) {
            theme::apply(ctx, theme);
            ctx.request_repaint();
        }
        if before.map_or(1.0, |before| before.scale) != scale {
            ctx.set_zoom_factor(scale);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_kept_and_odd_ones_are_made_sound() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = folder.path().join("deep/settings.json");
        let mut kept = KeptSettings { store: Some(store.clone()), ..KeptSettings::default() };
        kept.change(|settings| (settings.theme, settings.scale) = (Theme::Light, 1e9));
        let read: Settings = serde_json::from_slice(&std::fs::read(store).expect("kept")).expect("settings");
        assert_eq!((read.theme, read.scale), (Theme::Light, SCALES[1]));
        kept.change(|settings| settings.window = Some(WindowSize { points: [f32::NAN, 700.0], is_maximized: true }));
        assert_eq!(kept.get().window, None, "no window can open so");
        let partial: Settings = serde_json::from_str(r#"{"theme": "high-contrast", "pace": 2}"#).expect("settings");
        assert_eq!((partial.theme, partial.scale), (Theme::HighContrast, 1.0));
    }

    #[test]
    fn scales_go_by_eighths() {
        let mut settings = Settings::default();
        settings.rescale(1.0);
        assert_eq!(settings.scale, 1.125);
        settings.rescale(-2.0);
        assert_eq!(settings.scale, 0.875);
    }
}
