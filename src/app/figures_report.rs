//! The sweeps of the open map: one along each axis, at most one of them under way, and the files they are saved to.

use std::path::PathBuf;
use std::sync::Arc;

use super::figures_file::{Content, FileKind, Target};
use crate::gpu::Gpu;
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::measure::{Axis, Metric, Sweep, SweepRun};
use crate::session::{Message, Session};

/// What was measured of the open map, kept up to date by [`FiguresReport::poll`].
pub struct FiguresReport {
    gpu: Gpu,
    wake: Wake,
    /// The last sweep along each axis, the latest started last.
    runs: Vec<SweepRun>,
    saving: Option<Job<Saved>>,
}

/// The path that was written, a sentence why it was not, or nothing where the dialog was dismissed.
type Saved = Option<Result<PathBuf, String>>;

impl FiguresReport {
    /// Nothing measured yet. Measures on `gpu`, and calls `wake` when there are news.
    pub fn new(gpu: Gpu, wake: Wake) -> Self {
        Self { gpu, wake, runs: Vec::new(), saving: None }
    }

    /// Measures on another device from now on; a sweep under way ends, and what it found stays.
    pub fn move_to(&mut self, gpu: Gpu, wake: Wake) {
        self.cancel();
        (self.gpu, self.wake) = (gpu, wake);
    }

    /// The last sweep along an axis.
    pub fn run(&self, axis: Axis) -> Option<&SweepRun> {
        self.runs.iter().find(|run| run.sweep().axis == axis)
    }

    /// True while a sweep is under way.
    pub fn is_running(&self) -> bool {
        self.runs.iter().any(SweepRun::is_running)
    }

    /// True while a file is being asked for or written.
    pub fn is_saving(&self) -> bool {
        self.saving.is_some()
    }

    /// Starts a sweep; the one under way ends, and what the axis had goes.
    pub fn start(&mut self, session: &Session, sweep: Sweep) -> Result<(), Message> {
        self.cancel();
        let axis = sweep.axis;
        let run = SweepRun::start(session, sweep, &self.gpu, &self.wake).map_err(Message::error)?;
        self.runs.retain(|run| run.sweep().axis != axis);
        self.runs.push(run);
        Ok(())
    }

    /// Ends the sweep under way; what it found stays.
    pub fn cancel(&mut self) {
        self.runs.iter_mut().for_each(SweepRun::cancel);
    }

    /// Saves the figures along an axis; `metric` is what a picture shows.
    pub fn save(&mut self, axis: Axis, metric: Metric, target: Target) -> Result<(), Message> {
        let kind = match &target {
            Target::Dialog(kind) => *kind,
            Target::Path(path) => FileKind::of(path).ok_or_else(|| {
                let name = path.display();
                Message::error(format!("'{name}' tells no kind of file: end it in .csv, .json or .png."))
            })?,
        };
        let run = self.run(axis).ok_or_else(|| Message::error("There are no figures to save yet."))?;
        let content = Content::new(run, metric, kind).map_err(Message::error)?;
        let name = format!("{}-{}.{}", run.map(), axis.name(), kind.ending());
        let gpu = self.gpu.clone();
        let work = move |outbox: &Outbox<Saved>| {
            let path = match target {
                Target::Path(path) => Some(path),
                Target::Dialog(kind) => ask(kind, &name),
            };
            outbox.send(path.map(|path| content.write(&path, &gpu).map(|()| path)));
        };
        let job = Job::spawn("save-figures", Arc::clone(&self.wake), work);
        self.saving = Some(job.map_err(|error| Message::error(format!("The figures cannot be saved: {error}.")))?);
        Ok(())
    }

    /// Takes the jobs' news; sentences for the user go to `messages`.
    pub fn poll(&mut self, messages: &mut Vec<Message>) {
        let mut sentences = Vec::new();
        for run in &mut self.runs {
            run.poll(&mut sentences);
        }
        messages.extend(sentences.into_iter().map(Message::error));
        if let Some(event) = self.saving.as_ref().and_then(Job::next) {
            self.saving = None;
            messages.extend(match event {
                JobEvent::News(saved) => saved.map(told),
                JobEvent::Panicked(text) => Some(Message::error(format!("The figures were not saved: {text}."))),
            });
        }
    }
}

fn ask(kind: FileKind, name: &str) -> Option<PathBuf> {
    let dialog = rfd::FileDialog::new().set_title("Save figures").set_file_name(name);
    dialog.add_filter(kind.label(), &[kind.ending()]).save_file()
}

fn told(saved: Result<PathBuf, String>) -> Message {
    match saved {
        Ok(path) => Message::remark(format!("The figures are in '{}'.", path.display())),
        Err(sentence) => Message::error(sentence),
    }
}
