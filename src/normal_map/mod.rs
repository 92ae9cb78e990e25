//! The map that is inspected: unit normals of the base level, how they were read, and what was odd about them.
//!
//! Coordinates: `x` runs right and `y` runs down from the top-left texel, as in the image file. A normal is in
//! tangent space: `+x` right, `+y` up the image, `+z` out of it, whatever the file's own green convention was.

pub mod albedo;
pub mod decode;
pub mod diagnose;
pub mod height;
pub mod pose;
pub mod procedural;
pub mod pyramid;

use std::path::PathBuf;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use crate::image_io::{RasterImage, ReadImageError, SampleDepth, Samples};
use albedo::Albedo;
pub use decode::{DecodeError, OpenError};
pub use diagnose::{Diagnosis, Warning};
pub use height::SlopeKernel;

/// The convention of a file's green channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GreenChannel {
    /// Green above one half faces the top of the image (OpenGL).
    #[default]
    Up,
    /// Green above one half faces the bottom of the image (DirectX); negated on reading.
    Down,
    /// Whichever makes the slopes a surface; an open map says which it was.
    Auto,
}

/// What a third channel runs over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoredZ {
    /// From -1 to 1, as x and y do.
    #[default]
    Signed,
    /// From 0 to 1: only what faces the viewer.
    Unsigned,
}

/// What lies beyond an edge of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Addressing {
    /// The map tiles: the opposite edge follows.
    #[default]
    Wrap,
    /// The edge texel goes on for ever.
    Clamp,
}

/// How a file is read as a normal map.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct MapOptions {
    /// The green channel's convention.
    pub green: GreenChannel,
    /// What lies beyond an edge.
    pub addressing: Addressing,
    /// Takes z from x and y, whatever the third channel holds.
    pub two_channel: bool,
    /// Takes x from alpha, y from green and z from both, as textures in the DXT5nm layout hold them.
    pub x_in_alpha: bool,
    /// What the third channel runs over, where it is read.
    pub z: StoredZ,
    /// The samples are sRGB-encoded.
    pub srgb: bool,
    /// The normals are the object's and not the surface's: all directions are right, none is below a surface.
    pub object_space: bool,
    /// Reads the image as heights, scaled by this factor (in texel widths per full range), instead of as normals.
    pub height_scale: Option<f32>,
    /// How slopes are taken from heights.
    pub slopes: SlopeKernel,
    /// Multiplies the x and y of every normal, and with them the slopes, before it is normalised.
    pub slope_scale: Option<f32>,
    /// An image of the surface's colour, fitted along.
    pub color: Option<PathBuf>,
}

impl MapOptions {
    /// The height of the full range of a height map, in texel widths, unless told.
    pub const HEIGHT_SCALE: f32 = 4.0;

    /// True where z is taken from x and y.
    pub fn is_planar(&self) -> bool {
        self.two_channel || self.x_in_alpha
    }
}

/// Where a map came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MapSource {
    /// A file on disk.
    File(PathBuf),
    /// One of the program's own maps, by name.
    Bundled(&'static str),
}

/// A normal map ready to be filtered: validated once, immutable, shared by reference count.
#[derive(Clone, Debug)]
pub struct NormalMap {
    /// Texels across.
    pub width: usize,
    /// Texels down.
    pub height: usize,
    /// The x components of the unit normals, row by row; an invalid texel holds the zero vector, which adds
    /// nothing to any sum.
    pub x: Vec<f32>,
    /// The y components, `+y` up the image.
    pub y: Vec<f32>,
    /// The z components.
    pub z: Vec<f32>,
    /// How many texels are invalid (black, too short, or not finite).
    pub invalid: usize,
    /// How the file was read.
    pub options: MapOptions,
    /// Where it came from.
    pub source: MapSource,
    /// The samples as stored, for the texel read-out.
    pub stored: Arc<RasterImage>,
    /// What was odd about the file.
    pub warnings: Vec<Warning>,
    /// How a stored texel is decoded again in f64; `None` where the normals come from heights or from a fit.
    pub decoder: Option<decode::Decoder>,
    /// The surface's colour, where one was given.
    pub albedo: Option<Arc<Albedo>>,
}

impl std::fmt::Display for MapSource {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path) => write!(formatter, "{}", path.display()),
            Self::Bundled(name) => formatter.write_str(name),
        }
    }
}

