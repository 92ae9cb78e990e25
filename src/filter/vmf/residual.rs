//! How far a mixture's look is from the true one, and how its stored channels change that.
//!
//! A lobe `(alpha, m = alpha r)` looks like `alpha v(w; R)`, `R = a m / alpha`: v is the lobe of mean vector R, a the
//! material's mean cosine ([`super::looks`]). It is smooth in the stored channels, also where alpha or m vanish: with
//! `rho = |R|`, `mu = R / rho`, `u = mu.w` and `K' = dK / drho`,
//!
//! `d/dalpha = v (1 - rho K' (u - rho))`, `d/dm = a v (K' (u - rho) mu + K / rho (w - u mu))`.
//!
//! The squared residual is relative to the true look's square. Gauss-Newton's equations of one place are a slice: the
//! squared residual, half its gradient, then the 4x4 products of slot k's derivatives with slot j's, `j <= k`.

use glam::Vec4Swizzles;
use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::lanes::{LANES, exp_of_negative, halving_sum, lanes, mul_add};
use super::looks::{Directions, MEAN_COSINE, MOST_DIRECTIONS};
use super::phi::Width;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Channels of a slot.
pub const EACH: usize = 4;

/// The longest mean vector of a lobe under the material, and the shortest that has a direction.
const LENGTHS: (f32, f32) = (1e-4, MEAN_COSINE as f32);

/// Length of the equations of so many slots.
pub const fn equations_len(slots: usize) -> usize {
    1 + EACH * slots + EACH * EACH * slots * (slots + 1) / 2
}

/// Where the products of slot `k` with slot `j <= k` begin.
pub const fn products_start(slots: usize, j: usize, k: usize) -> usize {
    1 + EACH * slots + EACH * EACH * (k * (k + 1) / 2 + j)
}

/// A lobe under the material, as the loop reads it.
#[derive(Clone, Copy, Debug, Default)]
struct ShadedLobe {
    alpha: f32,
    mu: [f32; 3],
    kappa: f32,
    peak: f32,
    length: f32,
    /// `dK / drho`.
    slope: f32,
}

impl ShadedLobe {
    fn new(stored: StoredLobe) -> Self {
        let stored = glam::Vec4::from(stored);
        let resultant = MEAN_COSINE as f32 * stored.yzw() / stored.x;
        let length = resultant.length().clamp(LENGTHS.0, LENGTHS.1);
        let width = Width::of_length(f64::from(length));
        Self {
            alpha: stored.x,
            mu: resultant.try_normalize().unwrap_or(glam::Vec3::Z).to_array(),
            kappa: width.kappa as f32,
            peak: width.peak as f32,
            length,
            slope: (1.0 / width.slope) as f32,
        }
    }
}

/// Values towards every direction, a group of lanes at a time.
type Row = [[f32; LANES]; MOST_DIRECTIONS / LANES];

/// A row of nothing.
const NOTHING: Row = [[0.0; LANES]; MOST_DIRECTIONS / LANES];

/// Room for one place at a time.
pub struct Residual {
    residual: Row,
    columns: Box<[[Row; EACH]; MAX_LOBES]>,
}

impl Default for Residual {
    fn default() -> Self {
        Self { residual: NOTHING, columns: Box::new([[NOTHING; EACH]; MAX_LOBES]) }
    }
}

impl Residual {
    /// Writes the equations of a mixture whose true look is `look`; only the squared residual where `short`. Nothing
    /// counts where nothing is to be seen.
    pub fn equations(
        &mut self,
        directions: &Directions,
        stored: &[StoredLobe],
        look: &[f32],
        short: bool,
        equations: &mut [f32],
    ) {
        equations.fill(0.0);
        let groups = look.len() / LANES;
        let residual = &mut self.residual[..groups];
        residual.as_flattened_mut().copy_from_slice(look);
        let square = squares(residual);
        if square <= f32::MIN_POSITIVE {
            return;
        }
        residual.as_flattened_mut().iter_mut().for_each(|value| *value = -*value);
        for (columns, &stored) in self.columns.iter_mut().zip(stored) {
            if stored[0] > EMPTY_WEIGHT {
                shade(directions, &ShadedLobe::new(stored), residual, columns);
            } else if !short {
                for column in columns {
                    column[..groups].fill([0.0; LANES]);
                }
            }
        }
        let scale = 1.0 / square;
        equations[0] = scale * squares(residual);
        if !short {
            products(residual, &self.columns[..stored.len()], scale, &mut equations[1..]);
        }
    }
}

/// The sum of squares, lane by lane.
fn squares(values: &[[f32; LANES]]) -> f32 {
    let mut acc = [0.0_f32; LANES];
    for values in values {
        for i in 0..LANES {
            acc[i] += values[i] * values[i];
        }
    }
    halving_sum(acc)
}

