//! Phi and the equations of its Gauss-Newton steps for a crowd, a texel a lane: what [`super::phi`] and
//! [`super::gauss_newton`] work out for one texel, in single precision. The formulas are theirs.

use std::f32::consts::LOG2_E;

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::crowd::CrowdSamples;
use super::crowd_system::{CrowdSystem, EACH, Part, Tile};
use super::lane_width::LaneWidth;
use super::lanes::{LANES, Lanes, exp_of_negative, exp2_of_negative, mul_add};
use super::phi::{IMPORTANCE, MOMENTS, pair_index};
use super::shaded::MATERIALS;
use crate::sphere::mixture::MAX_LOBES;

const ZERO: Lanes = Lanes::splat(0.0);

/// How much each material counts, lane by lane.
pub type Weights = [Lanes; MATERIALS.len()];

/// A crowd's lobes in the terms in which they are moved; an empty slot has weight 0.
#[derive(Clone, Debug)]
pub struct CrowdParameters {
    /// Slots.
    pub count: usize,
    /// Weights, of sum 1.
    pub alpha: [Lanes; MAX_LOBES],
    /// Mean directions, by axis.
    pub mu: [[Lanes; 3]; MAX_LOBES],
    /// Concentrations.
    pub kappa: [Lanes; MAX_LOBES],
}

impl Default for CrowdParameters {
    fn default() -> Self {
        let up = [ZERO, ZERO, Lanes::splat(1.0)];
        Self { count: 0, alpha: [ZERO; MAX_LOBES], mu: [up; MAX_LOBES], kappa: [Lanes::splat(1.0); MAX_LOBES] }
    }
}

/// Two tangents at a lobe's direction, by axis.
pub type Frame = [[Lanes; 3]; 2];

/// Phi at one place, and the equations of a step from there.
#[derive(Clone, Debug)]
pub struct CrowdPhi {
    /// Phi.
    pub phi: Lanes,
    /// Half of Phi's gradient and the products of derivatives, without the lobes' factors alpha.
    pub system: CrowdSystem,
    /// Two tangents of every lobe.
    pub frames: [Frame; MAX_LOBES],
    /// `A(kappa)`, and what is left of 1.
    length: [Lanes; MAX_LOBES],
    shortfall: [Lanes; MAX_LOBES],
    /// `dA / d ln kappa`.
    slope: [Lanes; MAX_LOBES],
    /// The data's share of the gradient, then the mixture's.
    data: [Part; MAX_LOBES],
    model: [Part; MAX_LOBES],
}

impl Default for CrowdPhi {
    fn default() -> Self {
        let parts = [[ZERO; EACH]; MAX_LOBES];
        Self {
            phi: ZERO,
            system: CrowdSystem::default(),
            frames: [[[ZERO; 3]; 2]; MAX_LOBES],
            length: [ZERO; MAX_LOBES],
            shortfall: [ZERO; MAX_LOBES],
            slope: [ZERO; MAX_LOBES],
            data: parts,
            model: parts,
        }
    }
}

impl CrowdPhi {
    /// w_s: what each material counts by, over the energy of the mixtures at `at`.
    pub fn weights(&mut self, at: &CrowdParameters) -> Weights {
        let mut weights = [ZERO; MATERIALS.len()];
        widths(self, at);
        energies(at, self, &mut weights);
        for (weight, importance) in weights.iter_mut().zip(IMPORTANCE) {
            weight.0.iter_mut().for_each(|value| *value = importance as f32 / value.max(f32::MIN_POSITIVE));
        }
        weights
    }

    /// Evaluates Phi and the equations at `at`.
    pub fn move_to(&mut self, samples: &CrowdSamples, at: &CrowdParameters, weights: &Weights) {
        self.system.count = at.count;
        widths(self, at);
        data_terms(self, samples, at, weights);
        products(self, at, weights);
        centre(self, at);
    }
}

/// `1 - a^2 L` from what is left of 1 by L, of terms that are all positive: a product near 1 has lost the digits.
#[inline(always)]
fn shortfall(material: usize, left: f32) -> f32 {
    (1.0 - MOMENTS[material]) as f32 + MOMENTS[material] as f32 * left
}

