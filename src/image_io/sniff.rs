//! Which image format some bytes are in, by what they hold; the file's name counts for TGA alone, which has no
//! mark of its own at the start.

use std::path::Path;

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// Read by the `image` crate.
    Pixels(image::ImageFormat),
    /// Read by the `exr` crate.
    OpenExr,
}

/// What some bytes turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Content {
    /// An image that is read.
    Image(Format),
    /// An image format that is known by name and not read.
    Unsupported(&'static str),
    /// Readable text.
    PlainText,
    /// None of these.
    Unknown,
}

/// First bytes of formats that are recognised only to be refused by name.
const REFUSED: [(&[u8], &str); 6] = [
    (b"DDS ", "DDS"),
    (b"8BPS", "Photoshop"),
    (b"\xabKTX ", "KTX"),
    (b"GIF8", "GIF"),
    (b"%PDF", "PDF"),
    (b"qoif", "QOI"),
];

/// The last bytes of a TGA file of the format's second version.
const TGA_FOOTER: &[u8] = b"TRUEVISION-XFILE.\0";

/// Says what `bytes` hold. `name` gives the extension.
pub(super) fn sniff(name: &str, bytes: &[u8]) -> Content {
    use image::ImageFormat as F;
    if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        return Content::Image(Format::OpenExr);
    }
    if let Some((_, format)) = REFUSED.iter().find(|(mark, _)| bytes.starts_with(mark)) {
        return Content::Unsupported(format);
    }
    match image::guess_format(bytes) {
        Ok(format @ (F::Png | F::Jpeg | F::WebP | F::Tiff | F::Bmp | F::Hdr)) => Content::Image(Format::Pixels(format)),
        Ok(F::Avif) => Content::Unsupported("AVIF"),
        _ if bytes.ends_with(TGA_FOOTER) || is_tga(name, bytes) => Content::Image(Format::Pixels(F::Tga)),
        _ if is_text(bytes) => Content::PlainText,
        _ => Content::Unknown,
    }
}

/// True where the name says TGA and the image type and depth of the header are ones the format has.
fn is_tga(name: &str, bytes: &[u8]) -> bool {
    let extension = Path::new(name).extension().and_then(|extension| extension.to_str());
    let named = extension.is_some_and(|extension| extension.eq_ignore_ascii_case("tga"));
    let header = bytes.len() < 18 || matches!(bytes[2], 1..=3 | 9..=11) && matches!(bytes[16], 8 | 15 | 16 | 24 | 32);
    named && header && !is_text(bytes)
}

/// True where the first bytes are UTF-8 without control characters other than white space.
fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(4096)];
    let text = match std::str::from_utf8(start) {
        Ok(text) => text,
        // The cut may fall inside a character.
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&start[..error.valid_up_to()]).unwrap_or_default()
        }
        Err(_) => return false,
    };
    !text.is_empty() && !text.contains(|c: char| c.is_control() && !c.is_ascii_whitespace())
}

/// The name of a format that the window and the messages show.
pub(super) fn format_name(format: image::ImageFormat) -> &'static str {
    use image::ImageFormat as F;
    match format {
        F::Png => "PNG",
        F::Jpeg => "JPEG",
        F::WebP => "WebP",
        F::Tiff => "TIFF",
        F::Bmp => "BMP",
        F::Hdr => "Radiance HDR",
        F::Tga => "TGA",
        _ => "image",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_content_counts_and_not_the_name() {
        assert_eq!(sniff("a.png", b"once upon a time"), Content::PlainText);
        assert_eq!(sniff("a.txt", b"\x89PNG\r\n\x1a\n"), Content::Image(Format::Pixels(image::ImageFormat::Png)));
        assert_eq!(sniff("a.png", b"DDS \0\0"), Content::Unsupported("DDS"));
        assert_eq!(sniff("a.png", &[7, 0, 1, 2]), Content::Unknown);
    }

    #[test]
    fn text_cut_inside_a_character_is_still_text() {
        let text = "x".repeat(4095) + "é";
        assert_eq!(sniff("a.png", text.as_bytes()), Content::PlainText);
    }
}
