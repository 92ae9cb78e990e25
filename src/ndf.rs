//! The normal distribution function of a texel: the base normals that its footprint overlaps, weighted by area.

use glam::DVec3;

use crate::brdf::Brdf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::{Footprint, Texel};

/// A texel's normals and their weights, which sum to 1. A footprint without a valid texel holds one flat normal.
#[derive(Clone, Debug, PartialEq)]
pub struct Ndf {
    /// Unit normal in tangent space and its weight.
    pub samples: Vec<(DVec3, f64)>,
    /// True where no base texel was valid and the flat normal stands in.
    pub stand_in: bool,
}

impl Ndf {
    /// Gathers the footprint of a texel that the map has.
    pub fn of_texel(map: &NormalMap, texel: Texel) -> Self {
        let size = map.level_sizes()[texel.level];
        let footprint = Footprint::new((map.width, map.height), size, (texel.x, texel.y));
        let mut samples: Vec<(DVec3, f64)> = footprint
            .texels()
            .filter_map(|(x, y, area)| Some((map.normal(y * map.width + x)?.as_dvec3(), f64::from(area))))
            .collect();
        let stand_in = samples.is_empty();
        if stand_in {
            samples.push((DVec3::Z, 1.0));
        }
        let total: f64 = samples.iter().map(|(_, area)| area).sum();
        samples.iter_mut().for_each(|(_, area)| *area /= total);
        Self { samples, stand_in }
    }

    /// `sum_q weight_q f(n_q . omega)`, the effective BRDF at `omega` (Han et al. 2007, eq. 4 and 10), per steradian.
    pub fn effective_brdf(&self, brdf: Brdf, omega: DVec3) -> f64 {
        self.samples.iter().map(|(normal, weight)| weight * brdf.zonal(normal.dot(omega))).sum()
    }

    /// Weighted mean of the natural log of `density` over the normals.
    pub fn mean_log(&self, density: impl Fn(DVec3) -> f64) -> f64 {
        self.samples.iter().map(|(normal, weight)| weight * density(*normal).ln()).sum()
    }

    /// The mean normal, not normalised.
    pub fn mean(&self) -> DVec3 {
        self.samples.iter().map(|(normal, weight)| *weight * *normal).sum()
    }
}
