//! The laws of decoding.

use glam::Vec3;

use super::*;
use crate::image_io::{SampleDepth, Samples};
use crate::normal_map::procedural;

fn image(width: usize, channels: usize, samples: Samples) -> RasterImage {
    let height = samples.len() / channels / width;
    RasterImage {
        width,
        height,
        channels,
        has_alpha: channels == 4,
        samples,
        depth: SampleDepth::Bits8,
        format: "test",
        tagged_srgb: false,
    }
}

fn rgb8(width: usize, values: &[u8]) -> RasterImage {
    image(width, 3, Samples::U8(values.to_vec()))
}

fn decode(image: RasterImage, options: &MapOptions) -> Result<NormalMap, DecodeError> {
    NormalMap::from_image(image, MapSource::Bundled("test"), options)
}

fn plain(image: RasterImage) -> NormalMap {
    decode(image, &MapOptions::default()).unwrap()
}

#[test]
fn the_nearest_8_bit_code_to_flat_leans_a_third_of_a_degree() {
    let normal = plain(rgb8(1, &[128, 128, 255])).normal(0).unwrap();
    let lean = normal.x.hypot(normal.y).atan2(normal.z).to_degrees();
    assert!((lean - 0.3177).abs() < 1e-3, "{lean}");
    assert!(normal.x > 0.0 && normal.y > 0.0);
}

#[test]
fn every_valid_normal_has_unit_length() {
    let values: Vec<u8> = (0..3000_u32).map(|index| (index * 7919 % 251) as u8).collect();
    let map = plain(rgb8(50, &values));
    let unit = |index| map.normal(index).is_none_or(|normal: Vec3| (normal.length() - 1.0).abs() < 1e-6);
    assert!((0..map.len()).all(unit));
}

#[test]
fn sixteen_bits_are_not_rounded_to_eight() {
    let flat = plain(image(1, 3, Samples::U16(vec![32768, 32768, 65535]))).normal(0).unwrap();
    assert!(flat.x > 1e-5 && flat.x < 2e-5);
    let next = plain(image(1, 3, Samples::U16(vec![32769, 32768, 65535]))).normal(0).unwrap();
    assert!(next.x > flat.x);
}

#[test]
fn black_short_and_non_finite_texels_are_left_out_and_counted() {
    let map = plain(rgb8(3, &[0, 0, 0, 128, 127, 128, 128, 128, 255]));
    assert_eq!((map.invalid, map.normal(0), map.normal(1)), (2, None, None));
    assert_eq!(map.warnings, [Warning::InvalidTexels { count: 2, total: 3 }]);
    let map = plain(image(2, 3, Samples::F32(vec![f32::NAN, 0.5, 1.0, 0.5, 0.5, 1.0])));
    assert_eq!((map.invalid, map.normal(1)), (1, Some(Vec3::Z)));
}

#[test]
fn a_green_channel_that_points_down_negates_y() {
    let samples = [128, 200, 220];
    let up = plain(rgb8(1, &samples)).normal(0).unwrap();
    let options = MapOptions { green: GreenChannel::Down, ..MapOptions::default() };
    let down = decode(rgb8(1, &samples), &options).unwrap().normal(0).unwrap();
    assert_eq!(down, Vec3::new(up.x, -up.y, up.z));
}

#[test]
fn two_channels_give_z_on_the_upper_hemisphere() {
    let options = MapOptions { two_channel: true, ..MapOptions::default() };
    let normal = decode(rgb8(1, &[204, 128, 0]), &options).unwrap().normal(0).unwrap();
    let (x, y) = (0.6, 1.0 / 255.0_f32);
    assert!((normal - Vec3::new(x, y, (1.0 - x * x - y * y).sqrt())).length() < 1e-6);
    let beyond = decode(rgb8(1, &[255, 255, 0]), &options).unwrap().normal(0).unwrap();
    assert!((beyond - Vec3::new(0.5_f32.sqrt(), 0.5_f32.sqrt(), 0.0)).length() < 1e-6);
}

