//! The fit as the window sees it: the lobes at hand, what they are worth, and the job that betters them.

mod alignment_figures;

use std::sync::Arc;
use std::time::Duration;

use rayon::ThreadPool;

use super::kept::{self, KeptFits};
use crate::export::lobes_exr::FittedLobes;
use crate::filter::vmf::fit::{self, FitEvent, FitSettings, LevelStats, OwnLevels, Stage, Start};
use crate::filter::vmf::{
    Alignment, Cancelled, Coherence, Fold, LobePyramid, MixtureLevel, Monitor, Objective, Selection, fold,
};
use crate::image_io::memory;
use crate::jobs::{self, Ended, Job, JobEvent, Wake};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::sphere::StoredLobe;

/// How good a level's lobes are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LevelState {
    /// Nothing is fitted yet.
    #[default]
    Missing,
    /// Lobes that alignment has not reached yet.
    Unaligned,
    /// Finished lobes of earlier settings.
    Earlier,
    /// The fit of the settings in force.
    Done,
}

/// One level of the fit.
#[derive(Clone, Copy, Debug, Default)]
pub struct LevelFit {
    /// How good its lobes are.
    pub state: LevelState,
    /// What they came to.
    pub stats: Option<LevelStats>,
}

/// How far a running fit is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// The share of the whole, `0..=1`.
    pub fraction: f32,
    /// The share of each level, the base first.
    pub levels: Vec<f32>,
}

/// The running job.
struct Running {
    job: Job<FitEvent>,
    monitor: Arc<Monitor>,
}

impl Drop for Running {
    fn drop(&mut self) {
        // A job that nobody listens to must not go on using the cores.
        self.monitor.cancel();
    }
}

/// The lobes at hand and the job that betters them.
pub struct Fitting {
    map: Arc<NormalMap>,
    settings: FitSettings,
    lobes: Arc<LobePyramid>,
    levels: Vec<LevelFit>,
    fold: Fold,
    revision: u64,
    threads: Option<usize>,
    pool: Option<Arc<ThreadPool>>,
    running: Option<Running>,
    previews: bool,
    /// True where the unaligned levels are kept for another alignment.
    remembers: bool,
    /// Levels of the unaligned fit of the settings in force, whatever the alignment.
    own: OwnLevels,
    /// Those of one lobe fewer, which the fit grows from.
    fewer: OwnLevels,
    grown: bool,
    kept: KeptFits,
    /// The texel to be fitted first, and its own lobes once they are there.
    wanted: Option<Texel>,
    first: Option<(Texel, Vec<StoredLobe>)>,
    /// What alignment is worth, measured in the background once a fit is done.
    measuring: Option<Job<(usize, Coherence)>>,
}

impl Fitting {
    /// Nothing fitted yet.
    pub fn new(map: Arc<NormalMap>, settings: FitSettings) -> Self {
        let lobes = Arc::new(LobePyramid::unfitted(Arc::clone(&map)));
        let levels = vec![LevelFit::default(); lobes.levels()];
        Self {
            map,
            settings,
            lobes,
            levels,
            fold: Fold::default(),
            revision: 1,
            threads: None,
            pool: None,
            running: None,
            previews: true,
            remembers: true,
            own: OwnLevels::default(),
            fewer: OwnLevels::default(),
            grown: false,
            kept: KeptFits::default(),
            wanted: None,
            first: None,
            measuring: None,
        }
    }

    /// The settings in force.
    pub fn settings(&self) -> &FitSettings {
        &self.settings
    }

    /// The lobes at hand.
    pub fn lobes(&self) -> &Arc<LobePyramid> {
        &self.lobes
    }

    /// Each level's state, the base first.
    pub fn levels(&self) -> &[LevelFit] {
        &self.levels
    }

    /// How slots are merged before shading while a preview is shown.
    pub fn fold(&self) -> Fold {
        self.fold
    }

    /// Grows with every change of the lobes at hand; textures are uploaded anew then.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// True once every level is fitted with the settings in force.
    pub fn is_complete(&self) -> bool {
        self.levels.iter().all(|level| level.state == LevelState::Done)
    }

    /// True while a fit runs.
    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// How far the running fit is.
    pub fn progress(&self) -> Option<Progress> {
        let monitor = &self.running.as_ref()?.monitor;
        let levels = (0..monitor.levels()).map(|level| monitor.level_fraction(level)).collect();
        Some(Progress { fraction: monitor.fraction(), levels })
    }

    /// Uses this many threads from the next start on, or one per core.
    pub fn set_threads(&mut self, threads: Option<usize>) {
        (self.threads, self.pool) = (threads, None);
    }

    /// Keeps no level from now on before it is finished.
    pub fn skip_previews(&mut self) {
        (self.previews, self.remembers) = (false, false);
    }

