//! A mesh whose halves wear one texture, mirrored, shows no seam where they meet.

use std::sync::Arc;

use glam::Vec3;
use ndf_inspector::filter::Truth;
use ndf_inspector::lighting::Light;
use ndf_inspector::lit_surface::LitSurface;
use ndf_inspector::normal_map::{Addressing, MapOptions, MapSource, NormalMap};
use ndf_inspector::reference::{self, Picture};
use ndf_inspector::scene::{Camera, Model, Reconstruction, Shape};

use super::files::Roof;

const SIZE: [u32; 2] = [160, 120];

/// A map of waves whose crests run along the texture's diagonal; at u = 1, where the halves meet, x is 0.
fn waves() -> Arc<NormalMap> {
    let size = 256;
    let normals = (0..size * size).map(|index| {
        let (u, v) = ((index % size) as f32 / size as f32, (index / size) as f32 / size as f32);
        let slope = 0.8 * (6.0 * std::f32::consts::PI * u).sin();
        Vec3::new(slope, 0.4 * (4.0 * std::f32::consts::TAU * v).sin(), 1.0).normalize()
    });
    let normals: Vec<Vec3> = normals.collect();
    let component = |axis: usize| normals.iter().map(|n| n[axis]).collect::<Vec<f32>>();
    let options = MapOptions { addressing: Addressing::Clamp, ..MapOptions::default() };
    let planes = [component(0), component(1), component(2)];
    Arc::new(NormalMap::from_unit_normals((size, size), planes, MapSource::Bundled("waves"), options))
}

/// The roof seen from the front, the light in the plane of its ridge: all is symmetric.
fn picture(model: Model, reconstruction: Reconstruction) -> Picture {
    let mut surface = LitSurface { camera: Camera { distance: 2.6, ..Camera::default() }, ..LitSurface::default() };
    surface.shape = Shape { tiling: [1.0, 1.0], reconstruction, ..Shape::of_model(Arc::new(model)) };
    surface.lights = Light { azimuth_deg: -90.0, elevation_deg: 50.0, ..Light::DEFAULT }.into();
    let map = waves();
    reference::render(&surface, &Truth { map: map.clone(), samples: 64 }, SIZE, [0.0, 8.0], (map.width, map.height))
}

fn at(picture: &Picture, x: u32, y: u32) -> Vec3 {
    picture.rgb[(y * SIZE[0] + x) as usize]
}

fn assert_no_seam(model: Model, reconstruction: Reconstruction, what: &str) {
    let picture = picture(model, reconstruction);
    let (mut symmetric, mut jump, mut variation) = (0.0_f32, 0.0_f32, 0.0_f32);
    for y in (0..SIZE[1]).filter(|y| picture.covered[(y * SIZE[0] + 80) as usize]) {
        for x in 0..80 {
            let (left, right) = (at(&picture, 79 - x, y), at(&picture, 80 + x, y));
            symmetric = symmetric.max((left - right).abs().max_element());
            variation = variation.max((left - at(&picture, 79, y)).abs().max_element());
        }
        jump = jump.max((at(&picture, 79, y) - at(&picture, 80, y)).abs().max_element());
    }
    println!("{what}: asymmetry {symmetric}, jump at the ridge {jump}, variation along rows {variation}");
    assert!(variation > 0.2, "{what} is flat");
    // Jitter differs from pixel to pixel: 64 samples of a pixel of a few texels leave some thousandths.
    assert!(symmetric < 0.05 && jump < 0.02, "{what}: {symmetric} {jump}");
}

#[test]
fn a_mirrored_obj_and_a_mirrored_gltf_show_no_seam() {
    let folder = tempfile::tempdir().expect("a folder");
    let roof = Roof::new(16);
    for way in Reconstruction::ALL {
        assert_no_seam(Model::read(&roof.write_obj(folder.path())).expect("sound"), way, "OBJ");
        assert_no_seam(Model::read(&roof.write_glb(folder.path())).expect("sound"), way, "GLB");
    }
}
