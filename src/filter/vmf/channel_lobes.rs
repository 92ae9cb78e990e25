//! The lobes of a place a lane, as their stored channels: of a texel, or of a corner, where four texels' mean is.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use multiversion::multiversion;

use super::crowd_system::{EACH, Part};
use super::lanes::{LANES, Lanes, window};
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

const ZERO: Lanes = Lanes::splat(0.0);

/// The shortest mean vector that has a direction.
const SHORTEST: f32 = 1e-4;

/// The lobes of a place in every lane.
#[derive(Clone, Debug)]
pub struct ChannelLobes {
    /// Slots.
    pub count: usize,
    /// `(alpha, alpha r)` by slot; nothing in an empty one.
    pub channels: [Part; MAX_LOBES],
    /// Directions of the mean vectors, by axis.
    pub mu: [[Lanes; 3]; MAX_LOBES],
    /// Lengths of the mean vectors.
    pub rho: [Lanes; MAX_LOBES],
}

impl ChannelLobes {
    /// Empty slots.
    pub fn empty(count: usize) -> Self {
        let channels = [[ZERO; EACH]; MAX_LOBES];
        Self { count: count.min(MAX_LOBES), channels, mu: [[ZERO; 3]; MAX_LOBES], rho: [ZERO; MAX_LOBES] }
    }

    /// Becomes the mean of the texels in windows of channels, which are `stride` apart.
    pub fn read(&mut self, windows: &[(&[f32], usize)], stride: usize) {
        mean(self.channels[..self.count].as_flattened_mut(), windows, stride);
        directions(self);
    }
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn mean(channels: &mut [Lanes], windows: &[(&[f32], usize)], stride: usize) {
    let share = 1.0 / windows.len() as f32;
    for (channel, lanes) in channels.iter_mut().enumerate() {
        let mut sum = ZERO;
        for (column, start) in windows {
            let value = window(column, channel * stride + start);
            for i in 0..LANES {
                sum.0[i] += value[i];
            }
        }
        for i in 0..LANES {
            lanes.0[i] = share * sum.0[i];
        }
    }
}

/// Directions and lengths from the channels; what is in an empty slot is cleared.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn directions(lobes: &mut ChannelLobes) {
    for j in 0..lobes.count {
        let ([alpha, x, y, z], [mx, my, mz], rho) = (&mut lobes.channels[j], &mut lobes.mu[j], &mut lobes.rho[j]);
        for i in 0..LANES {
            let used = alpha.0[i] > EMPTY_WEIGHT;
            let clear = |value: f32| if used { value } else { 0.0 };
            (alpha.0[i], x.0[i], y.0[i], z.0[i]) = (clear(alpha.0[i]), clear(x.0[i]), clear(y.0[i]), clear(z.0[i]));
            let length = (x.0[i] * x.0[i] + y.0[i] * y.0[i] + z.0[i] * z.0[i]).sqrt();
            let directed = length > f32::MIN_POSITIVE;
            let inverse = 1.0 / if directed { length } else { 1.0 };
            (mx.0[i], my.0[i]) = (x.0[i] * inverse, y.0[i] * inverse);
            mz.0[i] = if directed { z.0[i] * inverse } else { 1.0 };
            rho.0[i] = (length / if used { alpha.0[i] } else { 1.0 }).clamp(SHORTEST, 1.0);
        }
    }
}
