//! The `smooth` alignment: neighbours speak in the E-step and leave the mean directions alone.
//!
//! Level by level downward. A texel starts from the blend of the four coarse texels around it; then Jacobi passes
//! over the level, each reading the previous one only, so that any number of threads gives the same bits. The
//! mixture of the E-step is `(1-b) own + b mean`, blended in `(alpha, alpha r)` space; the M-step is the plain one
//! on the texel's own normals, so `sum_j alpha_j r_j` stays the exact mean normal and interpolates exactly. It is a
//! heuristic, not the ascent of one objective: it stops by pass count.

use std::ops::Range;

use glam::Vec4;
use rayon::prelude::*;

use super::bins::{self, BinnedSamples};
use super::crowd::{self, CrowdStop};
use super::crowd_channels::CrowdChannels;
use super::em::{self, TexelLobes};
use super::fit::{FitSettings, LevelStats};
use super::lanes::LANES;
use super::monitor::{Cancelled, Monitor};
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::FootprintSamples;
use super::trace::TracedRun;
use super::unaligned::{Totals, texels_in_run};
use crate::filter::sampling::Grid;
use crate::normal_map::pyramid::{Footprint, Texel};
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Jacobi passes per level.
pub const PASSES: usize = 20;

/// Jacobi passes per level where the steps of [`super::between`] follow: more gain nothing that is left after them.
pub const PASSES_BEFORE_STEPS: usize = 10;

/// Levels of at most so many texels keep their normals in cells, some 80 MB of them.
const MOST_BINNED: usize = 256;

/// Least weight of a lobe in the E-step's mixture, so that a slot which neighbours fill can be filled here.
const LEAST_WEIGHT: f32 = 0.02;

/// Edge neighbours count whole, diagonal ones a quarter.
const NEIGHBOURS: [(i64, i64, f32); 8] =
    [(0, -1, 1.0), (-1, 0, 1.0), (1, 0, 1.0), (0, 1, 1.0), (-1, -1, 0.25), (1, -1, 0.25), (-1, 1, 0.25), (1, 1, 0.25)];

