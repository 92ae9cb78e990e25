//! What the alignment of a finished fit is worth, measured in the background.

use std::sync::Arc;

use super::{Fitting, LevelFit, LevelState};
use crate::filter::vmf::{Coherence, coherence};
use crate::jobs::{Job, JobEvent, Outbox, Wake};

impl Fitting {
    /// Measures what the alignment of every finished level is worth; waits.
    pub fn measure_coherence(&mut self) {
        for (level, fit) in self.levels.iter_mut().enumerate() {
            if let (LevelState::Done, Some(stats)) = (fit.state, &mut fit.stats) {
                stats.coherence = coherence::measure(&self.lobes, level);
            }
        }
    }

    /// Starts to measure what the alignment of a finished fit is worth, where that is not known and somebody looks.
    pub fn measure(&mut self, wake: &Wake) {
        let unknown = |fit: &LevelFit| fit.stats.is_some_and(|stats| stats.coherence.is_none());
        if !self.previews || self.measuring.is_some() || !self.is_complete() || !self.levels.iter().any(unknown) {
            return;
        }
        let (lobes, pool) = (Arc::clone(&self.lobes), self.pool.clone());
        let missing: Vec<usize> = (1..self.levels.len()).filter(|&level| unknown(&self.levels[level])).collect();
        let work = move |outbox: &Outbox<(usize, Coherence)>| {
            for level in missing {
                let measure = || coherence::measure(&lobes, level);
                let figures = pool.as_ref().map_or_else(measure, |pool| pool.install(measure));
                outbox.send((level, figures.unwrap_or_default()));
            }
        };
        match Job::spawn("measure-alignment", Arc::clone(wake), work) {
            Ok(job) => self.measuring = Some(job),
            Err(error) => log::warn!("the alignment cannot be measured: {error}"),
        }
    }

    /// True while figures of a finished fit are on their way.
    pub fn is_measuring(&self) -> bool {
        self.measuring.is_some()
    }

    /// Takes what has been measured; true if anything was.
    pub(super) fn take_figures(&mut self) -> bool {
        let mut changed = false;
        while let Some(event) = self.measuring.as_ref().and_then(Job::next) {
            changed = true;
            match event {
                JobEvent::News((level, figures)) => {
                    if let Some(stats) = &mut self.levels[level].stats {
                        stats.coherence = Some(figures);
                    }
                }
                JobEvent::Panicked(text) => {
                    log::warn!("the alignment was not measured: {text}");
                    self.measuring = None;
                }
            }
        }
        if self.levels.iter().all(|fit| fit.stats.is_none_or(|stats| stats.coherence.is_some())) {
            self.measuring = None;
        }
        changed
    }
}
