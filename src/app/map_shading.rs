//! What the pictures of levels show of their texels.

use serde::{Deserialize, Serialize};

use super::texel_scale::{Ramp, TexelScale};
use crate::image_io::RasterImage;
use crate::session::Session;

/// What a level's picture shows of its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapShading {
    /// The mean normal, coloured as normal maps are.
    #[default]
    Normal,
    /// The mean normal's angle from `+z`.
    Slope,
    /// The length of the mean normal: 1 where a footprint is flat.
    Length,
    /// The file's first channel.
    Red,
    /// The file's second channel.
    Green,
    /// The file's third channel.
    Blue,
    /// The file's alpha.
    Alpha,
    /// The lobes' colours, mixed by their weights.
    Lobes,
    /// How many lobes a texel uses, from none to the most there are.
    Count,
    /// The mean concentration of its lobes.
    Kappa,
    /// The mean angle to the neighbours' lobes of the same slots.
    Coherence,
    /// The relative L2 error of its effective BRDF.
    Error,
}

impl MapShading {
    /// Every shading with its name and what it means, in the order they are offered.
    pub const ALL: [(Self, &'static str, &'static str); 12] = [
        (Self::Normal, "Normal", "The mean normal, coloured as normal maps are."),
        (Self::Slope, "Slope", "The angle of the mean normal from +z."),
        (Self::Length, "Length", "The length of the mean normal: 1 where the normals under the texel agree."),
        (Self::Red, "Red channel", "The file's first channel as stored, averaged over the texel's footprint."),
        (Self::Green, "Green channel", "The file's second channel as stored, averaged over the texel's footprint."),
        (Self::Blue, "Blue channel", "The file's third channel as stored, averaged over the texel's footprint."),
        (Self::Alpha, "Alpha channel", "The file's alpha as stored, averaged over the texel's footprint."),
        (Self::Lobes, "Lobes", "The colours of the lobes' slots, mixed by weight."),
        (Self::Count, "J", "How many lobes the texel uses."),
        (
            Self::Kappa,
            "kappa",
            "One concentration for all lobes, of their mean width: exp(sum alpha ln kappa / sum alpha).",
        ),
        (
            Self::Coherence,
            "Coherence",
            "The mean angle between a lobe and its four neighbours' lobes of the same slot, weighted by alpha: low where \
             interpolation blends like with like.",
        ),
        (
            Self::Error,
            "BRDF error",
            "The relative L2 error of a method's effective BRDF m against the truth t, at the material's shininess, over \
             the hemisphere of half vectors: sqrt(int (m - t)^2 / int t^2).",
        ),
    ];

    /// The name to show.
    pub fn label(self) -> &'static str {
        Self::ALL.iter().find(|(shading, ..)| *shading == self).map_or("", |(_, name, _)| name)
    }

    /// The scale of a shading that shows a number.
    pub fn scale(self, session: &Session) -> Option<TexelScale> {
        let stored = &session.map().stored;
        let code =
            TexelScale { ramp: Ramp::Grey, ..TexelScale::linear(0.0, stored.samples.full_scale().unwrap_or(1.0), "") };
        match self {
            Self::Normal | Self::Lobes => None,
            Self::Slope => Some(TexelScale::linear(0.0, 90.0, "°")),
            Self::Length => Some(TexelScale::linear(0.0, 1.0, "")),
            Self::Red | Self::Green | Self::Blue | Self::Alpha => Some(code),
            Self::Count => Some(TexelScale::linear(0.0, session.lobes().lobes() as f64, "")),
            Self::Kappa => Some(TexelScale::logarithmic(1.0, 10_000.0, "")),
            Self::Coherence => Some(TexelScale::linear(0.0, 45.0, "°")),
            Self::Error => Some(TexelScale::logarithmic(0.1, 100.0, " %")),
        }
    }

    /// The channel of the file that is shown; `None` where the file has none of that kind.
    pub fn channel(self, stored: &RasterImage) -> Option<usize> {
        let color = |index: usize| (index < stored.color_channels()).then_some(index);
        match self {
            Self::Red => color(0),
            Self::Green => color(1),
            Self::Blue => color(2),
            Self::Alpha => stored.has_alpha.then(|| stored.channels - 1),
            _ => None,
        }
    }

    /// True where the picture changes with the lobes at hand.
    pub fn shows_lobes(self) -> bool {
        matches!(self, Self::Lobes | Self::Count | Self::Kappa | Self::Coherence)
    }
}
