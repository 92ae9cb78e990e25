//! What is made of the vertices' frames at a pixel, and frames of either orientation under a sky.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Mat3, Vec3};
use ndf_inspector::filter::{Method, Truth};
use ndf_inspector::lighting::{Light, Lights, Sky};
use ndf_inspector::lit_surface::{LitSurface, SurfacePoint};
use ndf_inspector::normal_map::{Addressing, NormalMap};
use ndf_inspector::reference::raster::pick;
use ndf_inspector::reference::{self, Picture};
use ndf_inspector::scene::mesh::Tangents;
use ndf_inspector::scene::{Model, Reconstruction, Shape, ShapeKind};

use super::sky::uneven;
use super::twins::{assert_alike, assert_twins, differences, methods, on_adapter, on_processor};
use super::{Scene, maps};
use crate::meshes::files::Roof;

fn rough() -> Arc<NormalMap> {
    maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color)
}

/// A mesh whose right half is mirrored, under a map that is sheared on it.
fn sheared_roof(map: Arc<NormalMap>) -> Scene {
    let folder = tempfile::tempdir().expect("a folder");
    let mut scene = Scene::new(map, 6);
    scene.surface.wear_on(Arc::new(Model::read(&Roof::new(6).write_glb(folder.path())).expect("sound")));
    (scene.surface.shape.shear, scene.surface.shape.tiling) = (0.7, [2.0, 2.0]);
    scene
}

#[test]
fn every_reconstruction_has_a_twin_by_every_method_by_lights_and_under_a_sky() {
    // The rotation has its twins with every surface and every sky.
    for way in [Reconstruction::Projected, Reconstruction::Interpolated] {
        for has_sky in [false, true] {
            let mut scene = sheared_roof(rough());
            scene.size = [96, 72];
            scene.surface.shape.reconstruction = way;
            if has_sky {
                (scene.surface.lights, scene.surface.sky) = (Lights::NONE, uneven());
            }
            for method in methods() {
                assert_twins(&scene, method, &format!("{method}, {} frames, sky: {has_sky}", way.name()));
            }
        }
    }
}

#[test]
fn the_reconstructions_part_where_a_map_is_sheared_and_nowhere_else() {
    let picture = |kind: ShapeKind, shear: f32, way: Reconstruction| {
        let mut scene = Scene::new(rough(), 6);
        scene.surface.shape = Shape { shear, reconstruction: way, ..Shape::of_kind(kind) };
        on_adapter(&scene, Method::Truth)
    };
    for kind in [ShapeKind::Plane, ShapeKind::Torus] {
        let [own, projected, interpolated] = Reconstruction::ALL.map(|way| picture(kind, 0.0, way));
        assert_alike(&projected, &own, "projected");
        // Corners of the finely divided torus have nearly the same frame.
        assert_alike(&interpolated, &own, "interpolated");
        let [own, projected, interpolated] = Reconstruction::ALL.map(|way| picture(kind, 0.8, way));
        for (one, other) in [(&own, &projected), (&own, &interpolated), (&projected, &interpolated)] {
            let apart = differences(one, other).into_iter().filter(|&codes| codes > 3).count();
            assert!(apart > 500, "{kind:?}: {apart} pixels");
        }
    }
}

/// A map of one normal.
const LEANING: Vec3 = Vec3::new(0.45, 0.3, 1.0);

fn leaning(x: f32) -> Scene {
    let mut scene = Scene::new(maps::map(16, 16, Addressing::Wrap, |_, _| LEANING * Vec3::new(x, 1.0, 1.0)), 1);
    // Every lobe is the map's one normal.
    let stored = (LEANING * Vec3::new(x, 1.0, 1.0)).normalize();
    for level in scene.lobes.coarse.iter_mut().flatten() {
        Arc::make_mut(level).stored.fill([1.0, stored.x, stored.y, stored.z]);
    }
    (scene.surface.lights, scene.surface.sky) = (Lights::NONE, uneven());
    scene.surface.material.specular = 0.0;
    scene
}

/// On a sheared plane, whose frame is the same everywhere, by the equations of the thesis.
#[test]
fn a_map_of_one_normal_is_lit_by_what_the_frame_makes_of_it_by_every_method() {
    for (way, mirrored) in Reconstruction::ALL.into_iter().flat_map(|way| [(way, false), (way, true)]) {
        let mut scene = leaning(1.0);
        (scene.surface.lights, scene.surface.sky) = (Light::DEFAULT.into(), Sky::default());
        scene.surface.shape = Shape { shear: 0.6, mirrored, reconstruction: way, ..Shape::default() };
        let shape = &scene.surface.shape;
        let Tangents { tangent, bitangent } = shape.mesh().vertices[0].tangents(shape.uv_from_surface());
        let whole = Mat3::from_cols(tangent, bitangent, Vec3::Z);
        let across = Vec3::Z.cross(tangent);
        let surface_from_map = match way {
            Reconstruction::Orthonormal => Mat3::from_cols(tangent, across * across.dot(bitangent).signum(), Vec3::Z),
            // Equation 56, and 57.
            Reconstruction::Projected => whole.inverse().transpose(),
            Reconstruction::Interpolated => whole,
        };
        let normal = (surface_from_map * LEANING).normalize();
        let (light, material) = (Light::DEFAULT, &scene.surface.material);
        let cosine = normal.dot(light.direction_in_world()).max(0.0);
        let expected = material.diffuse * material.diffuse_color * light.radiance() * cosine;
        let unnormalised = "mip-unnormalised".parse().expect("a method");
        for method in methods().filter(|method| *method != unnormalised) {
            for picture in [on_adapter(&scene, method), on_processor(&scene, method)] {
                let middle = picture.rgb[(picture.size[1] / 2 * picture.size[0] + picture.size[0] / 2) as usize];
                let off = (middle - expected).length() / expected.length();
                // Harmonics to l = 12 ring by as much around a clamped cosine.
                assert!(off < 0.02, "{method}, {}, mirrored: {mirrored}: {middle} for {expected}", way.name());
            }
        }
    }
}

