//! What of an inspector outlives its device: everything but what stands on the adapter.

use super::{
    Autosave, FiguresReport, History, Inspector, KeptSettings, MessageLog, Surroundings, Tour, ViewState, wake_of,
};
use crate::session::{Message, Session};

const SAID: &str = "The graphics device was lost and is set up again; nothing of what you did is lost.";

/// The document, the view of it, what it was before, what was said and measured.
pub struct Carried {
    session: Session,
    view: ViewState,
    history: History,
    autosave: Autosave,
    settings: KeptSettings,
    tour: Tour,
    figures: FiguresReport,
    messages: MessageLog,
}

impl Inspector {
    /// Leaves what stands on the device behind.
    pub fn into_carried(self) -> Carried {
        let Self { session, view, history, autosave, settings, tour, figures, messages, .. } = self;
        Carried { session, view, history, autosave, settings, tour, figures, messages }
    }

    /// The same inspector on another device, in another window, which says so once.
    pub fn revive(ctx: &egui::Context, carried: Carried, surroundings: Surroundings) -> Self {
        let Carried { session, view, history, autosave, mut settings, tour, mut figures, messages } = carried;
        figures.move_to(surroundings.gpu.clone(), wake_of(ctx));
        let mut inspector = Self::new(ctx, session, surroundings);
        settings.undress();
        (inspector.view, inspector.history, inspector.autosave) = (view, history, autosave);
        (inspector.settings, inspector.tour) = (settings, tour);
        (inspector.figures, inspector.messages) = (figures, messages);
        inspector.session.report(Message::remark(SAID));
        inspector
    }
}
