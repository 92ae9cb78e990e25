//! LEAN mapping: one anisotropic Gaussian over slopes.
//!
//! M. Olano and D. Baker, *LEAN mapping*, I3D 2010. A normal is the slope `b = (n_x / n_z, n_y / n_z)`; the mean slope
//! `m` and the second moments `E[b b^T]` average linearly, `C = E[b b^T] - m m^T`, and a Blinn-Phong exponent s, of
//! other models the equivalent one, is a Gaussian of variance `1/s` that adds to it. The half vector's slope `b_h = (h_x / h_z, h_y / h_z)` is distributed
//! as `exp(-(b_h - m)^T (C + I/s)^-1 (b_h - m) / 2) / (2 pi sqrt(det(C + I/s)))`, a Beckmann lobe; over `h_z^3` it is a
//! density per solid angle. The diffuse part is that of the mean slope's normal.
//!
//! Slopes have no bound at the horizon: normals are read with `n_z` at least [`LEAST_NORMAL_Z`], and half vectors below
//! [`LEAST_HALF_Z`] reflect nothing. Where one Gaussian is too few the lobe lies between the facets.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3, Vec4};

use super::channels::ChannelPyramid;
use super::rival::{Built, Rival, RivalFilter, RivalKind, Source};
use super::vmf::{Cancelled, Monitor};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe, PlainMip, reflect};
use crate::brdf::{Brdf, Material};
use crate::ndf::Ndf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::sphere::vmf::KAPPA_DELTA;

/// `lean`.
pub static KIND: RivalKind = RivalKind {
    name: "lean",
    label: "LEAN",
    parameter: None,
    has_channels: true,
    shader: include_str!("../../shaders/methods/lean.wgsl"),
    build,
};

/// The least `n_z` that a slope is taken of: 87 degrees, a slope of 20.
pub const LEAST_NORMAL_Z: f64 = 0.05;
/// The least `h_z` that reflects: 89 degrees.
pub const LEAST_HALF_Z: f64 = 0.02;

/// Mean slopes and their second moments: `(m_x, m_y, E[b_x^2], E[b_y^2])`, then `E[b_x b_y]`.
pub const CHANNELS: usize = 5;

/// LEAN mapping.
#[derive(Clone, Debug)]
pub struct Lean {
    mip: Arc<PlainMip>,
    moments: Arc<ChannelPyramid>,
}

fn build(source: &Source<'_>, _: Rival) -> Built {
    let moments = ChannelPyramid::average(&source.mip.map, false, CHANNELS, &encode, source.monitor)?;
    Ok(Arc::new(Lean { mip: Arc::clone(source.mip), moments: Arc::new(moments) }))
}

/// The moments of one normal.
pub fn encode(normal: Vec3, channels: &mut [f64]) {
    let slope = slope(normal.as_dvec3());
    channels.copy_from_slice(&[slope.x, slope.y, slope.x * slope.x, slope.y * slope.y, slope.x * slope.y]);
}

fn slope(normal: DVec3) -> DVec2 {
    normal.truncate() / normal.z.max(LEAST_NORMAL_Z)
}

/// A Gaussian over slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SlopeGaussian {
    mean: DVec2,
    /// Variances along x and y.
    variance: DVec2,
    covariance: f64,
}

impl SlopeGaussian {
    /// Reads the stored moments.
    fn from_moments(first: Vec4, second: Vec4) -> Self {
        let (mean, squares) = (first.truncate().truncate().as_dvec2(), DVec2::new(first.z.into(), first.w.into()));
        // Stored moments round: a variance may come out below 0.
        let variance = (squares - mean * mean).max(DVec2::ZERO);
        Self { mean, variance, covariance: f64::from(second.x) - mean.x * mean.y }
    }

    /// The slopes of an NDF.
    fn of_ndf(ndf: &Ndf<'_>) -> Self {
        let (mut mean, mut squares, mut product) = (DVec2::ZERO, DVec2::ZERO, 0.0);
        for (normal, weight) in ndf.samples() {
            let slope = slope(normal);
            mean += weight * slope;
            squares += weight * slope * slope;
            product += weight * slope.x * slope.y;
        }
        Self { mean, variance: (squares - mean * mean).max(DVec2::ZERO), covariance: product - mean.x * mean.y }
    }

