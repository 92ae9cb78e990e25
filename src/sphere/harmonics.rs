//! Functions on the sphere as series of harmonics.
//!
//! Zonal ones are Legendre series, `f(u) = sum_l (2l+1)/(4 pi) f_l P_l(u)`, `f_0 = 1` where f integrates to 1; the
//! convolution of two of them multiplies their coefficients (Funk-Hecke). Others take the real orthonormal basis
//! `Y_lm`, without the Condon-Shortley phase: `Y_1 = sqrt(3/(4 pi)) (y, z, x)` for m = -1, 0, 1.

use std::f64::consts::{PI, SQRT_2};

use glam::DVec3;

/// Least steps of the continued fraction beyond the last coefficient asked for.
const RUN_UP: usize = 40;

/// `A_l = I_{l+1/2}(kappa) / I_{1/2}(kappa)`, the coefficients of the von Mises-Fisher lobe, for `l < bands`.
///
/// `A_{l+1} = A_{l-1} - (2l+1)/kappa A_l` loses all digits upward once `l > kappa`. The ratios
/// `R_l = A_{l+1} / A_l = 1 / ((2l+3)/kappa + R_{l+1})` are run downward instead, a continued fraction that forgets
/// its start, here the bound `kappa / (l+1 + sqrt((l+2)^2 + kappa^2))` (Amos 1974), by a factor `R_l^2` a step: of
/// `exp(-36)` from `l = 6 sqrt(kappa)` down to 0.
pub fn vmf_zonal(kappa: f64, bands: usize) -> Vec<f64> {
    zonal_ratios(kappa, bands, bands.max((6.0 * kappa.sqrt()) as usize) + RUN_UP)
}

/// The coefficients from ratios that are run downward from `start`.
fn zonal_ratios(kappa: f64, bands: usize, start: usize) -> Vec<f64> {
    let last = start as f64;
    let mut ratio = kappa / (last + 1.0 + ((last + 2.0) * (last + 2.0) + kappa * kappa).sqrt());
    let mut coefficients = vec![0.0; bands];
    for l in (0..start).rev() {
        // kappa / (..) and not 1 / (../kappa): kappa may be 0.
        ratio = kappa / ((2 * l + 3) as f64 + kappa * ratio);
        if let Some(next) = coefficients.get_mut(l + 1) {
            *next = ratio;
        }
    }
    let mut product = 1.0;
    for coefficient in coefficients.iter_mut().skip(1) {
        product *= *coefficient;
        *coefficient = product;
    }
    if let Some(first) = coefficients.first_mut() {
        *first = 1.0;
    }
    coefficients
}

/// Steps of [`vmf_zonal_low`] beyond the last coefficient.
const SHORT_RUN_UP: usize = 8;

/// [`vmf_zonal`] for pictures, within 3e-5: the bound at the start is so near for wide and for sharp lobes that a few
/// steps do. The twin of the shader's.
pub fn vmf_zonal_low(kappa: f64, bands: usize) -> Vec<f64> {
    zonal_ratios(kappa, bands, bands + SHORT_RUN_UP)
}

/// The coefficients of `(s+1)/(2 pi) max(u, 0)^s`, normalised Blinn-Phong, exact for any `s > 0`, for `l < bands`:
/// `rho_0 = 1`, `rho_1 = (s+1)/(s+2)`, `rho_l = rho_{l-2} (s-l+2)/(s+l+1)`. The Lambertian is s = 1.
pub fn cosine_power_zonal(exponent: f64, bands: usize) -> Vec<f64> {
    let mut coefficients = vec![1.0, (exponent + 1.0) / (exponent + 2.0)];
    for l in 2..bands.max(2) {
        let l_f = l as f64;
        coefficients.push(coefficients[l - 2] * (exponent - l_f + 2.0) / (exponent + l_f + 1.0));
    }
    coefficients.truncate(bands);
    coefficients
}