/// `A(kappa)`, its derivative, and tangents (Duff et al. 2017) of every lobe.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn widths(own: &mut CrowdPhi, at: &CrowdParameters) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for j in 0..at.count {
        let [x, y, z] = &at.mu[j];
        let [first, second] = &mut own.frames[j];
        for i in 0..LANES {
            let width = LaneWidth::of_kappa::<FMA>(at.kappa[j].0[i]);
            (own.length[j].0[i], own.slope[j].0[i]) = (width.length, width.slope * width.kappa);
            own.shortfall[j].0[i] = width.shortfall;
            let (x, y, z) = (x.0[i], y.0[i], z.0[i]);
            let sign = 1.0_f32.copysign(z);
            let a = -1.0 / (sign + z);
            let b = x * y * a;
            (first[0].0[i], first[1].0[i], first[2].0[i]) = (1.0 + sign * x * x * a, sign * b, -sign * x);
            (second[0].0[i], second[1].0[i], second[2].0[i]) = (b, sign + y * y * a, -y);
        }
    }
}

/// The integral of the shaded mixture's square, by material.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn energies(at: &CrowdParameters, own: &CrowdPhi, energies: &mut Weights) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for k in 0..at.count {
        for j in 0..=k {
            let ([xj, yj, zj], [xk, yk, zk]) = (&at.mu[j], &at.mu[k]);
            let times = if j == k { 1.0 } else { 2.0 };
            for (material, energy) in energies.iter_mut().enumerate() {
                for i in 0..LANES {
                    let (dx, dy, dz) = (xj.0[i] - xk.0[i], yj.0[i] - yk.0[i], zj.0[i] - zk.0[i]);
                    let chord = dx * dx + dy * dy + dz * dz;
                    let left = own.shortfall[j].0[i] + own.length[j].0[i] * own.shortfall[k].0[i];
                    let width = LaneWidth::of_shortfall::<FMA>(shortfall(material, left));
                    let value = width.peak * exp_of_negative::<FMA>(-0.5 * width.kappa * chord);
                    energy.0[i] += times * at.alpha[j].0[i] * at.alpha[k].0[i] * value;
                }
            }
        }
    }
}

/// Every lobe on the data: the data's share of the gradient.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn data_terms(own: &mut CrowdPhi, samples: &CrowdSamples, at: &CrowdParameters, weights: &Weights) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let mut total = Lanes::splat(f32::MIN_POSITIVE);
    for w in samples.w() {
        total.add(w);
    }
    for j in 0..at.count {
        let (mu, frame, rest, slope) = (&at.mu[j], &own.frames[j], &own.shortfall[j], &own.slope[j]);
        let mut factors = [ZERO; MATERIALS.len()];
        for (material, factor) in factors.iter_mut().enumerate() {
            for i in 0..LANES {
                let kappa = LaneWidth::of_shortfall::<FMA>(shortfall(material, rest.0[i])).kappa;
                factor.0[i] = -0.5 * LOG2_E * kappa;
            }
        }
        let sums = sum_densities::<FMA>(samples, mu, &factors);
        let mut part = [ZERO; EACH];
        for (material, [value, dx, dy, dz]) in sums.iter().enumerate() {
            let moment = MOMENTS[material] as f32;
            for i in 0..LANES {
                let width = LaneWidth::of_shortfall::<FMA>(shortfall(material, rest.0[i]));
                let scale = weights[material].0[i] * width.peak / total.0[i];
                let value = scale * value.0[i];
                let (dx, dy, dz) = (scale * dx.0[i], scale * dy.0[i], scale * dz.0[i]);
                let along = |axes: &[Lanes; 3]| dx * axes[0].0[i] + dy * axes[1].0[i] + dz * axes[2].0[i];
                let by_kappa = value * width.shortfall + along(mu);
                part[0].0[i] += value;
                part[1].0[i] += width.kappa * along(&frame[0]);
                part[2].0[i] += width.kappa * along(&frame[1]);
                part[3].0[i] += by_kappa * moment * slope.0[i] / width.slope;
            }
        }
        own.data[j] = part;
    }
}

/// `sum_i w_i e_i` and `sum_i w_i e_i (n_i - mu)` of one lobe under every material.
#[inline(always)]
fn sum_densities<const FMA: bool>(
    samples: &CrowdSamples,
    mu: &[Lanes; 3],
    factors: &[Lanes; MATERIALS.len()],
) -> [[Lanes; 4]; MATERIALS.len()] {
    let mut acc = [[ZERO; 4]; MATERIALS.len()];
    let (xs, ys, zs, ws) = (samples.x(), samples.y(), samples.z(), samples.w());
    let [mx, my, mz] = *mu;
    let factors = *factors;
    for (((x, y), z), w) in xs.iter().zip(ys).zip(zs).zip(ws) {
        for i in 0..LANES {
            let (dx, dy, dz) = (x.0[i] - mx.0[i], y.0[i] - my.0[i], z.0[i] - mz.0[i]);
            let chord = mul_add::<FMA>(dz, dz, mul_add::<FMA>(dy, dy, dx * dx));
            for material in 0..MATERIALS.len() {
                let value = w.0[i] * exp2_of_negative::<FMA>(factors[material].0[i] * chord);
                acc[material][0].0[i] += value;
                acc[material][1].0[i] = mul_add::<FMA>(value, dx, acc[material][1].0[i]);
                acc[material][2].0[i] = mul_add::<FMA>(value, dy, acc[material][2].0[i]);
                acc[material][3].0[i] = mul_add::<FMA>(value, dz, acc[material][3].0[i]);
            }
        }
    }
    acc
}

