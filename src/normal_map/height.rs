//! Heights to normals.
//!
//! By central differences `h_s = scale * (h(x+1) - h(x-1)) / 2` and likewise upwards for `h_t`; by Sobel's kernels the
//! mean of three neighbouring ones, weighted 1, 2, 1, which smooths noise across the slope. The normal is
//! `(-h_s, -h_t, 1)`, normalised. After M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited* (2008), section
//! 2.5.2, whose factors m and n (texels per unit of texture space) are absorbed in `scale`: heights are measured in
//! texel widths.
//!
//! Valid for finite heights. A texel whose neighbour is not finite has no normal.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Addressing;
use crate::image_io::RasterImage;
use crate::scene::bump::HeightSample;

/// How slopes are taken from heights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SlopeKernel {
    /// The difference of the two neighbours.
    #[default]
    Central,
    /// That difference, smoothed across the slope (Sobel's kernels over 4).
    Sobel,
}

/// The height of a texel: the mean of its colour channels, an integer's full scale as 1.
pub(super) fn height_of(image: &RasterImage, texel: usize) -> f64 {
    let (first, color) = (texel * image.channels, image.color_channels());
    let sum: f64 = (first..first + color).map(|index| image.samples.get(index)).sum();
    sum / (color as f64 * image.samples.full_scale().unwrap_or(1.0))
}

/// Height and slopes at a point of the map, v down, interpolated between the four texels around it; slopes by texture
/// coordinates, t up.
pub fn sample(image: &RasterImage, uv: DVec2, addressing: Addressing, kernel: SlopeKernel) -> HeightSample {
    let size = DVec2::new(image.width as f64, image.height as f64);
    let at = uv * size - 0.5;
    let share = at - at.floor();
    let texel = |step: DVec2| {
        let inside = |value: f64, count: usize| match addressing {
            Addressing::Wrap => value.rem_euclid(count as f64) as usize % count,
            Addressing::Clamp => value.clamp(0.0, (count - 1) as f64) as usize,
        };
        let place = at.floor() + step;
        (inside(place.x, image.width), inside(place.y, image.height))
    };
    let mut sum = HeightSample::default();
    for step in [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE] {
        let weights = DVec2::ONE - (step - share).abs();
        let (x, y) = texel(step);
        let height = |x: usize, y: usize| height_of(image, y * image.width + x);
        let slope = size * half_differences((image.width, image.height), height, (x, y), addressing, kernel);
        sum.height += weights.x * weights.y * height(x, y);
        sum.slope += weights.x * weights.y * slope;
    }
    sum
}

/// What the heights rise from one texel to the next, rightwards and upwards, around a texel.
fn half_differences(
    (width, rows): (usize, usize),
    height: impl Fn(usize, usize) -> f64,
    (x, y): (usize, usize),
    addressing: Addressing,
    kernel: SlopeKernel,
) -> DVec2 {
    let (left, right) = neighbours(x, width, addressing);
    let (above, below) = neighbours(y, rows, addressing);
    let across = |y: usize| (height(right, y) - height(left, y)) / 2.0;
    let upwards = |x: usize| (height(x, above) - height(x, below)) / 2.0;
    match kernel {
        SlopeKernel::Central => DVec2::new(across(y), upwards(x)),
        SlopeKernel::Sobel => {
            let smooth = |[before, here, after]: [f64; 3]| (before + 2.0 * here + after) / 4.0;
            DVec2::new(smooth([above, y, below].map(across)), smooth([left, x, right].map(upwards)))
        }
    }
}

/// A map of heights, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightMap {
    /// Texels across.
    pub width: usize,
    /// Texels down.
    pub height: usize,
    /// The heights: 0..=1 where they come from integers, any float otherwise.
    pub values: Vec<f64>,
}

impl HeightMap {
    /// Takes the mean of the colour channels as height, an integer's full scale as 1.
    pub fn from_image(image: &RasterImage) -> Self {
        let values = (0..image.texels()).map(|texel| height_of(image, texel)).collect();
        Self { width: image.width, height: image.height, values }
    }

    /// The unit normal of every texel in tangent space, `+y` up the image; `None` where a neighbour is not finite.
    ///
    /// `scale` is the height, in texel widths, that a step of 1 in the values stands for. At a clamped edge the
    /// missing neighbour is the edge texel itself, so the slope there is half the one-sided difference.
    pub fn normals(&self, scale: f64, addressing: Addressing, kernel: SlopeKernel) -> Vec<Option<DVec3>> {
        let height = |x: usize, y: usize| self.values[y * self.width + x];
        let normal_at = |texel: usize| {
            let at = (texel % self.width, texel / self.width);
            let slope = scale * half_differences((self.width, self.height), height, at, addressing, kernel);
            slope.is_finite().then(|| (-slope).extend(1.0).normalize())
        };
        (0..self.values.len()).into_par_iter().map(normal_at).collect()
    }
}

