//! OpenEXR files of several parts, each a raster of named f32 channels.
//!
//! Rows go in and come out one at a time, so no second copy of the samples is ever in memory: a few blocks of 16
//! rows are, while they are compressed or decompressed (losslessly, by ZIP).

mod read;
mod write;

use std::collections::BTreeMap;

pub use read::PartsReader;
pub use write::write_parts;

/// What a part is, beside its samples.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// Its name, different from the other parts'.
    pub name: String,
    /// Texels across and down.
    pub size: (usize, usize),
    /// The channels' names, sorted.
    pub channels: Vec<String>,
    /// What is written beside the samples.
    pub notes: Notes,
}

/// Attributes of a part, each ASCII text; an empty one is not written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notes {
    /// `software`: the program and its version.
    pub software: String,
    /// `wrapmodes`: `periodic` or `clamp`.
    pub wrap_mode: String,
    /// Attributes that the format does not know, by name. At most one is written in the same order every time: the
    /// library shuffles them.
    pub own: BTreeMap<String, String>,
}

/// A run of samples of one channel in one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Index of the part.
    pub part: usize,
    /// Index of the channel among the part's.
    pub channel: usize,
    /// Column of the first sample.
    pub x: usize,
    /// Row from the top.
    pub y: usize,
}
