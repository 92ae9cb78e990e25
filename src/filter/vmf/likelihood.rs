//! The fit for the likelihood (stub).

use super::children::Children;
use super::em::{self, Stop, TexelFit};
use super::fit::FitSettings;
use super::merge::{Candidates, KullbackLeibler};
use super::samples::Samples;
use super::unaligned::TexelTask;

/// Passes that a texel is expected to take at most.
pub fn most_passes(settings: &FitSettings) -> usize {
    settings.iterations + 1
}

/// Fits one texel.
pub fn fit(samples: &impl Samples, children: &Children<'_>, task: &mut TexelTask<'_>) -> TexelFit {
    let mut candidates = Candidates::default();
    children.add_to(&mut candidates, &KullbackLeibler);
    candidates.merge_down_to(task.settings.lobes, &KullbackLeibler);
    let stop = Stop { iterations: 25, tolerance: 0.0 };
    em::fit(samples, candidates.to_lobes(task.settings.lobes), stop, task.settings.kappa, || task.visited())
}
