//! Small symmetric positive systems by Cholesky's method, in place: only the part of the matrix on and above the
//! diagonal is read and written.

/// Factors the first `n` rows of `matrix`; false where it is not positive.
pub fn factor<const N: usize>(matrix: &mut [[f64; N]; N], n: usize) -> bool {
    for k in 0..n {
        let pivot = matrix[k][k];
        if pivot.is_nan() || pivot <= 0.0 {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        matrix[k][k..n].iter_mut().for_each(|value| *value *= inverse);
        let (above, below) = matrix.split_at_mut(k + 1);
        let row = &above[k][..n];
        for (i, target) in (k + 1..n).zip(below) {
            let factor = row[i];
            target[i..n].iter_mut().zip(&row[i..]).for_each(|(value, &r)| *value -= factor * r);
        }
    }
    true
}

/// Replaces `x` by the solution of the factored system with right side `x`.
pub fn solve<const N: usize>(matrix: &[[f64; N]; N], n: usize, x: &mut [f64; N]) {
    for i in 0..n {
        x[i] /= matrix[i][i];
        let value = x[i];
        x[i + 1..n].iter_mut().zip(&matrix[i][i + 1..n]).for_each(|(x, &r)| *x -= r * value);
    }
    for i in (0..n).rev() {
        let sum: f64 = matrix[i][i + 1..n].iter().zip(&x[i + 1..n]).map(|(&r, &x)| r * x).sum();
        x[i] = (x[i] - sum) / matrix[i][i];
    }
}
