//! Roughness for each MIP level, so that a renderer of one isotropic lobe widens its highlight as the normals under a
//! texel ask for.
//!
//! The normals' spread comes from the length of the mean normal `N`, as a variance `v = 1 / kappa` per component: of
//! the one von Mises-Fisher lobe with that mean, `|N| = A(kappa)`, or as Toksvig's factor has it for a mirror,
//! `kappa = |N| / (1 - |N|)` (M. Toksvig, 2004, s to infinity). It is the normals' own, without a material's, whose
//! variance adds to it. A texel whose normals cancel, or that has none, is as rough as can be.

use std::path::{Path, PathBuf};

use crate::filter::PlainMip;
use crate::image_io::exr_parts::{Notes, Part, write_parts};
use crate::image_io::{WriteImageError, write_png_gray8, write_png_gray16};
use crate::normal_map::Addressing;
use crate::sphere::vmf::{KAPPA_DELTA, concentration};

/// How the spread follows from the mean normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spread {
    /// One von Mises-Fisher lobe.
    #[default]
    Vmf,
    /// Toksvig's factor.
    Toksvig,
}

/// What roughness means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Convention {
    /// `alpha = sqrt(2 v)`, of Beckmann's and Trowbridge and Reitz's (GGX) distributions.
    #[default]
    Alpha,
    /// `sqrt(v)`, the standard deviation of slopes.
    Deviation,
    /// `sigma = sqrt(v / 2)`, of `exp(-b^2 / (4 sigma^2))`, Torrance and Sparrow's as Han et al. 2007 write it.
    Sigma,
    /// `sqrt(alpha)`, perceptual roughness, which renderers square.
    Perceptual,
}

/// What a file's samples are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Depth {
    /// Integers of 8 bits, full scale 1.
    #[default]
    Bits8,
    /// Integers of 16 bits, full scale 1.
    Bits16,
}

/// How roughness is exported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct RoughnessSettings {
    /// How the spread follows from the mean normal.
    pub spread: Spread,
    /// What roughness means.
    pub convention: Convention,
    /// The samples of PNG files; OpenEXR has floats.
    pub depth: Depth,
}

impl Spread {
    /// Every way, in the order they are offered.
    pub const ALL: [Self; 2] = [Self::Vmf, Self::Toksvig];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Vmf => "one lobe",
            Self::Toksvig => "Toksvig",
        }
    }

    /// `1 / kappa` over a mean normal of length `1 - shortfall`; infinite where that is nothing.
    pub fn variance(self, shortfall: f64) -> f64 {
        let shortfall = shortfall.clamp(0.0, 1.0);
        match self {
            Self::Vmf => 1.0 / concentration(shortfall),
            Self::Toksvig => (shortfall / (1.0 - shortfall)).max(1.0 / KAPPA_DELTA),
        }
    }
}

impl Convention {
    /// Every convention, in the order they are offered.
    pub const ALL: [Self; 4] = [Self::Alpha, Self::Deviation, Self::Sigma, Self::Perceptual];

    /// The name to show, with the formula.
    pub fn label(self) -> &'static str {
        match self {
            Self::Alpha => "alpha = sqrt(2/kappa)",
            Self::Deviation => "deviation = sqrt(1/kappa)",
            Self::Sigma => "sigma = sqrt(1/(2 kappa))",
            Self::Perceptual => "perceptual = sqrt(alpha)",
        }
    }

    /// The roughness of a variance, at most 1.
    pub fn roughness(self, variance: f64) -> f64 {
        let roughness = match self {
            Self::Alpha => (2.0 * variance).sqrt(),
            Self::Deviation => variance.sqrt(),
            Self::Sigma => (variance / 2.0).sqrt(),
            Self::Perceptual => (2.0 * variance).sqrt().sqrt(),
        };
        roughness.min(1.0)
    }
}

impl RoughnessSettings {
    /// The roughness of every texel of a level, row by row, 0 to 1.
    pub fn level(&self, mip: &PlainMip, level: usize) -> Vec<f32> {
        mip.levels[level].iter().map(|mean| self.of_length(mean.as_dvec3().length()) as f32).collect()
    }

    /// The roughness over a mean normal of this length.
    pub fn of_length(&self, length: f64) -> f64 {
        self.convention.roughness(self.spread.variance(1.0 - length))
    }

