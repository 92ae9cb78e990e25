//! Every format keeps its samples at the depth they are stored in.

use exr::prelude::*;
use image::{DynamicImage, ImageFormat};
use ndf_inspector::image_io::{SampleDepth, Samples, decode_bytes, write_png_rgb8};
use ndf_inspector::normal_map::procedural::SAMPLES;
use ndf_inspector::normal_map::{MapOptions, NormalMap};

use super::files::{HEIGHT, WIDTH, colors8, colors16, encoded, encoded8, exr_bytes, exr_with, folder};

#[test]
fn eight_bit_formats_keep_every_sample() {
    use ImageFormat::{Bmp, Png, Tga, Tiff, WebP};
    let names = ["PNG", "TGA", "BMP", "TIFF", "WebP"];
    for (format, name) in [Png, Tga, Bmp, Tiff, WebP].into_iter().zip(names) {
        let image = decode_bytes("map.tga", &encoded8(format)).unwrap();
        assert_eq!((image.width, image.height, image.channels, image.format), (WIDTH, HEIGHT, 3, name));
        assert_eq!((image.depth, &image.samples), (SampleDepth::Bits8, &Samples::U8(colors8())), "{name}");
    }
}

#[test]
fn jpeg_is_read_near_its_samples() {
    let flat = image::RgbImage::from_pixel(9, 7, image::Rgb([128, 128, 255]));
    let image = decode_bytes("map.jpg", &encoded(&DynamicImage::ImageRgb8(flat), ImageFormat::Jpeg)).unwrap();
    assert_eq!((image.width, image.height, image.depth), (9, 7, SampleDepth::Bits8));
    // Lossy: a flat colour comes back within the rounding of its colour transform.
    for (channel, stored) in [128.0, 128.0, 255.0].into_iter().enumerate() {
        assert!((image.sample(4, 3, channel) - stored).abs() <= 3.0);
    }
}

#[test]
fn sixteen_bits_stay_sixteen_bits() {
    let image = image::ImageBuffer::from_raw(WIDTH as u32, HEIGHT as u32, colors16()).unwrap();
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        let read = decode_bytes("map", &encoded(&DynamicImage::ImageRgb16(image.clone()), format)).unwrap();
        assert_eq!((read.depth, &read.samples), (SampleDepth::Bits16, &Samples::U16(colors16())));
        assert_eq!(read.depth.label(), "16-bit");
    }
}

#[test]
fn float_formats_keep_their_values() {
    // Radiance shares one exponent among the channels: powers of two below one are exact.
    let values: Vec<f32> = (0..WIDTH * HEIGHT * 3).map(|index| 1.0 / (1 << (index % 4)) as f32).collect();
    let image = image::Rgb32FImage::from_raw(WIDTH as u32, HEIGHT as u32, values.clone()).unwrap();
    for format in [ImageFormat::Hdr, ImageFormat::Tiff] {
        let read = decode_bytes("map", &encoded(&DynamicImage::ImageRgb32F(image.clone()), format)).unwrap();
        assert_eq!((read.depth, &read.samples), (SampleDepth::Float, &Samples::F32(values.clone())), "{format:?}");
    }
}

#[test]
fn openexr_keeps_half_and_float_and_the_order_of_the_channels() {
    for (half, depth) in [(true, SampleDepth::Half), (false, SampleDepth::Float)] {
        let read = decode_bytes("map.exr", &exr_with(&["R", "G", "B", "A", "Z"], half)).unwrap();
        assert_eq!((read.width, read.height, read.channels), (WIDTH, HEIGHT, 4));
        assert_eq!((read.depth, read.has_alpha, read.format), (depth, true, "OpenEXR"));
        for (x, y, channel) in [(0, 0, 0), (4, 2, 1), (1, 1, 2), (3, 0, 3)] {
            assert_eq!(read.sample(x, y, channel), (10 * channel + y * WIDTH + x) as f64 / 64.0);
        }
    }
}

#[test]
fn openexr_layers_are_searched_for_colour_wherever_the_data_window_lies() {
    let depth = AnyChannels::sort(smallvec_of(AnyChannel::new("Z", FlatSamples::F32(vec![9.0; 15]))));
    let size = (WIDTH, HEIGHT);
    let first = Layer::new(size, LayerAttributes::named("depth"), Encoding::FAST_LOSSLESS, depth);
    let color = |x: f32| AnyChannel::new("normal.X", FlatSamples::F32((0..15).map(|texel| x * texel as f32).collect()));
    let mut channels = smallvec_of(color(-0.01));
    channels.push(AnyChannel::new("normal.Y", FlatSamples::F32(vec![0.5; 15])));
    channels.push(AnyChannel::new("normal.Z", FlatSamples::F32(vec![0.25; 15])));
    let mut attributes = LayerAttributes::named("normal");
    attributes.layer_position = Vec2(-7, 11);
    let second = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let window = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let image = Image::empty(window).with_layer(first).with_layer(second);
    let bytes = exr_bytes(|bytes| image.write().non_parallel().to_buffered(bytes).unwrap());
    let read = decode_bytes("map.exr", &bytes).unwrap();
    assert_eq!((read.width, read.height, read.channels, read.has_alpha), (WIDTH, HEIGHT, 3, false));
    assert_eq!([0, 1, 2].map(|channel| read.sample(4, 2, channel)), [f64::from(-0.14_f32), 0.5, 0.25]);
}

fn smallvec_of(channel: AnyChannel<FlatSamples>) -> exr::prelude::SmallVec<[AnyChannel<FlatSamples>; 4]> {
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
    std::fs::write(&path, encoded(&DynamicImage::ImageLuma16(ramp), ImageFormat::Png)).unwrap();
    let options = MapOptions { height_scale: Some(8.0), ..MapOptions::default() };
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
        let Samples::U8(rgb) = &made.stored.samples else { panic!("a bundled map has 8 bits") };
        write_png_rgb8(&path, 48, 48, rgb).unwrap();
        let read = NormalMap::read(&path, &MapOptions::default()).unwrap();
        assert_eq!((read.x, read.y, read.z), (made.x, made.y, made.z), "{}", sample.name);
    }
}
