//! Expectation maximisation of planar Gaussians over one footprint, with Tan's pull of the means.
//!
//! E-step `z_ij = alpha_i g_i(n_j) / sum_k alpha_k g_k(n_j)`. M-step, with M normals of weight 1,
//! `alpha_i = sum_j z_ij / M`, `mu_i = (sum_j z_ij n_j + c sum_k alpha_ki mu_ki) / (sum_j z_ij + c sum_k alpha_ki)` over
//! the neighbours k, and `sigma_i^2 = sum_j z_ij |n_j - mu_i|^2 / (2 sum_j z_ij)`; the paper divides the last by M once
//! more, a misprint.

use std::f64::consts::TAU;

use glam::DVec2;
use rayon::prelude::*;

use super::gaussian::{EMPTY_WEIGHT, MAX_GAUSSIANS, PlanarGaussian};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;

/// The least variance: a fifth of what rounding to 8 bits gives, `(2/255)^2 / 12`.
pub const LEAST_VARIANCE: f64 = 1e-6;
/// Most iterations.
const ITERATIONS: usize = 50;
/// The least gain in mean log-likelihood per normal that goes on.
const TOLERANCE: f64 = 1e-5;
/// Normals that one thread visits before others may help; sums over them are added in order.
const CHUNK: usize = 4096;

/// The Gaussians of one texel: as many slots as are asked for, the rest empty.
#[derive(Clone, Copy, Debug)]
pub struct PlanarMixture {
    /// Slots in use.
    pub count: usize,
    /// The Gaussians by slot.
    pub gaussians: [PlanarGaussian; MAX_GAUSSIANS],
}

impl PlanarMixture {
    /// `count` empty slots.
    pub fn empty(count: usize) -> Self {
        Self { count, gaussians: [PlanarGaussian::default(); MAX_GAUSSIANS] }
    }

    /// Reads stored Gaussians, slot by slot.
    pub fn from_stored(stored: &[[f32; 4]]) -> Self {
        let mut mixture = Self::empty(stored.len());
        for (gaussian, &stored) in mixture.gaussians.iter_mut().zip(stored) {
            *gaussian = PlanarGaussian::from_stored(stored).unwrap_or_default();
        }
        mixture
    }

    /// Writes the stored form, slot by slot.
    pub fn store(&self, target: &mut [[f32; 4]]) {
        target.iter_mut().zip(&self.gaussians).for_each(|(target, gaussian)| *target = gaussian.to_stored());
    }

    /// One flat normal, in the first slot.
    pub fn flat(count: usize) -> Self {
        let mut mixture = Self::empty(count);
        mixture.gaussians[0] = PlanarGaussian { weight: 1.0, mean: DVec2::ZERO, variance: 0.0 };
        mixture
    }
}

/// What the neighbours pull towards: `(sum_k alpha_ki, sum_k alpha_ki mu_ki)` per slot.
pub type Pull = [(f64, DVec2); MAX_GAUSSIANS];

/// Nobody pulls.
pub const NO_PULL: Pull = [(0.0, DVec2::ZERO); MAX_GAUSSIANS];

/// The normals of one footprint.
#[derive(Clone, Copy, Debug)]
pub struct PlanarSamples<'a> {
    map: &'a NormalMap,
    footprint: Footprint,
}

/// `sum z`, `sum z n` and `sum z |n|^2` per slot; the normals' weight and log-likelihood.
#[derive(Clone, Copy)]
struct Sums {
    weight: [f64; MAX_GAUSSIANS],
    first: [DVec2; MAX_GAUSSIANS],
    second: [f64; MAX_GAUSSIANS],
    total: f64,
    log_likelihood: f64,
}

impl Sums {
    const ZERO: Self = Self {
        weight: [0.0; MAX_GAUSSIANS],
        first: [DVec2::ZERO; MAX_GAUSSIANS],
        second: [0.0; MAX_GAUSSIANS],
        total: 0.0,
        log_likelihood: 0.0,
    };

    fn plus(mut self, other: &Self) -> Self {
        for slot in 0..MAX_GAUSSIANS {
            self.weight[slot] += other.weight[slot];
            self.first[slot] += other.first[slot];
            self.second[slot] += other.second[slot];
        }
        self.total += other.total;
        self.log_likelihood += other.log_likelihood;
        self
    }

