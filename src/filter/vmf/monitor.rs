//! How a running fit is watched and stopped, without locks.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The fit was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the fit was cancelled")]
pub struct Cancelled;

/// Progress of a fit in normals visited, per level, and the flag that ends it.
#[derive(Debug)]
pub struct Monitor {
    cancelled: AtomicBool,
    done: Vec<AtomicU64>,
    expected: Vec<u64>,
}

impl Monitor {
    /// Expects `expected[level]` normals to be visited.
    pub fn new(expected: Vec<u64>) -> Self {
        Self { cancelled: AtomicBool::new(false), done: expected.iter().map(|_| AtomicU64::new(0)).collect(), expected }
    }

    /// Asks the fit to end; it does so within the visit of one chunk of normals per thread.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// True once [`Self::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// `Err` once [`Self::cancel`] was called.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Counts visited normals of a level.
    pub fn visited(&self, level: usize, normals: u64) {
        self.done[level].fetch_add(normals, Ordering::Relaxed);
    }

    /// The share of a level that is done, `0..=1`.
    pub fn level_fraction(&self, level: usize) -> f32 {
        fraction(self.done[level].load(Ordering::Relaxed), self.expected[level])
    }

    /// The share of the whole that is done, `0..=1`.
    pub fn fraction(&self) -> f32 {
        fraction(self.done.iter().map(|done| done.load(Ordering::Relaxed)).sum(), self.expected.iter().sum())
    }

    /// Number of levels, the base counted.
    pub fn levels(&self) -> usize {
        self.expected.len()
    }
}

fn fraction(done: u64, expected: u64) -> f32 {
    if expected == 0 { 1.0 } else { (done as f64 / expected as f64).min(1.0) as f32 }
}
