//! `export`: results as files for other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use clap::{Args, ValueEnum};

use super::options::{FitArguments, MapArguments, wait_for_fit};
use crate::export::lobes_exr;
use crate::session::Session;

/// Write results for other programs.
#[derive(Args, Debug)]
pub struct ExportCommand {
    /// The normal map.
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
    /// The file to write, - for standard output.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportKind {
    /// The lobes of every level, as OpenEXR.
    Lobes,
}

impl ExportCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        let opened = self.map_arguments.read(&self.map)?;
        let mut session = Session::with_opened(opened, Arc::new(|| {}));
        session.set_threads(self.fit.threads());
        session.skip_previews();
        session.begin(self.fit.over(*session.fit_settings()));
        wait_for_fit(&mut session)?;
        match self.kind {
            ExportKind::Lobes => write_lobes(&self.output, &session),
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
