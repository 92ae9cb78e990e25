//! What alignment is worth: how far lobe j leans from its neighbours' lobe j, and how wrong interpolated lobes are.
//!
//! A small angle alone is no success: a strong pull has the smallest and the worst error. The error compares, half way
//! between texel centres, the BRDF of the blended lobes with the same blend of the texels' true effective BRDFs
//! (Han et al. 2007, eq. 4): relative L2 error over the hemisphere, mean over points.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::pyramid::{LobePyramid, MixtureLevel};
use super::smooth::neighbour;
use crate::brdf::{BlinnPhong, Brdf, ConvolutionRule};
use crate::filter::brdf_error::RelativeL2;
use crate::filter::sampling::Grid;
use crate::ndf::Ndf;
use crate::normal_map::pyramid::Texel;
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::mixture::EMPTY_WEIGHT;
use crate::sphere::{Mixture, StoredLobe, direction};

/// The Blinn-Phong exponent of the error.
pub const SHININESS: f64 = 64.0;

/// Directions over the hemisphere; a lobe of s = 64 spans several.
const DIRECTIONS: usize = 128;

/// Most points that a level is asked at.
const POINTS: usize = 64;

/// About the most normals that a level's truth reads: larger footprints are asked at fewer points, then read in strides.
const NORMALS: usize = 1 << 20;

/// Least points that a level is asked at.
const LEAST_POINTS: usize = 4;

/// Figures of one level's alignment.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Coherence {
    /// Mean angle between lobe j and its neighbours' lobe j, weighted by alpha, degrees.
    pub coherence_deg: f64,
    /// Relative error of the blended lobes half way between four texel centres.
    pub interpolation_error: f64,
    /// The same half way to the next coarser level; none at the top.
    pub trilinear_error: Option<f64>,
}

/// The figures of a level above the base, if it is fitted.
pub fn measure(lobes: &LobePyramid, level: usize) -> Option<Coherence> {
    let mixtures = lobes.level(level)?;
    let error = |between| Interpolation::new(&lobes.map, level, between).error(lobes, Blend::Lobes);
    Some(Coherence {
        coherence_deg: coherence_deg(mixtures, lobes.map.options.addressing),
        interpolation_error: error(Between::Texels),
        trilinear_error: lobes.level(level + 1).map(|_| error(Between::Levels)),
    })
}

/// Mean angle between lobe j and the lobe j to its right and below, weighted by both alphas, degrees.
pub fn coherence_deg(level: &MixtureLevel, addressing: Addressing) -> f64 {
    let row = |y: usize| {
        let mut sums = (0.0, 0.0);
        for x in 0..level.width {
            for (dx, dy) in [(1, 0), (0, 1)] {
                let column = neighbour(x, dx, level.width, addressing).filter(|&column| (column, dx) != (x, 1));
                let row = neighbour(y, dy, level.height, addressing).filter(|&row| (row, dy) != (y, 1));
                if let (Some(column), Some(row)) = (column, row) {
                    let pairs = level.texel(x, y).iter().zip(level.texel(column, row));
                    pairs.for_each(|(a, b)| add_angle(&mut sums, a, b));
                }
            }
        }
        sums
    };
    let rows: Vec<(f64, f64)> = (0..level.height).into_par_iter().map(row).collect();
    let (angle, weight) = rows.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
    if weight > 0.0 { (angle / weight).to_degrees() } else { 0.0 }
}

/// Mean angle between a texel's lobes and its four neighbours' lobes of the same slots, weighted by both alphas, degrees:
/// 0 where no neighbour uses a slot that the texel uses, for such lobes cross-fade; `None` where the level is not fitted.
pub fn texel_coherence_deg(lobes: &LobePyramid, texel: Texel) -> Option<f64> {
    let own = slots(lobes, texel)?;
    let (width, height) = lobes.map.level_size(texel.level);
    let addressing = lobes.map.options.addressing;
    let mut sums = (0.0, 0.0);
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
        let x = neighbour(texel.x, dx, width, addressing);
        let (Some(x), Some(y)) = (x, neighbour(texel.y, dy, height, addressing)) else { continue };
        let (first, theirs) = slots(lobes, Texel { x, y, ..texel })?;
        for (index, lobe) in own.1.iter().enumerate() {
            if let Some(other) = (own.0 + index).checked_sub(first).and_then(|slot| theirs.get(slot)) {
                add_angle(&mut sums, lobe, other);
            }
        }
    }
    Some(if sums.1 > 0.0 { (sums.0 / sums.1).to_degrees() } else { 0.0 })
}

