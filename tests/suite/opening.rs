//! Opening files: every format keeps its depth, and every bad file is refused in one sentence.

use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use exr::prelude::*;
use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageFormat};
use ndf_inspector::image_io::{
    RasterImage, SampleDepth, Samples, decode_bytes, read, write_bytes_atomically, write_png_rgb8,
    write_png_rgb16, write_png_rgba8,
};
use ndf_inspector::normal_map::procedural::SAMPLES;
use ndf_inspector::normal_map::{MapOptions, NormalMap};
use tempfile::TempDir;

/// A size that is no power of two.
const WIDTH: usize = 5;
const HEIGHT: usize = 3;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The sentence that refuses `path`, checked to be one, to name the file and to come within a second.
fn refusal(path: &Path) -> String {
    let start = Instant::now();
    let sentence = NormalMap::read(path, &MapOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        start.elapsed() < Duration::from_secs(1),
        "{sentence}: took {:?}",
        start.elapsed()
    );
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    assert!(sentence.contains(&name), "{sentence}");
    assert!(!sentence.contains('\n'), "{sentence}");
    sentence
}

fn refusal_of_bytes(name: &str, bytes: &[u8]) -> String {
    let folder = folder();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    refusal(&path)
}

fn colors8() -> Vec<u8> {
    (0..WIDTH * HEIGHT * 3)
        .map(|index| (index * 37 % 256) as u8)
        .collect()
}

fn colors16() -> Vec<u16> {
    (0..WIDTH * HEIGHT * 3)
        .map(|index| (index * 1409 + 3) as u16)
        .collect()
}

/// `colors8` as a file of `format`.
fn encoded8(format: ImageFormat) -> Vec<u8> {
    let image = image::RgbImage::from_raw(WIDTH as u32, HEIGHT as u32, colors8()).unwrap();
    encoded(&DynamicImage::ImageRgb8(image), format)
}

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn big_noise(format: ImageFormat) -> Vec<u8> {
    let noise = image::RgbImage::from_fn(97, 61, |x, y| {
        image::Rgb([x * x * 7, y * x * 13, x + y * y].map(|v| v as u8))
    });
    encoded(&DynamicImage::ImageRgb8(noise), format)
}

fn exr_bytes(write: impl FnOnce(&mut Cursor<Vec<u8>>)) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(&mut bytes);
    bytes.into_inner()
}

/// An OpenEXR file with one layer of the named channels, sample `10 * channel + texel` in each.
fn exr_with(names: &[&str], half: bool) -> Vec<u8> {
    let values =
        |channel: usize| (0..WIDTH * HEIGHT).map(move |texel| (10 * channel + texel) as f32 / 64.0);
    let channel = |(index, name): (usize, &&str)| {
        let samples = if half {
            FlatSamples::F16(values(index).map(f16::from_f32).collect())
        } else {
            FlatSamples::F32(values(index).collect())
        };
        AnyChannel::new(*name, samples)
    };
    let channels = AnyChannels::sort(names.iter().enumerate().map(channel).collect());
    let layer = Layer::new(
        (WIDTH, HEIGHT),
        LayerAttributes::named("only"),
        Encoding::FAST_LOSSLESS,
        channels,
    );
    exr_bytes(|bytes| {
        Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(bytes)
            .unwrap()
    })
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
        assert!(
            refusal_of_bytes(name, b"not a picture\n").ends_with("holds plain text, not an image")
        );
    }
}

#[test]
fn bytes_of_no_known_format_are_refused() {
    assert!(
        refusal_of_bytes("a.png", &[1, 2, 3, 255, 0, 9]).contains("not an image of a known format")
    );
    assert!(
        refusal_of_bytes("a.dds", b"DDS \x7c\0\0\0").contains("is a DDS file, which is not read")
    );
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
    let hdr = encoded(
        &DynamicImage::ImageRgb32F(image::Rgb32FImage::new(97, 61)),
        Hdr,
    );
    let mut files: Vec<(&str, Vec<u8>)> = [
        ("a.png", Png),
        ("a.jpg", Jpeg),
        ("a.bmp", Bmp),
        ("a.tga", Tga),
    ]
    .into_iter()
    .chain([("a.tif", Tiff), ("a.webp", WebP)])
    .map(|(name, format)| (name, big_noise(format)))
    .collect();
    files.extend([("a.hdr", hdr), ("a.exr", exr_with(&["R", "G", "B"], false))]);
    for (name, bytes) in files {
        assert!(decode_bytes(name, &bytes).is_ok(), "{name}");
        for keep in [bytes.len() / 5, bytes.len() / 2, bytes.len() * 9 / 10] {
            let sentence = refusal_of_bytes(name, &bytes[..keep]);
            assert!(
                sentence.contains("cut short") || sentence.contains("damaged"),
                "{keep}: {sentence}"
            );
        }
    }
}

