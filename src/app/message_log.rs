//! Sentences for the user: shown once until they are dismissed, and kept to be read again.

use crate::session::Message;

/// The most sentences that are kept.
const CAPACITY: usize = 500;

/// What was said.
#[derive(Default)]
pub struct MessageLog {
    /// What is shown and not dismissed yet.
    pub shown: Vec<Message>,
    said: Vec<Message>,
}

impl MessageLog {
    /// Shows and keeps what is new; what is shown already is not shown twice.
    pub fn add(&mut self, news: Vec<Message>) {
        for message in news {
            if !self.shown.contains(&message) {
                self.shown.push(message.clone());
            }
            self.said.push(message);
        }
        self.said.drain(..self.said.len().saturating_sub(CAPACITY));
    }

    /// Everything that was said, the earliest first.
    pub fn said(&self) -> &[Message] {
        &self.said
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_is_shown_once_and_kept_every_time() {
        let mut log = MessageLog::default();
        log.add(vec![Message::remark("one"), Message::error("two")]);
        log.add(vec![Message::remark("one")]);
        assert_eq!((log.shown.len(), log.said().len()), (2, 3));
        log.add(vec![Message::remark("three"); CAPACITY]);
        assert_eq!((log.shown.len(), log.said().len()), (3, CAPACITY));
    }
}
