//! Every model of the material is the same on the adapter as on the processor.

use ndf_inspector::brdf::{Brdf, ConvolutionRule, DiffuseRule, Ggx, Measured, Merl};
use ndf_inspector::filter::Method;
use ndf_inspector::normal_map::Addressing;

use super::twins::{assert_twins, methods};
use super::{Scene, maps};

/// The models beside Blinn-Phong, which every other test is of.
fn models() -> [Brdf; 5] {
    let names = ["lambert", "torrance-sparrow:0.06", "torrance-sparrow:0.4", "ggx:0.1", "ggx:0.6"];
    names.map(|name| name.parse().expect("a BRDF"))
}

/// A glossy plastic, redder away from the highlight.
fn measured() -> Measured {
    let gloss = Brdf::Ggx(Ggx { alpha: 0.15 });
    let merl = Merl::of_angles(|theta_h, theta_d| {
        let coat = 0.02 * gloss.zonal(theta_h.cos()) * (1.0 + 4.0 * theta_d.powi(4));
        [0.2, 0.1, 0.05].map(|base| base / std::f64::consts::PI + coat)
    });
    Measured::new("plastic", &merl)
}

fn scene(model: Brdf) -> Scene {
    let mut scene = Scene::new(maps::with_color(maps::rough(64, 64, Addressing::Wrap), maps::any_color), 6);
    scene.surface.material.set_brdf(model);
    scene.surface.material.specular = 0.4;
    scene.surface.material.fresnel = 0.7;
    scene.surface.lights.as_mut_slice()[0].elevation_deg = 20.0;
    scene.surface.exposure_stops = -1.0;
    scene
}

#[test]
fn every_model_has_a_twin_by_every_method() {
    for model in models().into_iter().chain([Brdf::Measured(measured())]) {
        for method in methods() {
            for distance in [1.2, 5.0] {
                let mut scene = scene(model);
                scene.surface.camera.distance = distance;
                assert_twins(&scene, method, &format!("{method} of {model} at {distance}"));
            }
        }
    }
}

#[test]
fn every_model_has_a_twin_under_every_rule() {
    for model in models() {
        for rule in ConvolutionRule::ALL {
            for method in [Method::Vmf, Method::VmfUnaligned] {
                let mut scene = scene(model);
                scene.surface.material.convolution = rule;
                scene.surface.material.diffuse_rule = DiffuseRule::Exact;
                assert_twins(&scene, method, &format!("{method} of {model}, {}", rule.label()));
            }
        }
    }
}
