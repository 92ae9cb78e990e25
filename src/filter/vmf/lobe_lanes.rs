//! Lobes as the E-step's loop reads them, a lobe in every lane, and how they follow from weights and mean vectors.
//!
//! `kappa = A^-1(|r|)` without iterations: Banerjee's closed form times a polynomial, fitted to least relative error,
//! within 2e-6 of the exact inverse. What enters is `1 - |r|^2`, because `|r|` alone loses the digits that matter
//! near 1.

use std::f32::consts::{LOG2_E, PI};

use super::kernel::LOG_ZERO;
use super::lanes::{LANES, Lanes, exp2_of_negative, ln_of_positive, mul_add, polynomial};
use crate::sphere::mixture::EMPTY_WEIGHT;
use crate::sphere::vmf::{KAPPA_MAX, KappaRule};

/// One lobe as the loop reads it: the same in all lanes, or another in each.
#[derive(Clone, Copy, Debug)]
pub struct LobeLanes {
    /// Mean directions, by axis.
    pub mu: [Lanes; 3],
    /// `-kappa / 2`, for exponents of 2.
    pub factor: Lanes,
    /// `ln(alpha) + ln(peak density)`, for exponents of 2.
    pub scale: Lanes,
}

impl LobeLanes {
    /// An empty slot.
    pub const EMPTY: Self = Self {
        mu: [Lanes::splat(0.0), Lanes::splat(0.0), Lanes::splat(1.0)],
        factor: Lanes::splat(0.0),
        scale: Lanes::splat(LOG_ZERO),
    };

    /// Lobes of these weights and mean vectors, `1 - |r|^2` given beside; a weight of an empty slot makes one.
    #[inline(always)]
    pub fn new<const FMA: bool>(alpha: &Lanes, resultant: &[Lanes; 3], shortfall: &Lanes, rule: KappaRule) -> Self {
        let mut lobe = Self::EMPTY;
        for i in 0..LANES {
            let [x, y, z] = [resultant[0].0[i], resultant[1].0[i], resultant[2].0[i]];
            let square = mul_add::<FMA>(x, x, mul_add::<FMA>(y, y, z * z));
            let directed = square > 1e-12;
            let inverse = 1.0 / if directed { square } else { 1.0 }.sqrt();
            for (mu, (r, up)) in lobe.mu.iter_mut().zip([(x, 0.0), (y, 0.0), (z, 1.0)]) {
                mu.0[i] = if directed { r * inverse } else { up };
            }
            let kappa = concentration::<FMA>(shortfall.0[i], rule).min(KAPPA_MAX as f32);
            let used = alpha.0[i] > EMPTY_WEIGHT;
            let log = ln_of_positive::<FMA>(if used { alpha.0[i] } else { 1.0 } * peak::<FMA>(kappa));
            lobe.factor.0[i] = -0.5 * LOG2_E * kappa;
            lobe.scale.0[i] = if used { log * LOG2_E } else { LOG_ZERO };
        }
        lobe
    }
}

/// `A^-1(sqrt(1 - shortfall))`: with `r = |r|`, Banerjee's `(3 r - r^3) / (1 - r^2)` times a polynomial of `2 r^2 - 1`.
#[inline(always)]
fn concentration<const FMA: bool>(shortfall: f32, rule: KappaRule) -> f32 {
    let shortfall = shortfall.clamp(1e-9, 1.0);
    let square = 1.0 - shortfall;
    let banerjee = square.sqrt() * (3.0 - square) / shortfall;
    let correction = banerjee_correction::<FMA>(square - shortfall);
    if rule == KappaRule::Exact { banerjee * correction } else { banerjee }
}

/// What Banerjee's closed form is to be multiplied by, a polynomial of `2 r^2 - 1`.
#[inline(always)]
pub fn banerjee_correction<const FMA: bool>(x: f32) -> f32 {
    polynomial::<FMA, 14>(
        x,
        [
            9.007_063e-3,
            9.999_03e-3,
            -3.202_864_4e-2,
            -3.961_819e-2,
            3.984_893e-2,
            6.461_186e-2,
            -1.091_729_3e-2,
            -5.463_053_6e-2,
            -2.605_191_8e-2,
            2.178_830_3e-2,
            5.450_753e-2,
            3.964_092e-2,
            -3.436_566_6e-2,
            9.582_098e-1,
        ],
    )
}

/// The density at the peak, `kappa / (2 pi (1 - exp(-2 kappa)))`; `x / (1 - exp(-x))` cancels near 0, its series does
/// not.
#[inline(always)]
fn peak<const FMA: bool>(kappa: f32) -> f32 {
    let x = 2.0 * kappa;
    let closed = x / (1.0 - exp2_of_negative::<FMA>(-LOG2_E * x)).max(f32::MIN_POSITIVE);
    let series = polynomial::<FMA, 5>(x, [-1.0 / 720.0, 0.0, 1.0 / 12.0, 0.5, 1.0]);
    (if x < 0.25 { series } else { closed }) / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::vmf;

    #[test]
    fn kappa_and_the_peak_agree_with_the_exact_ones() {
        for exponent in -20..=49 {
            let kappa = 10.0_f64.powf(f64::from(exponent) / 10.0);
            let length = if kappa > 50.0 { 1.0 - 1.0 / kappa } else { vmf::mean_resultant_length(kappa) };
            let shortfall = (1.0 - length) * (1.0 + length);
            let found = f64::from(concentration::<false>(shortfall as f32, KappaRule::Exact));
            // Near 0 it is |r| that the shortfall cannot tell: 6e-8 of r^2 = kappa^2 / 9.
            let tolerance = 3e-6 + 1e-6 / (kappa * kappa);
            assert!((found / kappa - 1.0).abs() < tolerance, "kappa {kappa}: {found}");
            let log_peak = f64::from(peak::<false>(kappa as f32).ln());
            assert!((log_peak - vmf::log_peak(kappa)).abs() < 2e-6, "kappa {kappa}: {log_peak}");
        }
    }

    #[test]
    fn an_empty_slot_and_a_lobe_without_direction_are_plain_numbers() {
        let zero = Lanes::splat(0.0);
        let empty = LobeLanes::new::<false>(&zero, &[zero; 3], &Lanes::splat(1.0), KappaRule::Exact);
        assert!(empty.scale.0[0] <= LOG_ZERO);
        let all = LobeLanes::new::<false>(&Lanes::splat(1.0), &[zero; 3], &Lanes::splat(1.0), KappaRule::Exact);
        assert!(all.factor.0[0] > -1e-3 && (all.mu[2].0[0] - 1.0).abs() < 1e-6);
        assert!((all.scale.0[0] + (4.0 * PI).log2()).abs() < 1e-3);
    }
}
