//! The import doctor: what a file's samples say of how it should be read, each answer with its confidence and reason.
//!
//! It looks at the image and not at the map, so that it can speak of files that are refused too, and it decodes by the
//! program's own decoder under every reading that it weighs. Questions are settled in an order: what the samples are,
//! whether x is in alpha, how they are encoded, what z is, which space they are in; only then do slopes mean anything. A finding is doubtful
//! where the map is read against it. A map of fewer than [`FEWEST_TEXELS`] texels tells nothing by its statistics.
//!
//! | file | what it answers |
//! | --- | --- |
//! | `content` | normals or heights |
//! | `encoding` | linear or sRGB-encoded |
//! | `third_channel` | z from -1 to 1, from 0 to 1, or none |
//! | `space` | tangent or object space |
//! | `green` | +Y up or down |
//! | `lengths` | how long the normals are stored, and how many texels have none |
//! | `depth` | how finely directions are stored, and the kappa that this limits |
//! | `alpha` | what a fourth channel holds: nothing, x, something else |
//! | `tiling` | whether opposite edges meet |
//!
//! `warning` holds what decoding itself counts; `sample` the texels that are looked at.

mod alpha;
mod content;
mod depth;
mod encoding;
mod finding;
mod green;
mod lengths;
mod sample;
mod space;
mod third_channel;
mod tiling;
mod warning;

pub use finding::{Advice, Confidence, Finding, Subject};
pub use green::Curl;
pub use lengths::LengthHistogram;
pub use warning::Warning;
pub(super) use warning::{Tally, alpha_varies};

use super::{GreenChannel, MapOptions};
use crate::image_io::RasterImage;
use sample::Sample;

/// Fewer texels than these are too few to judge a file by.
pub const FEWEST_TEXELS: usize = 64;

/// Everything the doctor says of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnosis {
    /// The answers, in the order in which they follow from each other.
    pub findings: Vec<Finding>,
    /// The lengths that the normals were stored with; empty for heights.
    pub lengths: LengthHistogram,
}

impl Diagnosis {
    /// Looks at an image that is read as `options` say.
    pub fn new(image: &RasterImage, options: &MapOptions) -> Self {
        let sample = Sample::new(image);
        let content = content::finding(&sample);
        let is_heights = matches!(content.advice, Some(Advice::Heights(Some(_))));
        let alpha = alpha::finding(image, options);
        let mut findings = vec![content];
        let mut lengths = LengthHistogram::default();
        if !is_heights {
            let reading = alpha.advice.map_or_else(|| options.clone(), |advice| advice.apply(options));
            lengths = examine_normals(&sample, &reading, &mut findings);
        }
        findings.extend([depth::finding(image, is_heights), alpha, tiling::finding(image)]);
        let findings = findings.into_iter().map(|finding| finding.against(options)).collect();
        Self { findings, lengths }
    }

    /// True where anything is.
    pub fn is_doubtful(&self) -> bool {
        self.findings.iter().any(|finding| finding.doubtful)
    }

    /// The answer on a subject, where the question arises.
    pub fn on(&self, subject: Subject) -> Option<&Finding> {
        self.findings.iter().find(|finding| finding.subject == subject)
    }
}

/// Settles one question after the other, each under what was found before; what was not found is as the options say.
fn examine_normals(sample: &Sample<'_>, options: &MapOptions, findings: &mut Vec<Finding>) -> LengthHistogram {
    let mut reading = MapOptions { green: GreenChannel::Up, ..options.clone() };
    for examine in [encoding::finding, third_channel::finding, space::finding] {
        let finding = examine(sample, &reading);
        if let Some(advice) = finding.advice {
            reading = advice.apply(&reading);
        }
        findings.push(finding);
    }
    if !reading.object_space {
        findings.push(green::finding(sample.image, &reading));
    }
    let (lengths, more) = lengths::findings(sample.image, &reading);
    findings.extend(more);
    lengths
}
