//! What is exported is read back by other readers than the program's own, and holds what it says.

use std::path::Path;

use exr::prelude::*;
use ndf_inspector::export::roughness::{Convention, Depth, RoughnessSettings, Spread};
use ndf_inspector::filter::PlainMip;
use ndf_inspector::normal_map::procedural;

use crate::cli::{assert_refused, folder, run, sample};

/// The channels of a part: name and samples.
type Channels = Vec<(String, Vec<f32>)>;

/// Every part of an OpenEXR file, by the `exr` crate's own reader: its name and channels.
fn parts(path: &Path) -> Vec<(String, Channels)> {
    let layers = read_all_flat_layers_from_file(path).expect("an OpenEXR file").layer_data;
    let channel = |channel: AnyChannel<FlatSamples>| {
        let samples = channel.sample_data.values_as_f32().collect();
        (channel.name.to_string(), samples)
    };
    let part = |layer: Layer<AnyChannels<FlatSamples>>| {
        let name = layer.attributes.layer_name.expect("a name").to_string();
        (name, layer.channel_data.list.into_iter().map(channel).collect())
    };
    layers.into_iter().map(part).collect()
}

#[test]
fn roughness_is_a_grey_png_per_level_or_one_openexr_file() {
    let folder = folder();
    sample(&folder, "bricks");
    let settings =
        RoughnessSettings { spread: Spread::Toksvig, convention: Convention::Perceptual, depth: Depth::Bits16 };
    let options = ["--spread", "toksvig", "--convention", "perceptual", "--bits", "16"];
    for output in ["rough.png", "rough.exr"] {
        let arguments = [&["export", "bricks.png", "roughness", "-o", output][..], &options].concat();
        let done = run(&folder, &arguments);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let mip = PlainMip::new(procedural::find("bricks").expect("a bundled map").make(64).into());
    let parts = parts(&folder.path().join("rough.exr"));
    assert_eq!(parts.len(), 7);
    for (level, (name, channels)) in parts.iter().enumerate() {
        assert_eq!((name.as_str(), channels[0].0.as_str()), (&*format!("level.{level:02}"), "Y"));
        let expected = settings.level(&mip, level);
        assert_eq!(channels[0].1, expected, "level {level}");
        let png = image::open(folder.path().join(format!("rough.level.{level:02}.png"))).expect("a picture");
        let image::DynamicImage::ImageLuma16(png) = png else { panic!("level {level} is not grey of 16 bits") };
        for (stored, value) in png.pixels().zip(&expected) {
            assert!((f32::from(stored[0]) / 65535.0 - value).abs() < 1e-5, "level {level}");
        }
    }
}

#[test]
fn slopes_are_two_layers_of_three_channels_whose_moments_are_those_of_the_normals() {
    let folder = folder();
    sample(&folder, "waves");
    let done = run(&folder, &["export", "waves.png", "slopes", "-o", "s.exr"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let parts = parts(&folder.path().join("s.exr"));
    let names: Vec<&str> = parts[0].1.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["mean.B", "mean.G", "mean.R", "moment.B", "moment.G", "moment.R"]);
    let map = procedural::find("waves").expect("a bundled map").make(64);
    let slope = |index: usize| (f64::from(map.x[index] / map.z[index]), f64::from(map.y[index] / map.z[index]));
    let mean =
        |of: &dyn Fn((f64, f64)) -> f64| (0..map.len()).map(|index| of(slope(index))).sum::<f64>() / map.len() as f64;
    let top = |channel: usize| f64::from(parts[6].1[channel].1[0]);
    let expected = [mean(&|b| b.1), mean(&|b| b.0), mean(&|b| b.0 * b.1), mean(&|b| b.1 * b.1), mean(&|b| b.0 * b.0)];
    for (channel, expected) in (1..).zip(expected) {
        // Levels are stored in f32, each the mean of the one below.
        assert!((top(channel) - expected).abs() < 1e-5, "{}: {} and {expected}", names[channel], top(channel));
    }
    let length = PlainMip::new(map.into()).levels[6][0].length();
    assert!((top(0) - f64::from(length)).abs() < 1e-6);
}

#[test]
fn the_shader_is_written_in_the_language_of_its_ending() {
    let folder = folder();
    sample(&folder, "waves");
    for (name, mark) in [("s.wgsl", "@fragment"), ("s.glsl", "#version 450"), ("s.hlsl", "SamplerState")] {
        let done = run(&folder, &["export", "waves.png", "shader", "-J", "3", "-o", name]);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let text = std::fs::read_to_string(folder.path().join(name)).expect("written");
        assert!(text.contains(mark) && text.contains("LOBES"), "{text}");
    }
    assert_refused(&run(&folder, &["export", "waves.png", "shader", "-o", "s.txt"]), "--language");
    assert_refused(&run(&folder, &["export", "waves.png", "roughness", "-o", "no/such/r.png"]), "r.level.00.png");
}
