//! Fitted lobes of every texel of every level, as they are stored.

use std::sync::Arc;

use glam::{Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use super::color::ColorLevel;
use crate::normal_map::NormalMap;
use crate::normal_map::pose::Pose;
use crate::normal_map::pyramid::Texel;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES, used};
use crate::sphere::{Mixture, StoredLobe};

/// The mixtures of one level above the base.
#[derive(Clone, Debug, PartialEq)]
pub struct MixtureLevel {
    /// Texels across.
    pub width: usize,
    /// Texels down.
    pub height: usize,
    /// Slots per texel.
    pub lobes: usize,
    /// Texel-major: `stored[(y * width + x) * lobes + slot]`.
    pub stored: Vec<StoredLobe>,
}

impl MixtureLevel {
    /// A level of empty slots.
    pub fn empty((width, height): (usize, usize), lobes: usize) -> Self {
        Self { width, height, lobes, stored: vec![[0.0; 4]; width * height * lobes] }
    }

    /// Texels that use no lobe, one, two and so on.
    pub fn lobe_counts(&self) -> [usize; MAX_LOBES + 1] {
        let mut counts = [0; MAX_LOBES + 1];
        self.stored.chunks_exact(self.lobes).for_each(|stored| counts[used(stored)] += 1);
        counts
    }

    /// Mean number of lobes in use per texel.
    pub fn mean_lobes(&self) -> f64 {
        let all: usize = self.lobe_counts().iter().enumerate().map(|(count, texels)| count * texels).sum();
        all as f64 / (self.width * self.height) as f64
    }

    /// The level without the slots that no texel uses.
    pub fn trimmed(self) -> Self {
        let last = |stored: &[StoredLobe]| stored.iter().rposition(|lobe| lobe[0] > EMPTY_WEIGHT).map_or(0, |j| j + 1);
        let lobes = self.stored.chunks_exact(self.lobes).map(last).max().unwrap_or(0).max(1);
        if lobes == self.lobes {
            return self;
        }
        let stored = self.stored.chunks_exact(self.lobes).flat_map(|stored| stored[..lobes].iter().copied()).collect();
        Self { lobes, stored, ..self }
    }

    /// The level in another pose.
    pub fn posed(self: &Arc<Self>, pose: Pose) -> Arc<Self> {
        if pose == Pose::IDENTITY {
            return Arc::clone(self);
        }
        let size = (self.width, self.height);
        let mut posed = Self::empty(pose.size(size), self.lobes);
        let width = posed.width;
        posed.stored.par_chunks_mut(width * self.lobes).enumerate().for_each(|(row, target)| {
            for (column, target) in target.chunks_exact_mut(self.lobes).enumerate() {
                let (x, y) = pose.source(size, (column, row));
                target.copy_from_slice(self.texel(x, y));
                turn(target, pose);
            }
        });
        Arc::new(posed)
    }

    /// The slots of texel `(x, y)`.
    pub fn texel(&self, x: usize, y: usize) -> &[StoredLobe] {
        let start = (y * self.width + x) * self.lobes;
        &self.stored[start..start + self.lobes]
    }
}

/// Turns the directions of a texel's lobes.
pub fn turn(stored: &mut [StoredLobe], pose: Pose) {
    for lobe in stored {
        *lobe = pose.vector(Vec4::from(*lobe).yzw()).extend(lobe[0]).wxyz().to_array();
    }
}

/// The slot that each base texel's only lobe sits in: a base texel is one normal, so its lobe is
/// `(1, n)` there and nothing elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BaseSlots {
    /// Row by row, one slot per base texel.
    pub slots: Vec<u8>,
}

/// The lobes at hand: complete, or as far as a running fit has come.
#[derive(Clone, Debug)]
pub struct LobePyramid {
    /// The map that was fitted.
    pub map: Arc<NormalMap>,
    /// Slots of level 0; slot 0 everywhere while it is not done.
    pub base: Option<Arc<BaseSlots>>,
    /// `coarse[k]` holds level `k + 1`, `None` while it is not done.
    pub coarse: Vec<Option<Arc<MixtureLevel>>>,
    /// `colors[k]` holds the colours of level `k + 1`'s lobes, `None` while they are not done or there is no albedo.
    pub colors: Vec<Option<Arc<ColorLevel>>>,
}

