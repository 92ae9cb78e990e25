//! The surface, its material and its levels, as options have them.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use clap::Args;

use super::brdf::BrdfArgument;
use super::options::parse_fresnel;
use super::rules::{Bump, Convolution, Diffuse, FramePerPixel};
use crate::filter::LevelChoice;
use crate::filter::probes::MOST_PROBES;
use crate::lighting::sky_harmonics::MOST_BANDS;
use crate::lighting::{Light, Lights, Sky, SkySource};
use crate::lit_surface::LitSurface;
use crate::scene::{FrameRule, Model, Shape, ShapeKind};

/// The surface, its material and the level it reads.
#[derive(Args, Clone, Debug, Default)]
pub struct LookArguments {
    /// The material's BRDF: lambert, blinn-phong:S, torrance-sparrow:SIGMA, ggx:ALPHA or merl:FILE.
    #[arg(long, value_name = "BRDF")]
    pub brdf: Option<BrdfArgument>,
    /// Specular strength Ks.
    #[arg(long, value_name = "KS", value_parser = parse_strength)]
    pub ks: Option<f32>,
    /// Diffuse strength Kd.
    #[arg(long, value_name = "KD", value_parser = parse_strength)]
    pub kd: Option<f32>,
    /// Strength of Schlick's Fresnel factor, 1 - F0: from 0, none, to 1.
    #[arg(long, value_name = "STRENGTH", value_parser = parse_fresnel)]
    pub fresnel: Option<f32>,
    /// How a lobe and the material are convolved.
    #[arg(long, value_enum)]
    pub convolution: Option<Convolution>,
    /// How a lobe reflects diffusely.
    #[arg(long, value_enum)]
    pub diffuse: Option<Diffuse>,
    /// The surface: plane, sphere, torus, monkey-saddle, teapot, or the file of a mesh (OBJ, glTF or GLB).
    #[arg(long, value_name = "NAME|FILE")]
    pub shape: Option<ShapeArgument>,
    /// The torus's radii: of the ring and of its tube.
    #[arg(long, value_name = "RING,TUBE", value_parser = parse_radii)]
    pub radii: Option<[f32; 2]>,
    /// Repeats of the map along each side of the surface, or along u and v.
    #[arg(long, value_name = "N|U,V", value_parser = parse_tiling)]
    pub tiling: Option<[f32; 2]>,
    /// How far each row of the tiled map is shifted sideways, per unit of height.
    #[arg(long, value_name = "K", allow_negative_numbers = true)]
    pub shear: Option<f32>,
    /// Degrees that the texture coordinates are turned by, counter-clockwise.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub turn: Option<f32>,
    /// The frames of a mesh: file, those that a glTF file brings or else MikkTSpace's; mikktspace; grouped or grouped:DEGREES, by Mikkelsen's four rules, averaging only what lies
    /// within so many degrees.
    #[arg(long, value_name = "RULE")]
    pub frames: Option<FrameRule>,
    /// What is made of the vertices' frames at a pixel between them.
    #[arg(long, value_enum)]
    pub reconstruction: Option<FramePerPixel>,
    /// How a map of heights bumps a parametric surface.
    #[arg(long, value_enum, value_name = "RULE")]
    pub bump: Option<Bump>,
    /// What a height of 1 is then, in the surface's own units.
    #[arg(long, value_name = "LAMBDA", value_parser = parse_bump_scale, allow_negative_numbers = true)]
    pub bump_scale: Option<f32>,
    /// Mirror the map, left for right.
    #[arg(long)]
    pub mirror: bool,
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
    /// How the specular light of the sky's sun is taken, if it has one.
    #[arg(long, value_enum)]
    pub sky_sun: Option<SkySun>,
}

/// The sun of a sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SkySun {
    /// A far light of its own.
    Apart,
    /// In the bands, with the rest of the sky (Han et al. 2007, eq. 26).
    Bands,
}

/// The surface by name, or a mesh by its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ShapeArgument {
    /// A surface of the program's own.
    BuiltIn(ShapeKind),
    /// A file.
    File(PathBuf),
}

impl FromStr for ShapeArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match ShapeKind::BUILT_IN.into_iter().find(|kind| kind.name() == text) {
            Some(kind) => Ok(Self::BuiltIn(kind)),
            None if text.contains(['.', '/']) => Ok(Self::File(text.into())),
            None => {
                let names = ShapeKind::BUILT_IN.map(ShapeKind::name).join(", ");
                Err(format!("write {names}, or the path of a mesh"))
            }
        }
    }
}

