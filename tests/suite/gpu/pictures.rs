//! Pictures of surfaces: a plane into the distance (Han et al. 2007, figure 3), the teapot (Mikkelsen 2008, figure 40)
//! and a mesh lit by a sky (Han et al., figure 9).

use std::path::Path;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use image::RgbaImage;
use ndf_inspector::brdf::Material;
use ndf_inspector::comparison::{Arrangement, ShownMethod};
use ndf_inspector::filter::Method;
use ndf_inspector::filter::vmf::Alignment;
use ndf_inspector::gpu::{FrameInput, render_to_rgba8};
use ndf_inspector::lighting::{Light, Lights, ProceduralSky, Sky, SkySource};
use ndf_inspector::normal_map::procedural;
use ndf_inspector::scene::{Camera, Model, Shape, ShapeKind};

use super::{Scene, gpu};
use crate::color::settings;
use crate::fit::fitted;
use crate::meshes::files::Roof;
use crate::window::pictures::compare;

const SIZE: [u32; 2] = [480, 320];
const SAMPLES: u32 = 256;

/// A bundled map of 64 x 64 texels with six lobes.
fn scene(map: &str) -> Scene {
    let map = Arc::new(procedural::find(map).expect("bundled").make(64));
    let lobes = fitted(&map, &settings(6, Alignment::default()));
    Scene { lobes, size: SIZE, ..Scene::new(map, 1) }
}

fn take(scene: &Scene, names: &[&str], arrangement: Arrangement) -> RgbaImage {
    let method = |name: &&str| {
        let method: Method = name.parse().expect("a method");
        ShownMethod { method, channels: scene.channels(method) }
    };
    let methods: Vec<ShownMethod> = names.iter().map(method).collect();
    let input = FrameInput { methods, arrangement, ..scene.input(Method::Truth) };
    let rgba = render_to_rgba8(gpu(), &input, SAMPLES).expect("readable");
    RgbaImage::from_raw(SIZE[0], SIZE[1], rgba).expect("as large as it says")
}

#[test]
fn a_plane_into_the_distance_by_truth_lobes_harmonics_and_plain_mip() {
    let mut scene = scene("scales");
    scene.surface.shape.tiling = [6.0, 6.0];
    scene.surface.camera = Camera { azimuth_deg: 20.0, elevation_deg: 9.0, distance: 1.6, ..Camera::default() };
    scene.surface.lights = Light { azimuth_deg: 100.0, elevation_deg: 20.0, ..Light::DEFAULT }.into();
    scene.surface.anisotropy = 16;
    let names = ["truth", "vmf", "sh:7", "mip"];
    compare(&take(&scene, &names, Arrangement::Grid { side: 2 }), "grazing_plane");
}

#[test]
fn the_teapot_in_five_orientations() {
    let mut scene = scene("pyramid5");
    scene.surface.shape = Shape { tiling: [60.0, 36.0], ..Shape::of_kind(ShapeKind::Teapot) };
    scene.surface.material.shininess = 64.0;
    scene.surface.camera = Camera { elevation_deg: 25.0, distance: 2.6, ..Camera::default() };
    let picture = take(&scene, &["truth", "vmf"], Arrangement::Wipe(0.5));
    compare(&picture, "teapot");
}

/// A tube along a trefoil knot, a thousand quads around the map, as a file.
fn knot(folder: &Path) -> Model {
    let (along, around) = (192_u32, 32_u32);
    let mut knot = Roof { positions: vec![], normals: vec![], uvs: vec![], triangles: vec![] };
    let centre = |t: f32| {
        let radius = 2.0 + (3.0 * t).cos();
        Vec3::new(radius * (2.0 * t).cos(), radius * (2.0 * t).sin(), 1.2 * (3.0 * t).sin())
    };
    for (i, j) in (0..=along).flat_map(|i| (0..=around).map(move |j| (i, j))) {
        let place = Vec2::new(i as f32 / along as f32, j as f32 / around as f32);
        let (t, turn) = (std::f32::consts::TAU * place.x, std::f32::consts::TAU * place.y);
        let forward = (centre(t + 1e-3) - centre(t - 1e-3)).normalize();
        let out = centre(t) - forward * forward.dot(centre(t));
        let (out, side) = (out.normalize(), forward.cross(out).normalize());
        let normal = turn.cos() * out + turn.sin() * side;
        knot.positions.push(centre(t) + 0.55 * normal);
        knot.normals.push(normal);
        knot.uvs.push(place);
        if i < along && j < around {
            let (a, b) = (i * (around + 1) + j, (i + 1) * (around + 1) + j);
            knot.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    Model::read(&knot.write_glb(folder)).expect("sound")
}

#[test]
fn a_mesh_under_a_studios_and_a_clear_sky() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut scene = scene("bricks");
    scene.surface.shape = Shape { tiling: [24.0, 6.0], ..Shape::of_model(Arc::new(knot(folder.path()))) };
    scene.surface.camera = Camera { elevation_deg: 35.0, distance: 2.8, ..Camera::default() };
    scene.surface.lights = Lights::NONE;
    let mut under = |made: ProceduralSky, exposure_stops: f32, specular: f32, name: &str| {
        let environment = Some(Arc::new(SkySource::Bundled(made).load().expect("a sky")));
        scene.surface.sky = Sky { environment, ..Sky::default() };
        (scene.surface.exposure_stops, scene.surface.material.specular) = (exposure_stops, specular);
        compare(&take(&scene, &["truth", "vmf"], Arrangement::Wipe(0.5)), name);
    };
    let usual = Material::DEFAULT.specular;
    under(ProceduralSky::Studio, 0.5, usual, "mesh_under_a_sky");
    under(ProceduralSky::Clear, -0.5, 5.0 * usual, "mesh_in_the_sun");
}
