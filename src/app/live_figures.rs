//! The figures of the methods on show, against the truth as it is drawn: worked out in a job whenever a picture that
//! they depend on has come back, or another region is chosen.

use std::sync::Arc;

use super::viewport::SurfaceReport;
use crate::filter::Method;
use crate::gpu::snapshots::{Snapshot, Snapshots};
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::reference::{Compared, Figures, Picture, Region, standard_error_of};

/// What figures are worked out from.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    snapshots: Snapshots,
    exposure: f32,
    region: Option<Region>,
}

impl Task {
    /// The pictures that the last frame left, where all are here, under this exposure; the whole of them, or a region.
    pub fn new(report: &SurfaceReport, region: Option<Region>) -> Option<Self> {
        let exposure = report.subject.as_ref()?.surface.exposure();
        let snapshots = report.snapshots.clone();
        (snapshots.truth.is_some() && snapshots.are_ready()).then_some(Self { snapshots, exposure, region })
    }
}

/// What was worked out.
#[derive(Debug)]
struct Found {
    task: Task,
    /// Kept for the next region.
    compared: Vec<Compare>,
    figures: Vec<(Method, Figures)>,
    standard_error: Option<f64>,
}

/// A method's picture beside the truth.
#[derive(Clone, Debug)]
struct Compare {
    of: Snapshot,
    truth: Snapshot,
    exposure: f32,
    pictures: Arc<Compared>,
}

/// The figures of what is on show, kept up to date by [`LiveFigures::update`].
#[derive(Default)]
pub struct LiveFigures {
    asked: Option<Task>,
    found: Option<Found>,
    job: Option<Job<Result<Found, String>>>,
    is_current: bool,
}

impl LiveFigures {
    /// The last figures of a method; `None` before there are any.
    pub fn of(&self, method: Method) -> Option<Figures> {
        let figures = &self.found.as_ref()?.figures;
        figures.iter().find(|(other, _)| *other == method).map(|(_, figures)| *figures)
    }

    /// The truth's own standard error, as a normalised colour error.
    pub fn standard_error(&self) -> Option<f64> {
        self.found.as_ref()?.standard_error
    }

    /// True where the figures are those of the pictures that the last frame left.
    pub fn is_current(&self) -> bool {
        self.is_current
    }

    /// True where nothing is left to be worked out for this task.
    pub fn is_done(&self, task: Option<&Task>) -> bool {
        self.job.is_none() && (task.is_none() || self.asked.as_ref() == task)
    }

    /// Takes the job's news and starts what is due, one job at a time. Call once per frame.
    pub fn update(&mut self, task: Option<Task>, wake: &Wake) {
        self.poll();
        self.is_current = task.is_some() && self.found.as_ref().map(|found| &found.task) == task.as_ref();
        let Some(task) = task.filter(|task| self.job.is_none() && self.asked.as_ref() != Some(task)) else { return };
        let kept = self.found.as_ref().map(|found| found.compared.clone()).unwrap_or_default();
        self.asked = Some(task.clone());
        let work = move |outbox: &Outbox<_>| outbox.send(work(task, kept));
        match Job::spawn("live-figures", Arc::clone(wake), work) {
            Ok(job) => self.job = Some(job),
            Err(error) => log::warn!("the figures on the picture cannot be worked out: {error}"),
        }
    }

    fn poll(&mut self) {
        match self.job.as_ref().and_then(Job::next) {
            Some(JobEvent::News(Ok(found))) => self.found = Some(found),
            Some(JobEvent::News(Err(text)) | JobEvent::Panicked(text)) => {
                log::warn!("the figures on the picture were not worked out: {text}");
            }
            None => return,
        }
        self.job = None;
    }
}

/// Compares every method with the truth; what was `kept` of the same pictures is not compared again.
fn work(task: Task, kept: Vec<Compare>) -> Result<Found, String> {
    let truth = task.snapshots.truth.clone().ok_or("there is no truth")?;
    let seen = truth.readback.picture()?;
    let mut found = Found { compared: Vec::new(), figures: Vec::new(), standard_error: None, task };
    found.standard_error = standard_error(&found.task, &seen)?;
    let exposure = found.task.exposure;
    for of in &found.task.snapshots.methods {
        let is_same = |kept: &&Compare| kept.of == *of && kept.truth == truth && kept.exposure == exposure;
        let pictures = match kept.iter().find(is_same) {
            Some(kept) => Arc::clone(&kept.pictures),
            None => Arc::new(Compared::new(of.readback.picture()?.exposed(exposure), seen.exposed(exposure))),
        };
        found.figures.push((of.method, pictures.figures(found.task.region)));
        found.compared.push(Compare { of: of.clone(), truth: truth.clone(), exposure, pictures });
    }
    Ok(found)
}

/// The truth's standard error, of the region or the whole, from its picture at an earlier stop.
fn standard_error(task: &Task, seen: &Picture) -> Result<Option<f64>, String> {
    let (Some(earlier), Some(truth)) = (&task.snapshots.earlier_truth, &task.snapshots.truth) else { return Ok(None) };
    let part = earlier.readback.picture()?;
    let within = task.region.map(|region| seen.within(region));
    let whole = (within.as_ref().unwrap_or(seen), truth.samples);
    Ok(standard_error_of((&*part, earlier.samples), whole))
}
