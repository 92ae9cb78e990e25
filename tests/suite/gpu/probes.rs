//! Long footprints read by several probes, on a plane at a grazing angle.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use ndf_inspector::brdf::{Brdf, ConvolutionRule, Material};
use ndf_inspector::filter::truth::{jitter, nearest_texel};
use ndf_inspector::filter::{EffectiveBrdf, Filter, LevelChoice, LocalLight, LocalSky, Lookup, Method, Rival};
use ndf_inspector::normal_map::pyramid::Texel;
use ndf_inspector::normal_map::{Addressing, NormalMap};
use ndf_inspector::reference::{self, normalised_color_error};
use ndf_inspector::sphere::harmonics::zonal_series;

use super::twins::{SAMPLES, assert_twins, methods, on_adapter};
use super::{Scene, maps};

/// A plane seen at a grazing angle: footprints many times as long as wide.
fn grazing(choice: LevelChoice, anisotropy: u32) -> Scene {
    let map = maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color);
    let mut scene = Scene::new(map, 6);
    scene.surface.shape.tiling = [3.0, 3.0];
    (scene.surface.camera.azimuth_deg, scene.surface.camera.elevation_deg) = (25.0, 14.0);
    (scene.surface.level, scene.surface.anisotropy) = (choice, anisotropy);
    scene
}

#[test]
fn probes_along_a_long_footprint_have_a_twin() {
    for (choice, anisotropy) in
        [(LevelChoice::Auto, 5), (LevelChoice::Auto, 16), (LevelChoice::Hardware, 1), (LevelChoice::Hardware, 16)]
    {
        let scene = grazing(choice, anisotropy);
        for method in methods().filter(|&method| method != Method::Truth) {
            assert_twins(&scene, method, &format!("{method} with {anisotropy} probes, {choice:?}"));
        }
    }
}

#[test]
fn more_probes_bring_a_grazing_plane_nearer_the_truth_and_leave_the_truth_alone() {
    let truth = on_adapter(&grazing(LevelChoice::Auto, 1), Method::Truth);
    assert!(truth == on_adapter(&grazing(LevelChoice::Auto, 16), Method::Truth));
    for method in [Method::Vmf, Method::VmfUnaligned] {
        let error = |probes| {
            let picture = on_adapter(&grazing(LevelChoice::Auto, probes), method);
            normalised_color_error(&picture, &truth).expect("the surface is seen")
        };
        let errors = [1, 4, 16].map(error);
        println!("{method}: {errors:?}");
        assert!(errors[1] < 0.8 * errors[0] && errors[2] < errors[1], "{method}: {errors:?}");
    }
}

/// The truth's own samples, each normal's cosine cut off after a band: all that harmonics to that band can show.
struct Truncated {
    map: Arc<NormalMap>,
    last_band: usize,
}

impl Filter for Truncated {
    fn map(&self) -> &NormalMap {
        &self.map
    }

    /// It is for pictures alone.
    fn effective_brdf_of(&self, _: Texel, _: Brdf) -> EffectiveBrdf<'_> {
        Box::new(|_| f64::NAN)
    }

    fn is_truth(&self) -> bool {
        false
    }

    fn shade(&self, lookup: &Lookup, light: &LocalLight, material: &Material) -> Vec3 {
        let multipliers = Brdf::Lambert.multipliers(ConvolutionRule::Exact, self.last_band + 1);
        let (map, addressing) = (&self.map, self.map.options.addressing);
        let sample = |index: u32| {
            let uv = lookup.uv + lookup.footprint.uv_step(jitter(lookup.pixel, index));
            let (x, y) = (nearest_texel(uv.x, map.width, addressing), nearest_texel(uv.y, map.height, addressing));
            let Some(normal) = map.normal(y * map.width + x) else { return Vec3::ZERO };
            let series = zonal_series(multipliers.iter().copied(), f64::from(normal.dot(light.light_in_tangent)));
            map.color(y * map.width + x) * material.diffuse * material.diffuse_color * (PI * series) as f32
        };
        (0..SAMPLES).map(sample).sum::<Vec3>() / SAMPLES as f32
    }

    fn shade_sky(&self, _: &Lookup, _: &LocalSky<'_>) -> Vec3 {
        Vec3::ZERO
    }
}

/// Han et al. 2007, figure 3: a Lambertian plane that runs into the distance. A method is as far off as what it keeps at
/// every probe lets it be: of harmonics to l = 2 that is the cosine's bands beyond the second, which the truth's own
/// samples lose as well. Measured by 1 and by 16 probes: .132 and .057 to l = 2, .137 and .038 to l = 12, .147 and .040 by
/// the mean normal; the truth's samples are .040 off without the bands beyond the second, .002 without those beyond 12.
#[test]
fn probes_let_harmonics_and_mean_normals_gain_on_a_grazing_lambertian_plane() {
    let scene = |probes| {
        let mut scene = grazing(LevelChoice::Auto, probes);
        (scene.surface.material.specular, scene.surface.material.diffuse) = (0.0, 1.0);
        scene.surface.camera.elevation_deg = 8.0;
        scene
    };
    let truth = on_adapter(&scene(1), Method::Truth);
    let errors = |name: &str| {
        let method = Method::Rival(Rival::parse(name).expect("a rival"));
        let error = |probes| normalised_color_error(&on_adapter(&scene(probes), method), &truth).expect("seen");
        let errors = [1, 2, 4, 8, 16].map(error);
        println!("{name} by 1, 2, 4, 8 and 16 probes: {errors:.4?}");
        errors
    };
    let bands = |last_band: usize| {
        let scene = scene(1);
        let map = scene.map().clone();
        let base = (map.width, map.height);
        let cut = reference::render(&scene.surface, &Truncated { map, last_band }, scene.size, [0.0, 0.0], base);
        let error = normalised_color_error(&cut, &truth).expect("seen");
        println!("the truth's samples cut off after band {last_band}: {error:.4}");
        error
    };
    let all = ["sh:2", "sh:4", "sh:7", "sh:12", "mip"].map(errors);
    for errors in &all {
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0] + 1e-3), "{errors:?}");
        assert!(errors[4] < 0.8 * errors[0], "{errors:?}");
    }
    for (errors, last_band) in all.iter().zip([2, 4, 7, 12]) {
        // What is left beside the bands is the reach of trilinear probes: the mean normal errs by it too.
        assert!(errors[4] < bands(last_band) + all[4][4], "to band {last_band}: {errors:?}");
    }
    assert!(all[3][4] < all[4][4], "enough bands are nearer the truth than the mean normal");
}
