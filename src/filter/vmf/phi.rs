//! The squared distance between the shaded mixture and the shaded truth, in closed form.
//!
//! A mixture of lobes `(alpha_j, mu_j, kappa_j)` under Blinn-Phong of exponent s is a mixture of blurred lobes; the
//! integral over the sphere of its squared difference from the shaded truth is, up to a constant,
//!
//! `Phi = sum_s w_s [ sum_jk alpha_j alpha_k v(mu_j.mu_k; K_jk) - 2 sum_j alpha_j sum_i w_i v(n_i.mu_j; K_j) ]`
//!
//! with v the density of [`crate::sphere::vmf`], `A(K_j) = A(kappa_j) a^2`, `A(K_jk) = A(kappa_j) A(kappa_k) a^2` and
//! `a = (s+1)/(s+2)`, the mean cosine of Blinn-Phong: two convolutions multiply first moments, and the result is taken
//! for the lobe of that moment. So no directions need be sampled, and the gradient is a few sums over the normals.

use std::f64::consts::TAU;

use glam::DVec3;

use super::em::TexelLobes;
use super::lanes::exp_of_negative;
use super::lobe_lanes::banerjee_correction;
use super::samples::Samples;
use super::shaded::{self, MATERIALS, ShadedLobes, ShadedSums};
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::{self, KAPPA_DELTA};

/// What each material's squared distance counts, before it is divided by the fit's own energy there.
pub const IMPORTANCE: [f64; MATERIALS.len()] = [16.0, 4.0, 1.0];

/// The least concentration that a step may lead to; below, a lobe is uniform.
pub const KAPPA_MIN: f64 = 1e-2;

/// A concentration with `A` and its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Width {
    /// K.
    pub kappa: f64,
    /// `A(K)`.
    pub length: f64,
    /// `A'(K)`.
    pub slope: f64,
    /// `A''(K)`.
    pub curvature: f64,
    /// The density at the lobe's own direction.
    pub peak: f64,
}

impl Width {
    /// Of a concentration above 0. With `e = exp(-2K)`, `coth K = (1+e)/(1-e)` and `1/sinh^2 K = 4e/(1-e)^2`. To 2e-5:
    /// e is in single precision.
    pub fn of_kappa(kappa: f64) -> Self {
        let inverse = 1.0 / kappa;
        let square = inverse * inverse;
        if kappa > 20.0 {
            // e^-40 is nothing beside 1.
            let (length, curvature) = (1.0 - inverse, -2.0 * square * inverse);
            return Self { kappa, length, slope: square, curvature, peak: kappa / TAU };
        }
        if kappa < 0.3 {
            return Self::of_small_kappa(kappa);
        }
        let e = f64::from(exp_of_negative::<false>((-2.0 * kappa) as f32));
        let inverse_rest = 1.0 / (1.0 - e);
        let coth = (1.0 + e) * inverse_rest;
        let csch_squared = 4.0 * e * inverse_rest * inverse_rest;
        Self {
            kappa,
            length: coth - inverse,
            slope: square - csch_squared,
            curvature: 2.0 * (csch_squared * coth - square * inverse),
            peak: kappa * inverse_rest / TAU,
        }
    }

    /// Where the closed forms cancel, their series in K: `A = K/3 - K^3/45 + 2 K^5/945 - K^7/4725`.
    fn of_small_kappa(kappa: f64) -> Self {
        let k2 = kappa * kappa;
        Self {
            kappa,
            length: kappa * (1.0 / 3.0 - k2 * (1.0 / 45.0 - k2 * (2.0 / 945.0 - k2 / 4725.0))),
            slope: 1.0 / 3.0 - k2 * (1.0 / 15.0 - k2 * (2.0 / 189.0 - k2 / 675.0)),
            curvature: kappa * (-2.0 / 15.0 + k2 * (8.0 / 189.0 - k2 * 6.0 / 675.0)),
            peak: (1.0 + kappa + k2 * (1.0 / 3.0 - k2 * (1.0 / 45.0 - k2 * 2.0 / 945.0))) / (2.0 * TAU),
        }
    }

    /// Of a length between 0 and 1, by the E-step's inverse without iterations; to 1e-5.
    pub fn of_length(length: f64) -> Self {
        let shortfall = 1.0 - length;
        if shortfall < 0.05 {
            return Self::of_kappa(1.0 / shortfall);
        }
        let square = length * length;
        let banerjee = length * (3.0 - square) / (1.0 - square);
        let kappa = banerjee * f64::from(banerjee_correction::<false>((2.0 * square - 1.0) as f32));
        Self::of_kappa(kappa.max(1e-6))
    }
}

/// The lobes of a texel in the terms in which they are moved; empty slots are left out.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Lobes in use.
    pub count: usize,
    /// The slot each came from.
    slot: [usize; MAX_LOBES],
    /// Weights, above 0, of sum 1.
    pub alpha: [f64; MAX_LOBES],
    /// Mean directions.
    pub mu: [DVec3; MAX_LOBES],
    /// `ln kappa`.
    pub log_kappa: [f64; MAX_LOBES],
}

