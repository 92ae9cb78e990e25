//! The true effective BRDF of one texel, `sum_q weight_q f(n_q . w)` (Han et al. 2007, eq. 4 and 10), prepared for many
//! directions: the normals are gathered once and summed in vectors, in f32 within a block and in f64 across blocks.
//!
//! A coarse footprint stands as the cells of [`BinnedSamples`], 1.6 degrees across, where the BRDF is much wider than
//! they are. A cell's mean normal is shorter than 1 by what its normals spread, so it loses of the peak what the blur of
//! the spread takes; what remains differs in the second order of the cell's size over the BRDF's width.

use glam::{DVec3, Vec3};
use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::vmf::bins::{BinnedSamples, WORTHWHILE};
use super::vmf::lanes::{LANES, exp2_of_negative, halving_sum, lanes, ln_of_positive, mul_add};
use crate::brdf::Brdf;
use crate::ndf::Ndf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::{Footprint, Texel};

/// The sharpest Blinn-Phong for which cells stand for normals: six cells across to half its peak.
pub const SHARPEST_BINNED: f64 = 400.0;

/// Normals per sum in f32.
const BLOCK: usize = 1024;

/// The normals of one texel, or the cells that stand for them, and the BRDF.
#[derive(Clone, Debug)]
pub struct FootprintBrdf {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Sums to 1; padding has none.
    weight: Vec<f32>,
    brdf: Brdf,
}

impl FootprintBrdf {
    /// Gathers the normals of a texel that the map has.
    pub fn new(map: &NormalMap, texel: Texel, brdf: Brdf) -> Self {
        let size = map.level_size(texel.level);
        let footprint = Footprint::new((map.width, map.height), size, (texel.x, texel.y));
        if footprint.len() >= WORTHWHILE && brdf.exponent() <= SHARPEST_BINNED {
            let bins = BinnedSamples::new(map, &footprint);
            let cells = bins.slices();
            let total: f64 = cells.w.iter().map(|&w| f64::from(w)).sum();
            let cell = |i: usize| (Vec3::new(cells.x[i], cells.y[i], cells.z[i]), f64::from(cells.w[i]) / total);
            if total > 0.0 {
                return Self::of_samples((0..cells.x.len()).map(cell), brdf);
            }
        }
        Self::unbinned(map, texel, brdf)
    }

    /// That of every normal on its own, whatever their number.
    pub fn unbinned(map: &NormalMap, texel: Texel, brdf: Brdf) -> Self {
        let ndf = Ndf::of_texel(map, texel);
        Self::of_samples(ndf.samples().map(|(normal, weight)| (normal.as_vec3(), weight)), brdf)
    }

    fn of_samples(samples: impl Iterator<Item = (Vec3, f64)>, brdf: Brdf) -> Self {
        let mut own = Self { x: Vec::new(), y: Vec::new(), z: Vec::new(), weight: Vec::new(), brdf };
        samples.for_each(|(normal, weight)| own.push(normal, weight as f32));
        while !own.x.len().is_multiple_of(LANES) {
            own.push(Vec3::ZERO, 0.0);
        }
        own
    }

    fn push(&mut self, normal: Vec3, weight: f32) {
        self.x.push(normal.x);
        self.y.push(normal.y);
        self.z.push(normal.z);
        self.weight.push(weight);
    }

    /// The value in one direction, per steradian; relative error about 1e-7 times the exponent.
    pub fn at(&self, omega: DVec3) -> f64 {
        match self.brdf {
            Brdf::Lambert | Brdf::BlinnPhong(_) => self.brdf.zonal(1.0) * power_sum(self, omega.as_vec3()),
            _ => self
                .samples()
                .map(|(normal, weight)| f64::from(weight) * self.brdf.zonal(normal.as_dvec3().dot(omega)))
                .sum(),
        }
    }

    /// The exponent of the BRDF.
    pub fn exponent(&self) -> f64 {
        self.brdf.exponent()
    }

    /// The mean normal, not normalised.
    pub fn mean(&self) -> DVec3 {
        self.samples().map(|(normal, weight)| f64::from(weight) * normal.as_dvec3()).sum()
    }

    /// The largest angle between `axis` and a normal, radians.
    pub fn reach(&self, axis: DVec3) -> f64 {
        let axis = axis.as_vec3();
        let chord = |(normal, _): (Vec3, f32)| normal.distance_squared(axis);
        let farthest = self.samples().map(chord).fold(0.0, f32::max);
        2.0 * f64::from(0.5 * farthest.sqrt()).min(1.0).asin()
    }

    fn samples(&self) -> impl Iterator<Item = (Vec3, f32)> + '_ {
        let normal = |i: usize| (Vec3::new(self.x[i], self.y[i], self.z[i]), self.weight[i]);
        (0..self.x.len()).map(normal).filter(|(_, weight)| *weight > 0.0)
    }
}

/// `sum_q weight_q max(n_q . w, 0)^s`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn power_sum(of: &FootprintBrdf, omega: Vec3) -> f64 {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let exponent = of.exponent() as f32 * std::f32::consts::LOG2_E;
    let mut total = 0.0;
    for first in (0..of.x.len()).step_by(BLOCK) {
        let last = (first + BLOCK).min(of.x.len());
        let mut sums = [0.0_f32; LANES];
        for group in first / LANES..last / LANES {
            let [x, y, z] = [&of.x, &of.y, &of.z].map(|component| lanes(component, group));
            let weight = lanes(&of.weight, group);
            for i in 0..LANES {
                let cosine = mul_add::<FMA>(x[i], omega.x, mul_add::<FMA>(y[i], omega.y, z[i] * omega.z));
                // A cosine of 0 or less gives a logarithm so low that its exponential is nothing.
                let power = exp2_of_negative::<FMA>(exponent * ln_of_positive::<FMA>(cosine.clamp(1e-30, 1.0)));
                sums[i] = mul_add::<FMA>(weight[i], power, sums[i]);
            }
        }
        total += f64::from(halving_sum(sums));
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{BlinnPhong, Ggx};
    use crate::normal_map::procedural;
    use crate::sphere::direction::hemisphere;

    #[test]
    fn the_prepared_sum_is_the_sum() {
        let map = procedural::find("bricks").expect("bundled").make(60);
        let blinn_phong = |shininess| Brdf::BlinnPhong(BlinnPhong { shininess });
        let ggx = Brdf::Ggx(Ggx { alpha: 0.2 });
        for (level, brdf) in
            [(0, blinn_phong(64.0)), (2, blinn_phong(1.0)), (3, blinn_phong(400.0)), (5, blinn_phong(4000.0)), (3, ggx)]
        {
            let texel = Texel { level, x: 0, y: 0 };
            let prepared = FootprintBrdf::new(&map, texel, brdf);
            let ndf = Ndf::of_texel(&map, texel);
            let peak = brdf.zonal(1.0);
            for omega in hemisphere(300) {
                let (found, exact) = (prepared.at(omega), ndf.effective_brdf(brdf, omega));
                let most = 1e-6 * peak + 2e-7 * brdf.exponent() * exact;
                assert!((found - exact).abs() < most, "{brdf}: {found} {exact}");
            }
        }
    }
}
