//! What can go wrong with a mesh file, each in one plain sentence that names the file and the cause.

use std::io::ErrorKind;

use super::{MAX_FILE_BYTES, MAX_TRIANGLES};
use crate::scene::soup::SoupError;

/// Why a mesh could not be read. `name` is the file as the user gave it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum ImportError {
    /// There is no such file.
    #[error("'{name}' does not exist")]
    Missing { name: String },
    /// The path leads to a folder.
    #[error("'{name}' is a folder, not a mesh file")]
    Folder { name: String },
    /// The system refused for another reason.
    #[error("'{name}' cannot be read: {cause}")]
    System { name: String, cause: ErrorKind },
    /// The file holds no byte.
    #[error("'{name}' is empty")]
    Empty { name: String },
    /// The file is too long.
    #[error("'{name}' is longer than {} MiB, the most that is read", MAX_FILE_BYTES >> 20)]
    TooLong { name: String },
    /// The content is neither OBJ nor glTF.
    #[error("'{name}' is not a mesh that is read (OBJ, glTF and GLB are)")]
    UnknownFormat { name: String },
    /// The data contradicts its own format.
    #[error("'{name}' is damaged: its {format} data cannot be decoded ({cause})")]
    Damaged { name: String, format: &'static str, cause: String },
    /// A file that the mesh is spread over cannot be read.
    #[error("'{name}' needs '{part}', which cannot be read: {cause}")]
    MissingPart { name: String, part: String, cause: String },
    /// The file claims more triangles than are read.
    #[error("'{name}' claims {triangles} triangles; at most {MAX_TRIANGLES} are read")]
    TooManyTriangles { name: String, triangles: usize },
    /// The triangles are none to put a map on.
    #[error("'{name}' {cause}")]
    Unsound { name: String, cause: SoupError },
    /// The file was asked for a texture that it does not bring.
    #[error("'{name}' brings no {what} texture")]
    NoTexture { name: String, what: &'static str },
}

impl ImportError {
    /// The sentence for a failure of the operating system.
    pub(super) fn from_io(name: String, error: &std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::Missing { name },
            ErrorKind::IsADirectory => Self::Folder { name },
            cause => Self::System { name, cause },
        }
    }
}
