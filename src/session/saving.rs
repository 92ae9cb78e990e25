//! Session files written in the background.

use std::path::PathBuf;
use std::sync::Arc;

use super::file::SessionFile;
use super::{Message, Session};
use crate::jobs::{Job, JobEvent};
use crate::normal_map::MapSource;

/// The path that was written, a sentence why it was not, or nothing where the dialog was dismissed.
type Saved = Option<Result<PathBuf, String>>;

/// The job that writes a session file, if one runs.
#[derive(Default)]
pub struct Saving {
    job: Option<Job<Saved>>,
}

impl Session {
    /// Writes `file`, what the window shows, to `path`, which then is the open session file.
    pub fn save(&mut self, file: SessionFile, path: PathBuf) {
        self.start_saving(move || Some(write(&file, path)));
    }

    /// Asks in the system's dialog where to write `file`.
    pub fn save_dialog(&mut self, file: SessionFile) {
        let suggested = self.suggested_path();
        self.start_saving(move || {
            let name = suggested.file_name().unwrap_or_default().to_string_lossy();
            let dialog = rfd::FileDialog::new().set_title("Save the session").set_file_name(name);
            let dialog = match suggested.parent() {
                Some(folder) => dialog.set_directory(folder),
                None => dialog,
            };
            dialog.add_filter("Sessions", &["json"]).save_file().map(|path| write(&file, path))
        });
    }

    /// Where the session is saved unless another path is chosen: its own file, or one beside its map.
    pub fn suggested_path(&self) -> PathBuf {
        self.path.clone().unwrap_or_else(|| match &self.map.source {
            MapSource::File(map) => map.with_extension(&SessionFile::ENDING[1..]),
            MapSource::Bundled(name) => PathBuf::from(format!("{name}{}", SessionFile::ENDING)),
        })
    }

    fn start_saving(&mut self, work: impl FnOnce() -> Saved + Send + 'static) {
        match Job::spawn("save-session", Arc::clone(&self.wake), move |outbox| outbox.send(work())) {
            Ok(job) => self.saving.job = Some(job),
            Err(error) => self.report(Message::error(format!("The session cannot be saved: {error}."))),
        }
    }

    /// True while a session file is being written.
    pub fn is_saving(&self) -> bool {
        self.saving.job.is_some()
    }

    /// Takes the news of what is being saved; true if there were any.
    pub(super) fn poll_saving(&mut self) -> bool {
        let Some(event) = self.saving.job.as_ref().and_then(Job::next) else { return false };
        self.saving.job = None;
        match event {
            JobEvent::News(None) => {}
            JobEvent::News(Some(Ok(path))) => {
                self.report(Message::remark(format!("The session is in '{}'.", path.display())));
                if let Err(error) = self.recent.push(&path) {
                    log::warn!("{error}");
                }
                self.path = Some(path);
            }
            JobEvent::News(Some(Err(sentence))) => self.report(Message::error(sentence)),
            JobEvent::Panicked(text) => self.report(Message::error(format!("The session was not saved: {text}."))),
        }
        true
    }
}

fn write(file: &SessionFile, path: PathBuf) -> Result<PathBuf, String> {
    file.write(&path).map(|()| path).map_err(|error| error.to_string())
}
