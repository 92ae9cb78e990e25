//! `sample`: the program's own maps as files.

use std::path::PathBuf;

use clap::Args;

use super::options::write_text;
use crate::image_io::{Samples, write_png_rgb8};
use crate::normal_map::procedural::{self, DEFAULT_SIZE, SAMPLES};

/// Write a bundled map, or list them.
#[derive(Args, Debug)]
pub struct SampleCommand {
    /// Which map.
    #[arg(required_unless_present = "list")]
    pub name: Option<String>,
    /// List the maps.
    #[arg(long)]
    pub list: bool,
    /// The PNG to write, - for standard output.
    #[arg(short, long, value_name = "FILE", required_unless_present = "list")]
    pub output: Option<PathBuf>,
    /// Texels along a side.
    #[arg(long, default_value_t = DEFAULT_SIZE as u32, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub size: u32,
}

impl SampleCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the target or the map, and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let (Some(name), Some(output), false) = (&self.name, &self.output, self.list) else {
            let lines: Vec<String> =
                SAMPLES.iter().map(|sample| format!("{:<10} {}", sample.name, sample.description)).collect();
            return write_text("-".as_ref(), &lines.join("\n"));
        };
        let Some(sample) = procedural::find(name) else {
            anyhow::bail!("There is no bundled map named '{name}'; `sample --list` names them.");
        };
        let image = sample.image(self.size as usize);
        let Samples::U8(bytes) = &image.samples else { anyhow::bail!("'{name}' is not made of 8-bit samples.") };
        Ok(write_png_rgb8(output, image.width, image.height, bytes)?)
    }
}
