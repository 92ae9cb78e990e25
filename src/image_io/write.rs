//! Writing files so that a target is either the whole new file or the old one, untouched.

use std::fs::OpenOptions;
use std::io::{BufWriter, Cursor, ErrorKind, Seek, Write};
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

/// Writes 8-bit grey as a PNG; `-` is standard output.
///
/// # Errors
/// As [`write_png_rgba8`].
pub fn write_png_gray8(path: &Path, width: usize, height: usize, gray: &[u8]) -> Result<(), WriteImageError> {
    let png = encode(path, width, height, gray, (1, 1), ExtendedColorType::L8)?;
    write_bytes_atomically(path, &png)
}

/// Writes 16-bit grey as a PNG; `-` is standard output.
///
/// # Errors
/// As [`write_png_rgba8`].
pub fn write_png_gray16(path: &Path, width: usize, height: usize, gray: &[u16]) -> Result<(), WriteImageError> {
    let png = encode(path, width, height, bytemuck::cast_slice(gray), (1, 2), ExtendedColorType::L16)?;
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
    let write = || match Target::open(path)? {
        Target::File(mut file) => {
            file.write_all(bytes)?;
            file.commit()
        }
        Target::Stream(mut stream) => {
            stream.write_all(bytes)?;
            stream.flush()
        }
    };
    write().map_err(|error| WriteImageError::from_io(&target_name(path), error.kind()))
}

/// A file that can be written to at any place.
pub(super) trait WriteAnywhere: Write + Seek {}

impl<T: Write + Seek> WriteAnywhere for T {}

/// As [`write_bytes_atomically`], for contents that `write` makes little by little and goes back in.
///
/// # Errors
/// One sentence that names the target and the cause; see [`WriteImageError`].
pub(super) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn WriteAnywhere) -> std::io::Result<()>,
) -> Result<(), WriteImageError> {
    let write = || match Target::open(path)? {
        Target::File(file) => {
            let mut buffered = BufWriter::new(file);
            write(&mut buffered)?;
            buffered.into_inner()?.commit()
        }
        Target::Stream(mut stream) => {
            let mut bytes = Cursor::new(Vec::new());
            write(&mut bytes)?;
            stream.write_all(bytes.get_ref())?;
            stream.flush()
        }
    };
    write().map_err(|error| WriteImageError::from_io(&target_name(path), error.kind()))
}

/// Where bytes go.
enum Target {
    /// A new file that takes the name once it is whole.
    File(AtomicWriteFile),
    /// Standard output, a device or a pipe.
    Stream(Box<dyn Write>),
}

impl Target {
    fn open(path: &Path) -> std::io::Result<Self> {
        if path == Path::new("-") {
            return Ok(Self::Stream(Box::new(std::io::stdout().lock())));
        }
        match std::fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => Err(ErrorKind::IsADirectory.into()),
            Ok(metadata) if !metadata.is_file() => {
                Ok(Self::Stream(Box::new(OpenOptions::new().write(true).open(path)?)))
            }
            // A file marked read-only is kept: its folder alone would let the new file take its name.
            Ok(metadata) if metadata.permissions().readonly() => Err(ErrorKind::PermissionDenied.into()),
            Ok(_) => Ok(Self::File(AtomicWriteFile::open(path.canonicalize()?)?)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Self::File(AtomicWriteFile::open(path)?)),
            Err(error) => Err(error),
        }
    }
}

fn target_name(path: &Path) -> String {
    if path == Path::new("-") { "standard output".to_owned() } else { path.display().to_string() }
}
