//! Each texel's own fit, finer level first: a texel is seeded from its children's lobes.

use std::ops::Range;

use rayon::prelude::*;

use super::bins::{self, BinnedSamples};
use super::children::Children;
use super::em::{self, EStep, Stop, TexelFit, TexelLobes};
use super::fit::{FitSettings, LevelStats};
use super::lanes::LANES;
use super::monitor::{Cancelled, Monitor};
use super::objective::Objective;
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::{FootprintSamples, Samples};
use super::seed::{self, Candidates};
use super::selection::{Selection, Trials};
use super::trace::TracedRun;
use super::{appearance, crowd, crowd_em, likelihood};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;
use crate::sphere::StoredLobe;

/// Base texels that a run of texels covers at most, unless it is one texel: work for one thread that takes long enough
/// to be told of, and not long.
const RUN: usize = 4096;

/// Fits one level above the base; the next finer one must be there.
pub fn fit_level(
    lobes: &LobePyramid,
    level: usize,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<(MixtureLevel, LevelStats), Cancelled> {
    let map = lobes.map.as_ref();
    let size = map.level_size(level);
    let texels = texels_in_run(map, size);
    let mut mixtures = MixtureLevel::empty(size, settings.lobes);
    let job = LevelFit { lobes, level, settings, monitor };
    let runs = mixtures.stored.par_chunks_mut(settings.lobes * texels).enumerate();
    let totals = runs.map(|(run, target)| job.run(run * texels, target)).try_reduce(Totals::default, |a, b| Ok(a + b));
    let stats = totals?.stats();
    let chosen = settings.selection != Selection::Fixed;
    Ok((if chosen { mixtures.trimmed() } else { mixtures }, stats))
}

/// Texels of a level that are done in one go.
pub fn texels_in_run(map: &NormalMap, (width, height): (usize, usize)) -> usize {
    (RUN * width * height / map.len()).max(1)
}

/// Fitting one level.
#[derive(Clone, Copy)]
pub struct LevelFit<'a> {
    /// The levels fitted so far.
    pub lobes: &'a LobePyramid,
    /// Which one is fitted.
    pub level: usize,
    /// How.
    pub settings: &'a FitSettings,
    monitor: &'a Monitor,
}

impl<'a> LevelFit<'a> {
    /// Fits the texels from `first` on into `target`.
    fn run(&self, first: usize, target: &mut [StoredLobe]) -> Result<Totals, Cancelled> {
        let mut totals = Totals::default();
        let mut visits = 0;
        let slots = self.settings.lobes;
        for (index, target) in (first..).step_by(LANES).zip(target.chunks_mut(slots * LANES)) {
            self.monitor.check()?;
            let texels = target.len() / slots;
            let mut keep = |place: usize, fit: &TexelFit| {
                fit.lobes.store(&mut target[place * slots..(place + 1) * slots]);
                totals.add(fit);
            };
            visits += self.fit_texels(index..index + texels, &mut keep);
        }
        self.monitor.visited(self.level, visits);
        self.monitor.check()?;
        Ok(totals)
    }

    /// Fits at most [`LANES`] texels and shows each to `keep` with its place among them; returns the visits of normals
    /// that are not reported yet.
    fn fit_texels(&self, texels: Range<usize>, keep: &mut dyn FnMut(usize, &TexelFit)) -> u64 {
        if let Some(normals) = self.fit_crowd(texels.clone(), keep) {
            return (normals * most_passes(self.settings)) as u64;
        }
        let mut visits = 0;
        for (place, index) in texels.enumerate() {
            let (fit, unreported) = self.texel(index, None);
            keep(place, &fit);
            visits += unreported;
        }
        visits
    }

    /// Fits texels as a crowd, if those of the level may be; returns their normals. A texel among others comes to the
    /// same bits as alone.
    fn fit_crowd(&self, texels: Range<usize>, keep: &mut dyn FnMut(usize, &TexelFit)) -> Option<usize> {
        let settings = self.settings;
        if settings.selection != Selection::Fixed {
            return None;
        }
        let most = crowd::most_normals(&self.lobes.map, self.lobes.map.level_size(self.level));
        match (settings.objective, settings.e_step) {
            // What has no more normals than lobes needs no fit, whatever the objective.
            _ if most <= settings.lobes => crowd_em::fit(self, texels, keep),
            (Objective::Em, EStep::WithAlpha) => crowd_em::fit(self, texels, keep),
            (Objective::Appearance { steps }, _) => appearance::fit_crowd(self, texels, usize::from(steps), keep),
            (Objective::Em, EStep::AsPrinted) | (Objective::Likelihood, _) => None,
        }
    }

    /// The base texels of the level's texel `index`.
    pub fn footprint(&self, index: usize) -> Footprint {
        let map = self.lobes.map.as_ref();
        let size = map.level_size(self.level);
        Footprint::new((map.width, map.height), size, (index % size.0, index / size.0))
    }

