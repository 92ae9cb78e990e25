//! Every bad file is refused within a second, in one sentence that names the file and the cause.

use std::path::Path;
use std::time::{Duration, Instant};

use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageFormat};
use ndf_inspector::image_io::decode_bytes;
use ndf_inspector::normal_map::{MapOptions, NormalMap};

use super::files::{encoded, encoded8, exr_with, folder};

fn big_noise(format: ImageFormat) -> Vec<u8> {
    let noise =
        image::RgbImage::from_fn(97, 61, |x, y| image::Rgb([x * x * 7, y * x * 13, x + y * y].map(|v| v as u8)));
    encoded(&DynamicImage::ImageRgb8(noise), format)
}

fn refusal_of_bytes(name: &str, bytes: &[u8]) -> String {
    let folder = folder();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    refusal(&path)
}

/// The sentence that refuses `path`, checked to be one, to name the file and to come within a second.
fn refusal(path: &Path) -> String {
    let start = Instant::now();
    let sentence = NormalMap::read(path, &MapOptions::default()).unwrap_err().to_string();
    assert!(start.elapsed() < Duration::from_secs(1), "{sentence}: took {:?}", start.elapsed());
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    assert!(sentence.contains(&name), "{sentence}");
    assert!(!sentence.contains('\n'), "{sentence}");
    sentence
}

#[test]
fn a_missing_file_is_named() {
    let folder = folder();
    assert!(refusal(&folder.path().join("gone.png")).ends_with("gone.png' does not exist"));
}

#[test]
fn a_folder_is_refused() {
    let folder = folder();
    let path = folder.path().join("maps.png");
    std::fs::create_dir(&path).unwrap();
    assert!(refusal(&path).ends_with("is a folder, not an image file"));
}

#[test]
fn an_empty_file_is_refused() {
    assert!(refusal_of_bytes("a.png", b"").ends_with("is empty"));
    assert!(refusal_of_bytes("a.tga", b"").ends_with("is empty"));
}

#[test]
fn a_text_file_is_refused_whatever_its_name() {
    for name in ["a.png", "a.tga", "a.exr", "a"] {
        assert!(refusal_of_bytes(name, b"not a picture\n").ends_with("holds plain text, not an image"));
    }
}

#[test]
fn bytes_of_no_known_format_are_refused() {
    assert!(refusal_of_bytes("a.png", &[1, 2, 3, 255, 0, 9]).contains("not an image of a known format"));
    assert!(refusal_of_bytes("a.dds", b"DDS \x7c\0\0\0").contains("is a DDS file, which is not read"));
    assert!(refusal_of_bytes("a.gif", b"GIF89a\0\0").contains("is a GIF file, which is not read"));
}

#[cfg(unix)]
#[test]
fn a_file_without_permission_is_refused() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let path = folder.path().join("secret.png");
    std::fs::write(&path, encoded8(ImageFormat::Png)).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    // The superuser may read anything, so there is nothing to see then.
    if std::fs::File::open(&path).is_err() {
        assert!(refusal(&path).ends_with("there is no permission to read it"));
    }
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    use ImageFormat::{Bmp, Hdr, Jpeg, Png, Tga, Tiff, WebP};
    let hdr = encoded(&DynamicImage::ImageRgb32F(image::Rgb32FImage::new(97, 61)), Hdr);
    let mut files: Vec<(&str, Vec<u8>)> = [("a.png", Png), ("a.jpg", Jpeg), ("a.bmp", Bmp), ("a.tga", Tga)]
        .into_iter()
        .chain([("a.tif", Tiff), ("a.webp", WebP)])
        .map(|(name, format)| (name, big_noise(format)))
        .collect();
    files.extend([("a.hdr", hdr), ("a.exr", exr_with(&["R", "G", "B"], false))]);
    for (name, bytes) in files {
        assert!(decode_bytes(name, &bytes).is_ok(), "{name}");
        for keep in [bytes.len() / 5, bytes.len() / 2, bytes.len() * 9 / 10] {
            let sentence = refusal_of_bytes(name, &bytes[..keep]);
            assert!(sentence.contains("cut short") || sentence.contains("damaged"), "{keep}: {sentence}");
        }
    }
}

