//! What can go wrong with an image file, each in one plain sentence that names the file and the cause.

use std::io::ErrorKind;

use super::{MAX_FILE_BYTES, MAX_SIDE};

const READABLE: &str = "PNG, TGA, BMP, TIFF, JPEG, WebP, Radiance HDR and OpenEXR";

/// Why an image could not be read. `name` is the file as the user gave it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum ReadImageError {
    /// There is no such file.
    #[error("'{name}' does not exist")]
    Missing { name: String },
    /// The path leads to a folder.
    #[error("'{name}' is a folder, not an image file")]
    Folder { name: String },
    /// The path leads to a device, a pipe or a socket.
    #[error("'{name}' is not a regular file")]
    NotRegular { name: String },
    /// The file exists but may not be read.
    #[error("'{name}' cannot be opened: there is no permission to read it")]
    Permission { name: String },
    /// The system refused for another reason, given in `cause`.
    #[error("'{name}' cannot be read: {cause}")]
    System { name: String, cause: ErrorKind },
    /// The file holds no byte.
    #[error("'{name}' is empty")]
    Empty { name: String },
    /// The file is longer than any image of the supported size.
    #[error("'{name}' is longer than {} MiB, the most that is read", MAX_FILE_BYTES >> 20)]
    TooLong { name: String },
    /// The file holds text.
    #[error("'{name}' holds plain text, not an image")]
    PlainText { name: String },
    /// The content is of no known image format.
    #[error("'{name}' is not an image of a known format ({READABLE} are read)")]
    UnknownFormat { name: String },
    /// The content is of an image format that is not read.
    #[error("'{name}' is a {format} file, which is not read; convert it to one of {READABLE}")]
    UnsupportedFormat { name: String, format: &'static str },
    /// The format is read, but not this flavour of it.
    #[error("'{name}' is a {format} file of a kind that is not read ({feature})")]
    UnsupportedKind { name: String, format: &'static str, feature: &'static str },
    /// The header claims more texels than are supported.
    #[error("'{name}' claims to be {width}x{height} texels; at most {MAX_SIDE}x{MAX_SIDE} are supported")]
    TooLarge { name: String, width: u64, height: u64 },
    /// The header claims more texels than memory can take.
    #[error("'{name}' is not read: with {width}x{height} texels {cause}")]
    NoMemory { name: String, width: u64, height: u64, cause: String },
    /// The data ends before the image does.
    #[error("'{name}' is cut short: its {format} data ends before the image does")]
    Truncated { name: String, format: &'static str },
    /// The data contradicts its own format.
    #[error("'{name}' is damaged: its {format} data cannot be decoded")]
    Damaged { name: String, format: &'static str },
    /// No layer of an OpenEXR file holds colour, x and y, or luminance.
    #[error("'{name}' has no colour channels (R, G and B, or X, Y and Z); it holds {found}")]
    NoColor { name: String, found: String },
}

impl ReadImageError {
    /// The sentence for a failure of the operating system.
    pub(super) fn from_io(name: &str, kind: ErrorKind) -> Self {
        let name = name.to_owned();
        match kind {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::Missing { name },
            ErrorKind::PermissionDenied => Self::Permission { name },
            ErrorKind::IsADirectory => Self::Folder { name },
            cause => Self::System { name, cause },
        }
    }
}

/// Why a file could not be written. The old file, where there was one, is whole and unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum WriteImageError {
    /// The folder to write into does not exist.
    #[error("'{name}' cannot be written: its folder does not exist")]
    NoFolder { name: String },
    /// The path leads to a folder.
    #[error("'{name}' cannot be written: it is a folder")]
    Folder { name: String },
    /// Writing is not allowed there.
    #[error("'{name}' cannot be written: there is no permission to write there")]
    Permission { name: String },
    /// No space is left.
    #[error("'{name}' cannot be written: the disk is full")]
    DiskFull { name: String },
    /// The system refused for another reason, given in `cause`.
    #[error("'{name}' cannot be written: {cause}")]
    System { name: String, cause: ErrorKind },
    /// The number of samples is not width times height times channels, or there are none.
    #[error("'{name}' cannot be written: {samples} samples do not make {width}x{height} texels")]
    WrongLength { name: String, samples: usize, width: usize, height: usize },
    /// The samples could not be encoded.
    #[error("'{name}' cannot be written: its texels could not be encoded")]
    Encoding { name: String },
}

impl WriteImageError {
    /// The sentence for a failure of the operating system.
    pub(super) fn from_io(name: &str, kind: ErrorKind) -> Self {
        let name = name.to_owned();
        match kind {
            ErrorKind::NotFound | ErrorKind::NotADirectory => Self::NoFolder { name },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Self::Permission { name },
            ErrorKind::IsADirectory => Self::Folder { name },
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Self::DiskFull { name },
            ErrorKind::InvalidData => Self::Encoding { name },
            cause => Self::System { name, cause },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_refusal_of_the_system_has_its_own_sentence() {
        let sentence = |kind| ReadImageError::from_io("a.png", kind).to_string();
        assert_eq!(sentence(ErrorKind::NotFound), "'a.png' does not exist");
        assert_eq!(
            sentence(ErrorKind::PermissionDenied),
            "'a.png' cannot be opened: there is no permission to read it"
        );
        assert_eq!(
            WriteImageError::from_io("b.png", ErrorKind::StorageFull).to_string(),
            "'b.png' cannot be written: the disk is full"
        );
    }
}
