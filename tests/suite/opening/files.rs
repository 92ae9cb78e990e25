//! Small images made for the tests, as the bytes of a file.

use std::io::Cursor;

use exr::prelude::*;
use image::{DynamicImage, ImageFormat};
use tempfile::TempDir;

/// A size that is no power of two.
pub(super) const WIDTH: usize = 5;
pub(super) const HEIGHT: usize = 3;

pub(super) fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub(super) fn colors8() -> Vec<u8> {
    (0..WIDTH * HEIGHT * 3).map(|index| (index * 37 % 256) as u8).collect()
}

pub(super) fn colors16() -> Vec<u16> {
    (0..WIDTH * HEIGHT * 3).map(|index| (index * 1409 + 3) as u16).collect()
}

/// `colors8` as a file of `format`.
pub(super) fn encoded8(format: ImageFormat) -> Vec<u8> {
    let image = image::RgbImage::from_raw(WIDTH as u32, HEIGHT as u32, colors8()).unwrap();
    encoded(&DynamicImage::ImageRgb8(image), format)
}

pub(super) fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

pub(super) fn exr_bytes(write: impl FnOnce(&mut Cursor<Vec<u8>>)) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(&mut bytes);
    bytes.into_inner()
}

/// An OpenEXR file with one layer of the named channels, sample `10 * channel + texel` in each.
pub fn exr_with(names: &[&str], half: bool) -> Vec<u8> {
    let values = |channel: usize| (0..WIDTH * HEIGHT).map(move |texel| (10 * channel + texel) as f32 / 64.0);
    let channel = |(index, name): (usize, &&str)| {
        let samples = if half {
            FlatSamples::F16(values(index).map(f16::from_f32).collect())
        } else {
            FlatSamples::F32(values(index).collect())
        };
        AnyChannel::new(*name, samples)
    };
    let channels = AnyChannels::sort(names.iter().enumerate().map(channel).collect());
    let layer = Layer::new((WIDTH, HEIGHT), LayerAttributes::named("only"), Encoding::FAST_LOSSLESS, channels);
    exr_bytes(|bytes| Image::from_layer(layer).write().non_parallel().to_buffered(bytes).unwrap())
}
