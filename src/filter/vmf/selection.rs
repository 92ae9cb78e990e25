//! How many lobes a texel gets: as many as it may, or as few as a criterion is content with (the future work of
//! Mikkelsen 2008).
//!
//! A texel whose lobes are chosen leaves its other slots empty, which interpolates exactly: a lobe beside an empty slot
//! cross-fades. So aligned storage stays valid.

use std::str::FromStr;
use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::bins::BinnedSamples;
use super::brdf_error::TrueBrdf;
use super::children::Children;
use super::em::{self, Stop, TexelFit, TexelLobes};
use super::merge::{Blurred, pair_by_rank};
use super::monitor::{Cancelled, Monitor};
use super::pyramid::{LobePyramid, MixtureLevel};
use super::samples::FootprintSamples;
use super::seed;
use crate::normal_map::pyramid::Footprint;
use crate::sphere::mixture::MAX_LOBES;
use crate::sphere::vmf::{self, KappaRule};

/// Who decides how many lobes a texel gets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Selection {
    /// Every texel gets the most there are.
    #[default]
    Fixed,
    /// As few as keep the error of the effective BRDF at or below this share of the truth ([`TrueBrdf`]).
    BrdfError {
        /// In percent, above 0.
        percent: f32,
    },
    /// As few as the Bayesian information criterion asks for (Schwarz 1978).
    Bic,
}

impl Selection {
    /// The error that is content unless told, percent.
    pub const DEFAULT_PERCENT: f32 = 2.0;

    /// The BRDF's error, with the usual target.
    pub const AUTO: Self = Self::BrdfError { percent: Self::DEFAULT_PERCENT };

    /// Most lobes that the criterion may choose unless told.
    pub fn default_most(self) -> usize {
        match self {
            Self::Fixed => 6,
            Self::BrdfError { .. } => MAX_LOBES,
            Self::Bic => 8,
        }
    }
}

impl std::fmt::Display for Selection {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Fixed => formatter.write_str("fixed"),
            Self::BrdfError { percent: Self::DEFAULT_PERCENT } => formatter.write_str("auto"),
            Self::BrdfError { percent } => write!(formatter, "auto:{percent}"),
            Self::Bic => formatter.write_str("bic"),
        }
    }
}

impl From<Selection> for String {
    fn from(selection: Selection) -> Self {
        selection.to_string()
    }
}

impl TryFrom<String> for Selection {
    type Error = ParseLobeCountError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        match text.as_str() {
            "fixed" => Ok(Self::Fixed),
            "bic" => Ok(Self::Bic),
            _ => percent(&text).ok_or(ParseLobeCountError(text)),
        }
    }
}

/// The target in `auto` or `auto:PERCENT`.
fn percent(text: &str) -> Option<Selection> {
    if text == "auto" {
        return Some(Selection::AUTO);
    }
    let percent = text.strip_prefix("auto:")?.parse().ok()?;
    (percent > 0.0 && percent <= 100.0).then_some(Selection::BrdfError { percent })
}

/// A number of lobes as it is asked for: `6`, `auto`, `auto:5`, `bic`, `bic:12`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeCount {
    /// Most lobes per texel, `1..=16`.
    pub most: usize,
    /// Who decides.
    pub selection: Selection,
}

/// Why a number of lobes could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a number of lobes: write 1 to 16, auto, auto:PERCENT, bic or bic:MAX with MAX from 1 to 16")]
pub struct ParseLobeCountError(String);

impl FromStr for LobeCount {
    type Err = ParseLobeCountError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.parse().ok().filter(|most| (1..=MAX_LOBES).contains(most));
        let by_default = |selection: Selection| Self { most: selection.default_most(), selection };
        match text {
            "bic" => Some(by_default(Selection::Bic)),
            _ => number(text)
                .map(|most| Self { most, selection: Selection::Fixed })
                .or_else(|| number(text.strip_prefix("bic:")?).map(|most| Self { most, selection: Selection::Bic }))
                .or_else(|| percent(text).map(by_default)),
        }
        .ok_or_else(|| ParseLobeCountError(text.to_owned()))
    }
}

