//! Colour is fitted along: each lobe carries the colour of the normals that it stands for.

use std::sync::Arc;

use glam::{Mat3, Vec2, Vec3};
use ndf_inspector::brdf::Material;
use ndf_inspector::export::lobes_exr::{FittedLobes, read_bytes, write};
use ndf_inspector::filter::vmf::{Alignment, FitSettings, Fold, LobePyramid, Objective, Rules};
use ndf_inspector::filter::{Filter, LocalLight, Lookup, PixelFootprint, PlainMip, Truth, VmfFilter};
use ndf_inspector::normal_map::pyramid::Texel;
use ndf_inspector::normal_map::{Addressing, MapOptions, MapSource, NormalMap};

use crate::fit::fitted;
use crate::gpu::maps::{map, noise, rough, with_color};

pub const RED: Vec3 = Vec3::new(0.8, 0.1, 0.05);
pub const BLUE: Vec3 = Vec3::new(0.05, 0.2, 0.9);

/// Grooves whose sides face right, in red, and left, in blue; noise on the normals keeps the sides lobes with a width.
pub fn groove() -> Arc<NormalMap> {
    let rising = |x: usize| x % 8 < 4;
    let normals = map(32, 32, Addressing::Wrap, |x, y| {
        let wobble = |seed: usize| 0.1 * (noise(seed + 2 * (y * 32 + x)) - 0.5);
        Vec3::new(if rising(x) { 0.6 } else { -0.6 } + wobble(0), wobble(1), 0.8)
    });
    with_color(normals, |index| if rising(index % 32) { RED } else { BLUE })
}

pub fn settings(lobes: usize, align: Alignment) -> FitSettings {
    FitSettings { lobes, align, ..FitSettings::default() }
}

/// The whole map seen from one side, lit from there too.
fn seen_from(filter: &dyn Filter, side: f32) -> Vec3 {
    let direction = Vec3::new(side * 0.7, 0.0, 0.714).normalize();
    let light = LocalLight { light_in_tangent: direction, half_in_tangent: direction };
    let footprint = PixelFootprint { dx: Vec2::X, dy: Vec2::Y, ..PixelFootprint::default() };
    let lookup = Lookup { uv: Vec2::splat(0.5), footprint, lod: 5.0, pixel: [3, 4], tangent_from_map: Mat3::IDENTITY };
    let white = Material { diffuse_color: Vec3::ONE, specular_color: Vec3::ONE, ..Material::default() };
    filter.shade(&lookup, &light, &white)
}

fn vmf(lobes: LobePyramid) -> VmfFilter {
    VmfFilter { lobes: Arc::new(lobes), fold: Fold::default(), rules: Rules::default() }
}

#[test]
fn a_two_colour_groove_keeps_each_sides_colour() {
    let map = groove();
    let truth = Truth { map: Arc::clone(&map), samples: 65536 };
    let plain = PlainMip::new(Arc::clone(&map));
    for align in [Alignment::None, Alignment::default()] {
        let filter = vmf(fitted(&map, &settings(2, align)));
        for (side, color) in [(1.0, RED), (-1.0, BLUE)] {
            let (expected, found) = (seen_from(&truth, side), seen_from(&filter, side));
            let error = (found - expected).length() / expected.length();
            assert!(error < 0.02, "{align}, side {side}: {found} for {expected}");
            let hue = |seen: Vec3| seen.normalize().dot(color.normalize());
            assert!(hue(found) > 0.99, "{align}, side {side}: {found} is not like {color}");
            assert!(hue(seen_from(&plain, side)) < 0.9, "the averaged normal mixes the sides");
        }
    }
}

#[test]
fn each_lobe_of_a_groove_has_its_sides_colour() {
    let map = groove();
    for align in [Alignment::None, Alignment::default()] {
        let lobes = fitted(&map, &settings(2, align));
        for texel in [Texel { level: 5, x: 0, y: 0 }, Texel { level: 3, x: 1, y: 2 }] {
            for (slot, lobe) in lobes.mixture(texel).expect("fitted").lobes {
                let color = lobes.lobe_color(texel, slot).expect("coloured");
                let side = if lobe.mean_direction.x > 0.0 { RED } else { BLUE };
                assert!((color - side).length() < 1e-3, "{align}, {texel}: {color} for {side}");
            }
        }
    }
}

#[test]
fn the_lobes_colours_sum_to_the_mean_colour() {
    let map = with_color(rough(21, 13, Addressing::Clamp), |index| Vec3::new(noise(index), noise(index + 5), 0.5));
    let settings = FitSettings { objective: Objective::Em, ..settings(4, Alignment::None) };
    let lobes = fitted(&map, &settings);
    let mip = PlainMip::new(Arc::clone(&map));
    for level in 1..lobes.levels() {
        for (texel, stored) in lobes.colors[level - 1].as_ref().expect("coloured").stored.chunks(4).enumerate() {
            let sum: Vec3 = stored.iter().map(|&color| Vec3::from(color)).sum();
            // Weights are one E-step behind the responsibilities, hence no closer; invalid texels have no lobe.
            assert!((sum - mip.colors[level][texel]).length() < 0.02, "level {level}, texel {texel}: {sum}");
        }
    }
}

#[test]
fn doubled_colours_double_every_lobes_colour_and_change_no_lobe() {
    let color = |index: usize| Vec3::new(noise(index), noise(index + 1), noise(index + 2));
    let fit = |factor: f32| {
        let map = with_color(rough(16, 16, Addressing::Wrap), |index| factor * color(index));
        fitted(&map, &settings(3, Alignment::default()))
    };
    let (once, twice) = (fit(1.0), fit(2.0));
    assert_eq!(once.coarse, twice.coarse);
    for (once, twice) in once.colors.iter().flatten().zip(twice.colors.iter().flatten()) {
        let doubled: Vec<f32> = once.stored.as_flattened().iter().map(|value| 2.0 * value).collect();
        assert_eq!(doubled, twice.stored.as_flattened());
    }
}

#[test]
fn a_white_map_shades_as_one_without_colour() {
    let plain = rough(16, 16, Addressing::Wrap);
    let white = with_color(Arc::clone(&plain), |_| Vec3::ONE);
    let settings = settings(3, Alignment::default());
    let [plain, white] = [plain, white].map(|map| seen_from(&vmf(fitted(&map, &settings)), 1.0));
    assert!((plain - white).length() < 1e-5 * plain.length(), "{white} for {plain}");
}

#[test]
fn colours_come_back_from_a_file_bit_for_bit() {
    let map = with_color(rough(24, 10, Addressing::Wrap), |index| Vec3::new(noise(index), 7.5 * noise(index + 1), 0.0));
    let settings = settings(3, Alignment::default());
    let lobes = Arc::new(fitted(&map, &settings));
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lobes.exr");
    write(&path, &FittedLobes { lobes: Arc::clone(&lobes), settings, stats: Vec::new() }).expect("written");
    let bytes = std::fs::read(&path).expect("there");
    let source = MapSource::File(path);
    let read = read_bytes(&bytes, source, &MapOptions::default()).expect("whole").expect("lobes").lobes;
    assert_eq!(read.colors, lobes.colors);
    // An invalid texel has no lobe, hence no colour.
    for index in (0..map.len()).filter(|&index| map.normal(index).is_some()) {
        assert_eq!(read.map.color(index), map.color(index));
    }
}