/// The coefficients of the same lobe as Han et al. 2007 (section 5) have them, `exp(-l^2 / (2s))`, for `l < bands`:
/// an approximation that holds while `l < s + 1`.
pub fn cosine_power_zonal_of_paper(exponent: f64, bands: usize) -> Vec<f64> {
    (0..bands).map(|l| (-((l * l) as f64) / (2.0 * exponent)).exp()).collect()
}

/// How many `Y_lm` there are for `l <= last_band`.
pub const fn harmonics_to(last_band: usize) -> usize {
    (last_band + 1) * (last_band + 1)
}

/// Shows every `Y_lm` of a unit vector for `l <= last_band` as `(l, value)`: m by m from 0 up, and within it l by l,
/// `Y_lm` before `Y_l,-m`, so that nothing needs to be kept but the last two Legendre functions of one m.
///
/// With `P = sqrt((2l+1)/(4 pi) (l-m)!/(l+m)!) P_l^m(z) / sin^m` the recursions are `P_mm = P_m-1,m-1 sqrt((2m+1)/(2m))`
/// and `P_lm = a (z P_l-1,m - b P_l-2,m)`, `a^2 = (4 l^2 - 1)/(l^2 - m^2)`, `b^2 = ((l-1)^2 - m^2)/(4 (l-1)^2 - 1)`:
/// upward in l, which is stable.
pub fn each_harmonic(direction: DVec3, last_band: usize, mut visit: impl FnMut(usize, f64)) {
    let DVec3 { x, y, z } = direction;
    let mut diagonal = (0.25 / PI).sqrt();
    // sin^m cos(m phi) and sin^m sin(m phi).
    let (mut cos, mut sin) = (1.0, 0.0);
    for m in 0..=last_band {
        if m > 0 {
            diagonal *= ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
            (cos, sin) = (cos * x - sin * y, sin * x + cos * y);
        }
        let (mut previous, mut current) = (0.0, diagonal);
        for l in m..=last_band {
            if l > m {
                (previous, current) = (current, legendre_step(l, m, z, current, previous));
            }
            if m == 0 {
                visit(l, current);
            } else {
                visit(l, SQRT_2 * current * cos);
                visit(l, SQRT_2 * current * sin);
            }
        }
    }
}

/// The normalised Legendre function of `l > m` from those of `l - 1` and `l - 2`.
fn legendre_step(l: usize, m: usize, z: f64, last: f64, second_last: f64) -> f64 {
    let (l2, m2, k2) = ((l * l) as f64, (m * m) as f64, ((l - 1) * (l - 1)) as f64);
    let a = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
    let b = if l > m + 1 { ((k2 - m2) / (4.0 * k2 - 1.0)).sqrt() } else { 0.0 };
    a * (z * last - b * second_last)
}

/// `sum_l (2l+1)/(4 pi) f_l P_l(u)`, by the upward recursion of P_l, which is stable for `|u| <= 1`.
pub fn zonal_series(coefficients: impl Iterator<Item = f64>, u: f64) -> f64 {
    let u = u.clamp(-1.0, 1.0);
    let (mut previous, mut current, mut sum) = (0.0, 1.0, 0.0);
    for (l, coefficient) in coefficients.enumerate() {
        let l = l as f64;
        sum += (2.0 * l + 1.0) * coefficient * current;
        (previous, current) = (current, ((2.0 * l + 1.0) * u * current - l * previous) / (l + 1.0));
    }
    sum / (4.0 * PI)
}

