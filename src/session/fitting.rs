//! The fit as the window sees it: the lobes at hand, what they are worth, and the job that betters them.

use std::sync::Arc;
use std::time::Duration;

use rayon::ThreadPool;

use crate::export::lobes_exr::FittedLobes;
use crate::filter::vmf::fit::{self, FitEvent, FitSettings, LevelStats};
use crate::filter::vmf::{Cancelled, Fold, LobePyramid, Monitor, coherence, fold};
use crate::jobs::{self, Ended, Job, JobEvent, Wake};
use crate::normal_map::NormalMap;

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
        self.previews = false;
    }

    /// Threads that fits run on.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(0, |pool| pool.current_num_threads())
    }

    /// Takes other settings: the running fit ends, and the lobes at hand become a preview.
    pub fn restart(&mut self, settings: FitSettings) {
        self.running = None;
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
        *self = Self { revision, threads, pool, previews: self.previews, ..Self::new(map, self.settings) };
    }

    /// Forgets the lobes and takes a fit that is finished.
    pub fn adopt_fit(&mut self, fit: FittedLobes) {
        self.adopt(Arc::clone(&fit.lobes.map));
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
        let pool = match &self.pool {
            Some(pool) => Arc::clone(pool),
            None => Arc::new(jobs::fit_pool(self.threads).map_err(|error| sentence(&error))?),
        };
        self.pool = Some(Arc::clone(&pool));
        let monitor = Arc::new(Monitor::new(fit::expected_visits(&self.map, &self.settings)));
        let (map, settings, watched) = (Arc::clone(&self.map), self.settings, Arc::clone(&monitor));
        let job = Job::spawn("fit", Arc::clone(wake), move |outbox| {
            let result: Result<LobePyramid, Cancelled> =
                pool.install(|| fit::fit(&map, &settings, &watched, &mut |event| outbox.send(event)));
            if let Err(cancelled) = result {
                log::debug!("{cancelled}");
            }
        });
        self.running = Some(Running { job: job.map_err(|error| sentence(&error))?, monitor });
        Ok(())
    }

    /// Measures what the alignment of every finished level is worth; waits.
    pub fn measure_coherence(&mut self) {
        for (level, fit) in self.levels.iter_mut().enumerate() {
            if let (LevelState::Done, Some(stats)) = (fit.state, &mut fit.stats) {
                stats.coherence = coherence::measure(&self.lobes, level);
            }
        }
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
        changed
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

    fn take(&mut self, event: FitEvent) {
        let lobes = Arc::make_mut(&mut self.lobes);
        match event {
            FitEvent::Level { level, mixtures, stats, last } => {
                // Finished lobes, even of earlier settings, look better than unaligned ones.
                let shown = &mut self.levels[level];
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
            }
        }
        self.revision += 1;
    }
}
