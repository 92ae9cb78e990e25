//! Light from everywhere: its twins, its laws, and the sky behind the surface.

use std::sync::Arc;

use glam::Vec3;
use ndf_inspector::filter::vmf::Alignment;
use ndf_inspector::filter::{LevelChoice, Method, Rival, Truth};
use ndf_inspector::gpu::SurfaceFrame;
use ndf_inspector::gpu::{FrameBudget, PICTURE_FORMAT};
use ndf_inspector::lighting::environment::LatLong;
use ndf_inspector::lighting::{Environment, Light, Lights, ProceduralSky, Sky, SkySource};
use ndf_inspector::normal_map::Addressing;
use ndf_inspector::reference::{self, ExactCoverage, normalised_color_error};
use ndf_inspector::scene::{Shape, ShapeKind};

use super::twins::{assert_alike, assert_twins, methods, on_adapter, on_processor};
use super::{Scene, gpu, maps};
use crate::color::settings;
use crate::fit::fitted;

const GRID: LatLong = LatLong { width: 32, height: 16 };

/// A sky of these colours.
fn sky(color: impl Fn(glam::DVec3) -> Vec3) -> Sky {
    let radiance = GRID.texels().map(|(direction, ..)| color(direction)).collect();
    let source = SkySource::Bundled(ProceduralSky::Studio);
    let environment = Environment::new(source, GRID.width, radiance).expect("a sky");
    Sky { environment: Some(Arc::new(environment)), is_seen: false, ..Sky::default() }
}

/// Coloured, brighter above, with a window that is much brighter.
pub(super) fn uneven() -> Sky {
    sky(|direction| {
        let window = direction.dot(glam::DVec3::new(-0.4, 0.5, 0.7)) > 0.9;
        Vec3::new(0.3, 0.4, 0.5) * (1.2 + direction.z as f32)
            + if window { Vec3::new(4.0, 3.0, 2.0) } else { Vec3::ZERO }
    })
}

fn scene(map: Arc<ndf_inspector::normal_map::NormalMap>, sky: Sky) -> Scene {
    let mut scene = Scene::new(map, 6);
    (scene.surface.lights, scene.surface.sky) = (Lights::NONE, sky);
    scene
}

#[test]
fn every_method_has_a_twin_under_a_sky() {
    for (kind, rotation_deg, last_band) in [(ShapeKind::Torus, 70.0, 8), (ShapeKind::Plane, -20.0, 12)] {
        let map = maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color);
        let sky = Sky { rotation_deg, last_band, intensity: 0.8, ..uneven() };
        let mut scene = scene(map, sky);
        scene.size = [96, 72];
        scene.surface.shape = Shape { tiling: [2.0, 2.0], ..Shape::of_kind(kind) };
        for method in methods() {
            assert_twins(&scene, method, &format!("{method} of a {kind:?} under a sky"));
        }
    }
}

#[test]
fn sky_and_lights_together_have_a_twin() {
    let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 6);
    scene.surface.sky = Sky { intensity: 0.3, ..uneven() };
    for method in [Method::MIP, Method::Vmf] {
        assert_twins(&scene, method, &format!("{method} under sky and light"));
    }
}

/// A bundled sky that lights and is not seen.
fn bundled(made: ProceduralSky) -> Sky {
    let environment = Some(Arc::new(SkySource::Bundled(made).load().expect("a sky")));
    Sky { environment, is_seen: false, ..Sky::default() }
}

#[test]
fn the_sun_has_a_twin_by_every_method_beside_eight_lights_too() {
    let mut scene = scene(maps::rough(64, 64, Addressing::Wrap), bundled(ProceduralSky::Clear));
    (scene.size, scene.surface.shape) = ([64, 48], Shape::of_kind(ShapeKind::Torus));
    scene.surface.sky.rotation_deg = 70.0;
    for method in methods() {
        assert_twins(&scene, method, &format!("{method} under a sun"));
    }
    let light = |index: u8| Light { azimuth_deg: 40.0 * f32::from(index), intensity: 0.2, ..Light::DEFAULT };
    let eight: Vec<Light> = (0..8).map(light).collect();
    scene.surface.lights = eight.as_slice().try_into().expect("eight at most");
    for method in [Method::Vmf, Method::Truth] {
        assert_twins(&scene, method, &format!("{method} under a sun and eight lights"));
    }
}

