//! Whether opposite edges meet: the step across a seam against the steps inside.
//!
//! A step is the mean distance of two neighbouring columns, or rows. A map that tiles steps across its edge as it does
//! inside; a crease may run along the edge of one that tiles, so a large step is never certain to be a seam.

use rayon::prelude::*;

use super::{Advice, Confidence, FEWEST_TEXELS, Finding, Subject};
use crate::image_io::RasterImage;
use crate::normal_map::Addressing;

/// The most lines whose steps are averaged.
const MOST_LINES: usize = 256;

/// The fewest texels along a side that give steps to compare with.
const FEWEST_STEPS: usize = 8;

/// A step across the edge of so many times the largest inside is no seam.
const NONE: f64 = 1.25;

/// One of so many times is; between them it may be either.
const SEAM: f64 = 2.0;

pub(super) fn finding(image: &RasterImage) -> Finding {
    let subject = Subject::Tiling;
    if image.texels() < FEWEST_TEXELS || image.width.min(image.height) < FEWEST_STEPS {
        let reason = format!("{} x {} texels are too few to compare with", image.width, image.height);
        return Finding::unknown(subject, reason);
    }
    let [across, down] = [true, false].map(|across| seam(image, across));
    let reason = format!(
        "the step across the left and right edges is {across:.2} times the largest inside, across top and bottom \
         {down:.2} times"
    );
    match across.max(down) {
        ..=NONE => Finding::new(subject, "no seam", Confidence::Likely, reason),
        SEAM.. => Finding::new(subject, "seams", Confidence::Likely, reason).advising(Advice::Edges(Addressing::Clamp)),
        _ => Finding::unknown(subject, reason),
    }
}

/// The step across the edge over the largest step inside; 0 where nothing varies.
fn seam(image: &RasterImage, across: bool) -> f64 {
    let (steps, lines) = if across { (image.width, image.height) } else { (image.height, image.width) };
    let step = |index: usize| {
        let chosen = (0..lines).step_by(lines.div_ceil(MOST_LINES));
        let place = |index: usize, line: usize| if across { (index, line) } else { (line, index) };
        chosen.map(|line| distance(image, place(index, line), place((index + 1) % steps, line))).sum::<f64>()
    };
    let edge = step(steps - 1);
    let inside = (0..steps - 1).into_par_iter().map(step).reduce(|| 0.0, f64::max);
    if edge > 0.0 { edge / inside } else { 0.0 }
}

/// How far apart the colours of two texels are; values that are not finite count as equal.
fn distance(image: &RasterImage, a: (usize, usize), b: (usize, usize)) -> f64 {
    let difference = |channel| (image.sample(a.0, a.1, channel) - image.sample(b.0, b.1, channel)).abs();
    (0..image.color_channels()).map(difference).filter(|difference| difference.is_finite()).sum()
}
