//! The `smooth` alignment: neighbours speak in the E-step and leave the mean directions alone.
//!
//! Level by level downward. A texel starts from the blend of the four coarse texels around it; then Jacobi passes
//! over the level, each reading the previous one only, so that any number of threads gives the same bits. The
//! mixture of the E-step is `(1-b) own + b mean`, blended in `(alpha, alpha r)` space; the M-step is the plain one
//! on the texel's own normals, so `sum_j alpha_j r_j` stays the exact mean normal and interpolates exactly. It is a
//! heuristic, not the ascent of one objective: it stops by pass count.

use glam::Vec4;
use rayon::prelude::*;

use super::em::TexelLobes;
use super::fit::{FitSettings, LevelStats};
use super::kernel::KernelLobes;
use super::monitor::{Cancelled, Monitor};
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::FootprintSamples;
use super::unaligned::Totals;
use crate::filter::sampling::Grid;
use crate::normal_map::pyramid::Footprint;
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Jacobi passes per level.
pub const PASSES: usize = 20;

/// Jacobi passes per level where the steps of [`super::between`] follow: more gain nothing that is left after them.
pub const PASSES_BEFORE_STEPS: usize = 10;

/// Least weight of a lobe in the E-step's mixture, so that a slot which neighbours fill can be filled here.
const LEAST_WEIGHT: f64 = 0.02;

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
    for pass in 0..settings.aligned_passes() {
        let share = if pass == 0 { 0.0 } else { blend };
        let job = Pass { map, coarse, previous: &current, share, settings };
        next.stored.par_chunks_mut(settings.lobes).enumerate().try_for_each(|(index, target)| {
            monitor.check()?;
            let texel = (index % size.0, index / size.0);
            let visits = job.run(texel, target);
            monitor.visited(level, visits);
            Ok(())
        })?;
        std::mem::swap(&mut current, &mut next);
    }
    Ok(current)
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
    previous: &'a MixtureLevel,
    share: f32,
    settings: &'a FitSettings,
}

impl Pass<'_> {
    /// Fits one texel into `target`; returns the normals visited.
    fn run(&self, texel: (usize, usize), target: &mut [[f32; 4]]) -> u64 {
        let size = (self.previous.width, self.previous.height);
        let footprint = Footprint::new((self.map.width, self.map.height), size, texel);
        let samples = FootprintSamples::new(self.map, footprint);
        let kernel = self.mixture(texel);
        let sums = samples.e_step(&kernel);
        let mut lobes = TexelLobes::empty(target.len());
        if sums.total > 0.0 {
            lobes.m_step(&kernel, &sums);
        } else {
            lobes = TexelLobes::flat(target.len());
        }
        lobes.store(target);
        footprint.len() as u64
    }

    /// The mixture of the E-step: own and neighbours' lobes, small weights raised.
    fn mixture(&self, (x, y): (usize, usize)) -> KernelLobes {
        let previous = self.previous;
        let slots = self.settings.lobes;
        let own = y * previous.width + x;
        let mut blended = [Vec4::ZERO; MAX_LOBES];
        let mean = if self.share > 0.0 { self.mean(x, y) } else { [Vec4::ZERO; MAX_LOBES] };
        for (slot, value) in blended.iter_mut().enumerate().take(slots) {
            let stored = Vec4::from(previous.stored[own * slots + slot]);
            *value = stored * (1.0 - self.share) + mean[slot] * self.share;
        }
        let mut lobes = TexelLobes::from_stored(&blended.map(|stored| stored.to_array())[..slots]);
        let raised = |alpha: f64| if alpha > f64::from(EMPTY_WEIGHT) { alpha.max(LEAST_WEIGHT) } else { 0.0 };
        lobes.alpha = lobes.alpha.map(raised);
        let total: f64 = lobes.alpha.iter().sum();
        lobes.alpha.iter_mut().for_each(|alpha| *alpha /= total.max(f64::MIN_POSITIVE));
        lobes.for_e_step(self.settings.kappa)
    }

    /// The weighted mean of the neighbours' lobes and of the coarse texels around.
    fn mean(&self, x: usize, y: usize) -> [Vec4; MAX_LOBES] {
        let previous = self.previous;
        let addressing = self.map.options.addressing;
        let mut mean = [Vec4::ZERO; MAX_LOBES];
        let mut total = 1.0;
        for (dx, dy, weight) in NEIGHBOURS {
            let column = neighbour(x, dx, previous.width, addressing);
            let row = neighbour(y, dy, previous.height, addressing);
            let (Some(column), Some(row)) = (column, row) else { continue };
            total += weight;
            for (value, &stored) in mean.iter_mut().zip(previous.texel(column, row)) {
                *value += weight * Vec4::from(stored);
            }
        }
        let taps = coarse_taps(self.coarse, (previous.width, previous.height), (x, y), addressing);
        for (slot, value) in mean.iter_mut().enumerate().take(previous.lobes) {
            *value += blend_slot(self.coarse, &taps, slot);
        }
        mean.map(|value| value / total)
    }
}

/// The index `offset` away along an axis; `None` beyond an edge that does not wrap.
pub fn neighbour(index: usize, offset: i64, size: usize, addressing: Addressing) -> Option<usize> {
    let target = index as i64 + offset;
    match addressing {
        Addressing::Wrap => Some(target.rem_euclid(size as i64) as usize),
        Addressing::Clamp => (0..size as i64).contains(&target).then_some(target as usize),
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
    let totals = Totals::default();
    (0..size.0 * size.1).into_par_iter().try_for_each(|index| {
        monitor.check()?;
        let texel = (index % size.0, index / size.0);
        totals.add_log_likelihood(mean_log_likelihood(map, mixtures, texel, settings));
        Ok(())
    })?;
    Ok(totals.stats(size.0 * size.1))
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
