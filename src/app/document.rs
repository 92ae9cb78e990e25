//! The document as a session file has it: the session, and the window's view of it. Saving, undo and the next start
//! all go by these contents.

use serde::Deserialize;
use serde_json::Value;

use super::ViewState;
use crate::session::file::SessionFile;
use crate::session::{Message, Session};

/// Everything that a session file keeps.
pub fn contents(session: &Session, view: &ViewState) -> SessionFile {
    SessionFile { view: serde_json::to_value(view).ok(), ..session.to_file() }
}

/// Brings the contents back; another map is read in the background.
pub fn restore(file: SessionFile, session: &mut Session, view: &mut ViewState) {
    if let Some(value) = file.view.clone() {
        take_view(value, session, view);
    }
    session.restore(file);
}

/// Takes a layout; one that cannot be read leaves the view as it is and says so.
pub fn take_view(value: Value, session: &mut Session, view: &mut ViewState) {
    match ViewState::deserialize(&value).and_then(|read| Ok((serde_json::to_value(&read)?, read))) {
        Ok((known, read)) => {
            session.keep_unknown_view(&value, &known);
            *view = read;
        }
        Err(error) => {
            session.report(Message::error(format!("The session's layout of the window cannot be read: {error}.")));
        }
    }
}
