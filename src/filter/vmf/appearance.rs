//! The fit for the shaded look: the children's lobes merged as a material blurs them, a few EM iterations on the data,
//! then Gauss-Newton steps on the squared distance between the shaded mixture and the shaded truth.
//!
//! Likelihood weighs lobes that no material can tell apart; the blur of a usual material does not. The merge changes
//! the shaded mixture least in squared error, and the steps lower that error itself ([`super::phi`]).
//!
//! Such steps from aligned lobes mend the texel (s = 64: .0226 to .0201) and spoil the blend midway between texels
//! (.0411 to .0455), for neighbours then disagree again: there [`super::between`] moves all texels together.

use std::ops::Range;

use super::children::Children;
use super::crowd::{self, CrowdLobes, CrowdSamples, CrowdStop};
use super::em::{self, Stop, TexelFit, TexelLobes};
use super::lanes::LANES;
use super::merge::{Blurred, Candidates, Ward};
use super::samples::Samples;
use super::seed;
use super::unaligned::{LevelFit, TexelTask, small};
use super::{crowd_gauss_newton, gauss_newton};
use crate::normal_map::pyramid::Footprint;

/// EM iterations between the merge and the steps.
pub const ITERATIONS: usize = 5;

/// Exponent of the material whose blur decides the merge.
const MERGE_SHININESS: f64 = 64.0;

/// Footprints of fewer normals, levels 2 and 3, are merged by Ward's criterion: it does as well there, at a tenth of
/// the cost.
const WARD_BELOW: usize = 256;

/// The children's lobes merged down to the texel's slots, in the room of `candidates`.
fn merged(children: &Children<'_>, normals: usize, slots: usize, candidates: &mut Candidates) -> TexelLobes {
    candidates.clear();
    if normals < WARD_BELOW {
        children.add_to(candidates, &Ward);
        candidates.merge_down_to(slots, &Ward);
    } else {
        let criterion = Blurred { shininess: MERGE_SHININESS };
        children.add_to(candidates, &criterion);
        candidates.merge_down_to(slots, &criterion);
    }
    candidates.to_lobes(slots)
}

/// Fits at most [`LANES`] small texels as a crowd, all but the merge and the steps, and shows each to `keep` with its
/// place among them. Returns their normals, or `None` where the footprints are too large for a crowd.
pub fn fit_crowd(
    job: &LevelFit<'_>,
    texels: Range<usize>,
    steps: usize,
    keep: &mut dyn FnMut(usize, &TexelFit),
) -> Option<usize> {
    let (map, settings) = (job.lobes.map.as_ref(), job.settings);
    crowd::with_crowd(map, map.level_size(job.level), texels.start, texels.len(), |samples, footprints| {
        let mut lobes = CrowdLobes::empty(settings.lobes, settings.kappa);
        let (mut iterations, mut searched) = ([0; LANES], [false; LANES]);
        let mut candidates = Candidates::default();
        for (lane, footprint) in footprints.iter().enumerate() {
            let exact = small(footprint, settings.lobes).then(|| seed::exact(map, footprint, settings.lobes)).flatten();
            searched[lane] = exact.is_none();
            iterations[lane] = if searched[lane] { ITERATIONS.min(settings.iterations) } else { 0 };
            let children = job.children(texels.start + lane);
            let merge = || merged(&children, footprint.len(), settings.lobes, &mut candidates);
            lobes.set(lane, &exact.unwrap_or_else(merge));
        }
        let run = |samples: &mut CrowdSamples, lobes: &mut CrowdLobes, iterations: [usize; LANES]| {
            lobes.prepare();
            samples.fit(lobes, &CrowdStop { iterations, tolerance: f32::NEG_INFINITY })
        };
        run(samples, &mut lobes, iterations);
        crowd_gauss_newton::refine(samples, &mut lobes, steps, &searched);
        let outcome = run(samples, &mut lobes, [0; LANES]);
        for (lane, &iterations) in iterations.iter().enumerate().take(footprints.len()) {
            let lobes = lobes.texel(lane, outcome.total[lane]).settled(settings.kappa);
            let mean_log_likelihood = f64::from(outcome.mean_log_likelihood[lane]);
            keep(lane, &TexelFit { lobes, mean_log_likelihood, iterations });
        }
        footprints.iter().map(Footprint::len).sum()
    })
}

/// Fits one texel.
pub fn fit(samples: &impl Samples, children: &Children<'_>, steps: usize, task: &mut TexelTask<'_>) -> TexelFit {
    let rule = task.settings.kappa;
    let mut lobes = merged(children, task.normals, task.settings.lobes, &mut Candidates::default());
    let iterations = ITERATIONS.min(task.settings.iterations);
    task.begin("EM from merged lobes");
    for _ in 0..iterations {
        let kernel = lobes.for_e_step(rule);
        let sums = em::e_step(samples, &kernel);
        if sums.total <= 0.0 || !task.saw(sums.log_likelihood / sums.total) {
            break;
        }
        lobes.m_step(&kernel, &sums);
    }
    gauss_newton::refine(samples, &mut lobes, steps, &mut || task.visited());
    task.begin("refined");
    let fit = em::fit(samples, lobes, Stop { iterations: 0, tolerance: 0.0 }, rule, |mean| task.saw(mean));
    TexelFit { iterations, ..fit }
}
