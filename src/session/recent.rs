//! Maps and sessions opened lately, remembered across runs in the user's configuration folder.

use std::path::{Path, PathBuf};

use directories::ProjectDirs;
use serde::Serialize;

use crate::image_io::{WriteImageError, write_bytes_atomically};

/// The user's folder for what the program keeps; `None` on a system that has none.
pub fn user_folder() -> Option<PathBuf> {
    ProjectDirs::from("", "", "ndf-inspector").map(|dirs| dirs.config_dir().to_owned())
}

/// Makes the folder of a file that is kept for the user. One that cannot be made shows as a file that cannot be written.
pub fn make_folder_of(store: &Path) {
    if let Some(folder) = store.parent() {
        let _ = std::fs::create_dir_all(folder);
    }
}

/// Keeps a value for the user, as JSON.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn keep(store: &Path, value: &impl Serialize) -> Result<(), WriteImageError> {
    make_folder_of(store);
    write_bytes_atomically(store, &serde_json::to_vec_pretty(value).unwrap_or_default())
}

/// How many are remembered.
const CAPACITY: usize = 10;

/// The list, the latest first, and the file that keeps it.
#[derive(Clone, Debug, Default)]
pub struct RecentFiles {
    paths: Vec<PathBuf>,
    store: Option<PathBuf>,
}

impl RecentFiles {
    /// Reads the user's list; an unreadable one counts as empty.
    pub fn load() -> Self {
        let store = user_folder().map(|folder| folder.join("recent.json"));
        let paths = store
            .as_deref()
            .and_then(|path| std::fs::read(path).ok())
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
            .unwrap_or_default();
        Self { paths, store }
    }

    /// The paths, the latest first.
    pub fn paths(&self) -> &[PathBuf] {
        &self.paths
    }

    /// Puts `path` first and keeps the list on disk.
    pub fn push(&mut self, path: &Path) -> Result<(), WriteImageError> {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.paths.retain(|known| *known != path);
        self.paths.insert(0, path);
        self.paths.truncate(CAPACITY);
        self.store.as_deref().map_or(Ok(()), |store| keep(store, &self.paths))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_map_comes_first_and_once() {
        let mut recent = RecentFiles::default();
        for name in ["/a", "/b", "/a"] {
            recent.push(Path::new(name)).expect("nothing is stored");
        }
        assert_eq!(recent.paths(), [PathBuf::from("/a"), PathBuf::from("/b")]);
    }
}
