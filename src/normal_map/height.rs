//! Heights to normals.
//!
//! `h_s = scale * (h(x+1) - h(x-1)) / 2` and likewise upwards for `h_t`; the normal is `(-h_s, -h_t, 1)`,
//! normalised. After M. S. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited* (2008), section 2.5.2, whose
//! factors m and n (texels per unit of texture space) are absorbed in `scale`: heights are measured in texel widths.
//!
//! Valid for finite heights. A texel whose neighbour is not finite has no normal.

use glam::DVec3;
use rayon::prelude::*;

use super::Addressing;
use crate::image_io::RasterImage;

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
        let color = image.color_channels();
        let divisor = color as f64 * image.samples.full_scale().unwrap_or(1.0);
        let height_of = |texel: usize| {
            let first = texel * image.channels;
            (first..first + color).map(|index| image.samples.get(index)).sum::<f64>() / divisor
        };
        Self { width: image.width, height: image.height, values: (0..image.texels()).map(height_of).collect() }
    }

    /// The unit normal of every texel in tangent space, `+y` up the image; `None` where a neighbour is not finite.
    ///
    /// `scale` is the height, in texel widths, that a step of 1 in the values stands for. At a clamped edge the
    /// missing neighbour is the edge texel itself, so the slope there is half the one-sided difference.
    pub fn normals(&self, scale: f64, addressing: Addressing) -> Vec<Option<DVec3>> {
        let normal_at = |texel: usize| self.normal(texel % self.width, texel / self.width, scale, addressing);
        (0..self.values.len()).into_par_iter().map(normal_at).collect()
    }

    fn normal(&self, x: usize, y: usize, scale: f64, addressing: Addressing) -> Option<DVec3> {
        let (left, right) = neighbours(x, self.width, addressing);
        let (above, below) = neighbours(y, self.height, addressing);
        let h = |x: usize, y: usize| self.values[y * self.width + x];
        let h_s = scale * (h(right, y) - h(left, y)) / 2.0;
        let h_t = scale * (h(x, above) - h(x, below)) / 2.0;
        let slopes_are_finite = h_s.is_finite() && h_t.is_finite();
        slopes_are_finite.then(|| DVec3::new(-h_s, -h_t, 1.0).normalize())
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
        let normals = ramp_up_the_image().normals(1.0, Addressing::Clamp);
        let inner = normals[5].unwrap();
        let half = 0.5_f64.sqrt();
        assert!((inner - DVec3::new(0.0, -half, half)).length() < 1e-15);
        let edge = normals[1].unwrap();
        assert!((edge.y / edge.z + 0.5).abs() < 1e-15, "half the one-sided difference");
    }

    #[test]
    fn wrapping_takes_the_opposite_edge() {
        let top = ramp_up_the_image().normals(1.0, Addressing::Wrap)[0].unwrap();
        // Above the top row (3) lies the bottom row (0); below it lies 2: the slope is (0 - 2) / 2.
        assert!((top.y / top.z - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_level_surface_is_flat_at_any_size() {
        for (width, height) in [(1, 1), (1, 5), (7, 3)] {
            let map = HeightMap { width, height, values: vec![0.25; width * height] };
            for addressing in [Addressing::Wrap, Addressing::Clamp] {
                assert!(map.normals(100.0, addressing).iter().all(|&normal| normal == Some(DVec3::Z)));
            }
        }
    }

    #[test]
    fn a_neighbour_that_is_not_finite_leaves_no_normal() {
        let map = HeightMap { width: 3, height: 1, values: vec![0.0, 0.0, f64::NAN] };
        let normals = map.normals(1.0, Addressing::Clamp);
        assert_eq!(normals[0], Some(DVec3::Z));
        assert_eq!(normals[1], None);
    }
}
