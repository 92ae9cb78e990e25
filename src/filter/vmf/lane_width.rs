//! A lobe's width as loops over lanes work it out: [`super::phi::Width`] in single precision and without branches.
//!
//! With `A = A(K)` known, `A' = 1 - A^2 - 2 A / K`, `A'' = -2 (A A' + A' / K - A / K^2)` and the density at the peak is
//! `(1 + K (1 + A)) / (4 pi)`: from `coth K = A + 1/K`, so no exponential is needed. For sharp lobes the first two
//! cancel; there `K = 1 / (1 - A)`, `A' = 1 / K^2` and `A'' = -2 / K^3`. For broad ones A and A'' follow from their series.

use std::f32::consts::PI;

use super::lanes::exp_of_negative;
use super::lobe_lanes::banerjee_correction;

/// `1 - A` below which a lobe is sharp, K above 10: e^-20 is nothing in single precision.
const SHARP: f32 = 0.1;

/// K below which a lobe is broad: series take over from closed forms that cancel.
const BROAD: f32 = 0.5;

/// A concentration with `A` and its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct LaneWidth {
    /// K.
    pub kappa: f32,
    /// `A(K)`.
    pub length: f32,
    /// `1 - A(K)`.
    pub shortfall: f32,
    /// `A'(K)`.
    pub slope: f32,
    /// `A''(K)`.
    pub curvature: f32,
    /// The density at the lobe's own direction.
    pub peak: f32,
}

impl LaneWidth {
    /// Of `1 - A` between 0 and 1; to 4e-5, its first derivative to 3e-4 and its second to 3e-3. Lengths near 1 differ by
    /// their rounding: what is left of 1 has the digits.
    #[inline(always)]
    pub fn of_shortfall<const FMA: bool>(shortfall: f32) -> Self {
        let shortfall = shortfall.max(f32::EPSILON);
        let length = 1.0 - shortfall;
        let square = length * length;
        let banerjee = length * (3.0 - square) / (1.0 - square).max(f32::EPSILON);
        let wide = (banerjee * banerjee_correction::<FMA>(2.0 * square - 1.0)).max(1e-6);
        let sharp = shortfall < SHARP;
        let reciprocal = 1.0 / if sharp { shortfall } else { wide };
        let (kappa, inverse) = if sharp { (reciprocal, shortfall) } else { (wide, reciprocal) };
        Self::new(kappa, inverse, length, shortfall)
    }

    /// Of a concentration above 0.
    #[inline(always)]
    pub fn of_kappa<const FMA: bool>(kappa: f32) -> Self {
        let inverse = 1.0 / kappa;
        let e = exp_of_negative::<FMA>(-2.0 * kappa);
        let closed = (1.0 + e) / (1.0 - e).max(f32::EPSILON) - inverse;
        let k2 = kappa * kappa;
        let series = kappa * (1.0 / 3.0 - k2 * (1.0 / 45.0 - k2 * (2.0 / 945.0 - k2 / 4725.0)));
        let length = if kappa < BROAD { series } else { closed };
        Self::new(kappa, inverse, length, if inverse < SHARP { inverse } else { 1.0 - length })
    }

    #[inline(always)]
    fn new(kappa: f32, inverse: f32, length: f32, shortfall: f32) -> Self {
        let sharp = inverse < SHARP;
        let slope = if sharp { inverse * inverse } else { 1.0 - length * length - 2.0 * length * inverse };
        let wide = -2.0 * (length * slope + inverse * (slope - length * inverse));
        let k2 = kappa * kappa;
        let broad = kappa * (-2.0 / 15.0 + k2 * (8.0 / 189.0 - k2 * (6.0 / 675.0)));
        let middle = if kappa < BROAD { broad } else { wide };
        let curvature = if sharp { -2.0 * slope * inverse } else { middle };
        let peak = (1.0 + kappa * (1.0 + length)) / (4.0 * PI);
        Self { kappa, length, shortfall, slope, curvature, peak }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::phi::Width;

    fn near(name: &str, kappa: f64, (value, exact): (f32, f64), tolerance: f64) {
        let value = f64::from(value);
        assert!((value - exact).abs() < tolerance * exact.abs(), "{name} at {kappa}: {value} {exact}");
    }

    #[test]
    fn a_lanes_width_is_the_width_in_double_precision() {
        for exponent in -20..=50 {
            let kappa = 10.0_f64.powf(f64::from(exponent) / 10.0);
            let exact = Width::of_kappa(kappa);
            let found = LaneWidth::of_kappa::<true>(kappa as f32);
            near("length", kappa, (found.length, exact.length), 3e-6);
            near("peak", kappa, (found.peak, exact.peak), 1e-5);
            // 1 - A^2 - 2 A / K is 1 / K^2 of what it is made of: some 1e-7 times 100.
            near("slope", kappa, (found.slope, exact.slope), 1e-4);
            if exact.length < 0.996 {
                let found = LaneWidth::of_shortfall::<true>((1.0 - exact.length) as f32);
                near("kappa", kappa, (found.kappa, exact.kappa), 4e-5);
                near("peak", kappa, (found.peak, exact.peak), 4e-5);
                near("slope", kappa, (found.slope, exact.slope), 3e-4);
                near("curvature", kappa, (found.curvature, exact.curvature), 3e-3);
            }
        }
    }
}
