//! Linear or sRGB-encoded: under the right reading normals have unit length, and lean neither right nor up on the
//! whole.
//!
//! Lengths and means are two witnesses: the answer is certain where the lengths speak plainly and the means do not
//! speak against them. A third channel of one value may be no z, and its lengths are no witness.

use super::sample::Sample;
use super::{Advice, Confidence, Finding, Subject};
use crate::normal_map::decode::Decoder;
use crate::normal_map::{MapOptions, StoredZ};

/// The mean x and y of a surface that rises nowhere on the whole, as far as a map of part of one may be off.
const LEVEL: f64 = 0.15;

/// A mean that no map of a surface has: flat, read against its encoding, is at -0.57 or 0.47.
const TILTED: f64 = 0.25;

/// Lengths this near to 1 are those of unit normals, as far as rounding and compression leave them.
const UNIT: f64 = 0.05;

/// How many times nearer lengths are under the one reading that speak plainly.
const PLAINLY: f64 = 4.0;

pub(super) fn finding(sample: &Sample<'_>, options: &MapOptions) -> Finding {
    let subject = Subject::Encoding;
    if Decoder::new(sample.image, options).is_signed() {
        let reason = "floats below 0 are not sRGB-encoded".to_owned();
        return Finding::new(subject, "linear", Confidence::Certain, reason).advising(Advice::Srgb(false));
    }
    if let Some(reason) = sample.too_small() {
        return Finding::unknown(subject, reason + tag(sample));
    }
    let misfits = [false, true].map(|srgb| misfit(sample, options, srgb));
    let means = [false, true].map(|srgb| sample.mean_off_axis(&MapOptions { srgb, ..options.clone() }));
    let reason = reason(misfits, means) + tag(sample);
    let (is_srgb, confidence) = match (by_length(misfits), by_mean(means)) {
        (Some(length), Some(mean)) if length != mean => return Finding::unknown(subject, reason),
        (Some(length), _) => (length, Confidence::Certain),
        (None, Some(mean)) => (mean, Confidence::Likely),
        (None, None) => return Finding::unknown(subject, reason),
    };
    let answer = if is_srgb { "sRGB-encoded" } else { "linear" };
    Finding::new(subject, answer, confidence, reason).advising(Advice::Srgb(is_srgb))
}

/// How far lengths are from 1, z being stored as suits them best; `None` where the third channel says nothing.
fn misfit(sample: &Sample<'_>, options: &MapOptions, srgb: bool) -> Option<f64> {
    let misfit = |z| sample.misfit(&MapOptions { srgb, z, two_channel: false, ..options.clone() });
    let says_something = sample.image.color_channels() > 2 && !options.x_in_alpha && !sample.is_constant(2);
    says_something.then(|| misfit(StoredZ::Signed).min(misfit(StoredZ::Unsigned)))
}

/// True for sRGB where lengths speak plainly.
fn by_length([linear, srgb]: [Option<f64>; 2]) -> Option<bool> {
    let (linear, srgb) = linear.zip(srgb)?;
    let (least, most) = (linear.min(srgb), linear.max(srgb));
    (least < UNIT && most > PLAINLY * least).then_some(srgb < linear)
}

/// True for sRGB where the means are level under that reading alone.
fn by_mean([linear, srgb]: [f64; 2]) -> Option<bool> {
    (linear.min(srgb) < LEVEL && linear.max(srgb) > TILTED).then_some(srgb < linear)
}

fn reason(misfits: [Option<f64>; 2], [linear, srgb]: [f64; 2]) -> String {
    let means = format!("the mean normal is {linear:.2} off the axis as linear and {srgb:.2} as sRGB");
    match misfits {
        [Some(linear), Some(srgb)] => {
            format!("lengths are {linear:.3} off 1 on the mean as linear and {srgb:.3} as sRGB, {means}")
        }
        _ => means,
    }
}

fn tag(sample: &Sample<'_>) -> &'static str {
    if sample.image.tagged_srgb { "; the file is tagged sRGB, which other programs may act on" } else { "" }
}
