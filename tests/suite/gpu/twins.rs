//! The adapter's pictures equal the processor's.

use std::sync::{Arc, Mutex};

use glam::{Mat3, Vec2, Vec3};
use ndf_inspector::brdf::{ConvolutionRule, DiffuseRule};
use ndf_inspector::color::srgb8_from_linear;
use ndf_inspector::comparison::ShownMethod;
use ndf_inspector::filter::LevelChoice;
use ndf_inspector::filter::vmf::{Fold, Rules};
use ndf_inspector::filter::{
    Filter, LocalLight, Lookup, Method, PixelFootprint, Rival, Truth, UnalignedVmf, VmfFilter,
};
use ndf_inspector::gpu::{FrameBudget, FrameInput, PICTURE_FORMAT, SurfaceFrame};
use ndf_inspector::lighting::Light;
use ndf_inspector::normal_map::Addressing;
use ndf_inspector::reference::{self, Picture};
use ndf_inspector::scene::{Model, Shape, ShapeKind};

use super::{Scene, gpu, maps};

/// Enough that one sample which falls on the other side of a texel's edge by a rounding changes less than 1/255.
pub(super) const SAMPLES: u32 = 256;

pub(super) fn on_processor(scene: &Scene, method: Method) -> Picture {
    let map = scene.map().clone();
    let base = (map.width, map.height);
    let vmf = || VmfFilter { lobes: Arc::new(scene.lobes.clone()), fold: scene.fold, rules: Rules::default() };
    let filter: Arc<dyn Filter> = match method {
        Method::Truth => Arc::new(Truth { map, samples: SAMPLES }),
        Method::Vmf => Arc::new(vmf()),
        Method::VmfUnaligned => Arc::new(UnalignedVmf(vmf())),
        Method::Rival(rival) => scene.rival(rival),
    };
    reference::render(&scene.surface, &*filter, scene.size, scene.full_lod_range(), base)
}

/// Frames that no test draws with just now: pipelines are compiled once, and scenes follow each other as in the window.
static FRAMES: Mutex<Vec<SurfaceFrame>> = Mutex::new(Vec::new());

/// The adapter's picture of one method, exposed, in linear light.
pub(super) fn on_adapter(scene: &Scene, method: Method) -> Picture {
    let kept = FRAMES.lock().expect("no test panics with it").pop();
    let mut frame = kept.unwrap_or_else(|| SurfaceFrame::new(&gpu().device, PICTURE_FORMAT));
    frame.budget = FrameBudget { truth_limit: SAMPLES, truth_batch: 64, upload_bytes: 1 << 30 };
    let methods = vec![ShownMethod { method, channels: scene.channels(method) }];
    let input = FrameInput { methods, ..scene.input(method) };
    frame.complete(gpu(), &input).expect("the device works");
    let picture = picture(&frame, scene.size, method);
    FRAMES.lock().expect("no test panics with it").push(frame);
    picture
}

/// The picture of one method as `frame` last drew it.
pub(super) fn picture(frame: &SurfaceFrame, size: [u32; 2], method: Method) -> Picture {
    let texels = frame.linear(&gpu().device, &gpu().queue, method).expect("readable");
    Picture {
        size,
        rgb: texels.iter().map(|t| Vec3::new(t[0], t[1], t[2])).collect(),
        covered: texels.iter().map(|t| t[3] > 0.5).collect(),
    }
}

/// The largest difference of a channel per pixel, in steps of 1/255 after sRGB encoding; 255 where only one of the
/// pictures shows the surface.
pub(super) fn differences(a: &Picture, b: &Picture) -> Vec<u8> {
    let pixel = |i: usize| {
        let (p, q) = (srgb8_from_linear(a.rgb[i]), srgb8_from_linear(b.rgb[i]));
        let largest = (0..3).map(|c| p[c].abs_diff(q[c])).max().unwrap_or(0);
        if a.covered[i] == b.covered[i] { largest } else { 255 }
    };
    (0..a.rgb.len()).map(pixel).collect()
}

/// Asserts that adapter and processor agree within 1/255 on 99.9 % of the pixels; prints the worst one.
pub(super) fn assert_twins(scene: &Scene, method: Method, what: &str) {
    assert_alike(&on_adapter(scene, method), &on_processor(scene, method), what);
}

