//! FLIP: the difference that an observer sees who flips between two displayed pictures, per pixel in `0..=1`.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. Fairchild: *FLIP: a difference evaluator
//! for alternating images*. HPG 2020. Both pictures go through two pipelines:
//! - **colour** (section 4.1): the contrast sensitivity of the eye as Gaussians in the opponent space YCxCz, then the
//!   HyAB distance in Hunt-adjusted L*a*b*, raised to 0.7 and squeezed into `0..=1`;
//! - **features** (section 4.2): edges and points of the achromatic channel by first and second derivatives of a
//!   Gaussian, the larger change of the two, over the root of 2, raised to 0.5.
//!
//! `FLIP = colour ^ (1 - feature)` (section 4.3). Every kernel is a sum of products of one function of x and one of y, so the
//! filters run along rows and then columns; pixels beyond the border repeat it. Sums run in f64: the exponents below 1
//! magnify what rounding leaves of equal pictures.

use glam::DVec3;
use rayon::prelude::*;

use super::Picture;
use super::flip_color::{color_difference, linear_from_opponent, opponent_from_linear};
use crate::color::{linear_from_srgb, srgb_from_linear};

/// Pixels per degree of visual angle where nothing is known of the observer: a display 0.7 m wide of 3840 pixels,
/// seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643_276_58;

/// Amplitude and width of the two Gaussians of each channel's contrast sensitivity: Y, Cx, Cz (table 1).
const SENSITIVITY: [[(f64, f64); 2]; 3] =
    [[(1.0, 0.0047), (0.0, 1e-5)], [(1.0, 0.0053), (0.0, 1e-5)], [(34.1, 0.04), (13.5, 0.025)]];

/// Width of the feature detectors in degrees: twice the Gaussian's standard deviation (section 4.2).
const FEATURE_WIDTH: f64 = 0.082;

/// A channel of a picture.
struct Plane {
    width: usize,
    height: usize,
    values: Vec<f64>,
}

/// A kernel along one axis; its middle lies on the pixel.
type Kernel = Vec<f64>;

/// The mean FLIP error over the covered pixels, of the pictures as sRGB shows them. `None` where nothing is seen or the
/// pictures differ in size.
pub fn flip(picture: &Picture, reference: &Picture) -> Option<f64> {
    mean_flip(&flip_map(picture, reference, PIXELS_PER_DEGREE)?, reference)
}

