//! How the numbers of a level's texels are spread over their scale.

use super::map_picture::PictureKey;
use super::texel_scale::TexelScale;
use super::texel_values::{TexelValue, TexelValues};
use crate::normal_map::pyramid::Texel;
use crate::reference::Region;

/// Parts of the scale.
pub const BINS: usize = 40;

/// About the most texels that are asked; a larger level is read in strides.
const MOST_ASKED: usize = 1 << 14;

/// The numbers of a level, or of a region of it.
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
    /// Counts the numbers of a level's texels, or of those that a region touches.
    pub fn new(values: &TexelValues<'_>, scale: &TexelScale, level: usize, region: Option<Region>) -> Self {
        let (left, top, width, height) = texels_of(region, values.session().map().level_size(level));
        // Odd, so that the strides do not fall into step with a map's own period.
        let stride = if width * height > MOST_ASKED { (width * height).div_ceil(MOST_ASKED) | 1 } else { 1 };
        let asked = (0..width * height).step_by(stride);
        let number = |index: usize| match values.value(Texel { level, x: left + index % width, y: top + index / width })
        {
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

/// Left column, upper row, columns and rows of a level of this size that a region touches, one at least.
fn texels_of(region: Option<Region>, (width, height): (usize, usize)) -> (usize, usize, usize, usize) {
    let Some(Region { min, max }) = region else { return (0, 0, width, height) };
    let along = |axis: usize, size: usize| {
        let first = ((min[axis] * size as f32) as usize).min(size - 1);
        (first, ((max[axis] * size as f32).ceil() as usize).clamp(first + 1, size) - first)
    };
    let ((left, columns), (top, rows)) = (along(0, width), along(1, height));
    (left, top, columns, rows)
}

/// The histogram that was shown last, made anew when what it depends on changes.
#[derive(Default)]
pub struct KeptHistogram(Option<((PictureKey, Option<Region>), LevelHistogram)>);

impl KeptHistogram {
    /// The histogram of a level, or of a region of it.
    pub fn get(
        &mut self,
        values: &TexelValues<'_>,
        scale: &TexelScale,
        level: usize,
        region: Option<Region>,
    ) -> &LevelHistogram {
        let key = (PictureKey::new(values, level), region);
        let kept = self.0.take().filter(|(made, _)| *made == key);
        &self.0.insert(kept.unwrap_or_else(|| (key, LevelHistogram::new(values, scale, level, region)))).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_counts_the_texels_that_it_touches_one_at_least() {
        let region = |min, max| Some(Region { min, max });
        assert_eq!(texels_of(None, (8, 4)), (0, 0, 8, 4));
        assert_eq!(texels_of(region([0.0, 0.0], [1.0, 1.0]), (8, 4)), (0, 0, 8, 4));
        assert_eq!(texels_of(region([0.3, 0.3], [0.5, 0.9]), (8, 4)), (2, 1, 2, 3));
        assert_eq!(texels_of(region([1.0, 1.0], [1.0, 1.0]), (8, 4)), (7, 3, 1, 1));
        assert_eq!(texels_of(region([0.2, 0.2], [0.4, 0.4]), (1, 1)), (0, 0, 1, 1));
    }
}
