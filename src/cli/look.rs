//! The surface, its material and its levels, as options have them.

use std::sync::Arc;

use clap::{Args, ValueEnum};

use super::rules::{Convolution, Diffuse};
use crate::brdf::Brdf;
use crate::filter::LevelChoice;
use crate::filter::probes::MOST_PROBES;
use crate::lighting::sky_harmonics::MOST_BANDS;
use crate::lighting::{Light, Lights, Sky, SkySource};
use crate::lit_surface::LitSurface;
use crate::scene::ShapeKind;

/// The surface, its material and the level it reads.
#[derive(Args, Clone, Debug, Default)]
pub struct LookArguments {
    /// The material's BRDF: lambert or blinn-phong:S.
    #[arg(long, value_name = "BRDF")]
    pub brdf: Option<Brdf>,
    /// How a lobe and the material are convolved.
    #[arg(long, value_enum)]
    pub convolution: Option<Convolution>,
    /// How a lobe reflects diffusely.
    #[arg(long, value_enum)]
    pub diffuse: Option<Diffuse>,
    /// The surface.
    #[arg(long, value_enum)]
    pub shape: Option<ShapeArgument>,
    /// Repeats of the map along each side of the surface.
    #[arg(long, value_name = "N")]
    pub tiling: Option<f32>,
    /// The MIP level that pixels read: auto, at which a lookup blurs as much as the pixel does; hardware, whose texels
    /// are as wide as the pixel is long; or a number, read everywhere.
    #[arg(long, value_name = "LEVEL", value_parser = parse_level)]
    pub level: Option<LevelChoice>,
    /// Most probes along the long axis of a pixel's footprint, 1 to 16.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_PROBES)))]
    pub anisotropy: Option<u32>,
    /// A light, up to eight times; the first takes the place of all there were: azimuth=DEGREES, elevation=DEGREES,
    /// intensity=FACTOR, color=#RRGGBB (sRGB) and distance=D with commas between, whichever are wanted. With a distance
    /// from the surface's centre it is a point light and falls off by the inverse square.
    #[arg(long = "light", value_name = "LIGHT")]
    pub lights: Vec<Light>,
    /// No light but the sky.
    #[arg(long, conflicts_with = "lights")]
    pub no_lights: bool,
    /// The sky that lights the surface: clear, overcast, studio, or a file by latitude and longitude, Radiance HDR or
    /// OpenEXR.
    #[arg(long, value_name = "NAME|FILE")]
    pub sky: Option<SkySource>,
    /// Degrees that the sky is turned.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub sky_rotation: Option<f32>,
    /// Factor on the sky's radiance.
    #[arg(long, value_name = "FACTOR")]
    pub sky_intensity: Option<f32>,
    /// The last band l* of the sky's specular light, 0 to 12.
    #[arg(long, value_name = "L", value_parser = clap::value_parser!(u8).range(0..=MOST_BANDS as i64))]
    pub sky_bands: Option<u8>,
}

/// The surface by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShapeArgument {
    /// A square.
    Plane,
    /// A sphere.
    Sphere,
    /// A torus.
    Torus,
}

fn parse_level(text: &str) -> Result<LevelChoice, String> {
    match text {
        "auto" => Ok(LevelChoice::Auto),
        "hardware" => Ok(LevelChoice::Hardware),
        _ => {
            let level = text.parse().ok().filter(|level| (0.0..=32.0).contains(level));
            level.map(LevelChoice::Fixed).ok_or_else(|| "write auto, hardware, or a level from 0 up".to_owned())
        }
    }
}

impl LookArguments {
    /// Sets what was asked for.
    ///
    /// # Errors
    /// One sentence that says what cannot be.
    pub fn apply_to(&self, surface: &mut LitSurface) -> anyhow::Result<()> {
        let material = &mut surface.material;
        material.shininess = self.brdf.map_or(material.shininess, |brdf| brdf.exponent() as f32);
        if self.brdf == Some(Brdf::Lambert) {
            material.specular = 0.0;
        }
        material.convolution = self.convolution.map_or(material.convolution, Convolution::rule);
        material.diffuse_rule = self.diffuse.map_or(material.diffuse_rule, Diffuse::rule);
        surface.shape.kind = self.shape.map_or(surface.shape.kind, ShapeArgument::kind);
        surface.shape.tiling = self.tiling.map_or(surface.shape.tiling, |tiling| [tiling; 2]);
        surface.level = self.level.unwrap_or(surface.level);
        surface.anisotropy = self.anisotropy.unwrap_or(surface.anisotropy);
        if !self.lights.is_empty() {
            surface.lights = Lights::try_from(self.lights.as_slice())?;
        }
        if self.no_lights {
            surface.lights = Lights::NONE;
        }
        self.apply_sky(&mut surface.sky)
    }

    fn apply_sky(&self, sky: &mut Sky) -> anyhow::Result<()> {
        if let Some(source) = &self.sky {
            sky.environment = Some(Arc::new(source.load()?));
        }
        let is_fit = |value: &f32| value.is_finite() && *value >= 0.0;
        anyhow::ensure!(self.sky_intensity.as_ref().is_none_or(is_fit), "The sky's intensity is no factor from 0 up.");
        sky.rotation_deg = self.sky_rotation.unwrap_or(sky.rotation_deg);
        sky.intensity = self.sky_intensity.unwrap_or(sky.intensity);
        sky.last_band = self.sky_bands.unwrap_or(sky.last_band);
        Ok(())
    }
}

impl ShapeArgument {
    fn kind(self) -> ShapeKind {
        match self {
            Self::Plane => ShapeKind::Plane,
            Self::Sphere => ShapeKind::Sphere,
            Self::Torus => ShapeKind::Torus,
        }
    }
}
