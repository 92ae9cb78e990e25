//! Merging many lobes into few, greedily: the pair that is cheapest to merge goes first. Merging adds the stored
//! channels `(alpha, alpha r)`, so weights and the mean normal stay exact.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::em::TexelLobes;
use super::merge_costs::{self, Columns, Costs, MAX_CANDIDATES};
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf::{self, KAPPA_MAX, KappaRule};

/// A lobe that may be merged, with what a criterion wants to know of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Candidate {
    /// Weight.
    pub alpha: f64,
    /// Mean resultant vector.
    pub resultant: DVec3,
    /// Its direction; zero where there is none.
    mu: DVec3,
    /// The criterion's own number.
    feature: f64,
}

/// What a merge costs.
pub trait Criterion {
    /// A number of each lobe that [`Self::cost`] needs, worked out once.
    fn feature(&self, alpha: f64, kappa: f64) -> f64;

    /// The cost of replacing `a` and `b` by `merged`.
    fn cost(&self, a: &Candidate, b: &Candidate, merged: &Candidate) -> f64;

    /// The candidate of a weight and a resultant.
    fn candidate(&self, alpha: f64, resultant: DVec3) -> Candidate {
        let length = resultant.length();
        // Banerjee's kappa is off by 5 % at most: far less than what decides which pair is cheapest.
        let kappa = KappaRule::Banerjee.concentration(1.0 - length).min(KAPPA_MAX);
        let mu = if length > 0.0 { resultant / length } else { DVec3::ZERO };
        Candidate { alpha, resultant, mu, feature: self.feature(alpha, kappa) }
    }

    /// The sum of two lobes.
    fn merged(&self, a: &Candidate, b: &Candidate) -> Candidate {
        let alpha = a.alpha + b.alpha;
        self.candidate(alpha, (a.alpha * a.resultant + b.alpha * b.resultant) / alpha)
    }

    /// The cost of merging two lobes.
    fn pair_cost(&self, a: &Candidate, b: &Candidate) -> f64 {
        self.cost(a, b, &self.merged(a, b))
    }

    /// The cost of merging lobe `i` with each of the others, and something for itself; in single precision, so that
    /// what differs by rounding only is a tie.
    fn costs(&self, candidates: &Candidates, i: usize, costs: &mut Costs) {
        let lobes = candidates.lobes();
        for (cost, other) in costs.iter_mut().zip(lobes) {
            *cost = self.pair_cost(&lobes[i], other) as f32;
        }
    }
}

/// The integrated squared change of the mixture as a material of exponent `s` shades it: every lobe a planar Gaussian
/// of variance `1/kappa + 1/(s+1)` per axis, distances along chords.
#[derive(Clone, Copy, Debug)]
pub struct Blurred {
    /// The material's exponent s.
    pub shininess: f64,
}

/// `integral of g_a g_b` of two planar Gaussians: a Gaussian of the distance, of both variances together.
fn overlap(a: &Candidate, b: &Candidate) -> f64 {
    let variance = a.feature + b.feature;
    (-0.5 * a.mu.distance_squared(b.mu) / variance).exp() / (TAU * variance)
}

impl Criterion for Blurred {
    fn feature(&self, _: f64, kappa: f64) -> f64 {
        // Wider than 10 square radians is the uniform lobe all the same.
        1.0 / kappa.max(0.1) + 1.0 / (self.shininess + 1.0)
    }

    fn cost(&self, a: &Candidate, b: &Candidate, merged: &Candidate) -> f64 {
        let square = |lobe: &Candidate| lobe.alpha * lobe.alpha / (4.0 * PI * lobe.feature);
        let product = |a: &Candidate, b: &Candidate| 2.0 * a.alpha * b.alpha * overlap(a, b);
        square(a) + square(b) + square(merged) + product(a, b) - product(a, merged) - product(b, merged)
    }

    fn costs(&self, candidates: &Candidates, i: usize, costs: &mut Costs) {
        merge_costs::blurred(&candidates.columns, candidates.count, i, 1.0 / (self.shininess as f32 + 1.0), costs);
    }
}