/// The same for two pictures.
pub(super) fn assert_alike(adapter: &Picture, processor: &Picture, what: &str) {
    let seen: Vec<Vec3> = (0..adapter.rgb.len()).filter(|&i| adapter.covered[i]).map(|i| adapter.rgb[i]).collect();
    let brightest = seen.iter().map(|c| c.max_element()).fold(0.0, f32::max);
    let darkest = seen.iter().map(|c| c.max_element()).fold(f32::MAX, f32::min);
    assert!(seen.len() > 200 && brightest > darkest + 0.02, "{what}: {} pixels, flat or black", seen.len());
    let differences = differences(adapter, processor);
    let worst = (0..differences.len()).max_by_key(|&i| differences[i]).unwrap_or(0);
    let wrong = differences.iter().filter(|&&d| d > 1).count();
    println!(
        "{what}: {wrong} of {} pixels off by more than 1/255; worst {}/255 at ({}, {}): {} against {}",
        differences.len(),
        differences[worst],
        worst as u32 % adapter.size[0],
        worst as u32 / adapter.size[0],
        adapter.rgb[worst],
        processor.rgb[worst],
    );
    assert!(wrong * 1000 <= differences.len(), "{what}: {wrong} pixels differ");
}

/// On every shape, near and far, a map without colour and one with it.
fn assert_twins_everywhere(method: Method) {
    let plain = maps::rough(64, 64, Addressing::Wrap);
    let colored = maps::with_color(plain.clone(), maps::any_color);
    for (map, what) in [(plain, "plain"), (colored, "coloured")] {
        for kind in ShapeKind::BUILT_IN {
            for distance in [1.2, 3.2, 12.0] {
                let mut scene = Scene::new(map.clone(), 6);
                scene.surface.shape = Shape { tiling: [2.0, 2.0], ..Shape::of_kind(kind) };
                scene.surface.camera.distance = distance;
                assert_twins(&scene, method, &format!("{method}, {what} {kind:?} at {distance}"));
            }
        }
    }
}

/// Every way that a map may lie on a surface, a left-handed one too.
#[test]
fn tiled_sheared_turned_and_mirrored_maps_have_twins() {
    for (kind, mirrored) in [(ShapeKind::Torus, false), (ShapeKind::Teapot, true), (ShapeKind::MonkeySaddle, true)] {
        let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 6);
        let shape = Shape { radii: [0.8, 0.25], tiling: [6.0, 3.0], shear: 0.4, ..Shape::of_kind(kind) };
        scene.surface.shape = Shape { turn_deg: 30.0, mirrored, ..shape };
        for method in [Method::Truth, Method::Vmf] {
            assert_twins(&scene, method, &format!("{method} on {kind:?}, turned"));
        }
    }
}

#[test]
fn a_mesh_from_a_file_has_a_twin() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = crate::meshes::files::Roof::new(16).write_glb(folder.path());
    let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 6);
    scene.surface.wear_on(Arc::new(Model::read(&path).expect("sound")));
    for method in methods() {
        assert_twins(&scene, method, &format!("{method} on a mirrored mesh"));
    }
}

#[test]
fn truth_on_the_adapter_equals_its_twin() {
    assert_twins_everywhere(Method::Truth);
}

#[test]
fn rivals_of_the_mean_normals_on_the_adapter_equal_their_twins() {
    assert_rivals_have_twins_everywhere(|rival| !rival.kind.has_channels);
}

#[test]
fn rivals_with_channels_on_the_adapter_equal_their_twins() {
    assert_rivals_have_twins_everywhere(|rival| rival.kind.has_channels);
}

/// Of each kind the last that is offered: the one of most channels.
fn rivals() -> Vec<Rival> {
    let mut rivals: Vec<Rival> = Rival::offered().collect();
    rivals.reverse();
    rivals.dedup_by_key(|rival| rival.kind.name);
    rivals
}

pub(super) fn methods() -> impl Iterator<Item = Method> {
    rivals().into_iter().map(Method::Rival).chain([Method::Truth, Method::Vmf, Method::VmfUnaligned])
}

fn assert_rivals_have_twins_everywhere(chosen: impl Fn(&Rival) -> bool) {
    for rival in rivals().into_iter().filter(chosen) {
        assert_twins_everywhere(Method::Rival(rival));
    }
}

#[test]
fn vmf_on_the_adapter_equals_its_twin() {
    assert_twins_everywhere(Method::Vmf);
}

#[test]
fn unaligned_vmf_on_the_adapter_equals_its_twin() {
    assert_twins_everywhere(Method::VmfUnaligned);
}

