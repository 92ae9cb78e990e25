//! A sweep in the background: a job of its own session on the device that is there, and what it has found so far.

use std::sync::Arc;
use std::time::Duration;

use super::findings::Findings;
use super::follower::{Finding, Follower, MeasureError};
use super::measurer::{Measurer, Point};
use super::sweep::{Axis, Sweep};
use crate::filter::MethodChoice;
use crate::filter::vmf::Monitor;
use crate::gpu::Gpu;
use crate::jobs::{Ended, Job, JobEvent, Outbox, Wake};
use crate::session::Session;

/// A sweep that runs, is done, or was cancelled: its findings stay.
pub struct SweepRun {
    sweep: Sweep,
    map: String,
    map_revision: u64,
    base: Point,
    findings: Findings,
    at: String,
    steps_done: usize,
    running: Option<Running>,
}

struct Running {
    job: Job<News>,
    monitor: Arc<Monitor>,
}

impl Drop for Running {
    fn drop(&mut self) {
        // A job that nobody listens to must not go on using the adapter.
        self.monitor.cancel();
    }
}

enum News {
    At(String),
    Found(Finding),
    Ended(Result<(), MeasureError>),
}

impl SweepRun {
    /// Starts to measure the session's map as it is shown now; what is done to the session later changes nothing.
    ///
    /// # Errors
    /// A sentence for the user.
    pub fn start(session: &Session, sweep: Sweep, gpu: &Gpu, wake: &Wake) -> Result<Self, String> {
        let base = base(session);
        let monitor = Arc::new(Monitor::new(Vec::new()));
        let fork = session.fork(sweep.axis == Axis::Alignment, Arc::new(|| {}));
        let (planned, points, gpu, watched) = (sweep.clone(), sweep.points(&base), gpu.clone(), Arc::clone(&monitor));
        let work = move |outbox: &Outbox<News>| {
            let mut session = fork;
            let mut telling = Telling { outbox, sweep: &planned, monitor: &watched, at: String::new() };
            let ended = Measurer::new(&gpu, &planned.settings).measure(&mut session, &points, &mut telling);
            outbox.send(News::Ended(ended));
        };
        let job = Job::spawn("measure-sweep", Arc::clone(wake), work)
            .map_err(|error| format!("The figures cannot be measured: {error}."))?;
        Ok(Self {
            findings: Findings::new(sweep.values.len(), sweep.settings.methods.len()),
            map: session.map().name(),
            map_revision: session.map_revision(),
            base,
            sweep,
            at: String::new(),
            steps_done: 0,
            running: Some(Running { job, monitor }),
        })
    }

    /// What is measured.
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// The name of the map that is measured.
    pub fn map(&self) -> &str {
        &self.map
    }

    /// What was open when it began.
    pub fn base(&self) -> &Point {
        &self.base
    }

    /// What was found so far.
    pub fn findings(&self) -> &Findings {
        &self.findings
    }

    /// True while it is under way.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Figures that are found, out of all.
    pub fn steps(&self) -> (usize, usize) {
        (self.steps_done, self.sweep.steps())
    }

    /// What is being measured now, in words.
    pub fn at(&self) -> &str {
        &self.at
    }

    /// True once every figure is found.
    pub fn is_complete(&self) -> bool {
        self.steps_done == self.sweep.steps()
    }

    /// True where the session shows another map, surface or fit by now, the varied quantity aside.
    pub fn is_stale(&self, session: &Session) -> bool {
        let axis = self.sweep.axis;
        let without = |point: &Point| axis.point(point, 1.0);
        self.map_revision != session.map_revision() || without(&self.base) != without(&base(session))
    }

    /// Ends it; what was found stays.
    pub fn cancel(&mut self) {
        self.running = None;
    }

    /// Takes the job's news; true if anything changed. Sentences for the user go to `messages`.
    pub fn poll(&mut self, messages: &mut Vec<String>) -> bool {
        let mut changed = false;
        while let Some(event) = self.running.as_ref().and_then(|running| running.job.next()) {
            changed = true;
            self.handle(event, messages);
        }
        changed
    }

    /// Waits up to `timeout` for the job's next news and takes them.
    pub fn wait(&mut self, timeout: Duration, messages: &mut Vec<String>) {
        match self.running.as_ref().map(|running| running.job.wait(timeout)) {
            Some(Ok(Some(event))) => self.handle(event, messages),
            Some(Err(Ended)) => self.running = None,
            Some(Ok(None)) | None => {}
        }
    }

    fn handle(&mut self, event: JobEvent<News>, messages: &mut Vec<String>) {
        match event {
            JobEvent::News(News::At(text)) => self.at = text,
            JobEvent::News(News::Found(finding)) => {
                self.steps_done += usize::from(matches!(finding, Finding::Method { .. }));
                self.findings.take(&finding);
            }
            JobEvent::News(News::Ended(ended)) => {
                messages.extend(ended.err().map(|error| format!("The figures are incomplete: {error}")));
                self.running = None;
            }
            JobEvent::Panicked(text) => {
                messages.push(format!("The figures are incomplete, by a fault of the program: {text}."));
                self.running = None;
            }
        }
    }
}

fn base(session: &Session) -> Point {
    Point { surface: session.surface.clone(), fit: *session.fit_settings() }
}

/// Tells the owner of a job.
struct Telling<'a> {
    outbox: &'a Outbox<News>,
    sweep: &'a Sweep,
    monitor: &'a Monitor,
    at: String,
}

impl Follower for Telling<'_> {
    fn begins(&mut self, method: MethodChoice, point: usize) {
        let Sweep { axis, values, .. } = self.sweep;
        self.at = format!("{} at {} {}", method.method.label(), axis.label(), values[point]);
        self.outbox.send(News::At(self.at.clone()));
    }

    fn waits(&mut self, session: &Session) {
        if let Some(progress) = session.fitting().progress() {
            self.outbox.send(News::At(format!("{}, fit {:.0} %", self.at, 100.0 * progress.fraction)));
        }
    }

    fn finds(&mut self, finding: Finding) {
        self.outbox.send(News::Found(finding));
    }

    fn is_cancelled(&self) -> bool {
        self.monitor.is_cancelled()
    }
}
