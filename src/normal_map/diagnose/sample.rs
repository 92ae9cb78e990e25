//! The texels that are looked at: all of a small image, evenly chosen ones of a large one.

use glam::DVec2;

use super::FEWEST_TEXELS;
use crate::image_io::RasterImage;
use crate::normal_map::MapOptions;
use crate::normal_map::decode::{Decoder, is_black};

/// The most texels that are looked at: a share is then known to a fifth of a percent.
const MOST_TEXELS: usize = 1 << 16;

/// The most that one texel counts for in a misfit, so that a few odd ones do not decide.
const WORST_MISFIT: f64 = 0.5;

/// Values that differ by less are one: rounding moves them.
const ONE_STEP: f64 = 1.5 / 255.0;

/// Texels of an image, black ones left out.
pub(super) struct Sample<'a> {
    pub image: &'a RasterImage,
    pub texels: Vec<usize>,
}

impl<'a> Sample<'a> {
    pub fn new(image: &'a RasterImage) -> Self {
        // An odd step takes every column of the usual even widths in turn.
        let step = image.texels().div_ceil(MOST_TEXELS) | 1;
        let texels = (0..image.texels()).step_by(step).filter(|&texel| !is_black(image, texel)).collect();
        Self { image, texels }
    }

    /// Why the sample tells nothing, where it is too small.
    pub fn too_small(&self) -> Option<String> {
        let count = self.texels.len();
        (count < FEWEST_TEXELS).then(|| format!("{count} texels that are not black are too few to judge by"))
    }

    /// A channel's values from 0 to 1; floats as they are.
    pub fn values(&self, channel: usize) -> impl Iterator<Item = f64> {
        let full_scale = self.image.samples.full_scale().unwrap_or(1.0);
        let value = move |&texel: &usize| self.image.samples.get(texel * self.image.channels + channel) / full_scale;
        self.texels.iter().map(value)
    }

    /// True where a channel's values differ by no more than a step of 8 bits.
    pub fn is_constant(&self, channel: usize) -> bool {
        let range = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let (low, high) = self.values(channel).fold((f64::INFINITY, f64::NEG_INFINITY), range);
        high - low < ONE_STEP
    }

    /// The larger of the mean x and y, without its sign, under a reading.
    pub fn mean_off_axis(&self, reading: &MapOptions) -> f64 {
        let decoder = Decoder::new(self.image, reading);
        let sum: DVec2 =
            self.texels.iter().map(|&texel| decoder.xy(self.image, texel)).filter(|xy| xy.is_finite()).sum();
        (sum / self.texels.len().max(1) as f64).abs().max_element()
    }

    /// How far the lengths are from 1 on the mean, under a reading.
    pub fn misfit(&self, reading: &MapOptions) -> f64 {
        let decoder = Decoder::new(self.image, reading);
        let misfit = |&texel: &usize| {
            let length = decoder.decode(self.image, texel).map_or(0.0, |(_, length)| length);
            (length - 1.0).abs().min(WORST_MISFIT)
        };
        self.mean(misfit)
    }

    /// The share of texels that `is` holds of.
    pub fn share(&self, is: impl Fn(&usize) -> bool) -> f64 {
        self.mean(|texel| f64::from(u8::from(is(texel))))
    }

    fn mean(&self, value: impl Fn(&usize) -> f64) -> f64 {
        self.texels.iter().map(value).sum::<f64>() / self.texels.len().max(1) as f64
    }
}