/// Fits of one texel with some number of lobes, judged by a criterion.
pub struct Trials<'a, F> {
    /// The footprint's normals.
    pub samples: &'a FootprintSamples<'a>,
    /// Most lobes.
    pub most: usize,
    /// Which inverse of `A` the fit uses.
    pub kappa: KappaRule,
    /// Fits with this many lobes.
    pub fit: F,
}

impl<F: FnMut(usize) -> TexelFit> Trials<'_, F> {
    /// The fit that `selection` is content with; the richest one where it never is.
    pub fn choose(mut self, selection: Selection, children: &Children<'_>) -> TexelFit {
        match selection {
            Selection::Fixed => (self.fit)(self.most),
            Selection::BrdfError { percent } => self.by_error(f64::from(percent) / 100.0, children),
            Selection::Bic => self.by_information(),
        }
    }

    /// Grows from as many lobes as a child has until the error is under the target, or shrinks while it stays there.
    fn by_error(&mut self, target: f64, children: &Children<'_>) -> TexelFit {
        if let Some(fit) = self.by_merging(target) {
            return fit;
        }
        let mut count = children.most_lobes().clamp(1, self.most);
        let mut best = (self.fit)(count);
        let Some(truth) = TrueBrdf::new(self.samples) else { return best };
        if truth.error(&best.lobes) <= target {
            while count > 1 {
                count -= 1;
                let fewer = (self.fit)(count);
                if truth.error(&fewer.lobes) > target {
                    break;
                }
                best = fewer;
            }
            return best;
        }
        while count < self.most {
            count += 1;
            best = (self.fit)(count);
            if truth.error(&best.lobes) <= target {
                break;
            }
        }
        best
    }

    /// Starts from a lobe for every normal, where there are so few that nothing is gained by fitting, and merges them.
    fn by_merging(&self, target: f64) -> Option<TexelFit> {
        let footprint = self.samples.footprint();
        if footprint.len() > FEW.min(self.most) {
            return None;
        }
        let mut lobes = seed::exact(self.samples.map(), footprint, self.most)?;
        if let Some(truth) = TrueBrdf::new(self.samples) {
            prune(&mut lobes, |fewer| truth.error(fewer) <= target);
        }
        Some(em::fit(self.samples, lobes, Stop { iterations: 0, tolerance: 0.0 }, self.kappa, |_| true))
    }

    /// The least `-2 n L + (4 J - 1) ln n` over J, n the occupied cells of [`BinnedSamples`] and L the mean
    /// log-likelihood with lobes no sharper than a cell: repeated normals are no further evidence.
    fn by_information(&mut self) -> TexelFit {
        let cells = BinnedSamples::new(self.samples.map(), self.samples.footprint()).occupied();
        let n = cells.max(1) as f64;
        let mut best: Option<(f64, TexelFit)> = None;
        let mut rises = 0;
        for count in 1..=self.most.min(cells.max(1)) {
            let fit = (self.fit)(count);
            let sums = em::e_step(self.samples, &no_sharper(&fit.lobes, CELL_KAPPA).for_e_step(self.kappa));
            let mean = if sums.total > 0.0 { sums.log_likelihood / sums.total } else { 0.0 };
            let criterion = -2.0 * n * mean + (4 * count - 1) as f64 * n.ln();
            match &best {
                Some((least, _)) if criterion >= *least => rises += 1,
                _ => (best, rises) = (Some((criterion, fit)), 0),
            }
            if rises > RISES {
                break;
            }
        }
        best.map_or_else(|| (self.fit)(1), |(_, fit)| fit)
    }
}

/// Most base texels of a footprint whose normals are merged rather than fitted: those of level 1.
const FEW: usize = 4;

/// Rises of the information criterion in a row after which more lobes are not tried.
const RISES: usize = 1;

/// The concentration of a lobe as wide as a cell of [`BinnedSamples`]: variance `(pi / 112)^2 / 12` per axis.
const CELL_KAPPA: f64 = 12.0 / (0.028 * 0.028);

