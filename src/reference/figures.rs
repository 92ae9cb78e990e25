//! The figures of one picture against the truth, of the whole or of a region of it.

use super::flip::{PIXELS_PER_DEGREE, flip_map, mean_flip};
use super::{Picture, normalised_color_error, rmse};

/// How far a picture is from the truth. `None` where nothing is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Tan et al. 2005.
    pub normalised_color_error: Option<f64>,
    /// Root of the mean squared difference of linear colour.
    pub rmse: Option<f64>,
    /// Andersson et al. 2020.
    pub flip: Option<f64>,
}

/// A rectangle of a picture, as parts of its width and height in `0..=1`, y downwards.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Region {
    /// The top left corner.
    pub min: [f32; 2],
    /// The bottom right corner.
    pub max: [f32; 2],
}

impl Region {
    /// The rectangle between two corners, whichever they are, cut to the picture.
    pub fn between(a: [f32; 2], b: [f32; 2]) -> Self {
        let within = |pick: fn(f32, f32) -> f32| [0, 1].map(|axis| pick(a[axis], b[axis]).clamp(0.0, 1.0));
        Self { min: within(f32::min), max: within(f32::max) }
    }

    /// True where the pixel's centre lies in it, of a picture of `size`.
    pub fn holds(&self, pixel: [usize; 2], size: [u32; 2]) -> bool {
        (0..2).all(|axis| {
            let at = (pixel[axis] as f32 + 0.5) / size[axis] as f32;
            (self.min[axis]..=self.max[axis]).contains(&at)
        })
    }
}

/// A picture beside the truth, with the map of FLIP, which is asked for once for any number of regions.
#[derive(Clone, Debug)]
pub struct Compared {
    picture: Picture,
    truth: Picture,
    flip: Option<Vec<f64>>,
}

impl Compared {
    /// Works out the map of FLIP.
    pub fn new(picture: Picture, truth: Picture) -> Self {
        let flip = flip_map(&picture, &truth, PIXELS_PER_DEGREE);
        Self { picture, truth, flip }
    }

    /// The figures of the region, or of the whole picture.
    pub fn figures(&self, region: Option<Region>) -> Figures {
        let truth = region.map(|region| self.truth.within(region));
        let truth = truth.as_ref().unwrap_or(&self.truth);
        Figures {
            normalised_color_error: normalised_color_error(&self.picture, truth),
            rmse: rmse(&self.picture, truth),
            flip: self.flip.as_ref().and_then(|errors| mean_flip(errors, truth)),
        }
    }
}

impl Picture {
    /// The picture, seen only in `region`.
    pub fn within(&self, region: Region) -> Self {
        let mut picture = self.clone();
        let width = self.size[0].max(1) as usize;
        for (index, covered) in picture.covered.iter_mut().enumerate() {
            *covered &= region.holds([index % width, index / width], self.size);
        }
        picture
    }

    /// The picture, every colour times `exposure`.
    pub fn exposed(&self, exposure: f32) -> Self {
        Self { rgb: self.rgb.iter().map(|&color| exposure * color).collect(), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn picture(color: impl Fn(u32) -> f32) -> Picture {
        let rgb = (0..200).map(|index| Vec3::splat(color(index % 20))).collect();
        Picture { size: [20, 10], rgb, covered: vec![true; 200] }
    }

    #[test]
    fn a_region_knows_the_errors_inside_it_alone() {
        let truth = picture(|_| 0.5);
        let compared = Compared::new(picture(|x| if x < 10 { 0.5 } else { 0.6 }), truth);
        let half = |min: f32| Some(Region::between([min + 0.5, 1.0], [min, 0.0]));
        let (left, right, whole) = (compared.figures(half(0.0)), compared.figures(half(0.5)), compared.figures(None));
        assert_eq!((left.normalised_color_error, left.rmse), (Some(0.0), Some(0.0)));
        let off = |figure: Option<f64>, expected: f64| (figure.expect("seen") - expected).abs() < 1e-6;
        assert!(off(right.normalised_color_error, 0.2) && off(right.rmse, 0.1), "{right:?}");
        assert!(off(whole.normalised_color_error, 0.1), "{whole:?}");
        assert!(left.flip < whole.flip && whole.flip < right.flip, "{left:?} {whole:?} {right:?}");
    }

    #[test]
    fn the_whole_picture_as_a_region_has_the_figures_of_the_whole() {
        let compared = Compared::new(picture(|x| 0.01 * x as f32), picture(|x| 0.02 * x as f32));
        assert_eq!(compared.figures(Some(Region::between([0.0, 0.0], [1.0, 1.0]))), compared.figures(None));
        assert_eq!(compared.figures(Some(Region::between([0.3, 0.3], [0.3, 0.3]))), Figures::default());
    }
}
