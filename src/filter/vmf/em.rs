//! Spherical expectation maximisation of one texel (Banerjee et al. 2005; Han et al. 2007, Algorithm 1).
//!
//! E-step: `z_ij = alpha_j v_j(n_i) / sum_k alpha_k v_k(n_i)`; Han's print leaves out alpha, an error. M-step with
//! sample weights w_i: `alpha_j = sum_i w_i z_ij`, `r_j = sum_i w_i z_ij n_i / alpha_j`, `mu_j = r_j / |r_j|`,
//! `kappa_j = A^-1(|r_j|)`. The mean log-likelihood never falls from one iteration to the next, save where
//! [`KAPPA_MAX`] holds a lobe back.

use glam::DVec3;

use super::kernel::{self, KernelLobes, Sums};
use super::samples::Samples;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::{self, KAPPA_MAX, KappaRule};
use crate::sphere::{Lobe, StoredLobe};

/// A lobe whose share of the footprint falls below this is retired: it keeps its slot, empty.
const RETIRED: f64 = EMPTY_WEIGHT as f64;

/// The mixture of one texel while it is fitted, by slot.
#[derive(Clone, Copy, Debug)]
pub struct TexelLobes {
    /// Slots in use.
    pub count: usize,
    /// Weights; 0 is an empty slot.
    pub alpha: [f64; MAX_LOBES],
    /// Mean resultant vectors r_j of length at most 1; a stored lobe is `(alpha, alpha r)`.
    pub resultant: [DVec3; MAX_LOBES],
}

impl TexelLobes {
    /// Empty slots.
    pub fn empty(count: usize) -> Self {
        Self { count: count.min(MAX_LOBES), alpha: [0.0; MAX_LOBES], resultant: [DVec3::ZERO; MAX_LOBES] }
    }

    /// One flat delta, for a footprint without a valid normal.
    pub fn flat(count: usize) -> Self {
        let mut lobes = Self::empty(count);
        (lobes.alpha[0], lobes.resultant[0]) = (1.0, DVec3::Z);
        lobes
    }

    /// Reads stored lobes.
    pub fn from_stored(stored: &[StoredLobe]) -> Self {
        let mut lobes = Self::empty(stored.len());
        for (j, s) in stored.iter().enumerate().take(MAX_LOBES) {
            if s[0] >= EMPTY_WEIGHT {
                lobes.alpha[j] = f64::from(s[0]);
                lobes.resultant[j] = glam::Vec3::new(s[1], s[2], s[3]).as_dvec3() / f64::from(s[0]);
            }
        }
        lobes
    }

    /// The stored form of slot `j`.
    pub fn stored(&self, j: usize) -> StoredLobe {
        let r = (self.alpha[j] * self.resultant[j]).as_vec3();
        [self.alpha[j] as f32, r.x, r.y, r.z]
    }

    /// Writes every slot to `target`.
    pub fn store(&self, target: &mut [StoredLobe]) {
        target.iter_mut().enumerate().for_each(|(j, slot)| *slot = self.stored(j));
    }

    /// The lobes as the E-step reads them, kappa capped at [`KAPPA_MAX`] because equal normals would drive the
    /// likelihood to infinity.
    pub fn for_e_step(&self, rule: KappaRule) -> KernelLobes {
        let mut kernel = KernelLobes { count: self.count, ..Default::default() };
        for j in 0..self.count {
            if self.alpha[j] <= RETIRED {
                continue;
            }
            let length = self.resultant[j].length();
            let kappa = rule.concentration(1.0 - length).min(KAPPA_MAX);
            kernel.mu[j] = self.resultant[j].try_normalize().unwrap_or(DVec3::Z).as_vec3().to_array();
            kernel.neg_half_kappa[j] = (-0.5 * kappa) as f32;
            kernel.log_scale[j] = (self.alpha[j].ln() + vmf::log_peak(kappa)) as f32;
        }
        kernel
    }

    /// The lobes as Algorithm 1 is printed: without their weights.
    pub fn for_printed_e_step(&self, rule: KappaRule) -> KernelLobes {
        let mut kernel = self.for_e_step(rule);
        for j in (0..self.count).filter(|&j| self.alpha[j] > RETIRED) {
            kernel.log_scale[j] -= self.alpha[j].ln() as f32;
        }
        kernel
    }

