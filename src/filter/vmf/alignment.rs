//! How lobe j of neighbouring texels is made to mean the same thing, by name.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::pull::Pull;

/// How lobe j of neighbouring texels is made to mean the same thing, so that hardware may interpolate it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Alignment {
    /// Each texel's own best fit; for unaligned shading.
    None,
    /// Neighbours speak in the E-step with this share, and leave the mean directions alone.
    Smooth {
        /// The neighbours' share b, `0..1`.
        blend: f32,
    },
    /// Han's pull of the mean directions towards the neighbours' (eq. 23), of this strength C.
    Paper {
        /// Strength C, at least 0.
        c: f32,
    },
    /// The exact M-step of the same prior (Mikkelsen 2008, eq. 113), of this strength per normal.
    Map {
        /// Strength c, at least 0.
        c: f32,
    },
}

impl Default for Alignment {
    fn default() -> Self {
        Self::Smooth { blend: Self::DEFAULT_BLEND }
    }
}

impl Alignment {
    /// The neighbours' share that [`Alignment::Smooth`] takes unless told.
    pub const DEFAULT_BLEND: f32 = 0.15;

    /// How the scanline alignments pull; `None` for the others.
    pub fn pull(self) -> Option<Pull> {
        match self {
            Self::None | Self::Smooth { .. } => None,
            Self::Paper { c } => Some(Pull::Paper { c: f64::from(c) }),
            Self::Map { c } => Some(Pull::Map { c: f64::from(c) }),
        }
    }
}

/// Why an alignment's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "'{0}' is not an alignment: write none, smooth, smooth:B with B from 0 to 0.9, paper:C or map:C with C from 0 to 100"
)]
pub struct ParseAlignmentError(String);

impl FromStr for Alignment {
    type Err = ParseAlignmentError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |prefix: &str| text.strip_prefix(prefix).and_then(|value| value.parse::<f32>().ok());
        let strength = |prefix: &str| number(prefix).filter(|c| (0.0..=100.0).contains(c));
        match text {
            "none" => Some(Self::None),
            "smooth" => Some(Self::default()),
            _ => number("smooth:")
                .filter(|blend| (0.0..=0.9).contains(blend))
                .map(|blend| Self::Smooth { blend })
                .or_else(|| strength("paper:").map(|c| Self::Paper { c }))
                .or_else(|| strength("map:").map(|c| Self::Map { c })),
        }
        .ok_or_else(|| ParseAlignmentError(text.to_owned()))
    }
}

impl std::fmt::Display for Alignment {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::None => formatter.write_str("none"),
            Self::Smooth { blend } if *blend == Self::DEFAULT_BLEND => formatter.write_str("smooth"),
            Self::Smooth { blend } => write!(formatter, "smooth:{blend}"),
            Self::Paper { c } => write!(formatter, "paper:{c}"),
            Self::Map { c } => write!(formatter, "map:{c}"),
        }
    }
}

impl From<Alignment> for String {
    fn from(alignment: Alignment) -> Self {
        alignment.to_string()
    }
}

impl TryFrom<String> for Alignment {
    type Error = ParseAlignmentError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}
