//! `bump`: a height map on a parametric surface, with the exact normal or Blinn's, drawn by the processor.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::look::LookArguments;
use super::options::write_text;
use super::render::PictureSize;
use super::rules::Slopes;
use crate::image_io::{self, write_png_rgba8};
use crate::lit_surface::LitSurface;
use crate::normal_map::Addressing;
use crate::reference::bump_picture::{BumpPicture, BumpView};
use crate::scene::Camera;
use crate::scene::bump::BumpRule;

/// A height map on a parametric surface: lit by the exact normal or by Blinn's, or what sets the two apart.
#[derive(Args, Debug)]
pub struct BumpCommand {
    /// The heights: an image, its full scale 1.
    pub heights: PathBuf,
    /// What is drawn.
    #[arg(long, value_enum, default_value_t = Show::Exact)]
    pub show: Show,
    /// What a height of 1 is, in the surface's own units: the torus's radii, the saddle's square of side 2.
    #[arg(long, value_name = "LAMBDA", default_value_t = 0.0625, allow_negative_numbers = true)]
    pub scale: f64,
    /// How slopes are taken from heights.
    #[arg(long, value_enum, default_value_t = Slopes::Central)]
    pub slopes: Slopes,
    /// The edge texel goes on beyond the edge; without it the map tiles.
    #[arg(long)]
    pub clamp: bool,
    /// Draw both normals as needles at N times N points: the exact one orange, Blinn's blue.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=64))]
    pub needles: u32,
    /// The surface and its material.
    #[command(flatten)]
    pub look: LookArguments,
    /// From the eye to the surface's centre.
    #[arg(long, value_name = "D")]
    pub distance: Option<f32>,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "960x600")]
    pub size: PictureSize,
    /// The PNG to write, - for standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// The surface lit with the displaced surface's normal.
    Exact,
    /// The surface lit with Blinn's normal.
    Blinn,
    /// The larger principal curvature.
    Curvature,
    /// The product of height and larger principal curvature.
    Product,
}

impl Show {
    fn view(self) -> BumpView {
        match self {
            Self::Exact => BumpView::Lit(BumpRule::Exact),
            Self::Blinn => BumpView::Lit(BumpRule::Blinn),
            Self::Curvature => BumpView::Curvature,
            Self::Product => BumpView::Product,
        }
    }

    fn quantity(self) -> &'static str {
        if self == Self::Curvature { "curvature" } else { "product of height and curvature" }
    }
}

impl BumpCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let heights = image_io::read(&self.heights)?;
        let mut surface = LitSurface::default();
        self.look.apply_to(&mut surface, self.look.model()?)?;
        let distance = self.distance.unwrap_or(surface.camera.distance);
        surface.camera.distance = distance.clamp(Camera::MIN_DISTANCE, Camera::MAX_DISTANCE);
        let label = surface.shape.kind.label();
        anyhow::ensure!(
            surface.shape.jet(0.5, 0.5).is_some(),
            "{label} is no parametric surface, whose curvature is known."
        );
        let PictureSize(size) = self.size;
        let picture = BumpPicture {
            surface: &surface,
            heights: &heights,
            scale: self.scale,
            kernel: self.slopes.kernel(),
            addressing: if self.clamp { Addressing::Clamp } else { Addressing::Wrap },
            view: self.show.view(),
            needles: self.needles,
        };
        let drawn = picture.draw(size);
        write_png_rgba8(&self.output, size[0] as usize, size[1] as usize, &drawn.rgba)?;
        match drawn.largest {
            Some(largest) if self.output != Path::new("-") => {
                write_text(Path::new("-"), &format!("largest {}: {largest:.4}", self.show.quantity()))
            }
            _ => Ok(()),
        }
    }
}
