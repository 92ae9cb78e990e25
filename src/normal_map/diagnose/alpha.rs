//! What a fourth channel holds.

use super::{Advice, Confidence, Finding, Subject};
use crate::image_io::RasterImage;
use crate::normal_map::MapOptions;

pub(super) fn finding(image: &RasterImage, options: &MapOptions) -> Finding {
    let found = |answer: &str, reason: String| Finding::new(Subject::Alpha, answer, Confidence::Certain, reason);
    if !image.has_alpha {
        return found("none", "the file has no alpha channel".to_owned());
    }
    let scale = image.samples.full_scale().unwrap_or(1.0);
    let [low, high] = range(image, image.channels - 1).map(|value| value / scale);
    if low == high {
        return found("constant", format!("alpha is {low:.2} everywhere"));
    }
    let runs = format!("alpha runs from {low:.2} to {high:.2}");
    let [red_low, red_high] = range(image, 0);
    if image.channels == 4 && red_low == red_high {
        let reason = format!("{runs} and red is constant");
        return Finding::new(Subject::Alpha, "x", Confidence::Likely, reason).advising(Advice::XInAlpha(true));
    }
    if options.x_in_alpha {
        return found("x", format!("{runs}, and is read as x"));
    }
    found("carries something", format!("{runs}, and is not used"))
}

fn range(image: &RasterImage, channel: usize) -> [f64; 2] {
    let values = (0..image.texels()).map(|texel| image.samples.get(texel * image.channels + channel));
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}
