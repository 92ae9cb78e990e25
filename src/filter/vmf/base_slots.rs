//! The level-0 rule: which slot each base texel's only lobe sits in.
//!
//! A base texel is one normal, `alpha = 1` in one slot, `r = n`. The slot is the one of least merge cost
//! `aa ab / (aa + ab) |ra - rb|^2` (an empty slot costs 0) against the four level-1 texels around, of total weight
//! 4, and the eight neighbours, of weight 1 and 1/4: one pass over visited neighbours only, then three full sweeps,
//! in the order of [`diagonals`].

use glam::Vec3;
use rayon::prelude::*;

use super::monitor::{Cancelled, Monitor};
use super::pyramid::{BaseSlots, LobePyramid, MixtureLevel};
use super::scanline::diagonals;
use super::smooth::{coarse_taps, neighbour};
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Full sweeps after the first pass.
const SWEEPS: usize = 3;

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
    let mut slots = vec![UNVISITED; map.len()];
    let mut chosen = Vec::new();
    for _ in 0..=SWEEPS {
        diagonals(map.width, map.height, |texels| {
            if monitor.is_cancelled() {
                return;
            }
            let choose = |&texel: &(usize, usize)| best_slot(lobes, coarse, &slots, texel);
            if texels.len() < 64 {
                chosen.clear();
                chosen.extend(texels.iter().map(choose));
            } else {
                texels.par_iter().with_min_len(32).map(choose).collect_into_vec(&mut chosen);
            }
            texels.iter().zip(&chosen).for_each(|(&(x, y), &slot)| slots[y * map.width + x] = slot);
        });
        monitor.check()?;
        monitor.visited(0, (map.len() / (SWEEPS + 1)) as u64);
    }
    Ok(BaseSlots { slots })
}

fn best_slot(lobes: &LobePyramid, coarse: &MixtureLevel, slots: &[u8], (x, y): (usize, usize)) -> u8 {
    let map = &lobes.map;
    let addressing = map.options.addressing;
    let Some(normal) = map.normal(y * map.width + x) else { return 0 };
    let mut cost = [0.0_f32; MAX_LOBES];
    for (index, weight) in coarse_taps(coarse, (map.width, map.height), (x, y), addressing) {
        let start = index * coarse.lobes;
        for (slot, stored) in coarse.stored[start..start + coarse.lobes].iter().enumerate() {
            cost[slot] += COARSE_WEIGHT * weight * merge_cost(normal, *stored);
        }
    }
    for dy in -1..=1 {
        for dx in -1..=1 {
            let column = neighbour(x, dx, map.width, addressing);
            let row = neighbour(y, dy, map.height, addressing);
            let (Some(column), Some(row), true) = (column, row, (dx, dy) != (0, 0)) else { continue };
            let index = row * map.width + column;
            if let (slot @ 0..16, Some(other)) = (usize::from(slots[index]), map.normal(index)) {
                let weight = if dx == 0 || dy == 0 { 1.0 } else { 0.25 };
                cost[slot] += weight * 0.5 * normal.distance_squared(other);
            }
        }
    }
    let least = (0..coarse.lobes).min_by(|&a, &b| cost[a].total_cmp(&cost[b]));
    least.unwrap_or(0) as u8
}

/// What merging the lobe `(1, normal)` with a stored one would cost.
fn merge_cost(normal: Vec3, stored: [f32; 4]) -> f32 {
    let alpha = stored[0];
    if alpha < EMPTY_WEIGHT {
        return 0.0;
    }
    let resultant = Vec3::new(stored[1], stored[2], stored[3]) / alpha;
    alpha / (1.0 + alpha) * normal.distance_squared(resultant)
}
