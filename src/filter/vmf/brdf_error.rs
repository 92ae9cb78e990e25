//! How far a texel's lobes are from the truth when a usual material shades them: the relative L2 error of the effective
//! BRDF (Han et al. 2007, eq. 4) over the hemisphere, from fixed directions.

use std::sync::OnceLock;

use glam::DVec3;

use super::em::TexelLobes;
use super::kernel::SampleSlices;
use super::lanes::{exp2_of_negative, ln_of_positive};
use super::samples::Samples;
use crate::brdf::ConvolutionRule;
use crate::filter::brdf_error::RelativeL2;
use crate::sphere::direction;
use crate::sphere::mixture::EMPTY_WEIGHT;
use crate::sphere::vmf;

/// The Blinn-Phong exponent of the error.
pub const SHININESS: i32 = 64;

/// Directions over the hemisphere, 9 degrees apart; half the width of a lobe of s = 64.
const DIRECTIONS: usize = 256;

/// The directions as structure of arrays.
struct Directions {
    x: [f32; DIRECTIONS],
    y: [f32; DIRECTIONS],
    z: [f32; DIRECTIONS],
}

fn directions() -> &'static Directions {
    static DIRECTIONS_SOA: OnceLock<Directions> = OnceLock::new();
    DIRECTIONS_SOA.get_or_init(|| {
        let mut soa = Directions { x: [0.0; DIRECTIONS], y: [0.0; DIRECTIONS], z: [0.0; DIRECTIONS] };
        for (i, omega) in direction::hemisphere(DIRECTIONS).enumerate() {
            let omega: DVec3 = omega;
            (soa.x[i], soa.y[i], soa.z[i]) = omega.as_vec3().into();
        }
        soa
    })
}

/// Values of a function in the fixed directions, and the weight they were summed with.
#[derive(Clone, Copy, Debug)]
struct Values {
    value: [f32; DIRECTIONS],
    total: f64,
}

impl Default for Values {
    fn default() -> Self {
        Self { value: [0.0; DIRECTIONS], total: 0.0 }
    }
}

impl std::ops::AddAssign<&Self> for Values {
    fn add_assign(&mut self, other: &Self) {
        self.value.iter_mut().zip(&other.value).for_each(|(sum, value)| *sum += value);
        self.total += other.total;
    }
}

/// The effective BRDF of a footprint, without its constant factor.
#[derive(Clone, Copy, Debug)]
pub struct TrueBrdf {
    value: [f32; DIRECTIONS],
}

impl TrueBrdf {
    /// Of weighted normals; `None` where no sample has weight.
    pub fn new(samples: &impl Samples) -> Option<Self> {
        let sums: Values = samples.sum(accumulate);
        if sums.total <= 0.0 {
            return None;
        }
        let scale = (1.0 / sums.total) as f32;
        Some(Self { value: sums.value.map(|value| value * scale) })
    }

    /// The relative L2 error of `lobes`, by the default convolution rule.
    pub fn error(&self, lobes: &TexelLobes) -> f64 {
        let pairs = shaded(lobes).into_iter().zip(self.value);
        RelativeL2::of(pairs.map(|(value, truth)| (f64::from(value), f64::from(truth))))
    }
}

/// The lobes' effective BRDF in the fixed directions.
fn shaded(lobes: &TexelLobes) -> [f32; DIRECTIONS] {
    let mut value = [0.0_f32; DIRECTIONS];
    for j in (0..lobes.count).filter(|&j| lobes.alpha[j] > f64::from(EMPTY_WEIGHT)) {
        add_lobe(lobes.alpha[j], lobes.resultant[j], &mut value);
    }
    value
}

/// Adds `w max(n.omega, 0)^64` of every sample: six squarings.
#[multiversion::multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+fma", "x86_64+sse4.1"))]
fn accumulate(samples: &SampleSlices, sums: &mut Values) {
    let directions = directions();
    let places = samples.x.iter().zip(samples.y).zip(samples.z).zip(samples.w);
    for (((&x, &y), &z), &w) in places {
        if w <= 0.0 {
            continue;
        }
        sums.total += f64::from(w);
        for (i, value) in sums.value.iter_mut().enumerate() {
            let mut cosine = (x * directions.x[i] + y * directions.y[i] + z * directions.z[i]).max(0.0);
            for _ in 0..SHININESS.ilog2() {
                cosine *= cosine;
            }
            *value += w * cosine;
        }
    }
}

/// Adds `alpha (s'+1)/(s+1) max(mu.omega, 0)^s'`: the same unit as the truth's.
#[multiversion::multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+fma", "x86_64+sse4.1"))]
fn add_lobe(alpha: f64, resultant: DVec3, value: &mut [f32; DIRECTIONS]) {
    let directions = directions();
    let kappa = vmf::concentration(1.0 - resultant.length());
    let exponent = ConvolutionRule::default().blurred_exponent(kappa, f64::from(SHININESS));
    let peak = (alpha * (exponent + 1.0) / (f64::from(SHININESS) + 1.0)) as f32;
    let [x, y, z] = resultant.normalize_or(DVec3::Z).as_vec3().to_array();
    let exponent = exponent as f32;
    for (i, value) in value.iter_mut().enumerate() {
        let cosine = x * directions.x[i] + y * directions.y[i] + z * directions.z[i];
        // A cosine of 0 or less gives a logarithm so low that its exponential is nothing, save for a uniform lobe.
        let log2 = ln_of_positive::<false>(cosine.clamp(1e-30, 1.0)) * std::f32::consts::LOG2_E;
        *value += peak * exp2_of_negative::<false>((exponent * log2).min(0.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{BlinnPhong, Brdf};
    use crate::filter::vmf::effective_brdf;
    use crate::filter::vmf::samples::FootprintSamples;
    use crate::ndf::Ndf;
    use crate::normal_map::procedural;
    use crate::normal_map::pyramid::{Footprint, Texel};
    use crate::sphere::Mixture;

    #[test]
    fn the_error_is_that_of_the_sums_in_f64() {
        let map = procedural::find("bricks").expect("bundled").make(64);
        let texel = Texel { level: 4, x: 1, y: 2 };
        let samples = FootprintSamples::new(&map, Footprint::new((64, 64), (4, 4), (1, 2)));
        let mut lobes = TexelLobes::empty(2);
        (lobes.alpha[0], lobes.resultant[0]) = (0.7, DVec3::new(0.1, 0.0, 0.9));
        (lobes.alpha[1], lobes.resultant[1]) = (0.3, DVec3::new(-0.3, 0.2, 0.6));
        let stored: Vec<[f32; 4]> = (0..2).map(|j| lobes.stored(j)).collect();
        let mixture = Mixture::from_stored(&stored);
        let brdf = Brdf::BlinnPhong(BlinnPhong { shininess: f64::from(SHININESS) });
        let (mut squares, mut energy) = (0.0, 0.0);
        for omega in direction::hemisphere(DIRECTIONS) {
            let truth = Ndf::of_texel(&map, texel).effective_brdf(brdf, omega);
            let value = effective_brdf(&mixture, brdf, omega, ConvolutionRule::default());
            squares += (value - truth) * (value - truth);
            energy += truth * truth;
        }
        let found = TrueBrdf::new(&samples).expect("valid normals").error(&lobes);
        let exact: f64 = (squares / energy).sqrt();
        assert!((found - exact).abs() < 1e-4 * exact, "{found} {exact}");
    }
}