/// [`zonal_series`] at many cosines at once, several times as fast.
pub fn zonal_series_at(coefficients: &[f64], cosines: &[f64]) -> Vec<f64> {
    let mut terms: Vec<[f64; 4]> = cosines.iter().map(|u| [u.clamp(-1.0, 1.0), 0.0, 1.0, 0.0]).collect();
    for (l, coefficient) in coefficients.iter().enumerate() {
        let l = l as f64;
        let (factor, up, down) = ((2.0 * l + 1.0) * coefficient, (2.0 * l + 1.0) / (l + 1.0), l / (l + 1.0));
        for [u, previous, current, sum] in &mut terms {
            *sum += factor * *current;
            (*previous, *current) = (*current, up * *u * *current - down * *previous);
        }
    }
    terms.into_iter().map(|[.., sum]| sum / (4.0 * PI)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::vmf;

    #[test]
    fn a_short_run_up_is_near_enough_for_pictures() {
        for exponent in -30..=70 {
            let kappa = 10.0_f64.powf(f64::from(exponent) / 10.0);
            let (low, exact) = (vmf_zonal_low(kappa, 13), vmf_zonal(kappa, 13));
            let worst = low.iter().zip(&exact).map(|(low, exact)| (low - exact).abs()).fold(0.0, f64::max);
            assert!(worst < 3e-5, "kappa {kappa}: {worst}");
        }
    }

    #[test]
    fn the_first_vmf_coefficient_is_the_mean_resultant_length_and_each_obeys_the_recursion() {
        for kappa in [1e-3, 0.3, 5.0, 80.0, 3e3, 1e5] {
            let a = vmf_zonal(kappa, 30);
            assert!((a[1] / vmf::mean_resultant_length(kappa) - 1.0).abs() < 1e-9, "kappa {kappa}: {}", a[1]);
            for l in 1..29 {
                let residual = a[l + 1] - (a[l - 1] - (2 * l + 1) as f64 / kappa * a[l]);
                assert!(residual.abs() < 1e-12 * (1.0 + 60.0 / kappa), "kappa {kappa}, l {l}: {residual}");
            }
        }
        assert_eq!(vmf_zonal(0.0, 4), [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn the_lambertian_is_the_cosine_power_of_one() {
        let rho = cosine_power_zonal(1.0, 5);
        for (found, exact) in rho.iter().zip([1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0]) {
            assert!((found - exact).abs() < 1e-15, "{rho:?}");
        }
    }

    #[test]
    fn the_first_harmonics_are_the_coordinates() {
        let n = DVec3::new(0.36, -0.48, 0.8);
        let mut found = Vec::new();
        each_harmonic(n, 1, |l, value| found.push((l, value)));
        let scale = (0.75 / PI).sqrt();
        let exact = [(0, (0.25 / PI).sqrt()), (1, scale * n.z), (1, scale * n.x), (1, scale * n.y)];
        assert_eq!(found.len(), exact.len());
        for (found, exact) in found.iter().zip(exact) {
            assert!(found.0 == exact.0 && (found.1 - exact.1).abs() < 1e-15, "{found:?}");
        }
    }

    #[test]
    fn harmonics_obey_the_addition_theorem() {
        let (a, b) = (DVec3::new(0.1, 0.7, 0.4).normalize(), DVec3::new(-0.5, 0.2, -0.3).normalize());
        let mut of_a = Vec::new();
        each_harmonic(a, 22, |_, value| of_a.push(value));
        assert_eq!(of_a.len(), harmonics_to(22));
        let (mut sums, mut next) = ([0.0; 23], of_a.iter());
        each_harmonic(b, 22, |l, value| sums[l] += value * next.next().expect("as many"));
        for (l, sum) in sums.into_iter().enumerate() {
            let mut only = [0.0; 23];
            only[l] = 1.0;
            let exact = zonal_series(only.into_iter(), a.dot(b));
            assert!((sum - exact).abs() < 1e-12, "{l}: {sum} against {exact}");
        }
    }

    #[test]
    fn the_series_of_a_smooth_lobe_is_the_lobe() {
        for u in [-1.0, -0.3, 0.0, 0.5, 0.9, 1.0_f64] {
            let power = zonal_series(cosine_power_zonal(10.0, 60).into_iter(), u);
            assert!((power - 11.0 / (2.0 * PI) * u.max(0.0).powi(10)).abs() < 1e-9, "{u}");
            let lobe = zonal_series(vmf_zonal(40.0, 80).into_iter(), u);
            let both = zonal_series_at(&vmf_zonal(40.0, 80), &[0.2, u]);
            assert!((both[1] - lobe).abs() < 1e-12, "{u}");
            assert!((lobe - (vmf::log_peak(40.0) + 40.0 * (u - 1.0)).exp()).abs() < 1e-9, "{u}");
        }
    }
}
