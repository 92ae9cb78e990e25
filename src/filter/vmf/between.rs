//! Steps of all texels of a level together that mend what hardware interpolation shows between them.
//!
//! `E = sum_texels w |look(x_t) - L_t|^2 / |L_t|^2 + sum_corners |look(x_c) - L_c|^2 / |L_c|^2`
//!
//! x are the stored channels, L the true looks ([`super::looks`]); at a corner, where four texels meet, both are the
//! mean of the four. For Gauss-Newton's quadratic model of a corner, Jensen's inequality gives
//! `(sum d_t/4)' H_c (sum d_t/4) <= sum d_t' H_c d_t / 4`: a bound that falls apart into texels, so all of them move
//! at once, each by `(w H_t + sum H_c/4) d_t = -(w g_t + sum g_c/4)`, `sum d_alpha = 0`, and no order matters. Weights
//! are kept at 0 or above and `|alpha r| <= alpha`. A round is kept only if E falls.
//!
//! Twenty smooth passes alone err 3.1 times as much half way between texels as unaligned shading (2.6 times half way
//! between levels), as mean over six maps at s = 64; ten and these rounds 2.3 and 2.0 times, at a little more time.
//! Coarse levels pay most, for the finer ones are seeded from them. Places half way to the coarser level as a third
//! term gained nothing; texels refined alone make the corners worse; 4x4 blocks in place of whole matrices gain half as
//! much in four rounds. Only s = 64 is looked at: at s = 400 texels err more, corners as before. The mean normal is no
//! longer exact, as in every fit for the shaded look.

use rayon::prelude::*;

use super::alignment::Alignment;
use super::cholesky::{self, MOST, Matrix};
use super::fit::FitSettings;
use super::looks::{self, Looks};
use super::monitor::{Cancelled, Monitor};
use super::objective::Objective;
use super::pyramid::MixtureLevel;
use super::residual::{EACH, Residual, equations_len, products_start};
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;

/// What a texel's centre counts against a corner.
const CENTRE: f32 = 0.5;

/// Rounds of level 2, doubled from level to level: a level has a quarter of the finer one's texels.
const FEWEST_ROUNDS: usize = 2;

/// Most rounds of a level.
const MOST_ROUNDS: usize = 32;

/// Marquardt's damping of level 2 at first, in proportion to the diagonal; a thirtieth from level to level: few normals
/// make sharp lobes, of which the quadratic model knows little.
const DAMPING: f64 = 1e-1;

/// The least damping of a first round.
const FIRST_DAMPING: f64 = 1e-4;

/// Factor on the damping after a round that is kept, down to [`LEAST_DAMPING`].
const EASED: f64 = 0.5;

/// The least damping: single precision knows the matrix no better.
const LEAST_DAMPING: f64 = 1e-5;

/// Factor on the damping after a round that is not.
const RAISED: f64 = 8.0;

/// The mean length up to which a step may sharpen a lobe, kappa 2000: what is sharper looks the same at s = 64, and would
/// be a glint that is not there under a sharper material.
const LONGEST: f64 = 1.0 - 1.0 / 2000.0;

/// What an unknown's share of the largest on the diagonal is to count as one.
const IDLE: f64 = 1e-6;

/// Rows of texels that one task works through are a level's height over this, so that few corners are met twice.
const TASKS: usize = 16;

/// True where a fit takes these steps: with one lobe there is nothing to align.
pub fn refines(settings: &FitSettings) -> bool {
    let aligns = matches!(settings.align, Alignment::Smooth { .. }) && settings.lobes > 1;
    aligns && matches!(settings.objective, Objective::Appearance { steps } if steps > 0)
}

/// Rounds that a level gets.
pub fn rounds(settings: &FitSettings, level: usize) -> usize {
    if !refines(settings) || level < looks::FINEST {
        return 0;
    }
    (FEWEST_ROUNDS << (level - looks::FINEST).min(8)).min(MOST_ROUNDS)
}