    fn add(&mut self, slot: usize, weight: f64, normal: DVec2) {
        self.weight[slot] += weight;
        self.first[slot] += weight * normal;
        self.second[slot] += weight * normal.length_squared();
    }
}

/// How a mixture shares a normal among its slots; returns the normal's log-density.
type Share<'a> = &'a (dyn Fn(DVec2, &mut [f64; MAX_GAUSSIANS]) -> f64 + Sync);

impl<'a> PlanarSamples<'a> {
    /// The normals of `footprint`.
    pub fn new(map: &'a NormalMap, footprint: Footprint) -> Self {
        Self { map, footprint }
    }

    /// The valid normals with their areas.
    pub fn each(&self) -> impl Iterator<Item = (DVec2, f64)> + '_ {
        (self.footprint.rows.start..self.footprint.rows.end).flat_map(|y| self.row(y))
    }

    fn row(&self, y: usize) -> impl Iterator<Item = (DVec2, f64)> + '_ {
        (self.footprint.columns.start..self.footprint.columns.end).filter_map(move |x| {
            let normal = self.map.normal(y * self.map.width + x)?;
            Some((normal.truncate().as_dvec2(), f64::from(self.footprint.weight(x, y))))
        })
    }

    /// The sums over all normals, large footprints in parallel by whole rows.
    fn sums(&self, count: usize, share: Share<'_>) -> Sums {
        let rows = self.footprint.rows.start..self.footprint.rows.end;
        let of_rows = |rows: std::ops::Range<usize>| {
            let (mut sums, mut z) = (Sums::ZERO, [0.0; MAX_GAUSSIANS]);
            for (normal, area) in rows.flat_map(|y| self.row(y)) {
                sums.log_likelihood += area * share(normal, &mut z);
                sums.total += area;
                (0..count).for_each(|slot| sums.add(slot, area * z[slot], normal));
            }
            sums
        };
        if self.footprint.len() <= CHUNK {
            return of_rows(rows);
        }
        let step = (CHUNK / self.footprint.columns.len()).max(1);
        let starts: Vec<usize> = rows.clone().step_by(step).collect();
        let chunks: Vec<Sums> =
            starts.into_par_iter().map(|start| of_rows(start..(start + step).min(rows.end))).collect();
        chunks.iter().fold(Sums::ZERO, Sums::plus)
    }

    /// Groups the normals about `centres` and takes each group for a Gaussian: the paper's initial values.
    pub fn grouped(&self, centres: &[DVec2]) -> PlanarMixture {
        let sums = self.sums(centres.len(), &|normal, z| {
            let distance = |slot: &usize| centres[*slot].distance_squared(normal);
            let nearest = (0..centres.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            z.fill(0.0);
            z[nearest.unwrap_or(0)] = 1.0;
            0.0
        });
        let mut mixture = PlanarMixture::empty(centres.len());
        mixture.gaussians.iter_mut().zip(centres).for_each(|(gaussian, &centre)| gaussian.mean = centre);
        m_step(&mut mixture, &sums, 0.0, &NO_PULL);
        mixture
    }

    /// Runs EM from `mixture`, the means pulled with strength c; a flat normal where none is valid.
    pub fn fit(&self, mixture: PlanarMixture, c: f64, pull: &Pull) -> PlanarMixture {
        let (mut mixture, mut last) = (mixture, f64::NEG_INFINITY);
        for _ in 0..ITERATIONS {
            let log_scales = log_scales(&mixture);
            let current = mixture;
            let sums = self.sums(mixture.count, &|normal, z| responsibilities(&current, &log_scales, normal, z));
            if sums.total <= 0.0 {
                return PlanarMixture::flat(mixture.count);
            }
            m_step(&mut mixture, &sums, c, pull);
            let reached = sums.log_likelihood / sums.total;
            if reached - last < TOLERANCE {
                break;
            }
            last = reached;
        }
        mixture
    }
}

