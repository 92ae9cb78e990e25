//! The truth: the sum itself, and its supersampling over a pixel's footprint.
//!
//! A sample is the base texel under a jittered point of the pixel's square, seen through the pixel's own perspective
//! ([`PixelFootprint`](super::PixelFootprint)) and lit as the pixel's centre is; an invalid texel reflects nothing. The
//! mean estimates the integral that [`ExactCoverage`](crate::reference::ExactCoverage) computes without samples. The
//! points follow Roberts' R2 sequence (2018), shifted per pixel by a hash, in 32-bit integers so that the shader draws
//! the very same ones.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use super::sampling::address;
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, reflect};
use crate::brdf::{Brdf, Material};
use crate::ndf::Ndf;
use crate::normal_map::pyramid::Texel;
use crate::normal_map::{Addressing, NormalMap};

/// `2^32 / p` and `2^32 / p^2` for the plastic number p: the steps of the R2 sequence.
const R2_STEP: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// Supersampling of the unfiltered map.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The map.
    pub map: Arc<NormalMap>,
    /// Samples per pixel.
    pub samples: u32,
}

/// A hash of 32 bits to 32 bits: the output permutation of PCG (O'Neill 2014; Jarzynski and Olano 2020).
fn pcg(input: u32) -> u32 {
    let state = input.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// What starts the sequences of a pixel: two of the jitter, three of the sky's directions.
pub(super) fn pixel_seeds(pixel: [u32; 2]) -> [u32; 5] {
    let mut seed = pcg(pixel[1]) ^ pixel[0];
    std::array::from_fn(|_| {
        seed = pcg(seed);
        seed
    })
}

/// Number `index` of a Kronecker sequence, in `0..1`.
pub(super) fn number(seed: u32, step: u32, index: u32) -> f32 {
    (seed.wrapping_add(index.wrapping_mul(step)) >> 8) as f32 / 16_777_216.0
}

/// Offset of sample `index` from the pixel's centre, each component in `-0.5..0.5`, for integer pixel coordinates.
pub fn jitter(pixel: [u32; 2], index: u32) -> Vec2 {
    let [across, down, ..] = pixel_seeds(pixel);
    Vec2::new(number(across, R2_STEP[0], index), number(down, R2_STEP[1], index)) - 0.5
}

/// The base texel under `uv` along one axis of `size` texels.
pub fn nearest_texel(coordinate: f32, size: usize, addressing: Addressing) -> usize {
    address((coordinate * size as f32).floor() as i64, size, addressing)
}

impl Truth {
    /// The normal under a point of the map, zero where it is invalid, and the colour there.
    fn texel_at(&self, uv: Vec2) -> (Vec3, Vec3) {
        let map = &self.map;
        let x = nearest_texel(uv.x, map.width, map.options.addressing);
        let y = nearest_texel(uv.y, map.height, map.options.addressing);
        let index = y * map.width + x;
        (map.normal(index).unwrap_or(Vec3::ZERO), map.color(index))
    }
}

impl Filter for Truth {
    fn map(&self) -> &NormalMap {
        &self.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let ndf = Ndf::of_texel(&self.map, texel);
        Box::new(move |omega| ndf.effective_brdf(brdf, omega))
    }

    fn is_truth(&self) -> bool {
        true
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        // In f64: an f32 sum of 65536 samples is off by 1e-4.
        let mut sum = DVec3::ZERO;
        for index in 0..self.samples {
            let offset = jitter(lookup.pixel, index);
            let (normal, color) = self.texel_at(lookup.uv + lookup.footprint.uv_step(offset));
            let normal = lookup.turned(normal);
            let specular = material.specular_at(normal.dot(light.half_in_tangent));
            sum += (color * reflect(material, specular, normal.dot(light.light_in_tangent))).as_dvec3();
        }
        (sum / f64::from(self.samples)).as_vec3()
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let sample = |index: u32| {
            let offset = jitter(lookup.pixel, index);
            let (normal, color) = self.texel_at(lookup.uv + lookup.footprint.uv_step(offset));
            (color * sky.sample(normal, lookup.pixel, index)).as_dvec3()
        };
        ((0..self.samples).map(sample).sum::<DVec3>() / f64::from(self.samples)).as_vec3()
    }
}
