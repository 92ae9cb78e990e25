//! Options that several commands share.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};

use super::rules::Slopes;
use crate::filter::vmf::{Alignment, EStep, FitSettings, LobeCount, Objective};
use crate::image_io::write_bytes_atomically;
use crate::normal_map::{Addressing, GreenChannel, MapOptions, StoredZ};
use crate::session::{MapRequest, OpenedMap, Session, opening};
use crate::sphere::vmf::KappaRule;

/// How a map is read.
#[derive(Args, Clone, Debug, Default)]
pub struct MapArguments {
    /// The green channel's convention.
    #[arg(long = "y", value_enum, value_name = "CONVENTION")]
    pub green: Option<Green>,
    /// The channel that holds x: red, or alpha as in the DXT5nm layout, where z is taken from x and y.
    #[arg(long = "x", value_enum, value_name = "CHANNEL")]
    pub x: Option<XChannel>,
    /// Read the image as heights, scaled by SCALE.
    #[arg(long = "height", value_name = "SCALE")]
    pub height_scale: Option<f32>,
    /// How slopes are taken from heights.
    #[arg(long, value_enum)]
    pub slopes: Option<Slopes>,
    /// Take z from x and y: the same as --z none.
    #[arg(long, conflicts_with = "z")]
    pub two_channel: bool,
    /// What the third channel holds.
    #[arg(long, value_enum, value_name = "RANGE")]
    pub z: Option<ZRange>,
    /// How the samples are encoded, whatever the file says of itself.
    #[arg(long, value_enum)]
    pub encoding: Option<Encoding>,
    /// Whose the normals are.
    #[arg(long, value_enum)]
    pub space: Option<Space>,
    /// The map tiles (the default).
    #[arg(long, conflicts_with = "clamp")]
    pub wrap: bool,
    /// The edge texel goes on beyond the edge.
    #[arg(long)]
    pub clamp: bool,
    /// An image of the surface's colour, fitted along: sRGB, or linear where it is of floats.
    #[arg(long, value_name = "FILE")]
    pub color: Option<PathBuf>,
}

/// The green channel's convention.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Green {
    /// +Y up, as OpenGL has it.
    Up,
    /// +Y down, as DirectX has it.
    Down,
    /// Whichever makes the slopes a surface.
    Auto,
}

/// The channel that holds x.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum XChannel {
    /// The first.
    Red,
    /// The last; y is in green.
    Alpha,
}

/// What the third channel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ZRange {
    /// z from -1 to 1, as x and y.
    Signed,
    /// z from 0 to 1.
    #[value(name = "01")]
    Unsigned,
    /// Something else, or nothing: z is taken from x and y.
    None,
}

/// How samples are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Encoding {
    /// As they are.
    Linear,
    /// By the sRGB curve.
    Srgb,
}

/// Whose normals are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// The surface's: +z points out of it.
    Tangent,
    /// The object's: all directions are right.
    Object,
}

impl MapArguments {
    /// The options, over what `base` says.
    pub fn over(&self, base: MapOptions) -> MapOptions {
        MapOptions {
            green: match self.green {
                Some(Green::Up) => GreenChannel::Up,
                Some(Green::Down) => GreenChannel::Down,
                Some(Green::Auto) => GreenChannel::Auto,
                None => base.green,
            },
            addressing: match (self.wrap, self.clamp) {
                (true, _) => Addressing::Wrap,
                (_, true) => Addressing::Clamp,
                _ => base.addressing,
            },
            two_channel: match self.z {
                Some(z) => z == ZRange::None,
                None => self.two_channel || base.two_channel,
            },
            x_in_alpha: self.x.map_or(base.x_in_alpha, |x| x == XChannel::Alpha),
            z: match self.z {
                Some(ZRange::Signed) => StoredZ::Signed,
                Some(ZRange::Unsigned) => StoredZ::Unsigned,
                Some(ZRange::None) | None => base.z,
            },
            srgb: self.encoding.map_or(base.srgb, |encoding| encoding == Encoding::Srgb),
            object_space: self.space.map_or(base.object_space, |space| space == Space::Object),
            height_scale: self.height_scale.or(base.height_scale),
            slopes: self.slopes.map_or(base.slopes, Slopes::kernel),
            slope_scale: base.slope_scale,
            color: self.color.clone().or(base.color),
        }
    }

    /// The request that opens `path`: a file, or a bundled map where no such file exists and one has that name.
    pub fn request(&self, path: &Path, base: MapOptions) -> MapRequest {
        let options = self.over(base);
        match path.to_str().and_then(crate::normal_map::procedural::find) {
            Some(sample) if !path.exists() => MapRequest::Bundled { name: sample.name.to_owned(), options },
            _ => MapRequest::File { path: path.to_owned(), options },
        }
    }

    /// Reads `path` now, a map or a fit.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn read(&self, path: &Path) -> anyhow::Result<OpenedMap> {
        opening::read(&self.request(path, MapOptions::default())).map_err(|message| anyhow::anyhow!(message.text))
    }
}

