//! Mixtures of von Mises-Fisher lobes: fitting, alignment, storage and shading.

pub mod alignment;
pub mod appearance;
pub mod base_slots;
pub mod between;
pub mod bins;
pub mod brdf_error;
pub mod channel_lobes;
pub mod channel_phi;
pub mod children;
pub mod cholesky;
pub mod coherence;
pub mod color;
pub mod corners;
pub mod crowd;
pub mod crowd_channels;
pub mod crowd_em;
pub mod crowd_gauss_newton;
pub mod crowd_lobes;
pub mod crowd_phi;
pub mod crowd_samples;
pub mod crowd_system;
pub mod em;
pub mod first;
pub mod fit;
pub mod fold;
pub mod gauss_newton;
pub mod grow;
pub mod joint_looks;
pub mod joint_rows;
pub mod kernel;
pub mod lane_width;
pub mod lanes;
pub mod likelihood;
pub mod lobe_lanes;
pub mod looks;
pub mod merge;
pub mod merge_costs;
pub mod monitor;
pub mod objective;
pub mod phi;
pub mod pull;
pub mod pyramid;
pub mod residual;
pub mod samples;
pub mod scanline;
pub mod seed;
pub mod selection;
pub mod shaded;
pub mod smooth;
pub mod texel_row;
pub mod trace;
pub mod unaligned;

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4Swizzles};

use super::sampling::{Grid, trilinear};
use super::{EffectiveBrdf, Filter, LocalLight, LocalSky, Lookup, NdfLobe};
use crate::brdf::{Brdf, ConvolutionRule, Convolved, DiffuseRule, Material};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::vmf;
use crate::sphere::{Lobe, Mixture};

pub use alignment::Alignment;
pub use coherence::Coherence;
pub use color::ColorLevel;
pub use em::EStep;
pub use fit::{FitEvent, FitSettings, LevelStats, Stage};
pub use monitor::{Cancelled, Monitor};
pub use objective::Objective;
pub use pyramid::{BaseSlots, LobePyramid, MixtureLevel};
pub use selection::{LobeCount, Selection};

/// Which slot each slot's channels are added to before shading: the identity shows the fit as it is, anything else
/// is a preview with fewer lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold(pub [u8; MAX_LOBES]);

impl Default for Fold {
    fn default() -> Self {
        Self(std::array::from_fn(|slot| slot as u8))
    }
}

/// Shading by the lobes at hand.
#[derive(Clone, Debug)]
pub struct VmfFilter {
    /// The lobes.
    pub lobes: Arc<LobePyramid>,
    /// How slots are merged before shading.
    pub fold: Fold,
    /// How effective BRDFs are found; pictures go by their material's.
    pub rules: Rules,
}

/// How a lobe and a BRDF are convolved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rules {
    /// For the specular part.
    pub convolution: ConvolutionRule,
    /// For the diffuse part.
    pub diffuse: DiffuseRule,
}

impl Default for Rules {
    fn default() -> Self {
        Self { convolution: ConvolutionRule::default(), diffuse: DiffuseRule::Exact }
    }
}

/// Shading of each of the eight texels around by its own lobes, and a blend of the results: slower than interpolating
/// lobes, and right whatever slot a lobe sits in.
#[derive(Clone, Debug)]
pub struct UnalignedVmf(pub VmfFilter);

/// Stored lobes of one lookup and their stored colours `alpha y`, all slots.
#[derive(Clone, Copy, Debug)]
struct Slots([(glam::Vec4, Vec3); MAX_LOBES]);

impl Slots {
    const EMPTY: Self = Self([(glam::Vec4::ZERO, Vec3::ZERO); MAX_LOBES]);

    fn add(&mut self, slot: usize, stored: glam::Vec4, color: Vec3) {
        self.0[slot].0 += stored;
        self.0[slot].1 += color;
    }
}

impl std::ops::Add for Slots {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|slot| (self.0[slot].0 + other.0[slot].0, self.0[slot].1 + other.0[slot].1)))
    }
}

impl std::ops::Mul<f32> for Slots {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|(stored, color)| (stored * factor, color * factor)))
    }
}

impl VmfFilter {
    /// Interpolated lobes around `uv` in one level; nothing where the level is not fitted.
    fn slots_at(&self, uv: Vec2, level: usize) -> Slots {
        let taps = self.grid(level).bilinear(uv);
        taps.into_iter().fold(Slots::EMPTY, |sum, (index, weight)| sum + self.slots_of(level, index) * weight)
    }

    /// The lobes of one texel, row-major `index`.
    fn slots_of(&self, level: usize, index: usize) -> Slots {
        let mut slots = Slots::EMPTY;
        if level == 0 {
            let stored = glam::Vec4::from(self.lobes.base_lobe(index));
            let slot = usize::from(self.fold.0[self.lobes.base_slot(index)]);
            slots.add(slot, stored, stored.x * self.lobes.map.color(index));
        } else if let Some(mixtures) = self.lobes.level(level) {
            let stored = mixtures.texel(index % mixtures.width, index / mixtures.width);
            for (slot, &stored) in stored.iter().enumerate() {
                let color = self.lobes.color(level, index * mixtures.lobes + slot);
                slots.add(usize::from(self.fold.0[slot]), glam::Vec4::from(stored), color);
            }
        }
        slots
    }

