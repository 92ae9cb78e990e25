//! The lengths that normals were stored with, and the texels that hold none: of every texel, as the decoder counts.

use rayon::prelude::*;

use super::warning::{LENGTH_TOLERANCE, WORTH_A_WARNING, percent};
use super::{Confidence, FEWEST_TEXELS, Finding, Subject};
use crate::image_io::RasterImage;
use crate::normal_map::MapOptions;
use crate::normal_map::decode::Decoder;

/// How many texels have which length, in steps of [`LengthHistogram::STEP`] from 0; the last holds all that are longer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LengthHistogram {
    /// The counts.
    pub counts: Vec<usize>,
}

impl LengthHistogram {
    /// The width of a bin.
    pub const STEP: f64 = 0.01;

    /// Up to the length of a texel that is full in all three channels, and one step more.
    const BINS: usize = 175;

    fn empty() -> Self {
        Self { counts: vec![0; Self::BINS] }
    }

    fn count(mut self, length: f64) -> Self {
        let bin = (length / Self::STEP) as usize;
        self.counts[bin.min(Self::BINS - 1)] += 1;
        self
    }

    fn plus(mut self, other: &Self) -> Self {
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, more)| *count += more);
        self
    }

    /// Texels with a length.
    pub fn total(&self) -> usize {
        self.counts.iter().sum()
    }

    /// The length that this share of the texels is below, to a step.
    pub fn quantile(&self, share: f64) -> f64 {
        let wanted = (share * self.total() as f64).ceil() as usize;
        let mut sum = 0;
        let below = |&count: &usize| {
            sum += count;
            sum >= wanted.max(1)
        };
        self.counts.iter().position(below).map_or(0.0, |bin| (bin as f64 + 0.5) * Self::STEP)
    }

    /// The share of the texels whose length is off 1 by more than a tenth.
    fn off_unit(&self) -> f64 {
        let is_off = |&(bin, _): &(usize, &usize)| ((bin as f64 + 0.5) * Self::STEP - 1.0).abs() > LENGTH_TOLERANCE;
        let off: usize = self.counts.iter().enumerate().filter(is_off).map(|(_, count)| count).sum();
        off as f64 / self.total().max(1) as f64
    }
}

/// The histogram, and what it and the texels without a normal are worth.
pub(super) fn findings(image: &RasterImage, options: &MapOptions) -> (LengthHistogram, [Finding; 2]) {
    let decoder = Decoder::new(image, options);
    let row = |row: usize| {
        let texels = row * image.width..(row + 1) * image.width;
        let lengths = texels.filter_map(|texel| decoder.decode(image, texel)).map(|(_, length)| length);
        lengths.fold(LengthHistogram::empty(), LengthHistogram::count)
    };
    let sum = |a: LengthHistogram, b: LengthHistogram| a.plus(&b);
    let lengths = (0..image.height).into_par_iter().map(row).reduce(LengthHistogram::empty, sum);
    let findings = [length_finding(&lengths, options), invalid_finding(&lengths, image.texels())];
    (lengths, findings)
}

fn length_finding(lengths: &LengthHistogram, options: &MapOptions) -> Finding {
    let subject = Subject::Lengths;
    if options.is_planar() {
        return Finding::new(subject, "unit", Confidence::Certain, "z is taken from x and y".to_owned());
    }
    let off = lengths.off_unit();
    let [low, first, third, high] = [0.01, 0.25, 0.75, 0.99].map(|share| lengths.quantile(share));
    let reason = format!(
        "{} are more than a tenth off 1; half are from {first:.2} to {third:.2} long, nearly all from {low:.2} to \
         {high:.2}",
        percent(off)
    );
    match (lengths.total() < FEWEST_TEXELS, off > WORTH_A_WARNING) {
        (true, _) => Finding::unknown(subject, reason),
        (false, true) => Finding::new(subject, "off unit", Confidence::Certain, reason).doubted(true),
        (false, false) => Finding::new(subject, "unit", Confidence::Certain, reason),
    }
}

fn invalid_finding(lengths: &LengthHistogram, texels: usize) -> Finding {
    let invalid = texels - lengths.total();
    let (answer, reason) = match invalid {
        0 => ("none".to_owned(), "every texel holds a normal".to_owned()),
        _ => (format!("{invalid} of {texels}"), "they are black, too short or not finite, and are left out".to_owned()),
    };
    Finding::new(Subject::Invalid, answer, Confidence::Certain, reason).doubted(invalid > 0)
}
