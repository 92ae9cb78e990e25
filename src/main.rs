//! The program `ndf-inspector`: parses the command line and hands over to the library.

use std::process::ExitCode;

use clap::Parser;
use ndf_inspector::cli::{self, Cli};

fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("ndf_inspector=warn")).init();
    let cli = Cli::parse();
    let result = match cli.command {
        Some(command) => cli::run(command),
        None => cli::open_window(&cli).map(|()| ExitCode::SUCCESS),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("ndf-inspector: {error:#}");
            ExitCode::FAILURE
        }
    }
}
