//! `probe`: effective BRDF values of a method at chosen texels and directions.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use serde::Serialize;

use super::brdf::BrdfArgument;
use super::fit::check_texel;
use super::options::{FitArguments, MapArguments, read_text, wait_for_fit, write_text};
use super::rules::{Convolution, Diffuse};
use crate::filter::rival::Source;
use crate::filter::vmf::{Alignment, Fold, Monitor, Rules};
use crate::filter::{Method, MethodChoice};
use crate::normal_map::pyramid::Texel;
use crate::session::Session;
use crate::sphere::Direction;

/// Effective BRDF values of a method at chosen texels and directions.
#[derive(Args, Debug)]
pub struct ProbeCommand {
    /// The normal map.
    pub map: PathBuf,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// How it is fitted, for vmf.
    #[command(flatten)]
    pub fit: FitArguments,
    /// The method: truth, mip, mip-unnormalised, toksvig, lean, gmm:N, sh:LMAX, vmf:J or vmf:J:unaligned.
    #[arg(long, value_name = "METHOD")]
    pub method: MethodChoice,
    /// The BRDF: lambert, blinn-phong:S, torrance-sparrow:SIGMA, ggx:ALPHA, or merl:FILE, by its luminance.
    #[arg(long, value_name = "BRDF", default_value = "blinn-phong:64")]
    pub brdf: BrdfArgument,
    /// How a lobe and the BRDF are convolved, for vmf; paper takes the paper's multipliers for sh.
    #[arg(long, value_enum, default_value_t)]
    pub convolution: Convolution,
    /// How a lobe reflects diffusely, for vmf.
    #[arg(long, value_enum, default_value_t)]
    pub diffuse: Diffuse,
    /// A texel; any number of them.
    #[arg(long = "texel", value_name = "LEVEL,X,Y", required = true)]
    pub texels: Vec<Texel>,
    /// A direction in tangent space; any number of them.
    #[arg(long = "omega", value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub omegas: Vec<Direction>,
    /// A file with one direction a line, - for standard input.
    #[arg(long = "omegas", value_name = "FILE")]
    pub omega_file: Option<PathBuf>,
    /// Write the result as JSON to FILE, - for standard output.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// The result, schema 1; others script against it.
#[derive(Debug, Serialize)]
struct Report {
    schema: u32,
    method: String,
    brdf: String,
    texels: Vec<TexelReport>,
}

#[derive(Debug, Serialize)]
struct TexelReport {
    level: usize,
    x: usize,
    y: usize,
    values: Vec<f64>,
}

impl ProbeCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let omegas = self.directions()?;
        let brdf = self.brdf.read()?;
        let opened = self.map_arguments.read(&self.map)?;
        let sizes = opened.map.level_sizes();
        self.texels.iter().try_for_each(|texel| check_texel(*texel, &sizes))?;
        let mut session = Session::with_opened(opened, Arc::new(|| {}));
        let mut settings = self.fit.over(*session.fit_settings());
        settings.lobes = self.method.lobes.unwrap_or(settings.lobes);
        if self.method.method == Method::VmfUnaligned {
            // Each texel's own best fit serves unaligned shading best.
            settings.align = self.fit.align.unwrap_or(Alignment::None);
        }
        if self.method.method.shows_lobes() {
            session.set_threads(self.fit.threads());
            session.skip_previews();
            session.begin(settings);
            wait_for_fit(&mut session)?;
        }
        let source = Source { mip: session.mip(), rules: self.rules(), monitor: &Monitor::new(Vec::new()) };
        let filter = self.method.method.filter(&source, session.lobes(), Fold::default())?;
        let texel_report = |&texel: &Texel| TexelReport {
            level: texel.level,
            x: texel.x,
            y: texel.y,
            values: omegas.iter().map(|omega| filter.effective_brdf(texel, brdf, omega.vector())).collect(),
        };
        let lobes = self.method.method.shows_lobes().then_some(settings.lobes);
        let method = MethodChoice { lobes, ..self.method }.to_string();
        let texels = self.texels.iter().map(texel_report).collect();
        let report = Report { schema: 1, method, brdf: brdf.to_string(), texels };
        match &self.json {
            Some(path) => write_text(path, &serde_json::to_string_pretty(&report)?),
            None => write_text("-".as_ref(), report.to_text().trim_end()),
        }
    }

    fn rules(&self) -> Rules {
        Rules { convolution: self.convolution.rule(), diffuse: self.diffuse.rule() }
    }

    fn directions(&self) -> anyhow::Result<Vec<Direction>> {
        let mut omegas = self.omegas.clone();
        if let Some(path) = &self.omega_file {
            for (number, line) in read_text(path)?.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
                let direction = line
                    .parse()
                    .map_err(|error| anyhow::anyhow!("'{}', line {}: {error}", path.display(), number + 1))?;
                omegas.push(direction);
            }
        }
        anyhow::ensure!(!omegas.is_empty(), "No direction was given: add --omega X,Y,Z or --omegas FILE.");
        Ok(omegas)
    }
}

impl Report {
    fn to_text(&self) -> String {
        let mut text = format!("{} of {}\n", self.method, self.brdf);
        for texel in &self.texels {
            let values: Vec<String> = texel.values.iter().map(|value| format!("{value:.6}")).collect();
            text += &format!("{},{},{}: {}\n", texel.level, texel.x, texel.y, values.join(" "));
        }
        text
    }
}
