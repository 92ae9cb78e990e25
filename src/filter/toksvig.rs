//! Toksvig's factor: the shorter the mean normal, the wider the highlight.
//!
//! M. Toksvig, *Mipmapping normal maps*, 2004. With the mean normal `N`, not normalised, and the exponent s,
//! `f = |N| / (|N| + s (1 - |N|))`; the exponent becomes `f s` and an unnormalised Blinn-Phong lobe is scaled by
//! `(1 + f s)/(1 + s)`, which is to say that the normalised lobe of exponent `f s` is taken. The diffuse part is that
//! of the normalised mean normal. Other models are taken for Blinn-Phong of their equivalent exponent. Isotropic, and blind to what makes `N` short: two facets or one rough one.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::rival::{Built, Rival, RivalFilter, RivalKind, Source};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe, PlainMip, reflect};
use crate::brdf::blinn_phong::blinn_phong;
use crate::brdf::{BlinnPhong, Brdf, Material};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::sphere::vmf::KAPPA_DELTA;

/// `toksvig`.
pub static KIND: RivalKind = RivalKind {
    name: "toksvig",
    label: "Toksvig",
    parameter: None,
    has_channels: false,
    shader: include_str!("../../shaders/methods/toksvig.wgsl"),
    build,
};

fn build(source: &Source<'_>, _: Rival) -> Built {
    Ok(Arc::new(Toksvig { mip: Arc::clone(source.mip) }))
}

/// Toksvig's factor on the mean normals.
#[derive(Clone, Debug)]
pub struct Toksvig {
    /// The mean normals.
    pub mip: Arc<PlainMip>,
}

/// `f s`: the exponent that Blinn-Phong of exponent s takes over a mean normal of this length.
pub fn widened_exponent(length: f32, exponent: f32) -> f32 {
    let length = length.min(1.0);
    exponent * length / (length + exponent * (1.0 - length))
}

impl RivalFilter for Toksvig {}

impl Filter for Toksvig {
    fn map(&self) -> &NormalMap {
        &self.mip.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let mean = self.mip.of_texel(texel).as_dvec3();
        let normal = mean.try_normalize().unwrap_or(DVec3::Z);
        let widened = if brdf == Brdf::Lambert {
            brdf
        } else {
            let (length, shininess) = (mean.length().min(1.0), brdf.exponent());
            Brdf::BlinnPhong(BlinnPhong { shininess: shininess * length / (length + shininess * (1.0 - length)) })
        };
        Box::new(move |omega| widened.zonal(normal.dot(omega)))
    }

    fn mean_normal(&self, lookup: &Lookup) -> Option<Vec3> {
        Some(self.mip.mean(lookup))
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let mean = self.mip.mean(lookup);
        let normal = mean.normalize_or_zero();
        let exponent = widened_exponent(mean.length(), material.exponent());
        let specular = blinn_phong(exponent, normal.dot(light.half_in_tangent));
        self.mip.color(lookup) * reflect(material, Vec3::splat(specular), normal.dot(light.light_in_tangent))
    }

    /// Toksvig's exponent `f s = kappa s / (kappa + s)` is that of a lobe of `kappa = |N| / (1 - |N|)`.
    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let mean = self.mip.mean(lookup);
        let length = f64::from(mean.length());
        let concentration = length / (1.0 - length).max(1.0 / KAPPA_DELTA);
        let normal = NdfLobe::normal(mean.normalize_or_zero());
        self.mip.color(lookup) * sky.shade(&NdfLobe { concentration, ..normal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_length_leaves_the_exponent_alone_and_a_zero_one_levels_it() {
        assert_eq!(widened_exponent(1.0, 64.0), 64.0);
        assert_eq!(widened_exponent(0.0, 64.0), 0.0);
    }

    #[test]
    fn the_widened_exponent_is_that_of_added_variances() {
        // The factor comes of a Gaussian's |N| = 1/(1 + sigma^2), whose variance adds to the lobe's 1/s.
        for (variance, exponent) in [(0.01_f32, 64.0_f32), (0.3, 10.0)] {
            let expected = 1.0 / (1.0 / exponent + variance);
            let found = widened_exponent(1.0 / (1.0 + variance), exponent);
            assert!((found / expected - 1.0).abs() < 1e-5, "{found} against {expected}");
        }
    }
}
