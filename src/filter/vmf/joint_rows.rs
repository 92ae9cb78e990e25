//! The steps of [`super::between`] for small footprints, a texel or a corner a lane, by [`super::channel_phi`]: with few
//! normals in a texel their looks need no directions, and the products of derivatives have a closed form.
//!
//! A row of texels lies in memory as lanes read it, the first texel's neighbour before it and the last one's behind,
//! so that the four texels of sixteen corners are four windows on two rows. Every squared residual is relative to the
//! true look's square, a corner's to the mean of its texels'; E is short of a constant.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use multiversion::multiversion;
use rayon::prelude::*;

use super::between::{CENTRE, IDLE, Joint, Level, moved};
use super::channel_lobes::ChannelLobes;
use super::channel_phi::{self, ChannelPhi};
use super::cholesky::MOST;
use super::corners::{line, lines, share};
use super::crowd;
use super::crowd_system::{CrowdSystem, EACH, Part};
use super::lanes::{LANES, Lanes, window};
use super::monitor::Cancelled;
use super::phi::pair_index;
use super::texel_row::TexelRow;
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;

const ZERO: Lanes = Lanes::splat(0.0);

/// Rows that one task works through: a line of corners is met twice where two tasks meet.
const ROWS: usize = 8;

/// Most normals of a footprint, those of level 3, with room for sizes that are no power of two: more cost more than
/// directions.
const MOST_NORMALS: usize = 100;

/// A level whose texels move together.
pub struct JointRows<'a> {
    level: Level<'a>,
    map: &'a NormalMap,
    /// The squares of the texels' true looks, a row after the other as rows lie.
    squares: Vec<f32>,
    /// The shares of a row's texels in the corner before each and behind it.
    across: [Vec<f32>; 2],
}

/// Room for a row of texels and the two lines of corners beside it.
pub struct Rows {
    /// The rows above and below the line of corners at hand.
    texels: [TexelRow; 2],
    /// Equations of the corners above and below, entry by entry.
    above: Vec<f32>,
    below: Vec<f32>,
    lobes: ChannelLobes,
    phi: ChannelPhi,
    /// For weights that keep their sum.
    together: [Part; MAX_LOBES],
}

impl<'a> JointRows<'a> {
    /// The level of `map`; `None` where its footprints are too large.
    pub fn new(map: &'a NormalMap, level: Level<'a>) -> Option<Self> {
        if !is_small(map, level.size) {
            return None;
        }
        let width = level.size.0;
        let across = |side| (0..width).map(|x| share(x, side, width, level.addressing)).chain([0.0; LANES]).collect();
        let mut own = Self { level, map, squares: Vec::new(), across: [across(0), across(1)] };
        let stride = own.stride();
        let mut squares = vec![0.0; stride * level.size.1];
        squares
            .par_chunks_mut(stride)
            .enumerate()
            .for_each_init(|| own.row(), |row, (y, squares)| own.square(y, row, squares));
        own.squares = squares;
        Some(own)
    }

    /// From one column of a row to the next.
    fn stride(&self) -> usize {
        TexelRow::stride(self.level.size.0)
    }

    /// Entries of the equations, of which E is none.
    fn entries(&self) -> usize {
        let slots = self.level.slots;
        EACH * slots + EACH * EACH * slots * (slots + 1) / 2
    }

    fn row(&self) -> TexelRow {
        let Level { size, slots, addressing, .. } = self.level;
        TexelRow::empty(self.map, size, slots, addressing)
    }

    /// The squares of the looks of row `y`.
    fn square(&self, y: usize, row: &mut TexelRow, squares: &mut [f32]) {
        row.read_normals(self.map, y);
        for x in (0..self.level.size.0).step_by(LANES) {
            let mut energy = ZERO;
            channel_phi::energy(&row.normals(x + 1), &mut energy);
            squares[x + 1..x + 1 + LANES].copy_from_slice(&energy.0);
        }
        row.close(squares);
    }