/// Moves the lobes of a level by so many rounds; returns E before and after.
pub fn refine(
    map: &NormalMap,
    looks: &Looks<'_>,
    level: usize,
    mixtures: &mut MixtureLevel,
    rounds: usize,
    monitor: &Monitor,
) -> Result<(f64, f64), Cancelled> {
    let size = (mixtures.width, mixtures.height);
    let joint = Joint { looks, level, size, slots: mixtures.lobes, addressing: map.options.addressing, monitor };
    let (mut trial, mut next) = (mixtures.stored.clone(), mixtures.stored.clone());
    let kept = &mut mixtures.stored;
    let mut damping = (DAMPING / 30.0_f64.powi((level - looks::FINEST) as i32)).max(FIRST_DAMPING);
    let first = joint.pass(kept, Some(damping), &mut trial)?;
    let mut least = first;
    for left in (0..rounds).rev() {
        let eased = (damping * EASED).max(LEAST_DAMPING);
        let here = joint.pass(&trial, (left > 0).then_some(eased), &mut next)?;
        if here < least {
            least = here;
            damping = eased;
            std::mem::swap(kept, &mut trial);
            std::mem::swap(&mut trial, &mut next);
        } else if left > 0 {
            damping *= RAISED;
            joint.pass(kept, Some(damping), &mut trial)?;
        }
        monitor.visited(level, map.len() as u64);
    }
    Ok((first, least))
}

/// A level whose texels move together.
struct Joint<'a> {
    looks: &'a Looks<'a>,
    level: usize,
    size: (usize, usize),
    slots: usize,
    addressing: Addressing,
    monitor: &'a Monitor,
}

/// Room for a row of texels and the two lines of corners beside it.
struct Rows {
    residual: Residual,
    /// Looks of the row above and of the row itself.
    looks: [Vec<f32>; 2],
    /// Equations of the corners above and below the row, then of its texels.
    above: Vec<f32>,
    below: Vec<f32>,
    own: Vec<f32>,
    sum: Vec<f32>,
    matrix: Box<Matrix>,
}

