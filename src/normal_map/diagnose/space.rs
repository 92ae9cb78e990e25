//! Tangent space or object space: seen from the surface no unit normal points down, and on the whole they point out.

use glam::DVec3;

use super::sample::Sample;
use super::warning::percent;
use super::{Advice, Confidence, Finding, Subject};
use crate::normal_map::MapOptions;
use crate::normal_map::decode::Decoder;

/// Lengths this near to 1 on the mean are those of unit normals.
const UNIT: f64 = 0.02;

/// z below this points down beyond rounding.
const DOWN: f64 = -0.05;

/// Hardly any normals.
const HARDLY: f64 = 0.005;

/// Some of the normals: painted details and lossy compression make fewer.
const SOME: f64 = 0.02;

/// Many of the normals.
const MANY: f64 = 0.1;

/// Degrees between the mean normal and +z that a tile of a surface seldom has: it rises nowhere on the whole.
const STEEP: f64 = 20.0;

/// Degrees that it does not have.
const SIDEWAYS: f64 = 45.0;

pub(super) fn finding(sample: &Sample<'_>, options: &MapOptions) -> Finding {
    let subject = Subject::Space;
    if options.is_planar() || sample.image.color_channels() == 2 {
        let reason = "x and y alone give normals of the upper hemisphere".to_owned();
        return Finding::new(subject, "tangent", Confidence::Certain, reason).advising(Advice::ObjectSpace(false));
    }
    if let Some(reason) = sample.too_small() {
        return Finding::unknown(subject, reason);
    }
    let decoder = Decoder::new(sample.image, options);
    let normal = |&texel: &usize| decoder.normal(sample.image, texel);
    let down = sample.share(|texel| normal(texel).is_some_and(|normal| normal.z < DOWN));
    let mean: DVec3 = sample.texels.iter().filter_map(normal).sum();
    let tilt = mean.angle_between(DVec3::Z).to_degrees();
    let reason = format!("{} of the normals point down, and the mean one leans {tilt:.0} degrees", percent(down));
    let found = |answer, confidence, object_space| {
        Finding::new(subject, answer, confidence, reason.clone()).advising(Advice::ObjectSpace(object_space))
    };
    let is_unit = sample.misfit(options) < UNIT;
    match (down, tilt) {
        (..HARDLY, ..STEEP) => found("tangent", Confidence::Certain, false),
        (..SOME, ..SIDEWAYS) => found("tangent", Confidence::Likely, false),
        (MANY.., _) if is_unit => found("object", Confidence::Certain, true),
        _ if is_unit => found("object", Confidence::Likely, true),
        _ => Finding::unknown(subject, format!("{reason}; but lengths are off 1")).doubted(true),
    }
}
