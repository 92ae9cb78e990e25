//! `adapters`: what graphics adapter would be used, and why.

use std::path::Path;

use super::options::write_text;
use crate::gpu::context::{self, GpuError};

/// Lists every adapter, the one that would be used marked.
///
/// # Errors
/// A sentence that names what to install where there is none.
pub fn run() -> anyhow::Result<()> {
    let adapters = context::list();
    anyhow::ensure!(!adapters.is_empty(), GpuError::NoAdapter);
    let lines: Vec<String> = adapters
        .iter()
        .map(|adapter| {
            let mark = if adapter.used { "*" } else { " " };
            format!("{mark} {} ({}): {}", adapter.choice.name, adapter.choice.backend, adapter.choice.reason)
        })
        .collect();
    write_text(Path::new("-"), &lines.join("\n"))
}
