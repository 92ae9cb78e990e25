//! Ways of filtering a normal map, all behind one trait.
//!
//! Every method estimates the same thing, the effective BRDF of a texel (Han et al. 2007, eq. 4 and 10),
//! `rho_eff(w) = sum_q weight_q f(n_q . w)`, and shades a surface point with it.

pub mod brdf_error;
pub mod brdf_shape;
pub mod channels;
pub mod footprint_brdf;
pub mod gmm;
pub mod harmonics;
pub mod lean;
pub mod method;
pub mod pixel_footprint;
pub mod plain_mip;
pub mod probes;
pub mod rival;
pub mod sampling;
pub mod sky_light;
pub mod toksvig;
pub mod truth;
pub mod vmf;
pub mod worst_texels;

use glam::{DVec3, Mat3, Vec2, Vec3};

use crate::brdf::{Brdf, Material};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::scene::reconstruction::turned;

pub use method::{Method, MethodChoice, ParseMethodError};
pub use pixel_footprint::PixelFootprint;
pub use plain_mip::PlainMip;
pub use probes::{LevelChoice, LevelRule, Probes};
pub use rival::{Rival, RivalFilter};
pub use sky_light::{LocalSky, NdfLobe};
pub use truth::Truth;
pub use vmf::{UnalignedVmf, VmfFilter};

/// One look at the map: where, how much of it the pixel covers, and at which level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// Texture coordinates: `u` right, `v` down, one unit per map.
    pub uv: Vec2,
    /// How `uv` runs over the pixel.
    pub footprint: PixelFootprint,
    /// Level of detail, already clamped to the levels there are.
    pub lod: f32,
    /// Integer pixel coordinates, which seed the truth's jitter.
    pub pixel: [u32; 2],
    /// Takes the map's normals to tangent space, up to their length; the identity but for frames that are not
    /// orthonormal.
    pub tangent_from_map: Mat3,
}

impl Lookup {
    /// A normal of the map in tangent space, of its own length.
    pub fn turned(&self, normal: Vec3) -> Vec3 {
        turned(self.tangent_from_map, normal)
    }
}

/// Light and view at a surface point, in the tangent space of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalLight {
    /// Unit vector towards the light.
    pub light_in_tangent: Vec3,
    /// Unit half vector between light and view.
    pub half_in_tangent: Vec3,
}

impl LocalLight {
    /// Light and half vector turned as the shortest way takes the mean normal in tangent space back to where it is in the
    /// map: what is kept about that mean is lit as if it had turned along.
    pub fn as_seen_from(self, lookup: &Lookup, mean: Vec3) -> Self {
        let (from, to) = (lookup.turned(mean).normalize_or_zero(), mean.normalize_or_zero());
        let (axis, cosine) = (from.cross(to), from.dot(to));
        if from == to || cosine < LEAST_TURN {
            return self;
        }
        let back = |v: Vec3| {
            let moved = axis.cross(v);
            v + moved + axis.cross(moved) / (1.0 + cosine)
        };
        Self { light_in_tangent: back(self.light_in_tangent), half_in_tangent: back(self.half_in_tangent) }
    }
}

/// No normal is turned as far as this cosine; there is no shortest way half round.
const LEAST_TURN: f32 = -0.9;

/// One texel's effective BRDF as a function of the direction, per steradian.
pub type EffectiveBrdf<'a> = Box<dyn Fn(DVec3) -> f64 + Send + Sync + 'a>;

/// One way of filtering, built from a pyramid.
pub trait Filter: Send + Sync {
    /// The method's estimate of `sum_q weight_q f(n_q . omega)` of one texel as a function of omega: what no direction
    /// changes is worked out once.
    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_>;

    /// That in one direction.
    fn effective_brdf(&self, texel: Texel, brdf: Brdf, omega: DVec3) -> f64 {
        self.effective_brdf_of(texel, brdf)(omega)
    }

    /// Linear RGB reflected towards the eye for light of radiance 1 by the material as it is towards that light
    /// ([`Material::towards`]): the CPU twin of the method's shader.
    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3;

    /// Linear RGB reflected of the sky towards the eye, likewise; of a sun that is a light of its own
    /// ([`Sky::sunlight`](crate::lighting::Sky::sunlight)) the diffuse part alone, but for the truth.
    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3;

    /// The map that is filtered.
    fn map(&self) -> &NormalMap;

    /// The mean normal at a lookup, not normalised, where all that the method keeps is lit about it; `None` where it
    /// turns its normals itself ([`Lookup::turned`]).
    fn mean_normal(&self, _lookup: &Lookup) -> Option<Vec3> {
        None
    }

    /// Whether it covers the footprint and the sky by samples of its own: it takes no probes, and meets the sun among
    /// the sky's samples.
    fn is_truth(&self) -> bool {
        false
    }
}

/// `(Ks f(h) + Kd) max(cos, 0)` of one lobe or normal (Han et al. 2007, Algorithm 2), linear RGB; `specular` is f(h).
pub fn reflect(material: &Material, specular: Vec3, light_cosine: f32) -> Vec3 {
    (material.specular * specular * material.specular_color + material.diffuse * material.diffuse_color)
        * light_cosine.max(0.0)
}
