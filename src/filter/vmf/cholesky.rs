//! Small symmetric positive systems by Cholesky's method, in place: of the matrix only what is on and above the diagonal
//! is read; what is below is overwritten.
//!
//! Rows are walked in whole groups of columns, the group of the diagonal included, which costs less than to begin and
//! end anywhere.

#![expect(clippy::needless_range_loop, reason = "columns of several rows are walked by one index, which vectorises")]

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use crate::sphere::mixture::MAX_LOBES;

/// Most unknowns: four for each lobe.
pub const MOST: usize = 4 * MAX_LOBES;

/// Columns in a group.
const GROUP: usize = 8;

/// A matrix, row by row.
pub type Matrix = [[f64; MOST]; MOST];

/// Factors the first `n` rows of `matrix`, with the inverses of the factor's diagonal on its own; false where it is not
/// positive.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma"
))]
pub fn factor(matrix: &mut Matrix, n: usize) -> bool {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let end = n.next_multiple_of(GROUP).min(MOST);
    for i in 0..n {
        matrix[i][i / GROUP * GROUP..i].fill(0.0);
        matrix[i][n..end].fill(0.0);
    }
    for k in 0..n {
        let pivot = matrix[k][k];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        let mut row = matrix[k];
        for c in k / GROUP * GROUP..end {
            row[c] *= inverse;
        }
        for i in k + 1..n {
            let factor = row[i];
            subtract::<FMA>(&mut matrix[i], &row, factor, i / GROUP * GROUP, end);
        }
        row[k] = inverse;
        matrix[k] = row;
    }
    true
}

/// Replaces `x` by the solution of the factored system with right side `x`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma"
))]
pub fn solve(matrix: &Matrix, n: usize, x: &mut [f64; MOST]) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let end = n.next_multiple_of(GROUP).min(MOST);
    let mut half = [0.0; MOST];
    for i in 0..n {
        half[i] = x[i] * matrix[i][i];
        // What is before i in its group is done with.
        subtract::<FMA>(x, &matrix[i], half[i], i / GROUP * GROUP, end);
    }
    *x = [0.0; MOST];
    for i in (0..n).rev() {
        // x is 0 up to i.
        let mut sum = [0.0; GROUP];
        for start in (i / GROUP * GROUP..end).step_by(GROUP) {
            for c in 0..GROUP {
                sum[c] = mul_add::<FMA>(matrix[i][start + c], x[start + c], sum[c]);
            }
        }
        let [a, b, c, d, e, f, g, h] = sum;
        x[i] = (half[i] - ((a + e) + (c + g) + ((b + f) + (d + h)))) * matrix[i][i];
    }
}

/// Subtracts `factor * row` from `from`, from column `start` to `end`.
#[inline(always)]
fn subtract<const FMA: bool>(from: &mut [f64; MOST], row: &[f64; MOST], factor: f64, start: usize, end: usize) {
    for start in (start..end).step_by(GROUP) {
        for c in start..start + GROUP {
            from[c] = mul_add::<FMA>(-factor, row[c], from[c]);
        }
    }
}

/// `a b + c`; fused only where that is one instruction.
#[inline(always)]
fn mul_add<const FMA: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_solves_whatever_is_below_the_diagonal() {
        for n in [1, 4, 8, 12, 24, 61, MOST] {
            let entry =
                |i: usize, j: usize| ((i.min(j) * 7 + i.max(j) * 3) as f64).sin() + if i == j { 70.0 } else { 0.0 };
            let mut matrix: Box<Matrix> = Box::new([[f64::NAN; MOST]; MOST]);
            for i in 0..n {
                (i..n).for_each(|j| matrix[i][j] = entry(i, j));
            }
            let mut x: [f64; MOST] = std::array::from_fn(|i| (i as f64).cos());
            let right = x;
            assert!(factor(&mut matrix, n));
            solve(&matrix, n, &mut x);
            for i in 0..n {
                let product: f64 = (0..n).map(|j| entry(i, j) * x[j]).sum();
                assert!((product - right[i]).abs() < 1e-12, "{n}, {i}: {product} {}", right[i]);
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_is_refused() {
        let mut matrix: Box<Matrix> = Box::new([[0.0; MOST]; MOST]);
        (matrix[0][0], matrix[0][1], matrix[1][1]) = (1.0, 2.0, 1.0);
        assert!(!factor(&mut matrix, 2));
    }
}
