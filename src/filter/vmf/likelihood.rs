//! The fit for the likelihood: the children's lobes merged where that costs the likelihood least, EM, then moves that
//! leave a poor optimum.
//!
//! EM never crosses a valley: where two lobes share one cluster and a third covers two, it stays. A move merges the
//! cheapest pair and splits another lobe along its longest axis, at every lobe in turn for a few iterations; the best
//! of them goes on and is kept if the likelihood rose (after Ueda et al. 2000, "SMEM").

use glam::DVec3;

use super::children::Children;
use super::em::{self, Stop, TexelFit, TexelLobes};
use super::fit::FitSettings;
use super::kernel::{KernelLobes, SampleSlices};
use super::merge::{Candidates, Criterion, KullbackLeibler, pair_by_rank};
use super::phi::Width;
use super::samples::Samples;
use super::unaligned::TexelTask;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::KAPPA_MAX;

/// EM iterations between the merge of the children's lobes and the moves.
const FIRST: usize = 5;

/// EM iterations in which a split shows its worth.
const TRIAL: usize = 3;

/// EM iterations that a move gets before it is judged.
const JUDGED: usize = 10;

/// Moves that may be kept, and moves in a row that may fail, each from the next cheapest pair.
const MOVES: usize = 8;
const FAILURES: usize = 3;

/// Footprints of fewer normals get one failure: there are many of them, and the merge seldom errs on few normals.
const FEW: usize = 256;

/// Least gain in mean log-likelihood that keeps a move.
const GAIN: f64 = 1e-4;

/// Passes that a texel is expected to take; most need far fewer than the limit.
pub fn most_passes(settings: &FitSettings) -> usize {
    FIRST + 3 * (settings.lobes * (TRIAL + 1) + JUDGED) + settings.iterations
}

/// Fits one texel.
pub fn fit(samples: &impl Samples, children: &Children<'_>, task: &mut TexelTask<'_>) -> TexelFit {
    let settings = task.settings;
    let mut candidates = Candidates::default();
    children.add_to(&mut candidates, &KullbackLeibler);
    candidates.merge_down_to(settings.lobes, &KullbackLeibler);
    let failures = if task.normals < FEW { 1 } else { FAILURES };
    let mut run = |name, lobes, iterations| {
        task.begin(name);
        let stop = Stop { iterations, tolerance: settings.tolerance };
        em::fit(samples, lobes, stop, settings.kappa, |mean| task.saw(mean))
    };
    let mut best = run("EM from merged lobes", candidates.to_lobes(settings.lobes), FIRST);
    let mut iterations = best.iterations;
    let mut failed = 0;
    for _ in 0..MOVES {
        let Some(moved) = moved(samples, &best.lobes, failed, &mut run) else { break };
        iterations += moved.iterations;
        if moved.mean_log_likelihood > best.mean_log_likelihood + GAIN {
            (best, failed) = (moved, 0);
        } else {
            failed += 1;
        }
        if failed >= failures {
            break;
        }
    }
    let last = run("EM of the best", best.lobes, settings.iterations);
    TexelFit { iterations: iterations + last.iterations, ..last }
}

