//! Measured reflectance read in the background, and the system's file dialog for it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{Message, Session};
use crate::brdf::{Brdf, Measured, Merl, MerlError};
use crate::image_io::{self, ReadImageError};
use crate::jobs::{Job, JobEvent, Wake};

/// Why a measured reflectance could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadMeasuredError {
    /// The file could not be read at all.
    #[error(transparent)]
    File(#[from] ReadImageError),
    /// It is no measured reflectance.
    #[error(transparent)]
    Merl(#[from] MerlError),
}

/// Reads a file and factors it, in about a fifth of a second.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn read(path: &Path) -> Result<Measured, ReadMeasuredError> {
    let bytes = image_io::read_bytes(path)?;
    let name = path.display().to_string();
    Ok(Measured::new(&name, &Merl::from_bytes(&name, &bytes)?))
}

/// What reading came to; `None` where the dialog was closed.
type News = Option<Result<Measured, ReadMeasuredError>>;

/// The job that reads a measured reflectance, if one runs.
#[derive(Default)]
pub struct Measuring {
    job: Option<Job<News>>,
    /// True where the material is of a session file: it has its model and its strengths.
    restores: bool,
}

impl Measuring {
    fn spawn(&mut self, wake: &Wake, work: impl FnOnce() -> News + Send + 'static) -> Result<(), Message> {
        let job = Job::spawn("read-reflectance", Arc::clone(wake), move |outbox| outbox.send(work()));
        let job = job.map_err(|error| Message::error(format!("No thread could be started ({error}).")))?;
        *self = Self { job: Some(job), restores: false };
        Ok(())
    }

    /// Takes what was read, or what the user should know.
    fn poll(&mut self) -> Option<Result<Measured, Message>> {
        let event = self.job.as_ref().and_then(Job::next)?;
        self.job = None;
        match event {
            JobEvent::News(news) => news.map(|read| read.map_err(|error| Message::error(error.to_string()))),
            JobEvent::Panicked(text) => Some(Err(Message::error(format!("Nothing could be read: {text}.")))),
        }
    }
}

impl Session {
    /// True while a measured reflectance is being read or asked for.
    pub fn is_measuring(&self) -> bool {
        self.measuring.job.is_some()
    }

    /// Reads a measured reflectance in the background; the material becomes it.
    pub fn open_measured(&mut self, path: PathBuf) {
        self.read_measured(move || Some(read(&path)));
    }

    /// Asks for a file, then does the same.
    pub fn open_measured_dialog(&mut self) {
        self.read_measured(|| {
            let dialog = rfd::FileDialog::new().set_title("Open a measured reflectance");
            dialog.add_filter("MERL", &["binary"]).pick_file().map(|path| read(&path))
        });
    }

    /// Reads the one that the material of a session file names.
    pub(super) fn restore_measured(&mut self, path: PathBuf) {
        self.open_measured(path);
        self.measuring.restores = true;
    }

    fn read_measured(&mut self, work: impl FnOnce() -> News + Send + 'static) {
        if let Err(message) = self.measuring.spawn(&self.wake, work) {
            self.report(message);
        }
    }

    /// Takes up what was read; true if anything was.
    pub(super) fn poll_measured(&mut self) -> bool {
        let Some(news) = self.measuring.poll() else { return false };
        let material = &mut self.surface.material;
        match news {
            Ok(measured) if self.measuring.restores => material.measured = Some(measured),
            Ok(measured) => material.set_brdf(Brdf::Measured(measured)),
            Err(message) => self.report(message),
        }
        true
    }
}
