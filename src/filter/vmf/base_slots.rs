//! The level-0 rule: which slot each base texel's only lobe sits in.
//!
//! A base texel is one normal, `alpha = 1` in one slot, `r = n`. The slot is the one of least merge cost
//! `aa ab / (aa + ab) |ra - rb|^2` (an empty slot costs 0) against the four level-1 texels around, of total weight
//! 4, and the eight neighbours, of weight 1 and 1/4: one pass over visited neighbours only, then three full sweeps.
//!
//! Texels come in scanline order but for where the map tiles. Sheared by `x + y`, no texel's visited neighbours lie to
//! its right or below, so blocks of a sheared map can be chosen for a diagonal at a time.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::monitor::{Cancelled, Monitor};
use super::pyramid::{BaseSlots, LobePyramid, MixtureLevel};
use super::smooth::{coarse_taps, neighbour};
use crate::normal_map::NormalMap;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Full sweeps after the first pass.
const SWEEPS: usize = 3;

/// Texels along each side of a block.
const SIDE: usize = 32;

/// The neighbours by `x + y + 2` and `y + 1`, edge neighbours whole and diagonal ones a quarter.
const NEIGHBOURS: [(usize, usize, f32); 8] =
    [(0, 0, 0.25), (1, 0, 1.0), (2, 0, 0.25), (1, 1, 1.0), (3, 1, 1.0), (2, 2, 0.25), (3, 2, 1.0), (4, 2, 0.25)];

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
    let sweep = Sweep { map, pull: CoarseCosts::new(coarse) };
    let mut slots = vec![UNVISITED; map.len()];
    for _ in 0..=SWEEPS {
        sweep.run(&mut slots, monitor)?;
        monitor.visited(0, (map.len() / (SWEEPS + 1)) as u64);
    }
    Ok(BaseSlots { slots })
}

/// A pass over all base texels.
struct Sweep<'a> {
    map: &'a NormalMap,
    pull: CoarseCosts<'a>,
}

/// A block of texels, `x + y` from `first.0` on and `y` from `first.1` on, with those around.
struct Window {
    slots: [[u8; SIDE + 4]; SIDE + 2],
    normals: [[Vec3; SIDE + 4]; SIDE + 2],
}

