//! Ways of filtering a normal map, all behind one trait.
//!
//! Every method estimates the same thing, the effective BRDF of a texel (Han et al. 2007, eq. 4 and 10),
//! `rho_eff(w) = sum_q weight_q f(n_q . w)`, and shades a surface point with it.

pub mod plain_mip;
pub mod sampling;
pub mod truth;
pub mod vmf;

use std::str::FromStr;

use glam::{DVec3, Vec2, Vec3};

use crate::brdf::{Brdf, Material};
use crate::normal_map::pyramid::Texel;

pub use plain_mip::PlainMip;
pub use truth::Truth;
pub use vmf::{UnalignedVmf, VmfFilter};

/// A filtering method by name, as the command line and the session file write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// `truth`: supersampling of the unfiltered map.
    Truth,
    /// `mip`: the averaged normal, normalised.
    Mip,
    /// `vmf`: aligned von Mises-Fisher lobes, as many as were fitted.
    #[default]
    Vmf,
    /// `vmf:unaligned`: the same lobes, each texel around shaded on its own and the results blended.
    VmfUnaligned,
}

impl Method {
    /// Every method, in the order they are offered.
    pub const ALL: [Self; 4] = [Self::Truth, Self::Mip, Self::Vmf, Self::VmfUnaligned];

    /// The name, without parameters.
    pub fn name(self) -> &'static str {
        match self {
            Self::Truth => "truth",
            Self::Mip => "mip",
            Self::Vmf => "vmf",
            Self::VmfUnaligned => "vmf:unaligned",
        }
    }

    /// True for the methods that show fitted lobes.
    pub fn shows_lobes(self) -> bool {
        matches!(self, Self::Vmf | Self::VmfUnaligned)
    }
}

/// A pixel's view of the map: where it looks and how much of it it covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// Texture coordinates at the pixel's centre: `u` right, `v` down, one unit per map.
    pub uv: Vec2,
    /// Change of `uv` over one pixel to the right.
    pub uv_dx: Vec2,
    /// Change of `uv` over one pixel down.
    pub uv_dy: Vec2,
    /// Level of detail, already clamped to the levels there are.
    pub lod: f32,
    /// Integer pixel coordinates, which seed the truth's jitter.
    pub pixel: [u32; 2],
}

/// Light and view at a surface point, in the tangent space of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalLight {
    /// Unit vector towards the light.
    pub light_in_tangent: Vec3,
    /// Unit half vector between light and view.
    pub half_in_tangent: Vec3,
}

/// One way of filtering, built from a pyramid.
pub trait Filter: Sync {
    /// Estimates `sum_q weight_q f(n_q . omega)` of one texel, per steradian.
    fn effective_brdf(&self, texel: Texel, brdf: Brdf, omega: DVec3) -> f64;

    /// Linear RGB reflected towards the eye for light of radiance 1: the CPU twin of the method's shader.
    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3;
}

/// `(Ks f(h) + Kd) max(cos, 0)` of one lobe or normal (Han et al. 2007, Algorithm 2), linear RGB.
pub fn reflect(material: &Material, exponent: f32, half_cosine: f32, light_cosine: f32) -> Vec3 {
    let half_cosine = half_cosine.max(0.0);
    // pow(0, 0) differs between processors; a cosine of 0 contributes only where the exponent is 0.
    let power = if half_cosine > 0.0 { (exponent * half_cosine.ln()).exp() } else { f32::from(exponent == 0.0) };
    let specular = material.specular * (exponent + 1.0) / std::f32::consts::TAU * power;
    (specular * material.specular_color + material.diffuse * material.diffuse_color) * light_cosine.max(0.0)
}

impl std::fmt::Display for Method {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A method with the lobe count that it asks for, as `METHOD` on the command line: `truth`, `mip`, `vmf[:J]`
/// or `vmf[:J]:unaligned`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodChoice {
    /// The method.
    pub method: Method,
    /// Lobes J, where the method names them.
    pub lobes: Option<usize>,
}

/// Why a method's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a method: write truth, mip, vmf:J or vmf:J:unaligned with J from 1 to 16")]
pub struct ParseMethodError(String);

impl FromStr for MethodChoice {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Method::ALL.into_iter().find(|method| method.name() == text);
        let plain = named.map(|method| Self { method, lobes: None });
        let counted = || {
            let (count, method) = match text.strip_suffix(":unaligned") {
                Some(count) => (count, Method::VmfUnaligned),
                None => (text, Method::Vmf),
            };
            let lobes = count.strip_prefix("vmf:")?.parse().ok()?;
            (1..=crate::sphere::mixture::MAX_LOBES).contains(&lobes).then_some(Self { method, lobes: Some(lobes) })
        };
        plain.or_else(counted).ok_or_else(|| ParseMethodError(text.to_owned()))
    }
}

impl std::fmt::Display for MethodChoice {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.lobes, self.method) {
            (Some(lobes), Method::VmfUnaligned) => write!(formatter, "vmf:{lobes}:unaligned"),
            (Some(lobes), method) => write!(formatter, "{method}:{lobes}"),
            (None, method) => write!(formatter, "{method}"),
        }
    }
}
