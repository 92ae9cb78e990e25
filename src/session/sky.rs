//! Skies read in the background; the one that lights stays until the next is there.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Message, Session};
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::lighting::{Environment, SkySource};

enum News {
    Read(Box<Environment>),
    Failed(String),
    Dismissed,
}

/// The job that reads a sky, if one runs.
#[derive(Default)]
pub struct SkyOpening {
    job: Option<Job<News>>,
}

impl SkyOpening {
    fn spawn(&mut self, name: &str, wake: &Wake, work: impl FnOnce(&Outbox<News>) + Send + 'static) -> Option<Message> {
        match Job::spawn(name, Arc::clone(wake), work) {
            Ok(job) => self.job = Some(job),
            Err(error) => {
                let text = format!("The sky cannot be opened: no thread could be started ({error}).");
                return Some(Message::error(text));
            }
        }
        None
    }
}

fn read(source: &SkySource) -> News {
    source.load().map_or_else(|error| News::Failed(error.to_string()), |sky| News::Read(Box::new(sky)))
}

fn picked() -> Option<PathBuf> {
    rfd::FileDialog::new().set_title("Open a sky").add_filter("Skies", &["hdr", "exr", "HDR", "EXR"]).pick_file()
}

impl Session {
    /// Opens a sky in the background; an earlier request is dropped.
    pub fn open_sky(&mut self, source: SkySource) {
        let refused = self.sky_opening.spawn("open-sky", &self.wake, move |outbox| outbox.send(read(&source)));
        self.messages.extend(refused);
    }

    /// Asks for a file in the system's dialog, off the window's thread, then opens it.
    pub fn open_sky_dialog(&mut self) {
        let refused = self.sky_opening.spawn("open-sky-dialog", &self.wake, |outbox| {
            outbox.send(picked().map_or(News::Dismissed, |path| read(&SkySource::Path(path))));
        });
        self.messages.extend(refused);
    }

    /// True while a sky is being read or asked for.
    pub fn is_opening_sky(&self) -> bool {
        self.sky_opening.job.is_some()
    }

    /// Takes a sky that was read; true if anything changed.
    pub(super) fn poll_sky(&mut self) -> bool {
        let Some(event) = self.sky_opening.job.as_ref().and_then(Job::next) else { return false };
        self.sky_opening.job = None;
        match event {
            JobEvent::News(News::Read(sky)) => self.surface.sky.environment = Some(Arc::new(*sky)),
            JobEvent::News(News::Failed(sentence)) => self.report(Message::error(sentence)),
            JobEvent::News(News::Dismissed) => {}
            JobEvent::Panicked(text) => self.report(Message::error(format!("The sky could not be opened: {text}."))),
        }
        true
    }
}
