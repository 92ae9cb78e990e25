//! What a window needs of the machine before the toolkit tries: a display, and the libraries of its keyboard.

use std::path::{Path, PathBuf};

use super::WindowError;

/// On Linux and the BSDs: a display must be named, and its keyboard library present, which would panic later.
pub fn check() -> Result<(), WindowError> {
    if !cfg!(all(unix, not(target_os = "macos"))) {
        return Ok(());
    }
    let named = |variable: &str| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    let wayland = named("WAYLAND_DISPLAY") || named("WAYLAND_SOCKET");
    if !wayland && !named("DISPLAY") {
        return Err(WindowError::NoDisplay("neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned()));
    }
    if !library_is_there("libxkbcommon.so.0") {
        return Err(WindowError::NoLibrary("libxkbcommon", "libxkbcommon0"));
    }
    if !wayland && !library_is_there("libxkbcommon-x11.so.0") {
        return Err(WindowError::NoLibrary("libxkbcommon-x11", "libxkbcommon-x11-0"));
    }
    Ok(())
}

/// Looks where the loader looks: `LD_LIBRARY_PATH`, and the system's folders one level down. Says yes when it found
/// no library folder at all, as on systems that keep them elsewhere.
fn library_is_there(file: &str) -> bool {
    let own = std::env::var("LD_LIBRARY_PATH").unwrap_or_default();
    let system = ["/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib"];
    let mut folders: Vec<PathBuf> = own.split(':').filter(|f| !f.is_empty()).map(Into::into).collect();
    folders.extend(system.iter().map(Into::into));
    let below = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect()
    };
    let nested: Vec<_> = folders.iter().flat_map(|folder| below(folder)).collect();
    folders.extend(nested);
    let mut present = folders.iter().filter(|folder| folder.is_dir()).peekable();
    present.peek().is_none()
        || present.any(|folder| folder.join(file).exists())
        || !folders.iter().any(|folder| has_libc(folder))
}

fn has_libc(folder: &Path) -> bool {
    folder.join("libc.so.6").exists()
}
