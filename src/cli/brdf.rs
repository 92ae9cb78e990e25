//! A BRDF as options name it.

use std::path::PathBuf;
use std::str::FromStr;

use clap::ValueEnum;

use crate::brdf::{BlinnPhong, Brdf, Ggx, ParseBrdfError, TorranceSparrow};
use crate::session::measured;

/// An analytic BRDF, or a file of a measured one, which is read when it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum BrdfArgument {
    /// `lambert`, `blinn-phong:S` and so on.
    Analytic(Brdf),
    /// `merl:FILE`.
    Merl(PathBuf),
}

impl FromStr for BrdfArgument {
    type Err = ParseBrdfError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.strip_prefix("merl:") {
            Some(path) if !path.is_empty() => Ok(Self::Merl(path.into())),
            _ => text.parse().map(Self::Analytic),
        }
    }
}

impl BrdfArgument {
    /// The BRDF, its file read.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read(&self) -> anyhow::Result<Brdf> {
        match self {
            Self::Analytic(brdf) => Ok(*brdf),
            Self::Merl(path) => Ok(Brdf::Measured(measured::read(path)?)),
        }
    }
}

/// A model with a width.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Analytic {
    /// Blinn-Phong of the exponent itself.
    BlinnPhong,
    /// The Torrance-Sparrow form of sigma = 1 / sqrt(2 s).
    TorranceSparrow,
    /// GGX of the alpha at which it falls to half its peak at the same angle.
    Ggx,
}

impl Analytic {
    /// The model as wide as Blinn-Phong of an exponent.
    pub fn of_exponent(self, exponent: f64) -> Brdf {
        match self {
            Self::BlinnPhong => Brdf::BlinnPhong(BlinnPhong { shininess: exponent }),
            Self::TorranceSparrow => Brdf::TorranceSparrow(TorranceSparrow::of_exponent(exponent)),
            Self::Ggx => Brdf::Ggx(Ggx::of_exponent(exponent)),
        }
    }
}