/// Ward's criterion, `aa ab / (aa + ab) |ra - rb|^2`: the growth of the squared distance to the means (Ward 1963).
#[derive(Clone, Copy, Debug)]
pub struct Ward;

impl Criterion for Ward {
    fn feature(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn cost(&self, _: &Candidate, _: &Candidate, _: &Candidate) -> f64 {
        0.0
    }

    fn candidate(&self, alpha: f64, resultant: DVec3) -> Candidate {
        Candidate { alpha, resultant, ..Candidate::default() }
    }

    fn pair_cost(&self, a: &Candidate, b: &Candidate) -> f64 {
        a.alpha * b.alpha / (a.alpha + b.alpha) * a.resultant.distance_squared(b.resultant)
    }

    fn costs(&self, candidates: &Candidates, i: usize, costs: &mut Costs) {
        merge_costs::ward(&candidates.columns, candidates.count, i, costs);
    }
}

/// The bound on the Kullback-Leibler divergence that a merge of equal moments causes (Runnalls 2007, in the form for an
/// exponential family): `aa l(kappa_a) + ab l(kappa_b) - am l(kappa_m)` with `l` a lobe's mean log-density under
/// itself, `ln peak(kappa) - kappa (1 - A(kappa))`.
#[derive(Clone, Copy, Debug)]
pub struct KullbackLeibler;

impl Criterion for KullbackLeibler {
    fn feature(&self, alpha: f64, kappa: f64) -> f64 {
        alpha * (vmf::log_peak(kappa) - kappa * (1.0 - vmf::mean_resultant_length(kappa)))
    }

    fn cost(&self, a: &Candidate, b: &Candidate, merged: &Candidate) -> f64 {
        a.feature + b.feature - merged.feature
    }
}

/// Lobes to be merged, on the stack.
#[derive(Clone, Debug)]
pub struct Candidates {
    lobes: [Candidate; MAX_CANDIDATES],
    columns: Columns,
    count: usize,
}

impl Default for Candidates {
    fn default() -> Self {
        Self { lobes: [Candidate::default(); MAX_CANDIDATES], columns: Columns::EMPTY, count: 0 }
    }
}

impl Candidates {
    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a lobe; one without weight, or beyond the room there is, is left out.
    pub fn push(&mut self, candidate: Candidate) {
        if candidate.alpha > f64::from(EMPTY_WEIGHT) && self.count < MAX_CANDIDATES {
            self.count += 1;
            self.set(self.count - 1, candidate);
        }
    }

    fn set(&mut self, index: usize, candidate: Candidate) {
        self.columns.set(index, candidate.alpha as f32, candidate.resultant.as_vec3(), candidate.feature as f32);
        self.lobes[index] = candidate;
    }

    /// The lobes there are.
    pub fn lobes(&self) -> &[Candidate] {
        &self.lobes[..self.count]
    }

    /// Merges the cheapest pair until at most `wanted` lobes are left.
    pub fn merge_down_to(&mut self, wanted: usize, criterion: &impl Criterion) {
        // The cheapest partner of each lobe among those after it.
        let mut partners = [Partner::NONE; MAX_CANDIDATES];
        let mut costs = [0.0; MAX_CANDIDATES];
        if self.count > wanted {
            (0..self.count).for_each(|i| partners[i] = self.partner_of(i, criterion, &mut costs));
        }
        while self.count > wanted.max(1) {
            let all = 0..self.count - 1;
            let mut of_all = [0.0; MAX_CANDIDATES];
            all.clone().for_each(|i| of_all[i] = partners[i].cost);
            let least = merge_costs::least(&of_all, &all);
            let cheapest = all.filter(|&i| of_all[i] == least).min_by(|&i, &k| partners[i].rank(&partners[k]));
            let Some(i) = cheapest else { return };
            self.merge(i, &mut partners, criterion, &mut costs);
        }
    }

