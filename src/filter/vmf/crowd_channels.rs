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
    lobes: CrowdLobes,
}

impl CrowdChannels {
    /// Empty slots.
    pub fn empty(count: usize, rule: KappaRule) -> Self {
        let channels = [[Lanes::splat(0.0); 4]; MAX_LOBES];
        Self { count: count.min(MAX_LOBES), channels, lobes: CrowdLobes::empty(count, rule) }
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
    pub fn lobes(&mut self, least: f32) -> &mut CrowdLobes {
        read(&self.channels[..self.count], least, &mut self.lobes);
        self.lobes.prepare();
        &mut self.lobes
    }
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn read(from: &[[Lanes; 4]], least: f32, lobes: &mut CrowdLobes) {
    let mut total = [f32::MIN_POSITIVE; LANES];
    for (j, [stored, vector @ ..]) in from.iter().enumerate() {
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
    for alpha in &mut lobes.alpha[..from.len()] {
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
        let mut channels = CrowdChannels::empty(3, KappaRule::Exact);
        (0..3).for_each(|slot| channels.set_slot(5, slot, stored[slot]));
        let lobes = channels.lobes(0.0);
        let (mut read, mut total) = ([[1.0; 4]; 6 * 3], [1.0; LANES]);
        lobes.store(&total, &mut read);
        for (read, stored) in read[5 * 3..].iter().flatten().zip(stored.iter().flatten()) {
            assert!((read - stored).abs() < 1e-7);
        }
        total[5] = 0.0;
        lobes.store(&total, &mut read);
        assert_eq!(read[5 * 3..], [TexelLobes::flat(1).stored(0), [0.0; 4], [0.0; 4]]);
    }

    #[test]
    fn a_weight_in_use_is_raised_and_an_empty_slot_stays_empty() {
        let mut channels = CrowdChannels::empty(3, KappaRule::Exact);
        channels.set_slot(0, 0, [0.99, 0.0, 0.0, 0.9]);
        channels.set_slot(0, 1, [0.01, 0.0, 0.0, 0.01]);
        let texel = channels.lobes(0.02).texel(0, 1.0);
        assert!((texel.alpha[0] - 0.99 / 1.01).abs() < 1e-6 && (texel.alpha[1] - 0.02 / 1.01).abs() < 1e-6);
        assert_eq!(texel.alpha[2].to_bits(), 0.0_f64.to_bits());
    }
}
