//! The command line: what can be asked for, and the way it is carried out.

pub mod adapters;
pub mod brdf;
pub mod bump;
pub mod compare;
pub mod doctor;
pub mod export;
pub mod fit;
pub mod look;
pub mod options;
pub mod probe;
pub mod render;
pub mod rules;
pub mod sample;
pub mod screenshot;
pub mod start;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, Subcommand};
use options::MapArguments;

use crate::app::autosave;
use crate::app::window::{self, WindowSettings};
use crate::jobs::panic_report;
use crate::normal_map::MapOptions;
use crate::session::{MapRequest, Message, Session, recent};

/// Shows what happens to a normal map when it is filtered.
#[derive(Debug, Parser)]
#[command(name = "ndf-inspector", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; the window opens without it.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The map or session that the window opens; without it, what the last run showed, or the bundled sample.
    pub map: Option<PathBuf>,
    /// Start with the bundled sample and the defaults, whatever the last run showed.
    #[arg(long, conflicts_with = "map")]
    pub new: bool,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// Write a line for every frame of the window, in milliseconds: its start, the time of its panels, and the
    /// processor's time that the window's thread spent in all.
    #[arg(long, value_name = "FILE")]
    pub frame_log: Option<PathBuf>,
    /// Give the graphics device up after so many seconds, to rehearse its loss.
    #[arg(long, value_name = "SECONDS", hide = true)]
    pub lose_device_after: Option<f32>,
}

/// The commands beside the window.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Fit lobes to every texel of every level, and write what was asked for.
    Fit(fit::FitCommand),
    /// Effective BRDF values of a method at chosen texels and directions.
    Probe(probe::ProbeCommand),
    /// The lit surface alone, without a window.
    Render(render::RenderCommand),
    /// Every method against the truth: a table, and pictures.
    Compare(compare::CompareCommand),
    /// The whole window as a PNG, without a display.
    Screenshot(screenshot::ScreenshotCommand),
    /// What a file says of how it should be read, and whether it is read so.
    Doctor(doctor::DoctorCommand),
    /// A height map on a parametric surface: lit by the exact normal or by Blinn's, or what sets the two apart.
    Bump(bump::BumpCommand),
    /// Write results for other programs.
    Export(export::ExportCommand),
    /// Write a bundled map, or list them.
    Sample(sample::SampleCommand),
    /// What graphics adapter would be used, and why.
    Adapters,
}

/// Opens the window on the map or session that was named, else on what the last run kept, else on the bundled sample.
///
/// # Errors
/// One sentence that says why there is no window, and what to do instead.
pub fn open_window(cli: &Cli) -> anyhow::Result<()> {
    if let Some(folder) = recent::user_folder() {
        panic_report::install(folder.join("reports"));
    }
    let named = cli.map.as_deref().map(|path| Ok(cli.map_arguments.request(path, MapOptions::default())));
    let kept = || autosave::last_run().map(|file| file.map(|file| MapRequest::Session(Box::new(file))));
    let request = named.or_else(|| if cli.new { None } else { kept() });
    let make = move |wake| {
        let mut session = Session::new(wake);
        session.remember_recent();
        session.watch_files();
        session.refit();
        match request {
            Some(Ok(request)) => session.open(request),
            Some(Err(error)) => session.report(Message::error(format!("The last session is lost: {error}."))),
            None => {}
        }
        session
    };
    let lose_device_after = cli.lose_device_after.and_then(|seconds| Duration::try_from_secs_f32(seconds).ok());
    let settings = WindowSettings { frame_log: cli.frame_log.as_deref(), lose_device_after };
    Ok(window::run(make, &settings)?)
}

/// Carries out a command, and says how the program ends.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn run(command: Command) -> anyhow::Result<ExitCode> {
    let done = match command {
        Command::Doctor(command) => return command.run(),
        Command::Fit(command) => command.run(),
        Command::Probe(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Compare(command) => command.run(),
        Command::Screenshot(command) => command.run(),
        Command::Bump(command) => command.run(),
        Command::Export(command) => command.run(),
        Command::Sample(command) => command.run(),
        Command::Adapters => adapters::run(),
    };
    done.map(|()| ExitCode::SUCCESS)
}
