//! Writing files so that a target is either the whole new file or the old one, untouched.

use std::fs::{Metadata, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::Path;

use atomic_write_file::AtomicWriteFile;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::WriteImageError;

/// Writes 8-bit red, green, blue and alpha as a PNG; `-` is standard output.
///
/// # Errors
/// One sentence that names the target and the cause; see [`WriteImageError`].
pub fn write_png_rgba8(path: &Path, width: usize, height: usize, rgba: &[u8]) -> Result<(), WriteImageError> {
    let png = encode(path, width, height, rgba, (4, 1), ExtendedColorType::Rgba8)?;
    write_bytes_atomically(path, &png)
}

/// Writes 8-bit red, green and blue as a PNG; `-` is standard output.
///
/// # Errors
/// As [`write_png_rgba8`].
pub fn write_png_rgb8(path: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<(), WriteImageError> {
    let png = encode(path, width, height, rgb, (3, 1), ExtendedColorType::Rgb8)?;
    write_bytes_atomically(path, &png)
}

/// Writes 16-bit red, green and blue as a PNG; `-` is standard output.
///
/// # Errors
/// As [`write_png_rgba8`].
pub fn write_png_rgb16(path: &Path, width: usize, height: usize, rgb: &[u16]) -> Result<(), WriteImageError> {
    let bytes = bytemuck::cast_slice(rgb);
    let png = encode(path, width, height, bytes, (3, 2), ExtendedColorType::Rgb16)?;
    write_bytes_atomically(path, &png)
}

/// The bytes of a PNG of 8-bit red, green and blue, for a target that is no file. `name` stands in the message.
///
/// # Errors
/// When the samples do not make the texels.
pub fn png_rgb8(name: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>, WriteImageError> {
    encode(name, width, height, rgb, (3, 1), ExtendedColorType::Rgb8)
}

/// Encodes samples of `(channels, bytes per sample)`.
fn encode(
    path: &Path,
    width: usize,
    height: usize,
    samples: &[u8],
    (channels, sample_bytes): (usize, usize),
    color: ExtendedColorType,
) -> Result<Vec<u8>, WriteImageError> {
    let name = target_name(path);
    let expected = width.checked_mul(height).and_then(|texels| texels.checked_mul(channels * sample_bytes));
    let sides = u32::try_from(width).ok().zip(u32::try_from(height).ok());
    let (Some((columns, rows)), true) = (sides, expected == Some(samples.len()) && !samples.is_empty()) else {
        let samples = samples.len() / sample_bytes;
        return Err(WriteImageError::WrongLength { name, samples, width, height });
    };
    let mut png = Vec::new();
    PngEncoder::new(&mut png).write_image(samples, columns, rows, color).map_err(|error| {
        log::debug!("{name}: {error}");
        WriteImageError::Encoding { name: name.clone() }
    })?;
    Ok(png)
}

/// Writes a file so that a failure, a full disk for one, leaves the old file whole: the bytes go to a new file
/// beside it, which then takes its name. `-` is standard output; a device or a pipe is written to as it stands, and
/// a symbolic link keeps pointing where it did.
///
/// # Errors
/// One sentence that names the target and the cause; see [`WriteImageError`].
pub fn write_bytes_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteImageError> {
    let name = target_name(path);
    let refused = |error: std::io::Error| WriteImageError::from_io(&name, error.kind());
    if path == Path::new("-") {
        return write_and_flush(std::io::stdout().lock(), bytes).map_err(refused);
    }
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => Err(WriteImageError::Folder { name }),
        Ok(metadata) if !metadata.is_file() => write_in_place(path, bytes).map_err(refused),
        Ok(metadata) => replace(path, &metadata, bytes).map_err(refused),
        Err(error) if error.kind() == ErrorKind::NotFound => write_new(path, bytes).map_err(refused),
        Err(error) => Err(refused(error)),
    }
}

/// Replaces a file, unless it is marked read-only: its folder alone would let the new file take its name.
fn replace(path: &Path, metadata: &Metadata, bytes: &[u8]) -> std::io::Result<()> {
    if metadata.permissions().readonly() {
        return Err(ErrorKind::PermissionDenied.into());
    }
    write_new(&path.canonicalize()?, bytes)
}

fn write_new(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = AtomicWriteFile::open(path)?;
    file.write_all(bytes)?;
    file.commit()
}

fn write_in_place(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    write_and_flush(OpenOptions::new().write(true).open(path)?, bytes)
}

fn write_and_flush(mut target: impl Write, bytes: &[u8]) -> std::io::Result<()> {
    target.write_all(bytes)?;
    target.flush()
}

fn target_name(path: &Path) -> String {
    if path == Path::new("-") { "standard output".to_owned() } else { path.display().to_string() }
}