    fn grid(&self, level: usize) -> Grid {
        let (width, height) = self.lobes.map.level_sizes()[level];
        Grid { width, height, addressing: self.lobes.map.options.addressing }
    }
}

impl Slots {
    /// What the lobes reflect together.
    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let filled = self.0.iter().filter(|(stored, _)| stored.x > EMPTY_WEIGHT);
        let turned = |stored: glam::Vec4| lookup.turned(stored.yzw()).extend(stored.x).wxyz();
        filled.map(|&(stored, color)| color / stored.x * shade_lobe(turned(stored), light, material)).sum()
    }
}

impl Slots {
    /// What they reflect of the sky together.
    fn shade_sky(&self, sky: &LocalSky<'_>) -> Vec3 {
        let filled = self.0.iter().filter(|(stored, _)| stored.x > EMPTY_WEIGHT);
        let of_lobe = |&(stored, color): &(glam::Vec4, Vec3)| {
            let resultant = stored.yzw() / stored.x;
            let length = resultant.length();
            let concentration = vmf::concentration(1.0 - f64::from(length));
            let mean_direction = resultant / length.max(1e-12);
            color * sky.shade(&NdfLobe { weight: 1.0, mean_direction, concentration })
        };
        filled.map(of_lobe).sum()
    }
}

impl Filter for VmfFilter {
    fn map(&self) -> &NormalMap {
        &self.lobes.map
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        let mixture = fold::mixture(&self.lobes, self.fold, texel).unwrap_or_default();
        let convolved = |lobe: &Lobe| match brdf {
            Brdf::Lambert => self.rules.diffuse.convolved_with(lobe.concentration),
            _ => brdf.convolved_with(self.rules.convolution, lobe.concentration),
        };
        let lobes: Vec<(Lobe, Convolved)> = mixture.lobes.iter().map(|(_, lobe)| (*lobe, convolved(lobe))).collect();
        let of_lobe = |(lobe, convolved): &(Lobe, Convolved), omega: DVec3| {
            lobe.weight * convolved.at(lobe.mean_direction.dot(omega))
        };
        Box::new(move |omega| lobes.iter().map(|lobe| of_lobe(lobe, omega)).sum())
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        trilinear(lookup.lod, self.lobes.levels(), |level| self.slots_at(lookup.uv, level))
            .shade(lookup, light, material)
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        trilinear(lookup.lod, self.lobes.levels(), |level| self.slots_at(lookup.uv, level)).shade_sky(sky)
    }
}

impl Filter for UnalignedVmf {
    fn map(&self) -> &NormalMap {
        self.0.map()
    }

    fn effective_brdf_of(&self, texel: Texel, brdf: Brdf) -> EffectiveBrdf<'_> {
        self.0.effective_brdf_of(texel, brdf)
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let of_texel = |level, (index, weight)| weight * self.0.slots_of(level, index).shade(lookup, light, material);
        trilinear(lookup.lod, self.0.lobes.levels(), |level| {
            self.0.grid(level).bilinear(lookup.uv).into_iter().map(|tap| of_texel(level, tap)).sum::<Vec3>()
        })
    }

    fn shade_sky(&self, lookup: &Lookup, sky: &LocalSky<'_>) -> Vec3 {
        let of_texel = |level, (index, weight)| weight * self.0.slots_of(level, index).shade_sky(sky);
        trilinear(lookup.lod, self.0.lobes.levels(), |level| {
            self.0.grid(level).bilinear(lookup.uv).into_iter().map(|tap| of_texel(level, tap)).sum::<Vec3>()
        })
    }
}

/// `alpha (Ks Bs(w_h . mu) + Kd) cos` of one stored lobe (Han et al. 2007, Algorithm 2) before its colour y, linear
/// RGB.
fn shade_lobe(stored: glam::Vec4, light: &LocalLight, material: &Material) -> Vec3 {
    let weight = stored.x;
    let resultant = stored.yzw() / weight;
    let length = resultant.length();
    let mu = resultant / length.max(1e-12);
    let kappa = vmf::concentration(1.0 - f64::from(length));
    let (half_cosine, light_cosine) = (mu.dot(light.half_in_tangent), mu.dot(light.light_in_tangent));
    let specular = material.blurred_at(kappa, half_cosine);
    let diffuse = material.diffuse_rule.cosine(kappa, f64::from(light_cosine)) as f32;
    weight
        * (material.specular * specular * light_cosine.max(0.0) * material.specular_color
            + material.diffuse * diffuse * material.diffuse_color)
}

/// `sum_j alpha_j f_j(mu_j . omega)` with each f_j blurred by its lobe, per steradian.
pub fn effective_brdf(mixture: &Mixture, brdf: Brdf, omega: DVec3, rule: ConvolutionRule) -> f64 {
    let of_lobe = |lobe: &Lobe| lobe.weight * brdf.convolved(rule, lobe.concentration, lobe.mean_direction.dot(omega));
    mixture.lobes.iter().map(|(_, lobe)| of_lobe(lobe)).sum()
}
