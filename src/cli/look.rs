//! The surface, its material and its levels, as options have them.

use clap::{Args, ValueEnum};

use super::rules::{Convolution, Diffuse};
use crate::brdf::Brdf;
use crate::lit_surface::{LevelChoice, LitSurface};
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
    /// The MIP level that every pixel reads; without it, the one that fits the pixel.
    #[arg(long, value_name = "LEVEL")]
    pub level: Option<f32>,
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

impl LookArguments {
    /// Sets what was asked for.
    pub fn apply_to(&self, surface: &mut LitSurface) {
        let material = &mut surface.material;
        material.shininess = self.brdf.map_or(material.shininess, |brdf| brdf.exponent() as f32);
        if self.brdf == Some(Brdf::Lambert) {
            material.specular = 0.0;
        }
        material.convolution = self.convolution.map_or(material.convolution, Convolution::rule);
        material.diffuse_rule = self.diffuse.map_or(material.diffuse_rule, Diffuse::rule);
        surface.shape.kind = self.shape.map_or(surface.shape.kind, ShapeArgument::kind);
        surface.shape.tiling = self.tiling.map_or(surface.shape.tiling, |tiling| [tiling; 2]);
        surface.level = self.level.map_or(surface.level, LevelChoice::Fixed);
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
