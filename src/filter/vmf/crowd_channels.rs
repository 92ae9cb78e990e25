//! The stored channels of a crowd's texels, and the lobes that they are.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use glam::Vec4;
use multiversion::multiversion;

use super::crowd::CrowdLobes;
use super::lanes::{LANES, Lanes};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::KappaRule;

/// `(alpha, alpha r)` of a crowd's texels, by slot.
#[derive(Clone, Debug)]
pub struct CrowdChannels {
    /// Slots in use.
    count: usize,
    channels: [[Lanes; 4]; MAX_LOBES],
}

impl CrowdChannels {
    /// Empty slots.
    pub fn empty(count: usize) -> Self {
        Self { count: count.min(MAX_LOBES), channels: [[Lanes::splat(0.0); 4]; MAX_LOBES] }
    }

    /// Sets one texel's slots.
    pub fn set(&mut self, lane: usize, stored: &[Vec4; MAX_LOBES]) {
        (0..self.count).for_each(|slot| self.set_slot(lane, slot, stored[slot].to_array()));
    }

    /// Sets one slot of one texel.
    pub fn set_slot(&mut self, lane: usize, slot: usize, stored: StoredLobe) {
        self.channels[slot].iter_mut().zip(stored).for_each(|(channel, value)| channel.0[lane] = value);
    }

    /// The lobes, ready for an E-step: weights in use made at least `least`, then to sum to 1.
    pub fn lobes(&self, least: f32, rule: KappaRule) -> CrowdLobes {
        let mut lobes = CrowdLobes::empty(self.count, rule);
        read(self, least, &mut lobes);
        lobes.prepare();
        lobes
    }
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn read(from: &CrowdChannels, least: f32, lobes: &mut CrowdLobes) {
    let mut total = [f32::MIN_POSITIVE; LANES];
    for j in 0..from.count {
        let [stored, vector @ ..] = &from.channels[j];
        for i in 0..LANES {
            let used = stored.0[i] > EMPTY_WEIGHT;
            // Divided, not multiplied by the inverse: a second rounding would be seen in the kappa of sharp lobes.
            let divisor = if used { stored.0[i] } else { f32::INFINITY };
            let alpha = if used { stored.0[i].max(least) } else { 0.0 };
            lobes.alpha[j].0[i] = alpha;
            total[i] += alpha;
            for axis in 0..3 {
                lobes.resultant[j][axis].0[i] = vector[axis].0[i] / divisor;
            }
        }
    }
    for alpha in &mut lobes.alpha[..from.count] {
        for i in 0..LANES {
            alpha.0[i] /= total[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::em::TexelLobes;

    #[test]
    fn lobes_of_channels_are_stored_as_they_were() {
        let stored = [[0.25, 0.1, -0.05, 0.2], [0.75, -0.3, 0.0, 0.6], [0.0; 4]];
        let mut channels = CrowdChannels::empty(3);
        (0..3).for_each(|slot| channels.set_slot(5, slot, stored[slot]));
        let lobes = channels.lobes(0.0, KappaRule::Exact);
        let mut read = [[1.0; 4]; 3];
        lobes.store(5, 1.0, &mut read);
        for (read, stored) in read.iter().flatten().zip(stored.iter().flatten()) {
            assert!((read - stored).abs() < 1e-7);
        }
        let mut flat = [[1.0; 4]; 3];
        lobes.store(5, 0.0, &mut flat);
        assert_eq!(flat, [TexelLobes::flat(1).stored(0), [0.0; 4], [0.0; 4]]);
    }

    #[test]
    fn a_weight_in_use_is_raised_and_an_empty_slot_stays_empty() {
        let mut channels = CrowdChannels::empty(3);
        channels.set_slot(0, 0, [0.99, 0.0, 0.0, 0.9]);
        channels.set_slot(0, 1, [0.01, 0.0, 0.0, 0.01]);
        let texel = channels.lobes(0.02, KappaRule::Exact).texel(0, 1.0);
        assert!((texel.alpha[0] - 0.99 / 1.01).abs() < 1e-6 && (texel.alpha[1] - 0.02 / 1.01).abs() < 1e-6);
        assert_eq!(texel.alpha[2].to_bits(), 0.0_f64.to_bits());
    }
}