    /// The density of half vectors, per steradian, for Blinn-Phong of exponent s.
    fn density(&self, exponent: f64, half: DVec3) -> f64 {
        if half.z <= LEAST_HALF_Z {
            return 0.0;
        }
        let own = 1.0 / exponent;
        let variance = self.variance + own;
        // At least what the material alone gives, whatever rounding did to the covariance.
        let determinant = (variance.x * variance.y - self.covariance * self.covariance).max(own * own);
        let d = half.truncate() / half.z - self.mean;
        let squared =
            (variance.y * d.x * d.x - 2.0 * self.covariance * d.x * d.y + variance.x * d.y * d.y) / determinant;
        (-0.5 * squared.max(0.0)).exp() / (TAU * determinant.sqrt()) / half.z.powi(3)
    }

    /// The normal whose slope is the mean slope.
    fn normal(&self) -> DVec3 {
        self.mean.extend(1.0).normalize()
    }
}

impl RivalFilter for Lean {
    fn channels(&self, _: &Monitor) -> Result<Option<&Arc<ChannelPyramid>>, Cancelled> {
        Ok(Some(&self.moments))
    }
}

impl Filter for Lean {
    fn map(&self) -> &NormalMap {
        &self.mip.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let slopes = SlopeGaussian::of_ndf(&Ndf::of_texel(&self.mip.map, texel));
        Box::new(move |omega| match brdf {
            Brdf::Lambert => brdf.zonal(slopes.normal().dot(omega)),
            _ => slopes.density(brdf.exponent(), omega),
        })
    }

    fn mean_normal(&self, lookup: &Lookup) -> Option<Vec3> {
        Some(self.mip.mean(lookup))
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let taps = self.moments.taps(lookup);
        let slopes = SlopeGaussian::from_moments(self.moments.blend(&taps, 0), self.moments.blend(&taps, 1));
        let specular = slopes.density(material.exponent().into(), light.half_in_tangent.as_dvec3()) as f32;
        let cosine = slopes.normal().as_vec3().dot(light.light_in_tangent);
        self.mip.color(lookup) * reflect(material, Vec3::splat(specular), cosine)
    }

    /// One isotropic lobe stands for the Gaussian: as wide as its two variances are on the mean.
    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let taps = self.moments.taps(lookup);
        let slopes = SlopeGaussian::from_moments(self.moments.blend(&taps, 0), self.moments.blend(&taps, 1));
        let concentration = 1.0 / (0.5 * slopes.variance.element_sum()).max(1.0 / KAPPA_DELTA);
        let normal = NdfLobe::normal(slopes.normal().as_vec3());
        self.mip.color(lookup) * sky.shade(&NdfLobe { concentration, ..normal })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction::hemisphere;

    fn gaussian(slopes: &[DVec2]) -> SlopeGaussian {
        let mut sum = [0.0; CHANNELS];
        for slope in slopes {
            let mut one = [0.0; CHANNELS];
            encode(slope.extend(1.0).normalize().as_vec3(), &mut one);
            sum.iter_mut().zip(one).for_each(|(sum, one)| *sum += one / slopes.len() as f64);
        }
        let stored = sum.map(|value| value as f32);
        SlopeGaussian::from_moments(Vec4::from_slice(&stored), Vec4::new(stored[4], 0.0, 0.0, 0.0))
    }

    #[test]
    fn two_facets_of_opposite_slopes_are_a_gaussian_of_that_variance() {
        let found = gaussian(&[DVec2::new(0.3, 0.6), DVec2::new(-0.3, -0.6)]);
        assert!(found.mean.length() < 1e-6);
        assert!((found.variance - DVec2::new(0.09, 0.36)).length() < 1e-6 && (found.covariance - 0.18).abs() < 1e-6);
    }

    #[test]
    fn the_density_per_slope_integrates_to_one() {
        // Over solid angle: the density times h_z is a flow of half vectors through the slope plane, and h_z^3 the
        // Jacobian; without h_z it is the slopes' own, which integrates to 1.
        let rough = gaussian(&[DVec2::new(0.2, 0.1), DVec2::new(-0.1, 0.3), DVec2::new(0.05, -0.2)]);
        let count = 200_000;
        let sum: f64 = hemisphere(count).map(|half| rough.density(40.0, half)).sum();
        assert!((sum * TAU / count as f64 - 1.0).abs() < 1e-3, "{sum}");
    }

    #[test]
    fn a_flat_footprint_has_the_materials_own_width() {
        let flat = gaussian(&[DVec2::ZERO; 3]);
        let peak = flat.density(64.0, DVec3::Z);
        assert!((peak - 64.0 / TAU).abs() < 1e-9, "{peak}");
    }
}
