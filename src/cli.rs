//! The command line: what can be asked for, and the way it is carried out.

pub mod adapters;
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

use clap::{Parser, Subcommand};
use options::MapArguments;

use crate::app::window;
use crate::normal_map::MapOptions;
use crate::session::Session;

/// Shows what happens to a normal map when it is filtered.
#[derive(Debug, Parser)]
#[command(name = "ndf-inspector", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; the window opens without it.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The map that the window opens; without it, the bundled sample.
    pub map: Option<PathBuf>,
    /// How the map is read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// Write a line for every frame of the window: its start and the program's own time, in milliseconds.
    #[arg(long, value_name = "FILE")]
    pub frame_log: Option<PathBuf>,
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
    /// Write results for other programs.
    Export(export::ExportCommand),
    /// Write a bundled map, or list them.
    Sample(sample::SampleCommand),
    /// What graphics adapter would be used, and why.
    Adapters,
}

/// Opens the window on the map that was named, or on the bundled sample.
///
/// # Errors
/// One sentence that says why there is no window, and what to do instead.
pub fn open_window(cli: &Cli) -> anyhow::Result<()> {
    let request = cli.map.as_deref().map(|path| cli.map_arguments.request(path, MapOptions::default()));
    let make = move |wake| {
        let mut session = Session::new(wake);
        session.remember_recent();
        session.refit();
        if let Some(request) = request {
            session.open(request);
        }
        session
    };
    Ok(window::run(make, cli.frame_log.as_deref())?)
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
        Command::Export(command) => command.run(),
        Command::Sample(command) => command.run(),
        Command::Adapters => adapters::run(),
    };
    done.map(|()| ExitCode::SUCCESS)
}