#[test]
fn at_a_texel_centre_unaligned_shading_is_aligned_shading_and_between_two_it_is_their_mean() {
    let scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 6);
    let vmf = VmfFilter { lobes: Arc::new(scene.lobes.clone()), fold: scene.fold, rules: Rules::default() };
    let unaligned = UnalignedVmf(vmf.clone());
    let light = LocalLight {
        light_in_tangent: Vec3::new(0.3, -0.2, 0.9).normalize(),
        half_in_tangent: Vec3::new(0.1, 0.2, 0.95).normalize(),
    };
    let material = scene.surface.material;
    let at = |filter: &dyn Filter, x: f32| {
        let uv = Vec2::new((x + 0.5) / 16.0, 3.5 / 16.0);
        let lookup = Lookup {
            uv,
            footprint: PixelFootprint::default(),
            lod: 2.0,
            pixel: [3, 4],
            tangent_from_map: Mat3::IDENTITY,
        };
        filter.shade(&lookup, &light, &material)
    };
    for x in 0..15 {
        let x = x as f32;
        // uv rounds.
        assert!((at(&vmf, x) - at(&unaligned, x)).abs().max_element() < 1e-4);
        let mean = 0.5 * (at(&vmf, x) + at(&vmf, x + 1.0));
        assert!((at(&unaligned, x + 0.5) - mean).abs().max_element() < 1e-4);
    }
}

#[test]
fn maps_of_any_size_and_either_addressing_have_twins() {
    for (width, height, addressing) in
        [(40, 23, Addressing::Clamp), (40, 23, Addressing::Wrap), (1, 7, Addressing::Wrap), (1, 1, Addressing::Clamp)]
    {
        for method in methods() {
            let mut scene = Scene::new(maps::rough(width, height, addressing), 3);
            scene.surface.shape = Shape { tiling: [3.0, 2.0], ..Shape::of_kind(ShapeKind::Sphere) };
            assert_twins(&scene, method, &format!("{method} of {width}x{height}, {addressing:?}"));
        }
    }
}

#[test]
fn every_convolution_rule_has_a_twin() {
    for rule in ConvolutionRule::ALL {
        for shininess in [1.0, 10.0, 400.0, 4000.0] {
            let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 8);
            scene.surface.material.convolution = rule;
            scene.surface.material.shininess = shininess;
            scene.surface.exposure_stops = -1.0;
            assert_twins(&scene, Method::Vmf, &format!("{} at s {shininess}", rule.label()));
        }
    }
}

#[test]
fn the_papers_multipliers_have_a_twin_and_so_have_soft_and_sharp_materials() {
    for rival in Rival::offered().filter(|rival| rival.kind.has_channels) {
        for (shininess, convolution) in
            [(1.0, ConvolutionRule::Paper), (10.0, ConvolutionRule::Paper), (400.0, ConvolutionRule::ShiftedExponent)]
        {
            let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 1);
            scene.surface.material.convolution = convolution;
            scene.surface.material.shininess = shininess;
            scene.surface.exposure_stops = -1.0;
            assert_twins(&scene, Method::Rival(rival), &format!("{rival} at s {shininess}"));
        }
    }
}

#[test]
fn the_exact_rules_have_twins_on_every_shape() {
    for kind in ShapeKind::BUILT_IN {
        for method in [Method::Vmf, Method::VmfUnaligned] {
            let mut scene = Scene::new(maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color), 6);
            scene.surface.shape = Shape { tiling: [2.0, 2.0], ..Shape::of_kind(kind) };
            scene.surface.material.convolution = ConvolutionRule::Exact;
            scene.surface.material.diffuse_rule = DiffuseRule::Exact;
            // Low, so that the horizon is seen, where the two diffuse rules differ most.
            scene.surface.lights.as_mut_slice()[0].elevation_deg = 15.0;
            scene.surface.material.diffuse = 1.0;
            assert_twins(&scene, method, &format!("{method} exactly on {kind:?}"));
        }
    }
}

#[test]
fn every_kind_of_light_has_a_twin_by_every_method_and_so_have_eight_together() {
    let far = Light { azimuth_deg: -20.0, elevation_deg: 30.0, color: Vec3::new(1.0, 0.7, 0.4), ..Light::DEFAULT };
    let near = Light { azimuth_deg: 100.0, elevation_deg: 40.0, intensity: 3.0, distance: Some(1.6), ..far };
    let crowd: Vec<Light> = (0..8)
        .map(|index| Light {
            azimuth_deg: 45.0 * index as f32 - 170.0,
            intensity: 0.4,
            distance: (index % 2 == 1).then_some(1.0 + 0.2 * index as f32),
            ..far
        })
        .collect();
    for lights in [&[far][..], &[near], &crowd] {
        let mut scene = Scene::new(maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color), 6);
        scene.surface.shape = Shape { tiling: [2.0, 2.0], ..Shape::of_kind(ShapeKind::Torus) };
        scene.surface.lights = lights.try_into().expect("eight at most");
        for method in methods() {
            assert_twins(&scene, method, &format!("{method} by {} lights", lights.len()));
        }
    }
}

