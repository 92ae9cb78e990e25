//! Reflectance models and the material that the lit surface wears.
//!
//! A model is a zonal function f(u) of the cosine between the normal and the direction that matters, the half vector or,
//! for the Lambertian, the light: what may be filtered by convolution (Han et al. 2007, eq. 3 and 10). It integrates to
//! 1 over the sphere; the material's strengths scale it. Every model has
//!
//! - its value, [`Brdf::zonal`];
//! - its multipliers `rho_l`, in closed form or projected, [`Brdf::multipliers`];
//! - its convolution with a von Mises-Fisher lobe, by a closed rule or exactly, [`Brdf::convolved_with`];
//! - an equivalent exponent, [`Brdf::exponent`], for the rivals that only know Blinn-Phong: Toksvig, LEAN and planar
//!   Gaussians take the material for Blinn-Phong of that.
//!
//! Lobes filter every model about as well as Blinn-Phong of the same width: the colour error of six lobes over three
//! bundled maps of 128 x 128 texels (`compare --models blinn-phong,torrance-sparrow,ggx --distances 4`) is
//!
//! | as wide as s = | 8 | 32 | 128 | 512 |
//! | --- | --- | --- | --- | --- |
//! | Blinn-Phong | 0.045 | 0.062 | 0.088 | 0.125 |
//! | Torrance-Sparrow | 0.044 | 0.061 | 0.087 | 0.125 |
//! | GGX | 0.040 | 0.049 | 0.066 | 0.092 |
//!
//! Factors of the angle between light and half vector, Fresnel's above all, do not depend on the normal and multiply
//! unfiltered: [`Material::towards`]. A model is one file here with its twin in `shaders/shared/`, its description a
//! [`ModelKind`], its place in [`Model`] and [`Brdf`].

pub mod blinn_phong;
pub mod blurred_powers;
pub mod convolution;
pub mod drying;
pub mod exact_table;
pub mod factors;
pub mod fresnel;
pub mod ggx;
pub mod kind;
pub mod material;
pub mod measured;
pub mod merl;
pub mod model;
pub mod projection;
pub mod torrance_sparrow;

use std::str::FromStr;

use self::projection::LOBES;
use crate::sphere::harmonics::{cosine_power_zonal, cosine_power_zonal_of_paper};

pub use blinn_phong::BlinnPhong;
pub use convolution::{ConvolutionRule, Convolved, DiffuseRule};
pub use ggx::Ggx;
pub use kind::{ModelKind, ModelParameter};
pub use material::Material;
pub use measured::Measured;
pub use merl::{Merl, MerlError};
pub use model::Model;
pub use projection::{PowerLobe, Projection};
pub use torrance_sparrow::TorranceSparrow;

/// A reflectance model by name and parameter, as the command line writes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Brdf {
    /// `lambert`: the clamped cosine over pi.
    Lambert,
    /// `blinn-phong:S`.
    BlinnPhong(BlinnPhong),
    /// `torrance-sparrow:SIGMA`.
    TorranceSparrow(TorranceSparrow),
    /// `ggx:ALPHA`.
    Ggx(Ggx),
    /// `merl:FILE`: f(theta_h) of a measured reflectance, of one channel or of their luminance.
    Measured(Measured),
}

