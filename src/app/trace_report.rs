//! How the selected texel's fit went: traced again in a job, while somebody looks and once per change.

use std::sync::Arc;

use crate::filter::vmf::trace::{Trace, trace};
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::normal_map::pyramid::Texel;
use crate::session::Session;
use crate::session::fitting::LevelState;

/// The trace of the selected texel, kept up to date by [`TraceReport::update`].
#[derive(Default)]
pub struct TraceReport {
    key: Option<(u64, u64, Texel)>,
    trace: Option<Trace>,
    job: Option<Job<Option<Trace>>>,
}

impl TraceReport {
    /// The trace; `None` while it is worked out, for a base texel and while the level is not fitted.
    pub fn trace(&self) -> Option<&Trace> {
        self.trace.as_ref()
    }

    /// True while it is worked out.
    pub fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Follows the session while `shown`. Call once per frame.
    pub fn update(&mut self, session: &Session, shown: bool, wake: &Wake) {
        if !shown {
            *self = Self::default();
            return;
        }
        self.poll();
        let texel = session.selected();
        let key = (session.map_revision(), session.fitting().revision(), texel);
        if self.key == Some(key) {
            return;
        }
        *self = Self { key: Some(key), ..Self::default() };
        if session.fitting().levels()[texel.level].state != LevelState::Done {
            return;
        }
        let (lobes, settings) = (Arc::clone(session.lobes()), *session.fit_settings());
        let work = move |outbox: &Outbox<Option<Trace>>| outbox.send(trace(&lobes, texel, &settings));
        match Job::spawn("trace-texel", Arc::clone(wake), work) {
            Ok(job) => self.job = Some(job),
            Err(error) => log::warn!("the texel's fit cannot be traced: {error}"),
        }
    }

    fn poll(&mut self) {
        match self.job.as_ref().and_then(Job::next) {
            Some(JobEvent::News(trace)) => self.trace = trace,
            Some(JobEvent::Panicked(text)) => log::warn!("the texel's fit was not traced: {text}"),
            None => return,
        }
        self.job = None;
    }
}
