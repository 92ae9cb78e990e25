//! From stored samples to unit normals.
//!
//! `n = 2 c / c_max - 1` per channel (`c_max` 255 or 65535), then normalised; so (128, 128, 255) leans 0.32 degrees,
//! which is the map's own lean. Floats are taken as they are where any colour sample is negative, else as
//! `n = 2 c - 1`; a warning says which. With two channels, or x in alpha,
//! `z = sqrt(max(0, 1 - x^2 - y^2))`; where the third holds z
//! from 0 to 1, `z = c`. Where the file is sRGB-encoded, `c` is the linear value.
//!
//! A texel is invalid where its colour is exactly black, its decoded length is below 0.1, or a sample is not finite.
//! Normals are computed in f64 and stored as f32, whose error (6e-8) is far below what any file resolves.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::diagnose::{Curl, Tally, Warning, alpha_varies};
use super::height::HeightMap;
use super::{GreenChannel, MapOptions, MapSource, NormalMap, StoredZ};
use crate::color::linear_from_srgb;
use crate::image_io::{self, RasterImage, ReadImageError};

/// A decoded length below this holds no direction worth the name: rounding alone moves it by tens of degrees.
const SHORTEST: f64 = 0.1;

/// An image is greyscale where more than this share of its texels that are not black are grey. The rest allows for
/// a stray mark on a height map; a normal map is blue nearly everywhere.
const GREY_SHARE: f64 = 0.999;

/// Why an image is no normal map. `name` is the file's or the bundled map's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum DecodeError {
    /// All channels are equal, as in a height map.
    #[error("'{name}' is greyscale and holds no normals; if it is a height map, add --height SCALE")]
    Greyscale { name: String },
    /// It has no alpha for x to be in.
    #[error("'{name}' has no alpha channel that could hold x")]
    NoAlpha { name: String },
    /// Every texel is exactly black.
    #[error("'{name}' is black all over and holds no normals")]
    Black { name: String },
    /// Not one texel is valid.
    #[error("'{name}' holds no valid normal: every texel is black, too short or not finite")]
    NoNormals { name: String },
}

/// Why a file could not be opened as a normal map; each message names the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    /// The image could not be read.
    #[error(transparent)]
    Read(#[from] ReadImageError),
    /// The image is no normal map.
    #[error(transparent)]
    Decode(#[from] DecodeError),
}

impl NormalMap {
    /// Reads a file as a normal map, or as heights where the options say so.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read(path: &Path, options: &MapOptions) -> Result<Self, OpenError> {
        let image = image_io::read(path)?;
        Ok(Self::from_image(image, MapSource::File(path.to_owned()), options)?)
    }

    /// Reads the bytes of a file that came without a path.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read_bytes(name: &str, bytes: &[u8], options: &MapOptions) -> Result<Self, OpenError> {
        let image = image_io::decode_bytes(name, bytes)?;
        Ok(Self::from_image(image, MapSource::File(name.into()), options)?)
    }

    /// Decodes an image that is already in memory.
    ///
    /// # Errors
    /// One sentence that names the source and the cause.
    pub fn from_image(image: RasterImage, source: MapSource, options: &MapOptions) -> Result<Self, DecodeError> {
        let name = source.to_string();
        let mut map = match options.height_scale {
            Some(scale) => from_heights(image, source, options, scale.into()),
            None => from_normals(image, source, options)?,
        };
        if alpha_varies(&map.stored) && !options.x_in_alpha {
            map.warnings.push(Warning::AlphaVaries);
        }
        if map.invalid == map.len() {
            return Err(DecodeError::NoNormals { name });
        }
        Ok(map)
    }

    /// A map of `image`'s size without normals yet.
    fn unfilled(image: RasterImage, source: MapSource, options: &MapOptions) -> Self {
        let texels = image.texels();
        Self {
            width: image.width,
            height: image.height,
            x: vec![0.0; texels],
            y: vec![0.0; texels],
            z: vec![0.0; texels],
            invalid: 0,
            options: options.clone(),
            source,
            stored: Arc::new(image),
            warnings: Vec::new(),
            decoder: None,
            albedo: None,
        }
    }

    /// Takes the green convention under which the slopes are those of a surface. The map was read as +Y up, and stays
    /// so where the slopes do not tell.
    fn settle_green(&mut self) {
        let curl = Curl::of((self.width, self.height), |texel| self.normal(texel).map(Vec3::as_dvec3));
        self.options.green = curl.green().unwrap_or(GreenChannel::Up);
        if self.options.green == GreenChannel::Down {
            self.y.iter_mut().for_each(|y| *y = -*y);
            if let Some(decoder) = &mut self.decoder {
                decoder.y_sign = -1.0;
            }
        }
    }

    /// Stores what `decode` gives for every texel: a unit normal and the length it was decoded with.
    fn fill(&mut self, decode: impl Fn(usize) -> Option<(DVec3, f64)> + Sync) {
        let width = self.width;
        let rows = (self.x.par_chunks_mut(width), self.y.par_chunks_mut(width), self.z.par_chunks_mut(width));
        let tally = rows
            .into_par_iter()
            .enumerate()
            .map(|(row, (x, y, z))| fill_row([x, y, z], |column| decode(row * width + column)))
            .reduce(Tally::default, Tally::plus);
        self.invalid = tally.invalid;
        self.warnings.extend(tally.warnings(self.options.object_space));
    }
}