#[test]
fn a_png_cut_short_is_told_from_a_damaged_one() {
    let mut png = big_noise(ImageFormat::Png);
    assert!(
        refusal_of_bytes("a.png", &png[..png.len() / 2]).contains("is cut short: its PNG data")
    );
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
                assert!(
                    start.elapsed() < Duration::from_secs(1),
                    "{name}: byte {at} set to {value}"
                );
            }
        }
    }
}

/// The first bytes of a PNG that claims a size.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&[0; 3], 1, 1, ExtendedColorType::Rgb8)
        .unwrap();
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    png
}

#[test]
fn a_claim_of_too_many_texels_is_refused_before_memory_is_taken() {
    let limit = "texels; at most 8192x8192 are supported";
    let sentence = refusal_of_bytes("a.png", &png_header(100_000, 100_000));
    assert!(
        sentence.contains("claims to be 100000x100000") && sentence.contains(limit),
        "{sentence}"
    );
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
    let start = exr
        .windows(11)
        .position(|window| window == b"dataWindow\0")
        .unwrap();
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
    assert!(
        sentence.ends_with("has no colour channels (R, G and B, or X, Y and Z); it holds Z, id"),
        "{sentence}"
    );
}

#[test]
fn a_greyscale_and_a_black_image_are_refused_by_name() {
    let grey = image::GrayImage::from_fn(4, 4, |x, y| image::Luma([(x * 16 + y) as u8]));
    let grey = encoded(&DynamicImage::ImageLuma8(grey), ImageFormat::Png);
    assert!(refusal_of_bytes("a.png", &grey).contains("add --height SCALE"));
    let black = encoded(
        &DynamicImage::ImageRgb8(image::RgbImage::new(4, 4)),
        ImageFormat::Png,
    );
    assert!(refusal_of_bytes("a.png", &black).contains("is black all over"));
}

#[test]
fn eight_bit_formats_keep_every_sample() {
    use ImageFormat::{Bmp, Png, Tga, Tiff, WebP};
    let names = ["PNG", "TGA", "BMP", "TIFF", "WebP"];
    for (format, name) in [Png, Tga, Bmp, Tiff, WebP].into_iter().zip(names) {
        let image = decode_bytes("map.tga", &encoded8(format)).unwrap();
        assert_eq!(
            (image.width, image.height, image.channels, image.format),
            (WIDTH, HEIGHT, 3, name)
        );
        assert_eq!(
            (image.depth, &image.samples),
            (SampleDepth::Bits8, &Samples::U8(colors8())),
            "{name}"
        );
    }
}

#[test]
fn jpeg_is_read_near_its_samples() {
    let flat = image::RgbImage::from_pixel(9, 7, image::Rgb([128, 128, 255]));
    let image = decode_bytes(
        "map.jpg",
        &encoded(&DynamicImage::ImageRgb8(flat), ImageFormat::Jpeg),
    )
    .unwrap();
    assert_eq!(
        (image.width, image.height, image.depth),
        (9, 7, SampleDepth::Bits8)
    );
    // Lossy: a flat colour comes back within the rounding of its colour transform.
    for (channel, stored) in [128.0, 128.0, 255.0].into_iter().enumerate() {
        assert!((image.sample(4, 3, channel) - stored).abs() <= 3.0);
    }
}

#[test]
fn sixteen_bits_stay_sixteen_bits() {
    let image = image::ImageBuffer::from_raw(WIDTH as u32, HEIGHT as u32, colors16()).unwrap();
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        let read = decode_bytes(
            "map",
            &encoded(&DynamicImage::ImageRgb16(image.clone()), format),
        )
        .unwrap();
        assert_eq!(
            (read.depth, &read.samples),
            (SampleDepth::Bits16, &Samples::U16(colors16()))
        );
        assert_eq!(read.depth.label(), "16-bit");
    }
}

