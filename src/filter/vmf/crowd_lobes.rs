//! The mixtures of a crowd's texels, a texel a lane, with the lobes that its E-step reads.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use std::f32::consts::LOG2_E;

use glam::{DVec3, Vec3};
use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::em::TexelLobes;
use super::kernel::{LOG_ZERO, ReadLobes};
use super::lanes::{LANES, Lanes};
use super::lobe_lanes::LobeLanes;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;
use crate::sphere::vmf::KappaRule;

/// The mixtures of a crowd's texels, by slot.
#[derive(Clone, Debug)]
pub struct CrowdLobes {
    /// Slots in use.
    pub count: usize,
    pub(super) rule: KappaRule,
    /// Weights; 0 is an empty slot.
    pub(super) alpha: [Lanes; MAX_LOBES],
    /// Mean resultant vectors, by axis.
    pub(super) resultant: [[Lanes; 3]; MAX_LOBES],
    /// The lobes of the E-step.
    pub(super) lobes: [LobeLanes; MAX_LOBES],
}

impl ReadLobes for CrowdLobes {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count.min(MAX_LOBES)
    }

    #[inline(always)]
    fn lobe(&self, j: usize) -> LobeLanes {
        self.lobes[j]
    }
}

/// Which lanes a step may change.
pub type Mask = [bool; LANES];

impl CrowdLobes {
    /// Empty slots.
    pub fn empty(count: usize, rule: KappaRule) -> Self {
        let zero = Lanes::splat(0.0);
        Self {
            count: count.min(MAX_LOBES),
            rule,
            alpha: [zero; MAX_LOBES],
            resultant: [[zero; 3]; MAX_LOBES],
            lobes: [LobeLanes::EMPTY; MAX_LOBES],
        }
    }

    /// Sets one texel's mixture; [`Self::prepare`] makes it count.
    pub fn set(&mut self, lane: usize, lobes: &TexelLobes) {
        for j in 0..self.count.min(lobes.count) {
            self.alpha[j].0[lane] = lobes.alpha[j] as f32;
            let resultant = lobes.resultant[j].as_vec3().to_array();
            self.resultant[j].iter_mut().zip(resultant).for_each(|(lanes, r)| lanes.0[lane] = r);
        }
    }

    /// Works out the lobes of the E-step from weights and resultants.
    pub fn prepare(&mut self) {
        prepare(self);
    }

    /// Makes the E-step's lobes of one texel centres of equal concentration and peak, to which an E-step assigns.
    pub fn set_centres(&mut self, lane: usize, centres: &[Vec3], kappa: f32) {
        for (j, lobe) in self.lobes.iter_mut().enumerate().take(self.count) {
            let centre = centres.get(j);
            lobe.scale.0[lane] = if centre.is_some() { 0.0 } else { LOG_ZERO };
            lobe.factor.0[lane] = -0.5 * LOG2_E * kappa;
            let mu = centre.unwrap_or(&Vec3::Z).to_array();
            lobe.mu.iter_mut().zip(mu).for_each(|(lanes, mu)| lanes.0[lane] = mu);
        }
    }

    /// Takes one texel's lobes from another crowd.
    pub fn take(&mut self, other: &Self, lane: usize) {
        for j in 0..self.count {
            self.alpha[j].0[lane] = other.alpha[j].0[lane];
            let (own, theirs) = (&mut self.lobes[j], &other.lobes[j]);
            (own.factor.0[lane], own.scale.0[lane]) = (theirs.factor.0[lane], theirs.scale.0[lane]);
            for axis in 0..3 {
                self.resultant[j][axis].0[lane] = other.resultant[j][axis].0[lane];
                own.mu[axis].0[lane] = theirs.mu[axis].0[lane];
            }
        }
    }

    /// Writes the texels' mixtures to their slots, as many as `target` has; `total` is the weight of their normals, as
    /// for [`Self::texel`].
    pub fn store(&self, total: &[f32; LANES], target: &mut [StoredLobe]) {
        let mut channels = [[Lanes::splat(0.0); 4]; MAX_LOBES];
        write_channels(self, &mut channels);
        for (lane, texel) in target.chunks_exact_mut(self.count).enumerate() {
            if total[lane] > 0.0 {
                for ([alpha, x, y, z], stored) in channels.iter().zip(texel) {
                    *stored = [alpha.0[lane], x.0[lane], y.0[lane], z.0[lane]];
                }
            } else {
                TexelLobes::flat(self.count).store(texel);
            }
        }
    }

    /// One texel's mixture; `total` is the weight of its normals, and without any it is one flat lobe.
    pub fn texel(&self, lane: usize, total: f32) -> TexelLobes {
        if total <= 0.0 {
            return TexelLobes::flat(self.count);
        }
        let mut lobes = TexelLobes::empty(self.count);
        for j in 0..self.count {
            let [x, y, z] = self.resultant[j].map(|lanes| f64::from(lanes.0[lane]));
            lobes.alpha[j] = f64::from(self.alpha[j].0[lane]);
            lobes.resultant[j] = DVec3::new(x, y, z).clamp_length_max(1.0);
        }
        lobes
    }
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn prepare(lobes: &mut CrowdLobes) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for j in 0..lobes.count() {
        let resultant = &lobes.resultant[j];
        let mut shortfall = Lanes::splat(0.0);
        for i in 0..LANES {
            let (x, y, z) = (f64::from(resultant[0].0[i]), f64::from(resultant[1].0[i]), f64::from(resultant[2].0[i]));
            shortfall.0[i] = (1.0 - (x * x + y * y + z * z)) as f32;
        }
        lobes.lobes[j] = LobeLanes::new::<FMA>(&lobes.alpha[j], resultant, &shortfall, lobes.rule);
    }
}

/// `(alpha, alpha r)` by slot, `|r|` at most 1.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn write_channels(lobes: &CrowdLobes, channels: &mut [[Lanes; 4]; MAX_LOBES]) {
    for j in 0..lobes.count() {
        let ([x, y, z], [weight, vector @ ..]) = (&lobes.resultant[j], &mut channels[j]);
        for i in 0..LANES {
            let alpha = lobes.alpha[j].0[i];
            let (x, y, z) = (x.0[i], y.0[i], z.0[i]);
            let square = x * x + y * y + z * z;
            let scale = if square > 1.0 { alpha / square.sqrt() } else { alpha };
            weight.0[i] = alpha;
            (vector[0].0[i], vector[1].0[i], vector[2].0[i]) = (scale * x, scale * y, scale * z);
        }
    }
}
