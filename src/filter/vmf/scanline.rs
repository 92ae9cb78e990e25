//! The paper's alignment, `paper:C`: coarsest level first, texels in scanline order, each pulled towards its parent
//! and its visited neighbours, `mu_j ~ r_j + C sum_k alpha_jk mu_jk` (Han et al. 2007, eq. 23).
//!
//! Given mu_j the best kappa_j is `A^-1(r_j . mu_j)`, not `A^-1(|r_j|)`, so `alpha (r_j . mu_j) mu_j` is stored.
//! Texels on one diagonal `x + 2 y` do not see each other, so a diagonal is fitted in parallel and the result is bit
//! for bit that of the scanline. Neighbours across the map's edge are not visited yet, and do not pull.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::em::TexelLobes;
use super::fit::{FitSettings, LevelStats};
use super::monitor::{Cancelled, Monitor};
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::FootprintSamples;
use super::smooth::{self, blend_down};
use crate::normal_map::pyramid::Footprint;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// EM iterations per texel: the paper says seldom more than ten.
pub const ITERATIONS: usize = 10;

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
    c: f32,
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
            fit_texel(lobes, coarse, &mixtures, texel, c, settings)
        };
        texels.par_iter().map(fit).collect_into_vec(&mut fitted);
        for (&(x, y), lobes) in texels.iter().zip(&fitted) {
            let start = (y * width + x) * settings.lobes;
            lobes.store(&mut mixtures.stored[start..start + settings.lobes]);
        }
    });
    monitor.check()?;
    let stats = smooth::likelihood(&lobes.map, &mixtures, settings, monitor)?;
    Ok((mixtures, LevelStats { mean_iterations: settings.aligned_passes() as f64, ..stats }))
}

/// Fits one texel whose parent and visited neighbours are final.
fn fit_texel(
    lobes: &LobePyramid,
    coarse: &MixtureLevel,
    mixtures: &MixtureLevel,
    texel: (usize, usize),
    c: f32,
    settings: &FitSettings,
) -> TexelLobes {
    let map = &lobes.map;
    let size = (mixtures.width, mixtures.height);
    let samples = FootprintSamples::new(map, Footprint::new((map.width, map.height), size, texel));
    let pull = pull(coarse, mixtures, texel).map(|sum| f64::from(c) * sum);
    let mut fit = TexelLobes::from_stored(mixtures.texel(texel.0, texel.1));
    for _ in 0..settings.aligned_passes() {
        let kernel = fit.for_e_step(settings.kappa);
        let sums = samples.e_step(&kernel);
        if sums.total <= 0.0 {
            return TexelLobes::flat(settings.lobes);
        }
        fit.m_step(&kernel, &sums);
        for (resultant, pull) in fit.resultant.iter_mut().zip(pull) {
            *resultant = pulled(*resultant, pull);
        }
    }
    fit
}

/// The resultant turned to `r + pull`, as long as its own projection on that direction.
fn pulled(resultant: DVec3, pull: DVec3) -> DVec3 {
    if pull == DVec3::ZERO {
        return resultant;
    }
    match (resultant + pull).try_normalize() {
        Some(mu) => resultant.dot(mu).max(0.0) * mu,
        None => resultant,
    }
}

/// `sum_k alpha_jk mu_jk` over the parent and the visited neighbours, per slot.
fn pull(coarse: &MixtureLevel, mixtures: &MixtureLevel, (x, y): (usize, usize)) -> [DVec3; MAX_LOBES] {
    let mut sum = [DVec3::ZERO; MAX_LOBES];
    let mut add = |stored: &[[f32; 4]]| {
        for (slot, &stored) in stored.iter().enumerate().filter(|(_, stored)| stored[0] > EMPTY_WEIGHT) {
            let mu = Vec3::new(stored[1], stored[2], stored[3]).normalize_or_zero().as_dvec3();
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
