//! How finely directions are stored, and the concentration that this limits.
//!
//! A component rounded to steps of `2 / (2^bits - 1)` errs with a variance of a twelfth of the step's square. A lobe
//! whose own variance per component, `1 / kappa`, is smaller shows the rounding and not the surface:
//! `kappa < 3 (2^bits - 1)^2`.

use super::{Confidence, Finding, Subject};
use crate::image_io::{RasterImage, SampleDepth, Samples};
use crate::sphere::vmf::KAPPA_MAX;

/// Bits of a half float between one half and one, its implied one included: x and y of flat normals lie about there.
const HALF_BITS: i32 = 11;

pub(super) fn finding(image: &RasterImage, is_heights: bool) -> Finding {
    let widened = holds_eight_bits(image);
    let bits = match image.depth {
        SampleDepth::Bits16 if !widened => 16,
        SampleDepth::Bits8 | SampleDepth::Bits16 => 8,
        SampleDepth::Half => HALF_BITS,
        SampleDepth::Float => f32::MANTISSA_DIGITS as i32,
    };
    let answer = if widened { "8 bits widened to 16" } else { image.depth.label() };
    let reason = if is_heights { steps(bits) } else { limit(bits) };
    Finding::new(Subject::Depth, answer, Confidence::Certain, reason).doubted(widened)
}

fn steps(bits: i32) -> String {
    format!("heights are stored in {:.0} steps", 2.0_f64.powi(bits))
}

fn limit(bits: i32) -> String {
    let kappa = 3.0 * (2.0_f64.powi(bits) - 1.0).powi(2);
    if kappa > 10.0 * KAPPA_MAX {
        return format!("rounding blurs no lobe before kappa {kappa:.0e}, far beyond the {KAPPA_MAX:.0e} of fits");
    }
    let degrees = (2.0 / (2.0_f64.powi(bits) - 1.0)).to_degrees();
    format!(
        "steps of {degrees:.2} degrees show no lobe sharper than kappa {kappa:.0e}; fits stop at {KAPPA_MAX:.0e} for that"
    )
}

/// True for samples of 16 bits that are all samples of 8 bits, widened.
fn holds_eight_bits(image: &RasterImage) -> bool {
    match &image.samples {
        Samples::U16(values) => values.iter().all(|value| value % 257 == 0),
        Samples::U8(_) | Samples::F32(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_bits_limit_kappa_to_2e5() {
        assert!(limit(8).contains("kappa 2e5; fits stop at 1e5"), "{}", limit(8));
        assert!(limit(16).contains("far beyond"), "{}", limit(16));
    }
}
