//! `screenshot`: the whole window as a PNG, without a display.

use std::path::PathBuf;

use clap::Args;

use super::options::read_text;
use super::render::{PictureSize, SceneArguments};
use crate::app::dock::{Panel, Preset};
use crate::app::theme::Theme;
use crate::gpu::Gpu;
use crate::headless::script::Script;
use crate::headless::{Headless, Screenshot, ScreenshotSettings};
use crate::image_io::write_png_rgba8;
use crate::normal_map::pyramid::Texel;

/// The whole window as a PNG, without a display.
#[derive(Args, Debug)]
pub struct ScreenshotCommand {
    /// What the window shows.
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The PNG to write, - for standard output.
    #[arg(short, long, value_name = "FILE", required_unless_present = "script")]
    pub output: Option<PathBuf>,
    /// Steps to play first, one a line, - for standard input: click NAME, set NAME VALUE, drag NAME DX DY, key KEYS,
    /// do ACTION, open FILE, wait, picture FILE and more.
    #[arg(long, value_name = "FILE")]
    pub script: Option<PathBuf>,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "1280x800")]
    pub size: PictureSize,
    /// Pixels per point: 2 draws everything twice as large.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub scale: f32,
    /// What the window is used for, and so which panels it shows: inspect, compare, tune or map-only.
    #[arg(long, value_name = "PRESET")]
    pub preset: Option<Preset>,
    /// One panel alone, by the name on its tab: controls, surface, map, figures, texel or levels.
    #[arg(long, value_name = "PANEL")]
    pub panel: Option<Panel>,
    /// How the window looks: dark, light or high-contrast.
    #[arg(long, value_name = "THEME", default_value = "dark")]
    pub theme: Theme,
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
        let script = self.script.as_ref().map(read_script).transpose()?;
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
        window.inspector.change_settings(|settings| settings.theme = self.theme);
        if let Some(preset) = self.preset {
            window.show(preset);
        }
        if let Some(script) = script {
            window.play(&script)?;
        }
        if let Some(output) = &self.output {
            let Screenshot { size: [width, height], rgba } = window.screenshot_of(self.panel)?;
            write_png_rgba8(output, width as usize, height as usize, &rgba)?;
        }
        Ok(())
    }
}

fn read_script(path: &PathBuf) -> anyhow::Result<Script> {
    Ok(Script::parse(&path.display().to_string(), &read_text(path)?)?)
}