/// How a map is fitted.
#[derive(Args, Clone, Debug, Default)]
pub struct FitArguments {
    /// Lobes per texel: 1 to 16; auto or auto:PERCENT, as few as keep the BRDF's error under 2 or PERCENT percent; bic
    /// or bic:MAX, as the Bayesian information criterion has it, at most 8 or MAX.
    #[arg(short = 'J', long = "lobes", value_name = "N")]
    pub lobes: Option<LobeCount>,
    /// What each texel's fit strives for: appearance, appearance:STEPS, likelihood or em.
    #[arg(long)]
    pub objective: Option<Objective>,
    /// How lobes are aligned: smooth, smooth:B, paper:C, map:C or none.
    #[arg(long)]
    pub align: Option<Alignment>,
    /// Most EM iterations per texel.
    #[arg(long, value_name = "N")]
    pub iterations: Option<usize>,
    /// Least gain in mean log-likelihood per normal that goes on.
    #[arg(long, value_name = "T")]
    pub tolerance: Option<f64>,
    /// Which inverse of A gives kappa.
    #[arg(long, value_enum)]
    pub kappa: Option<Kappa>,
    /// How em and the scanline alignments share normals between lobes.
    #[arg(long, value_enum)]
    pub e_step: Option<EStepArgument>,
    /// Threads to fit on; every core by default.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// Which inverse of A gives kappa.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kappa {
    /// Newton's method.
    Exact,
    /// Banerjee's closed form, as the papers have it.
    Banerjee,
}

/// How normals are shared between lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EStepArgument {
    /// By weight and density.
    WithAlpha,
    /// By density alone, as Algorithm 1 is printed.
    AsPrinted,
}

impl FitArguments {
    /// The settings, over what `base` says.
    pub fn over(&self, base: FitSettings) -> FitSettings {
        FitSettings {
            lobes: self.lobes.map_or(base.lobes, |count| count.most),
            selection: self.lobes.map_or(base.selection, |count| count.selection),
            objective: self.objective.unwrap_or(base.objective),
            align: self.align.unwrap_or(base.align),
            iterations: self.iterations.unwrap_or(base.iterations),
            tolerance: self.tolerance.unwrap_or(base.tolerance),
            kappa: match self.kappa {
                Some(Kappa::Exact) => KappaRule::Exact,
                Some(Kappa::Banerjee) => KappaRule::Banerjee,
                None => base.kappa,
            },
            e_step: match self.e_step {
                Some(EStepArgument::WithAlpha) => EStep::WithAlpha,
                Some(EStepArgument::AsPrinted) => EStep::AsPrinted,
                None => base.e_step,
            },
        }
    }

    /// The threads asked for.
    pub fn threads(&self) -> Option<usize> {
        self.threads.map(usize::from)
    }
}

/// Waits until the session's fit is complete, with a progress bar on a terminal and nothing in a pipe.
///
/// # Errors
/// The sentence of a fit that failed.
pub fn wait_for_fit(session: &mut Session) -> anyhow::Result<()> {
    let bar = if std::io::stderr().is_terminal() { ProgressBar::new(1000) } else { ProgressBar::hidden() };
    if let Ok(style) = ProgressStyle::with_template("fitting {bar:32} {percent:>3} % {msg}") {
        bar.set_style(style);
    }
    let waited = session.wait_for_fit(&mut |session| {
        if let Some(progress) = session.fitting().progress() {
            bar.set_position((progress.fraction * 1000.0) as u64);
            let busy = progress.levels.iter().rposition(|&done| done > 0.0 && done < 1.0);
            bar.set_message(busy.map_or_else(String::new, |level| format!("level {level}")));
        }
    });
    bar.finish_and_clear();
    waited.map_err(|message| anyhow::anyhow!(message.text))
}

/// Writes text to a file, whole or not at all, or to standard output where the path is `-`.
///
/// # Errors
/// One sentence that names the target and the cause.
pub fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    if path == Path::new("-") {
        let mut out = std::io::stdout().lock();
        return writeln!(out, "{text}").context("standard output cannot be written");
    }
    Ok(write_bytes_atomically(path, format!("{text}\n").as_bytes())?)
}

/// Reads a text file, or standard input where the path is `-`.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn read_text(path: &PathBuf) -> anyhow::Result<String> {
    if path == Path::new("-") {
        return std::io::read_to_string(std::io::stdin()).context("standard input cannot be read");
    }
    std::fs::read_to_string(path).with_context(|| format!("'{}' cannot be read", path.display()))
}

/// Reads the strength of a Fresnel factor.
///
/// # Errors
/// What may be written.
pub fn parse_fresnel(text: &str) -> Result<f32, String> {
    let strength = text.parse().ok().filter(|strength| (0.0..=1.0).contains(strength));
    strength.ok_or_else(|| "write a strength from 0 to 1".to_owned())
}
