//! What two pictures differ by at a pixel, and the colour that says so.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::color::{diverging, heat, luminance};

/// Which difference is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DifferenceKind {
    /// The mean over red, green and blue of `|right - left|`, on the scale of heat.
    #[default]
    Absolute,
    /// The luminance of the right picture less that of the left, on a scale that diverges from 0.
    Signed,
}

/// The difference of two pictures, exposed, in linear light, and the range of its scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Difference {
    /// Which.
    pub kind: DifferenceKind,
    /// The difference at the end of the scale, above 0; 1 is white at exposure 0.
    pub range: f32,
}

impl Default for Difference {
    fn default() -> Self {
        Self { kind: DifferenceKind::default(), range: Self::DEFAULT_RANGE }
    }
}

impl DifferenceKind {
    /// Every kind with its name, in the order they are offered.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Absolute, "absolute"), (Self::Signed, "signed")];

    /// The difference of two colours in linear RGB.
    pub fn of(self, left: Vec3, right: Vec3) -> f32 {
        match self {
            Self::Absolute => (right - left).abs().element_sum() / 3.0,
            Self::Signed => luminance(right - left),
        }
    }

    /// The scale's colour at `t` in `0..=1`, sRGB.
    pub fn color(self, t: f32) -> [u8; 3] {
        match self {
            Self::Absolute => heat(t),
            Self::Signed => diverging(t),
        }
    }
}

impl Difference {
    /// The range until the user sets one.
    pub const DEFAULT_RANGE: f32 = 0.2;
    /// Smallest and largest range that is offered.
    pub const RANGES: [f32; 2] = [0.001, 10.0];

    /// The differences at both ends of the scale.
    pub fn ends(self) -> [f32; 2] {
        // A session file may hold any number.
        let [least, most] = Self::RANGES;
        let range = if self.range.is_nan() { least } else { self.range.clamp(least, most) };
        match self.kind {
            DifferenceKind::Absolute => [0.0, range],
            DifferenceKind::Signed => [-range, range],
        }
    }

    /// The colour of a difference, sRGB; what lies beyond an end has the end's colour.
    pub fn color(self, difference: f32) -> [u8; 3] {
        let [low, high] = self.ends();
        self.kind.color((difference - low) / (high - low))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_difference_is_at_the_foot_of_the_one_scale_and_in_the_middle_of_the_other() {
        let color = Vec3::new(0.3, 0.1, 0.7);
        for (kind, _) in DifferenceKind::ALL {
            assert_eq!(kind.of(color, color), 0.0);
        }
        let scale = |kind| Difference { kind, range: 0.1 };
        assert_eq!(scale(DifferenceKind::Absolute).color(0.0), heat(0.0));
        assert_eq!(scale(DifferenceKind::Signed).color(0.0), diverging(0.5));
    }

    #[test]
    fn exchanging_the_pictures_turns_the_sign_and_leaves_the_amount() {
        let (a, b) = (Vec3::new(0.3, 0.1, 0.7), Vec3::new(0.2, 0.4, 0.6));
        assert_eq!(DifferenceKind::Absolute.of(a, b), DifferenceKind::Absolute.of(b, a));
        assert_eq!(DifferenceKind::Signed.of(a, b), -DifferenceKind::Signed.of(b, a));
        assert!(DifferenceKind::Signed.of(Vec3::ZERO, Vec3::ONE) > 0.999, "a brighter right side counts up");
    }
}
