//! The document kept on disk while it changes, so that the next start, after a crash too, goes on where this one was.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::jobs::{Job, JobEvent, Wake};
use crate::session::file::{SessionFile, SessionFileError};
use crate::session::recent::{make_folder_of, user_folder};

/// From a change to its being written, so that a row of changes is written once.
const PAUSE: Duration = Duration::from_secs(2);

/// What is kept, where, and how far it is.
#[derive(Default)]
pub struct Autosave {
    store: Option<PathBuf>,
    written: Option<(SessionFile, Option<PathBuf>)>,
    changed_at: Option<Instant>,
    job: Option<Job<Result<(), SessionFileError>>>,
}

/// The file that keeps the document of the last run; `None` on a system without a folder for the user's settings.
fn user_store() -> Option<PathBuf> {
    user_folder().map(|folder| folder.join(format!("last{}", SessionFile::ENDING)))
}

/// What the last run kept, if there was one. It belongs to the file that it was saved to, if it was to any.
///
/// # Errors
/// A sentence that names the file and the cause.
pub fn last_run() -> Option<Result<SessionFile, SessionFileError>> {
    let store = user_store().filter(|store| store.exists())?;
    Some(SessionFile::read(&store).map(|file| SessionFile { path: file.saved_as, saved_as: None, ..file }))
}

impl Autosave {
    /// Keeps the document in the user's folder.
    pub fn of_user() -> Self {
        user_store().map(Self::at).unwrap_or_default()
    }

    /// Keeps the document in a file, whose folder is made where it is missing.
    fn at(store: PathBuf) -> Self {
        make_folder_of(&store);
        Self { store: Some(store), ..Self::default() }
    }

    /// Writes the document, which is saved to `saved_as`, in the background, a little after it has changed; asks for a
    /// pass of the window then, and for none otherwise.
    pub fn update(&mut self, now: &SessionFile, saved_as: Option<&Path>, ctx: &egui::Context, wake: &Wake) {
        let Some(store) = self.store.clone() else { return };
        self.poll();
        if self.has_written(now, saved_as) {
            self.changed_at = None;
            return;
        }
        let age = self.changed_at.get_or_insert_with(Instant::now).elapsed();
        if age < PAUSE || self.job.is_some() {
            ctx.request_repaint_after(PAUSE.saturating_sub(age).max(Duration::from_millis(100)));
            return;
        }
        let file = SessionFile { saved_as: absolute(saved_as), ..now.clone() };
        self.written = Some((now.clone(), saved_as.map(Path::to_owned)));
        self.changed_at = None;
        match Job::spawn("autosave", Arc::clone(wake), move |outbox| outbox.send(file.write(&store))) {
            Ok(job) => self.job = Some(job),
            Err(error) => log::warn!("the session is not kept: {error}"),
        }
    }

    fn has_written(&self, now: &SessionFile, saved_as: Option<&Path>) -> bool {
        self.written.as_ref().is_some_and(|(file, path)| file == now && path.as_deref() == saved_as)
    }

    fn poll(&mut self) {
        let Some(event) = self.job.as_ref().and_then(Job::next) else { return };
        self.job = None;
        match event {
            JobEvent::News(Ok(())) => {}
            JobEvent::News(Err(error)) => log::warn!("{error}"),
            JobEvent::Panicked(text) => log::warn!("the session is not kept: {text}"),
        }
    }

    /// Writes the document now, where it has changed: the window closes.
    pub fn finish(&mut self, now: &SessionFile, saved_as: Option<&Path>) {
        let Some(store) = &self.store else { return };
        let file = SessionFile { saved_as: absolute(saved_as), ..now.clone() };
        if !self.has_written(now, saved_as)
            && let Err(error) = file.write(store)
        {
            log::warn!("{error}");
        }
    }
}

/// A path that is the same from any folder.
fn absolute(path: Option<&Path>) -> Option<PathBuf> {
    path.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_written_after_a_pause_and_only_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let store = folder.path().join("last.ndfi.json");
        let mut autosave = Autosave { store: Some(store.clone()), ..Autosave::default() };
        let (ctx, wake) = (egui::Context::default(), Arc::new(|| {}) as Wake);
        let file = SessionFile { truth_samples: Some(77), ..SessionFile::default() };
        autosave.update(&file, None, &ctx, &wake);
        assert!(autosave.job.is_none() && autosave.changed_at.is_some(), "written at once");
        autosave.changed_at = Instant::now().checked_sub(PAUSE);
        autosave.update(&file, None, &ctx, &wake);
        let job = autosave.job.take().expect("it is being written");
        assert!(matches!(job.wait(Duration::from_secs(10)), Ok(Some(JobEvent::News(Ok(()))))));
        assert_eq!(SessionFile::read(&store).expect("read").truth_samples, Some(77));
        autosave.update(&file, None, &ctx, &wake);
        assert!(autosave.job.is_none() && autosave.changed_at.is_none(), "nothing has changed");
    }

    #[test]
    fn what_changed_last_is_written_when_the_window_closes() {
        let folder = tempfile::tempdir().expect("a folder");
        // As on the first start.
        let store = folder.path().join("config/ndf-inspector/last.ndfi.json");
        let mut autosave = Autosave::at(store.clone());
        let mine = folder.path().join("mine.ndfi.json");
        std::fs::write(&mine, "{}").expect("written");
        autosave.finish(&SessionFile { truth_samples: Some(78), ..SessionFile::default() }, Some(&mine));
        let read = SessionFile::read(&store).expect("read");
        assert_eq!(read.truth_samples, Some(78));
        // Paths in it are relative to it, and found again from anywhere.
        let found = read.saved_as.and_then(|path| path.canonicalize().ok());
        assert_eq!(found, mine.canonicalize().ok());
        assert!(found.is_some());
    }
}
