//! A V-groove of two colours from either side: each side's colour stays, on the adapter and on the processor, beside
//! the truth.

use std::sync::Arc;

use glam::Vec3;
use ndf_inspector::brdf::{ConvolutionRule, DiffuseRule};
use ndf_inspector::filter::vmf::{Alignment, Fold};
use ndf_inspector::filter::{Method, PlainMip};
use ndf_inspector::lit_surface::LitSurface;
use ndf_inspector::reference::Picture;

use super::Scene;
use super::twins::{assert_twins, on_adapter, on_processor};
use crate::color::{BLUE, RED, groove, settings};
use crate::fit::fitted;

/// The groove as a plane far away, seen and lit from the side its right-facing (1) or left-facing (-1) slopes turn to.
fn seen_from(side: f32, align: Alignment) -> Scene {
    let map = groove();
    let lobes = fitted(&map, &settings(2, align));
    let mut surface = LitSurface::default();
    surface.shape.tiling = [32.0, 32.0];
    // The camera's azimuth counts from -y, the light's from +x.
    (surface.camera.azimuth_deg, surface.camera.elevation_deg) = (side * 90.0, 40.0);
    surface.camera.distance = 8.0;
    let light = &mut surface.lights.as_mut_slice()[0];
    (light.azimuth_deg, light.elevation_deg) = (90.0 - side * 90.0, 45.0);
    (surface.material.diffuse_color, surface.material.specular_color) = (Vec3::ONE, Vec3::ONE);
    (surface.material.convolution, surface.material.diffuse_rule) = (ConvolutionRule::Exact, DiffuseRule::Exact);
    Scene { mip: Arc::new(PlainMip::new(map)), lobes, fold: Fold::default(), surface, size: [192, 144] }
}

/// The mean colour of what is seen.
fn mean(picture: &Picture) -> Vec3 {
    let seen = picture.rgb.iter().zip(&picture.covered).filter(|(_, covered)| **covered).map(|(color, _)| *color);
    let (sum, count) = seen.fold((Vec3::ZERO, 0), |(sum, count), color| (sum + color, count + 1));
    assert!(count > 200, "the groove covers {count} pixels");
    sum / count as f32
}

#[test]
fn a_two_colour_groove_keeps_each_sides_colour_on_the_adapter() {
    for (side, color) in [(1.0, RED), (-1.0, BLUE)] {
        let hue = |seen: Vec3| seen.normalize().dot(color.normalize());
        let aligned = seen_from(side, Alignment::default());
        let unaligned = seen_from(side, Alignment::None);
        let truth = mean(&on_adapter(&aligned, Method::Truth));
        assert!((mean(&on_processor(&aligned, Method::Truth)) - truth).length() < 0.005 * truth.length());
        for (scene, method) in [(&aligned, Method::Vmf), (&unaligned, Method::VmfUnaligned)] {
            assert_twins(scene, method, &format!("{method} of the groove from side {side}"));
            for (what, picture) in [("adapter", on_adapter(scene, method)), ("processor", on_processor(scene, method))]
            {
                let found = mean(&picture);
                let error = (found - truth).length() / truth.length();
                println!("{method} on the {what} from side {side}: {found} for {truth}, off by {error:.4}");
                assert!(error < 0.03, "{method} on the {what} from side {side}: {found} for {truth}");
                assert!(hue(found) > 0.99, "{method} on the {what} from side {side}: {found} is not like {color}");
            }
        }
        assert!(hue(mean(&on_adapter(&aligned, Method::MIP))) < 0.9, "the averaged normal mixes the sides");
    }
}
