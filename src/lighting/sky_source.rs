//! Where a sky comes from, and what can be wrong with one.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::environment::MOST_RADIANCE;
use super::{Environment, ProceduralSky};
use crate::image_io::{self, RasterImage, ReadImageError, Samples};

/// A sky by name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SkySource {
    /// A file: Radiance HDR or OpenEXR, by latitude and longitude.
    Path(PathBuf),
    /// One that the program makes.
    Bundled(ProceduralSky),
}

/// Why a sky cannot light.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum SkyError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadImageError),
    /// The file holds code values, not radiance.
    #[error("'{name}' is a {format} file of {depth}; a sky is read from Radiance HDR or from floats in OpenEXR")]
    NotRadiance { name: String, format: &'static str, depth: &'static str },
    /// It is not a picture by latitude and longitude.
    #[error("'{name}' is {width}x{height} texels; a sky is twice as wide as high")]
    NotTwiceAsWide { name: String, width: usize, height: usize },
    /// A value is infinite, or no number.
    #[error("'{name}' holds a value that is no number, at texel ({x}, {y})")]
    NotFinite { name: String, x: usize, y: usize },
    /// A value is beyond all light.
    #[error("'{name}' holds a radiance above {MOST_RADIANCE:e}, at texel ({x}, {y})")]
    TooBright { name: String, x: usize, y: usize },
    /// Nothing shines.
    #[error("'{name}' is black everywhere: it lights nothing")]
    Black { name: String },
}

impl SkySource {
    /// Reads or makes the sky; the harmonics take about a second.
    ///
    /// # Errors
    /// A sentence that names the file and the cause.
    pub fn load(&self) -> Result<Environment, SkyError> {
        match self {
            Self::Bundled(sky) => Environment::new(self.clone(), ProceduralSky::WIDTH, sky.radiance()),
            Self::Path(path) => {
                let image = image_io::read(path)?;
                let radiance = radiance(&self.to_string(), &image)?;
                Environment::new(self.clone(), image.width, radiance)
            }
        }
    }

    /// The file's name without its folders, or the sky's.
    pub fn short_name(&self) -> String {
        match self {
            Self::Path(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            Self::Bundled(sky) => sky.name().to_owned(),
        }
    }
}

/// The colours of an image of floats; one channel is grey.
fn radiance(name: &str, image: &RasterImage) -> Result<Vec<Vec3>, SkyError> {
    let Samples::F32(values) = &image.samples else {
        let (format, depth) = (image.format, image.depth.label());
        return Err(SkyError::NotRadiance { name: name.to_owned(), format, depth });
    };
    let colors = image.color_channels();
    let color = |texel: &[f32]| Vec3::from_array([0, 1, 2].map(|channel| texel[if colors < 3 { 0 } else { channel }]));
    Ok(values.chunks_exact(image.channels).map(color).collect())
}

impl std::fmt::Display for SkySource {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Path(path) => write!(formatter, "{}", path.display()),
            Self::Bundled(sky) => formatter.write_str(sky.name()),
        }
    }
}

impl FromStr for SkySource {
    type Err = std::convert::Infallible;

    /// The bundled sky of this name, unless there is a file that is called so; else the file.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let bundled = ProceduralSky::ALL.into_iter().find(|sky| sky.name() == text && !Path::new(text).exists());
        Ok(bundled.map_or_else(|| Self::Path(text.into()), Self::Bundled))
    }
}
