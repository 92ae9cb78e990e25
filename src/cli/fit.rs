//! `fit`: lobes of every texel of every level; chosen texels and levels as text or JSON.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use glam::Vec3;
use serde::Serialize;

use super::export::write_lobes;
use super::options::{FitArguments, MapArguments, wait_for_fit, write_text};
use crate::filter::vmf::trace::{Trace, trace};
use crate::filter::vmf::{Coherence, EStep, smooth};
use crate::normal_map::pyramid::{Footprint, Texel};
use crate::session::Session;
use crate::sphere::direction::polar_deg;
use crate::sphere::{Lobe, Mixture};

/// Fit lobes to every texel of every level, and write what was asked for.
#[derive(Args, Debug)]
pub struct FitCommand {
    /// The normal map.
    pub map: PathBuf,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// How it is fitted.
    #[command(flatten)]
    pub fit: FitArguments,
    /// A texel whose lobes are printed; any number of them.
    #[arg(long = "texel", value_name = "LEVEL,X,Y")]
    pub texels: Vec<Texel>,
    /// Say of every such texel how its fit went: the log-likelihood of each iteration, lobes retired and capped.
    #[arg(long, requires = "texels")]
    pub trace: bool,
    /// Write the result as JSON to FILE, - for standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the lobes of every level as OpenEXR to FILE, - for standard output.
    #[arg(long, value_name = "FILE")]
    pub exr: Option<PathBuf>,
}

/// The result, schema 1; others script against it.
#[derive(Debug, Serialize)]
struct Report {
    schema: u32,
    version: &'static str,
    map: MapReport,
    settings: SettingsReport,
    seconds: f64,
    levels: Vec<LevelReport>,
    texels: Vec<TexelReport>,
}

#[derive(Debug, Serialize)]
struct MapReport {
    path: String,
    width: usize,
    height: usize,
    levels: usize,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct SettingsReport {
    lobes: usize,
    selection: String,
    objective: String,
    align: String,
    iterations: usize,
    tolerance: f64,
    kappa: crate::sphere::vmf::KappaRule,
    e_step: EStep,
    threads: usize,
}

#[derive(Debug, Serialize)]
struct LevelReport {
    level: usize,
    width: usize,
    height: usize,
    mean_log_likelihood: f64,
    mean_iterations: f64,
    seconds: f64,
    log_likelihood_lost: f64,
    mean_lobes: f64,
    /// Texels that use no lobe, one, two and so on.
    lobe_counts: Vec<usize>,
    #[serde(flatten)]
    coherence: Option<Coherence>,
}

#[derive(Debug, Serialize)]
struct TexelReport {
    level: usize,
    x: usize,
    y: usize,
    samples: usize,
    mean_log_likelihood: f64,
    lobes: Vec<LobeReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    trace: Option<Trace>,
}

#[derive(Debug, Serialize)]
struct LobeReport {
    #[serde(flatten)]
    lobe: Lobe,
    /// Linear RGB; left out for a map without colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    color: Option<Vec3>,
}

impl FitCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let opened = self.map_arguments.read(&self.map)?;
        let sizes = opened.map.level_sizes();
        self.texels.iter().try_for_each(|texel| check_texel(*texel, &sizes))?;
        let mut session = Session::with_opened(opened, Arc::new(|| {}));
        let settings = self.fit.over(*session.fit_settings());
        let start = Instant::now();
        session.set_threads(self.fit.threads());
        session.skip_previews();
        session.begin(settings);
        wait_for_fit(&mut session)?;
        let seconds = start.elapsed().as_secs_f64();
        session.measure_coherence();
        let report = self.report(&session, seconds);
        if let Some(path) = &self.exr {
            write_lobes(path, &session)?;
        }
        match &self.json {
            Some(path) => write_text(path, &serde_json::to_string_pretty(&report)?),
            None if self.exr.as_deref() == Some(Path::new("-")) => Ok(()),
            None => write_text("-".as_ref(), report.to_text().trim_end()),
        }
    }

    fn report(&self, session: &Session, seconds: f64) -> Report {
        let map = session.map();
        let settings = session.fit_settings();
        let sizes = map.level_sizes();
        let level_report = |(level, fit): (usize, &crate::session::fitting::LevelFit)| {
            let stats = fit.stats?;
            Some(LevelReport {
                level,
                width: sizes[level].0,
                height: sizes[level].1,
                mean_log_likelihood: stats.mean_log_likelihood,
                mean_iterations: stats.mean_iterations,
                seconds: stats.seconds,
                log_likelihood_lost: stats.log_likelihood_lost,
                mean_lobes: stats.mean_lobes,
                lobe_counts: session.lobes().level(level).map(|level| level.lobe_counts().to_vec()).unwrap_or_default(),
                coherence: stats.coherence,
            })
        };
        Report {
            schema: 1,
            version: env!("CARGO_PKG_VERSION"),
            map: MapReport {
                path: self.map.display().to_string(),
                width: map.width,
                height: map.height,
                levels: sizes.len(),
                warnings: map.warnings.iter().map(ToString::to_string).collect(),
            },
            settings: SettingsReport {
                lobes: settings.lobes,
                selection: settings.selection.to_string(),
                objective: settings.objective.to_string(),
                align: settings.align.to_string(),
                iterations: settings.iterations,
                tolerance: settings.tolerance,
                kappa: settings.kappa,
                e_step: settings.e_step,
                threads: session.fitting().threads(),
            },
            seconds,
            levels: session.fitting().levels().iter().enumerate().filter_map(level_report).collect(),
            texels: self.texels.iter().map(|&texel| texel_report(session, texel, self.trace)).collect(),
        }
    }
}