impl Joint<'_> {
    /// E at `from`; with a damping, `to` becomes the lobes a step on.
    fn pass(&self, from: &[StoredLobe], damping: Option<f64>, to: &mut [StoredLobe]) -> Result<f64, Cancelled> {
        let rows = self.size.1.div_ceil(TASKS);
        let strips = to.par_chunks_mut(rows * self.size.0 * self.slots).enumerate();
        let strip = |rooms: &mut Rows, (index, to): (usize, &mut [StoredLobe])| {
            self.strip(from, index * rows, damping, to, rooms)
        };
        let energies: Result<Vec<f64>, Cancelled> = strips.map_init(|| self.room(), strip).collect();
        Ok(energies?.iter().sum())
    }

    fn room(&self) -> Rows {
        let (width, length) = (self.size.0, equations_len(self.slots));
        let look = || vec![0.0; width * self.looks.directions.len()];
        let equations = |count: usize| vec![0.0; count * length];
        Rows {
            residual: Residual::default(),
            looks: [look(), look()],
            above: equations(width + 1),
            below: equations(width + 1),
            own: equations(width),
            sum: equations(1),
            matrix: Box::new([[0.0; MOST]; MOST]),
        }
    }

    /// Works through the rows from `top` that `to` holds; returns their part of E.
    fn strip(
        &self,
        from: &[StoredLobe],
        top: usize,
        damping: Option<f64>,
        to: &mut [StoredLobe],
        rows: &mut Rows,
    ) -> Result<f64, Cancelled> {
        let (width, height) = self.size;
        let length = equations_len(self.slots);
        let short = damping.is_none();
        let pair = line(top, height, self.addressing);
        self.looks.read_row(self.level, pair[0], &mut rows.looks[0]);
        self.looks.read_row(self.level, pair[1], &mut rows.looks[1]);
        self.corners(from, pair, short, rows);
        let mut energy = 0.0;
        for (row, to) in to.chunks_mut(width * self.slots).enumerate() {
            self.monitor.check()?;
            let y = top + row;
            std::mem::swap(&mut rows.above, &mut rows.below);
            self.centres(from, y, short, rows);
            rows.looks.swap(0, 1);
            let pair = line(y + 1, height, self.addressing);
            self.looks.read_row(self.level, pair[1], &mut rows.looks[1]);
            self.corners(from, pair, short, rows);
            let lines = lines(width, self.addressing);
            let of = |equations: &[f32], count: usize| -> f64 {
                equations.chunks(length).take(count).map(|equations| f64::from(equations[0])).sum()
            };
            energy += f64::from(CENTRE) * of(&rows.own, width) + of(&rows.above, lines);
            if y + 1 == height && self.addressing == Addressing::Clamp {
                energy += of(&rows.below, lines);
            }
            if let Some(damping) = damping {
                for (x, to) in to.chunks_mut(self.slots).enumerate() {
                    let index = (y * width + x) * self.slots;
                    self.gather((x, y), rows);
                    self.step(&from[index..index + self.slots], damping, rows, to);
                }
            }
        }
        Ok(energy)
    }

    /// The equations of the texels of row `y`.
    fn centres(&self, from: &[StoredLobe], y: usize, short: bool, rows: &mut Rows) {
        let count = self.looks.directions.len();
        let equations = rows.own.chunks_mut(equations_len(self.slots));
        for (x, (equations, look)) in equations.zip(rows.looks[1].chunks(count)).enumerate() {
            let index = (y * self.size.0 + x) * self.slots;
            let stored = &from[index..index + self.slots];
            rows.residual.equations(&self.looks.directions, stored, look, short, equations);
        }
    }

    /// The equations of the corners between two rows.
    fn corners(&self, from: &[StoredLobe], rows_of: [usize; 2], short: bool, rows: &mut Rows) {
        let width = self.size.0;
        let count = self.looks.directions.len();
        for (i, equations) in rows.below.chunks_mut(equations_len(self.slots)).enumerate() {
            let columns = line(i, width, self.addressing);
            let mut stored = [[0.0; EACH]; MAX_LOBES];
            let mut look = [0.0; looks::MOST_DIRECTIONS];
            for (y, looks) in rows_of.into_iter().zip(&rows.looks) {
                for x in columns {
                    let texel = &from[(y * width + x) * self.slots..][..self.slots];
                    let values = stored.iter_mut().flatten().zip(texel.iter().flatten());
                    values.for_each(|(sum, value)| *sum += 0.25 * value);
                    look.iter_mut().zip(&looks[x * count..(x + 1) * count]).for_each(|(sum, v)| *sum += 0.25 * v);
                }
            }
            let (stored, look) = (&stored[..self.slots], &look[..count]);
            rows.residual.equations(&self.looks.directions, stored, look, short, equations);
        }
    }

    /// The sum of a texel's own equations and those of the corners around, as much as each is its.
    fn gather(&self, (x, y): (usize, usize), rows: &mut Rows) {
        let (width, height) = self.size;
        let length = equations_len(self.slots);
        let own = &rows.own[x * length..(x + 1) * length];
        rows.sum.iter_mut().zip(own).for_each(|(sum, own)| *sum = CENTRE * own);
        for (j, beside) in [&rows.above, &rows.below].into_iter().enumerate() {
            for i in 0..2 {
                let share = share(x, i, width, self.addressing) * share(y, j, height, self.addressing);
                let corner = &beside[(x + i) * length..(x + i + 1) * length];
                rows.sum.iter_mut().zip(corner).for_each(|(sum, corner)| *sum += share * corner);
            }
        }
    }

    /// Solves a texel's equations and takes the step; stays where they have no answer.
    fn step(&self, from: &[StoredLobe], damping: f64, rows: &mut Rows, to: &mut [StoredLobe]) {
        to.copy_from_slice(from);
        let n = EACH * self.slots;
        let (matrix, sum) = (&mut *rows.matrix, &rows.sum);
        for (k, j) in (0..self.slots).flat_map(|k| (0..=k).map(move |j| (k, j))) {
            let products = &sum[products_start(self.slots, j, k)..][..EACH * EACH];
            for (index, &product) in products.iter().enumerate() {
                matrix[EACH * j + index % EACH][EACH * k + index / EACH] = f64::from(product);
            }
        }
        let largest = (0..n).map(|i| matrix[i][i]).fold(0.0, f64::max);
        let (mut step, mut together) = ([0.0; MOST], [0.0; MOST]);
        for i in 0..n {
            let idle = matrix[i][i] <= IDLE * largest;
            matrix[i][i] += damping * matrix[i][i] + IDLE * largest;
            step[i] = if idle { 0.0 } else { -f64::from(sum[1 + i]) };
            together[i] = if i % EACH == 0 && !idle { 1.0 } else { 0.0 };
        }
        if !cholesky::factor(matrix, n) {
            return;
        }
        cholesky::solve(matrix, n, &mut step);
        cholesky::solve(matrix, n, &mut together);
        let weight = |x: &[f64; MOST]| (0..self.slots).map(|j| x[EACH * j]).sum::<f64>();
        let excess = weight(&step) / weight(&together);
        step.iter_mut().zip(&together).for_each(|(step, together)| *step -= excess * together);
        if step[..n].iter().all(|value| value.is_finite()) {
            moved(from, &step, to);
        }
    }
}