#[test]
fn an_image_of_two_colour_channels_needs_no_option() {
    let mut two = image(1, 2, Samples::F32(vec![-0.6, 0.0]));
    two.depth = SampleDepth::Half;
    assert!((plain(two).normal(0).unwrap() - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
}

#[test]
fn floats_are_signed_where_one_is_negative() {
    let signed = plain(image(2, 3, Samples::F32(vec![-0.6, 0.0, 0.8, 0.0, 0.0, 1.0])));
    assert!((signed.normal(0).unwrap() - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
    assert_eq!(signed.warnings, [Warning::FloatsTakenAsSigned]);
    let unsigned = plain(image(1, 3, Samples::F32(vec![0.2, 0.5, 0.9])));
    assert!((unsigned.normal(0).unwrap() - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
    assert_eq!(unsigned.warnings, [Warning::FloatsTakenAsUnsigned]);
}

#[test]
fn a_greyscale_image_is_refused_and_the_way_to_read_it_named() {
    for grey in [image(2, 1, Samples::U8(vec![10, 200])), rgb8(2, &[10, 10, 10, 200, 200, 200])] {
        let error = decode(grey.clone(), &MapOptions::default()).unwrap_err();
        assert!(matches!(error, DecodeError::Greyscale { .. }));
        assert!(error.to_string().contains("--height SCALE"));
        let options = MapOptions { height_scale: Some(1.0), ..MapOptions::default() };
        assert!(decode(grey, &options).is_ok());
    }
}

#[test]
fn a_normal_map_that_is_mostly_black_is_not_greyscale() {
    let mut values = vec![0_u8; 3000];
    values[..3].copy_from_slice(&[128, 128, 255]);
    let map = plain(rgb8(100, &values));
    assert_eq!(map.invalid, 999);
}

#[test]
fn a_black_image_is_refused() {
    let error = decode(rgb8(2, &[0; 12]), &MapOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "'test' is black all over and holds no normals");
}

#[test]
fn a_colour_image_read_as_heights_says_so() {
    let options = MapOptions { height_scale: Some(1.0), ..MapOptions::default() };
    let map = decode(rgb8(2, &[1, 2, 3, 4, 5, 6]), &options).unwrap();
    assert_eq!(map.warnings, [Warning::HeightsFromColor]);
}

#[test]
fn alpha_that_varies_is_noted_and_constant_alpha_is_not() {
    let with = |alpha| plain(image(2, 4, Samples::U8(vec![128, 128, 255, 255, 128, 128, 255, alpha]))).warnings;
    assert_eq!(with(7), [Warning::AlphaVaries]);
    assert!(with(255).is_empty());
}

#[test]
fn the_green_convention_is_found_by_the_curl_of_the_slopes() {
    for sample in
        procedural::SAMPLES.iter().filter(|sample| ["bricks", "waves", "scales", "plate"].contains(&sample.name))
    {
        let map = sample.make(64);
        let options = MapOptions { green: GreenChannel::Auto, ..MapOptions::default() };
        let read = |image: RasterImage| NormalMap::from_image(image, MapSource::Bundled("test"), &options);
        let up = read(map.stored.as_ref().clone()).expect("a normal map");
        assert_eq!((up.options.green, &up.y), (GreenChannel::Up, &map.y), "{}", sample.name);
        let mut flipped = map.stored.as_ref().clone();
        if let Samples::U8(bytes) = &mut flipped.samples {
            bytes.iter_mut().skip(1).step_by(3).for_each(|green| *green = 255 - *green);
        }
        let down = read(flipped).expect("a normal map");
        assert_eq!((down.options.green, &down.y), (GreenChannel::Down, &map.y), "{}", sample.name);
    }
}

#[test]
fn opposite_values_are_opposite_components_to_the_bit() {
    let of = |values: Vec<u8>| plain(rgb8(1, &values));
    let straight = of((1..=254).flat_map(|c| [c, 255 - c / 2, 200]).collect());
    let opposite = of((1..=254).flat_map(|c| [255 - c, c / 2, 200]).collect());
    let negative = |values: &[f32]| values.iter().map(|value| -value).collect::<Vec<f32>>();
    assert_eq!(opposite.x, negative(&straight.x));
    assert_eq!(opposite.y, negative(&straight.y));
    assert_eq!(opposite.z, straight.z);
}