/// Stores one row of normals in its three planes and counts them.
fn fill_row([x, y, z]: [&mut [f32]; 3], decode: impl Fn(usize) -> Option<(DVec3, f64)>) -> Tally {
    let mut tally = Tally::default();
    for column in 0..x.len() {
        let Some((normal, length)) = decode(column) else {
            tally.invalid += 1;
            continue;
        };
        [x[column], y[column], z[column]] = normal.as_vec3().to_array();
        tally.count_valid(length, normal.z);
    }
    tally
}

fn from_heights(image: RasterImage, source: MapSource, options: &MapOptions, scale: f64) -> NormalMap {
    let in_color = image.color_channels() > 1 && !is_greyscale(&image);
    let normals = HeightMap::from_image(&image).normals(scale, options.addressing, options.slopes);
    let mut map = NormalMap::unfilled(image, source, options);
    map.fill(|texel| normals[texel].map(|normal| (normal, 1.0)));
    if in_color {
        map.warnings.push(Warning::HeightsFromColor);
    }
    map
}

fn from_normals(image: RasterImage, source: MapSource, options: &MapOptions) -> Result<NormalMap, DecodeError> {
    let name = source.to_string();
    if (0..image.texels()).all(|texel| is_black(&image, texel)) {
        return Err(DecodeError::Black { name });
    }
    if options.x_in_alpha && !image.has_alpha {
        return Err(DecodeError::NoAlpha { name });
    }
    let asked_for_two = options.x_in_alpha || options.two_channel && image.color_channels() > 1;
    if !asked_for_two && is_greyscale(&image) {
        return Err(DecodeError::Greyscale { name });
    }
    Ok(from_known_normals(image, source, options))
}

/// Decodes an image that is known to be a normal map, without asking whether it is one.
pub(super) fn from_known_normals(image: RasterImage, source: MapSource, options: &MapOptions) -> NormalMap {
    let decoder = Decoder::new(&image, options);
    let mut map = NormalMap::unfilled(image, source, options);
    map.warnings.extend(decoder.range.warning());
    let stored = Arc::clone(&map.stored);
    map.fill(|texel| decoder.decode(&stored, texel));
    map.decoder = Some(decoder);
    if options.green == GreenChannel::Auto {
        map.settle_green();
    }
    map
}

/// What stored values run over.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Range {
    /// Integers up to this full scale.
    Integer(f64),
    /// Floats from 0 to 1.
    Unsigned,
    /// Floats from -1 to 1.
    Signed,
}

impl Range {
    fn warning(self) -> Option<Warning> {
        match self {
            Self::Integer(_) => None,
            Self::Unsigned => Some(Warning::FloatsTakenAsUnsigned),
            Self::Signed => Some(Warning::FloatsTakenAsSigned),
        }
    }
}

/// The conventions of one file, by which any stored texel can be decoded again in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoder {
    range: Range,
    srgb: bool,
    /// `None` where z is taken from x and y.
    z: Option<StoredZ>,
    /// The channels that hold x and y.
    xy_channels: [usize; 2],
    y_sign: f64,
    slope_scale: f64,
}