    /// Writes every level: into one OpenEXR file of a part `level.NN` each where `path` ends in `.exr`, otherwise into a
    /// grey PNG each, `NAME.level.NN.png`. Each file is whole or not written. Returns the files.
    ///
    /// # Errors
    /// One sentence that names the target and the cause; the files before it are written.
    pub fn write(&self, path: &Path, mip: &PlainMip) -> Result<Vec<PathBuf>, WriteImageError> {
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            self.write_exr(path, mip).map(|()| vec![path.to_owned()])
        } else {
            (0..mip.levels.len()).map(|level| self.write_png(path, mip, level)).collect()
        }
    }

    fn write_png(&self, path: &Path, mip: &PlainMip, level: usize) -> Result<PathBuf, WriteImageError> {
        let path = path.with_extension(format!("level.{level:02}.png"));
        let (values, (width, height)) = (self.level(mip, level), mip.map.level_size(level));
        match self.depth {
            Depth::Bits8 => {
                let samples: Vec<u8> = values.iter().map(|value| (value * 255.0).round() as u8).collect();
                write_png_gray8(&path, width, height, &samples)?;
            }
            Depth::Bits16 => {
                let samples: Vec<u16> = values.iter().map(|value| (value * 65535.0).round() as u16).collect();
                write_png_gray16(&path, width, height, &samples)?;
            }
        }
        Ok(path)
    }

    fn write_exr(&self, path: &Path, mip: &PlainMip) -> Result<(), WriteImageError> {
        let levels: Vec<Vec<f32>> = (0..mip.levels.len()).map(|level| self.level(mip, level)).collect();
        let note = format!("{}, from {}", self.convention.label(), self.spread.label());
        let part = |level: usize| Part {
            name: format!("level.{level:02}"),
            size: mip.map.level_size(level),
            channels: vec!["Y".to_owned()],
            notes: notes(mip, [("roughness".to_owned(), note.clone())].into()),
        };
        let parts: Vec<Part> = (0..levels.len()).map(part).collect();
        write_parts(path, &parts, &|place, row| {
            let first = place.y * parts[place.part].size.0 + place.x;
            row.copy_from_slice(&levels[place.part][first..][..row.len()]);
        })
    }
}

/// What a part says beside its samples.
pub(super) fn notes(mip: &PlainMip, own: std::collections::BTreeMap<String, String>) -> Notes {
    Notes {
        software: format!("ndf-inspector {}", env!("CARGO_PKG_VERSION")),
        wrap_mode: match mip.map.options.addressing {
            Addressing::Wrap => "periodic",
            Addressing::Clamp => "clamp",
        }
        .to_owned(),
        own,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::vmf::mean_resultant_length;

    #[test]
    fn a_lobe_comes_back_by_its_mean_length_in_every_convention() {
        for kappa in [2.5, 40.0, 3000.0] {
            let settings = |convention| RoughnessSettings { convention, ..RoughnessSettings::default() };
            let roughness = |convention| settings(convention).of_length(mean_resultant_length(kappa));
            let expected = [2.0 / kappa, 1.0 / kappa, 0.5 / kappa];
            for (convention, squared) in Convention::ALL.into_iter().zip(expected) {
                // Newton's steps end at 1e-6 of kappa.
                assert!((roughness(convention).powi(2) / squared - 1.0).abs() < 1e-5, "{convention:?} at {kappa}");
            }
            assert!((roughness(Convention::Perceptual).powi(4) / expected[0] - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn both_spreads_agree_on_narrow_lobes_and_nothing_is_rougher_than_1() {
        // A(kappa) = 1 - 1/kappa there, Toksvig's 1 - 1/(kappa + 1).
        let [vmf, toksvig] = Spread::ALL.map(|spread| spread.variance(1e-3));
        assert!((vmf / toksvig - 1.0).abs() < 2e-3, "{vmf} and {toksvig}");
        for (spread, length) in Spread::ALL.into_iter().flat_map(|spread| [0.0, 0.2, 1.0, 1.0001].map(|l| (spread, l)))
        {
            let roughness = RoughnessSettings { spread, ..RoughnessSettings::default() }.of_length(length);
            assert!((0.0..=1.0).contains(&roughness), "{spread:?} of {length}: {roughness}");
        }
    }
}