impl Sweep<'_> {
    /// Chooses anew, block after block; those of a diagonal do not touch, and are chosen at once.
    fn run(&self, slots: &mut [u8], monitor: &Monitor) -> Result<(), Cancelled> {
        let (width, height) = (self.map.width, self.map.height);
        let (columns, rows) = ((width + height - 1).div_ceil(SIDE), height.div_ceil(SIDE));
        for diagonal in 0..columns + rows - 1 {
            monitor.check()?;
            let blocks = (diagonal + 1).saturating_sub(columns)..rows.min(diagonal + 1);
            let block = |row: usize| self.block((SIDE * (diagonal - row), SIDE * row), slots);
            let chosen: Vec<Vec<(usize, u8)>> = blocks.into_par_iter().map(block).collect();
            chosen.into_iter().flatten().for_each(|(index, slot)| slots[index] = slot);
        }
        Ok(())
    }

    /// The choices in the block from `first` on, in the order of rows.
    fn block(&self, first: (usize, usize), slots: &[u8]) -> Vec<(usize, u8)> {
        let map = self.map;
        let inside = |y: usize| first.0.max(y)..(first.0 + SIDE).min(y + map.width);
        let rows = first.1..(first.1 + SIDE).min(map.height);
        if rows.clone().all(|y| inside(y).is_empty()) {
            return Vec::new();
        }
        let mut window = self.window(first, slots);
        let mut chosen = Vec::with_capacity(SIDE * SIDE);
        for y in rows {
            for u in inside(y) {
                let slot = self.best_slot(&window, (u - first.0 + 2, y - first.1 + 1), (u - y, y));
                window.slots[y - first.1 + 1][u - first.0 + 2] = slot;
                chosen.push((y * map.width + u - y, slot));
            }
        }
        chosen
    }

    /// The slots and normals of a block and around it; nothing beyond an edge that does not wrap.
    fn window(&self, first: (usize, usize), slots: &[u8]) -> Window {
        let (map, addressing) = (self.map, self.map.options.addressing);
        let mut window =
            Window { slots: [[UNVISITED; SIDE + 4]; SIDE + 2], normals: [[Vec3::ZERO; SIDE + 4]; SIDE + 2] };
        for (v, (slots_here, normals_here)) in window.slots.iter_mut().zip(&mut window.normals).enumerate() {
            let y = first.1 as i64 + v as i64 - 1;
            let Some(row) = neighbour(0, y, map.height, addressing) else { continue };
            for (u, (slot, normal)) in slots_here.iter_mut().zip(normals_here).enumerate() {
                let x = first.0 as i64 + u as i64 - 2 - y;
                let Some(column) = neighbour(0, x, map.width, addressing) else { continue };
                let index = row * map.width + column;
                if let Some(valid) = map.normal(index) {
                    (*slot, *normal) = (slots[index], valid);
                }
            }
        }
        window
    }

    /// The slot of least cost for texel `(x, y)`, which is at `(u, v)` of the window.
    fn best_slot(&self, window: &Window, (u, v): (usize, usize), (x, y): (usize, usize)) -> u8 {
        let normal = window.normals[v][u];
        if normal == Vec3::ZERO {
            return 0;
        }
        let size = (self.map.width, self.map.height);
        let taps = coarse_taps(self.pull.level, size, (x, y), self.map.options.addressing);
        let mut cost = self.pull.costs(normal, &taps);
        for (du, dv, weight) in NEIGHBOURS {
            let (u, v) = (u + du - 2, v + dv - 1);
            if let Some(cost) = cost.get_mut(usize::from(window.slots[v][u])) {
                *cost += weight * 0.5 * normal.distance_squared(window.normals[v][u]);
            }
        }
        let least = (0..self.pull.level.lobes).min_by(|&a, &b| cost[a].total_cmp(&cost[b]));
        least.unwrap_or(0) as u8
    }
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
    use crate::normal_map::{Addressing, procedural};

    /// The slots of a map that does not tile, texel after texel in scanline order.
    fn plainly(sweep: &Sweep<'_>) -> Vec<u8> {
        let map = sweep.map;
        let size = (map.width, map.height);
        let mut slots = vec![UNVISITED; map.len()];
        for (_, y, x) in (0..=SWEEPS).flat_map(|s| (0..size.1).flat_map(move |y| (0..size.0).map(move |x| (s, y, x)))) {
            let Some(normal) = map.normal(y * size.0 + x) else { continue };
            let mut cost = sweep.pull.costs(normal, &coarse_taps(sweep.pull.level, size, (x, y), Addressing::Clamp));
            for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))).filter(|&offset| offset != (0, 0))
            {
                let at = |index, offset, size| neighbour(index, offset, size, Addressing::Clamp);
                let (Some(x), Some(y)) = (at(x, dx, size.0), at(y, dy, size.1)) else { continue };
                let (slot, other) = (slots[y * size.0 + x], map.normal(y * size.0 + x));
                if let (Some(other), true) = (other, slot != UNVISITED) {
                    let weight = if dx == 0 || dy == 0 { 1.0 } else { 0.25 };
                    cost[usize::from(slot)] += weight * 0.5 * normal.distance_squared(other);
                }
            }
            let least = (0..sweep.pull.level.lobes).min_by(|&a, &b| cost[a].total_cmp(&cost[b]));
            slots[y * size.0 + x] = least.unwrap_or(0) as u8;
        }
        slots
    }

    #[test]
    fn blocks_come_to_what_a_scanline_comes_to() {
        let mut map = procedural::find("bricks").expect("bundled").make(101);
        map.options.addressing = Addressing::Clamp;
        let mut coarse = MixtureLevel::empty(map.level_size(1), 3);
        for (index, stored) in coarse.stored.iter_mut().enumerate() {
            let mu = map.normal(index % map.len()).expect("valid");
            *stored = (mu * 0.3).extend(0.32).to_array();
            stored.rotate_right(1);
        }
        let sweep = Sweep { map: &map, pull: CoarseCosts::new(&coarse) };
        let mut slots = vec![UNVISITED; map.len()];
        let monitor = Monitor::new(vec![0]);
        (0..=SWEEPS).for_each(|_| sweep.run(&mut slots, &monitor).expect("nobody cancels"));
        assert_eq!(slots, plainly(&sweep));
    }

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
