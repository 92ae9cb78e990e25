//! How the numbers of a level's texels are spread over their scale.

use super::map_picture::PictureKey;
use super::texel_scale::TexelScale;
use super::texel_values::{TexelValue, TexelValues};
use crate::normal_map::pyramid::Texel;

/// Parts of the scale.
pub const BINS: usize = 40;

/// About the most texels that are asked; a larger level is read in strides.
const MOST_ASKED: usize = 1 << 14;

/// The numbers of a level.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelHistogram {
    /// Texels by part of the scale; one beyond the range counts in the part at its end.
    pub bins: [usize; BINS],
    /// How many texels were asked, and how many of those had a number.
    pub asked: [usize; 2],
    /// The lowest number, the median and the highest; none where no texel has one.
    pub quantiles: Option<[f64; 3]>,
}

impl LevelHistogram {
    /// Counts the numbers of a level's texels.
    pub fn new(values: &TexelValues<'_>, scale: &TexelScale, level: usize) -> Self {
        let (width, height) = values.session().map().level_size(level);
        // Odd, so that the strides do not fall into step with a map's own period.
        let stride = if width * height > MOST_ASKED { (width * height).div_ceil(MOST_ASKED) | 1 } else { 1 };
        let asked = (0..width * height).step_by(stride);
        let number = |index: usize| match values.value(Texel { level, x: index % width, y: index / width }) {
            TexelValue::Number(number) => Some(number),
            TexelValue::Color(_) | TexelValue::Invalid | TexelValue::Missing => None,
        };
        let mut numbers: Vec<f64> = asked.clone().filter_map(number).collect();
        numbers.sort_by(f64::total_cmp);
        let mut bins = [0; BINS];
        for &number in &numbers {
            bins[((scale.position(number) * BINS as f32) as usize).min(BINS - 1)] += 1;
        }
        let at = |share: usize| numbers.get((numbers.len().saturating_sub(1)) * share / 2).copied();
        let quantiles = at(0).zip(at(1)).zip(at(2)).map(|((lowest, median), highest)| [lowest, median, highest]);
        Self { bins, asked: [asked.count(), numbers.len()], quantiles }
    }
}

/// The histogram that was shown last, made anew when what it depends on changes.
#[derive(Default)]
pub struct KeptHistogram(Option<(PictureKey, LevelHistogram)>);

impl KeptHistogram {
    /// The histogram of a level.
    pub fn get(&mut self, values: &TexelValues<'_>, scale: &TexelScale, level: usize) -> &LevelHistogram {
        let key = PictureKey::new(values, level);
        let kept = self.0.take().filter(|(made, _)| *made == key);
        &self.0.insert(kept.unwrap_or_else(|| (key, LevelHistogram::new(values, scale, level)))).1
    }
}