    /// Merges lobe `i` with its partner: the sum takes its place, the last lobe takes the partner's.
    fn merge(
        &mut self,
        i: usize,
        partners: &mut [Partner; MAX_CANDIDATES],
        criterion: &impl Criterion,
        costs: &mut Costs,
    ) {
        let (j, last) = (partners[i].index, self.count - 1);
        self.set(i, criterion.merged(&self.lobes[i], &self.lobes[j]));
        self.set(j, self.lobes[last]);
        self.count = last;
        let moved = |k: usize| k == i || k == j;
        let mut stale = [false; MAX_CANDIDATES];
        for k in (0..last).filter(|&k| !moved(k)) {
            stale[k] = moved(partners[k].index) || partners[k].index == last;
        }
        for changed in [i, j].into_iter().filter(|&changed| changed < last) {
            partners[changed] = self.partner_of(changed, criterion, costs);
            for k in (0..changed).filter(|&k| !moved(k) && !stale[k]) {
                partners[k] = partners[k].cheaper(self.partner(k, changed, costs[k]));
            }
        }
        for k in (0..last).filter(|&k| stale[k]) {
            partners[k] = self.partner_of(k, criterion, costs);
        }
    }

    /// Lobe `i` beside lobe `index`, as partners.
    fn partner(&self, i: usize, index: usize, cost: f32) -> Partner {
        let height = |i: usize| self.lobes[i].alpha * self.lobes[i].resultant.z;
        Partner { index, cost, height: (height(i) + height(index)) as f32 }
    }

    /// The cheapest partner of lobe `i` among those after it; `costs` become those of all.
    fn partner_of(&self, i: usize, criterion: &impl Criterion, costs: &mut Costs) -> Partner {
        criterion.costs(self, i, costs);
        let others = i + 1..self.count;
        let least = merge_costs::least(costs, &others);
        let mut best = Partner::NONE;
        for index in others.filter(|&index| costs[index] == least) {
            best = best.cheaper(self.partner(i, index, least));
        }
        best
    }

    /// The lobes as the mixture of a texel of `slots` slots, weights made to sum to 1.
    pub fn to_lobes(&self, slots: usize) -> TexelLobes {
        let total: f64 = self.lobes().iter().map(|lobe| lobe.alpha).sum();
        if total <= 0.0 {
            return TexelLobes::flat(slots);
        }
        let mut lobes = TexelLobes::empty(slots);
        for (j, lobe) in self.lobes().iter().take(lobes.count).enumerate() {
            (lobes.alpha[j], lobes.resultant[j]) = (lobe.alpha / total, lobe.resultant);
        }
        lobes
    }
}

/// A lobe to merge with, and what that costs.
#[derive(Clone, Copy, Debug)]
struct Partner {
    index: usize,
    cost: f32,
    /// `sum alpha r_z` of the pair: decides a tie, for it is the same in a map mirrored, flipped or turned.
    height: f32,
}

impl Partner {
    const NONE: Self = Self { index: usize::MAX, cost: f32::INFINITY, height: 0.0 };

    fn rank(&self, other: &Self) -> std::cmp::Ordering {
        self.cost.total_cmp(&other.cost).then(self.height.total_cmp(&other.height))
    }

    /// The cheaper of two; the first where they cost the same.
    fn cheaper(self, other: Self) -> Self {
        if other.rank(&self).is_lt() { other } else { self }
    }
}

/// The two lobes of a mixture that are `rank`th cheapest to merge, the heavier slot's index whichever order.
pub fn pair_by_rank(lobes: &TexelLobes, rank: usize, criterion: &impl Criterion) -> Option<(usize, usize)> {
    let mut pairs = [(f64::INFINITY, 0, 0); MAX_LOBES * MAX_LOBES / 2];
    let mut count = 0;
    let used = |&j: &usize| lobes.alpha[j] > f64::from(EMPTY_WEIGHT);
    for i in (0..lobes.count).filter(used) {
        for j in (i + 1..lobes.count).filter(used) {
            let candidate = |j: usize| criterion.candidate(lobes.alpha[j], lobes.resultant[j]);
            pairs[count] = (criterion.pair_cost(&candidate(i), &candidate(j)), i, j);
            count += 1;
        }
    }
    pairs[..count].sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs[..count].get(rank).map(|&(_, i, j)| (i, j))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(index: usize) -> f64 {
        (index as f64 * 12.9898).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0)
    }