#[test]
fn a_sun_that_is_a_light_is_much_nearer_the_truth_than_one_in_the_bands_and_lights_diffusely_alike() {
    // Smooth, so that the truth's samples scatter little.
    let waves = maps::map(64, 64, Addressing::Wrap, |x, y| {
        Vec3::new(0.3 * (x as f32 * 0.4).sin(), 0.2 * (y as f32 * 0.6).cos(), 1.0)
    });
    let mut scene = scene(waves, bundled(ProceduralSky::Clear));
    (scene.size, scene.surface.shape) = ([96, 72], Shape::of_kind(ShapeKind::Sphere));
    scene.surface.camera.distance = 4.0;
    scene.lobes = fitted(scene.map(), &settings(6, Alignment::default()));
    let mut pictures = |specular: f32, is_sun_apart: bool| {
        (scene.surface.material.specular, scene.surface.material.diffuse) = (specular, 1.0 - specular);
        scene.surface.sky.is_sun_apart = is_sun_apart;
        [Method::Vmf, Method::Truth].map(|method| on_adapter(&scene, method))
    };
    let error = |[lobes, truth]: &[reference::Picture; 2]| reference::rmse(lobes, truth).expect("seen");
    let [apart, bands] = [true, false].map(|is_sun_apart| error(&pictures(1.0, is_sun_apart)));
    println!("specularly off by {apart:.4} apart, by {bands:.4} in the bands");
    assert!(apart < 0.3 * bands, "{apart} and {bands}");
    let [apart, bands] = [true, false].map(|is_sun_apart| pictures(0.0, is_sun_apart)[0].clone());
    assert_alike(&apart, &bands, "diffusely");
}

/// A rough map without an invalid texel.
fn valid() -> Arc<ndf_inspector::normal_map::NormalMap> {
    maps::map(64, 64, Addressing::Wrap, |x, y| {
        let noise = |seed| maps::noise(seed + 5 * (64 * y + x)) - 0.5;
        Vec3::new(0.8 * noise(0), 0.5 * noise(1) + 0.3 * (x as f32 * 0.4).sin(), 1.0)
    })
}

#[test]
fn under_a_constant_sky_every_method_shows_the_albedo_times_the_constant() {
    let constant = Vec3::new(0.5, 0.8, 1.1);
    let mut scene = scene(valid(), sky(|_| constant));
    scene.surface.material.specular = 0.0;
    scene.surface.shape.kind = ShapeKind::Sphere;
    let expected = scene.surface.material.diffuse * scene.surface.material.diffuse_color * constant;
    for method in methods().filter(|method| *method != Method::Rival(unnormalised())) {
        let picture = on_adapter(&scene, method);
        // The truth's samples scatter; all else rounds, weights of Gaussians and lobes in 16 bits where need be.
        let [tolerance, of_mean] = if method == Method::Truth { [0.3, 5e-3] } else { [2e-3, 2e-3] };
        let seen = (0..picture.rgb.len()).filter(|&index| picture.covered[index]);
        let worst = seen.clone().map(|i| (picture.rgb[i] - expected).length() / expected.length()).fold(0.0, f32::max);
        let mean = seen.clone().map(|index| picture.rgb[index]).sum::<Vec3>() / seen.count() as f32;
        let mean = (mean - expected).length() / expected.length();
        println!("{method}: the mean is off by {mean:.1e}, the worst pixel by {worst:.1e}");
        assert!(worst < tolerance && mean < of_mean, "{method}: {worst}, on the mean {mean}");
    }
    // Its author's method darkens what is rough, under any light.
    scene.surface.level = LevelChoice::Fixed(6.0);
    let short = on_adapter(&scene, Method::Rival(unnormalised()));
    let length = scene.mip.levels[6][0].length();
    let index = (0..short.rgb.len()).find(|&index| short.covered[index]).expect("the sphere is seen");
    assert!((short.rgb[index] - length * expected).length() < 1e-3 && length < 0.98, "{length}");
}

fn unnormalised() -> Rival {
    Rival::parse("mip-unnormalised").expect("a rival")
}

