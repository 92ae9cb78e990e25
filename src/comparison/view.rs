//! The ways of seeing methods beside each other, by name.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// How methods stand beside each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum View {
    /// `wipe`: two methods, one on either side of a line.
    #[default]
    Wipe,
    /// `flip`: two methods in turns, each over the whole picture.
    Flip,
    /// `difference`: what two methods differ by, in false colour.
    Difference,
    /// `grid-2x2`: four methods, a smaller picture each.
    Grid2x2,
    /// `grid-3x3`: nine methods.
    Grid3x3,
}

impl View {
    /// Every view with its name in the window, in the order they are offered.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Wipe, "Wipe"),
        (Self::Flip, "Flip"),
        (Self::Difference, "Difference"),
        (Self::Grid2x2, "2×2"),
        (Self::Grid3x3, "3×3"),
    ];

    /// Pictures along each side of a grid; `None` for the views of two methods.
    pub fn grid_side(self) -> Option<usize> {
        match self {
            Self::Wipe | Self::Flip | Self::Difference => None,
            Self::Grid2x2 => Some(2),
            Self::Grid3x3 => Some(3),
        }
    }
}

impl std::fmt::Display for View {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(match self {
            Self::Wipe => "wipe",
            Self::Flip => "flip",
            Self::Difference => "difference",
            Self::Grid2x2 => "grid-2x2",
            Self::Grid3x3 => "grid-3x3",
        })
    }
}

/// Why a view's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a view: write wipe, flip, difference, grid-2x2 or grid-3x3")]
pub struct ParseViewError(String);

impl FromStr for View {
    type Err = ParseViewError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.into_iter().map(|(view, _)| view);
        known.into_iter().find(|view| view.to_string() == text).ok_or_else(|| ParseViewError(text.to_owned()))
    }
}

impl From<View> for String {
    fn from(view: View) -> Self {
        view.to_string()
    }
}

impl TryFrom<String> for View {
    type Error = ParseViewError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}
