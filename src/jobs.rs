//! The only threads: named background jobs and the thread pool that fits run on.
//!
//! A job sends events to its owner and wakes the window for each. A panic inside a job becomes an event with the
//! panic's message; the owner and the window live on.

pub mod following;

pub mod panic_report;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use thread_priority::{ThreadPriority, ThreadPriorityValue, set_current_thread_priority};

/// Called from any thread when an event waits for the owner.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// What a job tells its owner.
#[derive(Debug)]
pub enum JobEvent<E> {
    /// News of its own kind.
    News(E),
    /// The job panicked with this message and has ended.
    Panicked(String),
}

/// Where a job puts its events.
pub struct Outbox<E> {
    sender: Sender<JobEvent<E>>,
    wake: Wake,
}

impl<E> Outbox<E> {
    /// Sends an event and wakes the owner. An owner that has dropped the job hears nothing more.
    pub fn send(&self, event: E) {
        self.post(JobEvent::News(event));
    }

    fn post(&self, event: JobEvent<E>) {
        if self.sender.send(event).is_ok() {
            (self.wake)();
        }
    }
}

/// A running background job. Dropping it drops its later events, so a stale result never appears.
#[derive(Debug)]
pub struct Job<E> {
    events: Receiver<JobEvent<E>>,
}

impl<E: Send + 'static> Job<E> {
    /// Runs `work` on a thread of this name.
    pub fn spawn(name: &str, wake: Wake, work: impl FnOnce(&Outbox<E>) + Send + 'static) -> std::io::Result<Self> {
        let (sender, events) = channel();
        let outbox = Outbox { sender, wake };
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work(&outbox))) {
                outbox.post(JobEvent::Panicked(panic_message(panic.as_ref())));
            }
        })?;
        Ok(Self { events })
    }

    /// The next event that waits, if any.
    pub fn next(&self) -> Option<JobEvent<E>> {
        self.events.try_recv().ok()
    }

    /// Waits up to `timeout` for an event; `Err` once the job has ended and every event was taken.
    pub fn wait(&self, timeout: Duration) -> Result<Option<JobEvent<E>>, Ended> {
        match self.events.recv_timeout(timeout) {
            Ok(event) => Ok(Some(event)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(Ended),
        }
    }
}

/// The job has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ended;

/// What the panic said, and where its report is, if there is one.
fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned());
    match panic_report::take_last() {
        Some(path) => format!("{text} (a report is in '{}')", path.display()),
        None => text,
    }
}

/// The priority of fit threads, 0..=99: about a third of the normal one, which Linux takes as niceness 7. Where the
/// processor draws too, a frame then has five times a fit's share of a core; at the lowest priority the fit starves
/// as long as anything moves.
const FIT_PRIORITY: u8 = 32;

/// A pool for fits: every core (or `threads` of them), at a low priority, so that a window stays fluent while all
/// cores fit.
pub fn fit_pool(threads: Option<usize>) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .thread_name(|index| format!("fit-{index}"))
        .start_handler(|_| {
            let priority = ThreadPriorityValue::try_from(FIT_PRIORITY).map(ThreadPriority::Crossplatform);
            if let Err(error) = set_current_thread_priority(priority.unwrap_or(ThreadPriority::Min)) {
                log::debug!("a fit thread keeps its normal priority: {error:?}");
            }
        })
        .build()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_a_job_is_an_event_and_not_the_end() {
        let job = Job::<()>::spawn("panics", Arc::new(|| {}), |_| panic!("on purpose")).expect("a thread");
        let event = job.wait(Duration::from_secs(10)).expect("still there");
        assert!(matches!(event, Some(JobEvent::Panicked(text)) if text == "on purpose"));
    }
}
