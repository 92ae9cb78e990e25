//! Every rival against the truth, and against what its author wrote down.

use std::sync::Arc;

use glam::{DVec2, DVec3, Mat3, Vec2, Vec3};
use ndf_inspector::brdf::{BlinnPhong, Brdf, Material};
use ndf_inspector::filter::gmm::{self, PlanarGaussian};
use ndf_inspector::filter::rival::Source;
use ndf_inspector::filter::vmf::{Monitor, Rules};
use ndf_inspector::filter::{Filter, LocalLight, Lookup, PixelFootprint, PlainMip, Rival, RivalFilter, Truth};
use ndf_inspector::ndf::Ndf;
use ndf_inspector::normal_map::pyramid::Texel;
use ndf_inspector::normal_map::{Addressing, NormalMap};
use ndf_inspector::sphere::direction::hemisphere;

use super::gpu::maps;

fn build(name: &str, map: &Arc<NormalMap>) -> Arc<dyn RivalFilter> {
    let rival = Rival::parse(name).expect("a rival");
    let mip = Arc::new(PlainMip::new(Arc::clone(map)));
    let monitor = Monitor::new(Vec::new());
    rival.build(&Source { mip: &mip, rules: Rules::default(), monitor: &monitor }).expect("nobody cancels")
}

fn truth(map: &Arc<NormalMap>) -> Truth {
    Truth { map: Arc::clone(map), samples: 1 }
}

fn blinn_phong(shininess: f64) -> Brdf {
    Brdf::BlinnPhong(BlinnPhong { shininess })
}

/// A texel in the middle of every level.
fn middles(map: &NormalMap) -> impl Iterator<Item = Texel> {
    let sizes = map.level_sizes().into_iter().enumerate();
    sizes.map(|(level, (width, height))| Texel { level, x: width / 2, y: height / 2 })
}

/// Maps whose sizes are powers of two, and not, and one texel wide.
fn some_maps() -> Vec<Arc<NormalMap>> {
    [(64, 64), (40, 23), (1, 7)].map(|(width, height)| maps::rough(width, height, Addressing::Wrap)).to_vec()
}

/// `|a - b| / |b|` over directions of the whole sphere.
fn relative_error(a: &dyn Filter, b: &dyn Filter, texel: Texel, brdf: Brdf) -> f64 {
    let (mut difference, mut whole) = (0.0, 0.0);
    for omega in hemisphere(200).flat_map(|omega| [omega, -omega]) {
        let (a, b) = (a.effective_brdf(texel, brdf, omega), b.effective_brdf(texel, brdf, omega));
        difference += (a - b) * (a - b);
        whole += b * b;
    }
    (difference / whole).sqrt()
}

#[test]
fn harmonics_to_band_12_are_the_truth_of_exponent_10_at_every_level() {
    for map in some_maps() {
        let filter = build("sh:12", &map);
        for texel in middles(&map) {
            let error = relative_error(&*filter, &truth(&map), texel, blinn_phong(10.0));
            assert!(error < 1e-3, "{texel}: {error}");
        }
    }
}

#[test]
fn nine_harmonics_hold_all_but_two_percent_of_lamberts_power_at_every_level() {
    for map in some_maps() {
        let filter = build("sh:2", &map);
        for texel in middles(&map) {
            let error = relative_error(&*filter, &truth(&map), texel, Brdf::Lambert);
            assert!(error * error < 0.02, "{texel}: {error}");
        }
    }
}