/// The lobes a step on: weights at least 0, of sum 1; no lobe becomes sharper than the material shows.
fn moved(from: &[StoredLobe], step: &[f64; MOST], to: &mut [StoredLobe]) {
    let mut total = 0.0;
    let mut lobes = [glam::DVec4::ZERO; MAX_LOBES];
    for (j, (lobe, &stored)) in lobes.iter_mut().zip(from).enumerate() {
        *lobe = glam::Vec4::from(stored).as_dvec4() + glam::DVec4::from_slice(&step[EACH * j..]);
        lobe.x = lobe.x.max(0.0);
        let [alpha, x, y, z] = stored.map(f64::from);
        let longest = (glam::DVec3::new(x, y, z).length() / alpha.max(f64::MIN_POSITIVE)).clamp(LONGEST, 1.0);
        let vector = glam::DVec3::new(lobe.y, lobe.z, lobe.w).clamp_length_max(longest * lobe.x);
        *lobe = glam::DVec4::new(lobe.x, vector.x, vector.y, vector.z);
        total += lobe.x;
    }
    if total > 0.0 {
        to.iter_mut().zip(lobes).for_each(|(to, lobe)| *to = (lobe / total).as_vec4().to_array());
    }
}

/// Lines of corners along an axis that count: the last is the first again where the map tiles.
fn lines(size: usize, addressing: Addressing) -> usize {
    size + usize::from(addressing == Addressing::Clamp)
}

/// The texels on either side of corner line `index` along an axis.
fn line(index: usize, size: usize, addressing: Addressing) -> [usize; 2] {
    match addressing {
        Addressing::Wrap => [(index + size - 1) % size, index % size],
        Addressing::Clamp => [index.max(1) - 1, index.min(size - 1)],
    }
}

/// The share of texel `index` in the corner line before it (`side` 0) or behind it (1), along an axis.
fn share(index: usize, side: usize, size: usize, addressing: Addressing) -> f32 {
    match addressing {
        // A single texel borders on itself, in one line.
        Addressing::Wrap if size == 1 => [1.0, 0.0][side],
        Addressing::Wrap => 0.5,
        Addressing::Clamp if index + side == 0 || index + side == size => 1.0,
        Addressing::Clamp => 0.5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_is_shared_out_whole() {
        for addressing in [Addressing::Wrap, Addressing::Clamp] {
            for size in 1..6 {
                let mut shares = [0.0; 7];
                for (index, side) in (0..size).flat_map(|index| [(index, 0), (index, 1)]) {
                    let at = index + side;
                    let counted = if at < lines(size, addressing) { at } else { 0 };
                    shares[counted] += share(index, side, size, addressing);
                    let beside = line(at, size, addressing).into_iter().filter(|&texel| texel == index).count();
                    let expected = beside as f32 / 2.0;
                    let same_line_twice = size == 1 && addressing == Addressing::Wrap && side == 1;
                    assert!(same_line_twice || share(index, side, size, addressing) == expected);
                }
                assert!(shares[..lines(size, addressing)].iter().all(|&share| share == 1.0), "{addressing:?}, {size}");
            }
        }
    }
}