#[test]
fn float_formats_keep_their_values() {
    // Radiance shares one exponent among the channels: powers of two below one are exact.
    let values: Vec<f32> = (0..WIDTH * HEIGHT * 3)
        .map(|index| 1.0 / (1 << (index % 4)) as f32)
        .collect();
    let image = image::Rgb32FImage::from_raw(WIDTH as u32, HEIGHT as u32, values.clone()).unwrap();
    for format in [ImageFormat::Hdr, ImageFormat::Tiff] {
        let read = decode_bytes(
            "map",
            &encoded(&DynamicImage::ImageRgb32F(image.clone()), format),
        )
        .unwrap();
        assert_eq!(
            (read.depth, &read.samples),
            (SampleDepth::Float, &Samples::F32(values.clone())),
            "{format:?}"
        );
    }
}

#[test]
fn openexr_keeps_half_and_float_and_the_order_of_the_channels() {
    for (half, depth) in [(true, SampleDepth::Half), (false, SampleDepth::Float)] {
        let read = decode_bytes("map.exr", &exr_with(&["R", "G", "B", "A", "Z"], half)).unwrap();
        assert_eq!((read.width, read.height, read.channels), (WIDTH, HEIGHT, 4));
        assert_eq!(
            (read.depth, read.has_alpha, read.format),
            (depth, true, "OpenEXR")
        );
        for (x, y, channel) in [(0, 0, 0), (4, 2, 1), (1, 1, 2), (3, 0, 3)] {
            assert_eq!(
                read.sample(x, y, channel),
                (10 * channel + y * WIDTH + x) as f64 / 64.0
            );
        }
    }
}

