//! The normals of a coarse footprint, gathered in cells of the sphere: many of them are nearly equal, and an E-step
//! over their means costs a fraction.
//!
//! The sphere is mapped to a square of 128 by 128 cells by the octahedral projection (Meyer et al. 2010), cells
//! 1.6 degrees across. A cell keeps its weight and the plain mean of its normals, whose length stays below 1: a
//! lobe's log-density is linear in the normal, so the mean gives the cell's mean log-density exactly, and the sums of
//! the M-step keep their first moments. What is lost is only that responsibilities are shared by a whole cell.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::kernel::SampleSlices;
use super::lanes::LANES;
use super::samples::{Partial, Samples};
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;

/// Cells along each side of the square: 64 lose a little of the likelihood, 256 save no time.
const SIDE: usize = 128;

/// Footprints of fewer normals than this, level 5 of a power of two, are not worth gathering.
pub const WORTHWHILE: usize = 1024;

/// Rows of a large footprint are gathered in this many strips at once.
const STRIPS: usize = 16;

/// Footprints of at least this many normals are gathered in strips.
const LARGE: usize = 65_536;

/// A cell that holds a normal.
#[derive(Clone, Copy, Debug)]
struct Cell {
    key: u16,
    weight: f64,
    sum: DVec3,
    /// `sum w |n|^2`, so that equal normals have a spread of exactly 0 in spite of their rounded lengths.
    squares: f64,
}

/// The occupied cells, in the order in which they were first met.
struct Cells {
    occupied: Vec<Cell>,
    /// One past the place in `occupied` of every key; 0 where there is none.
    place: Vec<u16>,
}

impl Cells {
    fn new() -> Self {
        Self { occupied: Vec::new(), place: vec![0; SIDE * SIDE] }
    }

    fn add(&mut self, cell: Cell) {
        let place = &mut self.place[usize::from(cell.key)];
        if *place == 0 {
            self.occupied.push(cell);
            *place = self.occupied.len() as u16;
            return;
        }
        let own = &mut self.occupied[usize::from(*place) - 1];
        own.weight += cell.weight;
        own.sum += cell.sum;
        own.squares += cell.squares;
    }

    fn gather(map: &NormalMap, footprint: &Footprint, rows: std::ops::Range<usize>) -> Self {
        let mut cells = Self::new();
        for y in rows {
            for x in footprint.columns.start..footprint.columns.end {
                let Some(normal) = map.normal(y * map.width + x) else { continue };
                let weight = f64::from(footprint.weight(x, y));
                let precise = normal.as_dvec3();
                let squares = weight * precise.length_squared();
                cells.add(Cell { key: key_of(normal), weight, sum: weight * precise, squares });
            }
        }
        cells
    }
}

/// The cell of a unit normal.
fn key_of(n: Vec3) -> u16 {
    let scale = 1.0 / (n.x.abs() + n.y.abs() + n.z.abs());
    let (mut u, mut v) = (n.x * scale, n.y * scale);
    if n.z < 0.0 {
        (u, v) = ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v));
    }
    let cell = |t: f32| (((t * 0.5 + 0.5) * SIDE as f32) as usize).min(SIDE - 1);
    (cell(v) * SIDE + cell(u)) as u16
}

/// A footprint's normals by cell, as the loops read them.
#[derive(Clone, Debug)]
pub struct BinnedSamples {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    w: Vec<f32>,
    spread: Vec<f32>,
}

impl BinnedSamples {
    /// Gathers every valid normal of `footprint`.
    pub fn new(map: &NormalMap, footprint: &Footprint) -> Self {
        let (top, bottom) = (footprint.rows.start, footprint.rows.end);
        if footprint.len() < LARGE {
            return Self::of_cells(&Cells::gather(map, footprint, top..bottom).occupied);
        }
        let edge = |strip: usize| top + (bottom - top) * strip / STRIPS;
        let strip = |strip: usize| Cells::gather(map, footprint, edge(strip)..edge(strip + 1)).occupied;
        let strips: Vec<Vec<Cell>> = (0..STRIPS).into_par_iter().map(strip).collect();
        let mut cells = Cells::new();
        strips.into_iter().flatten().for_each(|cell| cells.add(cell));
        Self::of_cells(&cells.occupied)
    }

    fn of_cells(cells: &[Cell]) -> Self {
        let padded = cells.len().next_multiple_of(LANES);
        let zeros = || vec![0.0; padded];
        let mut samples = Self { x: zeros(), y: zeros(), z: zeros(), w: zeros(), spread: zeros() };
        for (i, cell) in cells.iter().enumerate() {
            let mean = cell.sum / cell.weight;
            (samples.x[i], samples.y[i], samples.z[i]) = mean.as_vec3().into();
            samples.w[i] = cell.weight as f32;
            samples.spread[i] = (cell.squares / cell.weight - mean.length_squared()).max(0.0) as f32;
        }
        samples
    }

    /// The cells, padded with empty ones.
    pub fn slices(&self) -> SampleSlices<'_> {
        SampleSlices { x: &self.x, y: &self.y, z: &self.z, w: &self.w, spread: &self.spread }
    }

    /// Cells that hold a normal.
    pub fn occupied(&self) -> usize {
        self.w.iter().filter(|&&w| w > 0.0).count()
    }

    /// Cells that hold a normal, rounded up to whole lanes.
    pub fn len(&self) -> usize {
        self.w.len()
    }

    /// True where the footprint had no valid normal.
    pub fn is_empty(&self) -> bool {
        self.w.is_empty()
    }
}

impl Samples for BinnedSamples {
    fn sum<S: Partial>(&self, visit: impl Fn(&SampleSlices, &mut S) + Sync) -> S {
        let mut sums = S::default();
        visit(&self.slices(), &mut sums);
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    #[test]
    fn bins_keep_the_weight_and_the_mean_and_never_lengthen_it() {
        let map = procedural::find("bricks").expect("bundled").make(300);
        for (level, footprint) in
            [(5, Footprint::new((300, 300), (9, 9), (3, 4))), (8, Footprint::new((300, 300), (1, 1), (0, 0)))]
        {
            let bins = BinnedSamples::new(&map, &footprint);
            assert!(bins.len() < footprint.len() / 2, "level {level}: {} cells", bins.len());
            let (mut weight, mut mean) = (0.0, DVec3::ZERO);
            for i in 0..bins.len() {
                let cell = Vec3::new(bins.x[i], bins.y[i], bins.z[i]);
                assert!(cell.length() < 1.0 + 1e-6 && bins.spread[i] >= 0.0);
                weight += f64::from(bins.w[i]);
                mean += f64::from(bins.w[i]) * cell.as_dvec3();
            }
            let mut exact = (0.0, DVec3::ZERO);
            for (x, y, area) in footprint.texels() {
                exact.0 += f64::from(area);
                exact.1 += f64::from(area) * map.normal(y * 300 + x).expect("valid").as_dvec3();
            }
            assert!((weight / exact.0 - 1.0).abs() < 1e-6);
            assert!((mean / weight - exact.1 / exact.0).length() < 1e-6);
        }
    }
}