fn parse_pair(text: &str) -> Option<[f32; 2]> {
    let (first, second) = text.split_once(',')?;
    Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
}

fn parse_strength(text: &str) -> Result<f32, String> {
    let strength = text.parse().ok().filter(|strength| (0.0..=100.0).contains(strength));
    strength.ok_or_else(|| "write a strength from 0 to 100".to_owned())
}

fn parse_tiling(text: &str) -> Result<[f32; 2], String> {
    let pair = text.parse().ok().map(|both| [both; 2]).or_else(|| parse_pair(text));
    let pair = pair.filter(|pair| pair.iter().all(|repeats| repeats.is_finite() && *repeats > 0.0));
    pair.ok_or_else(|| "write one number above 0, or two as in 60,36".to_owned())
}

fn parse_radii(text: &str) -> Result<[f32; 2], String> {
    let pair = parse_pair(text).filter(|&[ring, tube]| ring > tube && tube > 0.0 && ring.is_finite());
    pair.ok_or_else(|| "write the ring's radius and the tube's smaller one, as in 0.75,0.35".to_owned())
}

fn parse_bump_scale(text: &str) -> Result<f32, String> {
    let scale = text.parse().ok().filter(|scale: &f32| scale.is_finite() && *scale != 0.0);
    scale.ok_or_else(|| "write a number that is not 0, as in 0.0625".to_owned())
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
    /// Reads the mesh that was asked for, if one was.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn model(&self) -> anyhow::Result<Option<Arc<Model>>> {
        let Some(ShapeArgument::File(path)) = &self.shape else { return Ok(None) };
        Ok(Some(Arc::new(Model::read(path)?)))
    }

    /// Sets what was asked for; `model` is the mesh that was read.
    ///
    /// # Errors
    /// One sentence that says what cannot be.
    pub fn apply_to(&self, surface: &mut LitSurface, model: Option<Arc<Model>>) -> anyhow::Result<()> {
        let material = &mut surface.material;
        if let Some(brdf) = &self.brdf {
            material.set_brdf(brdf.read()?);
        }
        material.specular = self.ks.unwrap_or(material.specular);
        material.diffuse = self.kd.unwrap_or(material.diffuse);
        material.fresnel = self.fresnel.unwrap_or(material.fresnel);
        material.convolution = self.convolution.map_or(material.convolution, Convolution::rule);
        material.diffuse_rule = self.diffuse.map_or(material.diffuse_rule, Diffuse::rule);
        if let Some(model) = model {
            surface.wear_on(model);
        }
        let shape = &mut surface.shape;
        if let Some(ShapeArgument::BuiltIn(kind)) = self.shape {
            shape.kind = kind;
        }
        *shape = Shape {
            radii: self.radii.unwrap_or(shape.radii),
            tiling: self.tiling.unwrap_or(shape.tiling),
            shear: self.shear.unwrap_or(shape.shear),
            frames: self.frames.unwrap_or(shape.frames),
            reconstruction: self.reconstruction.map_or(shape.reconstruction, FramePerPixel::way),
            bump: self.bump.map_or(shape.bump, Bump::rule),
            bump_scale: self.bump_scale.unwrap_or(shape.bump_scale),
            turn_deg: self.turn.unwrap_or(shape.turn_deg),
            mirrored: self.mirror || shape.mirrored,
            ..shape.clone()
        };
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
        sky.is_sun_apart = self.sky_sun.map_or(sky.is_sun_apart, |sun| sun == SkySun::Apart);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        look: LookArguments,
    }

    fn look(arguments: &[&str]) -> Result<LookArguments, clap::Error> {
        Command::try_parse_from([&["command"], arguments].concat()).map(|command| command.look)
    }

    #[test]
    fn the_strengths_are_the_materials() {
        let mut surface = LitSurface::default();
        let plain = surface.material;
        look(&["--ks", "0.4"]).expect("an option").apply_to(&mut surface, None).expect("applies");
        assert_eq!((surface.material.specular, surface.material.diffuse), (0.4, plain.diffuse));
        look(&["--kd", "0"]).expect("an option").apply_to(&mut surface, None).expect("applies");
        assert_eq!((surface.material.specular, surface.material.diffuse), (0.4, 0.0));
        for wrong in ["-1", "101", "nan", "much"] {
            assert!(look(&["--ks", wrong]).is_err() && look(&["--kd", wrong]).is_err(), "{wrong}");
        }
    }
}