/// Adds a lobe's look to `residual` and writes its derivatives to `columns`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn shade(directions: &Directions, lobe: &ShadedLobe, residual: &mut [[f32; LANES]], columns: &mut [Row; EACH]) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let [mx, my, mz] = lobe.mu;
    let (a, turn) = (MEAN_COSINE as f32, lobe.kappa / lobe.length);
    let neg_half_kappa = -0.5 * lobe.kappa;
    for (group, residual) in residual.iter_mut().enumerate() {
        let (x, y, z) = (lanes(&directions.x, group), lanes(&directions.y, group), lanes(&directions.z, group));
        let mut out = [[0.0_f32; LANES]; 1 + EACH];
        for i in 0..LANES {
            let (dx, dy, dz) = (x[i] - mx, y[i] - my, z[i] - mz);
            let chord = dx * dx + dy * dy + dz * dz;
            let v = lobe.peak * exp_of_negative::<FMA>(neg_half_kappa * chord);
            let u = 1.0 - 0.5 * chord;
            let stretch = lobe.slope * (u - lobe.length);
            let (along, v_a) = (stretch - turn * u, a * v);
            out[0][i] = v * (1.0 - lobe.length * stretch);
            out[1][i] = v_a * (along * mx + turn * x[i]);
            out[2][i] = v_a * (along * my + turn * y[i]);
            out[3][i] = v_a * (along * mz + turn * z[i]);
            out[4][i] = lobe.alpha * v;
        }
        for i in 0..LANES {
            residual[i] += out[EACH][i];
        }
        for (column, out) in columns.iter_mut().zip(&out) {
            column[group] = *out;
        }
    }
}

/// Writes the gradient and the products of `slots` times four columns.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn products(residual: &[[f32; LANES]], columns: &[[Row; EACH]], scale: f32, out: &mut [f32]) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let groups = residual.len();
    let (gradient, tiles) = out.split_at_mut(EACH * columns.len());
    for (columns, gradient) in columns.iter().zip(gradient.chunks_exact_mut(EACH)) {
        gradient.copy_from_slice(&times::<FMA>(residual, columns).map(|value| scale * value));
    }
    let pairs = (0..columns.len()).flat_map(|k| (0..=k).map(move |j| (j, k)));
    for ((j, k), tile) in pairs.zip(tiles.chunks_exact_mut(EACH * EACH)) {
        for (left, out) in columns[k].iter().zip(tile.chunks_exact_mut(EACH)) {
            out.copy_from_slice(&times::<FMA>(&left[..groups], &columns[j]).map(|value| scale * value));
        }
    }
}

/// The products of `left` with four columns.
#[inline(always)]
fn times<const FMA: bool>(left: &[[f32; LANES]], right: &[Row; EACH]) -> [f32; EACH] {
    let mut acc = [[0.0_f32; LANES]; EACH];
    let [a, b, c, d] = right;
    for ((((left, a), b), c), d) in left.iter().zip(a).zip(b).zip(c).zip(d) {
        for i in 0..LANES {
            acc[0][i] = mul_add::<FMA>(left[i], a[i], acc[0][i]);
            acc[1][i] = mul_add::<FMA>(left[i], b[i], acc[1][i]);
            acc[2][i] = mul_add::<FMA>(left[i], c[i], acc[2][i]);
            acc[3][i] = mul_add::<FMA>(left[i], d[i], acc[3][i]);
        }
    }
    acc.map(halving_sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::looks::Looks;
    use crate::filter::vmf::monitor::Monitor;
    use crate::normal_map::procedural;

    #[test]
    fn the_equations_equal_finite_differences() {
        let map = procedural::find("bricks").expect("bundled").make(32);
        let looks = Looks::new(&map, &Monitor::new(vec![1; 6])).expect("nobody cancels");
        let count = looks.directions.len();
        let mut look = vec![0.0; count];
        looks.read_row(5, 0, &mut look);
        let stored = [[0.5, 0.1, 0.05, 0.4], [0.3, -0.1, 0.1, 0.22], [0.2, 0.0, -0.02, 0.19], [0.0; 4]];
        let mut residual = Residual::default();
        let mut at = vec![0.0; equations_len(4)];
        residual.equations(&looks.directions, &stored, &look, false, &mut at);
        let mut value = |moved: &[StoredLobe]| {
            let mut short = vec![0.0; equations_len(4)];
            residual.equations(&looks.directions, moved, &look, true, &mut short);
            f64::from(short[0])
        };
        assert_eq!(value(&stored), f64::from(at[0]));
        let largest = at[1..17].iter().fold(0.0_f32, |largest, g| largest.max(g.abs()));
        for (j, p) in (0..3).flat_map(|j| (0..4).map(move |p| (j, p))) {
            let mut along = |h: f32| {
                let mut moved = stored;
                moved[j][p] += h;
                value(&moved)
            };
            let slope = (along(1e-3) - along(-1e-3)) / 2e-3;
            let found = 2.0 * f64::from(at[1 + 4 * j + p]);
            assert!((found - slope).abs() < 1e-2 * f64::from(largest), "{j}, {p}: {found}, {slope}");
        }
        assert!(at[13..17].iter().all(|&g| g == 0.0), "an empty slot has no say");
    }
}
