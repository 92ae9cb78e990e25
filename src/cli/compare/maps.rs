//! The maps that are compared: each by itself, a folder by the images in it.

use std::path::{Path, PathBuf};

use anyhow::Context;

/// Endings of files that are taken from a folder, in any case.
const ENDINGS: [&str; 10] = ["png", "tga", "bmp", "tif", "tiff", "jpg", "jpeg", "webp", "hdr", "exr"];

/// Every map that `named` stands for; `None` is the session's map, where none is named.
///
/// # Errors
/// One sentence that names the folder and the cause.
pub fn every_map(named: &[PathBuf]) -> anyhow::Result<Vec<Option<PathBuf>>> {
    let mut maps = Vec::new();
    for path in named {
        if path.is_dir() {
            maps.extend(images_in(path)?.into_iter().map(Some));
        } else {
            maps.push(Some(path.clone()));
        }
    }
    Ok(if maps.is_empty() { vec![None] } else { maps })
}

/// The images of a folder, by name; those of its own folders are left.
fn images_in(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let unreadable = || format!("'{}' cannot be read", folder.display());
    let mut images = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(unreadable)? {
        let path = entry.with_context(unreadable)?.path();
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if path.is_file() && ENDINGS.contains(&ending.to_ascii_lowercase().as_str()) {
            images.push(path);
        }
    }
    anyhow::ensure!(!images.is_empty(), "There is no image in '{}'.", folder.display());
    images.sort();
    Ok(images)
}
