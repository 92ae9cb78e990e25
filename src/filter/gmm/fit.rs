//! Fitting every texel, aligned: coarsest level first, texels in scanline order, each pulled by its parent and its
//! visited neighbours with c = 1 (Tan et al. 2005, section 4.1).
//!
//! The top's normals are grouped about those farthest apart; a finer texel starts from its parent's Gaussians, so that
//! slot i means the same thing in both. Texels on one diagonal do not see each other and are fitted in parallel; the
//! result is that of the scanline, bit for bit. A base texel is one normal: a Gaussian of no width in the slot whose
//! merge with the parent's costs least, which shades there as the unfiltered normal does.

use glam::DVec2;
use rayon::prelude::*;

use super::em::{NO_PULL, PlanarMixture, PlanarSamples, Pull};
use super::gaussian::{MAX_GAUSSIANS, PlanarGaussian};
use crate::filter::channels::ChannelPyramid;
use crate::filter::vmf::scanline::diagonals;
use crate::filter::vmf::{Cancelled, Monitor};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::{Footprint, Texel};

/// The strength of the pull, as in all of the paper's experiments.
const PULL: f64 = 1.0;

/// The neighbours of the level that a scanline has visited.
const VISITED: [(isize, isize); 4] = [(-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Fits `count` Gaussians to every texel of every level.
pub fn fit(map: &NormalMap, count: usize, monitor: &Monitor) -> Result<ChannelPyramid, Cancelled> {
    let mut pyramid = ChannelPyramid::zeros(map, false, count);
    let sizes = map.level_sizes();
    let (first, top) = (pyramid.first_level, sizes.len() - 1);
    if top > 0 {
        top_mixture(map, count).store(&mut pyramid.levels[top - first]);
    }
    for level in (first.max(1)..top).rev() {
        fit_level(map, &mut pyramid, level, monitor)?;
    }
    monitor.check()?;
    if first > 0 {
        return Ok(pyramid);
    }
    let (base, coarse) = pyramid.levels.split_at_mut(1);
    let coarse = coarse.first().map(|stored| Coarser { size: sizes[1], stored, count });
    base[0].par_chunks_mut(count).enumerate().for_each(|(index, target)| {
        let Some(gaussian) = of_base_texel(map, index) else { return };
        let texel = (index % map.width, index / map.width);
        let slot = coarse.as_ref().map_or(0, |coarse| best_slot(&coarse.parent(texel, sizes[0]), gaussian.mean));
        target[slot] = gaussian.to_stored();
    });
    Ok(pyramid)
}

/// The Gaussian of a base texel, of no width; `None` where the texel is invalid.
pub fn of_base_texel(map: &NormalMap, index: usize) -> Option<PlanarGaussian> {
    let normal = map.normal(index)?;
    Some(PlanarGaussian { weight: 1.0, mean: normal.truncate().as_dvec2(), variance: 0.0 })
}

/// A texel's own fit, of a level that is not stored, from the mixture `seed` around it.
pub fn of_texel(map: &NormalMap, texel: Texel, seed: &[[f32; 4]]) -> PlanarMixture {
    let sizes = map.level_sizes();
    let footprint = Footprint::new(sizes[0], sizes[texel.level], (texel.x, texel.y));
    PlanarSamples::new(map, footprint).fit(PlanarMixture::from_stored(seed), 0.0, &NO_PULL)
}

/// A level that is done, seen from the next finer one.
struct Coarser<'a> {
    size: (usize, usize),
    stored: &'a [[f32; 4]],
    count: usize,
}

impl Coarser<'_> {
    /// The mixture around the middle of texel `(x, y)` of a level of `width` by `height`.
    fn parent(&self, (x, y): (usize, usize), (width, height): (usize, usize)) -> PlanarMixture {
        let (column, row) = ((2 * x + 1) * self.size.0 / (2 * width), (2 * y + 1) * self.size.1 / (2 * height));
        PlanarMixture::from_stored(&self.stored[(row * self.size.0 + column) * self.count..][..self.count])
    }
}

/// The slot whose merge with a normal of weight 1 costs least, `alpha / (1 + alpha) |n - mu|^2` with the variance that
/// the merge takes in; an empty slot costs nothing, but is taken last, for it has no neighbours to blend with.
fn best_slot(parent: &PlanarMixture, normal: DVec2) -> usize {
    let cost = |slot: usize| {
        let gaussian = &parent.gaussians[slot];
        let apart = gaussian.mean.distance_squared(normal) + 2.0 * gaussian.variance;
        if gaussian.weight > 0.0 { gaussian.weight / (1.0 + gaussian.weight) * apart } else { f64::INFINITY }
    };
    (0..parent.count).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(0)
}