impl Parameters {
    /// Reads the lobes in use.
    pub fn of(lobes: &TexelLobes) -> Self {
        let mut own = Self {
            count: 0,
            slot: [0; MAX_LOBES],
            alpha: [0.0; MAX_LOBES],
            mu: [DVec3::Z; MAX_LOBES],
            log_kappa: [0.0; MAX_LOBES],
        };
        for slot in (0..lobes.count).filter(|&slot| lobes.alpha[slot] > f64::from(EMPTY_WEIGHT)) {
            let resultant = lobes.resultant[slot];
            let j = own.count;
            own.slot[j] = slot;
            own.alpha[j] = lobes.alpha[slot];
            own.mu[j] = resultant.try_normalize().unwrap_or(DVec3::Z);
            own.log_kappa[j] = vmf::concentration(1.0 - resultant.length()).clamp(KAPPA_MIN, KAPPA_DELTA).ln();
            own.count += 1;
        }
        own
    }

    /// Writes the lobes back to the slots they came from.
    pub fn store(&self, lobes: &mut TexelLobes) {
        for j in 0..self.count {
            lobes.alpha[self.slot[j]] = self.alpha[j];
            lobes.resultant[self.slot[j]] = Width::of_kappa(self.log_kappa[j].exp()).length * self.mu[j];
        }
    }

    /// The parameters after a step of every lobe: factors on the weights as logarithms, tangent vectors added to the
    /// directions, logarithms of factors on kappa. Weights are made to sum to 1.
    pub fn moved(&self, step: &[LobeStep; MAX_LOBES]) -> Self {
        let mut moved = *self;
        for (j, step) in step.iter().enumerate().take(self.count) {
            moved.alpha[j] *= step.log_alpha.exp();
            moved.mu[j] = (self.mu[j] + step.tangent).try_normalize().unwrap_or(self.mu[j]);
            moved.log_kappa[j] = (self.log_kappa[j] + step.log_kappa).clamp(KAPPA_MIN.ln(), KAPPA_DELTA.ln());
        }
        let total: f64 = moved.alpha[..self.count].iter().sum();
        moved.alpha[..self.count].iter_mut().for_each(|alpha| *alpha /= total);
        moved
    }
}

/// A step of one lobe.
#[derive(Clone, Copy, Debug, Default)]
pub struct LobeStep {
    /// Logarithm of the factor on the weight.
    pub log_alpha: f64,
    /// Added to the direction, at right angles to it.
    pub tangent: DVec3,
    /// Logarithm of the factor on kappa.
    pub log_kappa: f64,
}

/// Two blurred lobes under one material.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pair {
    /// `v(mu_j.mu_k; K_jk)`.
    pub value: f64,
    /// K_jk.
    pub width: Width,
}

/// A blurred lobe on the data under one material: the mean of v over the normals, and its gradient.
#[derive(Clone, Copy, Debug, Default)]
pub struct DataTerm {
    /// The mean.
    pub value: f64,
    /// Its gradient in mu; only the part at right angles to mu means anything.
    pub direction: DVec3,
    /// Its derivative by `ln kappa`.
    pub log_kappa: f64,
}

/// Pairs `j <= k` of up to [`MAX_LOBES`] lobes.
const PAIRS: usize = MAX_LOBES * (MAX_LOBES + 1) / 2;

/// The place of pair `j <= k`.
pub fn pair_index(j: usize, k: usize) -> usize {
    k * (k + 1) / 2 + j
}

/// Phi's parts at one place, with what its derivatives need.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Where.
    pub at: Parameters,
    /// `A(kappa_j)` and its derivatives.
    pub own: [Width; MAX_LOBES],
    /// Lobes on the data.
    pub data: [[DataTerm; MATERIALS.len()]; MAX_LOBES],
    /// Lobes on lobes.
    pub pairs: [[Pair; PAIRS]; MATERIALS.len()],
}

/// `a^2 = ((s+1)/(s+2))^2` of each material.
pub const MOMENTS: [f64; MATERIALS.len()] = {
    let mut moments = [0.0; MATERIALS.len()];
    let mut material = 0;
    while material < MATERIALS.len() {
        let mean = (MATERIALS[material] + 1.0) / (MATERIALS[material] + 2.0);
        moments[material] = mean * mean;
        material += 1;
    }
    moments
};

impl Evaluation {
    /// Room for an evaluation at `at`: 24 KiB, which are better filled anew than made anew.
    pub fn empty(at: Parameters) -> Self {
        Self {
            at,
            own: [Width::default(); MAX_LOBES],
            data: [[DataTerm::default(); MATERIALS.len()]; MAX_LOBES],
            pairs: [[Pair::default(); PAIRS]; MATERIALS.len()],
        }
    }

    /// Phi's parts at `at`; `None` where no sample has weight.
    pub fn new(samples: &impl Samples, at: Parameters) -> Option<Self> {
        let mut evaluation = Self::empty(at);
        evaluation.move_to(samples, at).then_some(evaluation)
    }