impl Decoder {
    /// The conventions of `image`, read as the options say.
    pub fn new(image: &RasterImage, options: &MapOptions) -> Self {
        let planar = options.is_planar() || image.color_channels() == 2;
        let used = if planar { 2 } else { 3 };
        Self {
            range: range_of(image, used),
            srgb: options.srgb,
            z: (!planar).then_some(options.z),
            xy_channels: if options.x_in_alpha { in_alpha(image) } else { [0, 1] },
            y_sign: if options.green == GreenChannel::Down { -1.0 } else { 1.0 },
            slope_scale: options.slope_scale.map_or(1.0, f64::from),
        }
    }

    /// True where the file's floats are components as they are.
    pub fn is_signed(&self) -> bool {
        self.range == Range::Signed
    }

    /// The unit normal of a stored texel in f64, or `None` where it is invalid.
    pub fn normal(&self, image: &RasterImage, texel: usize) -> Option<DVec3> {
        self.decode(image, texel).map(|(normal, _)| normal)
    }

    /// The unit normal of a texel and the length it was decoded with, or `None` where it is invalid.
    pub fn decode(&self, image: &RasterImage, texel: usize) -> Option<(DVec3, f64)> {
        if is_black(image, texel) {
            return None;
        }
        let xy = self.xy(image, texel);
        let stored_z = || image.samples.get(texel * image.channels + 2);
        let z = match self.z {
            None => (1.0 - xy.x * xy.x - xy.y * xy.y).max(0.0).sqrt(),
            Some(StoredZ::Signed) => self.component(stored_z()),
            Some(StoredZ::Unsigned) => self.linear(stored_z()),
        };
        let vector = xy.extend(z);
        let length = vector.length();
        let scaled = vector * DVec3::new(self.slope_scale, self.slope_scale, 1.0);
        (length.is_finite() && length >= SHORTEST).then(|| (scaled.normalize_or(DVec3::Z), length))
    }

    /// The x and y of a texel as they are stored, before the normal is normalised.
    pub fn xy(&self, image: &RasterImage, texel: usize) -> DVec2 {
        let component = |channel: usize| self.component(image.samples.get(texel * image.channels + channel));
        let [x, y] = self.xy_channels.map(component);
        DVec2::new(x, self.y_sign * y)
    }

    /// A stored value as a component from -1 to 1.
    fn component(&self, stored: f64) -> f64 {
        match self.range {
            Range::Signed => stored,
            // To the bit the negative of what the opposite value gives: a mirrored map is one.
            Range::Integer(full_scale) if !self.srgb => (2.0 * stored - full_scale) / full_scale,
            Range::Integer(_) | Range::Unsigned => 2.0 * self.linear(stored) - 1.0,
        }
    }

    /// A stored value from 0 to 1, freed of the sRGB curve where it was encoded with it.
    fn linear(&self, stored: f64) -> f64 {
        let value = if let Range::Integer(full_scale) = self.range { stored / full_scale } else { stored };
        if self.srgb && !self.is_signed() { linear_from_srgb(value as f32).into() } else { value }
    }
}

/// The channels of x and y where x is in alpha: y is in green, or in the one colour channel there is.
fn in_alpha(image: &RasterImage) -> [usize; 2] {
    [image.channels - 1, 1.min(image.color_channels() - 1)]
}

fn range_of(image: &RasterImage, used: usize) -> Range {
    if let Some(full_scale) = image.samples.full_scale() {
        return Range::Integer(full_scale);
    }
    let negative = |texel: usize| (0..used).any(|channel| image.samples.get(texel * image.channels + channel) < 0.0);
    if (0..image.texels()).any(negative) { Range::Signed } else { Range::Unsigned }
}

/// True where every colour sample of a texel is exactly 0.
pub(super) fn is_black(image: &RasterImage, texel: usize) -> bool {
    let first = texel * image.channels;
    (first..first + image.color_channels()).all(|index| image.samples.get(index) == 0.0)
}

/// True for one colour channel, or three that are equal nearly everywhere outside black; never for two.
fn is_greyscale(image: &RasterImage) -> bool {
    if image.color_channels() != 3 {
        return image.color_channels() == 1;
    }
    let (mut colored, mut grey) = (0_usize, 0_usize);
    for texel in (0..image.texels()).filter(|&texel| !is_black(image, texel)) {
        let sample = |channel: usize| image.samples.get(texel * image.channels + channel);
        let is_grey = sample(0) == sample(1) && sample(1) == sample(2);
        *(if is_grey { &mut grey } else { &mut colored }) += 1;
    }
    grey as f64 > GREY_SHARE * (grey + colored) as f64
}

#[cfg(test)]
#[path = "decode_tests.rs"]
mod tests;
