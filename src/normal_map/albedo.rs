//! The surface's colour: an image beside the map, one linear RGB per base texel.
//!
//! Integer samples are sRGB and become linear; floats are taken as they are. An image of another size is resampled by
//! area: a texel takes the mean of what its box covers.

use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;

use super::Warning;
use super::pyramid::Footprint;
use crate::color::linear_from_srgb;
use crate::image_io::{self, RasterImage, ReadImageError};

/// Linear RGB of every base texel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Albedo {
    /// One colour per base texel.
    pub rgb: Vec<[f32; 3]>,
}

impl Albedo {
    /// Reads an image for a map of `size` texels, and says what was odd about it.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read(path: &Path, size: (usize, usize)) -> Result<(Self, Vec<Warning>), ReadImageError> {
        Ok(Self::from_image(&image_io::read(path)?, size))
    }

    /// Takes an image in memory for a map of `size` texels, and says what was odd about it.
    pub fn from_image(image: &RasterImage, size: (usize, usize)) -> (Self, Vec<Warning>) {
        let found = (image.width, image.height);
        let color = |(x, y): (usize, usize)| mean_color(image, &Footprint::new(found, size, (x, y)));
        let texels = (0..size.0 * size.1).into_par_iter().map(|index| color((index % size.0, index / size.0)));
        let mut rgb: Vec<[f32; 3]> = texels.map(|color| color.as_vec3().to_array()).collect();
        let mut warnings = Vec::new();
        if found != size {
            warnings.push(Warning::ColorResampled { from: found, to: size });
        }
        let mut odd = 0;
        for color in rgb.iter_mut().filter(|color| !color.iter().all(|value| value.is_finite())) {
            *color = [0.0; 3];
            odd += 1;
        }
        if odd > 0 {
            warnings.push(Warning::ColorNotFinite { count: odd });
        }
        (Self { rgb }, warnings)
    }
}

fn mean_color(image: &RasterImage, footprint: &Footprint) -> DVec3 {
    let (mut sum, mut area) = (DVec3::ZERO, 0.0);
    for (x, y, weight) in footprint.texels() {
        sum += f64::from(weight) * linear_color(image, x, y);
        area += f64::from(weight);
    }
    sum / area
}

/// One channel is grey; a third channel that is missing is black.
fn linear_color(image: &RasterImage, x: usize, y: usize) -> DVec3 {
    let channel = |index: usize| {
        let stored = image.sample(x, y, index);
        image.samples.full_scale().map_or(stored, |full| f64::from(linear_from_srgb((stored / full) as f32)))
    };
    match image.color_channels() {
        0 | 1 => DVec3::splat(channel(0)),
        2 => DVec3::new(channel(0), channel(1), 0.0),
        _ => DVec3::new(channel(0), channel(1), channel(2)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image_io::{SampleDepth, Samples};

    fn image(width: usize, height: usize, samples: Samples) -> RasterImage {
        let channels = samples.len() / (width * height);
        let depth = SampleDepth::Float;
        RasterImage { width, height, channels, has_alpha: false, samples, depth, format: "none", tagged_srgb: false }
    }

    #[test]
    fn integers_are_srgb_and_floats_are_linear() {
        let (eight, warnings) = Albedo::from_image(&image(1, 1, Samples::U8(vec![255, 188, 0])), (1, 1));
        assert!(warnings.is_empty());
        assert!((eight.rgb[0][1] - 0.5).abs() < 4e-3 && eight.rgb[0][0] == 1.0 && eight.rgb[0][2] == 0.0);
        let (float, _) = Albedo::from_image(&image(1, 1, Samples::F32(vec![2.0, 0.5, 0.25])), (1, 1));
        assert_eq!(float.rgb, [[2.0, 0.5, 0.25]]);
    }

    #[test]
    fn another_size_is_resampled_by_area_and_said() {
        let wide = image(3, 1, Samples::F32(vec![0.0, 3.0, 6.0]));
        let (two, warnings) = Albedo::from_image(&wide, (2, 1));
        assert_eq!(two.rgb, [[1.0; 3], [5.0; 3]]);
        assert_eq!(warnings, [Warning::ColorResampled { from: (3, 1), to: (2, 1) }]);
        let (six, _) = Albedo::from_image(&wide, (6, 2));
        assert_eq!(six.rgb[..6], [0.0, 0.0, 3.0, 3.0, 6.0, 6.0].map(|value| [value; 3]));
    }

    #[test]
    fn a_colour_that_is_no_number_is_black_and_counted() {
        let (color, warnings) = Albedo::from_image(&image(2, 1, Samples::F32(vec![f32::NAN, 1.0])), (2, 1));
        assert_eq!(color.rgb, [[0.0; 3], [1.0; 3]]);
        assert_eq!(warnings, [Warning::ColorNotFinite { count: 1 }]);
    }
}