    /// The equations of the corners between the rows at hand, of texels `rows`; returns their part of E.
    fn corners(&self, rows_of: [usize; 2], rows: &mut Rows) -> f64 {
        let (stride, counted) = (self.stride(), lines(self.level.size.0, self.level.addressing));
        let mut energy = 0.0;
        for start in (0..counted).step_by(LANES) {
            let Rows { texels, below, lobes, phi, .. } = rows;
            let windows: [(usize, usize); 4] = std::array::from_fn(|i| (i / 2, start + i % 2));
            lobes.read(&windows.map(|(row, start)| (&texels[row].channels[..], start)), stride);
            phi.move_to(lobes, &windows.map(|(row, start)| texels[row].normals(start)));
            let squares = windows.map(|(row, start)| window(&self.squares, rows_of[row] * stride + start));
            let [a, b, c, d] = squares;
            let scale = Lanes(std::array::from_fn(|i| inverse(0.25 * (a[i] + b[i] + c[i] + d[i]))));
            let count = LANES.min(counted - start);
            energy += (0..count).map(|i| f64::from(scale.0[i] * phi.phi.0[i])).sum::<f64>();
            let mut at = start;
            for part in phi.system.parts() {
                write(part, &scale, below, at, stride);
                at += part.len() * stride;
            }
        }
        if self.level.addressing == Addressing::Wrap {
            rows.below.chunks_mut(stride).for_each(|column| column[counted] = column[0]);
        }
        energy
    }

    /// Adds a texel row's own equations and those of the corners around, as much as each is its, in
    /// `rows.phi.system`; returns the texels' own part of E.
    fn gather(&self, (x, y): (usize, usize), rows: &mut Rows) -> f64 {
        let ((width, height), stride, addressing) = (self.level.size, self.stride(), self.level.addressing);
        let Rows { texels, above, below, lobes, phi, .. } = rows;
        lobes.read(&[(&texels[0].channels[..], x + 1)], stride);
        phi.move_to(lobes, &[texels[0].normals(x + 1)]);
        let squares = window(&self.squares, y * stride + x + 1);
        let scale = Lanes(squares.map(|square| CENTRE * inverse(square)));
        let across = self.across.each_ref().map(|shares| window(shares, x));
        let down = [0, 1].map(|side| share(y, side, height, addressing));
        let shares: Shares = down.map(|down| across.map(|across| Lanes(across.map(|across| down * across))));
        let mut at = x;
        for part in phi.system.parts_mut() {
            add_shares(part, &scale, &shares, &[&above[..], &below[..]], at, stride);
            at += part.len() * stride;
        }
        (0..LANES.min(width - x)).map(|i| f64::from(scale.0[i] * phi.phi.0[i])).sum()
    }

    /// Solves the equations and takes the steps of the texels from `x` on; a texel stays where they have no answer.
    fn step(&self, from: &[StoredLobe], damping: f64, rows: &mut Rows, to: &mut [StoredLobe]) {
        let Rows { phi, together, .. } = rows;
        let system = &mut phi.system;
        damp(system, damping as f32, together);
        let solved = system.factor();
        let mut steps = system.right;
        system.substitute(&mut steps);
        system.substitute(together);
        let slots = self.level.slots;
        for (lane, (from, to)) in from.chunks_exact(slots).zip(to.chunks_exact_mut(slots)).enumerate() {
            to.copy_from_slice(from);
            let of = |parts: &[Part; MAX_LOBES], i: usize| f64::from(parts[i / EACH][i % EACH].0[lane]);
            let weight = |parts: &[Part; MAX_LOBES]| (0..slots).map(|j| of(parts, EACH * j)).sum::<f64>();
            let excess = weight(&steps) / weight(&*together);
            let mut step = [0.0; MOST];
            for (i, step) in step.iter_mut().enumerate().take(EACH * slots) {
                *step = of(&steps, i) - excess * of(&*together, i);
            }
            if solved[lane] && step.iter().all(|value| value.is_finite()) {
                moved(from, &step, to);
            }
        }
    }
}

