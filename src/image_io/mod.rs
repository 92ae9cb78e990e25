//! Images on disk: reading them with their samples as stored, and writing them whole or not at all.
//!
//! An image is kept at the depth of its file: 16-bit samples stay 16-bit and floats stay floats, because the
//! rounding of the samples is part of what a normal map holds.

mod error;
pub mod exr_parts;
pub mod memory;
mod open_exr;
mod pixel_formats;
mod read;
mod sniff;
mod write;

pub use error::{ReadImageError, WriteImageError};
pub use read::{MAX_FILE_BYTES, MAX_SIDE, decode_bytes, read, read_bytes};
pub use write::{
    png_rgb8, write_bytes_atomically, write_png_gray8, write_png_gray16, write_png_rgb8, write_png_rgb16,
    write_png_rgba8,
};

/// The samples of an image, row by row from the top, the channels of a texel side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Integers of at most 8 bits, full scale 255.
    U8(Vec<u8>),
    /// Integers of 16 bits, full scale 65535.
    U16(Vec<u16>),
    /// Floats; a half float is stored as the same value.
    F32(Vec<f32>),
}

impl Samples {
    /// How many samples there are: width times height times channels.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// True where there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The sample at `index` as stored: 0..=255, 0..=65535, or any float.
    pub fn get(&self, index: usize) -> f64 {
        match self {
            Self::U8(values) => f64::from(values[index]),
            Self::U16(values) => f64::from(values[index]),
            Self::F32(values) => f64::from(values[index]),
        }
    }

    /// The value of full scale, or `None` for floats.
    pub fn full_scale(&self) -> Option<f64> {
        match self {
            Self::U8(_) => Some(255.0),
            Self::U16(_) => Some(65535.0),
            Self::F32(_) => None,
        }
    }
}

/// How finely the file itself stores a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleDepth {
    /// Integers of at most 8 bits.
    Bits8,
    /// Integers of 16 bits.
    Bits16,
    /// Half floats (16 bits).
    Half,
    /// Floats (32 bits), Radiance's shared exponents, or OpenEXR's 32-bit integers.
    Float,
}

impl SampleDepth {
    /// The words the window shows, for example "16-bit".
    pub fn label(self) -> &'static str {
        match self {
            Self::Bits8 => "8-bit",
            Self::Bits16 => "16-bit",
            Self::Half => "half float",
            Self::Float => "float",
        }
    }
}

/// An image as its file stores it.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterImage {
    /// Texels across, 1..=[`MAX_SIDE`].
    pub width: usize,
    /// Texels down, 1..=[`MAX_SIDE`].
    pub height: usize,
    /// Samples per texel, 1..=4, alpha included.
    pub channels: usize,
    /// True where the last channel is alpha.
    pub has_alpha: bool,
    /// The samples, `width * height * channels` of them.
    pub samples: Samples,
    /// How finely the file stores them.
    pub depth: SampleDepth,
    /// The file format's name, for example "PNG".
    pub format: &'static str,
    /// True where the file itself says that its samples are sRGB-encoded.
    pub tagged_srgb: bool,
}

impl RasterImage {
    /// The stored value of one channel at column `x` from the left and row `y` from the top.
    ///
    /// # Panics
    /// Outside the image, as indexing a slice does.
    pub fn sample(&self, x: usize, y: usize, channel: usize) -> f64 {
        self.samples.get((y * self.width + x) * self.channels + channel)
    }

    /// Channels that hold colour: all but alpha.
    pub fn color_channels(&self) -> usize {
        self.channels - usize::from(self.has_alpha)
    }

    /// Texels in the image.
    pub fn texels(&self) -> usize {
        self.width * self.height
    }
}
