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

use glam::{DVec3, Vec2, Vec3};

use crate::brdf::{Brdf, Material};
use crate::normal_map::pyramid::Texel;

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
}

/// Light and view at a surface point, in the tangent space of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalLight {
    /// Unit vector towards the light.
    pub light_in_tangent: Vec3,
    /// Unit half vector between light and view.
    pub half_in_tangent: Vec3,
}

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

    /// Linear RGB reflected of the sky towards the eye, likewise.
    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3;

    /// Whether a long footprint is read by several probes; the truth alone covers it by its own samples.
    fn takes_probes(&self) -> bool {
        true
    }
}

/// `(Ks f(h) + Kd) max(cos, 0)` of one lobe or normal (Han et al. 2007, Algorithm 2), linear RGB; `specular` is f(h).
pub fn reflect(material: &Material, specular: Vec3, light_cosine: f32) -> Vec3 {
    (material.specular * specular * material.specular_color + material.diffuse * material.diffuse_color)
        * light_cosine.max(0.0)
}
