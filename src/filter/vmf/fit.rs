//! Fitting every texel of every level: settings, the order of levels, and what is reported on the way.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::alignment::Alignment;
use super::coherence::Coherence;
use super::color::{self, ColorLevel};
use super::em::{EStep, Stop};
use super::looks::Looks;
use super::monitor::{Cancelled, Monitor};
use super::objective::Objective;
use super::pull::Pull;
use super::pyramid::{BaseSlots, LobePyramid, MixtureLevel};
use super::selection::{self, Selection};
use super::{base_slots, between, first, grow, scanline, smooth, unaligned};
use crate::normal_map::NormalMap;
use crate::normal_map::pose::Pose;
use crate::normal_map::pyramid::Texel;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;
use crate::sphere::vmf::KappaRule;

/// How a map is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FitSettings {
    /// Lobes per texel J, `1..=16`: how many, or how many at most.
    #[serde(deserialize_with = "lobe_count")]
    pub lobes: usize,
    /// Who decides how many of them a texel gets.
    pub selection: Selection,
    /// What each texel's own fit strives for.
    pub objective: Objective,
    /// How lobes are aligned.
    pub align: Alignment,
    /// Most EM iterations per texel; an aligned pass takes at most its own number of them.
    pub iterations: usize,
    /// Least gain in mean log-likelihood per normal that goes on.
    pub tolerance: f64,
    /// Which inverse of `A` gives kappa.
    pub kappa: KappaRule,
    /// How the objective `em` and the scanline alignments share normals between lobes.
    pub e_step: EStep,
}

/// Lobes per texel as a file has them; a number that no fit can have is refused.
fn lobe_count<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    let lobes = usize::deserialize(deserializer)?;
    let refused = || serde::de::Error::custom(format!("{lobes} lobes, not 1 to {MAX_LOBES}"));
    (1..=MAX_LOBES).contains(&lobes).then_some(lobes).ok_or_else(refused)
}

impl Default for FitSettings {
    fn default() -> Self {
        Self {
            lobes: 6,
            selection: Selection::default(),
            objective: Objective::default(),
            align: Alignment::default(),
            iterations: 100,
            tolerance: 1e-5,
            kappa: KappaRule::Exact,
            e_step: EStep::default(),
        }
    }
}

impl FitSettings {
    /// The stopping rule of the unaligned fit.
    pub fn stop(&self) -> Stop {
        Stop { iterations: self.iterations, tolerance: self.tolerance }
    }

    /// Passes of the aligned fit over each level; 0 where there is none.
    pub fn aligned_passes(&self) -> usize {
        match self.align {
            Alignment::None => 0,
            Alignment::Smooth { .. } if between::refines(self) => smooth::PASSES_BEFORE_STEPS.min(self.iterations),
            Alignment::Smooth { .. } => smooth::PASSES.min(self.iterations),
            Alignment::Paper { .. } | Alignment::Map { .. } => {
                self.align.pull().map_or(0, Pull::iterations).min(self.iterations)
            }
        }
    }
}

/// What a fitted level came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LevelStats {
    /// Mean over the level's texels of the mean log-likelihood of their normals.
    pub mean_log_likelihood: f64,
    /// Mean iterations, or passes, per texel.
    pub mean_iterations: f64,
    /// Mean number of lobes in use per texel.
    pub mean_lobes: f64,
    /// Seconds it took.
    pub seconds: f64,
    /// Mean log-likelihood that alignment cost against each texel's own fit.
    pub log_likelihood_lost: f64,
    /// What the alignment is worth, once that was asked for.
    pub coherence: Option<Coherence>,
}

/// How far a level's lobes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Each texel's own fit, to be aligned.
    Own,
    /// Aligned, to be thinned out.
    Aligned,
    /// Nothing better will follow.
    Done,
}

/// News from a running fit.
#[derive(Clone, Debug)]
pub enum FitEvent {
    /// The own lobes of the texel that was to be fitted first.
    First {
        /// Which texel.
        texel: Texel,
        /// Its lobes.
        stored: Vec<StoredLobe>,
    },
    /// A level above the base is fitted. A fit that aligns reports each level twice, first unaligned.
    Level {
        /// Which level.
        level: usize,
        /// Its lobes.
        mixtures: Arc<MixtureLevel>,
        /// What it came to.
        stats: LevelStats,
        /// How far they are.
        stage: Stage,
    },
    /// The lobes of a level have their colours.
    Color {
        /// Which level.
        level: usize,
        /// The colours.
        colors: Arc<ColorLevel>,
    },
    /// The base level's slots are chosen: the fit is complete.
    Base(Arc<BaseSlots>),
}

/// Levels of the unaligned fit that are there already, the finest first: a change of the alignment needs them only.
pub type OwnLevels = Vec<(Arc<MixtureLevel>, LevelStats)>;

