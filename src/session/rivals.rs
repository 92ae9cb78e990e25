//! The channels of the rivals on show, built in the background and kept as long as they are shown.

use std::sync::Arc;
use std::time::Duration;

use rayon::ThreadPool;

use super::Message;
use crate::filter::channels::ChannelPyramid;
use crate::filter::rival::{Rival, Source};
use crate::filter::vmf::{Cancelled, Monitor, Rules};
use crate::filter::{Method, PlainMip};
use crate::jobs::{self, Ended, Job, JobEvent, Wake};

type Built = Option<Arc<ChannelPyramid>>;

/// The rivals that have channels and are shown.
#[derive(Default)]
pub struct Rivals {
    shown: Vec<Shown>,
    pool: Option<Arc<ThreadPool>>,
}

struct Shown {
    rival: Rival,
    mip: Arc<PlainMip>,
    state: State,
}

enum State {
    Building(Building),
    Built(Built),
    /// A fault of the program, which was told.
    Failed,
}

struct Building {
    job: Job<Built>,
    monitor: Arc<Monitor>,
}

impl Drop for Building {
    fn drop(&mut self) {
        // A job that nobody listens to must not go on using the cores.
        self.monitor.cancel();
    }
}

impl Rivals {
    /// The channels of a method, once they are built.
    pub fn channels(&self, method: Method) -> Option<&Arc<ChannelPyramid>> {
        let shown = self.shown.iter().find(|shown| method.rival() == Some(shown.rival))?;
        match &shown.state {
            State::Built(channels) => channels.as_ref(),
            State::Building(_) | State::Failed => None,
        }
    }

    /// True while channels are being built.
    pub fn is_building(&self) -> bool {
        self.shown.iter().any(|shown| matches!(shown.state, State::Building(_)))
    }

    /// Starts what `methods` of the map of `mip` need, drops the rest, and takes the jobs' news; true if anything
    /// changed.
    pub fn update(
        &mut self,
        methods: &[Method],
        mip: impl Fn() -> Arc<PlainMip>,
        wake: &Wake,
        messages: &mut Vec<Message>,
    ) -> bool {
        let rivals = methods.iter().copied().filter_map(Method::rival);
        let wanted: Vec<Rival> = rivals.filter(|rival| rival.kind.has_channels && rival.is_drawn()).collect();
        if wanted.is_empty() {
            let had = !self.shown.is_empty();
            self.shown.clear();
            return had;
        }
        let mip = mip();
        self.shown.retain(|shown| wanted.contains(&shown.rival) && Arc::ptr_eq(&shown.mip, &mip));
        for rival in wanted {
            if self.shown.iter().all(|shown| shown.rival != rival) {
                let state = match self.start(rival, &mip, wake) {
                    Ok(building) => State::Building(building),
                    Err(error) => {
                        messages.push(Message::error(format!("{rival} cannot be built: {error}.")));
                        State::Failed
                    }
                };
                self.shown.push(Shown { rival, mip: Arc::clone(&mip), state });
            }
        }
        self.shown.iter_mut().any(|shown| shown.poll(messages))
    }

    /// Waits up to `timeout` for the next news of a build; [`Rivals::update`] takes what follows.
    pub fn wait(&mut self, timeout: Duration, messages: &mut Vec<Message>) {
        for shown in &mut self.shown {
            if let State::Building(building) = &shown.state {
                let event = building.job.wait(timeout);
                shown.take(event, messages);
                return;
            }
        }
    }

    fn start(&mut self, rival: Rival, mip: &Arc<PlainMip>, wake: &Wake) -> Result<Building, String> {
        let pool = match &self.pool {
            Some(pool) => Arc::clone(pool),
            None => Arc::new(jobs::fit_pool(None).map_err(|error| error.to_string())?),
        };
        self.pool = Some(Arc::clone(&pool));
        let monitor = Arc::new(Monitor::new(Vec::new()));
        let (mip, watched) = (Arc::clone(mip), Arc::clone(&monitor));
        let job = Job::spawn(rival.kind.name, Arc::clone(wake), move |outbox| {
            let build = || {
                let filter = rival.build(&Source { mip: &mip, rules: Rules::default(), monitor: &watched })?;
                Ok(filter.channels(&watched)?.cloned())
            };
            match pool.install(build) {
                Ok(channels) => outbox.send(channels),
                Err(Cancelled) => log::debug!("{rival} is not wanted any more"),
            }
        });
        Ok(Building { job: job.map_err(|error| error.to_string())?, monitor })
    }
}

impl Shown {
    fn poll(&mut self, messages: &mut Vec<Message>) -> bool {
        let State::Building(building) = &self.state else { return false };
        let event = building.job.next();
        let changed = event.is_some();
        self.take(Ok(event), messages);
        changed
    }

    fn take(&mut self, event: Result<Option<JobEvent<Built>>, Ended>, messages: &mut Vec<Message>) {
        match event {
            Ok(None) => {}
            Ok(Some(JobEvent::News(channels))) => self.state = State::Built(channels),
            Ok(Some(JobEvent::Panicked(text))) => {
                messages.push(Message::error(format!("{} stopped by a fault of the program: {text}.", self.rival)));
                self.state = State::Failed;
            }
            Err(Ended) => self.state = State::Failed,
        }
    }
}
