//! Symmetric positive systems of a crowd's texels, a texel a lane, by Cholesky's method: what [`super::cholesky`] does
//! for one, in single precision.
//!
//! The matrix `A = U' U` is kept in tiles, a tile for each pair of lobes `j <= k`; U takes their place. Every step is
//! a step of all lanes, and a tile's sums run over lobes, so there is nothing to be summed over lanes. Lanes are the
//! outermost loop over a tile wherever that is long enough to stay one: inside, the compiler would take rows for lanes.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::lanes::{LANES, Lanes, mul_add};
use super::phi::pair_index;
use crate::sphere::mixture::MAX_LOBES;

/// Unknowns of a lobe.
pub const EACH: usize = 4;

/// The entries of lobe j's unknowns (rows) with lobe k's (columns).
pub type Tile = [[Lanes; EACH]; EACH];

/// A vector's entries of one lobe's unknowns.
pub type Part = [Lanes; EACH];

/// Pairs `j <= k` of up to [`MAX_LOBES`] lobes.
const PAIRS: usize = MAX_LOBES * (MAX_LOBES + 1) / 2;

/// An empty tile.
const EMPTY: Tile = [[Lanes::splat(0.0); EACH]; EACH];

/// A system for each lane.
#[derive(Clone, Debug)]
pub struct CrowdSystem {
    /// Lobes.
    pub count: usize,
    /// The matrix, by [`pair_index`].
    pub tiles: Box<[Tile]>,
    /// The right side, then the solution.
    pub right: [Part; MAX_LOBES],
}

impl Default for CrowdSystem {
    fn default() -> Self {
        let right = [[Lanes::splat(0.0); EACH]; MAX_LOBES];
        Self { count: 0, tiles: vec![EMPTY; PAIRS].into_boxed_slice(), right }
    }
}

impl CrowdSystem {
    /// Becomes a copy of another, as far as that is in use.
    pub fn copy_from(&mut self, other: &Self) {
        let (count, pairs) = (other.count, other.count * (other.count + 1) / 2);
        self.count = count;
        self.tiles[..pairs].copy_from_slice(&other.tiles[..pairs]);
        self.right[..count].copy_from_slice(&other.right[..count]);
    }

    /// What is in use of the right side and of the matrix.
    pub fn parts(&self) -> [&[Lanes]; 2] {
        let pairs = self.count * (self.count + 1) / 2;
        [self.right[..self.count].as_flattened(), self.tiles[..pairs].as_flattened().as_flattened()]
    }

    /// As [`Self::parts`], to be changed.
    pub fn parts_mut(&mut self) -> [&mut [Lanes]; 2] {
        let pairs = self.count * (self.count + 1) / 2;
        let tiles = self.tiles[..pairs].as_flattened_mut().as_flattened_mut();
        [self.right[..self.count].as_flattened_mut(), tiles]
    }

    /// Factors the matrix in place; says in which lanes it was positive.
    pub fn factor(&mut self) -> [bool; LANES] {
        let mut least = Lanes::splat(f32::INFINITY);
        factor(&mut self.tiles, self.count, &mut least);
        least.0.map(|pivot| pivot > 0.0)
    }

    /// Replaces a right side by the solution of the factored system.
    pub fn substitute(&self, right: &mut [Part; MAX_LOBES]) {
        substitute(&self.tiles, self.count, right);
    }

    /// Solves the system in place; says in which lanes the matrix was positive.
    pub fn solve(&mut self) -> [bool; LANES] {
        let positive = self.factor();
        substitute(&self.tiles, self.count, &mut self.right);
        positive
    }
}

/// Replaces the matrix by U, with the inverses of U's diagonal on its own; `least` becomes each lane's least pivot, or
/// less than 0 where there was none.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn factor(tiles: &mut [Tile], count: usize, least: &mut Lanes) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for k in 0..count {
        for j in 0..=k {
            let mut tile = tiles[pair_index(j, k)];
            for i in 0..j {
                subtract_product::<FMA>(&mut tile, &tiles[pair_index(i, j)], &tiles[pair_index(i, k)]);
            }
            if j == k {
                factor_tile::<FMA>(&mut tile, least);
            } else {
                divide_tile::<FMA>(&mut tile, &tiles[pair_index(j, j)]);
            }
            tiles[pair_index(j, k)] = tile;
        }
    }
}

/// `tile -= left' right`.
#[inline(always)]
fn subtract_product<const FMA: bool>(tile: &mut Tile, left: &Tile, right: &Tile) {
    for p in 0..EACH {
        for i in 0..LANES {
            for q in 0..EACH {
                let mut sum = tile[p][q].0[i];
                for r in 0..EACH {
                    sum = mul_add::<FMA>(-left[r][p].0[i], right[r][q].0[i], sum);
                }
                tile[p][q].0[i] = sum;
            }
        }
    }
}

/// Cholesky's method within a tile of the diagonal.
#[inline(always)]
fn factor_tile<const FMA: bool>(tile: &mut Tile, least: &mut Lanes) {
    let mut lowest = *least;
    for i in 0..LANES {
        let mut u = [[0.0_f32; EACH]; EACH];
        for p in 0..EACH {
            for q in p..EACH {
                let mut sum = tile[p][q].0[i];
                for r in 0..p {
                    sum = mul_add::<FMA>(-u[r][p], u[r][q], sum);
                }
                u[p][q] = sum;
            }
            let pivot = u[p][p];
            let positive = pivot > 0.0;
            let least = lowest.0[i];
            lowest.0[i] = if positive { if pivot < least { pivot } else { least } } else { -1.0 };
            let inverse = 1.0 / if positive { pivot } else { 1.0 }.sqrt();
            u[p][p] = inverse;
            for q in p + 1..EACH {
                u[p][q] *= inverse;
            }
        }
        for p in 0..EACH {
            for q in p..EACH {
                tile[p][q].0[i] = u[p][q];
            }
        }
    }
    *least = lowest;
}