impl NormalMap {
    /// A map of normals that are known already: `[x, y, z]` row by row, unit vectors, zero where there is none.
    pub fn from_unit_normals(
        (width, height): (usize, usize),
        [x, y, z]: [Vec<f32>; 3],
        source: MapSource,
        options: MapOptions,
    ) -> Self {
        let samples = x.iter().zip(&y).zip(&z).flat_map(|((&x, &y), &z)| [x, y, z]).collect();
        let stored = RasterImage {
            width,
            height,
            channels: 3,
            has_alpha: false,
            samples: Samples::F32(samples),
            depth: SampleDepth::Float,
            format: "OpenEXR",
            tagged_srgb: false,
        };
        let mut map = Self {
            width,
            height,
            x,
            y,
            z,
            invalid: 0,
            options,
            source,
            stored: Arc::new(stored),
            warnings: Vec::new(),
            decoder: None,
            albedo: None,
        };
        map.invalid = (0..map.len()).filter(|&index| map.normal(index).is_none()).count();
        if map.invalid > 0 {
            map.warnings.push(Warning::InvalidTexels { count: map.invalid, total: map.len() });
        }
        map
    }

    /// Reads the colour that the options name, if any.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read_color(&mut self, options: &MapOptions) -> Result<(), ReadImageError> {
        let Some(path) = &options.color else { return Ok(()) };
        let (albedo, warnings) = Albedo::read(path, (self.width, self.height))?;
        self.albedo = Some(Arc::new(albedo));
        self.options.color = Some(path.clone());
        self.warnings.extend(warnings);
        Ok(())
    }

    /// What the samples say of how they should be read.
    pub fn diagnose(&self) -> Diagnosis {
        Diagnosis::new(&self.stored, &self.options)
    }

    /// Takes an image in memory as the surface's colour.
    pub fn wear_color(&mut self, image: &RasterImage) {
        let (albedo, warnings) = Albedo::from_image(image, (self.width, self.height));
        self.albedo = Some(Arc::new(albedo));
        self.warnings.extend(warnings);
    }

    /// Linear RGB of a base texel; white where no colour was given.
    pub fn color(&self, index: usize) -> Vec3 {
        self.albedo.as_ref().map_or(Vec3::ONE, |albedo| albedo.rgb[index].into())
    }

    /// Texels in the base level.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// True for a map without texels, which no reader makes.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// The unit normal of the texel at row-major `index`, or `None` where it is invalid.
    pub fn normal(&self, index: usize) -> Option<Vec3> {
        let normal = Vec3::new(self.x[index], self.y[index], self.z[index]);
        (normal != Vec3::ZERO).then_some(normal)
    }

    /// The unit normal in f64, decoded anew from the stored texel: the truth asks for more than f32 keeps.
    pub fn precise_normal(&self, index: usize) -> Option<DVec3> {
        match &self.decoder {
            Some(decoder) => decoder.normal(&self.stored, index),
            None => self.normal(index).map(Vec3::as_dvec3),
        }
    }

    /// The name to show: the file's, or the bundled map's.
    pub fn name(&self) -> String {
        match &self.source {
            MapSource::File(path) => {
                path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
            }
            MapSource::Bundled(name) => (*name).to_owned(),
        }
    }

    /// The height of a texel, the full range of an integer as 1; 0 for a map of normals, and where it is not finite.
    pub fn height_of(&self, texel: usize) -> f32 {
        let height = self.options.height_scale.map_or(0.0, |_| height::height_of(&self.stored, texel)) as f32;
        if height.is_finite() { height } else { 0.0 }
    }

    /// By how much slopes by texture coordinates are steeper than those of the normals, which count texels, where a
    /// height of 1 is `scale` high; `None` for a map of normals.
    pub fn rise(&self, scale: f32) -> Option<Vec2> {
        let own = self.options.height_scale.filter(|own| *own != 0.0)?;
        Some(scale / own * Vec2::new(self.width as f32, self.height as f32))
    }

    /// Width and height of every MIP level, the base first.
    pub fn level_sizes(&self) -> Vec<(usize, usize)> {
        pyramid::level_sizes(self.width, self.height)
    }

    /// Width and height of one MIP level.
    pub fn level_size(&self, level: usize) -> (usize, usize) {
        ((self.width >> level).max(1), (self.height >> level).max(1))
    }
}