#[test]
fn the_truth_under_a_sky_agrees_with_exact_coverage() {
    let map = maps::with_color(maps::rough(32, 20, Addressing::Wrap), maps::any_color);
    let mut scene = scene(map.clone(), uneven());
    scene.size = [32, 24];
    scene.surface.camera.distance = 6.0;
    let base = (map.width, map.height);
    let exact = reference::render(&scene.surface, &ExactCoverage { map: map.clone() }, scene.size, [0.0, 0.0], base);
    let sampled = |samples| {
        let truth = Truth { map: map.clone(), samples };
        let picture = reference::render(&scene.surface, &truth, scene.size, [0.0, 0.0], base);
        normalised_color_error(&picture, &exact).expect("the plane is seen")
    };
    let errors = [64, 1024].map(sampled);
    println!("off by {errors:?}");
    assert!(errors[1] < 0.04 && errors[1] < 0.5 * errors[0], "{errors:?}");
}

/// Lobes against the truth over a map that is minified, under each bundled sky.
#[test]
fn lobes_under_a_sky_are_nearer_the_truth_than_plain_mip() {
    let mut scene = scene(valid(), Sky::default());
    scene.surface.camera.distance = 12.0;
    scene.surface.shape.tiling = [8.0, 8.0];
    scene.lobes = fitted(scene.map(), &settings(6, Alignment::default()));
    for made in ProceduralSky::ALL {
        scene.surface.sky = bundled(made);
        let truth = on_adapter(&scene, Method::Truth);
        let error = |method| normalised_color_error(&on_adapter(&scene, method), &truth).expect("seen");
        let (lobes, mip) = (error(Method::Vmf), error(Method::MIP));
        println!("{}: lobes {lobes:.4}, plain mip {mip:.4}", made.name());
        assert!(lobes < mip, "{}: {lobes} and {mip}", made.name());
    }
}

#[test]
fn the_sky_is_seen_behind_the_surface_and_turns_with_it() {
    let mut scene = scene(maps::rough(16, 16, Addressing::Wrap), Sky { is_seen: true, ..uneven() });
    scene.surface.sky.rotation_deg = 33.0;
    (scene.surface.camera.elevation_deg, scene.surface.camera.field_of_view_deg) = (5.0, 70.0);
    let mut frame = SurfaceFrame::new(&gpu().device, PICTURE_FORMAT);
    frame.budget = FrameBudget { truth_limit: 1, truth_batch: 1, upload_bytes: 1 << 30 };
    frame.complete(gpu(), &scene.input(Method::MIP)).expect("the device works");
    let texels = frame.linear(&gpu().device, &gpu().queue, Method::MIP).expect("readable");
    let [width, height] = scene.size.map(|side| side as usize);
    let world_from_clip = scene.surface.camera.clip_from_world(width as f32 / height as f32).inverse();
    let mut behind = 0;
    for (index, texel) in texels.iter().enumerate().filter(|(_, texel)| texel[3] < 0.5) {
        let (x, y) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        let clip = Vec3::new(2.0 * x / width as f32 - 1.0, 1.0 - 2.0 * y / height as f32, 1.0);
        let direction = (world_from_clip.project_point3(clip) - scene.surface.camera.eye_in_world()).normalize();
        let expected = scene.surface.sky.seen(direction).expect("it is seen");
        assert!((Vec3::from_slice(&texel[..3]) - expected).length() < 2e-2, "{texel:?} for {expected} at {x}, {y}");
        behind += 1;
    }
    assert!(behind > 2000, "{behind} pixels beside the plane");
    let picture = frame.picture(gpu(), scene.size).expect("readable");
    assert!(picture[..4] != [36, 36, 36, 255] && picture[0] > 60, "the corner shows the sky: {:?}", &picture[..4]);
}

#[test]
fn a_sky_that_is_turned_with_the_camera_and_the_map_gives_the_same_picture() {
    let flat = maps::map(16, 16, Addressing::Wrap, |_, _| Vec3::Z);
    let turned = |turn: f32| {
        let mut scene = scene(flat.clone(), uneven());
        scene.surface.shape.kind = ShapeKind::Sphere;
        scene.surface.camera.azimuth_deg = turn;
        scene.surface.sky.rotation_deg = turn;
        scene
    };
    for method in [Method::Truth, Method::MIP] {
        // The sphere's poles stand on the axis of the turn.
        assert_alike(&on_adapter(&turned(0.0), method), &on_processor(&turned(0.0), method), "at rest");
        assert_alike(&on_adapter(&turned(90.0), method), &on_adapter(&turned(0.0), method), "turned");
    }
}
