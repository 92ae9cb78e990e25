//! What the doctor says: an answer to one question about a file, how sure it is, why, and what to do about it.

use std::fmt;

use serde::Serialize;

use crate::normal_map::{Addressing, GreenChannel, MapOptions, StoredZ};

/// What a finding is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Subject {
    /// Normals or heights.
    Content,
    /// Linear or sRGB-encoded samples.
    Encoding,
    /// What the third channel holds.
    Z,
    /// Tangent space or object space.
    Space,
    /// Which way the green channel points.
    Green,
    /// The lengths that the normals were stored with.
    Lengths,
    /// Texels without a normal.
    Invalid,
    /// How finely directions are stored.
    Depth,
    /// The fourth channel.
    Alpha,
    /// Whether opposite edges meet.
    Tiling,
}

/// How sure an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Confidence {
    /// The file cannot well be otherwise.
    Certain,
    /// The file speaks for it.
    Likely,
    /// The file does not tell.
    Unknown,
}

/// A way to read a map: one option of [`MapOptions`] and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Advice {
    /// The green channel's convention.
    Green(GreenChannel),
    /// What the third channel holds.
    Z(StoredZ),
    /// The third channel holds no z.
    TwoChannel,
    /// Whether x is in alpha.
    XInAlpha(bool),
    /// Whether the samples are sRGB-encoded.
    Srgb(bool),
    /// Whether the normals are the object's.
    ObjectSpace(bool),
    /// The scale of heights, or `None` for normals.
    Heights(Option<f32>),
    /// What lies beyond an edge.
    Edges(Addressing),
}

/// An answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub subject: Subject,
    /// The answer in a few words, "cannot tell" where there is none.
    pub answer: String,
    /// How sure it is.
    pub confidence: Confidence,
    /// Why, in one sentence without a full stop.
    pub reason: String,
    /// The option that reads the file as the answer has it, where there is one.
    pub advice: Option<Advice>,
    /// True where the map is read against the answer, or the answer itself is a defect.
    pub doubtful: bool,
}

impl Subject {
    /// The name that the window shows.
    pub fn title(self) -> &'static str {
        match self {
            Self::Content => "Content",
            Self::Encoding => "Encoding",
            Self::Z => "Stored z",
            Self::Space => "Space",
            Self::Green => "Green sign",
            Self::Lengths => "Lengths",
            Self::Invalid => "Invalid texels",
            Self::Depth => "Depth",
            Self::Alpha => "Alpha",
            Self::Tiling => "Tiling",
        }
    }

    /// The word that tables show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Content => "content",
            Self::Encoding => "encoding",
            Self::Z => "z",
            Self::Space => "space",
            Self::Green => "green",
            Self::Lengths => "lengths",
            Self::Invalid => "invalid",
            Self::Depth => "depth",
            Self::Alpha => "alpha",
            Self::Tiling => "tiling",
        }
    }
}

impl fmt::Display for Confidence {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::Certain => "certain",
            Self::Likely => "likely",
            Self::Unknown => "unknown",
        })
    }
}

impl Advice {
    /// The options with the advice followed.
    pub fn apply(self, options: &MapOptions) -> MapOptions {
        let mut changed = options.clone();
        match self {
            Self::Green(green) => changed.green = green,
            Self::Z(z) => (changed.z, changed.two_channel) = (z, false),
            Self::TwoChannel => changed.two_channel = true,
            Self::XInAlpha(x_in_alpha) => changed.x_in_alpha = x_in_alpha,
            Self::Srgb(srgb) => changed.srgb = srgb,
            Self::ObjectSpace(object_space) => changed.object_space = object_space,
            Self::Heights(scale) => changed.height_scale = scale,
            Self::Edges(addressing) => changed.addressing = addressing,
        }
        changed
    }

    /// True where the options say so already; any scale of heights will do, and any sign where it is found out.
    pub fn is_followed(self, options: &MapOptions) -> bool {
        match self {
            Self::Heights(scale) => scale.is_some() == options.height_scale.is_some(),
            Self::Green(_) if options.green == GreenChannel::Auto => true,
            _ => self.apply(options) == *options,
        }
    }