/// The mixture after a move: the pair of that rank merged, the lobe whose split promises most split. `None` where
/// there is no such pair or no other lobe.
fn moved(
    samples: &impl Samples,
    lobes: &TexelLobes,
    rank: usize,
    run: &mut impl FnMut(&'static str, TexelLobes, usize) -> TexelFit,
) -> Option<TexelFit> {
    let free = (0..lobes.count).find(|&j| lobes.alpha[j] <= f64::from(EMPTY_WEIGHT));
    let (merged, free) = match free {
        // A retired lobe's slot can be had for nothing.
        Some(free) => (*lobes, free),
        None => {
            let (a, b) = pair_by_rank(lobes, rank, &KullbackLeibler)?;
            (merge_slots(lobes, a, b), b)
        }
    };
    let kernel = merged.for_e_step(crate::sphere::vmf::KappaRule::Exact);
    let shapes = samples.sum(|slices, shapes: &mut Shapes| shapes.add(slices, &kernel));
    let split = |j: usize| shapes.split(&merged, j, free);
    let trial = (0..merged.count)
        .filter(|&j| merged.alpha[j] > 1e-3)
        .filter_map(split)
        .map(|lobes| run("a split tried", lobes, TRIAL));
    let best = trial.max_by(|a, b| a.mean_log_likelihood.total_cmp(&b.mean_log_likelihood))?;
    Some(run("the best split", best.lobes, JUDGED))
}

/// Slot b merged into slot a.
fn merge_slots(lobes: &TexelLobes, a: usize, b: usize) -> TexelLobes {
    let mut merged = *lobes;
    let candidate = |j: usize| KullbackLeibler.candidate(lobes.alpha[j], lobes.resultant[j]);
    let sum = KullbackLeibler.merged(&candidate(a), &candidate(b));
    (merged.alpha[a], merged.resultant[a]) = (sum.alpha, sum.resultant);
    (merged.alpha[b], merged.resultant[b]) = (0.0, DVec3::ZERO);
    merged
}

/// How the normals of each lobe spread over its tangent plane: sums of `w z`, and of that times `x x`, `x y`, `y y`.
#[derive(Clone, Copy, Debug, Default)]
struct Shapes([[f64; 4]; MAX_LOBES]);

impl std::ops::AddAssign<&Self> for Shapes {
    fn add_assign(&mut self, other: &Self) {
        self.0.iter_mut().flatten().zip(other.0.iter().flatten()).for_each(|(own, other)| *own += other);
    }
}

impl Shapes {
    /// Adds samples, shared between the lobes as an E-step shares them.
    fn add(&mut self, samples: &SampleSlices, lobes: &KernelLobes) {
        let frames = lobes.mu.map(|mu| glam::Vec3::from(mu).any_orthonormal_pair());
        for i in (0..samples.x.len()).filter(|&i| samples.w[i] > 0.0) {
            let normal = glam::Vec3::new(samples.x[i], samples.y[i], samples.z[i]);
            let mut density = [f32::NEG_INFINITY; MAX_LOBES];
            for (j, value) in density.iter_mut().enumerate().take(lobes.count) {
                let chord = normal.distance_squared(glam::Vec3::from(lobes.mu[j]));
                *value = lobes.log_scale[j] + lobes.neg_half_kappa[j] * chord;
            }
            let max = density.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let density = density.map(|value| if value > max - 20.0 { (value - max).exp() } else { 0.0 });
            let scale = samples.w[i] / density.iter().sum::<f32>();
            for (j, &value) in density.iter().enumerate().filter(|(_, value)| **value > 0.0) {
                let weight = f64::from(value * scale);
                let (x, y) = (f64::from(frames[j].0.dot(normal)), f64::from(frames[j].1.dot(normal)));
                let part = [weight, weight * x * x, weight * x * y, weight * y * y];
                self.0[j].iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
            }
        }
    }

    /// The mixture with lobe j split in two along its longest axis, the second half in slot `free`; `None` for a
    /// lobe without extent.
    fn split(&self, lobes: &TexelLobes, j: usize, free: usize) -> Option<TexelLobes> {
        let [weight, xx, xy, yy] = self.0[j];
        let (xx, xy, yy) = (xx / weight, xy / weight, yy / weight);
        let mu = lobes.resultant[j].try_normalize()?;
        let (e1, e2) = mu.as_vec3().any_orthonormal_pair();
        // Eigenvalues of the symmetric 2 x 2 matrix, and the axis of the larger.
        let (half, difference) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let root = difference.hypot(xy);
        let (largest, least) = (half + root, half - root);
        if largest.is_nan() || largest < 1.0 / KAPPA_MAX {
            return None;
        }
        let angle = 0.5 * xy.atan2(difference);
        let axis = angle.cos() * e1.as_dvec3() + angle.sin() * e2.as_dvec3();
        // Halves of a Gaussian have their means at sqrt(2/pi) of its deviation, and 1 - 2/pi of its variance.
        let offset = (std::f64::consts::FRAC_2_PI * largest).sqrt();
        let variance = 0.5 * (largest * (1.0 - std::f64::consts::FRAC_2_PI) + least.max(0.0));
        let length = Width::of_kappa((1.0 / variance).clamp(0.1, KAPPA_MAX)).length;
        let mut split = *lobes;
        for (slot, sign) in [(j, 1.0), (free, -1.0)] {
            split.alpha[slot] = 0.5 * lobes.alpha[j];
            split.resultant[slot] = length * (mu + sign * offset * axis).normalize();
        }
        Some(split)
    }
}
