//! A sweep's figures as a file: comma-separated values, JSON, or a picture of the plot.

use std::path::{Path, PathBuf};

use egui::{CentralPanel, Frame, RichText};

use super::figures_plot::FiguresPlot;
use super::theme::{self, Theme};
use crate::gpu::Gpu;
use crate::gpu::readback::ReadbackError;
use crate::headless::{Canvas, Screenshot};
use crate::image_io::{write_bytes_atomically, write_png_rgba8};
use crate::measure::{Metric, SweepRun, sweep_files};

/// What figures are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// Comma-separated values, every metric.
    Csv,
    /// JSON, every metric and what was open.
    Json,
    /// A picture of the plot as it is shown.
    Png,
}

impl FileKind {
    /// Every kind, in the order they are offered.
    pub const ALL: [Self; 3] = [Self::Csv, Self::Json, Self::Png];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Csv => "CSV",
            Self::Json => "JSON",
            Self::Png => "PNG",
        }
    }

    /// The ending of such files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Json => "json",
            Self::Png => "png",
        }
    }

    /// The kind that a path's ending tells.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|kind| kind.ending() == ending)
    }
}

/// Where figures go.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A file, of the kind that its ending tells.
    Path(PathBuf),
    /// A file of this kind, for which the system's dialog asks.
    Dialog(FileKind),
}

/// What is to be written, apart from the sweep, so that a job may write it.
pub enum Content {
    /// A text file.
    Text(String),
    /// A picture of this plot.
    Picture(FiguresPlot),
}

/// Pixels across and down of the picture of a plot.
const PICTURE_SIZE: [u32; 2] = [1200, 720];
/// Passes until the axes have found their widths.
const PASSES: usize = 4;

impl Content {
    /// The figures of a sweep as a file of this kind; `metric` is what a picture shows. `Err` is a sentence.
    pub fn new(run: &SweepRun, metric: Metric, kind: FileKind) -> Result<Self, String> {
        Ok(match kind {
            FileKind::Csv => Self::Text(sweep_files::csv(run)),
            FileKind::Json => Self::Text(sweep_files::json(run).map_err(|error| error.to_string())? + "\n"),
            FileKind::Png => Self::Picture(FiguresPlot::new(run, metric)),
        })
    }

    /// Writes the file, whole or not at all. `Err` is a sentence that names it and the cause.
    pub fn write(&self, path: &Path, gpu: &Gpu) -> Result<(), String> {
        match self {
            Self::Text(text) => write_bytes_atomically(path, text.as_bytes()).map_err(|error| error.to_string()),
            Self::Picture(plot) => {
                let drawn = picture(plot, gpu);
                let Screenshot { size: [width, height], rgba } =
                    drawn.map_err(|error| format!("'{}' cannot be written: {error}", path.display()))?;
                write_png_rgba8(path, width as usize, height as usize, &rgba).map_err(|error| error.to_string())
            }
        }
    }
}

/// The plot by itself, under its title.
pub fn picture(plot: &FiguresPlot, gpu: &Gpu) -> Result<Screenshot, ReadbackError> {
    let mut canvas = Canvas::new(gpu, PICTURE_SIZE);
    for _ in 0..PASSES {
        canvas.pass(Vec::new(), |ui| {
            theme::apply(ui.ctx(), Theme::Dark);
            let frame = Frame::new().fill(theme::of(ui).panel).inner_margin(16);
            CentralPanel::no_frame().frame(frame).show(ui, |ui| {
                ui.label(RichText::new(plot.title()).color(theme::of(ui).strong));
                let height = ui.available_height();
                plot.show(ui, height);
            });
        })?;
    }
    canvas.picture()
}
