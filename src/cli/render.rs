//! `render`: the lit surface alone, without a window; and the options that every picture takes.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use clap::Args;

use super::look::LookArguments;
use super::options::{FitArguments, MapArguments, wait_for_fit};
use super::start::Start;
use crate::app::surface_picture::{captioned, surface_picture};
use crate::comparison::{MOST_METHODS, View};
use crate::filter::{MethodChoice, Rival};
use crate::gpu::context::Gpu;
use crate::image_io::write_png_rgba8;
use crate::scene::{Camera, Model};
use crate::session::Session;
use crate::session::file::SessionFile;

/// The lit surface alone, without a window.
#[derive(Args, Debug)]
pub struct RenderCommand {
    /// What the picture shows.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The PNG to write, - for standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "960x600")]
    pub size: PictureSize,
    /// Write what is shown, and of what material, below the picture.
    #[arg(long)]
    pub caption: bool,
}

/// What a picture shows: a session file, and flags over it.
#[derive(Args, Clone, Debug)]
pub struct SceneArguments {
    /// The normal map, or a bundled one by name; without it the session's, or the bundled sample.
    pub map: Option<PathBuf>,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// How it is fitted.
    #[command(flatten)]
    pub fit: FitArguments,
    /// A session file to start from.
    #[arg(long, value_name = "FILE")]
    pub session: Option<PathBuf>,
    /// One method over the whole picture: truth, mip, mip-unnormalised, toksvig, lean, gmm:N, sh:LMAX, vmf:J or
    /// vmf:J:unaligned.
    #[arg(long, value_name = "METHOD", conflicts_with_all = ["left", "right"])]
    pub method: Option<MethodChoice>,
    /// The method left of the wipe.
    #[arg(long, value_name = "METHOD")]
    pub left: Option<MethodChoice>,
    /// The method right of the wipe.
    #[arg(long, value_name = "METHOD")]
    pub right: Option<MethodChoice>,
    /// How methods stand beside each other: wipe, flip, difference, grid-2x2 or grid-3x3.
    #[arg(long, value_name = "VIEW", conflicts_with = "method")]
    pub view: Option<View>,
    /// The methods of a grid, row by row from the top, with commas between them: four are seen 2x2, up to nine 3x3,
    /// unless --view says otherwise.
    #[arg(long, value_name = "METHODS", value_delimiter = ',', conflicts_with_all = ["method", "left", "right", "wipe"])]
    pub methods: Vec<MethodChoice>,
    /// Where the wipe stands, from 0 (left edge) to 1.
    #[arg(long, value_name = "FRACTION")]
    pub wipe: Option<f32>,
    /// The surface and its material.
    #[command(flatten)]
    pub look: LookArguments,
    /// From the eye to the surface's centre.
    #[arg(long, value_name = "D")]
    pub distance: Option<f32>,
    /// Samples per pixel of the truth; the session's or, without one, 1024.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub samples: Option<u32>,
}

/// Samples per pixel of a truth that nobody chose and nobody watches: a quarter of the window's, for a picture has to
/// wait for all of them.
pub const PICTURE_SAMPLES: u32 = 1024;

/// Pixels across and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureSize(pub [u32; 2]);

/// Why a picture's size could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a size: write WIDTHxHEIGHT from 16x16 to 8192x8192, for example 1280x800")]
pub struct ParseSizeError(String);

impl FromStr for PictureSize {
    type Err = ParseSizeError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parse = |side: &str| side.parse().ok().filter(|side| (16..=8192).contains(side));
        text.split_once('x')
            .and_then(|(width, height)| Some(Self([parse(width)?, parse(height)?])))
            .ok_or_else(|| ParseSizeError(text.to_owned()))
    }
}

impl SceneArguments {
    /// A session of the map, with every setting in place and no fit started.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn session(&self) -> anyhow::Result<Session> {
        let count = self.methods.len();
        anyhow::ensure!(count <= MOST_METHODS, "--methods names {count} methods; a grid has room for {MOST_METHODS}.");
        let model = self.look.model()?;
        // A mesh that brings a normal texture brings the map, unless one is named.
        let brought = model.as_ref().filter(|model| model.has_normal_map).map(|model| model.path.clone());
        let start = Start {
            map: self.map.as_deref().or(brought.as_deref()),
            map_arguments: &self.map_arguments,
            fit: &self.fit,
            session: self.session.as_deref(),
        };
        start.session(|file| self.apply_to(file, model))
    }

    fn apply_to(&self, file: &mut SessionFile, model: Option<Arc<Model>>) -> anyhow::Result<()> {
        let comparison = &mut file.comparison;
        let mut chosen = [self.left, self.right, self.method].into_iter().flatten().chain(self.methods.iter().copied());
        file.fit.lobes = chosen.find_map(|choice| choice.lobes).unwrap_or(file.fit.lobes);
        comparison.left = self.left.map_or(comparison.left, |choice| choice.method);
        comparison.right = self.right.map_or(comparison.right, |choice| choice.method);
        comparison.wipe = self.wipe.unwrap_or(comparison.wipe).clamp(0.0, 1.0);
        comparison.view = self.view_over(comparison.view);
        for (cell, choice) in comparison.grid.iter_mut().zip(&self.methods) {
            *cell = choice.method;
        }
        if let Some(choice) = self.method {
            (comparison.right, comparison.wipe) = (choice.method, 0.0);
        }
        file.truth_samples = self.samples.or(file.truth_samples).or(Some(PICTURE_SAMPLES));
        let surface = &mut file.surface;
        self.look.apply_to(surface, model)?;
        let distance = self.distance.unwrap_or(surface.camera.distance);
        surface.camera.distance = distance.clamp(Camera::MIN_DISTANCE, Camera::MAX_DISTANCE);
        Ok(())
    }

    /// The view that was asked for; the session file's, unless methods are named that it does not show.
    fn view_over(&self, view: View) -> View {
        let of_two = self.left.is_some() || self.right.is_some();
        let of_grid = match self.methods.len() {
            0 => None,
            1..=4 => Some(View::Grid2x2),
            _ => Some(View::Grid3x3),
        };
        let of_wipe = self.method.is_some() || self.wipe.is_some() || of_two && view.grid_side().is_some();
        self.view.or(of_grid).unwrap_or(if of_wipe { View::Wipe } else { view })
    }
}

impl RenderCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let mut session = self.scene.session()?;
        let seen = session.comparison.methods_seen();
        for method in &seen {
            let is_drawn = method.rival().is_none_or(Rival::is_drawn);
            anyhow::ensure!(is_drawn, "{method} is too much for a picture; probe takes it.");
        }
        let gpu = Gpu::headless()?;
        if seen.iter().any(|method| method.shows_lobes()) {
            session.begin(*session.fit_settings());
            wait_for_fit(&mut session)?;
        }
        let mut picture = surface_picture(&gpu, &mut session, self.size.0)?;
        if self.caption {
            picture = captioned(&gpu, picture, &session)?;
        }
        let [width, height] = picture.size.map(|side| side as usize);
        Ok(write_png_rgba8(&self.output, width, height, &picture.rgba)?)
    }
}