#[test]
fn a_png_cut_short_is_told_from_a_damaged_one() {
    let mut png = big_noise(ImageFormat::Png);
    assert!(refusal_of_bytes("a.png", &png[..png.len() / 2]).contains("is cut short: its PNG data"));
    let middle = png.len() / 2;
    png[middle] ^= 0xff;
    assert!(refusal_of_bytes("a.png", &png).contains("is damaged: its PNG data"));
}

#[test]
fn any_single_damaged_byte_of_a_header_is_survived() {
    let files = [
        ("a.png", encoded8(ImageFormat::Png)),
        ("a.tga", encoded8(ImageFormat::Tga)),
        ("a.bmp", encoded8(ImageFormat::Bmp)),
        ("a.tif", encoded8(ImageFormat::Tiff)),
        ("a.jpg", encoded8(ImageFormat::Jpeg)),
        ("a.webp", encoded8(ImageFormat::WebP)),
        ("a.exr", exr_with(&["R", "G", "B"], true)),
    ];
    for (name, bytes) in files {
        for at in 0..bytes.len().min(400) {
            for value in [0x00, 0x7f, 0xff] {
                let mut bad = bytes.clone();
                bad[at] = value;
                let start = Instant::now();
                let _ = decode_bytes(name, &bad);
                assert!(start.elapsed() < Duration::from_secs(1), "{name}: byte {at} set to {value}");
            }
        }
    }
}

/// The first bytes of a PNG that claims a size.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png).write_image(&[0; 3], 1, 1, ExtendedColorType::Rgb8).unwrap();
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    png
}

#[test]
fn a_claim_of_too_many_texels_is_refused_before_memory_is_taken() {
    let limit = "texels; at most 8192x8192 are supported";
    let sentence = refusal_of_bytes("a.png", &png_header(100_000, 100_000));
    assert!(sentence.contains("claims to be 100000x100000") && sentence.contains(limit), "{sentence}");
    assert!(refusal_of_bytes("a.png", &png_header(8193, 1)).contains("8193x1 texels"));

    let mut tga = encoded8(ImageFormat::Tga);
    tga[12..16].copy_from_slice(&[0xff; 4]);
    assert!(refusal_of_bytes("a.tga", &tga).contains("65535x65535"));

    let mut bmp = encoded8(ImageFormat::Bmp);
    bmp[18..22].copy_from_slice(&100_000_u32.to_le_bytes());
    bmp[22..26].copy_from_slice(&(-100_000_i32).to_le_bytes());
    assert!(refusal_of_bytes("a.bmp", &bmp).contains("100000x100000"));

    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n\0\0";
    assert!(refusal_of_bytes("a.hdr", hdr).contains("100000x100000"));
}

#[test]
fn an_openexr_claim_of_too_many_texels_is_refused() {
    let mut exr = exr_with(&["R", "G", "B"], false);
    let start = exr.windows(11).position(|window| window == b"dataWindow\0").unwrap();
    // The name, the type `box2i`, four bytes of length, then x and y of the two corners.
    let corner = start + 11 + 6 + 4 + 8;
    exr[corner..corner + 4].copy_from_slice(&99_999_i32.to_le_bytes());
    exr[corner + 4..corner + 8].copy_from_slice(&99_999_i32.to_le_bytes());
    let sentence = refusal_of_bytes("a.exr", &exr);
    assert!(sentence.contains("100000x100000"), "{sentence}");
}

#[test]
fn an_openexr_without_colour_says_what_it_holds() {
    let sentence = refusal_of_bytes("a.exr", &exr_with(&["Z", "id"], false));
    assert!(sentence.ends_with("has no colour channels (R, G and B, or X, Y and Z); it holds Z, id"), "{sentence}");
}

#[test]
fn a_greyscale_and_a_black_image_are_refused_by_name() {
    let grey = image::GrayImage::from_fn(4, 4, |x, y| image::Luma([(x * 16 + y) as u8]));
    let grey = encoded(&DynamicImage::ImageLuma8(grey), ImageFormat::Png);
    assert!(refusal_of_bytes("a.png", &grey).contains("add --height SCALE"));
    let black = encoded(&DynamicImage::ImageRgb8(image::RgbImage::new(4, 4)), ImageFormat::Png);
    assert!(refusal_of_bytes("a.png", &black).contains("is black all over"));
}