/// Refuses a texel that the map does not have.
///
/// # Errors
/// One sentence that says what there is.
pub fn check_texel(texel: Texel, sizes: &[(usize, usize)]) -> anyhow::Result<()> {
    let size = sizes.get(texel.level).copied();
    let Some((width, height)) = size else {
        anyhow::bail!("There is no texel {texel}: the map's levels run from 0 to {}.", sizes.len() - 1);
    };
    anyhow::ensure!(
        texel.x < width && texel.y < height,
        "There is no texel {texel}: level {} has {width} x {height} texels.",
        texel.level
    );
    Ok(())
}

fn texel_report(session: &Session, texel: Texel, traced: bool) -> TexelReport {
    let lobes = session.lobes();
    let map = session.map();
    let mixture = lobes.mixture(texel).unwrap_or_default();
    let mean_log_likelihood = match lobes.level(texel.level) {
        Some(level) => smooth::mean_log_likelihood(map, level, (texel.x, texel.y), session.fit_settings()),
        None => base_log_likelihood(&mixture),
    };
    let footprint = Footprint::new((map.width, map.height), map.level_sizes()[texel.level], (texel.x, texel.y));
    TexelReport {
        level: texel.level,
        x: texel.x,
        y: texel.y,
        samples: footprint.len(),
        mean_log_likelihood,
        lobes: mixture
            .lobes
            .into_iter()
            .map(|(slot, lobe)| LobeReport { lobe, color: lobes.lobe_color(texel, slot) })
            .collect(),
        trace: traced.then(|| trace(lobes, texel, session.fit_settings())).flatten(),
    }
}

/// A base texel is one normal at the peak of its own lobe, as sharp as a fit may be.
fn base_log_likelihood(mixture: &Mixture) -> f64 {
    if mixture.lobes.is_empty() { 0.0 } else { crate::sphere::vmf::log_peak(crate::sphere::vmf::KAPPA_MAX) }
}

impl Report {
    fn to_text(&self) -> String {
        let mut text = format!(
            "{} {} x {}, {} lobes, align {}, {:.2} s\n",
            self.map.path, self.map.width, self.map.height, self.settings.lobes, self.settings.align, self.seconds
        );
        for warning in &self.map.warnings {
            text += &format!("warning: {warning}\n");
        }
        text += "\nlevel         size  log-likelihood     lost  lobes  iterations  seconds  coherence  interpolated  trilinear\n";
        for level in &self.levels {
            let size = format!("{} x {}", level.width, level.height);
            let coherence = level.coherence.unwrap_or_default();
            text += &format!(
                "{:>5} {:>12}  {:>14.4}  {:>7.4}  {:>5.2}  {:>10.1}  {:>7.3}  {:>8.2}°  {:>12.4}  {:>9}\n",
                level.level,
                size,
                level.mean_log_likelihood,
                level.log_likelihood_lost,
                level.mean_lobes,
                level.mean_iterations,
                level.seconds,
                coherence.coherence_deg,
                coherence.interpolation_error,
                coherence.trilinear_error.map_or_else(String::new, |error| format!("{error:.4}")),
            );
        }
        self.texels.iter().for_each(|texel| text += &texel.to_text());
        text
    }
}

impl TexelReport {
    fn to_text(&self) -> String {
        let mut text = format!(
            "\ntexel {},{},{}: {} normals, mean log-likelihood {:.6}\n    theta      phi      kappa   alpha        mu x      mu y      mu z\n",
            self.level, self.x, self.y, self.samples, self.mean_log_likelihood
        );
        for LobeReport { lobe, color } in &self.lobes {
            let (theta, phi) = polar_deg(lobe.mean_direction.as_vec3());
            let mu = lobe.mean_direction;
            text += &format!(
                "{theta:>9.3} {phi:>8.3} {:>10.3} {:>7.4}   {:>9.6} {:>9.6} {:>9.6}",
                lobe.concentration, lobe.weight, mu.x, mu.y, mu.z
            );
            text += &color.map_or_else(String::new, |y| format!("   colour {:.4} {:.4} {:.4}", y.x, y.y, y.z));
            text += "\n";
        }
        if let Some(trace) = &self.trace {
            let (iterations, retired, capped) = (trace.iterations, trace.retired, trace.capped);
            text += &format!("{iterations} iterations, {retired} slots empty, {capped} lobes as sharp as may be\n");
            for run in &trace.runs {
                let values: Vec<String> = run.log_likelihood.iter().map(|value| format!("{value:.5}")).collect();
                text += &format!("  {}: {}\n", run.name, values.join(" "));
            }
        }
        text
    }
}