impl Joint for JointRows<'_> {
    type Room = Rows;

    fn room(&self) -> Rows {
        let equations = || vec![0.0; self.entries() * self.stride()];
        Rows {
            texels: [self.row(), self.row()],
            above: equations(),
            below: equations(),
            lobes: ChannelLobes::empty(self.level.slots),
            phi: ChannelPhi::default(),
            together: [[ZERO; EACH]; MAX_LOBES],
        }
    }

    fn rows(&self) -> usize {
        ROWS
    }

    fn strip(
        &self,
        from: &[StoredLobe],
        top: usize,
        damping: Option<f64>,
        to: &mut [StoredLobe],
        rows: &mut Rows,
    ) -> Result<f64, Cancelled> {
        let ((width, height), slots, addressing) = (self.level.size, self.level.slots, self.level.addressing);
        let pair = line(top, height, addressing);
        pair.into_iter().zip(&mut rows.texels).for_each(|(y, row)| row.read(self.map, from, y));
        let mut energy = self.corners(pair, rows);
        let length = width * slots;
        let bottom = top + to.len() / length;
        for (y, to) in (top..).zip(to.chunks_mut(length)) {
            self.level.monitor.check()?;
            std::mem::swap(&mut rows.above, &mut rows.below);
            rows.texels.swap(0, 1);
            let pair = line(y + 1, height, addressing);
            rows.texels[1].read(self.map, from, pair[1]);
            let corners = self.corners(pair, rows);
            // The line below the strip is the next one's, but for the map's last where that has one of its own.
            if y + 1 < bottom || y + 1 == height && addressing == Addressing::Clamp {
                energy += corners;
            }
            let crowds = from[y * length..].chunks(LANES * slots).zip(to.chunks_mut(LANES * slots));
            for (index, (from, to)) in crowds.enumerate() {
                energy += self.gather((LANES * index, y), rows);
                if let Some(damping) = damping {
                    self.step(from, damping, rows, to);
                }
            }
        }
        Ok(energy)
    }
}

/// True where the footprints of a level of this size have few normals.
pub fn is_small(map: &NormalMap, size: (usize, usize)) -> bool {
    crowd::most_normals(map, size) <= MOST_NORMALS
}

/// The inverse of a square, 0 of nothing.
fn inverse(square: f32) -> f32 {
    if square > f32::MIN_POSITIVE { 1.0 / square } else { 0.0 }
}

/// The shares of texels in the corners around, by line and side.
type Shares = [[Lanes; 2]; 2];

/// Writes equations, in proportion, from `start` on and `stride` apart.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn write(part: &[Lanes], scale: &Lanes, corners: &mut [f32], start: usize, stride: usize) {
    for (entry, value) in part.iter().enumerate() {
        let out = &mut corners[start + entry * stride..][..LANES];
        for i in 0..LANES {
            out[i] = scale.0[i] * value.0[i];
        }
    }
}

/// Equations in proportion, and their shares of those of the corners, from `start` on and `stride` apart.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn add_shares(part: &mut [Lanes], scale: &Lanes, shares: &Shares, corners: &[&[f32]; 2], start: usize, stride: usize) {
    let [above, below] = corners;
    for (entry, value) in part.iter_mut().enumerate() {
        let at = start + entry * stride;
        let (a, b, c, d) = (window(above, at), window(above, at + 1), window(below, at), window(below, at + 1));
        for i in 0..LANES {
            let corners_above = shares[0][0].0[i] * a[i] + shares[0][1].0[i] * b[i];
            let corners_below = shares[1][0].0[i] * c[i] + shares[1][1].0[i] * d[i];
            value.0[i] = scale.0[i] * value.0[i] + corners_above + corners_below;
        }
    }
}

/// Raises the diagonals and sets the right sides: minus the gradient, and one for every weight. An unknown that is idle
/// is held.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn damp(system: &mut CrowdSystem, damping: f32, together: &mut [Part; MAX_LOBES]) {
    const LEAST: f32 = IDLE as f32;
    let CrowdSystem { count, tiles, right } = system;
    let mut largest = Lanes::splat(f32::MIN_POSITIVE);
    for j in 0..*count {
        let tile = &tiles[pair_index(j, j)];
        for i in 0..LANES {
            for p in 0..EACH {
                let diagonal = tile[p][p].0[i];
                largest.0[i] = if diagonal > largest.0[i] { diagonal } else { largest.0[i] };
            }
        }
    }
    for j in 0..*count {
        let tile = &mut tiles[pair_index(j, j)];
        let (mut steps, mut weights) = (right[j], [ZERO; EACH]);
        for i in 0..LANES {
            let least = LEAST * largest.0[i];
            for p in 0..EACH {
                let diagonal = tile[p][p].0[i];
                let idle = diagonal <= least;
                tile[p][p].0[i] = diagonal + damping * diagonal + least;
                steps[p].0[i] = if idle { 0.0 } else { -steps[p].0[i] };
                weights[p].0[i] = if idle || p > 0 { 0.0 } else { 1.0 };
            }
        }
        (right[j], together[j]) = (steps, weights);
    }
}

#[cfg(test)]
#[path = "joint_rows_tests.rs"]
mod tests;