    /// Its finer texels.
    pub fn children(&self, index: usize) -> Children<'a> {
        let width = self.lobes.map.level_size(self.level).0;
        Children::new(self.lobes, self.level, (index % width, index / width))
    }

    /// Fits one texel; returns the visits of normals that are not reported yet.
    fn texel(&self, index: usize, mut trace: Option<&mut Vec<TracedRun>>) -> (TexelFit, u64) {
        let (map, settings) = (self.lobes.map.as_ref(), self.settings);
        let footprint = self.footprint(index);
        let samples = FootprintSamples::new(map, footprint);
        let children = self.children(index);
        let mut reported = 0;
        let trial = |lobes: usize| {
            let settings = FitSettings { lobes, ..*settings };
            let normals = footprint.len();
            let (monitor, level, trace) = (self.monitor, self.level, trace.as_deref_mut());
            let mut task = TexelTask { settings: &settings, normals, monitor, level, passes: 0, trace };
            let fit = fit_trial(&samples, &children, &mut task);
            reported += task.reported();
            fit
        };
        let trials = Trials { samples: &samples, most: settings.lobes, kappa: settings.kappa, fit: trial };
        let fit = trials.choose(settings.selection, &children);
        (fit, ((most_passes(settings) * footprint.len()) as u64).saturating_sub(reported))
    }
}

/// One texel's fit: how, and how far.
pub struct TexelTask<'a> {
    /// How it is fitted.
    pub settings: &'a FitSettings,
    /// Base texels of the footprint.
    pub normals: usize,
    monitor: &'a Monitor,
    level: usize,
    passes: usize,
    /// What is told of the fit, if anybody asks.
    trace: Option<&'a mut Vec<TracedRun>>,
}

impl TexelTask<'_> {
    /// Starts another run of EM, for the trace.
    pub fn begin(&mut self, name: &'static str) {
        if let Some(trace) = &mut self.trace {
            trace.push(TracedRun { name, log_likelihood: Vec::new() });
        }
    }

    /// Counts an E-step of this mean log-likelihood; false where the fit should end.
    pub fn saw(&mut self, mean_log_likelihood: f64) -> bool {
        if let Some(run) = self.trace.as_mut().and_then(|trace| trace.last_mut()) {
            run.log_likelihood.push(mean_log_likelihood);
        }
        self.visited()
    }

    /// Counts a pass over the footprint's normals; false where the fit should end.
    pub fn visited(&mut self) -> bool {
        self.passes += 1;
        if self.is_large() {
            self.monitor.visited(self.level, self.normals as u64);
        }
        !self.monitor.is_cancelled()
    }

    /// True where a single pass is worth being told of.
    fn is_large(&self) -> bool {
        self.normals >= RUN
    }

    /// Visits that were reported.
    fn reported(&self) -> u64 {
        if self.is_large() { (self.passes * self.normals) as u64 } else { 0 }
    }
}

/// Passes over a texel's normals that its own fit is expected to take at most.
pub fn most_passes(settings: &FitSettings) -> usize {
    // Where the number of lobes is chosen, a texel is fitted about three times.
    let trials = if settings.selection == Selection::Fixed { 1 } else { 3 };
    trials * passes_of_trial(settings)
}

fn passes_of_trial(settings: &FitSettings) -> usize {
    match settings.objective {
        Objective::Em => settings.iterations + 1,
        Objective::Appearance { steps } => appearance::ITERATIONS.min(settings.iterations) + usize::from(steps) + 1,
        Objective::Likelihood => likelihood::most_passes(settings),
    }
}

/// Fits one texel of one level from its children's lobes.
pub fn fit_texel(
    lobes: &LobePyramid,
    level: usize,
    (x, y): (usize, usize),
    settings: &FitSettings,
    monitor: &Monitor,
) -> TexelFit {
    let index = y * lobes.map.level_size(level).0 + x;
    let mut fitted = None;
    LevelFit { lobes, level, settings, monitor }.fit_texels(index..index + 1, &mut |_, fit| fitted = Some(*fit));
    fitted.unwrap_or(TexelFit { lobes: TexelLobes::flat(settings.lobes), mean_log_likelihood: 0.0, iterations: 0 })
}

/// As [`fit_texel`], and every run of EM on the way.
pub fn trace_texel(
    lobes: &LobePyramid,
    level: usize,
    (x, y): (usize, usize),
    settings: &FitSettings,
) -> (TexelFit, Vec<TracedRun>) {
    let width = lobes.map.level_size(level).0;
    let monitor = Monitor::new(vec![0; lobes.levels()]);
    let mut trace = Vec::new();
    let fit = LevelFit { lobes, level, settings, monitor: &monitor }.texel(y * width + x, Some(&mut trace)).0;
    (fit, trace)
}

