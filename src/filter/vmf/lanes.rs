//! Arithmetic on lanes: small arrays walked by one index, which the compiler turns into vectors.
//!
//! Where the processor has fused multiply-adds they are used: a version of a loop is compiled with `FMA` true for
//! those processors and false for the others. The bits of a fit may thus differ between processors in the last
//! places, never between runs or numbers of threads on one.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

/// Lanes in a group: samples are padded to a multiple of this with weight 0.
pub const LANES: usize = 16;

/// One group of lanes, placed so that a load never straddles two cache lines.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(64))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// The same value in every lane.
    #[inline(always)]
    pub const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// Adds lane by lane.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for i in 0..LANES {
            self.0[i] += other.0[i];
        }
    }
}

/// The lanes of group `group` of a slice, as a copy: what is behind a reference might be what the loop writes, and
/// asking whether it is costs more than the loop.
#[inline(always)]
pub fn lanes(slice: &[f32], group: usize) -> [f32; LANES] {
    match slice[group * LANES..].first_chunk() {
        Some(lanes) => *lanes,
        None => [0.0; LANES],
    }
}

/// The lanes of a slice from `start` on, as a copy; zeros beyond its end.
#[inline(always)]
pub fn window(slice: &[f32], start: usize) -> [f32; LANES] {
    match slice.get(start..).and_then(<[f32]>::first_chunk) {
        Some(lanes) => *lanes,
        None => [0.0; LANES],
    }
}

/// `a b + c`; fused only where that is one instruction, for elsewhere it is a call.
#[inline(always)]
pub fn mul_add<const FMA: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FMA { a.mul_add(b, c) } else { a * b + c }
}

/// A polynomial of `x`, the highest coefficient first.
#[inline(always)]
pub fn polynomial<const FMA: bool, const N: usize>(x: f32, coefficients: [f32; N]) -> f32 {
    let mut value = coefficients[0];
    for k in 1..N {
        value = mul_add::<FMA>(value, x, coefficients[k]);
    }
    value
}

/// `2^v` for `v <= 0`, relative error 2e-7, `2^-126` below -126: the integer part goes to the exponent, the rest through the
/// polynomial of least relative error on -1/2 .. 1/2 that is exact at 0 (9e-8 before rounding).
#[inline(always)]
pub fn exp2_of_negative<const FMA: bool>(v: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0; // 1.5 * 2^23: adding it rounds to an integer in the low mantissa bits.
    let v = v.max(-126.0);
    let shifted = v + ROUND;
    let rest = v - (shifted - ROUND);
    #[expect(clippy::approx_constant, reason = "the best coefficient is near ln 2 and not ln 2")]
    let p =
        polynomial::<FMA, 6>(rest, [1.326_472_7e-3, 9.671_513e-3, 5.550_733_6e-2, 2.402_224_2e-1, 6.931_47e-1, 1.0]);
    f32::from_bits(p.to_bits().wrapping_add(shifted.to_bits().wrapping_shl(23)))
}

/// `exp(v)` for `v <= 0`, through [`exp2_of_negative`].
#[inline(always)]
pub fn exp_of_negative<const FMA: bool>(v: f32) -> f32 {
    exp2_of_negative::<FMA>(v * std::f32::consts::LOG2_E)
}

/// `ln(v)` for normal positive `v`, relative error 1e-6: the polynomial of Cephes (Moshier 1992) without branches.
#[inline(always)]
pub fn ln_of_positive<const FMA: bool>(v: f32) -> f32 {
    // Mantissa in 1/sqrt(2) .. sqrt(2).
    let bits = v.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (bits as i32 >> 23) as f32;
    let m = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3)) - 1.0;
    let p = polynomial::<FMA, 9>(
        m,
        [
            7.037_683_6e-2,
            -1.151_461e-1,
            1.167_699_9e-1,
            -1.242_014_1e-1,
            1.424_932_3e-1,
            -1.666_805_8e-1,
            2.000_071_5e-1,
            -2.499_999_4e-1,
            3.333_333e-1,
        ],
    );
    let tail = m * m * mul_add::<FMA>(m, p, -0.5);
    m + mul_add::<FMA>(exponent, std::f32::consts::LN_2, tail)
}

/// The sum of all lanes, halves onto halves: short dependency chains and little rounding.
#[inline(always)]
pub fn halving_sum(mut lanes: [f32; LANES]) -> f32 {
    let mut half = LANES / 2;
    while half > 0 {
        for i in 0..half {
            lanes[i] += lanes[i + half];
        }
        half /= 2;
    }
    lanes[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exp_and_ln_are_right<const FMA: bool>() {
        for i in 0..12_600 {
            let v = -(i as f32) / 100.0;
            let exact = f64::from(v).exp2();
            assert!((f64::from(exp2_of_negative::<FMA>(v)) / exact - 1.0).abs() < 3e-7, "exp2 {v}");
        }
        for i in 1..2000 {
            let v = i as f32 / 100.0;
            assert!((f64::from(ln_of_positive::<FMA>(v)) - f64::from(v).ln()).abs() < 1e-6, "ln {v}");
        }
    }

    #[test]
    fn exp_and_ln_are_right_to_a_few_units_in_the_last_place() {
        exp_and_ln_are_right::<false>();
        exp_and_ln_are_right::<true>();
    }

    #[test]
    fn nothing_is_lost_at_the_peak_and_nothing_is_left_far_off() {
        assert_eq!(exp2_of_negative::<true>(0.0).to_bits(), 1.0_f32.to_bits());
        assert!(exp2_of_negative::<true>(-1e30) < 2e-38);
    }
}