/// The lobes with every concentration at most `kappa`.
fn no_sharper(lobes: &TexelLobes, kappa: f64) -> TexelLobes {
    let longest = vmf::mean_resultant_length(kappa);
    let mut capped = *lobes;
    capped.resultant.iter_mut().for_each(|resultant| *resultant = resultant.clamp_length_max(longest));
    capped
}

/// The slots that aligned lobes of chosen number are kept in: enough for 95 % of the texels of every level.
pub fn slots(lobes: &LobePyramid) -> usize {
    lobes.coarse.iter().flatten().map(|level| enough(level)).max().unwrap_or(1)
}

fn enough(level: &MixtureLevel) -> usize {
    let counts = level.lobe_counts();
    let texels: usize = counts.iter().sum();
    let mut covered = 0;
    let wanted = |count: &usize| {
        covered += count;
        covered * 20 >= texels * 19
    };
    counts.iter().position(wanted).unwrap_or(MAX_LOBES).max(1)
}

/// Merges the lobes of a texel, the pair first that a material tells apart least, while `content` with the result. Each
/// merged lobe takes the slot of the heavier one, so that slots keep their meaning.
pub fn prune(lobes: &mut TexelLobes, mut content: impl FnMut(&TexelLobes) -> bool) {
    let criterion = Blurred { shininess: f64::from(super::brdf_error::SHININESS) };
    while let Some((a, b)) = pair_by_rank(lobes, 0, &criterion) {
        let (kept, freed) = if lobes.alpha[b] > lobes.alpha[a] { (b, a) } else { (a, b) };
        let mut fewer = *lobes;
        let alpha = lobes.alpha[a] + lobes.alpha[b];
        fewer.resultant[kept] = (lobes.alpha[a] * lobes.resultant[a] + lobes.alpha[b] * lobes.resultant[b]) / alpha;
        (fewer.alpha[kept], fewer.alpha[freed]) = (alpha, 0.0);
        fewer.resultant[freed] = glam::DVec3::ZERO;
        if !content(&fewer) {
            return;
        }
        *lobes = fewer;
    }
}

/// Prunes every level ([`prune_texel`]).
pub fn prune_levels(lobes: &mut LobePyramid, target: f64, monitor: &Monitor) -> Result<(), Cancelled> {
    let map = Arc::clone(&lobes.map);
    for level in lobes.coarse.iter_mut().flatten() {
        let level = Arc::make_mut(level);
        let size = (level.width, level.height);
        level.stored.par_chunks_exact_mut(level.lobes).enumerate().try_for_each(|(index, stored)| {
            monitor.check()?;
            let footprint = Footprint::new((map.width, map.height), size, (index % size.0, index / size.0));
            prune_texel(&FootprintSamples::new(&map, footprint), stored, target);
            Ok(())
        })?;
    }
    Ok(())
}

/// Prunes a texel whose lobes err no more than `target` to as few as still do.
pub fn prune_texel(samples: &FootprintSamples<'_>, stored: &mut [[f32; 4]], target: f64) {
    let mut lobes = TexelLobes::from_stored(stored);
    let Some(truth) = TrueBrdf::new(samples) else { return };
    if truth.error(&lobes) <= target {
        prune(&mut lobes, |fewer| truth.error(fewer) <= target);
        lobes.store(stored);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_lobes_reads_as_it_is_meant() {
        let read = |text: &str| text.parse::<LobeCount>().map(|count| (count.most, count.selection));
        assert_eq!(read("6"), Ok((6, Selection::Fixed)));
        assert_eq!(read("auto"), Ok((16, Selection::AUTO)));
        assert_eq!(read("auto:5"), Ok((16, Selection::BrdfError { percent: 5.0 })));
        assert_eq!(read("bic"), Ok((8, Selection::Bic)));
        assert_eq!(read("bic:12"), Ok((12, Selection::Bic)));
        for wrong in ["", "0", "17", "auto:", "auto:0", "auto:nan", "bic:0", "bic:17", "AUTO"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_selection_reads_as_it_is_written() {
        for selection in [Selection::Fixed, Selection::AUTO, Selection::BrdfError { percent: 0.5 }, Selection::Bic] {
            assert_eq!(Selection::try_from(selection.to_string()), Ok(selection));
        }
    }
}
