//! Reflectance models and the material that the lit surface wears.

pub mod blinn_phong;
pub mod exact_table;

use glam::Vec3;
use std::str::FromStr;

pub use blinn_phong::{BlinnPhong, ConvolutionRule, Convolved, DiffuseRule};

/// What the lit surface is made of: a Lambertian and a Blinn-Phong part.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Material {
    /// Blinn-Phong exponent s.
    pub shininess: f32,
    /// Specular strength Ks.
    pub specular: f32,
    /// Diffuse strength Kd.
    pub diffuse: f32,
    /// Linear RGB of the specular part.
    pub specular_color: Vec3,
    /// Linear RGB of the diffuse part.
    pub diffuse_color: Vec3,
    /// How a lobe and the BRDF are convolved.
    pub convolution: ConvolutionRule,
    /// How a lobe reflects diffusely.
    pub diffuse_rule: DiffuseRule,
}

impl Material {
    /// What a new session starts with.
    pub const DEFAULT: Self = Self {
        shininess: 64.0,
        specular: 0.1,
        diffuse: 0.5,
        specular_color: Vec3::new(1.0, 0.96, 0.9),
        diffuse_color: Vec3::new(0.32, 0.36, 0.45),
        convolution: ConvolutionRule::ShiftedExponent,
        diffuse_rule: DiffuseRule::Cosine,
    };
}

impl Default for Material {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// A reflectance model by name and parameter, as the command line writes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Brdf {
    /// `lambert`: the clamped cosine over pi.
    Lambert,
    /// `blinn-phong:S`.
    BlinnPhong(BlinnPhong),
}

impl Brdf {
    /// The zonal function `f(u)` of the cosine between normal and lighting direction, integrating to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        match self {
            // max(u, 0) / pi is Blinn-Phong with s = 1: (s+1)/(2 pi) = 1/pi.
            Self::Lambert => BlinnPhong { shininess: 1.0 }.zonal(cosine),
            Self::BlinnPhong(model) => model.zonal(cosine),
        }
    }

    /// The exponent of the equivalent Blinn-Phong lobe: 1 for the Lambertian.
    pub fn exponent(self) -> f64 {
        match self {
            Self::Lambert => 1.0,
            Self::BlinnPhong(model) => model.shininess,
        }
    }
}

impl std::fmt::Display for Brdf {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Lambert => formatter.write_str("lambert"),
            Self::BlinnPhong(model) => write!(formatter, "blinn-phong:{}", model.shininess),
        }
    }
}

/// Why a BRDF's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a BRDF: write lambert or blinn-phong:S with S from 1 to 100000")]
pub struct ParseBrdfError(String);

impl FromStr for Brdf {
    type Err = ParseBrdfError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "lambert" {
            return Ok(Self::Lambert);
        }
        text.strip_prefix("blinn-phong:")
            .and_then(|exponent| exponent.parse().ok())
            .filter(|shininess| (1.0..=1e5).contains(shininess))
            .map(|shininess| Self::BlinnPhong(BlinnPhong { shininess }))
            .ok_or_else(|| ParseBrdfError(text.to_owned()))
    }
}
