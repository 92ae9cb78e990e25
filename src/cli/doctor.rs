//! `doctor`: what a file says of how it should be read, and whether it is read so.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use serde::Serialize;

use super::options::{MapArguments, write_text};
use crate::image_io::{self, RasterImage};
use crate::normal_map::MapOptions;
use crate::normal_map::diagnose::{Advice, Confidence, Diagnosis, Finding, LengthHistogram, Subject};
use crate::normal_map::procedural::{self, DEFAULT_SIZE};

/// How the answer reads.
const EXPLANATION: &str = "\
Each line is an answer: its subject, how sure it is, and why. Exit status 0 where nothing is doubtful, 3 where something \
is: the map is read against an answer, or the answer is a defect. Doubtful lines begin with an exclamation mark and name \
the option that would settle them.";

/// What a file says of how it should be read, and whether it is read so.
#[derive(Args, Debug)]
#[command(after_help = EXPLANATION)]
pub struct DoctorCommand {
    /// The normal map, or a bundled one by name.
    pub map: PathBuf,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// The exit status where something is doubtful.
const DOUBTFUL: u8 = 3;

#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    version: &'a str,
    map: MapReport<'a>,
    doubtful: bool,
    findings: Vec<FindingReport<'a>>,
    lengths: LengthReport<'a>,
}

#[derive(Serialize)]
struct MapReport<'a> {
    path: String,
    width: usize,
    height: usize,
    channels: usize,
    format: &'a str,
    depth: &'a str,
}

#[derive(Serialize)]
struct FindingReport<'a> {
    subject: Subject,
    answer: &'a str,
    confidence: Confidence,
    doubtful: bool,
    reason: &'a str,
    option: Option<String>,
}

#[derive(Serialize)]
struct LengthReport<'a> {
    bin_width: f64,
    counts: &'a [usize],
}

impl DoctorCommand {
    /// Carries the command out; the exit status says whether anything is doubtful.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let image = self.image()?;
        let diagnosis = Diagnosis::new(&image, &self.map_arguments.over(MapOptions::default()));
        let text = if self.json { self.json(&image, &diagnosis)? } else { self.table(&image, &diagnosis) };
        write_text(Path::new("-"), &text)?;
        Ok(if diagnosis.is_doubtful() { ExitCode::from(DOUBTFUL) } else { ExitCode::SUCCESS })
    }

    fn image(&self) -> anyhow::Result<RasterImage> {
        match self.map.to_str().and_then(procedural::find) {
            Some(sample) if !self.map.exists() => Ok(sample.image(DEFAULT_SIZE)),
            _ => Ok(image_io::read(&self.map)?),
        }
    }

    fn table(&self, image: &RasterImage, diagnosis: &Diagnosis) -> String {
        let RasterImage { width, height, format, depth, .. } = image;
        let head = format!("{}: {width} x {height}, {} {format}", self.map.display(), depth.label());
        let lines = diagnosis.findings.iter().map(line);
        std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
    }

    fn json(&self, image: &RasterImage, diagnosis: &Diagnosis) -> anyhow::Result<String> {
        let map = MapReport {
            path: self.map.display().to_string(),
            width: image.width,
            height: image.height,
            channels: image.channels,
            format: image.format,
            depth: image.depth.label(),
        };
        let report = Report {
            schema: 1,
            version: env!("CARGO_PKG_VERSION"),
            map,
            doubtful: diagnosis.is_doubtful(),
            findings: diagnosis.findings.iter().map(FindingReport::of).collect(),
            lengths: LengthReport { bin_width: LengthHistogram::STEP, counts: &diagnosis.lengths.counts },
        };
        Ok(serde_json::to_string_pretty(&report)?)
    }
}

impl<'a> FindingReport<'a> {
    fn of(finding: &'a Finding) -> Self {
        Self {
            subject: finding.subject,
            answer: &finding.answer,
            confidence: finding.confidence,
            doubtful: finding.doubtful,
            reason: &finding.reason,
            option: finding.advice.map(Advice::option),
        }
    }
}

fn line(finding: &Finding) -> String {
    let mark = if finding.doubtful { "!" } else { " " };
    let Finding { answer, confidence, reason, .. } = finding;
    let settle = match finding.advice {
        Some(advice) if finding.doubtful => format!("; settled by {}", advice.option()),
        _ => String::new(),
    };
    format!("{mark} {:<8} {answer:<18} {confidence:<8} {reason}{settle}", finding.subject.label())
}
