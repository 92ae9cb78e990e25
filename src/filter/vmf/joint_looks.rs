//! The steps of [`super::between`] for large footprints, from the residuals towards every direction: what a texel looks
//! like costs the same whatever its normals ([`super::looks`], [`super::residual`]).

use super::between::{CENTRE, IDLE, Joint, Level, moved};
use super::cholesky::{self, MOST, Matrix};
use super::corners::{line, lines, share};
use super::looks::{self, Looks};
use super::monitor::Cancelled;
use super::residual::{EACH, Residual, equations_len, products_start};
use crate::normal_map::Addressing;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;

/// Rows that one task works through: a line of corners is met twice where two tasks meet.
const ROWS: usize = 4;

/// A level whose texels move together.
pub struct JointLooks<'a> {
    /// The level.
    pub level: Level<'a>,
    /// What its texels look like.
    pub looks: &'a Looks<'a>,
}

/// Room for a row of texels and the two lines of corners beside it.
pub struct Rows {
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

impl Joint for JointLooks<'_> {
    type Room = Rows;

    fn rows(&self) -> usize {
        ROWS
    }

    fn room(&self) -> Rows {
        let (width, length) = (self.level.size.0, equations_len(self.level.slots));
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

    fn strip(
        &self,
        from: &[StoredLobe],
        top: usize,
        damping: Option<f64>,
        to: &mut [StoredLobe],
        rows: &mut Rows,
    ) -> Result<f64, Cancelled> {
        let (width, height) = self.level.size;
        let length = equations_len(self.level.slots);
        let short = damping.is_none();
        let pair = line(top, height, self.level.addressing);
        self.looks.read_row(self.level.level, pair[0], &mut rows.looks[0]);
        self.looks.read_row(self.level.level, pair[1], &mut rows.looks[1]);
        self.corners(from, pair, short, rows);
        let mut energy = 0.0;
        for (row, to) in to.chunks_mut(width * self.level.slots).enumerate() {
            self.level.monitor.check()?;
            let y = top + row;
            std::mem::swap(&mut rows.above, &mut rows.below);
            self.centres(from, y, short, rows);
            rows.looks.swap(0, 1);
            let pair = line(y + 1, height, self.level.addressing);
            self.looks.read_row(self.level.level, pair[1], &mut rows.looks[1]);
            self.corners(from, pair, short, rows);
            let lines = lines(width, self.level.addressing);
            let of = |equations: &[f32], count: usize| -> f64 {
                equations.chunks(length).take(count).map(|equations| f64::from(equations[0])).sum()
            };
            energy += f64::from(CENTRE) * of(&rows.own, width) + of(&rows.above, lines);
            if y + 1 == height && self.level.addressing == Addressing::Clamp {
                energy += of(&rows.below, lines);
            }
            if let Some(damping) = damping {
                for (x, to) in to.chunks_mut(self.level.slots).enumerate() {
                    let index = (y * width + x) * self.level.slots;
                    self.gather((x, y), rows);
                    self.step(&from[index..index + self.level.slots], damping, rows, to);
                }
            }
        }
        Ok(energy)
    }
}

impl JointLooks<'_> {
    /// The equations of the texels of row `y`.
    fn centres(&self, from: &[StoredLobe], y: usize, short: bool, rows: &mut Rows) {
        let count = self.looks.directions.len();
        let equations = rows.own.chunks_mut(equations_len(self.level.slots));
        for (x, (equations, look)) in equations.zip(rows.looks[1].chunks(count)).enumerate() {
            let index = (y * self.level.size.0 + x) * self.level.slots;
            let stored = &from[index..index + self.level.slots];
            rows.residual.equations(&self.looks.directions, stored, look, short, equations);
        }
    }

    /// The equations of the corners between two rows.
    fn corners(&self, from: &[StoredLobe], rows_of: [usize; 2], short: bool, rows: &mut Rows) {
        let width = self.level.size.0;
        let count = self.looks.directions.len();
        for (i, equations) in rows.below.chunks_mut(equations_len(self.level.slots)).enumerate() {
            let columns = line(i, width, self.level.addressing);
            let mut stored = [[0.0; EACH]; MAX_LOBES];
            let mut look = [0.0; looks::MOST_DIRECTIONS];
            for (y, looks) in rows_of.into_iter().zip(&rows.looks) {
                for x in columns {
                    let texel = &from[(y * width + x) * self.level.slots..][..self.level.slots];
                    let values = stored.iter_mut().flatten().zip(texel.iter().flatten());
                    values.for_each(|(sum, value)| *sum += 0.25 * value);
                    look.iter_mut().zip(&looks[x * count..(x + 1) * count]).for_each(|(sum, v)| *sum += 0.25 * v);
                }
            }
            let (stored, look) = (&stored[..self.level.slots], &look[..count]);
            rows.residual.equations(&self.looks.directions, stored, look, short, equations);
        }
    }

    /// The sum of a texel's own equations and those of the corners around, as much as each is its.
    fn gather(&self, (x, y): (usize, usize), rows: &mut Rows) {
        let (width, height) = self.level.size;
        let length = equations_len(self.level.slots);
        let own = &rows.own[x * length..(x + 1) * length];
        rows.sum.iter_mut().zip(own).for_each(|(sum, own)| *sum = CENTRE * own);
        for (j, beside) in [&rows.above, &rows.below].into_iter().enumerate() {
            for i in 0..2 {
                let share = share(x, i, width, self.level.addressing) * share(y, j, height, self.level.addressing);
                let corner = &beside[(x + i) * length..(x + i + 1) * length];
                rows.sum.iter_mut().zip(corner).for_each(|(sum, corner)| *sum += share * corner);
            }
        }
    }

    /// Solves a texel's equations and takes the step; stays where they have no answer.
    fn step(&self, from: &[StoredLobe], damping: f64, rows: &mut Rows, to: &mut [StoredLobe]) {
        to.copy_from_slice(from);
        let n = EACH * self.level.slots;
        let (matrix, sum) = (&mut *rows.matrix, &rows.sum);
        for (k, j) in (0..self.level.slots).flat_map(|k| (0..=k).map(move |j| (k, j))) {
            let products = &sum[products_start(self.level.slots, j, k)..][..EACH * EACH];
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
        let weight = |x: &[f64; MOST]| (0..self.level.slots).map(|j| x[EACH * j]).sum::<f64>();
        let excess = weight(&step) / weight(&together);
        step.iter_mut().zip(&together).for_each(|(step, together)| *step -= excess * together);
        if step[..n].iter().all(|value| value.is_finite()) {
            moved(from, &step, to);
        }
    }
}
