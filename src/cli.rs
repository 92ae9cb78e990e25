//! The command line: what can be asked for, and the way it is carried out.

pub mod adapters;
pub mod fit;
pub mod options;
pub mod probe;
pub mod render;
pub mod sample;

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use options::MapArguments;

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
    /// Write a bundled map, or list them.
    Sample(sample::SampleCommand),
    /// What graphics adapter would be used, and why.
    Adapters,
}

/// Carries out a command.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn run(command: Command) -> anyhow::Result<()> {
    match command {
        Command::Fit(command) => command.run(),
        Command::Probe(command) => command.run(),
        Command::Render(command) => command.run(),
        Command::Sample(command) => command.run(),
        Command::Adapters => adapters::run(),
    }
}