/// The products of all lobes' derivatives, and what they make of the mixture's share of the gradient.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn products(own: &mut CrowdPhi, at: &CrowdParameters, weights: &Weights) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    own.model[..at.count].fill([ZERO; EACH]);
    for k in 0..at.count {
        for j in 0..=k {
            let tile = pair_products::<FMA>(own, at, weights, (j, k));
            let (mut model_j, mut model_k) = (own.model[j], own.model[k]);
            let (alpha_j, alpha_k) = (&at.alpha[j], &at.alpha[k]);
            for i in 0..LANES {
                for p in 0..EACH {
                    model_j[p].0[i] += alpha_k.0[i] * tile[p][0].0[i];
                    model_k[p].0[i] += alpha_j.0[i] * tile[0][p].0[i];
                }
            }
            own.model[j] = model_j;
            if j < k {
                own.model[k] = model_k;
            }
            own.system.tiles[pair_index(j, k)] = tile;
        }
    }
}

/// Sums over materials, for two lobes: of v, `K v` and `K^2 v`; of v's derivatives by `ln kappa` of the first lobe, of
/// the second and of both; and of `K v`'s by that of the first and of the second.
type PairSums = [Lanes; 8];

#[inline(always)]
fn pair_sums<const FMA: bool>(
    own: &CrowdPhi,
    at: &CrowdParameters,
    weights: &Weights,
    (j, k): (usize, usize),
) -> PairSums {
    let mut sums = [ZERO; 8];
    let (mu_j, mu_k) = (at.mu[j], at.mu[k]);
    let (length_j, length_k, slope_j, slope_k) = (own.length[j], own.length[k], own.slope[j], own.slope[k]);
    let (rest_j, rest_k) = (own.shortfall[j], own.shortfall[k]);
    let (alpha_j, alpha_k) = (at.alpha[j], at.alpha[k]);
    for (material, weight) in weights.iter().enumerate() {
        let (moment, weight) = (MOMENTS[material] as f32, *weight);
        for i in 0..LANES {
            let (dx, dy, dz) = (mu_j[0].0[i] - mu_k[0].0[i], mu_j[1].0[i] - mu_k[1].0[i], mu_j[2].0[i] - mu_k[2].0[i]);
            let chord = dx * dx + dy * dy + dz * dz;
            let both_used = alpha_j.0[i] > 0.0 && alpha_k.0[i] > 0.0;
            let left = rest_j.0[i] + length_j.0[i] * rest_k.0[i];
            let width = LaneWidth::of_shortfall::<FMA>(shortfall(material, left));
            let density = weight.0[i] * width.peak * exp_of_negative::<FMA>(-0.5 * width.kappa * chord);
            let v = if both_used { density } else { 0.0 };
            let (kappa, inverse, off) = (width.kappa, 1.0 / width.slope, width.shortfall - 0.5 * chord);
            let scale = moment * inverse;
            let (in_j, in_k) = (scale * length_k.0[i] * slope_j.0[i], scale * length_j.0[i] * slope_k.0[i]);
            let bend = 1.0 - width.length * width.curvature * inverse * inverse;
            let in_both = scale * slope_j.0[i] * slope_k.0[i] * bend;
            let mixed = v * (1.0 + kappa * off);
            sums[0].0[i] += v;
            sums[1].0[i] += v * kappa;
            sums[2].0[i] += v * kappa * kappa;
            sums[3].0[i] += v * off * in_j;
            sums[4].0[i] += v * off * in_k;
            sums[5].0[i] += v * ((off * off - width.slope) * in_j * in_k + off * in_both);
            sums[6].0[i] += mixed * in_j;
            sums[7].0[i] += mixed * in_k;
        }
    }
    sums
}

