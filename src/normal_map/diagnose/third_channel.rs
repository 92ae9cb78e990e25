//! What the third channel holds: z from -1 to 1, z from 0 to 1, or none, from the lengths under either reading.

use super::sample::Sample;
use super::{Advice, Confidence, Finding, Subject};
use crate::normal_map::decode::Decoder;
use crate::normal_map::{MapOptions, StoredZ};

/// Lengths this near to 1 on the mean are what rounding to 8 bits leaves of unit normals: half a step of z, halved.
const ROUNDED: f64 = 0.004;

/// Lengths this near to 1 on the mean are those of unit normals that were compressed or scaled.
const UNIT: f64 = 0.03;

/// What programs fill an unused channel with.
const FILLERS: [f64; 3] = [0.0, 0.5, 1.0];

/// A value this near to one is that: 127 and 128 stand for one half.
const NEAR: f64 = 0.01;

/// Normals longer than this are longer than rounding makes unit ones.
const TOO_LONG: f64 = 1.05;

/// Hardly any of the normals.
const FEW: f64 = 0.005;

/// More of the normals than painted details and lossy compression make too long.
const MANY: f64 = 0.15;

/// Lengths of more than this off 1 are no rounding's.
const PLAINLY_OFF: f64 = 0.02;

/// How many times nearer to 1 lengths must be to speak for a reading.
const FOR: f64 = 1.5;

/// How many times nearer they must be to speak plainly.
const PLAINLY: f64 = 4.0;

pub(super) fn finding(sample: &Sample<'_>, options: &MapOptions) -> Finding {
    if sample.image.color_channels() == 2 {
        let reason = "the file has no third colour channel".to_owned();
        return Finding::new(Subject::Z, "absent", Confidence::Certain, reason);
    }
    if options.x_in_alpha {
        let reason = "x is in alpha and y in green".to_owned();
        return Finding::new(Subject::Z, "absent", Confidence::Certain, reason);
    }
    if let Some(reason) = sample.too_small() {
        return Finding::unknown(Subject::Z, reason);
    }
    let misfit = |z| sample.misfit(&MapOptions { z, two_channel: false, ..options.clone() });
    let [signed, unsigned] = [misfit(StoredZ::Signed), misfit(StoredZ::Unsigned)];
    constant(sample, options, signed.min(unsigned)).unwrap_or_else(|| by_length(sample, options, signed, unsigned))
}

/// A channel of one value that fills unused ones holds z only where x and y ask for that value.
fn constant(sample: &Sample<'_>, options: &MapOptions, misfit: f64) -> Option<Finding> {
    let value = sample.values(2).next()?;
    if !sample.is_constant(2) || !FILLERS.iter().any(|filler| (value - filler).abs() < NEAR) {
        return None;
    }
    let points_down = value < NEAR && !Decoder::new(sample.image, options).is_signed();
    let full = value > 1.0 - NEAR;
    let reason = |why| format!("the third channel is {value:.2} everywhere, {why}");
    match misfit {
        // A slope before it is normalised: x and y have no bound then.
        _ if full && too_long(sample, options, true) > FEW => None,
        _ if points_down => Some(absent(Confidence::Certain, reason("which as z would point down"))),
        ..=ROUNDED => None,
        ..=PLAINLY_OFF => Some(absent(Confidence::Likely, reason("which as z hardly gives unit lengths"))),
        _ if full => Some(absent(Confidence::Likely, reason("which as z gives no unit lengths"))),
        _ => Some(absent(Confidence::Certain, reason("which as z gives no unit lengths"))),
    }
}

fn by_length(sample: &Sample<'_>, options: &MapOptions, signed: f64, unsigned: f64) -> Finding {
    let reason = format!("lengths are {signed:.3} off 1 on the mean as -1 to 1 and {unsigned:.3} as 0 to 1");
    let found =
        |answer, confidence, z| Finding::new(Subject::Z, answer, confidence, reason.clone()).advising(Advice::Z(z));
    let as_signed = |confidence| found("from -1 to 1", confidence, StoredZ::Signed);
    let as_unsigned = |confidence| found("from 0 to 1", confidence, StoredZ::Unsigned);
    if Decoder::new(sample.image, options).is_signed() && signed < UNIT {
        return as_signed(Confidence::Certain);
    }
    // Short normals come nearer to unit length as 0 to 1, so that reading has to fit to the rounding.
    if unsigned < 1.5 * ROUNDED && signed > FOR * unsigned {
        let plain = unsigned < ROUNDED && signed > PLAINLY * unsigned && signed > PLAINLY_OFF;
        return as_unsigned(if plain { Confidence::Certain } else { Confidence::Likely });
    }
    if signed < UNIT && unsigned > FOR * signed {
        let plain = signed < 2.5 * ROUNDED && unsigned > PLAINLY * signed;
        return as_signed(if plain { Confidence::Certain } else { Confidence::Likely });
    }
    let [whole, planar] = [false, true].map(|two_channel| too_long(sample, options, two_channel));
    // Means of unit normals are shorter, and stored as unit normals are.
    if unsigned > PLAINLY_OFF && whole < MANY {
        return as_signed(Confidence::Likely);
    }
    if whole > MANY && planar < FEW {
        let percent = 100.0 * whole;
        let reason = format!("with it {percent:.0}% of the normals are longer than 1, without it hardly any");
        return absent(Confidence::Likely, reason);
    }
    Finding::unknown(Subject::Z, reason)
}

/// The share of normals longer than 1, with the third channel as z or without it.
fn too_long(sample: &Sample<'_>, options: &MapOptions, two_channel: bool) -> f64 {
    let reading = MapOptions { two_channel, z: StoredZ::Signed, ..options.clone() };
    let decoder = Decoder::new(sample.image, &reading);
    sample.share(|&texel| decoder.decode(sample.image, texel).is_some_and(|(_, length)| length > TOO_LONG))
}

fn absent(confidence: Confidence, reason: String) -> Finding {
    Finding::new(Subject::Z, "absent", confidence, reason).advising(Advice::TwoChannel)
}
