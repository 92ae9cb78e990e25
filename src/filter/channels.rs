//! Channels that interpolate linearly, for every texel of every level, and their averages over footprints.
//!
//! A method that turns a normal into a fixed number of channels filters by averaging them, as plain MIP mapping does
//! with the normal's own three: slope moments, spherical harmonics. Others fill the channels by a fit. Either way a
//! lookup blends eight texels, as a GPU's sampler does, and the method shades once with the blend.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::Lookup;
use super::sampling::Grid;
use super::vmf::{Cancelled, Monitor};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::{Footprint, Span};

/// Memory set aside for one method's channels: 4096 x 4096 at four layers with all coarser levels.
const CHANNELS_BYTES: u64 = 3 << 29;

/// Channels of the levels from `first_level` to the top, four to a layer.
#[derive(Clone, Debug)]
pub struct ChannelPyramid {
    /// True where base texels need no store: the method shades them by their normals.
    pub base_by_hand: bool,
    /// The map's finest level that is stored; those left out for want of memory are the finest.
    pub first_level: usize,
    /// Groups of four channels per texel.
    pub layers: usize,
    /// `levels[k]` holds level `first_level + k`, texel by texel: `[(y * width + x) * layers + layer]`.
    pub levels: Vec<Vec<[f32; 4]>>,
    grids: Vec<Grid>,
}

/// The texels that a lookup blends, as `(level, row-major index, weight)`; the weights sum to 1.
#[derive(Clone, Copy, Debug)]
pub struct Taps([(usize, usize, f32); 8]);

/// What a normal becomes: writes its channels, as many as there are.
pub type Encode<'a> = &'a (dyn Fn(Vec3, &mut [f64]) + Sync);

impl ChannelPyramid {
    /// Nothing but zeros.
    pub fn zeros(map: &NormalMap, base_by_hand: bool, layers: usize) -> Self {
        let first_level = first_that_fits(&map.level_sizes(), usize::from(base_by_hand), layers);
        let grid = |(width, height)| Grid { width, height, addressing: map.options.addressing };
        let grids: Vec<Grid> = map.level_sizes().into_iter().map(grid).collect();
        let stored = grids.iter().skip(first_level);
        let levels = stored.map(|grid| vec![[0.0; 4]; grid.width * grid.height * layers]).collect();
        Self { base_by_hand, first_level, layers, levels, grids }
    }

    /// The area-weighted means of `encode` over every footprint's valid normals; a flat normal's where there is none.
    pub fn average(
        map: &NormalMap,
        base_by_hand: bool,
        channels: usize,
        encode: Encode<'_>,
        monitor: &Monitor,
    ) -> Result<Self, Cancelled> {
        let mut pyramid = Self::zeros(map, base_by_hand, channels.div_ceil(4));
        let first_level = pyramid.first_level;
        let mut areas: Vec<Vec<f32>> = Vec::new();
        for index in 0..pyramid.levels.len() {
            let finer = pyramid.nested_in(index);
            let (done, rest) = pyramid.levels.split_at_mut(index);
            let size =
                |index: usize| (pyramid.grids[first_level + index].width, pyramid.grids[first_level + index].height);
            let finer = finer.map(|k| Finer { size: size(k), stored: &done[k], areas: &areas[k] });
            let level = Level { map, size: size(index), channels, encode, finer };
            areas.push(level.fill(&mut rest[0], pyramid.layers, monitor)?);
        }
        Ok(pyramid)
    }

    /// The coarsest stored level finer than `levels[index]` whose texels it covers whole, so that their means serve.
    fn nested_in(&self, index: usize) -> Option<usize> {
        let grid = |index: usize| self.grids[self.first_level + index];
        let nests = |&finer: &usize| {
            grid(finer).width.is_multiple_of(grid(index).width) && grid(finer).height.is_multiple_of(grid(index).height)
        };
        (0..index).rev().find(nests)
    }

    /// One texel's layers; its level must be stored.
    pub fn texel(&self, level: usize, index: usize) -> &[[f32; 4]] {
        &self.levels[level - self.first_level][index * self.layers..][..self.layers]
    }

    /// Width and height of every level of the map, the base first.
    pub fn level_sizes(&self) -> Vec<(usize, usize)> {
        self.grids.iter().map(|grid| (grid.width, grid.height)).collect()
    }

    /// The texels of one level.
    pub fn grid(&self, level: usize) -> Grid {
        self.grids[level]
    }

    /// The texels that `lookup` blends; of levels that are not stored, the first that is stands in.
    pub fn taps(&self, lookup: &Lookup) -> Taps {
        let last = self.grids.len() - 1;
        let lod = lookup.lod.clamp(self.first_level as f32, last as f32);
        let fine = lod as usize;
        let blend = lod - fine as f32;
        let mut taps = [(fine, 0, 0.0); 8];
        for (half, (level, share)) in [(fine, 1.0 - blend), ((fine + 1).min(last), blend)].into_iter().enumerate() {
            for (corner, (index, weight)) in self.grids[level].bilinear(lookup.uv).into_iter().enumerate() {
                taps[4 * half + corner] = (level, index, share * weight);
            }
        }
        Taps(taps)
    }

    /// One layer of a lookup.
    pub fn blend(&self, taps: &Taps, layer: usize) -> Vec4 {
        let seen = taps.0.iter().filter(|tap| tap.2 > 0.0);
        seen.map(|&(level, index, weight)| weight * Vec4::from(self.texel(level, index)[layer])).sum()
    }
}

