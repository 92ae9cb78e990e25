//! Each texel's own fit, finer level first: a texel is seeded from its children's lobes.

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::em::{self, TexelFit};
use super::fit::{FitSettings, LevelStats};
use super::monitor::{Cancelled, Monitor};
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::FootprintSamples;
use super::seed::{self, Candidates};
use crate::normal_map::pyramid::{Footprint, Span};
use crate::sphere::StoredLobe;

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
    Ok((mixtures, stats))
}

/// Fits one texel of one level from its children's lobes.
pub fn fit_texel(
    lobes: &LobePyramid,
    level: usize,
    texel: (usize, usize),
    settings: &FitSettings,
    monitor: &Monitor,
) -> TexelFit {
    let map = &lobes.map;
    let sizes = map.level_sizes();
    let footprint = Footprint::new(sizes[0], sizes[level], texel);
    let samples = FootprintSamples::new(map, footprint);
    let visits = footprint.len() as u64;
    let budget = visits * (settings.iterations as u64 + 1);
    let mut visited = 0;
    let stop = settings.stop();
    let mut run = |seed, stop| {
        em::fit(&samples, seed, stop, settings.kappa, || {
            visited += visits;
            monitor.visited(level, visits);
            !monitor.is_cancelled()
        })
    };
    let exact = if small(&footprint, settings.lobes) { seed::exact(map, &footprint, settings.lobes) } else { None };
    let fit = match exact {
        Some(lobes) => run(lobes, em::Stop { iterations: 0, ..stop }),
        None => {
            let seed = seed_of(lobes, level, texel, &samples, settings.lobes);
            if footprint.len() >= RACED && settings.iterations > RACE {
                let (centres, count) = seed::farthest_normals(map, &footprint, settings.lobes);
                let rival = seed::assign(&samples, &centres[..count], settings.lobes);
                race(&mut run, seed, rival, stop)
            } else {
                run(seed, stop)
            }
        }
    };
    monitor.visited(level, budget.saturating_sub(visited));
    fit
}

/// Iterations that two seeds are given before the better one goes on.
const RACE: usize = 10;

/// Normals from which on a bad seed is likely enough to race two; the extremes of fewer are the children's lobes.
const RACED: usize = 64;

/// Runs both seeds for a while and the one of higher likelihood to the end: a single start can end far off.
fn race(
    run: &mut impl FnMut(em::TexelLobes, em::Stop) -> TexelFit,
    first: em::TexelLobes,
    second: em::TexelLobes,
    stop: em::Stop,
) -> TexelFit {
    let short = em::Stop { iterations: RACE, ..stop };
    let (first, second) = (run(first, short), run(second, short));
    let better = if second.mean_log_likelihood > first.mean_log_likelihood { second } else { first };
    if better.iterations < RACE {
        return better;
    }
    let rest = run(better.lobes, em::Stop { iterations: stop.iterations - RACE, ..stop });
    TexelFit { iterations: RACE + rest.iterations, ..rest }
}

/// True for footprints whose every normal may have a lobe of its own.
fn small(footprint: &Footprint, lobes: usize) -> bool {
    footprint.len() <= lobes
}

/// The seed of a texel: its children's lobes, farthest apart, then one hard assignment of its normals.
fn seed_of(
    lobes: &LobePyramid,
    level: usize,
    (x, y): (usize, usize),
    samples: &FootprintSamples<'_>,
    slots: usize,
) -> em::TexelLobes {
    let sizes = lobes.map.level_sizes();
    let (coarse, fine) = (sizes[level], sizes[level - 1]);
    let columns = Span::new(fine.0, coarse.0, x);
    let rows = Span::new(fine.1, coarse.1, y);
    let children = (rows.start..rows.end).flat_map(|y| (columns.start..columns.end).map(move |x| (x, y)));
    let mut candidates = Candidates::default();
    let mut mean = glam::Vec3::ZERO;
    let mut add = |stored: &[StoredLobe]| {
        candidates.push_stored(stored);
        mean += seed::mean_of(stored.iter().copied());
    };
    for (x, y) in children {
        match lobes.level(level - 1) {
            Some(finer) => add(finer.texel(x, y)),
            None => add(&[lobes.base_lobe(y * fine.0 + x)]),
        }
    }
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
