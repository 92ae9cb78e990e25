//! What was odd about a file, as values: counted while decoding, never silently repaired.

use std::fmt;

use crate::image_io::RasterImage;

/// A decoded length further than this from 1 counts as off. Rounding to 8 bits moves a length by at most 0.007.
pub(super) const LENGTH_TOLERANCE: f64 = 0.1;

/// Below this share of the texels an odd length or a normal below the horizon is not worth a warning: painted
/// details and lossy compression make a few in many good maps.
pub(super) const WORTH_A_WARNING: f64 = 0.005;

/// Something odd about a map that was read all the same. `Display` gives one plain sentence without a full stop.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Texels without a normal; they have weight 0 in every footprint.
    InvalidTexels {
        /// How many.
        count: usize,
        /// Texels in the map.
        total: usize,
    },
    /// Texels whose decoded length is off 1 by more than 0.1.
    LengthsOffUnit {
        /// Their share of the valid texels, 0..=1.
        share: f64,
    },
    /// Texels whose normal points below the surface.
    BelowHorizon {
        /// Their share of the valid texels, 0..=1.
        share: f64,
    },
    /// Float samples without a negative one, taken as 0..1 and spread over -1..1.
    FloatsTakenAsUnsigned,
    /// Float samples with a negative one, taken as components as they are.
    FloatsTakenAsSigned,
    /// The alpha channel differs from texel to texel; it is not used.
    AlphaVaries,
    /// A colour image was read as heights, by the mean of its colour channels.
    HeightsFromColor,
    /// Options were given for a file that holds a fit of a map that was read with others.
    FitKeepsItsOptions,
    /// The colour image is of another size than the map.
    ColorResampled {
        /// Its texels across and down.
        from: (usize, usize),
        /// The map's.
        to: (usize, usize),
    },
    /// Texels whose colour is not finite.
    ColorNotFinite {
        /// How many.
        count: usize,
    },
}

impl Warning {
    /// True where the doctor finds the same, and more of it.
    pub fn is_found_by_the_doctor(self) -> bool {
        matches!(self, Self::InvalidTexels { .. } | Self::LengthsOffUnit { .. } | Self::BelowHorizon { .. })
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::InvalidTexels { count: 1, total } => write!(
                formatter,
                "1 of {total} texels holds no normal (black, too short or not finite) and was left out"
            ),
            Self::InvalidTexels { count, total } => write!(
                formatter,
                "{count} of {total} texels hold no normal (black, too short or not finite) and were left out"
            ),
            Self::LengthsOffUnit { share } => write!(
                formatter,
                "{} of the texels are more than a tenth off unit length; they were normalised",
                percent(share)
            ),
            Self::BelowHorizon { share } => write!(
                formatter,
                "{} of the normals point below the surface; the blue channel may not hold z (see `doctor`)",
                percent(share)
            ),
            Self::FloatsTakenAsUnsigned => {
                formatter.write_str("no float sample is negative, so 0 to 1 was read as -1 to 1")
            }
            Self::FloatsTakenAsSigned => {
                formatter.write_str("some float samples are negative, so all were read as components from -1 to 1")
            }
            Self::AlphaVaries => formatter.write_str("the alpha channel is not constant; it was not used"),
            Self::HeightsFromColor => {
                formatter.write_str("the image is in colour; the mean of its channels was read as height")
            }
            Self::ColorResampled { from, to } => write!(
                formatter,
                "the colour image is {} x {} texels; it was resampled by area to the map's {} x {}",
                from.0, from.1, to.0, to.1
            ),
            Self::ColorNotFinite { count: 1 } => {
                formatter.write_str("the colour of 1 texel is not finite; it was taken as black")
            }
            Self::ColorNotFinite { count } => {
                write!(formatter, "the colours of {count} texels are not finite; they were taken as black")
            }
            Self::FitKeepsItsOptions => formatter
                .write_str("the file holds a fit; it was opened as it was fitted, whatever the map options say"),
        }
    }
}

pub(super) fn percent(share: f64) -> String {
    if share < 0.095 { format!("{:.1}%", 100.0 * share) } else { format!("{:.0}%", 100.0 * share) }
}

/// Counts kept while the texels are decoded; counts of parts of a map add up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::normal_map) struct Tally {
    /// Texels with a normal.
    pub valid: usize,
    /// Texels without one.
    pub invalid: usize,
    /// Valid texels off unit length by more than [`LENGTH_TOLERANCE`].
    pub off_unit: usize,
    /// Valid texels with z below 0.
    pub below_horizon: usize,
}

impl Tally {
    /// Counts a valid texel that decoded to `length` before it was normalised.
    pub fn count_valid(&mut self, length: f64, z: f64) {
        self.valid += 1;
        self.off_unit += usize::from((length - 1.0).abs() > LENGTH_TOLERANCE);
        self.below_horizon += usize::from(z < 0.0);
    }

    /// The sum of the counts of two parts.
    pub fn plus(self, other: Self) -> Self {
        Self {
            valid: self.valid + other.valid,
            invalid: self.invalid + other.invalid,
            off_unit: self.off_unit + other.off_unit,
            below_horizon: self.below_horizon + other.below_horizon,
        }
    }

    /// The warnings that the counts are worth; in object space no direction is below a horizon.
    pub fn warnings(&self, object_space: bool) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.invalid > 0 {
            let total = self.valid + self.invalid;
            warnings.push(Warning::InvalidTexels { count: self.invalid, total });
        }
        let share = |count: usize| count as f64 / self.valid.max(1) as f64;
        if share(self.off_unit) > WORTH_A_WARNING {
            warnings.push(Warning::LengthsOffUnit { share: share(self.off_unit) });
        }
        if !object_space && share(self.below_horizon) > WORTH_A_WARNING {
            warnings.push(Warning::BelowHorizon { share: share(self.below_horizon) });
        }
        warnings
    }
}

/// True where the image has an alpha channel with more than one value in it.
pub(in crate::normal_map) fn alpha_varies(image: &RasterImage) -> bool {
    let last = image.channels - 1;
    let alpha = |texel: usize| image.samples.get(texel * image.channels + last);
    image.has_alpha && (1..image.texels()).any(|texel| alpha(texel) != alpha(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_is_one_plain_sentence() {
        assert_eq!(
            Warning::InvalidTexels { count: 12, total: 64 }.to_string(),
            "12 of 64 texels hold no normal (black, too short or not finite) and were left out"
        );
        assert!(Warning::LengthsOffUnit { share: 0.031 }.to_string().starts_with("3.1% of"));
        assert!(Warning::LengthsOffUnit { share: 1.0 }.to_string().starts_with("100% of"));
    }

    #[test]
    fn a_few_odd_texels_in_a_good_map_give_no_warning() {
        let tally = Tally { valid: 10_000, off_unit: 10, below_horizon: 3, invalid: 0 };
        assert!(tally.warnings(false).is_empty());
        let tally = Tally { valid: 10_000, off_unit: 1000, below_horizon: 0, invalid: 0 };
        assert_eq!(tally.warnings(false), [Warning::LengthsOffUnit { share: 0.1 }]);
    }
}