/// Fits one level below the top; the next coarser one must be aligned already.
pub fn fit_level(
    lobes: &LobePyramid,
    level: usize,
    blend: f32,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<(MixtureLevel, LevelStats), Cancelled> {
    let mixtures = pass_over(lobes, level, blend, settings, monitor)?;
    let stats = stats(&lobes.map, &mixtures, settings, monitor)?;
    Ok((mixtures, stats))
}

/// The passes over one level.
pub fn pass_over(
    lobes: &LobePyramid,
    level: usize,
    blend: f32,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<MixtureLevel, Cancelled> {
    let Some(coarse) = lobes.level(level + 1) else { return Err(Cancelled) };
    let map = lobes.map.as_ref();
    let size = map.level_sizes()[level];
    let mut current = MixtureLevel::empty(size, settings.lobes);
    blend_down(coarse, &mut current, map.options.addressing);
    let mut next = current.clone();
    let bins = binned(map, size);
    for pass in 0..settings.aligned_passes() {
        let share = if pass == 0 { 0.0 } else { blend };
        let job = Pass { map, coarse, bins: &bins, previous: &current, share, settings };
        let run = texels_in_run(map, size);
        let fit_run =
            |room: &mut CrowdChannels, (index, target): (usize, &mut [StoredLobe])| -> Result<(), Cancelled> {
                monitor.check()?;
                let firsts = (index * run..).step_by(LANES);
                let crowds = firsts.zip(target.chunks_mut(settings.lobes * LANES));
                monitor.visited(level, crowds.map(|(first, target)| job.run(first, room, target)).sum());
                Ok(())
            };
        let runs = next.stored.par_chunks_mut(settings.lobes * run).enumerate();
        runs.try_for_each_init(|| CrowdChannels::empty(settings.lobes, settings.kappa), fit_run)?;
        std::mem::swap(&mut current, &mut next);
    }
    Ok(current)
}

/// The normals of a level's texels in cells, texel by texel, where they are visited at a fraction of the cost; else
/// nothing.
fn binned(map: &NormalMap, size: (usize, usize)) -> Vec<BinnedSamples> {
    let count = size.0 * size.1;
    if count > MOST_BINNED || map.len() / count < bins::WORTHWHILE {
        return Vec::new();
    }
    let footprint = |index: usize| Footprint::new((map.width, map.height), size, (index % size.0, index / size.0));
    (0..count).into_par_iter().map(|index| BinnedSamples::new(map, &footprint(index))).collect()
}

/// What a finished level came to.
pub fn stats(
    map: &NormalMap,
    mixtures: &MixtureLevel,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<LevelStats, Cancelled> {
    let stats = likelihood(map, mixtures, settings, monitor)?;
    Ok(LevelStats { mean_iterations: settings.aligned_passes() as f64, ..stats })
}

/// Seeds every texel of `fine` with the bilinear blend of the four coarse texels around it.
pub fn blend_down(coarse: &MixtureLevel, fine: &mut MixtureLevel, addressing: Addressing) {
    let (width, height, slots) = (fine.width, fine.height, fine.lobes);
    fine.stored.par_chunks_mut(slots).enumerate().for_each(|(index, target)| {
        let taps = coarse_taps(coarse, (width, height), (index % width, index / width), addressing);
        for (slot, stored) in target.iter_mut().enumerate() {
            *stored = blend_slot(coarse, &taps, slot).to_array();
        }
    });
}

/// The four coarse texels around a fine one, with bilinear weights.
pub fn coarse_taps(
    coarse: &MixtureLevel,
    fine_size: (usize, usize),
    (x, y): (usize, usize),
    addressing: Addressing,
) -> [(usize, f32); 4] {
    let grid = Grid { width: coarse.width, height: coarse.height, addressing };
    let centre = |index: usize, size: usize| (index as f32 + 0.5) / size as f32;
    grid.bilinear(glam::Vec2::new(centre(x, fine_size.0), centre(y, fine_size.1)))
}

/// One slot of a weighted blend of texels; nothing where the level has no such slot.
pub fn blend_slot(level: &MixtureLevel, taps: &[(usize, f32)], slot: usize) -> Vec4 {
    if slot >= level.lobes {
        return Vec4::ZERO;
    }
    taps.iter().map(|&(index, weight)| weight * Vec4::from(level.stored[index * level.lobes + slot])).sum()
}

/// One Jacobi pass over a level.
struct Pass<'a> {
    map: &'a NormalMap,
    coarse: &'a MixtureLevel,
    bins: &'a [BinnedSamples],
    previous: &'a MixtureLevel,
    share: f32,
    settings: &'a FitSettings,
}

impl Pass<'_> {
    /// Fits at most [`LANES`] texels from `first` on into `target`; returns the normals visited.
    fn run(&self, first: usize, channels: &mut CrowdChannels, target: &mut [StoredLobe]) -> u64 {
        let slots = self.settings.lobes;
        let (size, texels) = ((self.previous.width, self.previous.height), target.len() / slots);
        let of_crowd = crowd::with_crowd(self.map, size, first, texels, |samples, footprints| {
            (0..texels).for_each(|lane| channels.set(lane, &self.blended(first + lane)));
            let lobes = channels.lobes(LEAST_WEIGHT);
            let total = samples.step(lobes, &[true; LANES]);
            lobes.store(&total, target);
            footprints.iter().map(Footprint::len).sum::<usize>() as u64
        });
        of_crowd.unwrap_or_else(|| (first..).zip(target.chunks_mut(slots)).map(|(i, t)| self.run_one(i, t)).sum())
    }

    /// Fits one texel into `target`; returns the normals visited.
    fn run_one(&self, index: usize, target: &mut [StoredLobe]) -> u64 {
        let size = (self.previous.width, self.previous.height);
        let texel = (index % size.0, index / size.0);
        let footprint = Footprint::new((self.map.width, self.map.height), size, texel);
        let kernel = self.mixture(index).for_e_step(self.settings.kappa);
        let sums = match self.bins.get(index) {
            Some(bins) => em::e_step(bins, &kernel),
            None => FootprintSamples::new(self.map, footprint).e_step(&kernel),
        };
        let mut lobes = TexelLobes::empty(target.len());
        if sums.total > 0.0 {
            lobes.m_step(&kernel, &sums);
        } else {
            lobes = TexelLobes::flat(target.len());
        }
        lobes.store(target);
        footprint.len() as u64
    }

    /// The mixture of a texel's E-step: own and neighbours' lobes, small weights raised.
    fn mixture(&self, own: usize) -> TexelLobes {
        let blended = self.blended(own).map(|stored| stored.to_array());
        let mut lobes = TexelLobes::from_stored(&blended[..self.settings.lobes]);
        let least = f64::from(LEAST_WEIGHT);
        let raised = |alpha: f64| if alpha > f64::from(EMPTY_WEIGHT) { alpha.max(least) } else { 0.0 };
        lobes.alpha = lobes.alpha.map(raised);
        let total: f64 = lobes.alpha.iter().sum();
        lobes.alpha.iter_mut().for_each(|alpha| *alpha /= total.max(f64::MIN_POSITIVE));
        lobes
    }

    /// A texel's own channels and, for their share, the weighted mean of the neighbours' and of the coarse texels'
    /// around.
    fn blended(&self, own: usize) -> [Vec4; MAX_LOBES] {
        let previous = self.previous;
        let mut blended = [Vec4::ZERO; MAX_LOBES];
        let mut add = |level: &MixtureLevel, texel: usize, weight: f32| {
            let stored = &level.stored[texel * level.lobes..(texel + 1) * level.lobes];
            blended.iter_mut().zip(stored).for_each(|(sum, &stored)| *sum += weight * Vec4::from(stored));
        };
        add(previous, own, 1.0 - self.share);
        if self.share > 0.0 {
            let (size, texel) = ((previous.width, previous.height), (own % previous.width, own / previous.width));
            let addressing = self.map.options.addressing;
            let (around, count, total) = neighbours(size, texel, addressing);
            let share = self.share / (1.0 + total);
            for &(texel, weight) in &around[..count] {
                add(previous, texel, share * weight);
            }
            for &(texel, weight) in &coarse_taps(self.coarse, size, texel, addressing) {
                add(self.coarse, texel, share * weight);
            }
        }
        blended
    }
}

/// The texels around one that the map has, with their weights, how many they are and what they weigh together.
fn neighbours(
    (width, height): (usize, usize),
    (x, y): (usize, usize),
    addressing: Addressing,
) -> ([(usize, f32); NEIGHBOURS.len()], usize, f32) {
    let mut around = [(0, 0.0); NEIGHBOURS.len()];
    let (mut count, mut total) = (0, 0.0);
    for (dx, dy, weight) in NEIGHBOURS {
        if let (Some(column), Some(row)) = (neighbour(x, dx, width, addressing), neighbour(y, dy, height, addressing)) {
            around[count] = (row * width + column, weight);
            count += 1;
            total += weight;
        }
    }
    (around, count, total)
}

/// The index `offset` away along an axis; `None` beyond an edge that does not wrap.
pub fn neighbour(index: usize, offset: i64, size: usize, addressing: Addressing) -> Option<usize> {
    let target = index as i64 + offset;
    let inside = (0..size as i64).contains(&target);
    match addressing {
        // A division is slow, and seldom needed.
        Addressing::Wrap if !inside => Some(target.rem_euclid(size as i64) as usize),
        Addressing::Wrap | Addressing::Clamp => inside.then_some(target as usize),
    }
}

/// The mean log-likelihood of a level's final lobes.
pub fn likelihood(
    map: &NormalMap,
    mixtures: &MixtureLevel,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<LevelStats, Cancelled> {
    let size = (mixtures.width, mixtures.height);
    let run = texels_in_run(map, size);
    let of_run = |first: usize| {
        monitor.check()?;
        let mut totals = Totals::default();
        let end = (first + run).min(size.0 * size.1);
        for first in (first..end).step_by(LANES) {
            add_log_likelihoods(map, mixtures, first..end.min(first + LANES), settings, &mut totals);
        }
        Ok(totals)
    };
    let runs = (0..(size.0 * size.1).div_ceil(run)).into_par_iter().map(|index| of_run(index * run));
    Ok(runs.try_reduce(Totals::default, |a, b| Ok(a + b))?.stats())
}

/// Adds the mean log-likelihoods of at most [`LANES`] texels.
fn add_log_likelihoods(
    map: &NormalMap,
    mixtures: &MixtureLevel,
    texels: Range<usize>,
    settings: &FitSettings,
    totals: &mut Totals,
) {
    let size = (mixtures.width, mixtures.height);
    let place = |index: usize| (index % size.0, index / size.0);
    let of_crowd = crowd::with_crowd(map, size, texels.start, texels.len(), |samples, _| {
        let mut channels = CrowdChannels::empty(mixtures.lobes, settings.kappa);
        for (lane, index) in texels.clone().enumerate() {
            let (x, y) = place(index);
            mixtures.texel(x, y).iter().enumerate().for_each(|(slot, &stored)| channels.set_slot(lane, slot, stored));
        }
        samples.fit(channels.lobes(0.0), &CrowdStop { iterations: [0; LANES], tolerance: 0.0 }).mean_log_likelihood
    });
    match of_crowd {
        Some(means) => means[..texels.len()].iter().for_each(|&mean| totals.add_log_likelihood(f64::from(mean))),
        None => {
            texels.for_each(|i| totals.add_log_likelihood(mean_log_likelihood(map, mixtures, place(i), settings)));
        }
    }
}

/// The mean log-likelihood of one texel's normals under its stored lobes; 0 without a valid normal.
pub fn mean_log_likelihood(
    map: &NormalMap,
    mixtures: &MixtureLevel,
    texel: (usize, usize),
    settings: &FitSettings,
) -> f64 {
    let footprint = Footprint::new((map.width, map.height), (mixtures.width, mixtures.height), texel);
    let kernel = TexelLobes::from_stored(mixtures.texel(texel.0, texel.1)).for_e_step(settings.kappa);
    let sums = FootprintSamples::new(map, footprint).e_step(&kernel);
    if sums.total > 0.0 { sums.log_likelihood / sums.total } else { 0.0 }
}

/// The passes of one texel beside its neighbours' final lobes: the mean log-likelihood before the first pass and after
/// each. `None` where this level or the next coarser one is not fitted.
pub fn trace_texel(lobes: &LobePyramid, texel: Texel, blend: f32, settings: &FitSettings) -> Option<TracedRun> {
    let (level, coarse) = (lobes.level(texel.level)?, lobes.level(texel.level + 1)?);
    let (map, size) = (lobes.map.as_ref(), (level.width, level.height));
    let mut seeded = MixtureLevel::clone(level);
    let index = texel.y * size.0 + texel.x;
    let slots = index * level.lobes..(index + 1) * level.lobes;
    let taps = coarse_taps(coarse, size, (texel.x, texel.y), map.options.addressing);
    for (slot, stored) in seeded.stored[slots.clone()].iter_mut().enumerate() {
        *stored = blend_slot(coarse, &taps, slot).to_array();
    }
    let settings = FitSettings { lobes: level.lobes, ..*settings };
    let likelihood = |level: &MixtureLevel| mean_log_likelihood(map, level, (texel.x, texel.y), &settings);
    let mut log_likelihood = vec![likelihood(&seeded)];
    let mut target = vec![[0.0; 4]; level.lobes];
    for pass in 0..settings.aligned_passes() {
        let share = if pass == 0 { 0.0 } else { blend };
        Pass { map, coarse, bins: &[], previous: &seeded, share, settings: &settings }.run_one(index, &mut target);
        seeded.stored[slots.clone()].copy_from_slice(&target);
        log_likelihood.push(likelihood(&seeded));
    }
    Some(TracedRun { name: "aligned passes", log_likelihood })
}
