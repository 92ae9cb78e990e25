//! Small footprints, [`LANES`] texels at once: a texel a lane, so that every step of the fit is a step of all of them.
//!
//! A footprint of sixteen normals fills one group of lanes; what surrounds its E-step, the sums over lanes and the
//! M-step, would cost more than the E-step itself. Here the same loop ([`super::kernel`]) runs over the normals of all
//! texels side by side, there is nothing to sum over lanes, and the M-step is the same arithmetic on lanes, in f32:
//! `1 - |r|^2` follows from the mean deviation, not from `|r|`.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::kernel::{self, BLOCK, LaneSums, ReadLobes, SampleSlices};
use super::lanes::{LANES, Lanes};
use super::lobe_lanes::LobeLanes;
use crate::sphere::mixture::EMPTY_WEIGHT;

pub use super::crowd_lobes::{CrowdLobes, Mask};
pub use super::crowd_samples::{CrowdSamples, MOST_NORMALS, each_normal, most_normals, with_crowd};

/// When a crowd's iterations end, texel by texel.
#[derive(Clone, Copy, Debug)]
pub struct CrowdStop {
    /// Most iterations.
    pub iterations: [usize; LANES],
    /// Least gain in mean log-likelihood per normal that goes on.
    pub tolerance: f32,
}

/// How far each texel came.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrowdOutcome {
    /// Mean log-likelihood, per normal and steradian.
    pub mean_log_likelihood: [f32; LANES],
    /// Iterations used.
    pub iterations: [usize; LANES],
    /// Weight of all normals; 0 where none is valid.
    pub total: [f32; LANES],
}

impl CrowdSamples {
    /// One E-step and M-step of the texels in `mask`; returns the weight of each texel's normals.
    pub fn step(&mut self, lobes: &mut CrowdLobes, mask: &Mask) -> [f32; LANES] {
        e_step(self, lobes);
        m_step(&self.scratch.sums, lobes, mask);
        self.scratch.sums.total.0
    }

    /// Runs EM, as [`super::em::fit`] does for one texel; a texel that has come to its end waits for the others.
    pub fn fit(&mut self, lobes: &mut CrowdLobes, stop: &CrowdStop) -> CrowdOutcome {
        let mut running = [true; LANES];
        let mut outcome = CrowdOutcome { mean_log_likelihood: [f32::NEG_INFINITY; LANES], ..CrowdOutcome::default() };
        loop {
            e_step(self, lobes);
            let sums = &self.scratch.sums;
            for i in 0..LANES {
                let total = sums.total.0[i];
                let mean = if total > 0.0 { sums.log_likelihood.0[i] / total } else { 0.0 };
                let gain = mean - outcome.mean_log_likelihood[i];
                if running[i] {
                    (outcome.mean_log_likelihood[i], outcome.total[i]) = (mean, total);
                    running[i] = total > 0.0 && outcome.iterations[i] < stop.iterations[i] && gain >= stop.tolerance;
                    outcome.iterations[i] += usize::from(running[i]);
                }
            }
            if running == [false; LANES] {
                return outcome;
            }
            m_step(sums, lobes, &running);
        }
    }
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn e_step(samples: &mut CrowdSamples, lobes: &CrowdLobes) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let CrowdSamples { x, y, z, w, len, scratch } = samples;
    let [x, y, z, w] = [x, y, z, w].map(|lanes| bytemuck::cast_slice(&lanes[..*len]));
    let all = SampleSlices { x, y, z, w, spread: &[] };
    scratch.sums.clear(lobes.count());
    for start in (0..*len * LANES).step_by(BLOCK) {
        kernel::sum_block::<FMA, false>(&all.range(start, (start + BLOCK).min(*len * LANES)), lobes, scratch);
    }
}

