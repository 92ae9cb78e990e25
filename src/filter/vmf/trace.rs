//! How one texel's fit went, on demand: the log-likelihood of every iteration, what was retired, what was capped.

use serde::Serialize;

use super::alignment::Alignment;
use super::em::TexelLobes;
use super::fit::FitSettings;
use super::pyramid::LobePyramid;
use super::{scanline, smooth, unaligned};
use crate::normal_map::pose::Pose;
use crate::normal_map::pyramid::Texel;
use crate::sphere::mixture::EMPTY_WEIGHT;
use crate::sphere::vmf::{self, KAPPA_MAX};

/// One run of EM.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TracedRun {
    /// Where it started.
    pub name: &'static str,
    /// Mean log-likelihood of the texel's normals, per normal and steradian, at each E-step.
    pub log_likelihood: Vec<f64>,
}

/// A texel's fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trace {
    /// Every run of EM in order. A texel of an aligned level shows its passes beside the neighbours as they ended; one
    /// of an unaligned level, and the top, its own fit from the children's lobes at hand.
    pub runs: Vec<TracedRun>,
    /// Iterations of all runs.
    pub iterations: usize,
    /// Slots that hold no lobe: retired by EM, or never filled.
    pub retired: usize,
    /// Lobes as sharp as a fit may be, [`KAPPA_MAX`], or sharper.
    pub capped: usize,
}

/// Runs the texel's fit again and watches it; `None` for a base texel and for a level that is not fitted.
pub fn trace(lobes: &LobePyramid, texel: Texel, settings: &FitSettings) -> Option<Trace> {
    let stored = lobes.level(texel.level)?.texel(texel.x, texel.y);
    // As it was fitted.
    let pose = if settings.align.pull().is_none() { Pose::canonical(&lobes.map) } else { Pose::IDENTITY };
    let texel = pose.texel(lobes.map.level_size(texel.level), texel);
    let lobes = &lobes.posed(pose);
    let top = texel.level + 1 == lobes.levels();
    let runs = match settings.align {
        Alignment::Smooth { blend } if !top => vec![smooth::trace_texel(lobes, texel, blend, settings)?],
        Alignment::Paper { .. } | Alignment::Map { .. } if !top => vec![scanline::trace_texel(lobes, texel, settings)?],
        _ => unaligned::trace_texel(lobes, texel.level, (texel.x, texel.y), settings).1,
    };
    let fit = TexelLobes::from_stored(stored);
    let used = |&j: &usize| fit.alpha[j] > f64::from(EMPTY_WEIGHT);
    let sharp = |&j: &usize| vmf::concentration(1.0 - fit.resultant[j].length()) >= KAPPA_MAX;
    Some(Trace {
        iterations: runs.iter().map(|run| run.log_likelihood.len().saturating_sub(1)).sum(),
        retired: stored.len() - (0..stored.len()).filter(used).count(),
        capped: (0..stored.len()).filter(used).filter(sharp).count(),
        runs,
    })
}