    /// The finished fit, if there is one, in a place of its own that keeps no previews; with the unaligned levels where
    /// it `remembers` them. A fit that grew is left, so that what follows is what a start from nothing comes to.
    pub fn fork(&self, remembers: bool) -> Self {
        let new = Self::new(Arc::clone(&self.map), self.settings);
        let mut fork = Self { threads: self.threads, pool: self.pool.clone(), previews: false, remembers, ..new };
        if !self.grown {
            fork.own = if remembers { self.own.clone() } else { OwnLevels::default() };
            if let Some(fit) = self.finished() {
                fork.take_fit(fit);
            }
        }
        fork
    }

    /// Threads that fits run on.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(0, |pool| pool.current_num_threads())
    }

    /// Finished fits that are kept, and the memory that they and the unaligned levels hold, bytes.
    pub fn kept(&self) -> (usize, usize) {
        (self.kept.len(), self.kept.bytes() + self.own_bytes())
    }

    fn own_bytes(&self) -> usize {
        self.own.iter().chain(&self.fewer).map(|(level, _)| kept::level_bytes(level)).sum()
    }

    /// Forgets what is kept of the settings in force, so that the next start fits everything anew.
    pub fn forget(&mut self) {
        (self.own, self.fewer, self.grown) = (OwnLevels::default(), OwnLevels::default(), false);
        self.kept.forget(&self.settings);
    }

    /// Takes the kept fit of these settings, if there is one; the running fit then ends.
    pub fn recall(&mut self, settings: &FitSettings) -> bool {
        let Some(fit) = self.kept.recall(settings) else { return false };
        self.leave_for(settings);
        self.fold = Fold::default();
        self.take_fit(fit);
        self.revision += 1;
        true
    }

    /// Ends what runs; drops the unaligned levels where they are of other settings than these, or keeps them to grow
    /// from.
    fn leave_for(&mut self, settings: &FitSettings) {
        (self.running, self.first, self.measuring) = (None, None, None);
        let unaligned = |settings: &FitSettings| FitSettings { align: Alignment::None, ..*settings };
        if unaligned(settings) == unaligned(&self.settings) {
            return;
        }
        let own = std::mem::take(&mut self.own);
        let one_fewer = FitSettings { lobes: self.settings.lobes + 1, ..unaligned(&self.settings) };
        let pays = !matches!(settings.objective, Objective::Appearance { .. });
        let grows = pays && settings.selection == Selection::Fixed && unaligned(settings) == one_fewer;
        let whole = own.len() + 1 == self.levels.len();
        self.grown = grows && whole;
        self.fewer = if self.grown { own } else { OwnLevels::default() };
    }

    /// True where the lobes grow, or grew, from a fit with one lobe fewer: a fit from the start may come to slightly
    /// other ones.
    pub fn is_grown(&self) -> bool {
        self.grown
    }

    /// Takes other settings: the running fit ends, and the lobes at hand become a preview.
    pub fn restart(&mut self, settings: FitSettings) {
        self.leave_for(&settings);
        if settings.lobes != self.settings.lobes {
            self.fold = fold::fewer_lobes(&self.lobes, settings.lobes);
        }
        self.settings = settings;
        for level in self.levels.iter_mut().filter(|level| level.state == LevelState::Done) {
            level.state = LevelState::Earlier;
        }
        self.revision += 1;
    }

    /// Forgets the lobes and takes another map.
    pub fn adopt(&mut self, map: Arc<NormalMap>) {
        let (revision, threads, pool) = (self.revision + 1, self.threads, self.pool.take());
        let (previews, remembers) = (self.previews, self.remembers);
        *self = Self { revision, threads, pool, previews, remembers, ..Self::new(map, self.settings) };
    }

    /// Forgets the lobes and takes a fit that is finished.
    pub fn adopt_fit(&mut self, fit: FittedLobes) {
        self.adopt(Arc::clone(&fit.lobes.map));
        self.take_fit(fit);
    }

    fn take_fit(&mut self, fit: FittedLobes) {
        let level = |index| LevelFit { state: LevelState::Done, stats: fit.stats.get(index).copied().flatten() };
        self.levels = (0..fit.lobes.levels()).map(level).collect();
        (self.lobes, self.settings) = (fit.lobes, fit.settings);
    }

    /// The fit, once it is finished.
    pub fn finished(&self) -> Option<FittedLobes> {
        let stats = self.levels.iter().map(|level| level.stats).collect();
        let fit = || FittedLobes { lobes: Arc::clone(&self.lobes), settings: self.settings, stats };
        self.is_complete().then(fit)
    }

    /// Starts the job. `Err` is a sentence for the user.
    pub fn start(&mut self, wake: &Wake) -> Result<(), String> {
        let sentence = |cause: &dyn std::fmt::Display| format!("The fit cannot start: {cause}.");
        memory::check(self.expected_bytes()).map_err(|cause| sentence(&cause))?;
        let pool = match &self.pool {
            Some(pool) => Arc::clone(pool),
            None => Arc::new(jobs::fit_pool(self.threads).map_err(|error| sentence(&error))?),
        };
        self.pool = Some(Arc::clone(&pool));
        let monitor = Arc::new(Monitor::new(fit::expected_visits(&self.map, &self.settings)));
        let (map, settings, watched) = (Arc::clone(&self.map), self.settings, Arc::clone(&monitor));
        let start =
            Start { own: self.own.clone(), fewer: self.fewer.clone(), first: self.wanted.filter(|_| self.previews) };
        let job = Job::spawn("fit", Arc::clone(wake), move |outbox| {
            let result: Result<LobePyramid, Cancelled> =
                pool.install(|| fit::fit_from(&map, &settings, &start, &watched, &mut |event| outbox.send(event)));
            if let Err(cancelled) = result {
                log::debug!("{cancelled}");
            }
        });
        self.running = Some(Running { job: job.map_err(|error| sentence(&error))?, monitor });
        Ok(())
    }

    /// Memory that a fit with the settings in force takes: every level's lobes, aligned and not.
    fn expected_bytes(&self) -> u64 {
        let texels: usize = self.map.level_sizes().iter().skip(1).map(|(width, height)| width * height).sum();
        (2 * texels * self.settings.lobes * size_of::<StoredLobe>()) as u64
    }

    /// Stops the job; the levels that are done stay.
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
        changed | self.take_figures()
    }

    /// Waits up to `timeout` for the job's next event and takes it.
    pub fn wait(&mut self, timeout: Duration, messages: &mut Vec<String>) {
        match self.running.as_ref().map(|running| running.job.wait(timeout)) {
            Some(Ok(Some(event))) => self.handle(event, messages),
            Some(Err(Ended)) => self.running = None,
            Some(Ok(None)) | None => {}
        }
    }

    fn handle(&mut self, event: JobEvent<FitEvent>, messages: &mut Vec<String>) {
        match event {
            JobEvent::News(event) => self.take(event),
            JobEvent::Panicked(text) => {
                messages.push(format!("The fit stopped by a fault of the program: {text}."));
                self.running = None;
            }
        }
    }

    /// The selected texel's own lobes, fitted ahead of its level; `None` once the level itself is fitted.
    pub fn first(&self, texel: Texel) -> Option<&[StoredLobe]> {
        let waits = matches!(self.levels[texel.level].state, LevelState::Missing | LevelState::Earlier);
        self.first.as_ref().filter(|(fitted, _)| waits && *fitted == texel).map(|(_, stored)| stored.as_slice())
    }

    /// The texel that the next start fits first.
    pub fn want(&mut self, texel: Texel) {
        self.wanted = Some(texel);
    }

    /// Remembers a level of the unaligned fit; they come from the finest up.
    fn remember(&mut self, level: usize, mixtures: &Arc<MixtureLevel>, stats: LevelStats) {
        let next = level == self.own.len() + 1;
        if next && self.remembers && self.own_bytes() + kept::level_bytes(mixtures) <= kept::BUDGET / 2 {
            self.own.push((Arc::clone(mixtures), stats));
        }
    }

    fn take(&mut self, event: FitEvent) {
        if let FitEvent::Level { level, mixtures, stats, stage } = &event
            && (*stage == Stage::Own || self.settings.align == Alignment::None)
        {
            self.remember(*level, mixtures, *stats);
        }
        let lobes = Arc::make_mut(&mut self.lobes);
        match event {
            FitEvent::First { texel, stored } => self.first = Some((texel, stored)),
            FitEvent::Level { level, mixtures, stats, stage } => {
                // Finished lobes, even of earlier settings, look better than unaligned ones.
                let shown = &mut self.levels[level];
                let last = stage == Stage::Done;
                if last || self.previews && shown.state != LevelState::Earlier {
                    lobes.coarse[level - 1] = Some(mixtures);
                    lobes.colors[level - 1] = None;
                    let state = if last { LevelState::Done } else { LevelState::Unaligned };
                    *shown = LevelFit { state, stats: Some(stats) };
                }
            }
            FitEvent::Color { level, colors } => lobes.colors[level - 1] = Some(colors),
            FitEvent::Base(base) => {
                lobes.base = Some(base);
                self.levels[0].state = LevelState::Done;
                self.fold = Fold::default();
                self.running = None;
                self.fewer = OwnLevels::default();
                if let Some(fit) = self.finished().filter(|_| self.previews) {
                    self.kept.keep(fit, kept::BUDGET - self.own_bytes());
                }
            }
        }
        self.revision += 1;
    }
}