/// A texel's stored lobes and the slot of the first: all of them, or a base texel's only one.
fn slots(lobes: &LobePyramid, texel: Texel) -> Option<(usize, Cow<'_, [StoredLobe]>)> {
    if texel.level > 0 {
        return Some((0, lobes.level(texel.level)?.texel(texel.x, texel.y).into()));
    }
    let index = texel.y * lobes.map.width + texel.x;
    lobes.base.as_ref().map(|_| (lobes.base_slot(index), vec![lobes.base_lobe(index)].into()))
}

fn add_angle((angle, weight): &mut (f64, f64), a: &StoredLobe, b: &StoredLobe) {
    let mu = |stored: &StoredLobe| Vec3::new(stored[1], stored[2], stored[3]).as_dvec3().try_normalize();
    if let (Some(mu_a), Some(mu_b), true) = (mu(a), mu(b), a[0].min(b[0]) > EMPTY_WEIGHT) {
        let both = f64::from(a[0]) + f64::from(b[0]);
        // From the chord: acos of the dot product rounds small angles away.
        *angle += both * 2.0 * (0.5 * mu_a.distance(mu_b)).min(1.0).asin();
        *weight += both;
    }
}

/// Where interpolated lobes are judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Half way between the centres of four texels of one level.
    Texels,
    /// There, and half way to the next coarser level.
    Levels,
}

/// What is blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// The stored channels, slot by slot, then shaded once: what hardware interpolation gives.
    Lobes,
    /// The texels' BRDFs: unaligned shading, whose error is that of the fit alone.
    Brdfs,
}

/// Points of one level with the truth at them.
#[derive(Clone, Debug)]
pub struct Interpolation {
    directions: Vec<DVec3>,
    points: Vec<Vec<(Texel, f32)>>,
    truth: Vec<Vec<f64>>,
}

impl Interpolation {
    /// Chooses the points, always the same, and computes their truth. `level` is not the top with [`Between::Levels`].
    pub fn new(map: &NormalMap, level: usize, between: Between) -> Self {
        let directions: Vec<DVec3> = direction::hemisphere(DIRECTIONS).collect();
        let size = map.level_sizes()[level];
        let footprint = map.len() / (size.0 * size.1);
        let count = (NORMALS / (4 * footprint)).clamp(LEAST_POINTS, POINTS);
        let points: Vec<_> = corners(size, count).map(|uv| taps(map, level, between, uv)).collect();
        let mut texels: Vec<Texel> = points.iter().flatten().map(|tap| tap.0).collect();
        texels.sort_by_key(|texel| (texel.level, texel.y, texel.x));
        texels.dedup();
        let normals = NORMALS / texels.len();
        let brdf = |&texel: &Texel| (texel, true_brdf(map, texel, &directions, normals));
        let brdfs: HashMap<Texel, Vec<f64>> = texels.par_iter().map(brdf).collect();
        let truth = points.iter().map(|taps| blended(taps, DIRECTIONS, |texel| &brdfs[&texel])).collect();
        Self { directions, points, truth }
    }

    /// The mean relative L2 error over the points; 0 where a level is not fitted.
    pub fn error(&self, lobes: &LobePyramid, blend: Blend) -> f64 {
        let error = |(taps, truth): (&Vec<(Texel, f32)>, &Vec<f64>)| {
            let value = match blend {
                Blend::Lobes => self.brdf(&Mixture::from_stored(&blended_lobes(lobes, taps))),
                Blend::Brdfs => {
                    let brdf = |(texel, _): &(Texel, f32)| self.brdf(&lobes.mixture(*texel).unwrap_or_default());
                    let brdfs: Vec<Vec<f64>> = taps.iter().map(brdf).collect();
                    let index = |texel| taps.iter().position(|tap| tap.0 == texel).unwrap_or(0);
                    blended(taps, DIRECTIONS, |texel| &brdfs[index(texel)])
                }
            };
            RelativeL2::of(value.into_iter().zip(truth.iter().copied()))
        };
        let errors: Vec<f64> = self.points.par_iter().zip(&self.truth).map(error).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }

    fn brdf(&self, mixture: &Mixture) -> Vec<f64> {
        let brdf = Brdf::BlinnPhong(BlinnPhong { shininess: SHININESS });
        let value = |&omega: &DVec3| super::effective_brdf(mixture, brdf, omega, ConvolutionRule::default());
        self.directions.iter().map(value).collect()
    }
}

/// At most `count` of the points where four texels meet, spread by the golden ratio.
fn corners((width, height): (usize, usize), count: usize) -> impl Iterator<Item = Vec2> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let all = width * height;
    let index = move |i: usize| if all <= count { i } else { ((i as f64 * GOLDEN).fract() * all as f64) as usize };
    let corner = move |i: usize| Vec2::new((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
    (0..all.min(count)).map(move |i| corner(index(i)))
}

/// The texels around `uv` with their weights, none of them twice.
fn taps(map: &NormalMap, level: usize, between: Between, uv: Vec2) -> Vec<(Texel, f32)> {
    let levels = match between {
        Between::Texels => vec![(level, 1.0)],
        Between::Levels => vec![(level, 0.5), (level + 1, 0.5)],
    };
    let mut taps: Vec<(Texel, f32)> = Vec::new();
    for (level, share) in levels {
        let (width, height) = map.level_sizes()[level];
        let grid = Grid { width, height, addressing: map.options.addressing };
        for (index, weight) in grid.bilinear(uv).into_iter().filter(|tap| tap.1 > 0.0) {
            let texel = Texel { level, x: index % width, y: index / width };
            match taps.iter_mut().find(|tap| tap.0 == texel) {
                Some(tap) => tap.1 += share * weight,
                None => taps.push((texel, share * weight)),
            }
        }
    }
    taps
}

/// The effective BRDF of a texel in every direction, from at most about `normals` of its normals.
fn true_brdf(map: &NormalMap, texel: Texel, directions: &[DVec3], normals: usize) -> Vec<f64> {
    let ndf = Ndf::of_texel(map, texel);
    // Odd, so that the strides do not fall into step with a map's own period.
    let stride = if ndf.len() > normals { ndf.len().div_ceil(normals) | 1 } else { 1 };
    let (mut sum, mut total) = (vec![0.0; directions.len()], 0.0);
    for (normal, weight) in ndf.samples().step_by(stride) {
        total += weight;
        for (value, omega) in sum.iter_mut().zip(directions) {
            *value += weight * normal.dot(*omega).max(0.0).powi(SHININESS as i32);
        }
    }
    let peak = BlinnPhong { shininess: SHININESS }.zonal(1.0);
    sum.iter().map(|value| peak * value / total).collect()
}

fn blended<'a>(taps: &[(Texel, f32)], length: usize, of: impl Fn(Texel) -> &'a Vec<f64>) -> Vec<f64> {
    let mut sum = vec![0.0; length];
    for &(texel, weight) in taps {
        sum.iter_mut().zip(of(texel)).for_each(|(sum, value)| *sum += f64::from(weight) * value);
    }
    sum
}

fn blended_lobes(lobes: &LobePyramid, taps: &[(Texel, f32)]) -> Vec<StoredLobe> {
    let mut stored = vec![glam::Vec4::ZERO; lobes.lobes()];
    for &(texel, weight) in taps {
        let texel = lobes.level(texel.level).map(|level| level.texel(texel.x, texel.y));
        stored
            .iter_mut()
            .zip(texel.unwrap_or_default())
            .for_each(|(sum, &lobe)| *sum += weight * glam::Vec4::from(lobe));
    }
    stored.into_iter().map(|lobe| lobe.to_array()).collect()
}