impl LobePyramid {
    /// A pyramid of which nothing is fitted yet.
    pub fn unfitted(map: Arc<NormalMap>) -> Self {
        let levels = map.level_sizes().len();
        Self { map, base: None, coarse: vec![None; levels - 1], colors: vec![None; levels - 1] }
    }

    /// The map and the levels above its base in another pose; colours and slots stay behind.
    pub fn posed(&self, pose: Pose) -> Self {
        let coarse = self.coarse.iter().map(|level| level.as_ref().map(|level| level.posed(pose))).collect();
        Self { coarse, ..Self::unfitted(pose.map(&self.map)) }
    }

    /// Number of levels, the base counted.
    pub fn levels(&self) -> usize {
        self.coarse.len() + 1
    }

    /// The lobes of a level above the base, if they are fitted.
    pub fn level(&self, level: usize) -> Option<&Arc<MixtureLevel>> {
        self.coarse.get(level.checked_sub(1)?)?.as_ref()
    }

    /// The slot of a base texel's lobe.
    pub fn base_slot(&self, index: usize) -> usize {
        self.base.as_ref().map_or(0, |base| usize::from(base.slots[index]))
    }

    /// The lobe of a base texel, `(1, n)`; empty where the texel is invalid.
    pub fn base_lobe(&self, index: usize) -> StoredLobe {
        self.map.normal(index).map_or([0.0; 4], |n| [1.0, n.x, n.y, n.z])
    }

    /// The stored colour `alpha y` of a lobe above the base, by its place in [`MixtureLevel::stored`]; `alpha`, for
    /// white, while there is none.
    pub fn color(&self, level: usize, index: usize) -> Vec3 {
        let colors = level.checked_sub(1).and_then(|k| self.colors.get(k)?.as_ref());
        let white = || self.level(level).map_or(Vec3::ZERO, |mixtures| Vec3::splat(mixtures.stored[index][0]));
        colors.map_or_else(white, |colors| colors.stored[index].into())
    }

    /// The colour y of a texel's lobe; `None` for a map without colour and while it is not fitted.
    pub fn lobe_color(&self, texel: Texel, slot: usize) -> Option<Vec3> {
        self.map.albedo.as_ref()?;
        if texel.level == 0 {
            return Some(self.map.color(texel.y * self.map.width + texel.x));
        }
        self.colors.get(texel.level - 1)?.as_ref()?;
        let mixtures = self.level(texel.level)?;
        let index = (texel.y * mixtures.width + texel.x) * mixtures.lobes + slot;
        Some(self.color(texel.level, index) / mixtures.stored[index][0])
    }

    /// The mixture of one texel, if its level is fitted.
    pub fn mixture(&self, texel: Texel) -> Option<Mixture> {
        if texel.level > 0 {
            return Some(Mixture::from_stored(self.level(texel.level)?.texel(texel.x, texel.y)));
        }
        let index = texel.y * self.map.width + texel.x;
        let mut stored = vec![[0.0; 4]; self.base_slot(index) + 1];
        stored[self.base_slot(index)] = self.base_lobe(index);
        Some(Mixture::from_stored(&stored))
    }

    /// Most slots any level at hand uses.
    pub fn lobes(&self) -> usize {
        self.coarse.iter().flatten().map(|level| level.lobes).max().unwrap_or(1)
    }

    /// The finest and coarsest level that can be shown: a run of fitted levels that ends at the top.
    /// The base counts as soon as level 1 is there. `None` before anything is fitted.
    pub fn shown_levels(&self) -> Option<(usize, usize)> {
        let last = self.coarse.iter().rposition(Option::is_some)?;
        let first = (0..=last).rev().take_while(|&k| self.coarse[k].is_some()).last()?;
        Some((if first == 0 { 0 } else { first + 1 }, last + 1))
    }
}
