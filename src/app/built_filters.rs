//! Filters that were built for effective BRDFs of the open map, kept for whoever asks next, and the threads that such work
//! runs on. Clones share them.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rayon::ThreadPool;

use crate::filter::rival::Source;
use crate::filter::vmf::{Cancelled, Fold, LobePyramid, Monitor, Rules};
use crate::filter::{Filter, Method, PlainMip};
use crate::jobs;
use crate::session::Session;

/// The most that are kept: beyond, the one asked for longest ago goes.
const MOST_KEPT: usize = 6;

/// The filters and the threads.
#[derive(Clone, Default)]
pub struct BuiltFilters {
    /// The latest asked for last.
    kept: Arc<Mutex<Vec<Kept>>>,
    /// None where the system gave none.
    pool: Arc<OnceLock<Option<ThreadPool>>>,
}

/// A filter, and what it was built from.
type Kept = (Key, Arc<dyn Filter>);

/// What a rival's filter depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key {
    map_revision: u64,
    method: Method,
    rules: Rules,
}

/// What filters of a session are made of, to be taken along into a job.
#[derive(Clone)]
pub struct FilterSource {
    map_revision: u64,
    /// The map and its mean normals.
    pub mip: Arc<PlainMip>,
    lobes: Arc<LobePyramid>,
    fold: Fold,
    rules: Rules,
}

impl FilterSource {
    /// Of the session as it is, with these rules.
    pub fn new(session: &Session, rules: Rules) -> Self {
        Self {
            map_revision: session.map_revision(),
            mip: Arc::clone(session.mip()),
            lobes: Arc::clone(session.lobes()),
            fold: session.fitting().fold(),
            rules,
        }
    }

    /// True where a method has something to show of a level: lobes may not be fitted there.
    pub fn has(&self, method: Method, level: usize) -> bool {
        !method.shows_lobes() || level == 0 || self.lobes.level(level).is_some()
    }
}

impl BuiltFilters {
    /// Does work on threads of low priority.
    pub fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match self.pool.get_or_init(|| jobs::fit_pool(None).ok()) {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// The filter of a method, built unless it is kept. Lobes are those of the source and need no building.
    ///
    /// # Errors
    /// When it is cancelled.
    pub fn get(&self, source: &FilterSource, method: Method, monitor: &Monitor) -> Result<Arc<dyn Filter>, Cancelled> {
        let key = Key { map_revision: source.map_revision, method, rules: source.rules };
        if let Some(filter) = self.recall(&key) {
            return Ok(filter);
        }
        let built = Source { mip: &source.mip, rules: source.rules, monitor };
        let filter = self.install(|| method.filter(&built, &source.lobes, source.fold))?;
        if method.rival().is_some() {
            let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.retain(|(other, _)| other.map_revision == key.map_revision);
            kept.push((key, Arc::clone(&filter)));
            let surplus = kept.len().saturating_sub(MOST_KEPT);
            kept.drain(..surplus);
        }
        Ok(filter)
    }

    fn recall(&self, key: &Key) -> Option<Arc<dyn Filter>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let index = kept.iter().position(|(other, _)| other == key)?;
        let found = kept.remove(index);
        let filter = Arc::clone(&found.1);
        kept.push(found);
        Some(filter)
    }
}
