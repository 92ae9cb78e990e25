//! `export`: results as files for other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use clap::{Args, ValueEnum};

use super::options::{FitArguments, MapArguments, wait_for_fit, write_text};
use crate::export::lobe_shader::{Language, lobe_shader};
use crate::export::roughness::{Convention, Depth, RoughnessSettings, Spread};
use crate::export::{lobes_exr, slopes};
use crate::filter::PlainMip;
use crate::session::{OpenedMap, Session};

/// What the files hold.
const LAYOUT: &str = "\
Roughness is one OpenEXR file of a part level.NN each where the output ends in .exr, otherwise a grey PNG of each level, \
NAME.level.NN.png. Slopes are one OpenEXR file: mean.R and .G the mean slope, mean.B the length of the mean normal, \
moment.R, .G and .B the means of its squares and of its product. Lobes are one OpenEXR file that opens again as a fit. \
The shader's header says how lobes are laid out.";

/// Write results for other programs.
#[derive(Args, Debug)]
#[command(after_help = LAYOUT)]
pub struct ExportCommand {
    /// The normal map, or a file of lobes.
    pub map: PathBuf,
    /// What is written.
    #[arg(value_enum)]
    pub kind: ExportKind,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// How it is fitted.
    #[command(flatten)]
    pub fit: FitArguments,
    /// How roughness is taken and written.
    #[command(flatten)]
    pub roughness: RoughnessArguments,
    /// The shader's language; without it, that of the file's ending.
    #[arg(long, value_enum)]
    pub language: Option<LanguageArgument>,
    /// The file to write, - for standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportKind {
    /// Roughness of every level, as PNG or OpenEXR.
    Roughness,
    /// The lobes of every level, as OpenEXR.
    Lobes,
    /// Anisotropic moments of slope of every level, as OpenEXR of six channels.
    Slopes,
    /// The shader that lights the lobes.
    Shader,
}

/// How roughness is taken and written.
#[derive(Args, Clone, Debug)]
pub struct RoughnessArguments {
    /// How roughness follows from the normals: one von Mises-Fisher lobe, or Toksvig's factor.
    #[arg(long, value_enum, default_value = "vmf")]
    pub spread: SpreadArgument,
    /// What roughness means.
    #[arg(long, value_enum, default_value = "alpha")]
    pub convention: ConventionArgument,
    /// Bits per sample of PNG files.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = parse_bits)]
    pub bits: u8,
}

/// How roughness follows from the normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SpreadArgument {
    /// The one lobe with their mean.
    Vmf,
    /// Toksvig's factor, of a mirror.
    Toksvig,
}

/// What roughness means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ConventionArgument {
    /// Alpha of Beckmann and GGX: sqrt(2/kappa).
    Alpha,
    /// Standard deviation of slopes: sqrt(1/kappa).
    Deviation,
    /// Torrance and Sparrow's sigma: sqrt(1/(2 kappa)).
    Sigma,
    /// The square root of alpha, which renderers square.
    Perceptual,
}

/// A shading language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LanguageArgument {
    /// WebGPU's.
    Wgsl,
    /// OpenGL's.
    Glsl,
    /// Direct3D's.
    Hlsl,
}

fn parse_bits(text: &str) -> Result<u8, String> {
    match text {
        "8" => Ok(8),
        "16" => Ok(16),
        _ => Err("write 8 or 16".to_owned()),
    }
}

impl ExportCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let opened = self.map_arguments.read(&self.map)?;
        match self.kind {
            ExportKind::Roughness => self.roughness(opened),
            ExportKind::Slopes => Ok(slopes::write(&self.output, &PlainMip::new(opened.map))?),
            ExportKind::Lobes => self.lobes(opened),
            ExportKind::Shader => self.shader(opened),
        }
    }

    fn roughness(&self, opened: OpenedMap) -> anyhow::Result<()> {
        anyhow::ensure!(self.output != Path::new("-"), "Roughness is written to files, for it may take several.");
        self.roughness.settings().write(&self.output, &PlainMip::new(opened.map))?;
        Ok(())
    }

    fn lobes(&self, opened: OpenedMap) -> anyhow::Result<()> {
        let mut session = Session::with_opened(opened, Arc::new(|| {}));
        session.set_threads(self.fit.threads());
        session.skip_previews();
        session.begin(self.fit.over(*session.fit_settings()));
        wait_for_fit(&mut session)?;
        write_lobes(&self.output, &session)
    }

    /// As many slots as the fit has, that of the file or the one that was asked for.
    fn shader(&self, opened: OpenedMap) -> anyhow::Result<()> {
        let settings = opened.fit.map(|fit| fit.settings).unwrap_or_default();
        let text = lobe_shader(self.fit.over(settings).lobes, self.language()?)?;
        write_text(&self.output, text.trim_end())
    }

    fn language(&self) -> anyhow::Result<Language> {
        let by_ending = || {
            let ending = self.output.extension()?.to_str()?.to_ascii_lowercase();
            Language::ALL.into_iter().find(|language| language.ending() == ending)
        };
        let asked = self.language.map(LanguageArgument::language);
        asked.or_else(by_ending).context("The file's ending tells no shading language; add --language.")
    }
}

impl RoughnessArguments {
    fn settings(&self) -> RoughnessSettings {
        RoughnessSettings {
            spread: match self.spread {
                SpreadArgument::Vmf => Spread::Vmf,
                SpreadArgument::Toksvig => Spread::Toksvig,
            },
            convention: match self.convention {
                ConventionArgument::Alpha => Convention::Alpha,
                ConventionArgument::Deviation => Convention::Deviation,
                ConventionArgument::Sigma => Convention::Sigma,
                ConventionArgument::Perceptual => Convention::Perceptual,
            },
            depth: if self.bits == 16 { Depth::Bits16 } else { Depth::Bits8 },
        }
    }
}

impl LanguageArgument {
    fn language(self) -> Language {
        match self {
            Self::Wgsl => Language::Wgsl,
            Self::Glsl => Language::Glsl,
            Self::Hlsl => Language::Hlsl,
        }
    }
}

/// Writes a session's finished fit as OpenEXR.
///
/// # Errors
/// One sentence that names the target and the cause.
pub fn write_lobes(path: &Path, session: &Session) -> anyhow::Result<()> {
    let fit = session.fitting().finished().context("The fit is not finished.")?;
    Ok(lobes_exr::write(path, &fit)?)
}
