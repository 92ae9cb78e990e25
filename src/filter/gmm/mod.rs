//! Mixtures of planar Gaussians over the normals' `(n_x, n_y)`.
//!
//! P. Tan, S. Lin, L. Quan, B. Guo and H.-Y. Shum, *Multiresolution reflectance filtering*, EGSR 2005: four isotropic
//! Gaussians a texel, aligned over the pyramid so that hardware may interpolate them, with two misprints put right
//! (see [`gaussian`] and [`em`]). The material is a Gaussian of variance `1/s`, s its equivalent exponent, over
//! `(h_x, h_y)` that adds to each; half
//! vectors below the horizon reflect nothing. A Gaussian's cosine is that of the normal above its mean.
//!
//! The plane takes steep normals for close ones, and those below the horizon for their mirror images.

pub mod em;
pub mod fit;
pub mod gaussian;

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::channels::ChannelPyramid;
use super::rival::{Built, Parameter, Rival, RivalFilter, RivalKind, Source};
use super::vmf::{Cancelled, Monitor};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe, PlainMip};
use crate::brdf::{Brdf, Material};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::sphere::vmf::KAPPA_DELTA;

pub use em::PlanarMixture;
pub use gaussian::{MAX_GAUSSIANS, PlanarGaussian};

/// `gmm:N`.
pub static KIND: RivalKind = RivalKind {
    name: "gmm",
    label: "GMM N =",
    parameter: Some(Parameter {
        symbol: "N",
        range: [1, MAX_GAUSSIANS as u8],
        most_drawn: MAX_GAUSSIANS as u8,
        default: 4,
        offered: &[4],
    }),
    has_channels: true,
    shader: include_str!("../../../shaders/methods/gmm.wgsl"),
    build,
};

/// Planar Gaussians of every texel.
#[derive(Clone, Debug)]
pub struct Gmm {
    mip: Arc<PlainMip>,
    /// A layer per Gaussian, as [`PlanarGaussian::to_stored`] has it.
    gaussians: Arc<ChannelPyramid>,
}

fn build(source: &Source<'_>, rival: Rival) -> Built {
    let count = usize::from(rival.parameter).clamp(1, MAX_GAUSSIANS);
    let gaussians = fit::fit(&source.mip.map, count, source.monitor)?;
    Ok(Arc::new(Gmm { mip: Arc::clone(source.mip), gaussians: Arc::new(gaussians) }))
}

impl Gmm {
    /// The Gaussians of one texel; a flat one for a base texel that is invalid.
    pub fn mixture(&self, texel: Texel) -> PlanarMixture {
        let map = &self.mip.map;
        let (count, first) = (self.gaussians.layers, self.gaussians.first_level);
        if texel.level == 0 {
            let mut mixture = PlanarMixture::flat(count);
            mixture.gaussians[0] =
                fit::of_base_texel(map, texel.y * map.width + texel.x).unwrap_or(mixture.gaussians[0]);
            return mixture;
        }
        let stored = |level: usize| {
            let (from, to) = (self.gaussians.grid(texel.level), self.gaussians.grid(level));
            let column = (2 * texel.x + 1) * to.width / (2 * from.width);
            let row = (2 * texel.y + 1) * to.height / (2 * from.height);
            self.gaussians.texel(level, row * to.width + column)
        };
        if texel.level < first {
            return fit::of_texel(map, texel, stored(first));
        }
        PlanarMixture::from_stored(stored(texel.level))
    }
}

/// `sum_i alpha_i f_i(omega)`, per steradian.
pub fn effective_brdf(mixture: &[PlanarGaussian], brdf: Brdf, omega: DVec3) -> f64 {
    let of_gaussian = |gaussian: &PlanarGaussian| match brdf {
        Brdf::Lambert => gaussian.weight * brdf.zonal(gaussian.normal().dot(omega)),
        _ => gaussian.weight * gaussian.density(1.0 / brdf.exponent(), omega),
    };
    mixture.iter().filter(|gaussian| gaussian.weight > 0.0).map(of_gaussian).sum()
}

impl RivalFilter for Gmm {
    fn channels(&self, _: &Monitor) -> Result<Option<&Arc<ChannelPyramid>>, Cancelled> {
        Ok(Some(&self.gaussians))
    }
}

impl Filter for Gmm {
    fn map(&self) -> &NormalMap {
        &self.mip.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let mixture = self.mixture(texel);
        Box::new(move |omega| effective_brdf(&mixture.gaussians, brdf, omega))
    }

    fn mean_normal(&self, lookup: &Lookup) -> Option<Vec3> {
        Some(self.mip.mean(lookup))
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let taps = self.gaussians.taps(lookup);
        let variance = 1.0 / f64::from(material.exponent());
        let (mut specular, mut diffuse) = (0.0, 0.0);
        for layer in 0..self.gaussians.layers {
            let stored = self.gaussians.blend(&taps, layer).to_array();
            let Some(gaussian) = PlanarGaussian::from_stored(stored) else { continue };
            let cosine = gaussian.weight * gaussian.normal().dot(light.light_in_tangent.as_dvec3()).max(0.0);
            specular += cosine * gaussian.density(variance, light.half_in_tangent.as_dvec3());
            diffuse += cosine;
        }
        self.mip.color(lookup)
            * (material.specular * specular as f32 * material.specular_color
                + material.diffuse * diffuse as f32 * material.diffuse_color)
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let taps = self.gaussians.taps(lookup);
        let stored = (0..self.gaussians.layers).map(|layer| self.gaussians.blend(&taps, layer).to_array());
        let lobe = |gaussian: PlanarGaussian| NdfLobe {
            weight: gaussian.weight as f32,
            mean_direction: gaussian.normal().as_vec3(),
            concentration: 1.0 / gaussian.variance.max(1.0 / KAPPA_DELTA),
        };
        let lobes = stored.filter_map(PlanarGaussian::from_stored).map(lobe);
        self.mip.color(lookup) * lobes.map(|lobe| sky.shade(&lobe)).sum::<Vec3>()
    }
}
