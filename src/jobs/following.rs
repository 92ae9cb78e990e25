//! Work that follows a key, such as the selected texel and what is asked of it: it starts anew when the key changes.
//!
//! At most one piece of work runs at a time, so that a key that changes with every frame piles up no threads: what runs
//! for another key is cancelled, and the next starts once it has ended.

use std::sync::Arc;

use super::{Job, JobEvent, Outbox, Wake};
use crate::filter::vmf::{Cancelled, Monitor};

/// The work of the latest key.
pub struct Following<K, E> {
    key: Option<K>,
    running: Option<Running<E>>,
}

struct Running<E> {
    /// Ends with `None`.
    job: Job<Option<E>>,
    monitor: Arc<Monitor>,
}

impl<E> Drop for Running<E> {
    fn drop(&mut self) {
        // A job that nobody listens to must not go on using the cores.
        self.monitor.cancel();
    }
}

impl<K, E> Default for Following<K, E> {
    fn default() -> Self {
        Self { key: None, running: None }
    }
}

impl<K: PartialEq, E: Send + 'static> Following<K, E> {
    /// True when the work of `key` is to be started by [`Self::start`]: it is not what was started last, and that has
    /// ended, if need be because it was cancelled here. Call once per frame.
    pub fn is_due(&mut self, key: &K) -> bool {
        if self.is_of(key) {
            return false;
        }
        if let Some(running) = &self.running {
            running.monitor.cancel();
        }
        while self.take().is_some() {}
        self.running.is_none()
    }

    /// Starts the work of `key`; `work` sends what it finds, and ends early once the monitor, which counts nothing
    /// unless it `expected` something, is cancelled.
    pub fn start(
        &mut self,
        name: &str,
        (key, expected): (K, Vec<u64>),
        wake: &Wake,
        work: impl FnOnce(&dyn Fn(E), &Monitor) -> Result<(), Cancelled> + Send + 'static,
    ) {
        let monitor = Arc::new(Monitor::new(expected));
        let watched = Arc::clone(&monitor);
        let job = Job::spawn(name, Arc::clone(wake), move |outbox: &Outbox<Option<E>>| {
            if work(&|event| outbox.send(Some(event)), &watched).is_err() {
                log::debug!("the work was not wanted any more");
            }
            outbox.send(None);
        });
        self.key = Some(key);
        match job {
            Ok(job) => self.running = Some(Running { job, monitor }),
            Err(error) => log::warn!("{name} cannot start: {error}"),
        }
    }

    /// The next thing that was found, if any.
    pub fn take(&mut self) -> Option<E> {
        match self.running.as_ref()?.job.next()? {
            JobEvent::News(Some(event)) => return Some(event),
            JobEvent::News(None) => {}
            JobEvent::Panicked(text) => log::warn!("the work stopped by a fault of the program: {text}"),
        }
        self.running = None;
        None
    }

    /// True where `key` is what was started last.
    pub fn is_of(&self, key: &K) -> bool {
        self.key.as_ref() == Some(key)
    }

    /// How far the work is, while it runs.
    pub fn progress(&self) -> Option<&Monitor> {
        self.running.as_ref().map(|running| &*running.monitor)
    }

    /// True while the work runs.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    /// Follows `key` until something is found; the work finds the key itself, once it may.
    fn found(following: &mut Following<u32, u32>, key: u32, endless: bool) -> Option<u32> {
        let wake: Wake = Arc::new(|| {});
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(10) {
            if following.is_due(&key) {
                following.start("follows", (key, Vec::new()), &wake, move |send, monitor| {
                    send(key);
                    if !endless {
                        return Ok(());
                    }
                    loop {
                        monitor.check()?;
                        std::thread::yield_now();
                    }
                });
            }
            if let Some(event) = following.take() {
                return Some(event);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        None
    }

    #[test]
    fn another_key_ends_the_work_and_starts_its_own() {
        let mut following = Following::default();
        assert_eq!(found(&mut following, 1, true), Some(1));
        assert!(following.is_running() && !following.is_due(&1));
        assert_eq!(found(&mut following, 2, false), Some(2), "the first never ends by itself");
        while following.is_running() {
            assert_eq!(following.take(), None);
        }
        assert!(following.is_of(&2) && !following.is_due(&2));
    }
}