/// Where a fit starts.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// What an earlier fit of the same settings, alignment apart, has left.
    pub own: OwnLevels,
    /// What an earlier fit with one lobe fewer has left, to grow from.
    pub fewer: OwnLevels,
    /// The texel that somebody waits for.
    pub first: Option<Texel>,
}

/// The normals that a fit of these settings is expected to visit, per level.
pub fn expected_visits(map: &NormalMap, settings: &FitSettings) -> Vec<u64> {
    let colored = usize::from(map.albedo.is_some());
    let passes = unaligned::most_passes(settings) + settings.aligned_passes() + colored;
    let per_level = (map.len() * passes) as u64;
    let levels = map.level_sizes().len();
    let rounds = |level| if level + 1 < levels { between::rounds(settings, level) * map.len() } else { 0 };
    (0..levels).map(|level| if level == 0 { map.len() as u64 } else { per_level + rounds(level) as u64 }).collect()
}

/// Fits every level of `map` on the current thread pool, reporting each as it is done: the unaligned fit from the
/// finest level up, then the aligned one from the coarsest down, then colours and the base level's slots. Deterministic: the
/// number of threads never changes a bit.
pub fn fit(
    map: &Arc<NormalMap>,
    settings: &FitSettings,
    monitor: &Monitor,
    report: &mut dyn FnMut(FitEvent),
) -> Result<LobePyramid, Cancelled> {
    fit_from(map, settings, &Start::default(), monitor, report)
}

/// As [`fit`], from where an earlier one has left off.
pub fn fit_from(
    map: &Arc<NormalMap>,
    settings: &FitSettings,
    start: &Start,
    monitor: &Monitor,
    report: &mut dyn FnMut(FitEvent),
) -> Result<LobePyramid, Cancelled> {
    let mut lobes = LobePyramid::unfitted(Arc::clone(map));
    let mut posed = Posed::new(map, Pose::canonical(map));
    let aligns = settings.align != Alignment::None;
    if let Some(texel) = start.first.filter(|texel| texel.level > start.own.len())
        && let Some(stored) = first::fit(&posed.lobes.map, posed.pose, texel, settings)
    {
        report(FitEvent::First { texel, stored });
    }
    // By level; the base is not fitted.
    let mut own = vec![LevelStats::default()];
    for level in 1..lobes.levels() {
        let (mixtures, stats) = match (start.own.get(level - 1), start.fewer.get(level - 1)) {
            (Some((mixtures, stats)), _) => {
                monitor.visited(level, (map.len() * unaligned::most_passes(settings)) as u64);
                // The last of them has a level to seed.
                if level == start.own.len() {
                    posed.take(level, mixtures);
                }
                (Arc::clone(mixtures), *stats)
            }
            (None, fewer) => {
                let timed = std::time::Instant::now();
                let (mixtures, stats) = match fewer {
                    Some((fewer, _)) => {
                        grow::fit_level(&posed.lobes.map, &fewer.posed(posed.pose), level, settings, monitor)?
                    }
                    None => unaligned::fit_level(&posed.lobes, level, settings, monitor)?,
                };
                let mixtures = posed.put(level, mixtures);
                // It has seeded the next.
                posed.forget(level - 1);
                (mixtures, LevelStats { seconds: timed.elapsed().as_secs_f64(), ..stats })
            }
        };
        own.push(stats);
        keep(&mut lobes, level, mixtures, stats, if aligns { Stage::Own } else { Stage::Done }, report);
    }
    if aligns {
        // An alignment row by row is at home in the map as it lies.
        let posed = if settings.align.pull().is_none() { posed } else { Posed::new(map, Pose::IDENTITY) };
        align(&mut lobes, posed, settings, &own, monitor, report)?;
    }
    color::fit_levels(&mut lobes, settings.kappa, monitor, &mut |level, colors| {
        report(FitEvent::Color { level, colors: Arc::clone(colors) });
    })?;
    let base = if aligns { base_slots::choose(&lobes, monitor)? } else { base_slots::first(map.len()) };
    let base = Arc::new(base);
    lobes.base = Some(Arc::clone(&base));
    report(FitEvent::Base(base));
    Ok(lobes)
}

/// Levels in the pose in which they are fitted: how a map lies decides nothing.
struct Posed {
    pose: Pose,
    lobes: LobePyramid,
}

impl Posed {
    fn new(map: &Arc<NormalMap>, pose: Pose) -> Self {
        Self { pose, lobes: LobePyramid::unfitted(pose.map(map)) }
    }

    /// Takes in a level as the map lies.
    fn take(&mut self, level: usize, mixtures: &Arc<MixtureLevel>) {
        self.lobes.coarse[level - 1] = Some(mixtures.posed(self.pose));
    }

    /// Keeps a level of this pose; returns it as the map lies.
    fn put(&mut self, level: usize, mixtures: MixtureLevel) -> Arc<MixtureLevel> {
        let mixtures = Arc::new(mixtures);
        self.lobes.coarse[level - 1] = Some(Arc::clone(&mixtures));
        mixtures.posed(self.pose.inverse())
    }

