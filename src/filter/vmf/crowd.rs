//! Small footprints, [`LANES`] texels at once: a texel a lane, so that every step of the fit is a step of all of them.
//!
//! A footprint of sixteen normals fills one group of lanes; what surrounds its E-step, the sums over lanes and the
//! M-step, would cost more than the E-step itself. Here the same loop ([`super::kernel`]) runs over the normals of all
//! texels side by side, there is nothing to sum over lanes, and the M-step is the same arithmetic on lanes, in f32:
//! `1 - |r|^2` follows from the mean deviation, not from `|r|`.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use std::cell::RefCell;
use std::f32::consts::LOG2_E;

use glam::{DVec3, Vec3, Vec4Swizzles};
use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::em::TexelLobes;
use super::kernel::{self, BLOCK, LOG_ZERO, LaneSums, ReadLobes, SampleSlices};
use super::lanes::{LANES, Lanes};
use super::lobe_lanes::LobeLanes;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::KappaRule;

/// Most normals of a footprint that joins a crowd: those of level 3, with room for sizes that are no power of two.
pub const MOST_NORMALS: usize = 100;

/// The normals of a crowd's texels, the first of every texel before the second of any.
pub struct CrowdSamples {
    x: Box<[Lanes]>,
    y: Box<[Lanes]>,
    z: Box<[Lanes]>,
    w: Box<[Lanes]>,
    /// Normals of the largest footprint.
    len: usize,
    scratch: Box<kernel::Scratch>,
}

thread_local! {
    static SAMPLES: RefCell<CrowdSamples> = RefCell::default();
}

/// The most normals that a footprint of a level of size `size` may have; those whose boxes cut base texels reach one
/// further on either side.
pub fn most_normals(map: &NormalMap, size: (usize, usize)) -> usize {
    let along = |base: usize, count: usize| if base.is_multiple_of(count) { base / count } else { base / count + 2 };
    along(map.width, size.0) * along(map.height, size.1)
}

/// Gathers the normals of the `count` texels from `first` on of a level of size `size`, row by row, and shows them to
/// `visit`, with their footprints; `None` where footprints of the level may be too large for a crowd.
pub fn with_crowd<R>(
    map: &NormalMap,
    size: (usize, usize),
    first: usize,
    count: usize,
    visit: impl FnOnce(&mut CrowdSamples, &[Footprint]) -> R,
) -> Option<R> {
    if most_normals(map, size) > MOST_NORMALS {
        return None;
    }
    let footprint = |index: usize| Footprint::new((map.width, map.height), size, (index % size.0, index / size.0));
    let mut footprints = [footprint(first); LANES];
    let footprints = &mut footprints[..count.min(LANES)];
    footprints.iter_mut().enumerate().for_each(|(lane, own)| *own = footprint(first + lane));
    Some(SAMPLES.with_borrow_mut(|samples| {
        samples.gather(map, footprints);
        visit(samples, footprints)
    }))
}

impl Default for CrowdSamples {
    fn default() -> Self {
        let zeros = || vec![Lanes::splat(0.0); MOST_NORMALS].into_boxed_slice();
        let scratch = Box::new(kernel::Scratch::EMPTY);
        Self { x: zeros(), y: zeros(), z: zeros(), w: zeros(), len: 0, scratch }
    }
}

impl CrowdSamples {
    /// Takes in the normals of at most [`LANES`] footprints of at most [`MOST_NORMALS`] each.
    fn gather(&mut self, map: &NormalMap, footprints: &[Footprint]) {
        self.len = footprints.iter().map(Footprint::len).max().unwrap_or(0).min(MOST_NORMALS);
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.w] {
            array[..self.len].fill(Lanes::splat(0.0));
        }
        for (lane, footprint) in footprints.iter().enumerate().take(LANES) {
            for (n, (x, y, area)) in footprint.texels().enumerate().take(self.len) {
                let index = y * map.width + x;
                let (x, y, z) = (map.x[index], map.y[index], map.z[index]);
                // An invalid texel is a zero vector.
                let weight = if (x, y, z) == (0.0, 0.0, 0.0) { 0.0 } else { area };
                (self.x[n].0[lane], self.y[n].0[lane], self.z[n].0[lane], self.w[n].0[lane]) = (x, y, z, weight);
            }
        }
    }
}

/// The mixtures of a crowd's texels, by slot.
#[derive(Clone, Debug)]
pub struct CrowdLobes {
    /// Slots in use.
    pub count: usize,
    rule: KappaRule,
    /// Weights; 0 is an empty slot.
    pub(super) alpha: [Lanes; MAX_LOBES],
    /// Mean resultant vectors, by axis.
    pub(super) resultant: [[Lanes; 3]; MAX_LOBES],
    /// The lobes of the E-step.
    lobes: [LobeLanes; MAX_LOBES],
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

    /// Writes one texel's mixture to its slots; `total` is the weight of its normals, as for [`Self::texel`].
    pub fn store(&self, lane: usize, total: f32, target: &mut [StoredLobe]) {
        if total <= 0.0 {
            return TexelLobes::flat(self.count).store(target);
        }
        for ((alpha, resultant), stored) in self.alpha.iter().zip(&self.resultant).zip(target) {
            let [x, y, z] = resultant;
            let r = Vec3::new(x.0[lane], y.0[lane], z.0[lane]).clamp_length_max(1.0);
            *stored = (alpha.0[lane] * r.extend(1.0)).wxyz().to_array();
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
    use crate::filter::vmf::em::{self, Stop};
    use crate::filter::vmf::samples::FootprintSamples;
    use crate::filter::vmf::seed;
    use crate::normal_map::procedural;

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
