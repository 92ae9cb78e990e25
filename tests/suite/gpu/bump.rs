//! Bump mapping on the adapter: its twin, and the pictures that know the surface itself.

use std::sync::Arc;

use glam::Vec3;
use ndf_inspector::filter::{LevelChoice, Method};
use ndf_inspector::image_io::{RasterImage, SampleDepth, Samples};
use ndf_inspector::normal_map::{Addressing, MapOptions, MapSource, NormalMap, SlopeKernel};
use ndf_inspector::reference::Picture;
use ndf_inspector::reference::bump_picture::{BumpPicture, BumpView};
use ndf_inspector::scene::bump::BumpRule;
use ndf_inspector::scene::{Shape, ShapeKind};

use super::Scene;
use super::twins::{assert_alike, assert_twins, differences, methods, on_adapter};

/// Heights of two waves.
fn heights() -> RasterImage {
    let size = 64;
    let wave = |i: usize, turns: f32| (turns * i as f32 / size as f32 * std::f32::consts::TAU).sin();
    let height = |texel: usize| 0.5 + 0.25 * wave(texel % size, 1.0) + 0.25 * wave(texel / size + texel % size, 2.0);
    RasterImage {
        width: size,
        height: size,
        channels: 1,
        has_alpha: false,
        samples: Samples::F32((0..size * size).map(height).collect()),
        depth: SampleDepth::Float,
        format: "test",
        tagged_srgb: false,
    }
}

fn scene(kind: ShapeKind, rule: Option<BumpRule>, bump_scale: f32) -> Scene {
    let options = MapOptions { height_scale: Some(12.0), ..MapOptions::default() };
    let map = NormalMap::from_image(heights(), MapSource::Bundled("waves"), &options).expect("heights");
    let mut scene = Scene::new(Arc::new(map), 4);
    let shape = Shape { tiling: [4.0, 2.0], radii: [0.75, 0.2], shear: 0.2, ..Shape::of_kind(kind) };
    scene.surface.shape = Shape { bump: rule, bump_scale, mirrored: kind == ShapeKind::Sphere, ..shape };
    scene
}

const KINDS: [ShapeKind; 4] = [ShapeKind::Plane, ShapeKind::Sphere, ShapeKind::Torus, ShapeKind::MonkeySaddle];

#[test]
fn both_normals_have_twins_on_every_parametric_surface() {
    for (kind, rule) in KINDS.into_iter().flat_map(|kind| [(kind, BumpRule::Blinn), (kind, BumpRule::Exact)]) {
        let scene = scene(kind, Some(rule), 0.08);
        for method in [Method::Truth, Method::MIP, Method::Vmf] {
            assert_twins(&scene, method, &format!("{method} of {rule:?} on {kind:?}"));
        }
    }
    for method in methods() {
        let scene = scene(ShapeKind::Torus, Some(BumpRule::Exact), 0.08);
        assert_twins(&scene, method, &format!("{method} of a bumped torus"));
    }
}

/// The picture that takes curvature, heights and slopes from the surface itself, at every pixel.
fn by_the_surface(scene: &Scene, rule: BumpRule) -> Picture {
    let surface = &scene.surface;
    let picture = BumpPicture {
        surface,
        heights: &scene.map().stored,
        scale: surface.shape.bump_scale.into(),
        kernel: SlopeKernel::Central,
        addressing: Addressing::Wrap,
        view: BumpView::Lit(rule),
        needles: 0,
    };
    let texels = picture.draw(scene.size).rgba;
    let linear = |code: u8| ndf_inspector::color::linear_from_srgb(f32::from(code) / 255.0);
    Picture {
        size: scene.size,
        rgb: texels.chunks_exact(4).map(|t| Vec3::new(linear(t[0]), linear(t[1]), linear(t[2]))).collect(),
        covered: texels.chunks_exact(4).map(|texel| texel[3] > 0).collect(),
    }
}

#[test]
fn the_adapters_normals_are_those_of_the_surface_itself() {
    for (kind, rule) in KINDS.into_iter().flat_map(|kind| [(kind, BumpRule::Blinn), (kind, BumpRule::Exact)]) {
        let mut scene = scene(kind, Some(rule), 0.04);
        // Both read base texels alone; between texels one blends normals, the other slopes.
        scene.surface.level = LevelChoice::Fixed(0.0);
        scene.surface.material.specular = 0.0;
        let apart = differences(&on_adapter(&scene, Method::MIP), &by_the_surface(&scene, rule));
        let seen = apart.iter().filter(|&&codes| codes < 255).count();
        let mean = apart.iter().filter(|&&codes| codes < 255).map(|&codes| f64::from(codes)).sum::<f64>() / seen as f64;
        let far = apart.iter().filter(|&&codes| (6..255).contains(&codes)).count();
        println!("{rule:?} on {kind:?}: {mean:.2} codes apart on the mean, {far} of {seen} pixels by more than 5");
        assert!(mean < 0.3 && 200 * far < seen, "{rule:?} on {kind:?}: {mean}, {far}");
    }
}

#[test]
fn both_normals_part_on_a_thin_torus_and_not_on_a_plane() {
    let picture = |kind, rule| on_adapter(&scene(kind, Some(rule), 0.12), Method::Truth);
    let both = |kind| [BumpRule::Blinn, BumpRule::Exact].map(|rule| picture(kind, rule));
    let [blinn, exact] = both(ShapeKind::Plane);
    assert_alike(&blinn, &exact, "on a plane");
    let [blinn, exact] = both(ShapeKind::Torus);
    let apart = differences(&blinn, &exact).into_iter().filter(|&codes| codes > 8).count();
    assert!(apart > 500, "{apart} pixels");
    let as_normals = on_adapter(&scene(ShapeKind::Torus, None, 0.12), Method::Truth);
    assert!(differences(&as_normals, &exact).into_iter().filter(|&codes| codes > 8).count() > 500);
}
