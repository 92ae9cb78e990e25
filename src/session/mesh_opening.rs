//! Meshes read in the background, and the system's file dialog for them.

use std::path::PathBuf;
use std::sync::Arc;

use super::Message;
use crate::jobs::{Job, JobEvent, Wake};
use crate::scene::{Model, import};

enum News {
    Read(Model),
    Failed(String),
    Dismissed,
}

/// The job that reads a mesh, if one runs.
#[derive(Default)]
pub struct MeshOpening {
    job: Option<Job<News>>,
}

impl MeshOpening {
    /// True while a mesh is being read or asked for.
    pub fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Starts reading; an earlier request is dropped. `Err` is a sentence for the user.
    pub fn start(&mut self, path: PathBuf, wake: &Wake) -> Result<(), String> {
        self.spawn("open-mesh", wake, move || read(path))
    }

    /// Asks for a file, then reads it. `Err` is a sentence for the user.
    pub fn start_dialog(&mut self, wake: &Wake) -> Result<(), String> {
        self.spawn("open-mesh-dialog", wake, || {
            let dialog = rfd::FileDialog::new().set_title("Open a mesh").add_filter("Meshes", &import::EXTENSIONS);
            dialog.pick_file().map_or(News::Dismissed, read)
        })
    }

    fn spawn(&mut self, name: &str, wake: &Wake, work: impl FnOnce() -> News + Send + 'static) -> Result<(), String> {
        let job = Job::spawn(name, Arc::clone(wake), move |outbox| outbox.send(work()));
        self.job =
            Some(job.map_err(|error| format!("The mesh cannot be opened: no thread could be started ({error})."))?);
        Ok(())
    }

    /// Takes a mesh that was read, or what the user should know.
    pub fn poll(&mut self) -> Option<Result<Model, Message>> {
        let event = self.job.as_ref().and_then(Job::next)?;
        self.job = None;
        match event {
            JobEvent::News(News::Read(model)) => Some(Ok(model)),
            JobEvent::News(News::Failed(sentence)) => Some(Err(Message::error(sentence))),
            JobEvent::News(News::Dismissed) => None,
            JobEvent::Panicked(text) => Some(Err(Message::error(format!("The mesh could not be opened: {text}.")))),
        }
    }
}

fn read(path: PathBuf) -> News {
    match Model::read(&path) {
        Ok(model) => News::Read(model),
        Err(error) => News::Failed(error.to_string()),
    }
}
