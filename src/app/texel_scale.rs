//! The scale on which a number of every texel is coloured: fixed, so that levels, maps and settings compare.

use crate::color::heat;

/// How a position on a scale is coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ramp {
    /// The perceptual map of heat, dark to bright.
    Heat,
    /// Black to white, as an image's own channel is.
    Grey,
}

/// A scale and how its numbers are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexelScale {
    /// The lowest and the highest number that are told apart.
    pub range: [f64; 2],
    /// True where ratios matter rather than differences.
    pub logarithmic: bool,
    /// Written behind a number.
    pub unit: &'static str,
    /// Its colours.
    pub ramp: Ramp,
}

impl TexelScale {
    /// From `low` to `high` in equal differences.
    pub const fn linear(low: f64, high: f64, unit: &'static str) -> Self {
        Self { range: [low, high], logarithmic: false, unit, ramp: Ramp::Heat }
    }

    /// From `low` to `high` in equal ratios.
    pub const fn logarithmic(low: f64, high: f64, unit: &'static str) -> Self {
        Self { logarithmic: true, ..Self::linear(low, high, unit) }
    }

    /// Where a number stands, `0..=1`; one beyond the range stands at its end.
    pub fn position(&self, value: f64) -> f32 {
        let [low, high] = self.range;
        let share = if self.logarithmic {
            (value.max(low * 1e-3) / low).ln() / (high / low).ln()
        } else {
            (value - low) / (high - low)
        };
        share.clamp(0.0, 1.0) as f32
    }

    /// The number at a position.
    pub fn value(&self, position: f64) -> f64 {
        let [low, high] = self.range;
        if self.logarithmic { low * (high / low).powf(position) } else { low + position * (high - low) }
    }

    /// The colour at a position, sRGB.
    pub fn color_at(&self, position: f32) -> [u8; 3] {
        match self.ramp {
            Ramp::Heat => heat(position),
            Ramp::Grey => [(255.0 * position).round() as u8; 3],
        }
    }

    /// The colour of a number, sRGB.
    pub fn color(&self, value: f64) -> [u8; 3] {
        self.color_at(self.position(value))
    }

    /// A number with its unit.
    pub fn written(&self, value: f64) -> String {
        format!("{}{}", significant(value), self.unit)
    }

    /// The ends of the range with their unit.
    pub fn ends(&self) -> [String; 2] {
        self.range.map(|end| format!("{end}{}", self.unit))
    }

    /// Positions of numbers to be written along the scale: quarters, or powers of ten.
    pub fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        let steps = if self.logarithmic { (high / low).log10().round().max(1.0) } else { 4.0 };
        (0..=steps as usize).map(|step| step as f64 / steps).collect()
    }

    /// What an axis of numbers named so says of them.
    pub fn axis_label(&self, name: &str) -> String {
        let unit = self.unit.trim();
        let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
        format!("{name}{unit}{}", if self.logarithmic { ", log" } else { "" })
    }

    /// The range in words.
    pub fn words(&self) -> String {
        let [low, high] = self.ends();
        format!("{low} to {high}, {}", if self.logarithmic { "logarithmic" } else { "linear" })
    }
}

/// About three digits.
pub fn significant(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if value.fract() == 0.0 && size < 1e6 => format!("{value:.0}"),
        size if !(5e-4..1e6).contains(&size) => format!("{value:.0e}"),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALES: [TexelScale; 2] = [TexelScale::linear(-1.0, 3.0, ""), TexelScale::logarithmic(0.1, 100.0, " %")];

    #[test]
    fn a_number_stands_where_its_position_has_it_and_ends_hold_what_lies_beyond() {
        for scale in SCALES {
            for position in [0.0, 0.25, 0.5, 1.0] {
                assert!((f64::from(scale.position(scale.value(position))) - position).abs() < 1e-6, "{scale:?}");
            }
            let [low, high] = scale.range;
            assert_eq!([low - 5.0, low, high, high + 5.0].map(|value| scale.position(value)), [0.0, 0.0, 1.0, 1.0]);
        }
    }

    #[test]
    fn numbers_have_about_three_digits() {
        let written = [0.0, 1.0, 12.345, 0.04, 123.4, 3e-5, 2.5e7, 0.9999].map(significant);
        assert_eq!(written, ["0", "1", "12.3", "0.040", "123", "3e-5", "2e7", "1.000"]);
        assert_eq!(SCALES[1].words(), "0.1 % to 100 %, logarithmic");
    }
}