/// Fits one texel with as many lobes as the settings have.
fn fit_trial(samples: &FootprintSamples<'_>, children: &Children<'_>, task: &mut TexelTask<'_>) -> TexelFit {
    let (map, footprint, settings) = (samples.map(), samples.footprint(), task.settings);
    let exact = if small(footprint, settings.lobes) { seed::exact(map, footprint, settings.lobes) } else { None };
    match (exact, settings.objective) {
        (Some(lobes), _) => em::fit(samples, lobes, Stop { iterations: 0, tolerance: 0.0 }, settings.kappa, |_| true),
        (None, Objective::Em) => fit_by_em(samples, children, task),
        (None, objective) if footprint.len() >= bins::WORTHWHILE => {
            fit_from_merge(objective, &BinnedSamples::new(map, footprint), children, task)
        }
        (None, objective) => fit_from_merge(objective, samples, children, task),
    }
}

/// The objectives that start from the children's lobes merged.
fn fit_from_merge(
    objective: Objective,
    samples: &impl Samples,
    children: &Children<'_>,
    task: &mut TexelTask<'_>,
) -> TexelFit {
    match objective {
        Objective::Appearance { steps } => appearance::fit(samples, children, usize::from(steps), task),
        Objective::Em | Objective::Likelihood => likelihood::fit(samples, children, task),
    }
}

/// EM to its tolerance from the children's lobes, farthest apart.
fn fit_by_em(samples: &FootprintSamples<'_>, children: &Children<'_>, task: &mut TexelTask<'_>) -> TexelFit {
    let settings = task.settings;
    let stop = settings.stop();
    let mut run = |name, seed, stop| {
        task.begin(name);
        match settings.e_step {
            EStep::WithAlpha => em::fit(samples, seed, stop, settings.kappa, |mean| task.saw(mean)),
            EStep::AsPrinted => em::fit_as_printed(samples, seed, stop, settings.kappa, |mean| task.saw(mean)),
        }
    };
    let seed = seed_of(children, samples, settings.lobes);
    if samples.len() < RACED || settings.iterations <= RACE {
        return run(FROM_CHILDREN, seed, stop);
    }
    let (centres, count) = seed::farthest_normals(samples.map(), samples.footprint(), settings.lobes);
    let rival = seed::assign(samples, &centres[..count], settings.lobes);
    race(&mut run, seed, rival, stop)
}

const FROM_CHILDREN: &str = "EM from children's lobes far apart";

/// Iterations that two seeds are given before the better one goes on.
pub const RACE: usize = 10;

/// Normals from which on a bad seed is likely enough to race two; the extremes of fewer are the children's lobes.
pub const RACED: usize = 64;

/// Runs both seeds for a while and the one of higher likelihood to the end: a single start can end far off.
fn race(
    run: &mut impl FnMut(&'static str, TexelLobes, Stop) -> TexelFit,
    first: TexelLobes,
    second: TexelLobes,
    stop: Stop,
) -> TexelFit {
    let short = Stop { iterations: RACE, ..stop };
    let (first, second) = (run(FROM_CHILDREN, first, short), run("EM from normals far apart", second, short));
    let better = if second.mean_log_likelihood > first.mean_log_likelihood { second } else { first };
    if better.iterations < RACE {
        return better;
    }
    let rest = run("EM of the better", better.lobes, Stop { iterations: stop.iterations - RACE, ..stop });
    TexelFit { iterations: RACE + rest.iterations, ..rest }
}

/// True for footprints whose every normal may have a lobe of its own.
pub fn small(footprint: &Footprint, lobes: usize) -> bool {
    footprint.len() <= lobes
}

/// The seed of EM: the children's lobes, farthest apart, then one hard assignment of the texel's normals.
fn seed_of(children: &Children<'_>, samples: &FootprintSamples<'_>, slots: usize) -> TexelLobes {
    let (centres, count) = children.farthest_apart(slots, &mut Candidates::default());
    seed::assign(samples, &centres[..count], slots)
}

/// Sums over texels; whole numbers, so the order of adding changes nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    micro_log_likelihood: i64,
    iterations: u64,
    texels: u64,
}

impl Totals {
    /// Adds one texel.
    pub fn add(&mut self, fit: &TexelFit) {
        self.add_log_likelihood(fit.mean_log_likelihood);
        self.iterations += fit.iterations as u64;
    }

    /// Adds one texel's mean log-likelihood.
    pub fn add_log_likelihood(&mut self, mean_log_likelihood: f64) {
        self.micro_log_likelihood += (mean_log_likelihood * 1e6).round() as i64;
        self.texels += 1;
    }

    /// Means over the texels.
    pub fn stats(&self) -> LevelStats {
        let texels = self.texels.max(1) as f64;
        LevelStats {
            mean_log_likelihood: self.micro_log_likelihood as f64 * 1e-6 / texels,
            mean_iterations: self.iterations as f64 / texels,
            ..LevelStats::default()
        }
    }
}

impl std::ops::Add for Totals {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            micro_log_likelihood: self.micro_log_likelihood + other.micro_log_likelihood,
            iterations: self.iterations + other.iterations,
            texels: self.texels + other.texels,
        }
    }
}