    /// Lets go of a level.
    fn forget(&mut self, level: usize) {
        if level > 0 {
            self.lobes.coarse[level - 1] = None;
        }
    }
}

/// Replaces each texel's own lobes by aligned ones, from the coarsest level down.
fn align(
    lobes: &mut LobePyramid,
    mut posed: Posed,
    settings: &FitSettings,
    own: &[LevelStats],
    monitor: &Monitor,
    report: &mut dyn FnMut(FitEvent),
) -> Result<(), Cancelled> {
    let selects = settings.selection != Selection::Fixed;
    let slots = if selects { selection::slots(lobes) } else { settings.lobes };
    let aligned = FitSettings { lobes: slots, selection: Selection::Fixed, ..*settings };
    let top = lobes.levels() - 1;
    let map = Arc::clone(&posed.lobes.map);
    let looks = if between::refines(&aligned) { Some(Looks::new(&map, monitor)?) } else { None };
    // By level, for the lobes that are kept at last.
    let mut seconds = vec![0.0; lobes.levels()];
    let timed = std::time::Instant::now();
    // The top is shared by both fits; alignment starts below it.
    match lobes.level(top).cloned() {
        // Every slot below descends from one of the top, so the top has to fill them all.
        Some(_) if selects => {
            if let Some(seeds) = lobes.level(top - 1) {
                posed.take(top - 1, seeds);
            }
            let (mixtures, mut stats) = unaligned::fit_level(&posed.lobes, top, &aligned, monitor)?;
            stats.seconds = timed.elapsed().as_secs_f64();
            seconds[top] = stats.seconds;
            keep(lobes, top, posed.put(top, mixtures), stats, Stage::Aligned, report);
        }
        Some(mixtures) => {
            posed.take(top, &mixtures);
            keep(lobes, top, mixtures, own[top], Stage::Done, report);
        }
        None => {}
    }
    for level in (1..top).rev() {
        let timed = std::time::Instant::now();
        // The aligned fit starts from the coarser level; this one's own lobes only take room.
        lobes.coarse[level - 1] = None;
        let (mixtures, mut stats) = match (settings.align, settings.align.pull()) {
            (_, Some(pull)) => scanline::fit_level(&posed.lobes, level, pull, &aligned, monitor)?,
            (Alignment::Smooth { blend }, _) => {
                smoothed(&posed.lobes, level, blend, looks.as_ref(), &aligned, monitor)?
            }
            (Alignment::None | Alignment::Paper { .. } | Alignment::Map { .. }, None) => break,
        };
        stats.seconds = timed.elapsed().as_secs_f64();
        seconds[level] = stats.seconds;
        stats.log_likelihood_lost = own[level].mean_log_likelihood - stats.mean_log_likelihood;
        let stage = if selects { Stage::Aligned } else { Stage::Done };
        keep(lobes, level, posed.put(level, mixtures), stats, stage, report);
        if !selects {
            posed.forget(level + 1);
        }
    }
    if let Selection::BrdfError { percent } = settings.selection {
        lobes.coarse.fill(None);
        selection::prune_levels(&mut posed.lobes, f64::from(percent) / 100.0, monitor)?;
    }
    if selects {
        for (level, own) in own.iter().enumerate().skip(1) {
            let Some(mixtures) = posed.lobes.coarse[level - 1].take() else { continue };
            let mut stats = smooth::stats(&map, &mixtures, &aligned, monitor)?;
            stats.seconds = seconds[level];
            stats.log_likelihood_lost = own.mean_log_likelihood - stats.mean_log_likelihood;
            let mixtures = Arc::new(Arc::unwrap_or_clone(mixtures).trimmed());
            keep(lobes, level, mixtures.posed(posed.pose.inverse()), stats, Stage::Done, report);
        }
    }
    Ok(())
}

/// A level aligned by `smooth`, and refined where the objective asks for it.
fn smoothed(
    lobes: &LobePyramid,
    level: usize,
    blend: f32,
    looks: Option<&Looks>,
    settings: &FitSettings,
    monitor: &Monitor,
) -> Result<(MixtureLevel, LevelStats), Cancelled> {
    let mut mixtures = smooth::pass_over(lobes, level, blend, settings, monitor)?;
    let rounds = between::rounds(settings, level);
    if let (Some(looks), true) = (looks, rounds > 0) {
        between::refine(&lobes.map, looks, level, &mut mixtures, rounds, monitor)?;
    }
    let stats = smooth::stats(&lobes.map, &mixtures, settings, monitor)?;
    Ok((mixtures, stats))
}

fn keep(
    lobes: &mut LobePyramid,
    level: usize,
    mixtures: Arc<MixtureLevel>,
    mut stats: LevelStats,
    stage: Stage,
    report: &mut dyn FnMut(FitEvent),
) {
    stats.mean_lobes = mixtures.mean_lobes();
    lobes.coarse[level - 1] = Some(Arc::clone(&mixtures));
    report(FitEvent::Level { level, mixtures, stats, stage });
}