impl Brdf {
    /// The zonal function `f(u)` of the cosine between normal and lighting direction, integrating to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        match self {
            // max(u, 0) / pi is Blinn-Phong with s = 1: (s+1)/(2 pi) = 1/pi.
            Self::Lambert => BlinnPhong { shininess: 1.0 }.zonal(cosine),
            Self::BlinnPhong(model) => model.zonal(cosine),
            Self::TorranceSparrow(model) => model.zonal(cosine),
            Self::Ggx(model) => model.zonal(cosine),
            Self::Measured(model) => model.zonal(cosine),
        }
    }

    /// `rho_l = 2 pi int f(u) P_l(u) du` for `l < bands`: exact, or as the paper writes them where the rule is its own
    /// and it does so.
    pub fn multipliers(self, rule: ConvolutionRule, bands: usize) -> Vec<f64> {
        match (self, rule) {
            (Self::Lambert, _) => cosine_power_zonal(1.0, bands),
            (Self::BlinnPhong(model), ConvolutionRule::Paper) => cosine_power_zonal_of_paper(model.shininess, bands),
            (Self::BlinnPhong(model), _) => cosine_power_zonal(model.shininess, bands),
            (Self::TorranceSparrow(model), ConvolutionRule::Paper) => model.zonal_of_paper(bands),
            (Self::TorranceSparrow(_) | Self::Ggx(_) | Self::Measured(_), _) => {
                Projection::of(self).multipliers(bands).to_vec()
            }
        }
    }

    /// The Blinn-Phong lobes that stand for it where no closed form convolves it with a lobe.
    pub fn lobes(self) -> [PowerLobe; LOBES] {
        match self {
            Self::Lambert | Self::BlinnPhong(_) => {
                let mut lobes = [PowerLobe::default(); LOBES];
                lobes[0] = PowerLobe { weight: 1.0, shininess: self.exponent() };
                lobes
            }
            Self::TorranceSparrow(_) | Self::Ggx(_) | Self::Measured(_) => Projection::of(self).lobes,
        }
    }

    /// The exponent of the Blinn-Phong lobe of the same width: 1 for the Lambertian.
    pub fn exponent(self) -> f64 {
        match self {
            Self::Lambert => 1.0,
            Self::BlinnPhong(model) => model.shininess,
            Self::TorranceSparrow(model) => model.exponent(),
            Self::Ggx(model) => model.exponent(),
            Self::Measured(model) => model.exponent(),
        }
    }

    /// True where f falls off as a power of the angle rather than exponentially.
    pub fn has_tail(self) -> bool {
        matches!(self, Self::Ggx(_) | Self::Measured(_))
    }
}

impl std::fmt::Display for Brdf {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Lambert => formatter.write_str("lambert"),
            Self::BlinnPhong(model) => write!(formatter, "blinn-phong:{}", model.shininess),
            Self::TorranceSparrow(model) => write!(formatter, "torrance-sparrow:{}", model.sigma),
            Self::Ggx(model) => write!(formatter, "ggx:{}", model.alpha),
            Self::Measured(model) => write!(formatter, "merl:{}", model.measurement().name),
        }
    }
}

/// Why a BRDF's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a BRDF: write {usage}, or merl:FILE", usage = usage())]
pub struct ParseBrdfError(String);

/// What may be written, as in "lambert, or blinn-phong:S with S from 1 to 100000".
fn usage() -> String {
    let of_model = |model: &Model| {
        let kind = model.kind();
        kind.parameter.as_ref().map_or_else(
            || kind.usage(),
            |p| format!("{} with {} from {} to {}", kind.usage(), p.symbol, p.range[0], p.most),
        )
    };
    let analytic = Model::ALL.iter().filter(|&&model| model != Model::Measured);
    analytic.map(of_model).collect::<Vec<_>>().join(", or ")
}

impl FromStr for Brdf {
    type Err = ParseBrdfError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (name, value) = text.split_once(':').map_or((text, None), |(name, value)| (name, Some(value)));
        let found = Model::ALL.into_iter().find(|model| model.kind().name == name).and_then(|model| {
            let Some(parameter) = &model.kind().parameter else {
                return (model == Model::Lambert && value.is_none()).then_some(Self::Lambert);
            };
            let value: f64 = value?.parse().ok()?;
            (f64::from(parameter.range[0])..=parameter.most).contains(&value).then(|| (parameter.model)(value))
        });
        found.ok_or_else(|| ParseBrdfError(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every model, narrow and wide.
    pub(super) fn some_models() -> Vec<Brdf> {
        let names = "lambert blinn-phong:10 blinn-phong:400 torrance-sparrow:0.05 torrance-sparrow:0.2 \
                     torrance-sparrow:0.5 ggx:0.05 ggx:0.3 ggx:1";
        names.split_whitespace().map(|name| name.parse().expect("a BRDF")).collect()
    }

    #[test]
    fn a_brdf_reads_as_it_is_written_and_others_are_refused() {
        for brdf in some_models() {
            assert_eq!(brdf.to_string().parse(), Ok(brdf));
        }
        for text in
            ["", "lambert:2", "blinn-phong", "blinn-phong:0", "blinn-phong:nan", "ggx:2", "ggx:", "phong:3", "merl"]
        {
            let error = text.parse::<Brdf>().expect_err(text).to_string();
            assert!(error.contains("torrance-sparrow:SIGMA with SIGMA from 0.01 to 0.5"), "{error}");
        }
    }
}
