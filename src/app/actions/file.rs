//! Maps and sessions.

use std::path::Path;

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::Command;
use crate::app::view_state::Overlay;
use crate::normal_map::MapSource;
use crate::normal_map::procedural::SAMPLES;
use crate::session::MapRequest;

/// The submenu of bundled maps.
pub const BUNDLED: &str = "Open bundled map";

pub fn actions() -> Vec<Action> {
    let mut actions = vec![
        Action::new(Menu::File, "open", "Open…", |_| Some(Command::OpenDialog)).key(Modifiers::COMMAND, Key::O),
        Action::new(Menu::File, "open-mesh", "Open mesh…", |_| Some(Command::OpenMeshDialog)),
        Action::new(Menu::File, "reload-map", "Reload map", |facts| {
            let map = facts.session.map();
            matches!(map.source, MapSource::File(_)).then(|| Command::Reopen(map.options.clone()))
        })
        .key(Modifiers::COMMAND, Key::R),
        Action::new(Menu::File, "save-session", "Save session", |facts| {
            let path = facts.session.path().map(Path::to_owned);
            Some(path.map_or(Command::AskSessionPath, Command::SaveSession))
        })
        .key(Modifiers::COMMAND, Key::S)
        .after_rule(),
        Action::new(Menu::File, "save-session-as", "Save session as…", |_| Some(Command::AskSessionPath))
            .key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S),
        Action::of_view(Menu::File, "export", "Export…", |view| view.overlay = Overlay::Export)
            .key(Modifiers::COMMAND, Key::E),
    ];
    actions.extend(SAMPLES.iter().map(|sample| {
        let name = sample.name;
        let open = move |facts: &super::Facts<'_>| {
            let options = facts.session.map().options.clone();
            Some(Command::Open(MapRequest::Bundled { name: name.to_owned(), options }))
        };
        Action::new(Menu::File, format!("open-bundled-{name}"), name, open).inside(BUNDLED)
    }));
    let quit = Action::new(Menu::File, "quit", "Quit", |_| Some(Command::Quit));
    actions.push(quit.key(Modifiers::COMMAND, Key::Q).after_rule());
    actions
}
