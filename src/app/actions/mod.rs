//! Everything the user may do by name: one list, which menus, keys, palette, the overlay of keys and scripts read.
//!
//! An action makes a [`Command`] of what it finds, or none where it cannot be done now. Names never change.

mod edit;
mod file;
mod help;
mod looks;
mod methods;
mod texels;
mod view;

use std::sync::LazyLock;

use egui::{Context, Key, KeyboardShortcut, Modifiers};

use super::history::History;
use super::view_state::Overlay;
use super::{Command, ViewState};
use crate::session::Session;

/// What an action may look at.
#[derive(Clone, Copy)]
pub struct Facts<'a> {
    /// The document.
    pub session: &'a Session,
    /// The view of it.
    pub view: &'a ViewState,
    /// What can be undone.
    pub history: &'a History,
}

/// The menu that an action stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Maps and sessions.
    File,
    /// Settings.
    Edit,
    /// What is seen, and how.
    View,
    /// What there is to know.
    Help,
}

impl Menu {
    /// Every menu with its name, from left to right.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::File, "File"), (Self::Edit, "Edit"), (Self::View, "View"), (Self::Help, "Help")];

    /// The menu's name.
    pub fn label(self) -> &'static str {
        Self::ALL.into_iter().find(|(menu, _)| *menu == self).map_or("", |(_, label)| label)
    }
}

type Make = Box<dyn Fn(&Facts<'_>) -> Option<Command> + Send + Sync>;

/// Something that the user may do.
pub struct Action {
    /// The name in scripts.
    pub name: String,
    /// The words in menus.
    pub label: String,
    /// The menu.
    pub menu: Menu,
    /// The menu within it, for actions of a kind.
    pub submenu: Option<&'static str>,
    /// True below a line.
    pub starts_group: bool,
    /// The keys, any of which will do; the first is shown.
    pub keys: Vec<KeyboardShortcut>,
    repeats: bool,
    make: Make,
}

impl Action {
    /// An action without a key.
    fn new(
        menu: Menu,
        name: impl Into<String>,
        label: impl Into<String>,
        make: impl Fn(&Facts<'_>) -> Option<Command> + Send + Sync + 'static,
    ) -> Self {
        let (name, label, make) = (name.into(), label.into(), Box::new(make));
        Self { name, label, menu, submenu: None, starts_group: false, keys: Vec::new(), repeats: false, make }
    }

    /// An action that changes the view alone and can always be done.
    fn of_view(menu: Menu, name: &str, label: &str, change: fn(&mut ViewState)) -> Self {
        Self::new(menu, name, label, move |_| Some(Command::ChangeView(change)))
    }

    fn key(mut self, modifiers: Modifiers, key: Key) -> Self {
        self.keys.push(KeyboardShortcut::new(modifiers, key));
        self
    }

    /// Goes on while the key is held.
    fn repeating(self) -> Self {
        Self { repeats: true, ..self }
    }

    fn inside(self, submenu: &'static str) -> Self {
        Self { submenu: Some(submenu), ..self }
    }

    fn after_rule(self) -> Self {
        Self { starts_group: true, ..self }
    }

    /// The command that does it; `None` where it cannot be done now.
    pub fn command(&self, facts: &Facts<'_>) -> Option<Command> {
        (self.make)(facts)
    }

    /// Its first key in words; empty without one.
    pub fn key_text(&self, ctx: &Context) -> String {
        self.keys.first().map_or_else(String::new, |key| key_words(ctx, key))
    }

    /// Where it stands, and its words.
    pub fn words(&self) -> String {
        format!("{}: {}", self.submenu.unwrap_or(self.menu.label()), self.label)
    }

    /// True if its words or its name hold every word of `text`, whatever their case.
    pub fn matches(&self, text: &str) -> bool {
        let own = format!("{} {}", self.words(), self.name).to_lowercase();
        text.to_lowercase().split_whitespace().all(|word| own.contains(word))
    }
}

/// Every action, in the order of the menus.
pub fn all() -> &'static [Action] {
    static ALL: LazyLock<Vec<Action>> = LazyLock::new(|| {
        [file::actions(), edit::actions(), view::actions(), methods::actions(), help::actions()]
            .into_iter()
            .flatten()
            .collect()
    });
    &ALL
}

/// The action of this name.
pub fn find(name: &str) -> Option<&'static Action> {
    all().iter().find(|action| action.name == name)
}

