//! What texels look like: their normals under a usual material, towards fixed directions.
//!
//! The look of a texel towards w is `sum_i w_i v(n_i.w; K)`, v the lobe that stands for the material as in
//! [`super::phi`]: `A(K) = (s+1)/(s+2)`. Looks are linear in the normals, so the look half way between texels is the
//! same blend of theirs, and the look of a level follows from the finer one where boxes nest.

use multiversion::multiversion;
use multiversion::target::target_cfg_f;
use rayon::prelude::*;

use super::joint_rows;
use super::kernel::SampleSlices;
use super::lanes::{LANES, exp_of_negative};
use super::monitor::{Cancelled, Monitor};
use super::phi::Width;
use super::samples::{FootprintSamples, Samples};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;
use crate::sphere::direction;

/// The Blinn-Phong exponent of the material.
pub const SHININESS: f64 = 64.0;

/// Its mean cosine, by which it shortens a lobe's mean vector.
pub const MEAN_COSINE: f64 = (SHININESS + 1.0) / (SHININESS + 2.0);

/// Directions over the hemisphere, of which a map uses those where it is seen: 160 cost 5 % of the accuracy that
/// 256 have, 100 cost 17 %.
pub const MOST_DIRECTIONS: usize = 13 * LANES;

/// Rings they lie on.
const RINGS: usize = 9;

/// A direction is used where the whole map looks this bright, against its brightest.
const SEEN: f64 = 1e-3;

/// Levels of more texels than this are not kept, some 100 MB, but worked out whenever they are read.
const MOST_KEPT: usize = 1 << 18;

/// Where looks are taken, as the loops read them.
#[derive(Clone, Debug)]
pub struct Directions {
    /// x components; a multiple of [`LANES`] of them.
    pub x: Vec<f32>,
    /// y components.
    pub y: Vec<f32>,
    /// z components; padding lies far from the sphere, where every lobe is 0.
    pub z: Vec<f32>,
}

impl Directions {
    /// Those of the hemisphere that `wanted` holds.
    fn new(wanted: impl Fn(usize) -> bool) -> Self {
        let mut own = Self { x: Vec::new(), y: Vec::new(), z: Vec::new() };
        let all = direction::symmetric_hemisphere(RINGS).take(MOST_DIRECTIONS);
        for (_, towards) in all.enumerate().filter(|(i, _)| wanted(*i)) {
            own.push(towards);
        }
        while own.x.is_empty() || !own.x.len().is_multiple_of(LANES) {
            own.push(glam::Vec3::new(0.0, 0.0, -30.0));
        }
        own
    }

    fn push(&mut self, towards: glam::Vec3) {
        self.x.push(towards.x);
        self.y.push(towards.y);
        self.z.push(towards.z);
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Never true.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }
}

/// A sum of looks.
#[derive(Clone, Copy)]
struct LookSum {
    value: [f32; MOST_DIRECTIONS],
    total: f64,
}

impl Default for LookSum {
    fn default() -> Self {
        Self { value: [0.0; MOST_DIRECTIONS], total: 0.0 }
    }
}

impl std::ops::AddAssign<&Self> for LookSum {
    fn add_assign(&mut self, other: &Self) {
        self.value.iter_mut().zip(&other.value).for_each(|(own, other)| *own += other);
        self.total += other.total;
    }
}

/// Adds the looks of `samples`, without the lobe's peak.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn accumulate(samples: &SampleSlices, directions: &Directions, neg_half_kappa: f32, sum: &mut LookSum) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for group in 0..directions.len() / LANES {
        let range = group * LANES..(group + 1) * LANES;
        let (x, y, z) = (&directions.x[range.clone()], &directions.y[range.clone()], &directions.z[range.clone()]);
        let mut acc = [0.0_f32; LANES];
        for n in 0..samples.x.len() {
            let (nx, ny, nz, w) = (samples.x[n], samples.y[n], samples.z[n], samples.w[n]);
            for i in 0..LANES {
                let (dx, dy, dz) = (x[i] - nx, y[i] - ny, z[i] - nz);
                acc[i] += w * exp_of_negative::<FMA>(neg_half_kappa * (dx * dx + dy * dy + dz * dz));
            }
        }
        sum.value[range].iter_mut().zip(acc).for_each(|(sum, value)| *sum += value);
    }
    sum.total += samples.w.iter().map(|&w| f64::from(w)).sum::<f64>();
}

/// The looks of every texel but of those with few normals, which need none ([`super::joint_rows`]).
#[derive(Clone, Debug)]
pub struct Looks<'a> {
    map: &'a NormalMap,
    sizes: Vec<(usize, usize)>,
    /// Where they are taken.
    pub directions: Directions,
    /// By level, texel by texel; empty where they are not kept.
    kept: Vec<Vec<f32>>,
}

impl<'a> Looks<'a> {
    /// Takes the looks of `map`.
    pub fn new(map: &'a NormalMap, monitor: &Monitor) -> Result<Self, Cancelled> {
        let mut own = Self { map, sizes: map.level_sizes(), directions: Directions::new(|_| true), kept: Vec::new() };
        if let Some(finest) = (0..own.sizes.len()).find(|&level| own.keeps(level)) {
            own.kept = vec![Vec::new(); finest];
            let looks = own.level(finest, monitor)?;
            let seen = own.narrow(&looks);
            own.kept.push(seen);
        }
        for level in own.kept.len()..own.sizes.len() {
            let looks = own.level(level, monitor)?;
            own.kept.push(looks);
        }
        Ok(own)
    }

