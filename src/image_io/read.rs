//! From a path, or bytes, to a [`RasterImage`]; every hostile size is refused before memory is taken for it.

use std::fs::File;
use std::io::Read;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use super::sniff::{Content, Format, format_name, sniff};
use super::{RasterImage, ReadImageError, memory, open_exr, pixel_formats};

/// The longest side of an image that is read: what every GPU the program runs on can hold in one texture.
pub const MAX_SIDE: usize = 8192;
/// Memory of a map that is being opened, per texel: up to four channels as they are stored, in single precision while
/// they are decoded, the normals, and the mean normals of every level.
const BYTES_PER_TEXEL: u64 = 4 * 4 + 4 * 4 + 3 * 4 + 4 * 16 / 3;

/// The longest file that is read: the largest image as four uncompressed floats a texel, and as much again for
/// layers and data beside it.
pub const MAX_FILE_BYTES: u64 = 2 << 30;

/// Reads an image file; the path `-` stands for standard input.
///
/// # Errors
/// One sentence that names the file and the cause; see [`ReadImageError`].
pub fn read(path: &Path) -> Result<RasterImage, ReadImageError> {
    decode_bytes(&source_name(path), &read_bytes(path)?)
}

/// Reads the bytes of an image file; the path `-` stands for standard input.
///
/// # Errors
/// One sentence that names the file and the cause; see [`ReadImageError`].
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, ReadImageError> {
    let name = source_name(path);
    if path == Path::new("-") {
        return read_all(&name, std::io::stdin().lock());
    }
    let refused = |error: std::io::Error| ReadImageError::from_io(&name, error.kind());
    let metadata = std::fs::metadata(path).map_err(refused)?;
    if metadata.is_dir() {
        return Err(ReadImageError::Folder { name });
    }
    if !metadata.is_file() {
        return Err(ReadImageError::NotRegular { name });
    }
    let file = File::open(path).map_err(refused)?;
    read_all(&name, file)
}

/// What messages call a file.
fn source_name(path: &Path) -> String {
    if path == Path::new("-") { "standard input".to_owned() } else { path.display().to_string() }
}

/// Decodes an image held in memory. `name` stands in the messages, and its extension tells TGA apart.
///
/// A decoder that panics on hostile bytes is caught and reported as damage: the decoders promise not to, but they
/// are other people's code and the window must outlive any file.
///
/// # Errors
/// One sentence that names the file and the cause; see [`ReadImageError`].
pub fn decode_bytes(name: &str, bytes: &[u8]) -> Result<RasterImage, ReadImageError> {
    let owned = || name.to_owned();
    if bytes.is_empty() {
        return Err(ReadImageError::Empty { name: owned() });
    }
    let format = match sniff(name, bytes) {
        Content::Image(format) => format,
        Content::Unsupported(format) => {
            return Err(ReadImageError::UnsupportedFormat { name: owned(), format });
        }
        Content::PlainText => return Err(ReadImageError::PlainText { name: owned() }),
        Content::Unknown => return Err(ReadImageError::UnknownFormat { name: owned() }),
    };
    catch_unwind(AssertUnwindSafe(|| decode_as(format, name, bytes))).unwrap_or_else(|_| {
        let format = match format {
            Format::OpenExr => open_exr::FORMAT,
            Format::Pixels(format) => format_name(format),
        };
        Err(ReadImageError::Damaged { name: owned(), format })
    })
}

fn decode_as(format: Format, name: &str, bytes: &[u8]) -> Result<RasterImage, ReadImageError> {
    match format {
        Format::OpenExr => open_exr::decode(name, bytes),
        Format::Pixels(format) => pixel_formats::decode(name, bytes, format),
    }
}

fn read_all(name: &str, source: impl Read) -> Result<Vec<u8>, ReadImageError> {
    let mut bytes = Vec::new();
    source
        .take(MAX_FILE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| ReadImageError::from_io(name, error.kind()))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(ReadImageError::TooLong { name: name.to_owned() });
    }
    Ok(bytes)
}

/// Checks what a header claims, before anything is allocated for it.
pub(super) fn check_size(
    name: &str,
    format: &'static str,
    width: u64,
    height: u64,
) -> Result<(usize, usize), ReadImageError> {
    let name = name.to_owned();
    if width == 0 || height == 0 {
        return Err(ReadImageError::Damaged { name, format });
    }
    match (usize::try_from(width), usize::try_from(height)) {
        (Ok(w), Ok(h)) if w <= MAX_SIDE && h <= MAX_SIDE => {
            let need = width * height * BYTES_PER_TEXEL;
            memory::check(need).map_err(|cause| ReadImageError::NoMemory { name, width, height, cause })?;
            Ok((w, h))
        }
        _ => Err(ReadImageError::TooLarge { name, width, height }),
    }
}
