//! A measured reflectance as a product, `rho(theta_h, theta_d, phi_d) = f(theta_h) g(theta_d)` per channel, which is
//! what may be filtered (Han et al. 2007, footnote 4; Lawrence et al. 2006).
//!
//! Alternating least squares: for a given g the best f is `sum_d W rho g / sum_d W g^2` and the other way round, neither
//! of which can be negative. W is the solid angle of half vectors and of lights about them times the cosines of light
//! and eye, 0 where either is below the horizon and where nothing was measured.

use std::f64::consts::{FRAC_PI_2, PI};

use super::merl::{Merl, PHI_D, THETA_D, THETA_H, cosines, theta_d, theta_h};

/// Rounds of the two: the product changes by less than 1e-9 in the last.
const ROUNDS: usize = 60;

/// The factors of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Factors {
    /// By bin of theta_h, not normalised.
    pub f: [f64; THETA_H],
    /// By bin of theta_d; its weighted mean is 1.
    pub g: [f64; THETA_D],
    /// What the product leaves of the values, as a weighted root of squares over theirs.
    pub residual: f64,
}

/// Sums over phi_d of the weight, of weight times value, and of weight times its square.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    weight: f64,
    first: f64,
    second: f64,
}

type Bins = Vec<[Bin; THETA_D]>;

impl Factors {
    /// Factors one channel.
    pub fn of_channel(measured: &Merl, channel: usize) -> Self {
        let bins: Bins = (0..THETA_H).map(|h| std::array::from_fn(|d| bin(measured, channel, h, d))).collect();
        let (mut f, mut g) = ([0.0; THETA_H], [1.0; THETA_D]);
        for _ in 0..ROUNDS {
            f = std::array::from_fn(|h| best((0..THETA_D).map(|d| (&bins[h][d], g[d]))));
            g = std::array::from_fn(|d| best((0..THETA_H).map(|h| (&bins[h][d], f[h]))));
        }
        let mean = mean_of(&g);
        f = fill(f.map(|value| value * mean));
        g = fill(g.map(|value| value / mean));
        Self { residual: residual(&bins, &f, &g), f, g }
    }
}

fn bin(measured: &Merl, channel: usize, h: usize, d: usize) -> Bin {
    let (sin_h, (sin_d, cos_d)) = (theta_h(h).sin(), theta_d(d).sin_cos());
    // Equal steps of the square root of theta_h are as wide as the root.
    let solid_angle = sin_h * theta_h(h).sqrt() * sin_d * cos_d;
    let first = (h * THETA_D + d) * PHI_D;
    let values = &measured.planes[channel][first..first + PHI_D];
    let mut sums = Bin::default();
    for (k, &value) in values.iter().enumerate() {
        let [light, eye] = cosines(h, d, k);
        if light > 0.0 && eye > 0.0 && value >= 0.0 {
            let weight = solid_angle * light * eye;
            sums.weight += weight;
            sums.first += weight * value;
            sums.second += weight * value * value;
        }
    }
    sums
}

/// The factor of least squares for bins whose other factor is given; negative where no bin counts.
fn best<'a>(bins: impl Iterator<Item = (&'a Bin, f64)>) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for (bin, other) in bins {
        above += bin.first * other;
        below += bin.weight * other * other;
    }
    if below > 0.0 { above / below } else { UNKNOWN }
}

/// Stands where nothing was measured.
const UNKNOWN: f64 = -1.0;

/// The mean of what is known over half vectors' lights, whose solid angle goes by `sin cos`.
fn mean_of(g: &[f64; THETA_D]) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    for (d, &value) in g.iter().enumerate().filter(|(_, value)| **value >= 0.0) {
        let weight = (2.0 * theta_d(d)).sin();
        (sum, total) = (sum + weight * value, total + weight);
    }
    if sum > 0.0 { sum / total } else { 1.0 }
}

