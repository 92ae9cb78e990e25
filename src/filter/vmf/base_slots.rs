//! The level-0 rule: which slot each base texel's only lobe sits in.
//!
//! A base texel is one normal, `alpha = 1` in one slot, `r = n`. The slot is the one of least merge cost
//! `aa ab / (aa + ab) |ra - rb|^2` (an empty slot costs 0) against the four level-1 texels around, of total weight
//! 4, and the eight neighbours, of weight 1 and 1/4: one pass over visited neighbours only, then three full sweeps,
//! in the order of [`diagonals`].

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::monitor::{Cancelled, Monitor};
use super::pyramid::{BaseSlots, LobePyramid, MixtureLevel};
use super::scanline::diagonals;
use super::smooth::{coarse_taps, neighbour};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Full sweeps after the first pass.
const SWEEPS: usize = 3;

/// Texels of a diagonal that one thread has chosen for before another would have woken up.
const ALONE: usize = 256;

/// Total weight of the level-1 texels around, against 1 for an edge neighbour.
const COARSE_WEIGHT: f32 = 4.0;

/// A slot that no pass has chosen yet.
const UNVISITED: u8 = u8::MAX;

/// Slot 0 for every base texel: for lobes that are not aligned, or alone.
pub fn first(texels: usize) -> BaseSlots {
    BaseSlots { slots: vec![0; texels] }
}

/// Chooses every base texel's slot; the first everywhere for a map of one level or a fit of one lobe.
pub fn choose(lobes: &LobePyramid, monitor: &Monitor) -> Result<BaseSlots, Cancelled> {
    let map = &lobes.map;
    let Some(coarse) = lobes.level(1).filter(|coarse| coarse.lobes > 1) else {
        return Ok(first(map.len()));
    };
    // On a thread of the pool: a diagonal at a time, one from outside would wake it up thousands of times.
    rayon::scope(|_| sweep(lobes, coarse, monitor))
}

fn sweep(lobes: &LobePyramid, coarse: &MixtureLevel, monitor: &Monitor) -> Result<BaseSlots, Cancelled> {
    let map = &lobes.map;
    let pull = CoarseCosts::new(coarse);
    let mut slots = vec![UNVISITED; map.len()];
    let mut chosen = Vec::new();
    for _ in 0..=SWEEPS {
        diagonals(map.width, map.height, |texels| {
            if monitor.is_cancelled() {
                return;
            }
            let choose = |&texel: &(usize, usize)| best_slot(lobes, &pull, &slots, texel);
            if texels.len() < ALONE {
                chosen.clear();
                chosen.extend(texels.iter().map(choose));
            } else {
                texels.par_iter().with_min_len(ALONE / 2).map(choose).collect_into_vec(&mut chosen);
            }
            texels.iter().zip(&chosen).for_each(|(&(x, y), &slot)| slots[y * map.width + x] = slot);
        });
        monitor.check()?;
        monitor.visited(0, (map.len() / (SWEEPS + 1)) as u64);
    }
    Ok(BaseSlots { slots })
}

fn best_slot(lobes: &LobePyramid, pull: &CoarseCosts<'_>, slots: &[u8], (x, y): (usize, usize)) -> u8 {
    let map = &lobes.map;
    let addressing = map.options.addressing;
    let Some(normal) = map.normal(y * map.width + x) else { return 0 };
    let taps = coarse_taps(pull.level, (map.width, map.height), (x, y), addressing);
    let mut cost = pull.costs(normal, &taps);
    for dy in -1..=1 {
        let Some(row) = neighbour(y, dy, map.height, addressing) else { continue };
        for dx in -1..=1 {
            let (Some(column), true) = (neighbour(x, dx, map.width, addressing), (dx, dy) != (0, 0)) else { continue };
            let index = row * map.width + column;
            if let (slot @ 0..16, Some(other)) = (usize::from(slots[index]), map.normal(index)) {
                let weight = if dx == 0 || dy == 0 { 1.0 } else { 0.25 };
                cost[slot] += weight * 0.5 * normal.distance_squared(other);
            }
        }
    }
    let least = (0..pull.level.lobes).min_by(|&a, &b| cost[a].total_cmp(&cost[b]));
    least.unwrap_or(0) as u8
}

/// What merging the lobe `(1, n)` with each lobe of level 1 would cost, as a function of n.
///
/// `a / (1 + a) |n - r|^2` is, for a unit vector, `c0 - c.n` with `c0 = a / (1 + a) (1 + |r|^2)` and
/// `c = 2 a / (1 + a) r`: blends of such functions are blends of four numbers.
struct CoarseCosts<'a> {
    level: &'a MixtureLevel,
    /// `(c, c0)`, in the order of the level's lobes; zeros for an empty slot, with which a merge is free.
    linear: Vec<Vec4>,
}

impl<'a> CoarseCosts<'a> {
    fn new(level: &'a MixtureLevel) -> Self {
        Self { level, linear: level.stored.par_iter().map(|&stored| linear_cost(stored)).collect() }
    }

    /// The cost of each slot of the blend of texels `taps`.
    fn costs(&self, normal: Vec3, taps: &[(usize, f32); 4]) -> [f32; MAX_LOBES] {
        let count = self.level.lobes;
        let mut costs = [0.0; MAX_LOBES];
        let of = taps.map(|(index, _)| &self.linear[index * count..(index + 1) * count]);
        for (slot, cost) in costs.iter_mut().enumerate().take(count) {
            let linear: Vec4 = of.iter().zip(taps).map(|(of, tap)| tap.1 * of[slot]).sum();
            *cost = COARSE_WEIGHT * (linear.w - linear.truncate().dot(normal));
        }
        costs
    }
}

fn linear_cost([alpha, x, y, z]: StoredLobe) -> Vec4 {
    if alpha < EMPTY_WEIGHT {
        return Vec4::ZERO;
    }
    let resultant = Vec3::new(x, y, z) / alpha;
    let factor = alpha / (1.0 + alpha);
    (2.0 * factor * resultant).extend(factor * (1.0 + resultant.length_squared()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_linear_cost_is_the_merge_cost() {
        let normal = Vec3::new(0.3, -0.2, 0.9).normalize();
        for stored in [[0.4, 0.1, 0.05, 0.3], [1.0, 0.0, 0.0, 1.0], [0.0; 4]] {
            let linear = linear_cost(stored);
            let cost = linear.w - linear.truncate().dot(normal);
            let resultant = Vec3::new(stored[1], stored[2], stored[3]) / stored[0].max(EMPTY_WEIGHT);
            let exact = stored[0] / (1.0 + stored[0]) * normal.distance_squared(resultant);
            assert!((cost - exact).abs() < 1e-6, "{cost} {exact}");
        }
    }
}