/// `r = mu + d` with d the mean deviation, so `1 - |r|^2 = -(2 mu.d + |d|^2)`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn m_step(sums: &LaneSums, lobes: &mut CrowdLobes, mask: &Mask) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for j in 0..lobes.count() {
        let old = lobes.lobes[j];
        let (mut alpha, mut resultant) = (lobes.alpha[j], lobes.resultant[j]);
        let mut shortfall = Lanes::splat(0.0);
        let [weight, deviation @ ..] = &sums.lobes[j];
        for i in 0..LANES {
            let share = weight.0[i] / sums.total.0[i].max(f32::MIN_POSITIVE);
            let used = share > EMPTY_WEIGHT;
            let inverse = if used { 1.0 / weight.0[i] } else { 0.0 };
            let (mut along, mut square) = (0.0, 0.0);
            for axis in 0..3 {
                let (mu, d) = (old.mu[axis].0[i], deviation[axis].0[i] * inverse);
                along += mu * d;
                square += d * d;
                let r = if used { mu + d } else { 0.0 };
                resultant[axis].0[i] = if mask[i] { r } else { resultant[axis].0[i] };
            }
            shortfall.0[i] = -(2.0 * along + square);
            alpha.0[i] = if mask[i] { if used { share } else { 0.0 } } else { alpha.0[i] };
        }
        let new = LobeLanes::new::<FMA>(&alpha, &resultant, &shortfall, lobes.rule);
        for i in 0..LANES {
            lobes.lobes[j].factor.0[i] = if mask[i] { new.factor.0[i] } else { old.factor.0[i] };
            lobes.lobes[j].scale.0[i] = if mask[i] { new.scale.0[i] } else { old.scale.0[i] };
            for axis in 0..3 {
                lobes.lobes[j].mu[axis].0[i] = if mask[i] { new.mu[axis].0[i] } else { old.mu[axis].0[i] };
            }
        }
        (lobes.alpha[j], lobes.resultant[j]) = (alpha, resultant);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::em::{self, Stop, TexelLobes};
    use crate::filter::vmf::samples::FootprintSamples;
    use crate::filter::vmf::seed;
    use crate::normal_map::pyramid::Footprint;
    use crate::normal_map::{NormalMap, procedural};
    use crate::sphere::vmf::KappaRule;
    use glam::DVec3;

    /// A map of an odd size, whose footprints differ, with texels that are invalid.
    fn map() -> NormalMap {
        let mut map = procedural::find("plate").expect("bundled").make(45);
        for index in (0..200).step_by(7) {
            (map.x[index], map.y[index], map.z[index]) = (0.0, 0.0, 0.0);
            map.invalid += 1;
        }
        map
    }

    #[test]
    fn a_crowd_comes_to_what_each_texel_alone_comes_to() {
        let map = map();
        for (level, iterations) in [(2, 0), (2, 3), (3, 8)] {
            let size = map.level_size(level);
            let (first, count) = (1, LANES - 3);
            let seed_of = |footprint: &Footprint| {
                let (centres, count) = seed::farthest_normals(&map, footprint, 4);
                seed::assign(&FootprintSamples::new(&map, *footprint), &centres[..count], 4)
            };
            with_crowd(&map, size, first, count, |samples, footprints| {
                let mut lobes = CrowdLobes::empty(4, KappaRule::Exact);
                footprints.iter().enumerate().for_each(|(lane, footprint)| lobes.set(lane, &seed_of(footprint)));
                lobes.prepare();
                let stop = CrowdStop { iterations: [iterations; LANES], tolerance: f32::NEG_INFINITY };
                let outcome = samples.fit(&mut lobes, &stop);
                for (lane, footprint) in footprints.iter().enumerate() {
                    let alone = FootprintSamples::new(&map, *footprint);
                    let stop = Stop { iterations, tolerance: f64::NEG_INFINITY };
                    let alone = em::fit(&alone, seed_of(footprint), stop, KappaRule::Exact, |_| true);
                    let off = f64::from(outcome.mean_log_likelihood[lane]) - alone.mean_log_likelihood;
                    assert!(off.abs() < 2e-3, "level {level}, lane {lane}: {off}");
                    let texel = lobes.texel(lane, outcome.total[lane]);
                    let mean =
                        |lobes: &TexelLobes| -> DVec3 { (0..4).map(|j| lobes.alpha[j] * lobes.resultant[j]).sum() };
                    assert!((mean(&texel) - mean(&alone.lobes)).length() < 1e-5);
                }
            })
            .expect("small footprints");
        }
    }

    #[test]
    fn a_footprint_that_is_too_large_is_no_crowd() {
        let map = map();
        assert!(with_crowd(&map, map.level_size(4), 0, 1, |_, _| ()).is_none());
    }
}
