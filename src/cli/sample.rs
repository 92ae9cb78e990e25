//! `sample`: the program's own maps and materials as files.

use std::path::{Path, PathBuf};

use clap::Args;

use super::options::{parse_fresnel, write_text};
use crate::brdf::{Brdf, Merl};
use crate::image_io::{Samples, write_bytes_atomically, write_png_rgb8};
use crate::normal_map::procedural::{self, DEFAULT_SIZE, SAMPLES};

/// Write a bundled map or a material, or list the maps.
#[derive(Args, Debug)]
pub struct SampleCommand {
    /// Which map.
    #[arg(required_unless_present_any = ["list", "brdf"])]
    pub name: Option<String>,
    /// List the maps.
    #[arg(long)]
    pub list: bool,
    /// The PNG or the measured reflectance to write; a PNG may go to standard output, -.
    #[arg(short, long, value_name = "FILE", required_unless_present = "list")]
    pub output: Option<PathBuf>,
    /// Texels along a side.
    #[arg(long, default_value_t = DEFAULT_SIZE as u32, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub size: u32,
    /// Write a quarter of this BRDF as a measured reflectance in MERL's format, in place of a map; lambert in full.
    #[arg(long, value_name = "BRDF", conflicts_with_all = ["name", "list"])]
    pub brdf: Option<Brdf>,
    /// Strength of its Fresnel factor, from 0 to 1.
    #[arg(long, value_name = "STRENGTH", requires = "brdf", default_value = "0", value_parser = parse_fresnel)]
    pub fresnel: f32,
}

impl SampleCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the target or the map, and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        match (&self.name, &self.output, self.brdf) {
            (_, Some(output), Some(brdf)) => {
                Ok(write_bytes_atomically(output, &Merl::of_brdf(brdf, self.fresnel).to_bytes())?)
            }
            (Some(name), Some(output), None) if !self.list => self.write_map(name, output),
            _ => list(),
        }
    }

    fn write_map(&self, name: &str, output: &Path) -> anyhow::Result<()> {
        let Some(sample) = procedural::find(name) else {
            anyhow::bail!("There is no bundled map named '{name}'; `sample --list` names them.");
        };
        let image = sample.image(self.size as usize);
        let Samples::U8(bytes) = &image.samples else { anyhow::bail!("'{name}' is not made of 8-bit samples.") };
        Ok(write_png_rgb8(output, image.width, image.height, bytes)?)
    }
}

fn list() -> anyhow::Result<()> {
    let lines: Vec<String> =
        SAMPLES.iter().map(|sample| format!("{:<10} {}", sample.name, sample.description)).collect();
    write_text("-".as_ref(), &lines.join("\n"))
}