#[test]
fn stored_harmonics_shade_as_the_sum_over_the_footprint() {
    // The picture goes by stored coefficients and the probe by the addition theorem.
    let map = maps::rough(64, 64, Addressing::Wrap);
    let filter = build("sh:12", &map);
    let half = Vec3::new(0.2, -0.1, 0.95).normalize();
    let light = LocalLight { light_in_tangent: half, half_in_tangent: half };
    let brdf = blinn_phong(30.0);
    let specular =
        Material { shininess: 30.0, specular: 1.0, diffuse: 0.0, specular_color: Vec3::ONE, ..Material::default() };
    let diffuse = Material { specular: 0.0, diffuse: 1.0, diffuse_color: Vec3::ONE, ..Material::default() };
    for texel in middles(&map).filter(|texel| texel.level > 0) {
        let size = map.level_sizes()[texel.level];
        let uv = (Vec2::new(texel.x as f32, texel.y as f32) + 0.5) / Vec2::new(size.0 as f32, size.1 as f32);
        let lookup = Lookup {
            uv,
            footprint: PixelFootprint::default(),
            lod: texel.level as f32,
            pixel: [0, 0],
            tangent_from_map: Mat3::IDENTITY,
        };
        let cosine = Ndf::of_texel(&map, texel).mean().normalize().dot(half.as_dvec3());
        let expected = filter.effective_brdf(texel, brdf, half.as_dvec3()) * cosine;
        let shaded = f64::from(filter.shade(&lookup, &light, &specular).x);
        assert!((shaded - expected).abs() < 1e-4 * expected.abs().max(0.1), "{texel}: {shaded} against {expected}");
        let expected = std::f64::consts::PI * filter.effective_brdf(texel, Brdf::Lambert, half.as_dvec3());
        let shaded = f64::from(filter.shade(&lookup, &light, &diffuse).x);
        assert!((shaded - expected).abs() < 1e-4, "{texel}: {shaded} against {expected}");
    }
}

#[test]
fn on_a_base_texel_and_on_a_flat_map_mean_normals_shade_as_the_normal_itself() {
    let rough = maps::rough(16, 16, Addressing::Wrap);
    let flat = maps::map(24, 10, Addressing::Wrap, |_, _| Vec3::new(0.1, -0.05, 1.0).normalize());
    let base = (0..16).map(|x| Texel { level: 0, x, y: 5 });
    let cases = base.map(|texel| (&rough, texel)).chain(middles(&flat).map(|texel| (&flat, texel)));
    for (map, texel) in cases {
        for name in ["mip", "mip-unnormalised", "toksvig"] {
            let error = relative_error(&*build(name, map), &truth(map), texel, blinn_phong(64.0));
            // f32 holds the mean's length to 6e-8: 4e-6 of the exponent's effect.
            assert!(error < 1e-4, "{name} {texel}: {error}");
        }
    }
}

#[test]
fn on_a_level_map_gaussians_come_as_close_as_they_are_like_blinn_phong() {
    let flat = maps::map(16, 16, Addressing::Wrap, |_, _| Vec3::Z);
    for (exponent, most) in [(10.0, 0.25), (64.0, 0.05), (400.0, 0.01)] {
        for name in ["lean", "gmm:4"] {
            for texel in middles(&flat) {
                let error = relative_error(&*build(name, &flat), &truth(&flat), texel, blinn_phong(exponent));
                assert!(error < most, "{name} {texel} at s {exponent}: {error}");
            }
        }
    }
}

#[test]
fn toksvig_and_lean_are_their_closed_forms_on_two_facets() {
    // Every other row leans by the same slope up or down.
    let facet = |y: usize| Vec3::new(0.0, if y.is_multiple_of(2) { 0.4 } else { -0.4 }, 1.0).normalize();
    let map = maps::map(8, 8, Addressing::Wrap, |_, y| facet(y));
    let (texel, exponent) = (Texel { level: 1, x: 1, y: 1 }, 50.0);
    let length = f64::from(facet(0).z);
    let factor = length / (length + exponent * (1.0 - length));
    for omega in hemisphere(60) {
        let widened = BlinnPhong { shininess: factor * exponent }.zonal(omega.z);
        let found = build("toksvig", &map).effective_brdf(texel, blinn_phong(exponent), omega);
        assert!((found - widened).abs() < 1e-4 * widened.max(0.01), "{found} against {widened}");
        let slope = omega.truncate() / omega.z;
        let variance = DVec2::new(1.0 / exponent, 1.0 / exponent + 0.16);
        let squared = slope.x * slope.x / variance.x + slope.y * slope.y / variance.y;
        let density =
            (-0.5 * squared).exp() / (std::f64::consts::TAU * (variance.x * variance.y).sqrt()) / omega.z.powi(3);
        let density = if omega.z > 0.02 { density } else { 0.0 };
        let found = build("lean", &map).effective_brdf(texel, blinn_phong(exponent), omega);
        assert!((found - density).abs() < 1e-5 * density.max(1.0), "{found} against {density}");
    }
}