/// The mixed derivatives of `v(u; K)` by lobe j's parameters (rows) and lobe k's (columns), over all materials; zeros
/// where either slot is empty.
#[inline(always)]
fn pair_products<const FMA: bool>(
    own: &CrowdPhi,
    at: &CrowdParameters,
    weights: &Weights,
    (j, k): (usize, usize),
) -> Tile {
    let [v0, v1, v2, by_j, by_k, by_both, mixed_j, mixed_k] = pair_sums::<FMA>(own, at, weights, (j, k));
    let mut tile = [[ZERO; EACH]; EACH];
    let (mu_j, mu_k, frame_j, frame_k) = (at.mu[j], at.mu[k], own.frames[j], own.frames[k]);
    for i in 0..LANES {
        let of = |axes: &[Lanes; 3]| [axes[0].0[i], axes[1].0[i], axes[2].0[i]];
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (direction_j, direction_k) = (of(&mu_j), of(&mu_k));
        let (first_j, second_j, first_k, second_k) =
            (of(&frame_j[0]), of(&frame_j[1]), of(&frame_k[0]), of(&frame_k[1]));
        let along_j = [dot(first_j, direction_k), dot(second_j, direction_k)];
        let along_k = [dot(first_k, direction_j), dot(second_k, direction_j)];
        let (v1, v2, mixed_j, mixed_k) = (v1.0[i], v2.0[i], mixed_j.0[i], mixed_k.0[i]);
        tile[0][0].0[i] = v0.0[i];
        tile[0][1].0[i] = v1 * along_k[0];
        tile[0][2].0[i] = v1 * along_k[1];
        tile[0][3].0[i] = by_k.0[i];
        tile[1][0].0[i] = v1 * along_j[0];
        tile[2][0].0[i] = v1 * along_j[1];
        tile[3][0].0[i] = by_j.0[i];
        tile[3][3].0[i] = by_both.0[i];
        tile[1][3].0[i] = mixed_k * along_j[0];
        tile[2][3].0[i] = mixed_k * along_j[1];
        tile[3][1].0[i] = mixed_j * along_k[0];
        tile[3][2].0[i] = mixed_j * along_k[1];
        tile[1][1].0[i] = v2 * along_j[0] * along_k[0] + v1 * dot(first_j, first_k);
        tile[1][2].0[i] = v2 * along_j[0] * along_k[1] + v1 * dot(first_j, second_k);
        tile[2][1].0[i] = v2 * along_j[1] * along_k[0] + v1 * dot(second_j, first_k);
        tile[2][2].0[i] = v2 * along_j[1] * along_k[1] + v1 * dot(second_j, second_k);
    }
    tile
}

/// Phi from the data's and the mixture's shares; then, in the equations, the mixture subtracted from the weights'
/// derivatives.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn centre(own: &mut CrowdPhi, at: &CrowdParameters) {
    let (mut phi, mut energy, mut mean) = (ZERO, ZERO, ZERO);
    for j in 0..at.count {
        let (data, model, right) = (&own.data[j], &own.model[j], &mut own.system.right[j]);
        for i in 0..LANES {
            let alpha = at.alpha[j].0[i];
            phi.0[i] += alpha * (model[0].0[i] - 2.0 * data[0].0[i]);
            energy.0[i] += alpha * model[0].0[i];
            mean.0[i] += alpha * (model[0].0[i] - data[0].0[i]);
        }
        for i in 0..LANES {
            let used = at.alpha[j].0[i] > 0.0;
            for p in 0..EACH {
                right[p].0[i] = if used { model[p].0[i] - data[p].0[i] } else { 0.0 };
            }
        }
    }
    for k in 0..at.count {
        for i in 0..LANES {
            let used = at.alpha[k].0[i] > 0.0;
            own.system.right[k][0].0[i] -= if used { mean.0[i] } else { 0.0 };
        }
        for j in 0..=k {
            let tile = &mut own.system.tiles[pair_index(j, k)];
            let (model_j, model_k, alpha_j, alpha_k) = (&own.model[j], &own.model[k], &at.alpha[j], &at.alpha[k]);
            for i in 0..LANES {
                let used = alpha_j.0[i] > 0.0 && alpha_k.0[i] > 0.0;
                let centred = energy.0[i] - model_j[0].0[i] - model_k[0].0[i];
                tile[0][0].0[i] += if used { centred } else { 0.0 };
                for p in 1..EACH {
                    tile[0][p].0[i] -= if used { model_k[p].0[i] } else { 0.0 };
                    tile[p][0].0[i] -= if used { model_j[p].0[i] } else { 0.0 };
                }
            }
        }
    }
    own.phi = phi;
}