    fn merged_down(criterion: &impl Criterion, wanted: usize) -> (Candidates, Candidates) {
        let mut candidates = Candidates::default();
        for i in 0..24 {
            let mu = DVec3::new(noise(4 * i) - 0.5, noise(4 * i + 1) - 0.5, 0.6).normalize();
            candidates.push(criterion.candidate(0.01 + noise(4 * i + 2), mu * (0.9 + 0.1 * noise(4 * i + 3))));
        }
        let before = candidates.clone();
        candidates.merge_down_to(wanted, criterion);
        (before, candidates)
    }

    fn moments(candidates: &Candidates) -> (f64, DVec3) {
        let lobes = candidates.lobes();
        (lobes.iter().map(|l| l.alpha).sum(), lobes.iter().map(|l| l.alpha * l.resultant).sum())
    }

    fn a_merge_keeps_weight_and_mean(criterion: &impl Criterion) {
        for wanted in [1, 2, 6, 16] {
            let (before, after) = merged_down(criterion, wanted);
            assert_eq!(after.lobes().len(), wanted);
            let (before, after) = (moments(&before), moments(&after));
            assert!((before.0 - after.0).abs() < 1e-12 && (before.1 - after.1).length() < 1e-12);
        }
    }

    #[test]
    fn a_merge_keeps_alpha_and_alpha_r_exactly() {
        a_merge_keeps_weight_and_mean(&Blurred { shininess: 64.0 });
        a_merge_keeps_weight_and_mean(&Ward);
        a_merge_keeps_weight_and_mean(&KullbackLeibler);
    }

    #[test]
    fn the_remembered_partners_choose_as_a_full_search_does() {
        let criterion = Blurred { shininess: 64.0 };
        let (before, fast) = merged_down(&criterion, 5);
        let mut plain = before.lobes().to_vec();
        while plain.len() > 5 {
            let pairs = (0..plain.len()).flat_map(|i| (i + 1..plain.len()).map(move |j| (i, j)));
            let cost = |&(i, j): &(usize, usize)| criterion.pair_cost(&plain[i], &plain[j]);
            let (i, j) = pairs.min_by(|a, b| cost(a).total_cmp(&cost(b))).expect("two or more");
            plain[i] = criterion.merged(&plain[i], &plain[j]);
            plain.swap_remove(j);
        }
        let sorted = |lobes: &[Candidate]| {
            let mut alphas: Vec<f64> = lobes.iter().map(|lobe| lobe.alpha).collect();
            alphas.sort_by(f64::total_cmp);
            alphas
        };
        for (a, b) in sorted(&plain).iter().zip(sorted(fast.lobes())) {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn merging_equal_lobes_costs_nothing_and_far_ones_more() {
        let cost = |criterion: &dyn Fn(f64) -> f64| [criterion(0.0), criterion(0.1), criterion(0.5)];
        let at = |x: f64| 0.95 * DVec3::new(x, 0.0, 1.0).normalize();
        let blurred = Blurred { shininess: 64.0 };
        let of_blur = |x| blurred.pair_cost(&blurred.candidate(0.4, at(0.0)), &blurred.candidate(0.2, at(x)));
        let of_kl = |x| {
            KullbackLeibler.pair_cost(&KullbackLeibler.candidate(0.4, at(0.0)), &KullbackLeibler.candidate(0.2, at(x)))
        };
        for costs in [cost(&of_blur), cost(&of_kl)] {
            assert!(costs[0].abs() < 1e-12 && costs[0] < costs[1] && costs[1] < costs[2], "{costs:?}");
        }
    }
}