    /// Evaluates Phi's parts at `at`; false where no sample has weight.
    pub fn move_to(&mut self, samples: &impl Samples, at: Parameters) -> bool {
        let Self { at: place, own, data, pairs } = self;
        *place = at;
        for (own, log_kappa) in own.iter_mut().zip(at.log_kappa).take(at.count) {
            *own = Width::of_kappa(log_kappa.exp());
        }
        let Some(terms) = data_terms(samples, &at, own) else { return false };
        *data = terms;
        for (pairs, moment) in pairs.iter_mut().zip(MOMENTS) {
            for k in 0..at.count {
                for j in 0..=k {
                    let width = Width::of_length(moment * own[j].length * own[k].length);
                    let exponent = -0.5 * width.kappa * at.mu[j].distance_squared(at.mu[k]);
                    let density = f64::from(exp_of_negative::<false>(exponent as f32));
                    pairs[pair_index(j, k)] = Pair { value: width.peak * density, width };
                }
            }
        }
        true
    }

    /// The integral of the shaded mixture's square.
    fn energy(&self, material: usize) -> f64 {
        let mut sum = 0.0;
        for k in 0..self.at.count {
            for j in 0..=k {
                let twice = if j == k { 1.0 } else { 2.0 };
                sum += twice * self.at.alpha[j] * self.at.alpha[k] * self.pairs[material][pair_index(j, k)].value;
            }
        }
        sum
    }

    /// w_s: what each material counts by, over the energy here.
    pub fn weights(&self) -> [f64; MATERIALS.len()] {
        std::array::from_fn(|material| IMPORTANCE[material] / self.energy(material).max(f64::MIN_POSITIVE))
    }

    /// Phi with these weights of the materials.
    pub fn phi(&self, weights: &[f64; MATERIALS.len()]) -> f64 {
        let of_material = |material: usize| {
            let data: f64 = (0..self.at.count).map(|j| self.at.alpha[j] * self.data[j][material].value).sum();
            weights[material] * (self.energy(material) - 2.0 * data)
        };
        (0..MATERIALS.len()).map(of_material).sum()
    }
}

/// Every lobe on the data under every material, in one pass over the samples.
fn data_terms(
    samples: &impl Samples,
    at: &Parameters,
    own: &[Width; MAX_LOBES],
) -> Option<[[DataTerm; MATERIALS.len()]; MAX_LOBES]> {
    let mut widths = [[Width::default(); MATERIALS.len()]; MAX_LOBES];
    let mut lobes = ShadedLobes { count: at.count, ..ShadedLobes::default() };
    for j in 0..at.count {
        lobes.mu[j] = at.mu[j].as_vec3().to_array();
        for (material, moment) in MOMENTS.into_iter().enumerate() {
            widths[j][material] = Width::of_length(moment * own[j].length);
            lobes.neg_half_kappa[j][material] = (-0.5 * widths[j][material].kappa) as f32;
        }
    }
    let sums: ShadedSums = samples.sum(|slices, sums| shaded::accumulate(slices, &lobes, sums));
    if sums.total <= 0.0 {
        return None;
    }
    let mut terms = [[DataTerm::default(); MATERIALS.len()]; MAX_LOBES];
    for j in 0..at.count {
        for (material, moment) in MOMENTS.into_iter().enumerate() {
            let (width, sum) = (&widths[j][material], &sums.density[j][material]);
            let scale = width.peak / sums.total;
            let deviation = scale * DVec3::from(sum.deviation);
            // n.mu = 1 + (n - mu).mu, and dv/dK = v (n.mu - A(K)).
            let by_kappa = scale * sum.value * (1.0 - width.length) + deviation.dot(at.mu[j]);
            terms[j][material] = DataTerm {
                value: scale * sum.value,
                direction: width.kappa * deviation,
                log_kappa: by_kappa * moment * own[j].slope * own[j].kappa / width.slope,
            };
        }
    }
    Some(terms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_width_has_the_derivatives_of_its_length() {
        for exponent in -40..=50 {
            let kappa = 10.0_f64.powf(f64::from(exponent) / 10.0);
            let width = Width::of_kappa(kappa);
            let near = |value: f64, exact: f64| assert!((value / exact - 1.0).abs() < 3e-5, "{kappa}: {value} {exact}");
            near(width.peak, vmf::log_peak(kappa).exp());
            let exact = if kappa > 50.0 { 1.0 - 1.0 / kappa } else { vmf::mean_resultant_length(kappa) };
            near(width.length, exact);
            near(Width::of_length(width.length).kappa, kappa);
            if (0.1..40.0).contains(&kappa) {
                let step = 1e-3 * kappa;
                let [below, above] = [kappa - step, kappa + step].map(vmf::mean_resultant_length);
                near(width.slope, (above - below) / (2.0 * step));
                let curvature = (above - 2.0 * exact + below) / (step * step);
                assert!((width.curvature / curvature - 1.0).abs() < 1e-3, "{kappa}: {} {curvature}", width.curvature);
            }
        }
    }
}
