//! A fit as an OpenEXR file, and back without loss.
//!
//! One part per MIP level, `level.00` the base; in it four f32 channels per lobe, `lobe.NN.alpha`, `lobe.NN.rx`,
//! `.ry` and `.rz`, which hold `alpha` and `alpha A(kappa) mu` as they are stored. A base texel is one normal and has
//! one lobe, `(1, n)`, in its own slot; an invalid one has none. With colour, `lobe.NN.cr`, `.cg` and `.cb` hold
//! `alpha y`, linear RGB. The attribute `fit` of each part is JSON: the
//! version, the source's name, J and the other settings, and what the level came to. `wrapmodes` says what lies
//! beyond an edge.

mod base;
mod note;
mod read;
mod write;

use std::sync::Arc;

pub use read::{read, read_bytes};
pub use write::write;

use crate::filter::vmf::{FitSettings, LevelStats, LobePyramid};
use crate::image_io::ReadImageError;

/// A finished fit.
#[derive(Clone, Debug)]
pub struct FittedLobes {
    /// The map and its lobes, every level of them.
    pub lobes: Arc<LobePyramid>,
    /// How they were fitted.
    pub settings: FitSettings,
    /// What each level came to, the base first, as far as it is known.
    pub stats: Vec<Option<LevelStats>>,
}

/// Why a file of lobes could not be read. `name` is the file as the user gave it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum ReadLobesError {
    /// The file could not be read, or is damaged.
    #[error(transparent)]
    Image(#[from] ReadImageError),
    /// A level is missing.
    #[error("'{name}' holds lobes but lacks the part '{part}'")]
    MissingPart { name: String, part: String },
    /// A level is of another size than the base level asks for.
    #[error("'{name}' is damaged: its part '{part}' is {} x {} texels, not {} x {}", .found.0, .found.1, .wanted.0, .wanted.1)]
    WrongSize { name: String, part: String, found: (usize, usize), wanted: (usize, usize) },
    /// A lobe's channel is missing, or there are too many lobes.
    #[error(
        "'{name}' is damaged: its part '{part}' does not hold 1 to 16 lobes of four channels each, or of seven with colour"
    )]
    WrongChannels { name: String, part: String },
    /// A value is not finite.
    #[error("'{name}' is damaged: its part '{part}' holds values that are not numbers")]
    NotFinite { name: String, part: String },
    /// A texel's lobes are no mixture.
    #[error("'{name}' is damaged: in its part '{part}' the lobes of texel ({x}, {y}) are no mixture")]
    NoMixture { name: String, part: String, x: usize, y: usize },
    /// No base texel has a normal.
    #[error("'{name}' holds lobes but no normal at all")]
    NoNormals { name: String },
}

/// The name of a level's part.
fn part_name(level: usize) -> String {
    format!("level.{level:02}")
}

/// What the channels of a lobe are called: first as a lobe is stored, then its colour.
const COMPONENTS: [&str; 7] = ["alpha", "rx", "ry", "rz", "cr", "cg", "cb"];

/// Components of a lobe without colour.
const PLAIN: usize = 4;

/// The channel of one component of a lobe.
fn channel_name(slot: usize, component: usize) -> String {
    format!("lobe.{slot:02}.{}", COMPONENTS[component])
}

/// Which slot and component a channel holds; the inverse of [`channel_name`].
fn parse_channel(name: &str) -> Option<(usize, usize)> {
    let (slot, component) = name.strip_prefix("lobe.")?.split_once('.')?;
    let component = COMPONENTS.iter().position(|&known| known == component)?;
    let is_number = slot.len() == 2 && slot.bytes().all(|byte| byte.is_ascii_digit());
    Some((slot.parse().ok().filter(|_| is_number)?, component))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_channel_is_found_by_the_name_it_was_given() {
        for (slot, component) in [(0, 0), (7, 2), (15, 3)] {
            assert_eq!(parse_channel(&channel_name(slot, component)), Some((slot, component)));
        }
        assert_eq!(channel_name(3, 1), "lobe.03.rx");
        for other in ["R", "lobe.3.rx", "lobe.03.rw", "lobe.03", "lobe.+3.rx"] {
            assert_eq!(parse_channel(other), None, "{other}");
        }
    }
}
