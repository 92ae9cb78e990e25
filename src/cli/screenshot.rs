//! `screenshot`: the whole window as a PNG, without a display.

use std::path::PathBuf;

use clap::Args;

use super::render::{PictureSize, SceneArguments};
use crate::gpu::Gpu;
use crate::headless::{Headless, ScreenshotSettings};
use crate::image_io::write_png_rgba8;
use crate::normal_map::pyramid::Texel;

/// The whole window as a PNG, without a display.
#[derive(Args, Debug)]
pub struct ScreenshotCommand {
    /// What the window shows.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The PNG to write, - for standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    pub size: PictureSize,
    /// Pixels per point: 2 draws everything twice as large.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub scale: f32,
    /// The selected texel.
    #[arg(long, value_name = "LEVEL,X,Y")]
    pub texel: Option<Texel>,
    /// Show a fit that is under way instead of waiting for it.
    #[arg(long)]
    pub no_wait: bool,
}

impl ScreenshotCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        anyhow::ensure!((0.5..=4.0).contains(&self.scale), "The scale is {}, not from 0.5 to 4.", self.scale);
        let gpu = Gpu::headless()?;
        let mut session = self.scene.session()?;
        if let Some(texel) = self.texel {
            session.select(texel);
        }
        let PictureSize(size) = self.size;
        let settings = ScreenshotSettings { size, px_per_point: self.scale, wait: !self.no_wait };
        let mut window = Headless::new(&gpu, settings, |wake| {
            session.set_wake(wake);
            session.begin(*session.fit_settings());
            session
        });
        let picture = window.screenshot()?;
        Ok(write_png_rgba8(&self.output, size[0] as usize, size[1] as usize, &picture.rgba)?)
    }
}