    /// The plain M-step from the sums of an E-step under `kernel`.
    pub fn m_step(&mut self, kernel: &KernelLobes, sums: &Sums) {
        for j in 0..self.count {
            let weight = sums.weight[j];
            self.alpha[j] = weight / sums.total;
            if self.alpha[j] <= RETIRED {
                (self.alpha[j], self.resultant[j]) = (0.0, DVec3::ZERO);
                continue;
            }
            let mu = glam::Vec3::from(kernel.mu[j]).as_dvec3();
            self.resultant[j] = (mu + DVec3::from(sums.deviation[j]) / weight).clamp_length_max(1.0);
        }
    }

    /// Resultants replaced by the lengths that Banerjee's kappa stands for, so that it is what is stored and shown.
    pub fn settled(mut self, rule: KappaRule) -> Self {
        if rule == KappaRule::Exact {
            return self;
        }
        for j in 0..self.count {
            let lobe = Lobe {
                weight: self.alpha[j],
                mean_direction: self.resultant[j].try_normalize().unwrap_or(DVec3::Z),
                concentration: rule.concentration(1.0 - self.resultant[j].length()),
            };
            let stored = lobe.to_stored();
            self.resultant[j] = glam::Vec3::new(stored[1], stored[2], stored[3]).as_dvec3() / lobe.weight.max(1e-300);
        }
        self
    }
}

/// How normals are shared between lobes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EStep {
    /// By `alpha_j v_j(n)`, as a mixture has it.
    #[default]
    WithAlpha,
    /// By `v_j(n)` alone, as Han's Algorithm 1 is printed; an error that its author confirmed (Mikkelsen 2008), kept so
    /// that the paper's own result can be seen.
    AsPrinted,
}

/// When the iterations end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Most iterations.
    pub iterations: usize,
    /// Least gain in mean log-likelihood per normal that goes on.
    pub tolerance: f64,
}

/// A fitted texel.
#[derive(Clone, Copy, Debug)]
pub struct TexelFit {
    /// The mixture.
    pub lobes: TexelLobes,
    /// Its mean log-likelihood, per normal and steradian.
    pub mean_log_likelihood: f64,
    /// Iterations used.
    pub iterations: usize,
}

/// The E-step over all samples.
pub fn e_step(samples: &impl Samples, lobes: &KernelLobes) -> Sums {
    samples.sum(|slices, sums| kernel::accumulate(slices, lobes, sums))
}

/// Runs EM from `seed` over the footprint's normals; `watch` is told the mean log-likelihood of every E-step and returns
/// false to stop early.
/// Without a valid normal the result is one flat lobe.
pub fn fit(
    samples: &impl Samples,
    seed: TexelLobes,
    stop: Stop,
    rule: KappaRule,
    mut watch: impl FnMut(f64) -> bool,
) -> TexelFit {
    let mut lobes = seed;
    let (mut previous, mut iterations) = (f64::NEG_INFINITY, 0);
    loop {
        let kernel = lobes.for_e_step(rule);
        let sums = e_step(samples, &kernel);
        if sums.total <= 0.0 {
            return TexelFit { lobes: TexelLobes::flat(seed.count), mean_log_likelihood: 0.0, iterations };
        }
        let mean_log_likelihood = sums.log_likelihood / sums.total;
        let done = iterations >= stop.iterations || mean_log_likelihood - previous < stop.tolerance;
        if !watch(mean_log_likelihood) || done {
            return TexelFit { lobes: lobes.settled(rule), mean_log_likelihood, iterations };
        }
        previous = mean_log_likelihood;
        lobes.m_step(&kernel, &sums);
        iterations += 1;
    }
}

/// As [`fit`], with the E-step of [`EStep::AsPrinted`]: it lowers the likelihood as often as not, so it ends when the
/// likelihood changes by less than the tolerance.
pub fn fit_as_printed(
    samples: &impl Samples,
    seed: TexelLobes,
    stop: Stop,
    rule: KappaRule,
    mut watch: impl FnMut(f64) -> bool,
) -> TexelFit {
    let likelihood = Stop { iterations: 0, tolerance: 0.0 };
    let mut best = fit(samples, seed, likelihood, rule, &mut watch);
    for iteration in 1..=stop.iterations {
        let kernel = best.lobes.for_printed_e_step(rule);
        let sums = e_step(samples, &kernel);
        if sums.total <= 0.0 {
            break;
        }
        let mut lobes = best.lobes;
        lobes.m_step(&kernel, &sums);
        let mut proceed = true;
        let next = fit(samples, lobes, likelihood, rule, |mean| {
            proceed = watch(mean);
            proceed
        });
        let change = (next.mean_log_likelihood - best.mean_log_likelihood).abs();
        best = TexelFit { iterations: iteration, ..next };
        if change < stop.tolerance || !proceed {
            break;
        }
    }
    best
}
