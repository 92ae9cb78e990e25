//! Plain MIP mapping: the footprint's mean normal, normalised. What hardware does to any texture, and wrong for
//! normals: every footprint shades as if it were flat. Left unnormalised, the mean normal darkens what is rough, the
//! highlight to nothing.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::rival::{Built, Rival, RivalFilter, RivalKind, Source};
use super::sampling::{Grid, trilinear};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe, reflect};
use crate::brdf::{Brdf, Material};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::{Footprint, Texel};

/// `mip`.
pub static KIND: RivalKind = RivalKind {
    name: "mip",
    label: "plain mip",
    parameter: None,
    has_channels: false,
    shader: include_str!("../../shaders/methods/mip.wgsl"),
    build,
};

/// `mip-unnormalised`.
pub static UNNORMALISED: RivalKind = RivalKind {
    name: "mip-unnormalised",
    label: "mip, unnormalised",
    parameter: None,
    has_channels: false,
    shader: include_str!("../../shaders/methods/mip_unnormalised.wgsl"),
    build: build_unnormalised,
};

fn build(source: &Source<'_>, _: Rival) -> Built {
    Ok(Arc::<PlainMip>::clone(source.mip))
}

fn build_unnormalised(source: &Source<'_>, _: Rival) -> Built {
    Ok(Arc::new(UnnormalisedMip { mip: Arc::clone(source.mip) }))
}

/// Mean normals of every level.
#[derive(Clone, Debug)]
pub struct PlainMip {
    /// The map.
    pub map: Arc<NormalMap>,
    /// `levels[k]`: the mean normal of each texel of level `k`, row by row, not normalised; zero where no base
    /// texel is valid.
    pub levels: Vec<Vec<Vec3>>,
    /// `colors[k]`: the mean colour of each texel of level `k`; no levels for a map without colour.
    pub colors: Vec<Vec<Vec3>>,
}

impl PlainMip {
    /// Averages every footprint of every level over its valid base texels.
    pub fn new(map: Arc<NormalMap>) -> Self {
        let base = (map.width, map.height);
        let mean = |size: (usize, usize), index: usize| {
            let footprint = Footprint::new(base, size, (index % size.0, index / size.0));
            mean_normal(&map, &footprint).unwrap_or(DVec3::ZERO).as_vec3()
        };
        let color = |size: (usize, usize), index: usize| {
            mean_color(&map, &Footprint::new(base, size, (index % size.0, index / size.0)))
        };
        let sizes = map.level_sizes();
        let levels = sizes.iter().map(|&size| each_texel(size, &mean)).collect();
        let colored = if map.albedo.is_some() { sizes.as_slice() } else { &[] };
        let colors = colored.iter().map(|&size| each_texel(size, &color)).collect();
        Self { map, levels, colors }
    }

    /// The mean normal of one texel, not normalised.
    pub fn of_texel(&self, texel: Texel) -> Vec3 {
        let width = self.map.level_sizes()[texel.level].0;
        self.levels[texel.level][texel.y * width + texel.x]
    }

    /// The interpolated mean normal, not normalised.
    pub fn mean(&self, lookup: &Lookup) -> Vec3 {
        trilinear(lookup.lod, self.levels.len(), |level| {
            self.grid(level).bilinear(lookup.uv).into_iter().map(|(index, w)| w * self.levels[level][index]).sum()
        })
    }

    /// The interpolated mean colour; white for a map without colour.
    pub fn color(&self, lookup: &Lookup) -> Vec3 {
        if self.colors.is_empty() {
            return Vec3::ONE;
        }
        trilinear(lookup.lod, self.colors.len(), |level| {
            self.grid(level).bilinear(lookup.uv).into_iter().map(|(index, w)| w * self.colors[level][index]).sum()
        })
    }

    /// The texels of one level.
    pub fn grid(&self, level: usize) -> Grid {
        let (width, height) = self.map.level_sizes()[level];
        Grid { width, height, addressing: self.map.options.addressing }
    }
}

/// The area-weighted mean of the footprint's valid normals, summed in f64; `None` where none is valid.
pub fn mean_normal(map: &NormalMap, footprint: &Footprint) -> Option<DVec3> {
    let (mut sum, mut area) = (DVec3::ZERO, 0.0);
    for (x, y, weight) in footprint.texels() {
        if let Some(normal) = map.normal(y * map.width + x) {
            sum += f64::from(weight) * normal.as_dvec3();
            area += f64::from(weight);
        }
    }
    (area > 0.0).then(|| sum / area)
}

fn each_texel(size: (usize, usize), value: &(dyn Fn((usize, usize), usize) -> Vec3 + Sync)) -> Vec<Vec3> {
    (0..size.0 * size.1).into_par_iter().map(|index| value(size, index)).collect()
}

/// The area-weighted mean of the footprint's colours, summed in f64.
fn mean_color(map: &NormalMap, footprint: &Footprint) -> Vec3 {
    let (mut sum, mut area) = (DVec3::ZERO, 0.0);
    for (x, y, weight) in footprint.texels() {
        sum += f64::from(weight) * map.color(y * map.width + x).as_dvec3();
        area += f64::from(weight);
    }
    (sum / area).as_vec3()
}

impl RivalFilter for PlainMip {}

impl Filter for PlainMip {
    fn map(&self) -> &NormalMap {
        &self.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let normal = self.of_texel(texel).as_dvec3().try_normalize().unwrap_or(DVec3::Z);
        Box::new(move |omega| brdf.zonal(normal.dot(omega)))
    }

    fn mean_normal(&self, lookup: &Lookup) -> Option<Vec3> {
        Some(self.mean(lookup))
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let normal = self.mean(lookup).normalize_or_zero();
        self.color(lookup) * reflect_from(normal, light, material)
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        self.color(lookup) * sky.shade(&NdfLobe::normal(self.mean(lookup).normalize_or_zero()))
    }
}

/// The mean normals, used as they are.
#[derive(Clone, Debug)]
pub struct UnnormalisedMip {
    /// The mean normals.
    pub mip: Arc<PlainMip>,
}

impl RivalFilter for UnnormalisedMip {}

impl Filter for UnnormalisedMip {
    fn map(&self) -> &NormalMap {
        &self.mip.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let mean = self.mip.of_texel(texel).as_dvec3();
        Box::new(move |omega| brdf.zonal(mean.dot(omega)))
    }

    fn mean_normal(&self, lookup: &Lookup) -> Option<Vec3> {
        Some(self.mip.mean(lookup))
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        self.mip.color(lookup) * reflect_from(self.mip.mean(lookup), light, material)
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        self.mip.color(lookup) * sky.shade(&NdfLobe::normal(self.mip.mean(lookup)))
    }
}

fn reflect_from(normal: Vec3, light: &LocalLight, material: &Material) -> Vec3 {
    let specular = material.specular_at(normal.dot(light.half_in_tangent));
    reflect(material, specular, normal.dot(light.light_in_tangent))
}
