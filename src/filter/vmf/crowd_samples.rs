//! The normals of small footprints, [`LANES`] texels at once: a texel a lane.

use std::cell::RefCell;

use super::kernel;
use super::lanes::{LANES, Lanes};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;

/// Most normals of a footprint that joins a crowd: those of level 4, with room for sizes that are no power of two.
pub const MOST_NORMALS: usize = 324;

/// The normals of a crowd's texels, the first of every texel before the second of any.
pub struct CrowdSamples {
    pub(super) x: Box<[Lanes]>,
    pub(super) y: Box<[Lanes]>,
    pub(super) z: Box<[Lanes]>,
    pub(super) w: Box<[Lanes]>,
    /// Normals of the largest footprint.
    pub(super) len: usize,
    /// Room for the E-step.
    pub(super) scratch: Box<kernel::Scratch>,
}

thread_local! {
    static SAMPLES: RefCell<CrowdSamples> = RefCell::default();
}

/// The most normals that a footprint of a level of size `size` may have; those whose boxes cut base texels reach one
/// further on either side.
pub fn most_normals(map: &NormalMap, size: (usize, usize)) -> usize {
    let along = |base: usize, count: usize| if base.is_multiple_of(count) { base / count } else { base / count + 2 };
    along(map.width, size.0) * along(map.height, size.1)
}

/// Gathers the normals of the `count` texels from `first` on of a level of size `size`, row by row, and shows them to
/// `visit`, with their footprints; `None` where footprints of the level may be too large for a crowd.
pub fn with_crowd<R>(
    map: &NormalMap,
    size: (usize, usize),
    first: usize,
    count: usize,
    visit: impl FnOnce(&mut CrowdSamples, &[Footprint]) -> R,
) -> Option<R> {
    if most_normals(map, size) > MOST_NORMALS {
        return None;
    }
    let footprint = |index: usize| Footprint::new((map.width, map.height), size, (index % size.0, index / size.0));
    let mut footprints = [footprint(first); LANES];
    let footprints = &mut footprints[..count.min(LANES)];
    footprints.iter_mut().enumerate().for_each(|(lane, own)| *own = footprint(first + lane));
    Some(SAMPLES.with_borrow_mut(|samples| {
        samples.gather(map, footprints);
        visit(samples, footprints)
    }))
}

impl Default for CrowdSamples {
    fn default() -> Self {
        let zeros = || vec![Lanes::splat(0.0); MOST_NORMALS].into_boxed_slice();
        let scratch = Box::new(kernel::Scratch::EMPTY);
        Self { x: zeros(), y: zeros(), z: zeros(), w: zeros(), len: 0, scratch }
    }
}

impl CrowdSamples {
    /// x components, the first normal of every texel before the second of any.
    pub fn x(&self) -> &[Lanes] {
        &self.x[..self.len]
    }

    /// y components.
    pub fn y(&self) -> &[Lanes] {
        &self.y[..self.len]
    }

    /// z components.
    pub fn z(&self) -> &[Lanes] {
        &self.z[..self.len]
    }

    /// Weights, 0 where a texel has no such normal.
    pub fn w(&self) -> &[Lanes] {
        &self.w[..self.len]
    }

    /// Takes in the normals of at most [`LANES`] footprints of at most [`MOST_NORMALS`] each.
    fn gather(&mut self, map: &NormalMap, footprints: &[Footprint]) {
        self.len = footprints.iter().map(Footprint::len).max().unwrap_or(0).min(MOST_NORMALS);
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.w] {
            array[..self.len].fill(Lanes::splat(0.0));
        }
        for (lane, footprint) in footprints.iter().enumerate().take(LANES) {
            self.gather_lane(map, lane, footprint);
        }
    }

    /// Takes in one texel's normals, row by row and axis by axis.
    fn gather_lane(&mut self, map: &NormalMap, lane: usize, footprint: &Footprint) {
        let (columns, whole) = (footprint.columns.start..footprint.columns.end, footprint.is_whole());
        for (row, y) in (footprint.rows.start..footprint.rows.end).enumerate() {
            let places = row * columns.len()..(row + 1) * columns.len();
            let normals = y * map.width + columns.start..y * map.width + columns.end;
            for (lanes, axis) in [(&mut self.x, &map.x), (&mut self.y, &map.y), (&mut self.z, &map.z)] {
                let values = lanes[places.clone()].iter_mut().zip(&axis[normals.clone()]);
                values.for_each(|(lanes, &value)| lanes.0[lane] = value);
            }
            for (lanes, x) in self.w[places].iter_mut().zip(columns.clone()) {
                lanes.0[lane] = if whole { 1.0 } else { footprint.weight(x, y) };
            }
        }
        if map.invalid > 0 {
            for n in 0..footprint.len() {
                // An invalid texel is a zero vector.
                let invalid = [&self.x, &self.y, &self.z].iter().all(|axis| axis[n].0[lane] == 0.0);
                self.w[n].0[lane] = if invalid { 0.0 } else { self.w[n].0[lane] };
            }
        }
    }
}

/// Shows every normal of a footprint to `visit`, with its place among them and its weight: 0 for an invalid texel, which
/// is a zero vector.
pub fn each_normal(map: &NormalMap, footprint: &Footprint, mut visit: impl FnMut(usize, [f32; 3], f32)) {
    let (columns, whole) = (footprint.columns.start..footprint.columns.end, footprint.is_whole());
    let mut n = 0;
    for y in footprint.rows.start..footprint.rows.end {
        let row = y * map.width + columns.start..y * map.width + columns.end;
        let normals = map.x[row.clone()].iter().zip(&map.y[row.clone()]).zip(&map.z[row]);
        for (x, ((&nx, &ny), &nz)) in columns.clone().zip(normals) {
            let area = if whole { 1.0 } else { footprint.weight(x, y) };
            visit(n, [nx, ny, nz], if (nx, ny, nz) == (0.0, 0.0, 0.0) { 0.0 } else { area });
            n += 1;
        }
    }
}