#[test]
fn gaussians_blur_by_adding_the_materials_variance() {
    let mixture = [
        PlanarGaussian { weight: 0.3, mean: DVec2::new(0.2, -0.1), variance: 0.01 },
        PlanarGaussian { weight: 0.7, mean: DVec2::new(-0.4, 0.3), variance: 0.05 },
    ];
    for half in hemisphere(40).flat_map(|half| [half, -half]) {
        let lobe = |weight: f64, mean: DVec2, variance: f64| {
            let squared = half.truncate().distance_squared(mean) / (variance + 1.0 / 64.0);
            weight * (-0.5 * squared).exp() / (std::f64::consts::TAU * (variance + 1.0 / 64.0))
        };
        let above = lobe(0.3, DVec2::new(0.2, -0.1), 0.01) + lobe(0.7, DVec2::new(-0.4, 0.3), 0.05);
        let expected = if half.z > 0.0 { above } else { 0.0 };
        let found = gmm::effective_brdf(&mixture, blinn_phong(64.0), half);
        assert!((found - expected).abs() < 1e-12, "{half}: {found} against {expected}");
    }
}

#[test]
fn four_gaussians_beat_one_where_there_are_four_facets() {
    let facets =
        [Vec3::new(0.5, 0.0, 1.0), Vec3::new(-0.5, 0.0, 1.0), Vec3::new(0.0, 0.5, 1.0), Vec3::new(0.0, -0.5, 1.0)];
    let map = maps::map(32, 32, Addressing::Wrap, |x, y| facets[x % 2 + 2 * (y % 2)].normalize());
    let top = Texel { level: 5, x: 0, y: 0 };
    let error = |name| relative_error(&*build(name, &map), &truth(&map), top, blinn_phong(64.0));
    assert!(error("gmm:4") < 0.25 && error("gmm:1") > 0.7, "{} and {}", error("gmm:4"), error("gmm:1"));
}

#[test]
fn every_rival_is_finite_over_invalid_steep_and_buried_normals() {
    let map = maps::map(12, 8, Addressing::Clamp, |x, y| match (x + 3 * y) % 5 {
        0 => Vec3::ZERO,
        1 => Vec3::X,
        2 => Vec3::new(0.3, 0.1, -0.9),
        3 => Vec3::NEG_Z,
        _ => Vec3::new(-0.9, 0.1, 0.01),
    });
    let empty = maps::map(4, 4, Addressing::Wrap, |_, _| Vec3::ZERO);
    let light = LocalLight { light_in_tangent: Vec3::new(0.6, 0.0, 0.8), half_in_tangent: Vec3::Z };
    for (map, rival) in [map, empty].iter().flat_map(|map| Rival::offered().map(move |rival| (map, rival))) {
        let filter = build(&rival.to_string(), map);
        for texel in middles(map) {
            for omega in [DVec3::Z, DVec3::X, DVec3::NEG_Z] {
                let value = filter.effective_brdf(texel, blinn_phong(400.0), omega);
                assert!(value.is_finite(), "{rival} {texel} {omega}: {value}");
            }
            let lod = texel.level as f32 + 0.3;
            let lookup = Lookup {
                uv: Vec2::splat(0.37),
                footprint: PixelFootprint::default(),
                lod,
                pixel: [0, 0],
                tangent_from_map: Mat3::IDENTITY,
            };
            let color = filter.shade(&lookup, &light, &Material::default());
            assert!(color.is_finite(), "{rival} at {lod}: {color}");
        }
    }
}