/// The one texel of the top, which has nobody to align to.
fn top_mixture(map: &NormalMap, count: usize) -> PlanarMixture {
    let samples = PlanarSamples::new(map, Footprint::new((map.width, map.height), (1, 1), (0, 0)));
    let (centres, found) = farthest_apart(&samples, count);
    let mut seed = samples.grouped(&centres[..found]);
    seed.count = count;
    samples.fit(seed, 0.0, &NO_PULL)
}

/// Up to `count` normals, the one nearest to the mean first, then each the farthest from those before.
fn farthest_apart(samples: &PlanarSamples<'_>, count: usize) -> ([DVec2; MAX_GAUSSIANS], usize) {
    let mut centres = [DVec2::ZERO; MAX_GAUSSIANS];
    let total: f64 = samples.each().map(|(_, area)| area).sum();
    let mean = samples.each().map(|(normal, area)| area * normal).sum::<DVec2>() / total.max(f64::MIN_POSITIVE);
    let first = samples.each().map(|(normal, _)| normal);
    let nearest = first.min_by(|a, b| a.distance_squared(mean).total_cmp(&b.distance_squared(mean)));
    let Some(nearest) = nearest else { return (centres, 1) };
    centres[0] = nearest;
    for found in 1..count {
        let distance = |normal: DVec2| {
            centres[..found].iter().map(|centre| centre.distance_squared(normal)).fold(f64::INFINITY, f64::min)
        };
        let far = samples.each().map(|(normal, _)| (distance(normal), normal)).max_by(|a, b| a.0.total_cmp(&b.0));
        match far {
            Some((distance, normal)) if distance > 0.0 => centres[found] = normal,
            _ => return (centres, found),
        }
    }
    (centres, count)
}

/// A level below the top.
fn fit_level(map: &NormalMap, pyramid: &mut ChannelPyramid, level: usize, monitor: &Monitor) -> Result<(), Cancelled> {
    let (sizes, count) = (map.level_sizes(), pyramid.layers);
    let (width, height) = sizes[level];
    let index = level - pyramid.first_level;
    let (finer, coarse) = pyramid.levels.split_at_mut(index + 1);
    let coarser = Coarser { size: sizes[level + 1], stored: &coarse[0], count };
    let stored = &mut finer[index];
    let mut fitted = Vec::with_capacity(height);
    diagonals(width, height, |texels| {
        let fit = |&texel: &(usize, usize)| {
            let parent = coarser.parent(texel, sizes[level]);
            if monitor.is_cancelled() {
                return parent;
            }
            let samples = PlanarSamples::new(map, Footprint::new(sizes[0], sizes[level], texel));
            let mut pull = NO_PULL;
            add_pull(&mut pull, &parent);
            visited(texel, width, |index| {
                add_pull(&mut pull, &PlanarMixture::from_stored(&stored[index * count..][..count]));
            });
            samples.fit(parent, PULL, &pull)
        };
        texels.par_iter().map(fit).collect_into_vec(&mut fitted);
        for (&(x, y), mixture) in texels.iter().zip(&fitted) {
            mixture.store(&mut stored[(y * width + x) * count..][..count]);
        }
    });
    monitor.check()
}

/// Shows the neighbours that a scanline has visited before `(x, y)`, row-major.
fn visited((x, y): (usize, usize), width: usize, mut visit: impl FnMut(usize)) {
    for (dx, dy) in VISITED {
        if let (Some(column), Some(row)) = (x.checked_add_signed(dx), y.checked_add_signed(dy))
            && column < width
        {
            visit(row * width + column);
        }
    }
}

fn add_pull(pull: &mut Pull, mixture: &PlanarMixture) {
    for (pull, gaussian) in pull.iter_mut().zip(&mixture.gaussians) {
        pull.0 += gaussian.weight;
        pull.1 += gaussian.weight * gaussian.mean;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    #[test]
    fn every_texel_is_finite_and_its_weights_sum_to_one() {
        let map = procedural::default_map();
        let monitor = Monitor::new(Vec::new());
        let pyramid = fit(&map, 4, &monitor).expect("nobody cancels");
        for level in &pyramid.levels {
            for texel in level.chunks(4) {
                let weight: f32 = texel.iter().map(|stored| stored[0]).sum();
                assert!((weight - 1.0).abs() < 1e-5 && texel.as_flattened().iter().all(|v| v.is_finite()), "{texel:?}");
            }
        }
        monitor.cancel();
        assert!(fit(&map, 4, &monitor).is_err());
    }
}
