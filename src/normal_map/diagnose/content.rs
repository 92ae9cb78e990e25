//! Normals or heights: heights are grey, and a normal map is blue nearly everywhere. Grey beside an alpha that varies may
//! be the y of a map whose x is in alpha.

use super::sample::Sample;
use super::warning::{alpha_varies, percent};
use super::{Advice, Confidence, Finding, Subject};
use crate::normal_map::MapOptions;

/// Channels that differ by less are grey: lossy compression moves them this far.
const GREY: f64 = 4.5 / 255.0;

/// Grey over this share of the texels, an image is of heights.
const MOSTLY: f64 = 0.98;

/// Grey over less than this share, it certainly is not.
const HARDLY: f64 = 0.5;

pub(super) fn finding(sample: &Sample<'_>) -> Finding {
    let heights = Advice::Heights(Some(MapOptions::HEIGHT_SCALE));
    let found = |answer, confidence, reason| Finding::new(Subject::Content, answer, confidence, reason);
    let sure = if alpha_varies(sample.image) { Confidence::Likely } else { Confidence::Certain };
    match sample.image.color_channels() {
        1 => {
            let reason = "one colour channel holds no direction".to_owned();
            return found("heights", sure, reason).advising(heights);
        }
        2 => {
            let reason = "two colour channels hold x and y".to_owned();
            return found("normals", Confidence::Certain, reason).advising(Advice::Heights(None));
        }
        _ => {}
    }
    if let Some(reason) = sample.too_small() {
        return Finding::unknown(Subject::Content, reason);
    }
    let grey = grey_share(sample);
    let reason = format!("{} of the texels are grey", percent(grey));
    match grey {
        1.0 => found("heights", sure, reason).advising(heights),
        MOSTLY.. => found("heights", Confidence::Likely, reason).advising(heights),
        HARDLY.. => found("normals", Confidence::Likely, reason).advising(Advice::Heights(None)),
        _ => found("normals", Confidence::Certain, reason).advising(Advice::Heights(None)),
    }
}

fn grey_share(sample: &Sample<'_>) -> f64 {
    let image = sample.image;
    let scale = image.samples.full_scale().unwrap_or(1.0);
    sample.share(|&texel| {
        let [r, g, b] = [0, 1, 2].map(|channel| image.samples.get(texel * image.channels + channel) / scale);
        r.max(g).max(b) - r.min(g).min(b) < GREY
    })
}