    /// What to choose instead of it.
    pub fn opposite(self) -> Self {
        match self {
            Self::Green(GreenChannel::Down) => Self::Green(GreenChannel::Up),
            Self::Green(_) => Self::Green(GreenChannel::Down),
            Self::Z(_) => Self::TwoChannel,
            Self::TwoChannel => Self::Z(StoredZ::Signed),
            Self::XInAlpha(x_in_alpha) => Self::XInAlpha(!x_in_alpha),
            Self::Srgb(srgb) => Self::Srgb(!srgb),
            Self::ObjectSpace(object_space) => Self::ObjectSpace(!object_space),
            Self::Heights(Some(_)) => Self::Heights(None),
            Self::Heights(None) => Self::Heights(Some(MapOptions::HEIGHT_SCALE)),
            Self::Edges(Addressing::Wrap) => Self::Edges(Addressing::Clamp),
            Self::Edges(Addressing::Clamp) => Self::Edges(Addressing::Wrap),
        }
    }

    /// The option of the command line.
    pub fn option(self) -> String {
        match self {
            Self::Green(GreenChannel::Up) => "--y up".to_owned(),
            Self::Green(GreenChannel::Down) => "--y down".to_owned(),
            Self::Green(GreenChannel::Auto) => "--y auto".to_owned(),
            Self::Z(StoredZ::Signed) => "--z signed".to_owned(),
            Self::Z(StoredZ::Unsigned) => "--z 01".to_owned(),
            Self::TwoChannel => "--z none".to_owned(),
            Self::XInAlpha(true) => "--x alpha".to_owned(),
            Self::XInAlpha(false) => "--x red".to_owned(),
            Self::Srgb(true) => "--encoding srgb".to_owned(),
            Self::Srgb(false) => "--encoding linear".to_owned(),
            Self::ObjectSpace(true) => "--space object".to_owned(),
            Self::ObjectSpace(false) => "--space tangent".to_owned(),
            Self::Heights(Some(scale)) => format!("--height {scale}"),
            Self::Heights(None) => "no --height".to_owned(),
            Self::Edges(Addressing::Wrap) => "--wrap".to_owned(),
            Self::Edges(Addressing::Clamp) => "--clamp".to_owned(),
        }
    }
}

impl Finding {
    /// An answer that is no defect, and that no option follows.
    pub(super) fn new(subject: Subject, answer: impl Into<String>, confidence: Confidence, reason: String) -> Self {
        Self { subject, answer: answer.into(), confidence, reason, advice: None, doubtful: false }
    }

    /// No answer.
    pub(super) fn unknown(subject: Subject, reason: String) -> Self {
        Self::new(subject, "cannot tell", Confidence::Unknown, reason)
    }

    /// The same with the option that follows it.
    pub(super) fn advising(self, advice: Advice) -> Self {
        Self { advice: Some(advice), ..self }
    }

    /// The same as a defect, where it is one.
    pub(super) fn doubted(self, doubtful: bool) -> Self {
        Self { doubtful, ..self }
    }

    /// The same, doubtful where the options do not follow its advice.
    pub(super) fn against(self, options: &MapOptions) -> Self {
        let unfollowed = self.advice.is_some_and(|advice| !advice.is_followed(options));
        Self { doubtful: self.doubtful || unfollowed, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_that_was_applied_is_followed_and_its_opposite_is_not() {
        let options = MapOptions::default();
        let all = [
            Advice::Green(GreenChannel::Up),
            Advice::Green(GreenChannel::Down),
            Advice::Z(StoredZ::Signed),
            Advice::Z(StoredZ::Unsigned),
            Advice::TwoChannel,
            Advice::XInAlpha(true),
            Advice::XInAlpha(false),
            Advice::Srgb(true),
            Advice::Srgb(false),
            Advice::ObjectSpace(true),
            Advice::ObjectSpace(false),
            Advice::Heights(Some(2.0)),
            Advice::Heights(None),
            Advice::Edges(Addressing::Wrap),
            Advice::Edges(Addressing::Clamp),
        ];
        for advice in all {
            let applied = advice.apply(&options);
            assert!(advice.is_followed(&applied), "{advice:?}");
            assert!(!advice.opposite().is_followed(&applied), "{advice:?}");
        }
    }
}