/// The first level from `finest` on that the memory set aside can hold with all coarser ones.
fn first_that_fits(sizes: &[(usize, usize)], finest: usize, layers: usize) -> usize {
    let needed = |from: usize| sizes[from..].iter().map(|(w, h)| (w * h * layers) as u64 * 16).sum::<u64>();
    (finest..sizes.len()).find(|&level| needed(level) <= CHANNELS_BYTES).unwrap_or(sizes.len() - 1)
}

/// A finer level that is done.
struct Finer<'a> {
    size: (usize, usize),
    stored: &'a [[f32; 4]],
    areas: &'a [f32],
}

/// A level to be averaged.
struct Level<'a> {
    map: &'a NormalMap,
    size: (usize, usize),
    channels: usize,
    encode: Encode<'a>,
    finer: Option<Finer<'a>>,
}

impl Level<'_> {
    /// Fills every texel and returns the area of its valid base texels.
    fn fill(&self, target: &mut [[f32; 4]], layers: usize, monitor: &Monitor) -> Result<Vec<f32>, Cancelled> {
        let mut areas = vec![0.0; self.size.0 * self.size.1];
        let scratch = || (vec![0.0; self.channels], vec![0.0; self.channels]);
        let texels = target.par_chunks_mut(layers).zip(&mut areas).enumerate();
        texels.try_for_each_init(scratch, |(sum, one), (index, (target, area))| {
            monitor.check()?;
            let texel = (index % self.size.0, index / self.size.0);
            sum.fill(0.0);
            let total = match &self.finer {
                Some(finer) => self.add_finer(finer, texel, sum),
                None => self.add_normals(texel, sum, one),
            };
            if total == 0.0 {
                (self.encode)(Vec3::Z, sum);
            }
            let scale = if total > 0.0 { 1.0 / total } else { 1.0 };
            for (stored, sum) in target.as_flattened_mut().iter_mut().zip(sum.iter()) {
                *stored = (scale * sum) as f32;
            }
            *area = total as f32;
            Ok(())
        })?;
        Ok(areas)
    }

    /// Adds the channels of the footprint's valid normals, times their areas; returns the area.
    fn add_normals(&self, texel: (usize, usize), sum: &mut [f64], one: &mut [f64]) -> f64 {
        let footprint = Footprint::new((self.map.width, self.map.height), self.size, texel);
        let mut total = 0.0;
        for (x, y, area) in footprint.texels() {
            let Some(normal) = self.map.normal(y * self.map.width + x) else { continue };
            (self.encode)(normal, one);
            sum.iter_mut().zip(one.iter()).for_each(|(sum, one)| *sum += f64::from(area) * one);
            total += f64::from(area);
        }
        total
    }

    /// The same from the means of whole finer texels.
    fn add_finer(&self, finer: &Finer<'_>, (x, y): (usize, usize), sum: &mut [f64]) -> f64 {
        let layers = self.channels.div_ceil(4);
        let columns = Span::new(finer.size.0, self.size.0, x);
        let rows = Span::new(finer.size.1, self.size.1, y);
        let mut total = 0.0;
        for index in
            (rows.start..rows.end).flat_map(|y| (columns.start..columns.end).map(move |x| y * finer.size.0 + x))
        {
            let area = f64::from(finer.areas[index]);
            let stored = finer.stored[index * layers..][..layers].as_flattened();
            sum.iter_mut().zip(stored).for_each(|(sum, &stored)| *sum += area * f64::from(stored));
            total += area;
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;
    use crate::normal_map::pyramid::level_sizes;

    fn nothing_else() -> Monitor {
        Monitor::new(Vec::new())
    }

    fn channels(map: &NormalMap) -> ChannelPyramid {
        let encode: Encode<'_> = &|normal, channels| {
            for (k, channel) in channels.iter_mut().enumerate() {
                *channel = f64::from(normal.x) * k as f64 + f64::from(normal.y);
            }
        };
        ChannelPyramid::average(map, false, 6, encode, &nothing_else()).expect("nobody cancels")
    }

    #[test]
    fn means_of_whole_finer_texels_are_means_of_the_normals() {
        let map = procedural::default_map();
        let pyramid = channels(&map);
        for level in [1, 4, map.level_sizes().len() - 1] {
            let grid = pyramid.grid(level);
            let index = (grid.height / 2) * grid.width + grid.width / 3;
            let texel = (index % grid.width, index / grid.width);
            let footprint = Footprint::new((map.width, map.height), (grid.width, grid.height), texel);
            let mean = crate::filter::plain_mip::mean_normal(&map, &footprint).expect("valid texels");
            let stored = pyramid.texel(level, index).as_flattened();
            for (k, &stored) in stored[..6].iter().enumerate() {
                let exact = mean.x * k as f64 + mean.y;
                assert!((f64::from(stored) - exact).abs() < 1e-6, "level {level}, channel {k}");
            }
            assert_eq!(stored[6..], [0.0, 0.0]);
        }
    }

    #[test]
    fn levels_too_large_for_the_memory_set_aside_are_left_out_the_finest_first() {
        let sizes = level_sizes(8192, 8192);
        assert_eq!(first_that_fits(&sizes, 0, 1), 0);
        assert_eq!(first_that_fits(&sizes, 0, 4), 1);
        assert_eq!(first_that_fits(&sizes, 1, 43), 3);
        assert_eq!(first_that_fits(&[(1, 1)], 1, 43), 0, "a map of one level");
    }

    #[test]
    fn a_cancelled_average_ends() {
        let monitor = nothing_else();
        monitor.cancel();
        let map = procedural::default_map();
        assert!(ChannelPyramid::average(&map, false, 4, &|_, _| {}, &monitor).is_err());
    }
}
