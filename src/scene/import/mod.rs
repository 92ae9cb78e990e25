//! Meshes from files: Wavefront OBJ, glTF and GLB.

mod error;
mod gltf;
mod obj;

use std::io::Read;
use std::path::Path;

use glam::Vec3;

use super::soup::{MissingNormals, Part, Soup};
pub use error::ImportError;
pub use gltf::{TextureRole, texture};

/// Most triangles that are read.
pub const MAX_TRIANGLES: usize = 5_000_000;
/// The longest file that is read.
pub const MAX_FILE_BYTES: u64 = 1 << 30;
/// Extensions that the dialog offers.
pub const EXTENSIONS: [&str; 3] = ["obj", "gltf", "glb"];

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub struct Imported {
    /// The triangles.
    pub soup: Soup,
    /// Linear RGB of the whole surface, where the file gives one.
    pub base_color: Option<Vec3>,
    /// True where the file brings a normal texture.
    pub has_normal_map: bool,
}

/// True where the path's extension is a mesh's.
pub fn is_mesh_path(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

/// Reads a mesh; what it is follows from its content, and for text from its first byte.
///
/// # Errors
/// One sentence that names the file and the cause.
pub fn read(path: &Path) -> Result<Imported, ImportError> {
    let bytes = read_file(path)?;
    let starts_as_gltf = bytes.starts_with(b"glTF") || bytes.trim_ascii_start().first() == Some(&b'{');
    if starts_as_gltf { gltf::read(path, &bytes) } else { obj::read(path, &bytes) }
}

/// Checks the parts of a file and brings them together.
fn soup(path: &Path, parts: Vec<Part>, missing: MissingNormals) -> Result<Soup, ImportError> {
    let triangles = parts.iter().map(|part| part.triangles.len()).sum();
    if triangles > MAX_TRIANGLES {
        return Err(ImportError::TooManyTriangles { name: name(path), triangles });
    }
    Soup::new(parts, missing).map_err(|cause| ImportError::Unsound { name: name(path), cause })
}

fn read_file(path: &Path) -> Result<Vec<u8>, ImportError> {
    let failed = |error: std::io::Error| ImportError::from_io(name(path), &error);
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if metadata.is_dir() {
        return Err(ImportError::Folder { name: name(path) });
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(ImportError::TooLong { name: name(path) });
    }
    let mut bytes = Vec::new();
    file.by_ref().take(MAX_FILE_BYTES).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.is_empty() { Err(ImportError::Empty { name: name(path) }) } else { Ok(bytes) }
}

fn name(path: &Path) -> String {
    path.display().to_string()
}
