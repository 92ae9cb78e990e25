//! A preview with fewer lobes from the lobes at hand: surplus slots are merged into the ones that stay.

use glam::Vec3;

use super::Fold;
use super::pyramid::{LobePyramid, MixtureLevel};
use crate::normal_map::pyramid::Texel;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};
use crate::sphere::{Mixture, StoredLobe};

/// Texels that a level must have to speak for the map; the coarsest such level is asked.
const ENOUGH_TEXELS: usize = 64;

/// Merges each slot from `lobes` up into the lower slot that it is cheapest to merge with, everywhere the same so
/// that slots still mean the same thing from texel to texel. Slots below `lobes` stay as they are.
pub fn fewer_lobes(pyramid: &LobePyramid, lobes: usize) -> Fold {
    let mut fold = Fold::default();
    let levels = pyramid.coarse.iter().flatten();
    let Some(level) = levels.clone().rev().find(|l| l.width * l.height >= ENOUGH_TEXELS).or(levels.last()) else {
        return fold;
    };
    for slot in lobes..pyramid.lobes().min(MAX_LOBES) {
        let cost = |target: usize| merge_cost(level, slot, target);
        let cheapest = (0..lobes).min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        fold.0[slot] = cheapest.unwrap_or(0) as u8;
    }
    fold
}

/// Ward's cost of merging two slots, `aa ab / (aa + ab) |ra - rb|^2`, summed over a level's texels.
fn merge_cost(level: &MixtureLevel, a: usize, b: usize) -> f64 {
    if a >= level.lobes || b >= level.lobes {
        return 0.0;
    }
    let texels = level.stored.chunks_exact(level.lobes);
    texels
        .filter(|texel| texel[a][0] > EMPTY_WEIGHT && texel[b][0] > EMPTY_WEIGHT)
        .map(|texel| {
            let resultant = |s: [f32; 4]| Vec3::new(s[1], s[2], s[3]) / s[0];
            let (alpha_a, alpha_b) = (texel[a][0], texel[b][0]);
            let distance = resultant(texel[a]).distance_squared(resultant(texel[b]));
            f64::from(alpha_a * alpha_b / (alpha_a + alpha_b) * distance)
        })
        .sum()
}

/// The lobes of a texel with slots merged; `None` while its level is not fitted.
pub fn mixture(lobes: &LobePyramid, fold: Fold, texel: Texel) -> Option<Mixture> {
    let mut folded = [[0.0; 4]; MAX_LOBES];
    let mut add = |slot: usize, stored: StoredLobe| {
        let target = &mut folded[usize::from(fold.0[slot])];
        *target = std::array::from_fn(|i| target[i] + stored[i]);
    };
    if texel.level == 0 {
        let index = texel.y * lobes.map.width + texel.x;
        add(lobes.base_slot(index), lobes.base_lobe(index));
    } else {
        let level = lobes.level(texel.level)?;
        level.texel(texel.x, texel.y).iter().enumerate().for_each(|(slot, &stored)| add(slot, stored));
    }
    Some(Mixture::from_stored(&folded))
}