/// Replaces a tile T by the solution of `U' X = T`, U the diagonal's tile of the same rows.
#[inline(always)]
fn divide_tile<const FMA: bool>(tile: &mut Tile, diagonal: &Tile) {
    for q in 0..EACH {
        for i in 0..LANES {
            let mut x = [0.0_f32; EACH];
            for p in 0..EACH {
                let mut sum = tile[p][q].0[i];
                for r in 0..p {
                    sum = mul_add::<FMA>(-diagonal[r][p].0[i], x[r], sum);
                }
                x[p] = sum * diagonal[p][p].0[i];
                tile[p][q].0[i] = x[p];
            }
        }
    }
}

/// Solves `U' U x = right` in place.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn substitute(tiles: &[Tile], count: usize, right: &mut [Part; MAX_LOBES]) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for k in 0..count {
        let mut part = right[k];
        for j in 0..k {
            subtract::<FMA, true>(&mut part, &tiles[pair_index(j, k)], &right[j]);
        }
        let diagonal = &tiles[pair_index(k, k)];
        for i in 0..LANES {
            for q in 0..EACH {
                let mut sum = part[q].0[i];
                for p in 0..q {
                    sum = mul_add::<FMA>(-diagonal[p][q].0[i], part[p].0[i], sum);
                }
                part[q].0[i] = sum * diagonal[q][q].0[i];
            }
        }
        right[k] = part;
    }
    for j in (0..count).rev() {
        let mut part = right[j];
        for k in j + 1..count {
            subtract::<FMA, false>(&mut part, &tiles[pair_index(j, k)], &right[k]);
        }
        let diagonal = &tiles[pair_index(j, j)];
        for i in 0..LANES {
            for p in (0..EACH).rev() {
                let mut sum = part[p].0[i];
                for q in p + 1..EACH {
                    sum = mul_add::<FMA>(-diagonal[p][q].0[i], part[q].0[i], sum);
                }
                part[p].0[i] = sum * diagonal[p][p].0[i];
            }
        }
        right[j] = part;
    }
}

/// `from -= tile known`, or with the tile transposed.
#[inline(always)]
fn subtract<const FMA: bool, const TRANSPOSED: bool>(from: &mut Part, tile: &Tile, known: &Part) {
    for i in 0..LANES {
        for p in 0..EACH {
            let mut sum = from[p].0[i];
            for q in 0..EACH {
                let entry = if TRANSPOSED { tile[q][p].0[i] } else { tile[p][q].0[i] };
                sum = mul_add::<FMA>(-entry, known[q].0[i], sum);
            }
            from[p].0[i] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::cholesky::{self, MOST, Matrix};

    /// An entry of lane `lane`'s matrix, unlike every other lane's.
    fn entry(lane: usize, a: usize, b: usize) -> f64 {
        let (low, high) = (a.min(b), a.max(b));
        ((low * 7 + high * 3 + lane) as f64).sin() + if a == b { 30.0 } else { 0.0 }
    }

    fn system(count: usize) -> CrowdSystem {
        let mut system = CrowdSystem { count, ..CrowdSystem::default() };
        for (k, j) in (0..count).flat_map(|k| (0..=k).map(move |j| (k, j))) {
            for (p, q, lane) in (0..EACH * EACH * LANES).map(|i| (i / LANES / EACH, i / LANES % EACH, i % LANES)) {
                system.tiles[pair_index(j, k)][p][q].0[lane] = entry(lane, EACH * j + p, EACH * k + q) as f32;
            }
        }
        for (i, value) in system.right.as_flattened_mut().iter_mut().enumerate() {
            value.0 = std::array::from_fn(|lane| ((i + lane) as f32).cos());
        }
        system
    }

    #[test]
    fn every_lane_comes_to_what_one_system_alone_comes_to() {
        for count in [1, 2, 6, MAX_LOBES] {
            let mut fast = system(count);
            let right = fast.right;
            assert_eq!(fast.solve(), [true; LANES]);
            let mut matrix: Box<Matrix> = Box::new([[0.0; MOST]; MOST]);
            for lane in 0..LANES {
                let n = EACH * count;
                (0..n).for_each(|a| (a..n).for_each(|b| matrix[a][b] = entry(lane, a, b)));
                let mut x: [f64; MOST] = std::array::from_fn(|i| f64::from(right.as_flattened()[i].0[lane]));
                assert!(cholesky::factor(&mut matrix, n));
                cholesky::solve(&matrix, n, &mut x);
                for (found, exact) in fast.right.as_flattened().iter().zip(&x[..n]) {
                    // A hundred roundings of values near 1/30.
                    assert!((f64::from(found.0[lane]) - exact).abs() < 1e-6, "{count}, {lane}");
                }
            }
        }
    }

    #[test]
    fn a_lane_whose_matrix_is_not_positive_is_told_apart() {
        let mut system = system(2);
        system.tiles[pair_index(1, 1)][2][2].0[5] = -1.0;
        let positive = system.solve();
        assert_eq!(positive, std::array::from_fn(|lane| lane != 5));
    }
}
