//! Undo and redo. Whatever a session file keeps comes back, step by step; what is held or still moves is one step.

use crate::session::file::SessionFile;

/// The most steps that are kept.
const CAPACITY: usize = 200;

/// What the document was, and what it is again after an undo.
#[derive(Default)]
pub struct History {
    past: Vec<SessionFile>,
    present: Option<SessionFile>,
    future: Vec<SessionFile>,
    /// True until the document has become what was brought back, which may take the nearest values there are.
    settling: bool,
}

impl History {
    /// True where there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// True where there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Takes note of the document, between two movements.
    pub fn record(&mut self, now: SessionFile) {
        let Some(present) = &self.present else {
            self.present = Some(now);
            return;
        };
        if *present == now {
            self.settling = false;
            return;
        }
        let before = self.present.replace(now);
        if !std::mem::take(&mut self.settling) {
            self.past.extend(before);
            self.past.drain(..self.past.len().saturating_sub(CAPACITY));
            self.future.clear();
        }
    }

    /// The document one step ago.
    pub fn undo(&mut self) -> Option<SessionFile> {
        let earlier = self.past.pop()?;
        self.future.extend(self.present.replace(earlier.clone()));
        self.settling = true;
        Some(earlier)
    }

    /// The document one undo ago.
    pub fn redo(&mut self) -> Option<SessionFile> {
        let later = self.future.pop()?;
        self.past.extend(self.present.replace(later.clone()));
        self.settling = true;
        Some(later)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(samples: u32) -> SessionFile {
        SessionFile { truth_samples: Some(samples), ..SessionFile::default() }
    }

    fn recorded(steps: impl IntoIterator<Item = u32>) -> History {
        let mut history = History::default();
        steps.into_iter().for_each(|samples| history.record(at(samples)));
        history
    }

    #[test]
    fn undo_goes_back_and_redo_forth_through_every_step() {
        let mut history = recorded([1, 2, 2, 3]);
        assert_eq!((history.undo(), history.undo(), history.undo()), (Some(at(2)), Some(at(1)), None));
        assert_eq!((history.redo(), history.redo(), history.redo()), (Some(at(2)), Some(at(3)), None));
    }

    #[test]
    fn a_new_step_ends_what_could_be_redone() {
        let mut history = recorded([1, 2]);
        history.undo();
        history.record(at(1));
        history.record(at(9));
        assert!(!history.can_redo() && history.undo() == Some(at(1)));
    }

    #[test]
    fn a_document_that_comes_back_as_near_as_it_can_is_no_step_of_its_own() {
        let mut history = recorded([1, 2]);
        history.undo();
        history.record(at(7));
        assert!(history.can_redo() && !history.can_undo());
    }

    #[test]
    fn the_oldest_steps_go_first() {
        let mut history = recorded(0..=CAPACITY as u32 + 5);
        let earliest = std::iter::from_fn(|| history.undo()).last();
        assert_eq!(earliest, Some(at(5)));
    }
}
