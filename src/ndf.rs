//! The normal distribution function of a texel: the base normals that its footprint overlaps, weighted by area.

use glam::DVec3;
use rayon::prelude::*;

use crate::brdf::Brdf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::{Footprint, Texel};

/// A texel's normals and their weights, read from the map on demand: a top level's footprint is the whole map.
#[derive(Clone, Copy, Debug)]
pub struct Ndf<'a> {
    map: &'a NormalMap,
    footprint: Footprint,
    /// Area of the valid base texels inside the footprint, in base texels.
    valid_area: f64,
    /// Base texels touched that are valid.
    valid: usize,
}

impl<'a> Ndf<'a> {
    /// The NDF of a texel that the map has.
    pub fn of_texel(map: &'a NormalMap, texel: Texel) -> Self {
        let size = map.level_sizes()[texel.level];
        let footprint = Footprint::new((map.width, map.height), size, (texel.x, texel.y));
        let (valid, valid_area) = rows(&footprint)
            .map(|y| row(map, &footprint, y).fold((0, 0.0), |(count, area), (_, weight)| (count + 1, area + weight)))
            .collect::<Vec<_>>()
            .into_iter()
            .fold((0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        Self { map, footprint, valid_area, valid }
    }

    /// Valid base texels that the footprint touches.
    pub fn len(&self) -> usize {
        self.valid
    }

    /// True where no base texel is valid and one flat normal stands in.
    pub fn is_empty(&self) -> bool {
        self.valid == 0
    }

    /// Unit normals in tangent space with their weights, which sum to 1. A footprint without a valid texel holds one
    /// flat normal.
    pub fn samples(&self) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        let flat = self.is_empty().then_some((DVec3::Z, 1.0));
        let rows = self.footprint.rows.start..self.footprint.rows.end;
        let valid = rows.flat_map(|y| row(self.map, &self.footprint, y));
        flat.into_iter().chain(valid.map(|(normal, area)| (normal, area / self.valid_area)))
    }

    /// `sum_q weight_q value(n_q)`, the rows in parallel and added in order.
    pub fn expectation(&self, value: impl Fn(DVec3) -> f64 + Sync) -> f64 {
        if self.is_empty() {
            return value(DVec3::Z);
        }
        let sums: Vec<f64> = rows(&self.footprint)
            .map(|y| row(self.map, &self.footprint, y).map(|(normal, area)| area * value(normal)).sum())
            .collect();
        sums.iter().sum::<f64>() / self.valid_area
    }

    /// `sum_q weight_q f(n_q . omega)`, the effective BRDF at `omega` (Han et al. 2007, eq. 4 and 10), per steradian.
    pub fn effective_brdf(&self, brdf: Brdf, omega: DVec3) -> f64 {
        self.expectation(|normal| brdf.zonal(normal.dot(omega)))
    }

    /// The mean normal, not normalised.
    pub fn mean(&self) -> DVec3 {
        self.samples().map(|(normal, weight)| weight * normal).sum()
    }
}

fn rows(footprint: &Footprint) -> impl IndexedParallelIterator<Item = usize> {
    (footprint.rows.start..footprint.rows.end).into_par_iter().with_min_len(16)
}

/// The valid normals of one base row inside the footprint, with their areas.
fn row<'a>(map: &'a NormalMap, footprint: &'a Footprint, y: usize) -> impl Iterator<Item = (DVec3, f64)> + 'a {
    (footprint.columns.start..footprint.columns.end)
        .filter_map(move |x| Some((map.precise_normal(y * map.width + x)?, f64::from(footprint.weight(x, y)))))
}
