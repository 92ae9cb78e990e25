//! The scanline alignments, `paper:C` and `map:C`: coarsest level first, texels in scanline order, each fitted from the
//! blend of the coarse texels around it while its parent and its visited neighbours [pull](Pull) its directions
//! (Han et al. 2007, section 7.3).
//!
//! Texels on one diagonal `x + 2 y` do not see each other, so a diagonal is fitted in parallel and the result is bit
//! for bit that of the scanline. Neighbours across the map's edge do not pull: most are not visited yet, and the others
//! would make every row wait for the end of the last.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::em::{EStep, TexelLobes};
use super::fit::{FitSettings, LevelStats};
use super::monitor::{Cancelled, Monitor};
use super::pull::{Pull, Unpulled};
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::FootprintSamples;
use super::smooth::{self, blend_down};
use super::trace::TracedRun;
use crate::normal_map::pyramid::{Footprint, Texel};
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::KappaRule;

/// The neighbours of the level that a scanline has visited.
const VISITED: [(i64, i64); 4] = [(-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Calls `visit` with the texels of each diagonal `x + 2 y = d`, d rising: every texel after its visited neighbours.
pub fn diagonals(width: usize, height: usize, mut visit: impl FnMut(&[(usize, usize)])) {
    let mut texels = Vec::with_capacity(width.div_ceil(2).min(height) + 1);
    for d in 0..width + 2 * (height - 1) {
        texels.clear();
        let first_row = (d + 1).saturating_sub(width).div_ceil(2);
        texels.extend((first_row..=(d / 2).min(height - 1)).map(|y| (d - 2 * y, y)));
        visit(&texels);
    }
}

/// Fits one level below the top; the next coarser one must be aligned already.
pub fn fit_level(
    lobes: &LobePyramid,
    level: usize,
    pull: Pull,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<(MixtureLevel, LevelStats), Cancelled> {
    let Some(coarse) = lobes.level(level + 1) else { return Err(Cancelled) };
    let (width, height) = lobes.map.level_sizes()[level];
    let mut mixtures = MixtureLevel::empty((width, height), settings.lobes);
    blend_down(coarse, &mut mixtures, lobes.map.options.addressing);
    let visits = (lobes.map.len() / (width * height) * settings.aligned_passes()) as u64;
    let mut fitted = Vec::with_capacity(height);
    diagonals(width, height, |texels| {
        let fit = |&texel: &(usize, usize)| {
            if monitor.is_cancelled() {
                return TexelLobes::empty(settings.lobes);
            }
            monitor.visited(level, visits);
            let seed = TexelLobes::from_stored(mixtures.texel(texel.0, texel.1));
            PulledTexel::new(lobes, coarse, &mixtures, texel, pull, settings).fit(seed, settings.aligned_passes())
        };
        texels.par_iter().map(fit).collect_into_vec(&mut fitted);
        for (&(x, y), lobes) in texels.iter().zip(&fitted) {
            let start = (y * width + x) * settings.lobes;
            lobes.store(&mut mixtures.stored[start..start + settings.lobes]);
        }
    });
    monitor.check()?;
    let stats = smooth::stats(&lobes.map, &mixtures, settings, monitor)?;
    Ok((mixtures, stats))
}

/// The iterations of one texel: its parent and its visited neighbours are as they were when it was fitted. The mean
/// log-likelihood before the first and after each; `None` where this level or the next coarser one is not fitted.
pub fn trace_texel(lobes: &LobePyramid, texel: Texel, settings: &FitSettings) -> Option<TracedRun> {
    let (level, coarse) = (lobes.level(texel.level)?, lobes.level(texel.level + 1)?);
    let (place, size) = ((texel.x, texel.y), (level.width, level.height));
    let pulled = PulledTexel::new(lobes, coarse, level, place, settings.align.pull()?, settings);
    let taps = smooth::coarse_taps(coarse, size, place, lobes.map.options.addressing);
    let seed: Vec<_> = (0..level.lobes).map(|slot| smooth::blend_slot(coarse, &taps, slot).to_array()).collect();
    let mut fit = TexelLobes::from_stored(&seed);
    let mut log_likelihood = Vec::new();
    for iteration in 0..=settings.aligned_passes() {
        log_likelihood.push(pulled.mean_log_likelihood(&fit)?);
        if iteration < settings.aligned_passes() {
            pulled.step(&mut fit)?;
        }
    }
    Some(TracedRun { name: "aligned iterations", log_likelihood })
}

/// One texel whose parent and visited neighbours are final.
#[derive(Clone, Copy, Debug)]
pub struct PulledTexel<'a> {
    samples: FootprintSamples<'a>,
    towards: [DVec3; MAX_LOBES],
    pull: Pull,
    rule: KappaRule,
    e_step: EStep,
}

impl<'a> PulledTexel<'a> {
    /// Texel `texel` of the level of `mixtures`, whose parents are in `coarse`.
    pub fn new(
        lobes: &'a LobePyramid,
        coarse: &MixtureLevel,
        mixtures: &MixtureLevel,
        texel: (usize, usize),
        pull: Pull,
        settings: &FitSettings,
    ) -> Self {
        let map = &lobes.map;
        let footprint = Footprint::new((map.width, map.height), (mixtures.width, mixtures.height), texel);
        let towards = directions_around(coarse, mixtures, texel);
        let (rule, e_step) = (settings.kappa, settings.e_step);
        Self { samples: FootprintSamples::new(map, footprint), towards, pull, rule, e_step }
    }

    /// `iterations` steps from `seed`; a flat lobe without a valid normal.
    pub fn fit(&self, seed: TexelLobes, iterations: usize) -> TexelLobes {
        let mut lobes = seed;
        for _ in 0..iterations {
            if self.step(&mut lobes).is_none() {
                return TexelLobes::flat(seed.count);
            }
        }
        lobes
    }

    /// One iteration: E-step, plain M-step, pull. Returns the mean log-likelihood before it, the pull's log-prior
    /// added, which never falls from one iteration to the next where the pull is [`Pull::Map`]: mu_j is best given
    /// kappa_j, then kappa_j given mu_j, a generalised EM (Dempster et al. 1977). `None` without a valid normal.
    pub fn step(&self, lobes: &mut TexelLobes) -> Option<f64> {
        let kernel = match self.e_step {
            EStep::WithAlpha => lobes.for_e_step(self.rule),
            EStep::AsPrinted => lobes.for_printed_e_step(self.rule),
        };
        let sums = self.samples.e_step(&kernel);
        if sums.total <= 0.0 {
            return None;
        }
        let log_prior = self.log_prior(lobes);
        lobes.m_step(&kernel, &sums);
        for j in 0..lobes.count {
            let (alpha, resultant) = (lobes.alpha[j], lobes.resultant[j]);
            if alpha > 0.0 {
                let kappa = -2.0 * f64::from(kernel.neg_half_kappa[j]);
                lobes.resultant[j] = self.pull.turned(Unpulled { kappa, alpha, resultant }, self.towards[j]);
            }
        }
        Some(sums.log_likelihood / sums.total + log_prior)
    }

    /// The mean log-likelihood without the prior; `None` without a valid normal.
    fn mean_log_likelihood(&self, lobes: &TexelLobes) -> Option<f64> {
        let sums = self.samples.e_step(&lobes.for_e_step(self.rule));
        (sums.total > 0.0).then(|| sums.log_likelihood / sums.total)
    }

    fn log_prior(&self, lobes: &TexelLobes) -> f64 {
        let mu = |j: usize| (lobes.alpha[j] > 0.0).then(|| lobes.resultant[j].try_normalize()).flatten();
        (0..lobes.count).map(|j| self.pull.log_prior(mu(j), self.towards[j])).sum()
    }
}

/// `sum_k alpha_jk mu_jk` over the parent and the visited neighbours, per slot.
fn directions_around(coarse: &MixtureLevel, mixtures: &MixtureLevel, (x, y): (usize, usize)) -> [DVec3; MAX_LOBES] {
    let mut sum = [DVec3::ZERO; MAX_LOBES];
    let mut add = |stored: &[[f32; 4]]| {
        for (slot, &stored) in stored.iter().enumerate().filter(|(_, stored)| stored[0] > EMPTY_WEIGHT) {
            let mu = Vec3::new(stored[1], stored[2], stored[3]).as_dvec3().normalize_or_zero();
            sum[slot] += f64::from(stored[0]) * mu;
        }
    };
    let parent = |index: usize, fine: usize, coarse: usize| (2 * index + 1) * coarse / (2 * fine);
    add(coarse.texel(parent(x, mixtures.width, coarse.width), parent(y, mixtures.height, coarse.height)));
    for (dx, dy) in VISITED {
        let (column, row) = (x as i64 + dx, y as i64 + dy);
        if (0..mixtures.width as i64).contains(&column) && row >= 0 {
            add(mixtures.texel(column as usize, row as usize));
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonals_visit_every_texel_once_and_after_its_visited_neighbours() {
        for (width, height) in [(1, 1), (1, 5), (7, 1), (6, 4), (5, 9)] {
            let mut order = vec![usize::MAX; width * height];
            let mut step = 0;
            diagonals(width, height, |texels| {
                for &(x, y) in texels {
                    assert_eq!(order[y * width + x], usize::MAX);
                    order[y * width + x] = step;
                }
                step += 1;
            });
            assert!(order.iter().all(|&step| step != usize::MAX), "{width}x{height}");
            for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
                for (dx, dy) in VISITED {
                    let (column, row) = (x as i64 + dx, y as i64 + dy);
                    if (0..width as i64).contains(&column) && row >= 0 {
                        assert!(order[row as usize * width + column as usize] < order[y * width + x]);
                    }
                }
            }
        }
    }
}
