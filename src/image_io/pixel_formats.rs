//! PNG, TGA, BMP, TIFF, JPEG, WebP and Radiance HDR, by the `image` crate.

use std::error::Error;
use std::io::{Cursor, ErrorKind};

use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::read::check_size;
use super::sniff::format_name;
use super::{MAX_FILE_BYTES, RasterImage, ReadImageError, SampleDepth, Samples};

/// Decodes `bytes`, known to be in `format`, at the depth they are stored in.
pub(super) fn decode(name: &str, bytes: &[u8], format: ImageFormat) -> Result<RasterImage, ReadImageError> {
    let plain = |error: ImageError| plain_error(name, format, &error);
    check_claimed_size(name, bytes, format)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_FILE_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(plain)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(name, format_name(format), width.into(), height.into())?;
    if format == ImageFormat::Jpeg && !jpeg_is_complete(bytes) {
        return Err(truncated(name, format));
    }
    let color = decoder.color_type();
    let samples = read_samples(decoder, color, width * height).map_err(plain)?;
    Ok(RasterImage {
        width,
        height,
        channels: usize::from(color.channel_count()),
        has_alpha: color.has_alpha(),
        depth: depth_of(&samples),
        samples,
        format: format_name(format),
        tagged_srgb: format == ImageFormat::Png && png_says_srgb(bytes),
    })
}

fn read_samples(decoder: impl ImageDecoder, color: ColorType, texels: usize) -> Result<Samples, ImageError> {
    let count = texels * usize::from(color.channel_count());
    Ok(match color {
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let mut values = vec![0_u16; count];
            decoder.read_image(bytemuck::cast_slice_mut(&mut values))?;
            Samples::U16(values)
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            let mut values = vec![0.0_f32; count];
            decoder.read_image(bytemuck::cast_slice_mut(&mut values))?;
            Samples::F32(values)
        }
        _ => {
            let mut values = vec![0_u8; count];
            decoder.read_image(&mut values)?;
            Samples::U8(values)
        }
    })
}

fn depth_of(samples: &Samples) -> SampleDepth {
    match samples {
        Samples::U8(_) => SampleDepth::Bits8,
        Samples::U16(_) => SampleDepth::Bits16,
        Samples::F32(_) => SampleDepth::Float,
    }
}

/// Reads the size from the headers whose claim the decoder itself refuses with another message, or acts on at once.
fn check_claimed_size(name: &str, bytes: &[u8], format: ImageFormat) -> Result<(), ReadImageError> {
    let word = |at: usize, big: bool| {
        let word: [u8; 4] = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u64::from(if big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) }))
    };
    let claim = match format {
        ImageFormat::Png => word(16, true).zip(word(20, true)),
        // A BMP counts its rows downwards when the height is negative.
        ImageFormat::Bmp => word(18, false).zip(word(22, false).map(|height| height.min((1 << 32) - height))),
        _ => None,
    };
    match claim {
        Some((width, height)) => check_size(name, format_name(format), width, height).map(|_| ()),
        None => Ok(()),
    }
}

/// True where a chunk of a PNG says that its samples are sRGB. Chunks are a length, a name, the data and a checksum,
/// and this one comes before the samples.
fn png_says_srgb(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or_default();
    while let &[a, b, c, d, ref name @ ..] = rest {
        if name.starts_with(b"sRGB") || name.starts_with(b"IDAT") {
            return name.starts_with(b"sRGB");
        }
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        rest = name.get(length.saturating_add(8)..).unwrap_or_default();
    }
    false
}

/// True where the last scan is followed by the end-of-image mark. The decoder fills a cut JPEG with grey instead
/// of failing. Inside a scan a byte `ff` is followed by `00` or a restart mark, so neither mark is found there.
fn jpeg_is_complete(bytes: &[u8]) -> bool {
    let last = |mark: [u8; 2]| bytes.windows(2).rposition(|pair| pair == mark);
    last([0xff, 0xd9]) > last([0xff, 0xda])
}

fn truncated(name: &str, format: ImageFormat) -> ReadImageError {
    ReadImageError::Truncated { name: name.to_owned(), format: format_name(format) }
}

/// Puts a decoder's failure into plain words; its own text goes to the log.
fn plain_error(name: &str, format: ImageFormat, error: &ImageError) -> ReadImageError {
    log::debug!("{name}: {error}");
    if ended_early(error) {
        return truncated(name, format);
    }
    let (name, format) = (name.to_owned(), format_name(format));
    match error {
        ImageError::Unsupported(_) => {
            ReadImageError::UnsupportedKind { name, format, feature: "its compression or sample layout" }
        }
        _ => ReadImageError::Damaged { name, format },
    }
}

/// True where the end of the data is somewhere in the chain of causes.
fn ended_early(error: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(error);
    while let Some(error) = cause {
        let io = error.downcast_ref::<std::io::Error>();
        if io.is_some_and(|error| error.kind() == ErrorKind::UnexpectedEof) {
            return true;
        }
        if let Some(ImageError::IoError(error)) = error.downcast_ref::<ImageError>()
            && error.kind() == ErrorKind::UnexpectedEof
        {
            return true;
        }
        cause = error.source();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_says_srgb_by_a_chunk_before_its_samples() {
        let chunk =
            |name: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_be_bytes()[..], name, data, &[0; 4]].concat();
        let png = |chunks: &[Vec<u8>]| [&[0; 8][..], &chunks.concat()].concat();
        let (srgb, samples) = (chunk(b"sRGB", &[0]), chunk(b"IDAT", b"sRGBsRGB"));
        assert!(png_says_srgb(&png(&[chunk(b"IHDR", &[0; 13]), srgb.clone(), samples.clone()])));
        assert!(!png_says_srgb(&png(&[chunk(b"IHDR", &[0; 13]), samples, srgb])));
        assert!(!png_says_srgb(&[0xff; 40]));
    }

    #[test]
    fn a_jpeg_needs_its_end_mark_after_the_last_scan() {
        assert!(jpeg_is_complete(&[0xff, 0xda, 1, 2, 0xff, 0xd9]));
        assert!(!jpeg_is_complete(&[0xff, 0xd9, 0xff, 0xda, 1, 2]));
        assert!(!jpeg_is_complete(&[0xff, 0xda, 1, 2]));
    }
}