/// What the keys pressed in this pass ask for. While text is edited, its own keys are left to it, and those that move
/// about to whatever has the focus; under an overlay, all are.
pub fn pressed(ctx: &Context, facts: &Facts<'_>) -> Vec<Command> {
    if facts.view.overlay != Overlay::None {
        return Vec::new();
    }
    let typing = ctx.text_edit_focused();
    let focused = ctx.memory(egui::Memory::focused).is_some();
    let is_pressed = |action: &&Action| {
        let taken = |key: &KeyboardShortcut| typing && belongs_to_text(key) || focused && moves_about(key.logical_key);
        let keys = action.keys.iter().filter(|key| !taken(key));
        // Every key is asked, for each is taken away from the rest of the window.
        keys.filter(|key| consume(ctx, key, action.repeats)).count() > 0
    };
    all().iter().filter(is_pressed).filter_map(|action| action.command(facts)).collect()
}

/// Keys as they stand on a keyboard: `Ctrl+Z`, `?`.
pub fn key_words(ctx: &Context, keys: &KeyboardShortcut) -> String {
    let (words, key) = (ctx.format_shortcut(keys), keys.logical_key);
    if makes_sign(key) { words.replace(key.name(), key.symbol_or_name()) } else { words }
}

/// True for keys that Shift may be needed for.
fn makes_sign(key: Key) -> bool {
    matches!(key, Key::Plus | Key::Minus | Key::Equals | Key::Questionmark)
}

/// True for keys that a text field wants for itself.
fn belongs_to_text(key: &KeyboardShortcut) -> bool {
    let undoes = key.modifiers.command && matches!(key.logical_key, Key::Z | Key::Y);
    undoes || !key.modifiers.command && !is_function_key(key.logical_key)
}

fn moves_about(key: Key) -> bool {
    use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, PageDown, PageUp};
    matches!(key, ArrowLeft | ArrowRight | ArrowUp | ArrowDown | PageUp | PageDown)
}

fn is_function_key(key: Key) -> bool {
    key.name().strip_prefix('F').is_some_and(|number| number.parse::<u8>().is_ok())
}

/// Takes the presses of a key out of the pass; true if there was one. Shift must be as it is asked for where it
/// does not itself make the sign.
fn consume(ctx: &Context, wanted: &KeyboardShortcut, repeats: bool) -> bool {
    let mut found = false;
    ctx.input_mut(|input| {
        input.events.retain(|event| {
            let egui::Event::Key { key, pressed: true, repeat, modifiers, .. } = event else { return true };
            let fits = if makes_sign(wanted.logical_key) {
                modifiers.matches_logically(wanted.modifiers)
            } else {
                modifiers.matches_exact(wanted.modifiers)
            };
            let is_wanted = fits && *key == wanted.logical_key && (repeats || !repeat);
            found |= is_wanted;
            !is_wanted
        });
    });
    found
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_name_and_every_key_belongs_to_one_action() {
        let (mut names, mut keys) = (BTreeSet::new(), BTreeSet::new());
        for action in all() {
            assert!(names.insert(&action.name), "'{}' is doubled", action.name);
            assert!(action.name.chars().all(|c| c.is_ascii_graphic()), "'{}' is no word", action.name);
            for key in &action.keys {
                assert!(keys.insert(format!("{key:?}")), "{key:?} of '{}' is doubled", action.name);
            }
        }
        assert!(names.len() > 40, "only {} actions", names.len());
    }

    #[test]
    fn words_find_an_action_in_any_order() {
        let undo = find("undo").expect("there is one");
        assert!(undo.matches("") && undo.matches("UN do") && undo.matches("edit: undo") && !undo.matches("undo redo"));
    }

    #[test]
    fn letters_belong_to_text_and_file_keys_do_not() {
        let key = |modifiers, key| belongs_to_text(&KeyboardShortcut::new(modifiers, key));
        assert!(key(Modifiers::NONE, Key::F) && key(Modifiers::SHIFT, Key::E) && key(Modifiers::COMMAND, Key::Z));
        assert!(!key(Modifiers::COMMAND, Key::S) && !key(Modifiers::NONE, Key::F2));
    }
}
