//! The open map's file, looked at once a second from a job, so that a map which another program writes is offered anew.

use std::path::Path;
use std::sync::{Arc, Weak};
use std::time::{Duration, SystemTime};

use crate::jobs::{Job, Outbox, Wake};

const INTERVAL: Duration = Duration::from_secs(1);

/// A file that is being looked at.
pub struct Watch {
    job: Job<()>,
    /// The job ends once this is gone.
    _alive: Arc<()>,
}

/// What tells one state of a file from another.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Stamp {
    modified: Option<SystemTime>,
    bytes: u64,
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        Some(Self { modified: metadata.modified().ok(), bytes: metadata.len() })
    }
}

impl Watch {
    /// Looks at a file from now on; `None` where it is none.
    pub fn start(path: &Path, wake: &Wake) -> Option<Self> {
        Self::every(INTERVAL, path, wake)
    }

    fn every(interval: Duration, path: &Path, wake: &Wake) -> Option<Self> {
        let (first, path, alive) = (Stamp::of(path)?, path.to_owned(), Arc::new(()));
        let living = Arc::downgrade(&alive);
        let job =
            Job::spawn("watch-map", Arc::clone(wake), move |outbox| look(&path, interval, first, &living, outbox));
        job.map_err(|error| log::warn!("the map's file is not watched: {error}"))
            .ok()
            .map(|job| Self { job, _alive: alive })
    }

    /// True once for every time that the file was written since.
    pub fn has_changed(&self) -> bool {
        self.job.next().is_some()
    }
}

/// Tells of every change, once it has lasted from one look to the next: a file is not read while it is written.
fn look(path: &Path, interval: Duration, first: Stamp, living: &Weak<()>, outbox: &Outbox<()>) {
    let (mut known, mut before) = (first, first);
    loop {
        std::thread::sleep(interval);
        if living.strong_count() == 0 {
            return;
        }
        let Some(now) = Stamp::of(path) else { continue };
        if now != known && now == before {
            known = now;
            outbox.send(());
        }
        before = now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_written_is_told_of_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("map.png");
        std::fs::write(&path, "one").expect("written");
        let watch = Watch::every(Duration::from_millis(5), &path, &(Arc::new(|| {}) as Wake)).expect("a file");
        std::fs::write(&path, "three").expect("written");
        let told = watch.job.wait(Duration::from_secs(10)).expect("still looking");
        assert!(told.is_some(), "waited in vain");
        assert_eq!(watch.job.wait(Duration::from_millis(100)).map(|event| event.is_some()), Ok(false));
    }
}