    /// Leaves out the directions in which a level is not seen; returns its looks towards the others.
    fn narrow(&mut self, looks: &[f32]) -> Vec<f32> {
        let all = self.directions.len();
        let mut whole = [0.0_f64; MOST_DIRECTIONS];
        for look in looks.chunks_exact(all) {
            whole.iter_mut().zip(look).for_each(|(sum, &value)| *sum += f64::from(value));
        }
        let brightest = whole.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let seen: Vec<usize> = (0..all).filter(|&i| whole[i] > SEEN * brightest).collect();
        self.directions = Directions::new(|i| seen.binary_search(&i).is_ok());
        let count = self.directions.len();
        let mut narrowed = vec![0.0; looks.len() / all * count];
        for (look, out) in looks.chunks_exact(all).zip(narrowed.chunks_exact_mut(count)) {
            out.iter_mut().zip(&seen).for_each(|(out, &i)| *out = look[i]);
        }
        narrowed
    }

    /// True for a level whose looks are kept.
    fn keeps(&self, level: usize) -> bool {
        let (width, height) = self.sizes[level];
        !joint_rows::is_small(self.map, (width, height)) && width * height <= MOST_KEPT
    }

    fn level(&self, level: usize, monitor: &Monitor) -> Result<Vec<f32>, Cancelled> {
        let (width, height) = self.sizes[level];
        if !self.keeps(level) {
            return Ok(Vec::new());
        }
        let count = self.directions.len();
        let mut looks = vec![0.0; width * height * count];
        let finer = self.nested(level);
        looks.par_chunks_mut(count).enumerate().try_for_each(|(index, look)| {
            monitor.check()?;
            let texel = (index % width, index / width);
            match finer {
                Some(finer) => average(finer, self.sizes[level - 1].0, texel, look),
                None => self.work_out(level, texel, look),
            }
            Ok(())
        })?;
        Ok(looks)
    }

    /// The finer level's looks where four of them average to one of this level's.
    fn nested(&self, level: usize) -> Option<&[f32]> {
        let (coarse, fine) = (self.sizes[level], self.sizes[level - 1]);
        let finer = &self.kept[level - 1];
        let nest = self.map.invalid == 0 && fine == (2 * coarse.0, 2 * coarse.1) && !finer.is_empty();
        nest.then_some(finer)
    }

    /// The look of one texel, from its normals; a flat one where none is valid.
    fn work_out(&self, level: usize, texel: (usize, usize), look: &mut [f32]) {
        let width = Width::of_length(MEAN_COSINE);
        let samples = FootprintSamples::new(self.map, Footprint::new(self.sizes[0], self.sizes[level], texel));
        let neg_half_kappa = (-0.5 * width.kappa) as f32;
        let mut sum: LookSum = samples.sum(|slices, sum| accumulate(slices, &self.directions, neg_half_kappa, sum));
        if sum.total <= 0.0 {
            sum = LookSum::default();
            let flat = SampleSlices { x: &[0.0], y: &[0.0], z: &[1.0], w: &[1.0], spread: &[] };
            accumulate(&flat, &self.directions, neg_half_kappa, &mut sum);
        }
        let scale = (width.peak / sum.total) as f32;
        look.iter_mut().zip(sum.value).for_each(|(look, value)| *look = scale * value);
    }

    /// Writes the looks of one row of texels to `row`.
    pub fn read_row(&self, level: usize, y: usize, row: &mut [f32]) {
        let (width, count) = (self.sizes[level].0, self.directions.len());
        match self.kept[level].get(y * width * count..(y + 1) * width * count) {
            Some(kept) => row.copy_from_slice(kept),
            None => row.chunks_mut(count).enumerate().for_each(|(x, look)| self.work_out(level, (x, y), look)),
        }
    }
}

/// The mean look of the four finer texels in a box.
fn average(finer: &[f32], width: usize, (x, y): (usize, usize), look: &mut [f32]) {
    let of = |x: usize, y: usize| &finer[(y * width + x) * look.len()..][..look.len()];
    let (a, b) = (of(2 * x, 2 * y), of(2 * x + 1, 2 * y));
    let (c, d) = (of(2 * x, 2 * y + 1), of(2 * x + 1, 2 * y + 1));
    let mean: [f32; MOST_DIRECTIONS] =
        std::array::from_fn(|i| if i < a.len() { 0.25 * ((a[i] + b[i]) + (c[i] + d[i])) } else { 0.0 });
    look.copy_from_slice(&mean[..look.len()]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    #[test]
    fn looks_of_nested_boxes_are_those_of_their_normals() {
        let map = procedural::find("waves").expect("bundled").make(64);
        let looks = Looks::new(&map, &Monitor::new(vec![1; 7])).expect("nobody cancels");
        let count = looks.directions.len();
        for level in 4..7 {
            let width = 64 >> level;
            let mut row = vec![0.0; width * count];
            looks.read_row(level, width - 1, &mut row);
            let mut own = vec![0.0; count];
            looks.work_out(level, (width - 1, width - 1), &mut own);
            let brightest = own.iter().copied().fold(0.0, f32::max);
            let farthest = own.iter().zip(&row[row.len() - count..]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(farthest < 1e-5 * brightest, "level {level}: {farthest} of {brightest}");
        }
    }
}