#[test]
fn openexr_layers_are_searched_for_colour_wherever_the_data_window_lies() {
    let depth = AnyChannels::sort(smallvec_of(AnyChannel::new(
        "Z",
        FlatSamples::F32(vec![9.0; 15]),
    )));
    let size = (WIDTH, HEIGHT);
    let first = Layer::new(
        size,
        LayerAttributes::named("depth"),
        Encoding::FAST_LOSSLESS,
        depth,
    );
    let color = |x: f32| {
        AnyChannel::new(
            "normal.X",
            FlatSamples::F32((0..15).map(|texel| x * texel as f32).collect()),
        )
    };
    let mut channels = smallvec_of(color(-0.01));
    channels.push(AnyChannel::new("normal.Y", FlatSamples::F32(vec![0.5; 15])));
    channels.push(AnyChannel::new(
        "normal.Z",
        FlatSamples::F32(vec![0.25; 15]),
    ));
    let mut attributes = LayerAttributes::named("normal");
    attributes.layer_position = Vec2(-7, 11);
    let second = Layer::new(
        size,
        attributes,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let window = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let image = Image::empty(window).with_layer(first).with_layer(second);
    let bytes = exr_bytes(|bytes| image.write().non_parallel().to_buffered(bytes).unwrap());
    let read = decode_bytes("map.exr", &bytes).unwrap();
    assert_eq!(
        (read.width, read.height, read.channels, read.has_alpha),
        (WIDTH, HEIGHT, 3, false)
    );
    assert_eq!(
        [0, 1, 2].map(|channel| read.sample(4, 2, channel)),
        [f64::from(-0.14_f32), 0.5, 0.25]
    );
}

fn smallvec_of(
    channel: AnyChannel<FlatSamples>,
) -> exr::prelude::SmallVec<[AnyChannel<FlatSamples>; 4]> {
    std::iter::once(channel).collect()
}

#[test]
fn an_openexr_of_x_and_y_alone_is_a_map_of_two_channels() {
    let folder = folder();
    let path = folder.path().join("two.exr");
    std::fs::write(&path, exr_with(&["X", "Y"], true)).unwrap();
    let map = NormalMap::read(&path, &MapOptions::default()).unwrap();
    // No sample is negative, so 0 to 1 is read as -1 to 1: texel 14 holds 14/64 and 24/64.
    let (x, y) = (-36.0 / 64.0, -16.0 / 64.0_f32);
    let expected = glam::Vec3::new(x, y, (1.0 - x * x - y * y).sqrt());
    assert!((map.normal(14).unwrap() - expected).length() < 1e-6);
}

#[test]
fn a_greyscale_file_opens_as_heights_where_asked() {
    let folder = folder();
    let path = folder.path().join("heights.png");
    let ramp = image::ImageBuffer::from_fn(8, 4, |x, _| image::Luma([x as u16 * 8192]));
    std::fs::write(
        &path,
        encoded(&DynamicImage::ImageLuma16(ramp), ImageFormat::Png),
    )
    .unwrap();
    let options = MapOptions {
        height_scale: Some(8.0),
        ..MapOptions::default()
    };
    let map = NormalMap::read(&path, &options).unwrap();
    // A step of 8192 of 65535 to a texel, times 8, is a slope of nearly 1 upwards to the right.
    let normal = map.normal(3).unwrap();
    assert!((normal.x / normal.z + 8.0 * 8192.0 / 65535.0).abs() < 1e-6 && normal.y == 0.0);
}

#[test]
fn a_single_texel_is_a_map() {
    let folder = folder();
    let path = folder.path().join("one.png");
    write_png_rgb8(&path, 1, 1, &[128, 128, 255]).unwrap();
    let map = NormalMap::read(&path, &MapOptions::default()).unwrap();
    assert_eq!((map.width, map.height, map.invalid), (1, 1, 0));
    assert_eq!(map.name(), "one.png");
}

#[test]
fn a_bundled_map_and_the_file_written_from_it_hold_the_same_normals() {
    let folder = folder();
    for sample in SAMPLES {
        let path = folder.path().join(sample.name);
        let made = sample.make(48);
        let Samples::U8(rgb) = &made.stored.samples else {
            panic!("a bundled map has 8 bits")
        };
        write_png_rgb8(&path, 48, 48, rgb).unwrap();
        let read = NormalMap::read(&path, &MapOptions::default()).unwrap();
        assert_eq!(
            (read.x, read.y, read.z),
            (made.x, made.y, made.z),
            "{}",
            sample.name
        );
    }
}

#[test]
fn what_is_written_is_read_back() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let read_back = |path: &PathBuf| -> RasterImage { read(path).unwrap() };
    let rgba: Vec<u8> = (0..WIDTH * HEIGHT * 4)
        .map(|index| (index * 3) as u8)
        .collect();
    write_png_rgba8(&path, WIDTH, HEIGHT, &rgba).unwrap();
    assert_eq!(read_back(&path).samples, Samples::U8(rgba));
    write_png_rgb16(&path, WIDTH, HEIGHT, &colors16()).unwrap();
    assert_eq!(read_back(&path).samples, Samples::U16(colors16()));
    assert_eq!(
        std::fs::read_dir(folder.path()).unwrap().count(),
        1,
        "nothing is left beside the file"
    );
}

#[test]
fn a_target_that_cannot_be_written_is_named_and_left_whole() {
    let folder = folder();
    let sentence = |path: &Path| {
        write_bytes_atomically(path, b"new")
            .unwrap_err()
            .to_string()
    };
    assert!(sentence(&folder.path().join("no/such/a.png")).ends_with("its folder does not exist"));
    assert!(sentence(folder.path()).ends_with("it is a folder"));

    let path = folder.path().join("kept.png");
    std::fs::write(&path, b"old").unwrap();
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    assert!(
        sentence(&path)
            .ends_with("kept.png' cannot be written: there is no permission to write there")
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"old");

    let error = write_png_rgb8(&path, 2, 2, &[0; 3])
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("3 samples do not make 2x2 texels"),
        "{error}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_called_by_name() {
    let error = write_bytes_atomically(Path::new("/dev/full"), b"new")
        .unwrap_err()
        .to_string();
    assert_eq!(error, "'/dev/full' cannot be written: the disk is full");
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_keeps_pointing_where_it_did() {
    let folder = folder();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    std::fs::write(&file, b"old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_bytes_atomically(&link, b"new").unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), b"new");
    assert!(link.symlink_metadata().unwrap().is_symlink());
}
