//! The lobes' colours (Han et al. 2007, eq. 22): `y_j = sum_i w_i z_ij y_i / sum_i w_i z_ij` with the responsibilities
//! z of the finished fit, stored as `alpha_j y_j`, which interpolates like the lobe itself.
//!
//! Colour never enters the E-step, so this runs once, after the fit. The plain loop is enough for one visit.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::em::TexelLobes;
use super::kernel::KernelLobes;
use super::monitor::{Cancelled, Monitor};
use super::pyramid::{LobePyramid, MixtureLevel};
use crate::normal_map::NormalMap;
use crate::normal_map::albedo::Albedo;
use crate::normal_map::pyramid::Footprint;
use crate::sphere::mixture::MAX_LOBES;
use crate::sphere::vmf::KappaRule;

/// The lobes' colours of one level above the base, in the order of its [`MixtureLevel`].
#[derive(Clone, Debug, PartialEq)]
pub struct ColorLevel {
    /// `alpha_j y_j`, linear RGB: `stored[(y * width + x) * lobes + slot]`.
    pub stored: Vec<[f32; 3]>,
}

/// Base texels that one thread visits before others may help; sums over them are added in order.
const CHUNK: usize = 4096;

/// Colours the finished lobes of every level, finest first, where the map has a colour.
pub fn fit_levels(
    lobes: &mut LobePyramid,
    rule: KappaRule,
    monitor: &Monitor,
    report: &mut dyn FnMut(usize, &Arc<ColorLevel>),
) -> Result<(), Cancelled> {
    let Some(albedo) = lobes.map.albedo.clone() else { return Ok(()) };
    for level in 1..lobes.levels() {
        let colors = fit_level(lobes, level, &albedo, rule, monitor)?.map(Arc::new);
        if let Some(colors) = &colors {
            report(level, colors);
        }
        lobes.colors[level - 1] = colors;
    }
    Ok(())
}

/// Colours the lobes of one fitted level; `None` where the level is not fitted.
fn fit_level(
    lobes: &LobePyramid,
    level: usize,
    albedo: &Albedo,
    rule: KappaRule,
    monitor: &Monitor,
) -> Result<Option<ColorLevel>, Cancelled> {
    let Some(mixtures) = lobes.level(level) else { return Ok(None) };
    let job = Coloring { map: &lobes.map, albedo, mixtures, rule };
    let mut stored = vec![[0.0; 3]; mixtures.stored.len()];
    stored.par_chunks_mut(mixtures.lobes).enumerate().try_for_each(|(index, target)| {
        monitor.check()?;
        let visits = job.run((index % mixtures.width, index / mixtures.width), target);
        monitor.visited(level, visits);
        Ok(())
    })?;
    Ok(Some(ColorLevel { stored }))
}

/// Colouring one level.
struct Coloring<'a> {
    map: &'a NormalMap,
    albedo: &'a Albedo,
    mixtures: &'a MixtureLevel,
    rule: KappaRule,
}

/// `sum_i w_i z_ij` and `sum_i w_i z_ij y_i` per slot, and the colour of all texels together.
#[derive(Clone, Copy)]
struct Sums {
    weight: [f64; MAX_LOBES],
    color: [DVec3; MAX_LOBES],
    all: (f64, DVec3),
}

impl Sums {
    const ZERO: Self = Self { weight: [0.0; MAX_LOBES], color: [DVec3::ZERO; MAX_LOBES], all: (0.0, DVec3::ZERO) };

    fn plus(mut self, other: &Self) -> Self {
        for j in 0..MAX_LOBES {
            self.weight[j] += other.weight[j];
            self.color[j] += other.color[j];
        }
        self.all = (self.all.0 + other.all.0, self.all.1 + other.all.1);
        self
    }
}

impl Coloring<'_> {
    /// Colours one texel's lobes; returns the base texels visited.
    fn run(&self, texel: (usize, usize), target: &mut [[f32; 3]]) -> u64 {
        let level = (self.mixtures.width, self.mixtures.height);
        let footprint = Footprint::new((self.map.width, self.map.height), level, texel);
        let stored = self.mixtures.texel(texel.0, texel.1);
        let sums = self.sums(&footprint, &TexelLobes::from_stored(stored).for_e_step(self.rule));
        let mean = sums.all.1 / sums.all.0;
        for (j, (color, lobe)) in target.iter_mut().zip(stored).enumerate() {
            // A lobe that no normal answers to, as the flat one of a footprint without any, takes the mean.
            let y = if sums.weight[j] > 0.0 { sums.color[j] / sums.weight[j] } else { mean };
            *color = (f64::from(lobe[0]) * y).as_vec3().to_array();
        }
        footprint.len() as u64
    }

    /// The sums over a footprint, large ones in parallel by whole rows.
    fn sums(&self, footprint: &Footprint, lobes: &KernelLobes) -> Sums {
        let rows = footprint.rows.start..footprint.rows.end;
        let row = |sums: &mut Sums, y| self.add_row(footprint, lobes, y, sums);
        if footprint.len() <= CHUNK {
            let mut sums = Sums::ZERO;
            rows.for_each(|y| row(&mut sums, y));
            return sums;
        }
        let rows_per_chunk = (CHUNK / footprint.columns.len()).max(1);
        let chunk = |first: usize| {
            let mut sums = Sums::ZERO;
            (first..(first + rows_per_chunk).min(rows.end)).for_each(|y| row(&mut sums, y));
            sums
        };
        let starts: Vec<usize> = rows.clone().step_by(rows_per_chunk).collect();
        let chunks: Vec<Sums> = starts.into_par_iter().map(chunk).collect();
        chunks.iter().fold(Sums::ZERO, Sums::plus)
    }

    fn add_row(&self, footprint: &Footprint, lobes: &KernelLobes, y: usize, sums: &mut Sums) {
        let mut z = [0.0; MAX_LOBES];
        for x in footprint.columns.start..footprint.columns.end {
            let index = y * self.map.width + x;
            let weight = f64::from(footprint.weight(x, y));
            let color = Vec3::from(self.albedo.rgb[index]).as_dvec3();
            sums.all.0 += weight;
            sums.all.1 += weight * color;
            let Some(normal) = self.map.normal(index) else { continue };
            responsibilities(lobes, normal, &mut z);
            for (j, &z) in z.iter().enumerate().take(lobes.count) {
                sums.weight[j] += weight * f64::from(z);
                sums.color[j] += weight * f64::from(z) * color;
            }
        }
    }
}

/// `z_j = alpha_j v_j(n) / sum_k alpha_k v_k(n)`, the largest exponent taken out first.
fn responsibilities(lobes: &KernelLobes, normal: Vec3, z: &mut [f32; MAX_LOBES]) {
    let mut most = f32::NEG_INFINITY;
    for (j, z) in z.iter_mut().enumerate().take(lobes.count) {
        *z = lobes.log_scale[j] + lobes.neg_half_kappa[j] * normal.distance_squared(Vec3::from(lobes.mu[j]));
        most = most.max(*z);
    }
    let mut total = 0.0;
    for z in z.iter_mut().take(lobes.count) {
        *z = (*z - most).exp();
        total += *z;
    }
    z.iter_mut().take(lobes.count).for_each(|z| *z /= total);
}
