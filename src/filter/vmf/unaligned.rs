//! Each texel's own fit, finer level first: a texel is seeded from its children's lobes.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::bins::{self, BinnedSamples};
use super::children::Children;
use super::em::{self, Stop, TexelFit};
use super::fit::{FitSettings, LevelStats};
use super::monitor::{Cancelled, Monitor};
use super::objective::Objective;
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::{FootprintSamples, Samples};
use super::seed::{self, Candidates};
use super::selection::{Selection, Trials};
use super::{appearance, likelihood};
use crate::normal_map::pyramid::Footprint;

/// Fits one level above the base; the next finer one must be there.
pub fn fit_level(
    lobes: &LobePyramid,
    level: usize,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<(MixtureLevel, LevelStats), Cancelled> {
    let size = lobes.map.level_sizes()[level];
    let mut mixtures = MixtureLevel::empty(size, settings.lobes);
    let totals = Totals::default();
    mixtures.stored.par_chunks_mut(settings.lobes).enumerate().try_for_each(|(index, target)| {
        monitor.check()?;
        let fit = fit_texel(lobes, level, (index % size.0, index / size.0), settings, monitor);
        fit.lobes.store(target);
        totals.add(&fit);
        monitor.check()
    })?;
    let stats = totals.stats(size.0 * size.1);
    let chosen = settings.selection != Selection::Fixed;
    Ok((if chosen { mixtures.trimmed() } else { mixtures }, stats))
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
}

impl TexelTask<'_> {
    /// Counts a pass over the footprint's normals; false where the fit should end.
    pub fn visited(&mut self) -> bool {
        self.passes += 1;
        self.monitor.visited(self.level, self.normals as u64);
        !self.monitor.is_cancelled()
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
    texel: (usize, usize),
    settings: &FitSettings,
    monitor: &Monitor,
) -> TexelFit {
    let map = lobes.map.as_ref();
    let sizes = map.level_sizes();
    let footprint = Footprint::new(sizes[0], sizes[level], texel);
    let samples = FootprintSamples::new(map, footprint);
    let children = Children::new(lobes, level, texel);
    let mut passes = 0;
    let trial = |lobes: usize| {
        let settings = FitSettings { lobes, ..*settings };
        let mut task = TexelTask { settings: &settings, normals: footprint.len(), monitor, level, passes: 0 };
        let fit = fit_trial(&samples, &children, &mut task);
        passes += task.passes;
        fit
    };
    let trials = Trials { samples: &samples, most: settings.lobes, kappa: settings.kappa, fit: trial };
    let fit = trials.choose(settings.selection, &children);
    // The passes that were expected and not needed.
    monitor.visited(level, (most_passes(settings).saturating_sub(passes) * footprint.len()) as u64);
    fit
}

/// Fits one texel with as many lobes as the settings have.
fn fit_trial(samples: &FootprintSamples<'_>, children: &Children<'_>, task: &mut TexelTask<'_>) -> TexelFit {
    let (map, footprint, settings) = (samples.map(), samples.footprint(), task.settings);
    let exact = if small(footprint, settings.lobes) { seed::exact(map, footprint, settings.lobes) } else { None };
    match (exact, settings.objective) {
        (Some(lobes), _) => em::fit(samples, lobes, Stop { iterations: 0, tolerance: 0.0 }, settings.kappa, || true),
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
    let mut run = |seed, stop| em::fit(samples, seed, stop, settings.kappa, || task.visited());
    let seed = seed_of(children, samples, settings.lobes);
    if samples.len() < RACED || settings.iterations <= RACE {
        return run(seed, stop);
    }
    let (centres, count) = seed::farthest_normals(samples.map(), samples.footprint(), settings.lobes);
    let rival = seed::assign(samples, &centres[..count], settings.lobes);
    race(&mut run, seed, rival, stop)
}

/// Iterations that two seeds are given before the better one goes on.
const RACE: usize = 10;

/// Normals from which on a bad seed is likely enough to race two; the extremes of fewer are the children's lobes.
const RACED: usize = 64;

/// Runs both seeds for a while and the one of higher likelihood to the end: a single start can end far off.
fn race(
    run: &mut impl FnMut(em::TexelLobes, Stop) -> TexelFit,
    first: em::TexelLobes,
    second: em::TexelLobes,
    stop: Stop,
) -> TexelFit {
    let short = Stop { iterations: RACE, ..stop };
    let (first, second) = (run(first, short), run(second, short));
    let better = if second.mean_log_likelihood > first.mean_log_likelihood { second } else { first };
    if better.iterations < RACE {
        return better;
    }
    let rest = run(better.lobes, Stop { iterations: stop.iterations - RACE, ..stop });
    TexelFit { iterations: RACE + rest.iterations, ..rest }
}

/// True for footprints whose every normal may have a lobe of its own.
fn small(footprint: &Footprint, lobes: usize) -> bool {
    footprint.len() <= lobes
}

/// The seed of EM: the children's lobes, farthest apart, then one hard assignment of the texel's normals.
fn seed_of(children: &Children<'_>, samples: &FootprintSamples<'_>, slots: usize) -> em::TexelLobes {
    let mut candidates = Candidates::default();
    let mut mean = glam::Vec3::ZERO;
    children.each(|stored, _| {
        candidates.push_stored(stored);
        mean += seed::mean_of(stored.iter().copied());
    });
    let (centres, count) = candidates.farthest_apart(slots, mean);
    seed::assign(samples, &centres[..count], slots)
}

/// Sums over texels that any thread may add to; whole numbers, so the order of adding changes nothing.
#[derive(Default)]
pub struct Totals {
    micro_log_likelihood: AtomicU64,
    iterations: AtomicU64,
}

impl Totals {
    /// Adds one texel.
    pub fn add(&self, fit: &TexelFit) {
        self.add_log_likelihood(fit.mean_log_likelihood);
        self.iterations.fetch_add(fit.iterations as u64, Ordering::Relaxed);
    }

    /// Adds one texel's mean log-likelihood.
    pub fn add_log_likelihood(&self, mean_log_likelihood: f64) {
        let micro = (mean_log_likelihood * 1e6).round() as i64;
        self.micro_log_likelihood.fetch_add(micro as u64, Ordering::Relaxed);
    }

    /// Means over `texels` texels.
    pub fn stats(&self, texels: usize) -> LevelStats {
        LevelStats {
            mean_log_likelihood: self.micro_log_likelihood.load(Ordering::Relaxed) as i64 as f64 * 1e-6 / texels as f64,
            mean_iterations: self.iterations.load(Ordering::Relaxed) as f64 / texels as f64,
            ..LevelStats::default()
        }
    }
}