#[test]
fn without_lights_the_surface_is_black_and_two_give_the_sum_of_both() {
    let scene = |lights: &[Light]| {
        let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 6);
        scene.surface.lights = lights.try_into().expect("eight at most");
        scene
    };
    let near = Light { azimuth_deg: -60.0, distance: Some(2.0), ..Light::DEFAULT };
    for method in [Method::Truth, Method::MIP, Method::Vmf, Method::VmfUnaligned] {
        let picture = |lights: &[Light]| on_adapter(&scene(lights), method).rgb;
        let (both, first, second) = (picture(&[Light::DEFAULT, near]), picture(&[Light::DEFAULT]), picture(&[near]));
        assert!(picture(&[]).iter().all(|color| *color == Vec3::ZERO), "{method}");
        for ((both, first), second) in both.iter().zip(first).zip(second) {
            // Rounding of the truth's running mean.
            assert!((*both - first - second).abs().max_element() <= 1e-5, "{method}: {both} of {first} and {second}");
        }
    }
}

#[test]
fn a_preview_with_fewer_lobes_has_a_twin() {
    let map = maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color);
    let mut scene = Scene::new(map, 6);
    scene.fold = Fold(std::array::from_fn(|slot| [0, 1, 1, 0, 4, 1][slot.min(5)]));
    for distance in [1.2, 12.0] {
        scene.surface.camera.distance = distance;
        assert_twins(&scene, Method::Vmf, &format!("folded at {distance}"));
        assert_twins(&scene, Method::VmfUnaligned, &format!("unaligned and folded at {distance}"));
    }
}

#[test]
fn a_fixed_level_has_a_twin_whole_or_between_two() {
    let mut scene = Scene::new(maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color), 6);
    for level in [0.0, 0.4, 1.0, 2.7, 6.0, 9.0] {
        scene.surface.level = LevelChoice::Fixed(level);
        for method in methods().filter(|&method| method != Method::Truth) {
            if level < 6.0 {
                assert_twins(&scene, method, &format!("{method} at level {level}"));
            } else {
                // One texel over the whole plane: not flat enough to fail, not rough enough to pass the check above.
                let worst = differences(&on_adapter(&scene, method), &on_processor(&scene, method)).into_iter().max();
                assert!(worst <= Some(1), "{method} at level {level}: {worst:?}");
            }
        }
    }
}

#[test]
fn a_flat_map_gives_the_same_picture_by_every_method_at_every_level() {
    let flat = maps::map(16, 16, Addressing::Wrap, |_, _| Vec3::Z);
    let mut scene = Scene::new(flat.clone(), 1);
    for level in scene.lobes.coarse.iter_mut().flatten() {
        Arc::make_mut(level).stored.fill([1.0, 0.0, 0.0, 1.0]);
    }
    scene.lobes.base = None;
    scene.surface.shape.kind = ShapeKind::Torus;
    let truth = on_adapter(&scene, Method::Truth);
    for level in 0..5 {
        scene.surface.level = LevelChoice::Fixed(level as f32);
        let of_mean_normals = Rival::offered().filter(|rival| !rival.kind.has_channels).map(Method::Rival);
        for method in of_mean_normals.chain([Method::Vmf, Method::VmfUnaligned]) {
            let worst = differences(&on_adapter(&scene, method), &truth).into_iter().max();
            // One step: a lobe of 1/kappa = 1e-7 is not quite a delta, and rounding may fall either way.
            assert!(worst <= Some(1), "{method} at level {level}: {worst:?}");
        }
    }
}

#[test]
fn at_a_texel_centre_of_level_0_every_method_gives_the_unfiltered_shading() {
    let scene = Scene::new(maps::rough(8, 8, Addressing::Wrap), 6);
    let vmf = VmfFilter { lobes: Arc::new(scene.lobes.clone()), fold: scene.fold, rules: Rules::default() };
    let material = scene.surface.material;
    let light = LocalLight {
        light_in_tangent: Vec3::new(0.3, -0.2, 0.9).normalize(),
        half_in_tangent: Vec3::new(0.1, 0.2, 0.95).normalize(),
    };
    for texel in 0..64 {
        let uv = (Vec2::new((texel % 8) as f32, (texel / 8) as f32) + 0.5) / 8.0;
        let lookup = Lookup {
            uv,
            footprint: PixelFootprint::default(),
            lod: 0.0,
            pixel: [3, 4],
            tangent_from_map: Mat3::IDENTITY,
        };
        let truth = Truth { map: scene.map().clone(), samples: 1 }.shade(&lookup, &light, &material);
        for filter in [&*scene.mip as &dyn Filter, &vmf] {
            let shaded = filter.shade(&lookup, &light, &material);
            // A lobe of 1/kappa = 1e-7 stands for the delta, and uv rounds.
            assert!((shaded - truth).abs().max_element() < 1e-4, "texel {texel}: {shaded} against {truth}");
        }
    }
}