/// The mean of the errors of [`flip_map`] over the pixels that the reference covers; `None` where there is none.
pub fn mean_flip(errors: &[f64], reference: &Picture) -> Option<f64> {
    let seen = errors.iter().zip(&reference.covered).filter(|(_, covered)| **covered);
    let (sum, count) = seen.fold((0.0, 0_u32), |(sum, count), (error, _)| (sum + error, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// The FLIP error of every pixel, row by row, for a display of `ppd` pixels per degree. `None` where the pictures
/// differ in size.
pub fn flip_map(picture: &Picture, reference: &Picture, ppd: f64) -> Option<Vec<f64>> {
    let [width, height] = reference.size.map(|side| side as usize);
    if picture.size != reference.size || [&picture.rgb, &reference.rgb].iter().any(|rgb| rgb.len() != width * height) {
        return None;
    }
    let (a, b) = (opponent_planes(picture), opponent_planes(reference));
    let (a_seen, b_seen) = (seen_colors(&a, ppd), seen_colors(&b, ppd));
    let (a_features, b_features) = (features(&a[0], ppd), features(&b[0], ppd));
    let error = |index: usize| {
        let color = color_difference(a_seen[index], b_seen[index]);
        let change = |kind: usize| (a_features[kind][index] - b_features[kind][index]).abs();
        let feature = (change(0).max(change(1)) * std::f64::consts::FRAC_1_SQRT_2).sqrt();
        color.powf(1.0 - feature)
    };
    Some((0..width * height).map(error).collect())
}

/// Y, Cx and Cz of a picture as it is displayed: within `0..=1`, by way of sRGB.
fn opponent_planes(picture: &Picture) -> [Plane; 3] {
    let displayed = |rgb: &glam::Vec3| {
        let channels = rgb.to_array().map(|value| f64::from(linear_from_srgb(srgb_from_linear(value))));
        opponent_from_linear(DVec3::from(channels))
    };
    let opponent: Vec<DVec3> = picture.rgb.iter().map(displayed).collect();
    let [width, height] = picture.size.map(|side| side as usize);
    [0, 1, 2].map(|c| Plane { width, height, values: opponent.iter().map(|color| color[c]).collect() })
}

/// Linear RGB of what the eye resolves, within `0..=1`.
fn seen_colors(planes: &[Plane; 3], ppd: f64) -> Vec<DVec3> {
    let blurred: Vec<Vec<f64>> = planes.iter().zip(SENSITIVITY).map(|(plane, s)| sensed(plane, s, ppd)).collect();
    let color = |index| DVec3::new(blurred[0][index], blurred[1][index], blurred[2][index]);
    let linear = |index| linear_from_opponent(color(index)).clamp(DVec3::ZERO, DVec3::ONE);
    (0..planes[0].values.len()).map(linear).collect()
}

/// A channel under its contrast sensitivity `sum_i a_i sqrt(pi / b_i) exp(-pi^2 r^2 / b_i)`, scaled to sum to 1, on the
/// radius of the widest Gaussian of all channels.
fn sensed(plane: &Plane, gaussians: [(f64, f64); 2], ppd: f64) -> Vec<f64> {
    use std::f64::consts::PI;
    let widest = SENSITIVITY.iter().flatten().map(|(_, width)| *width).fold(0.0, f64::max);
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * ppd).ceil() as i32;
    let kernel = |b: f64| sampled(radius, |x| (-PI * PI * (x / ppd).powi(2) / b).exp());
    let parts: Vec<(f64, Kernel)> =
        gaussians.into_iter().filter(|(a, _)| *a > 0.0).map(|(a, b)| (a * (PI / b).sqrt(), kernel(b))).collect();
    let total: f64 = parts.iter().map(|(scale, kernel)| scale * kernel.iter().sum::<f64>().powi(2)).sum();
    let mut sum = vec![0.0; plane.values.len()];
    for (scale, kernel) in &parts {
        let blurred = plane.filtered(kernel, kernel);
        sum.iter_mut().zip(blurred).for_each(|(sum, value)| *sum += scale / total * value);
    }
    sum
}

/// How much of an edge and of a point each pixel is.
fn features(luminance: &Plane, ppd: f64) -> [Vec<f64>; 2] {
    // Y of YCxCz runs from -16 to 100.
    let values = luminance.values.iter().map(|y| (y + 16.0) / 116.0).collect();
    let plane = Plane { values, ..*luminance };
    let deviation = 0.5 * FEATURE_WIDTH * ppd;
    let radius = (3.0 * deviation).ceil() as i32;
    let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let across = sampled(radius, gaussian);
    let total: f64 = across.iter().sum();
    let across: Kernel = across.iter().map(|weight| weight / total).collect();
    let edge = balanced(sampled(radius, |x| -x * gaussian(x)));
    let point = balanced(sampled(radius, |x| (x * x / (deviation * deviation) - 1.0) * gaussian(x)));
    [edge, point].map(|along| {
        let (x, y) = (plane.filtered(&along, &across), plane.filtered(&across, &along));
        x.iter().zip(y).map(|(x, y)| x.hypot(y)).collect()
    })
}

fn sampled(radius: i32, function: impl Fn(f64) -> f64) -> Kernel {
    (-radius..=radius).map(|x| function(f64::from(x))).collect()
}

/// The kernel with its positive weights scaled to sum to 1 and its negative ones to -1.
fn balanced(kernel: Kernel) -> Kernel {
    let positive: f64 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    kernel.into_iter().map(|weight| weight / if weight < 0.0 { negative } else { positive }).collect()
}

impl Plane {
    /// Correlated with `along_x(x) along_y(y)`.
    fn filtered(&self, along_x: &[f64], along_y: &[f64]) -> Vec<f64> {
        let radius = |kernel: &[f64]| kernel.len() as isize / 2;
        let near = |place: usize, step: usize, radius: isize, size: usize| {
            (place as isize + step as isize - radius).clamp(0, size as isize - 1) as usize
        };
        let sum = |kernel: &[f64], value: &dyn Fn(usize) -> f64| -> f64 {
            kernel.iter().enumerate().map(|(step, weight)| weight * value(step)).sum()
        };
        let mut rows = vec![0.0; self.values.len()];
        rows.par_chunks_mut(self.width).zip(self.values.par_chunks(self.width)).for_each(|(row, values)| {
            for (x, out) in row.iter_mut().enumerate() {
                *out = sum(along_x, &|step| values[near(x, step, radius(along_x), self.width)]);
            }
        });
        let mut columns = vec![0.0; self.values.len()];
        columns.par_chunks_mut(self.width).enumerate().for_each(|(y, row)| {
            for (x, out) in row.iter_mut().enumerate() {
                *out = sum(along_y, &|step| rows[near(y, step, radius(along_y), self.height) * self.width + x]);
            }
        });
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn picture(color: impl Fn(u32, u32) -> Vec3) -> Picture {
        let size = [40, 30];
        let rgb = (0..30).flat_map(|y| (0..40).map(move |x| (x, y))).map(|(x, y)| color(x, y)).collect();
        Picture { size, rgb, covered: vec![true; 1200] }
    }

    fn wave(x: u32, y: u32) -> Vec3 {
        Vec3::new(0.5 + 0.4 * (x as f32 * 0.7).sin(), 0.3, 0.5 + 0.4 * (y as f32 * 0.5).cos())
    }

    #[test]
    fn flip_of_a_picture_and_itself_is_0() {
        assert_eq!(flip(&picture(wave), &picture(wave)), Some(0.0));
    }

    #[test]
    fn flip_of_either_way_round_is_the_same_and_within_0_to_1() {
        let (a, b) = (picture(wave), picture(|x, y| wave(y, x)));
        let (there, back) = (flip(&a, &b).expect("one size"), flip(&b, &a).expect("one size"));
        assert!((there - back).abs() < 1e-12 && there > 0.05, "{there} {back}");
        assert!(flip_map(&a, &b, PIXELS_PER_DEGREE).is_some_and(|map| map.iter().all(|e| (0.0..=1.0).contains(e))));
    }

    #[test]
    fn flat_green_and_blue_are_as_far_apart_as_can_be() {
        // cmax of section 4.1 is this very distance; flat pictures have no features.
        let error = flip(&picture(|_, _| Vec3::Y), &picture(|_, _| Vec3::Z)).expect("one size");
        assert!((error - 1.0).abs() < 1e-6, "{error}");
    }

    #[test]
    fn flat_white_and_black_are_told_apart_as_published() {
        // HyAB 100 of a maximum of 308.1: 100^0.7 = 25.1 lies above 0.4 of 55.2 (section 4.1).
        let error = flip(&picture(|_, _| Vec3::ONE), &picture(|_, _| Vec3::ZERO)).expect("one size");
        assert!((error - 0.95).abs() < 0.03, "{error}");
    }

    /// Of these pictures the authors' own program (flip-evaluator 1.7, single precision) finds the same.
    #[test]
    fn errors_are_those_of_the_authors_program() {
        let size = [64, 48];
        let drawn = |color: &dyn Fn(u32, u32) -> Vec3| {
            let rgb = (0..48).flat_map(|y| (0..64).map(move |x| (x, y))).map(|(x, y)| color(x, y)).collect();
            Picture { size, rgb, covered: vec![true; 64 * 48] }
        };
        let checks = |x: u32, y: u32| if (x / 8 + y / 8).is_multiple_of(2) { 0.25 } else { 0.75 };
        let reference = |x: u32, y: u32| Vec3::new(x as f32 / 64.0, y as f32 / 48.0, checks(x, y));
        let other = |x: u32, y: u32| {
            if (10..20).contains(&y) && (10..30).contains(&x) {
                return Vec3::splat(0.9);
            }
            let [r, g, b] = reference(x, y).to_array();
            Vec3::new(0.8 * r, if y == 30 { 0.1 } else { g }, b)
        };
        let (picture, truth) = (drawn(&other), drawn(&reference));
        let errors = flip_map(&picture, &truth, PIXELS_PER_DEGREE).expect("one size");
        let mean = mean_flip(&errors, &truth).expect("seen");
        assert!((mean - 0.313_857).abs() < 1e-5, "{mean}");
        for (x, y, published) in [(0, 0, 0.019_325), (15, 15, 0.909_775), (40, 30, 0.570_159), (20, 9, 0.830_741)] {
            let error = errors[y * 64 + x];
            assert!((error - published).abs() < 2e-5, "({x}, {y}): {error} {published}");
        }
    }

    #[test]
    fn a_larger_difference_is_a_larger_error() {
        let errors = [0.02_f32, 0.1, 0.3].map(|more| flip(&picture(|x, y| wave(x, y) * (1.0 - more)), &picture(wave)));
        assert!(errors[0] < errors[1] && errors[1] < errors[2], "{errors:?}");
    }

    #[test]
    fn what_is_not_seen_does_not_count_and_sizes_must_agree() {
        let mut reference = picture(wave);
        let mut other = picture(wave);
        reference.covered.fill(false);
        assert_eq!(flip(&other, &reference), None);
        other.size = [30, 40];
        assert_eq!(flip(&other, &reference), None);
    }
}