#[test]
fn under_a_sky_a_mirrored_map_is_the_map_of_mirrored_normals() {
    for kind in [ShapeKind::Plane, ShapeKind::Torus] {
        let scene = |x: f32, mirrored: bool| {
            let mut scene = leaning(x);
            scene.surface.shape = Shape { mirrored, ..Shape::of_kind(kind) };
            scene.surface.material.specular = 0.2;
            scene
        };
        for method in methods() {
            let [mirrored, plain] = [scene(1.0, true), scene(-1.0, false)].map(|scene| on_adapter(&scene, method));
            assert_alike(&mirrored, &plain, &format!("{method} on a mirrored {kind:?}"));
            assert_alike(&on_processor(&scene(1.0, true), method), &plain, &format!("{method} by the processor"));
            let other = on_adapter(&scene(1.0, false), method);
            let apart = differences(&mirrored, &other).into_iter().filter(|&codes| codes > 3).count();
            assert!(apart > 500, "{method} on {kind:?}: the mirror is seen at {apart} pixels");
        }
    }
}

/// What a Lambertian normal of the world reflects of the sky: the sum over all of its texels.
fn lit_by_every_texel(surface: &LitSurface, normal_in_world: Vec3) -> Vec3 {
    let environment = surface.sky.environment.as_ref().expect("a sky");
    let world_from_sky = surface.sky.sky_from_world().inverse();
    let of_texel = |(direction, solid_angle, index): (glam::DVec3, f64, usize)| {
        let cosine = (world_from_sky * direction.as_vec3()).dot(normal_in_world).max(0.0);
        solid_angle as f32 * cosine * environment.radiance[index]
    };
    let sum: Vec3 = environment.grid().texels().map(of_texel).sum();
    surface.material.diffuse * surface.material.diffuse_color * surface.sky.intensity * sum / PI
}

/// The roof's own frame, from its equations: u grows towards the ridge on either side, v towards the front.
fn normal_on_roof(position: Vec3, normal: Vec3) -> Vec3 {
    let along_u = if position.x < 0.0 { Vec3::X } else { Vec3::NEG_X };
    let tangent = (along_u - normal * normal.dot(along_u)).normalize();
    let n = LEANING.normalize();
    (n.x * tangent + n.y * Vec3::Y + n.z * normal).normalize()
}

#[test]
fn on_both_halves_of_a_mirrored_mesh_the_sky_is_the_sum_over_its_texels() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = Roof::new(16).write_glb(folder.path());
    let mut scene = Scene { size: [96, 72], ..leaning(1.0) };
    scene.surface.wear_on(Arc::new(Model::read(&path).expect("sound")));
    scene.surface.sky.rotation_deg = 40.0;
    let pixels = (5..90).step_by(8).flat_map(|x| (5..70).step_by(6).map(move |y| [x, y]));
    let seen = pixels.filter_map(|pixel| Some((pixel, pick(&scene.surface, scene.size, pixel)?)));
    // Where the halves meet, a pixel's four neighbours may lie on both.
    let points: Vec<_> = seen.filter(|(_, point)| point.position_in_world.x.abs() > 0.05).collect();
    let on_the_left = points.iter().filter(|(_, point)| point.position_in_world.x < 0.0).count();
    assert!(on_the_left > 5 && points.len() - on_the_left > 5, "{on_the_left} of {} points", points.len());
    let error = |picture: &Picture| {
        let of_point = |&([x, y], point): &([u32; 2], SurfacePoint)| {
            let normal = normal_on_roof(point.position_in_world, point.world_from_tangent.z_axis);
            let exact = lit_by_every_texel(&scene.surface, normal);
            (picture.rgb[(y * scene.size[0] + x) as usize] - exact).length() / exact.length()
        };
        points.iter().map(of_point).sum::<f32>() / points.len() as f32
    };
    let unnormalised = "mip-unnormalised".parse().expect("a method");
    for method in methods().filter(|method| ![unnormalised, Method::Truth].contains(method)) {
        let errors = [on_adapter(&scene, method), on_processor(&scene, method)].map(|picture| error(&picture));
        println!("{method}: off by {errors:.4?}");
        assert!(errors.iter().all(|&error| error < 5e-3), "{method}: {errors:?}");
    }
    // The truth's directions scatter, those drawn for the highlight that there is none of, too.
    let map = scene.map().clone();
    let base = (map.width, map.height);
    let sampled = |samples| {
        let truth = Truth { map: map.clone(), samples };
        error(&reference::render(&scene.surface, &truth, scene.size, [0.0, 0.0], base))
    };
    let errors = [64, 256, 4096].map(sampled);
    println!("truth by 64, 256 and 4096 samples: off by {errors:.4?}");
    assert!(errors[2] < 0.02 && errors[2] < 0.4 * errors[0], "{errors:?}");
}