/// Puts the last known value, or else the next, where nothing was measured.
fn fill<const N: usize>(mut values: [f64; N]) -> [f64; N] {
    let mut last = values.iter().copied().find(|&value| value >= 0.0).unwrap_or(0.0);
    for value in &mut values {
        if *value >= 0.0 {
            last = *value;
        } else {
            *value = last;
        }
    }
    values
}

fn residual(bins: &Bins, f: &[f64; THETA_H], g: &[f64; THETA_D]) -> f64 {
    let (mut squares, mut energy) = (0.0, 0.0);
    for (row, f) in bins.iter().zip(f) {
        for (bin, g) in row.iter().zip(g) {
            let product = f * g;
            squares += bin.second - 2.0 * product * bin.first + product * product * bin.weight;
            energy += bin.second;
        }
    }
    (squares.max(0.0) / energy.max(f64::MIN_POSITIVE)).sqrt()
}

/// A factor of theta_h between its bins' middles, linear in the square root; 0 below the horizon.
pub fn of_theta_h(f: &[f64; THETA_H], theta_h: f64) -> f64 {
    if theta_h >= FRAC_PI_2 { 0.0 } else { between(f, (theta_h / FRAC_PI_2).sqrt()) }
}

/// A factor of theta_d between its bins' middles.
pub fn of_theta_d(g: &[f64; THETA_D], theta_d: f64) -> f64 {
    between(g, theta_d / FRAC_PI_2)
}

/// Linear interpolation between the middles of equal steps of 0..1.
fn between<const N: usize>(values: &[f64; N], at: f64) -> f64 {
    let place = (at * N as f64 - 0.5).clamp(0.0, (N - 1) as f64);
    let first = (place as usize).min(N - 2);
    let share = place - first as f64;
    values[first] * (1.0 - share) + values[first + 1] * share
}

/// `2 pi int f sin(theta) dtheta`, by the midpoint rule in the square root.
pub fn integral(f: &[f64; THETA_H]) -> f64 {
    let steps = 20_000;
    let ring = |i: i32| {
        let root = (f64::from(i) + 0.5) / f64::from(steps);
        let angle = root * root * FRAC_PI_2;
        of_theta_h(f, angle) * angle.sin() * 2.0 * root
    };
    2.0 * PI * FRAC_PI_2 * (0..steps).map(ring).sum::<f64>() / f64::from(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(theta_h: f64, theta_d: f64) -> f64 {
        (-30.0 * theta_h * theta_h).exp() * (0.2 + theta_d * theta_d)
    }

    #[test]
    fn a_product_comes_apart_without_a_rest() {
        let found = Factors::of_channel(&Merl::of_angles(|h, d| [product(h, d), 1.0, 1.0]), 0);
        assert!(found.residual < 1e-7, "{}", found.residual);
        for (h, d) in [(0, 0), (10, 40), (40, 70), (60, 5)] {
            let exact = product(theta_h(h), theta_d(d));
            let product = found.f[h] * found.g[d];
            assert!((product / exact - 1.0).abs() < 1e-7, "{h}, {d}: {product} against {exact}");
        }
    }

    #[test]
    fn what_is_no_product_leaves_the_rest_that_it_says() {
        // A tenth more at every other light's turn: phi_d is in no factor.
        let mut measured = Merl::of_angles(|h, d| [product(h, d); 3]);
        measured.planes[1].iter_mut().skip(1).step_by(2).for_each(|value| *value *= 1.2);
        let found = Factors::of_channel(&measured, 1);
        assert!((found.residual - 0.1 / 1.1).abs() < 2e-3, "{}", found.residual);
    }

    #[test]
    fn bins_that_were_not_measured_count_for_nothing() {
        let mut measured = Merl::of_angles(|h, d| [product(h, d); 3]);
        measured.planes[2].iter_mut().step_by(3).for_each(|value| *value = -1.0);
        measured.planes[2][..PHI_D * THETA_D].fill(-1.0);
        let found = Factors::of_channel(&measured, 2);
        assert!(found.residual < 1e-7 && (found.f[0] - found.f[1]).abs() < 1e-12, "{found:?}");
    }
}