/// The texels before and after `index` along an axis of `count` texels.
fn neighbours(index: usize, count: usize, addressing: Addressing) -> (usize, usize) {
    match addressing {
        Addressing::Wrap => ((index + count - 1) % count, (index + 1) % count),
        Addressing::Clamp => (index.saturating_sub(1), (index + 1).min(count - 1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp_up_the_image() -> HeightMap {
        // Row 0 is the top and the highest.
        let values = (0..16).map(|texel| f64::from(3 - texel / 4)).collect();
        HeightMap { width: 4, height: 4, values }
    }

    #[test]
    fn a_slope_that_rises_up_the_image_leans_down_it() {
        let normals = ramp_up_the_image().normals(1.0, Addressing::Clamp, SlopeKernel::Central);
        let inner = normals[5].unwrap();
        let half = 0.5_f64.sqrt();
        assert!((inner - DVec3::new(0.0, -half, half)).length() < 1e-15);
        let edge = normals[1].unwrap();
        assert!((edge.y / edge.z + 0.5).abs() < 1e-15, "half the one-sided difference");
    }

    #[test]
    fn wrapping_takes_the_opposite_edge() {
        let top = ramp_up_the_image().normals(1.0, Addressing::Wrap, SlopeKernel::Central)[0].unwrap();
        // Above the top row (3) lies the bottom row (0); below it lies 2: the slope is (0 - 2) / 2.
        assert!((top.y / top.z - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_level_surface_is_flat_at_any_size() {
        for (width, height) in [(1, 1), (1, 5), (7, 3)] {
            let map = HeightMap { width, height, values: vec![0.25; width * height] };
            for addressing in [Addressing::Wrap, Addressing::Clamp] {
                for kernel in [SlopeKernel::Central, SlopeKernel::Sobel] {
                    assert!(map.normals(100.0, addressing, kernel).iter().all(|&normal| normal == Some(DVec3::Z)));
                }
            }
        }
    }

    #[test]
    fn a_neighbour_that_is_not_finite_leaves_no_normal() {
        let map = HeightMap { width: 3, height: 1, values: vec![0.0, 0.0, f64::NAN] };
        let normals = map.normals(1.0, Addressing::Clamp, SlopeKernel::Central);
        assert_eq!(normals[0], Some(DVec3::Z));
        assert_eq!(normals[1], None);
    }

    #[test]
    fn sobel_gives_a_ramps_slope_and_halves_the_noise_across_it() {
        // A ramp of slope (2, -3) per texel, away from the edges; then one row raised.
        let size = 7;
        let mut values: Vec<f64> =
            (0..size * size).map(|i| 2.0 * (i % size) as f64 + 3.0 * (i / size) as f64).collect();
        let slopes = |values: &[f64], kernel| {
            let map = HeightMap { width: size, height: size, values: values.to_vec() };
            let normal = map.normals(1.0, Addressing::Clamp, kernel)[3 * size + 3].unwrap();
            -normal.truncate() / normal.z
        };
        for kernel in [SlopeKernel::Central, SlopeKernel::Sobel] {
            assert!((slopes(&values, kernel) - DVec2::new(2.0, -3.0)).length() < 1e-12, "{kernel:?}");
        }
        values[3 * size + 4] += 1.0;
        // Half of the neighbour's rise for central differences, half of that for Sobel's middle weight.
        assert!((slopes(&values, SlopeKernel::Central).x - 2.5).abs() < 1e-12);
        assert!((slopes(&values, SlopeKernel::Sobel).x - 2.25).abs() < 1e-12);
    }

    #[test]
    fn a_sample_at_a_texels_centre_is_the_texels_own_and_between_two_their_mean() {
        let values: Vec<f32> = (0..16).map(|i| (i * i % 7) as f32).collect();
        let image = RasterImage {
            width: 4,
            height: 4,
            channels: 1,
            has_alpha: false,
            samples: crate::image_io::Samples::F32(values.clone()),
            depth: crate::image_io::SampleDepth::Float,
            format: "test",
            tagged_srgb: false,
        };
        let normals = HeightMap::from_image(&image).normals(1.0, Addressing::Wrap, SlopeKernel::Central);
        let at = |x: f64, y: f64| sample(&image, DVec2::new(x, y) / 4.0, Addressing::Wrap, SlopeKernel::Central);
        let (here, next) = (at(1.5, 2.5), at(2.5, 2.5));
        assert!((here.height - f64::from(values[9])).abs() < 1e-12);
        // Per texture coordinate there are four texels.
        let normal = normals[9].unwrap();
        assert!((here.slope + 4.0 * normal.truncate() / normal.z).length() < 1e-12);
        let between = at(2.0, 2.5);
        assert!((between.height - 0.5 * (here.height + next.height)).abs() < 1e-12);
        assert!((between.slope - 0.5 * (here.slope + next.slope)).length() < 1e-12);
    }
}
