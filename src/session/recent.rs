//! Maps and sessions opened lately, remembered across runs in the user's configuration folder.

use std::path::{Path, PathBuf};

use directories::ProjectDirs;

use crate::image_io::{WriteImageError, write_bytes_atomically};

/// The user's folder for what the program keeps; `None` on a system that has none.
pub fn user_folder() -> Option<PathBuf> {
    ProjectDirs::from("", "", "ndf-inspector").map(|dirs| dirs.config_dir().to_owned())
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
        let Some(store) = &self.store else { return Ok(()) };
        if let Some(folder) = store.parent() {
            // A folder that cannot be made shows as a file that cannot be written.
            let _ = std::fs::create_dir_all(folder);
        }
        let json = serde_json::to_vec_pretty(&self.paths).unwrap_or_default();
        write_bytes_atomically(store, &json)
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