/// `ln alpha_i - ln (2 pi sigma_i^2)`.
fn log_scales(mixture: &PlanarMixture) -> [f64; MAX_GAUSSIANS] {
    mixture.gaussians.map(|gaussian| (gaussian.weight / (TAU * gaussian.variance.max(LEAST_VARIANCE))).ln())
}

/// `z_i` of one normal, the largest exponent taken out first; returns its log-density.
fn responsibilities(
    mixture: &PlanarMixture,
    log_scales: &[f64; MAX_GAUSSIANS],
    normal: DVec2,
    z: &mut [f64; MAX_GAUSSIANS],
) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for slot in 0..mixture.count {
        let gaussian = &mixture.gaussians[slot];
        let squared = gaussian.mean.distance_squared(normal) / gaussian.variance.max(LEAST_VARIANCE);
        z[slot] = log_scales[slot] - 0.5 * squared;
        most = most.max(z[slot]);
    }
    let mut total = 0.0;
    for z in &mut z[..mixture.count] {
        *z = (*z - most).exp();
        total += *z;
    }
    z[..mixture.count].iter_mut().for_each(|z| *z /= total);
    most + total.ln()
}

fn m_step(mixture: &mut PlanarMixture, sums: &Sums, c: f64, pull: &Pull) {
    let count = mixture.count;
    for (slot, (gaussian, &(pulling, towards))) in mixture.gaussians.iter_mut().zip(pull).enumerate().take(count) {
        let weight = sums.weight[slot];
        gaussian.weight = weight / sums.total;
        if gaussian.weight < EMPTY_WEIGHT {
            gaussian.weight = 0.0;
            continue;
        }
        gaussian.mean = (sums.first[slot] + c * towards) / (weight + c * pulling);
        let mean = sums.first[slot] / weight;
        // Spread about the normals' own mean, and that mean's distance from the pulled one.
        let spread = 0.5 * (sums.second[slot] / weight - mean.length_squared());
        gaussian.variance = (spread + 0.5 * mean.distance_squared(gaussian.mean)).max(LEAST_VARIANCE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    #[test]
    fn one_gaussian_has_the_mean_and_half_the_variance_of_both_axes() {
        let map = procedural::default_map();
        let size = (map.width, map.height);
        let samples = PlanarSamples::new(&map, Footprint::new(size, (1, 1), (0, 0)));
        let found = samples.fit(samples.grouped(&[DVec2::ZERO]), 0.0, &NO_PULL);
        let total: f64 = samples.each().map(|(_, area)| area).sum();
        let mean = samples.each().map(|(normal, area)| area * normal).sum::<DVec2>() / total;
        let variance =
            samples.each().map(|(normal, area)| 0.5 * area * normal.distance_squared(mean)).sum::<f64>() / total;
        let gaussian = found.gaussians[0];
        assert!((gaussian.weight - 1.0).abs() < 1e-12 && gaussian.mean.distance(mean) < 1e-12);
        assert!((gaussian.variance - variance).abs() < 1e-12, "{} {variance}", gaussian.variance);
    }

    #[test]
    fn em_never_lowers_the_likelihood_and_weights_sum_to_one() {
        let map = procedural::default_map();
        let samples = PlanarSamples::new(&map, Footprint::new((map.width, map.height), (8, 8), (3, 2)));
        let centres = [DVec2::new(0.3, 0.0), DVec2::new(-0.3, 0.0), DVec2::new(0.0, 0.3), DVec2::new(0.0, -0.3)];
        let (mut mixture, mut last) = (samples.grouped(&centres), f64::NEG_INFINITY);
        for _ in 0..30 {
            let (scales, current) = (log_scales(&mixture), mixture);
            let sums = samples.sums(4, &|normal, z| responsibilities(&current, &scales, normal, z));
            assert!(sums.log_likelihood >= last - 1e-9 * last.abs(), "{} after {last}", sums.log_likelihood);
            last = sums.log_likelihood;
            m_step(&mut mixture, &sums, 0.0, &NO_PULL);
            let weight: f64 = mixture.gaussians[..4].iter().map(|gaussian| gaussian.weight).sum();
            assert!((weight - 1.0).abs() < 1e-9);
        }
    }
}
