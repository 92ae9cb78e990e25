//! Laws of the fit.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use ndf_inspector::filter::vmf::em::{self, Stop};
use ndf_inspector::filter::vmf::fit::{FitEvent, expected_visits, fit};
use ndf_inspector::filter::vmf::samples::FootprintSamples;
use ndf_inspector::filter::vmf::{Alignment, EStep, FitSettings, LobePyramid, Monitor, Objective, seed, smooth};
use ndf_inspector::normal_map::procedural;
use ndf_inspector::normal_map::pyramid::{Footprint, Texel};
use ndf_inspector::normal_map::{Addressing, NormalMap};
use ndf_inspector::sphere::Mixture;
use ndf_inspector::sphere::vmf::{self, KappaRule};
use proptest::prelude::*;

use crate::gpu::maps::{map as map_of, noise};

/// Fits a map to the end.
pub fn fitted(map: &Arc<NormalMap>, settings: &FitSettings) -> LobePyramid {
    let monitor = Monitor::new(expected_visits(map, settings));
    fit(map, settings, &monitor, &mut |_| {}).expect("nobody cancels")
}

fn unaligned(lobes: usize) -> FitSettings {
    FitSettings { lobes, objective: Objective::Em, align: Alignment::None, ..FitSettings::default() }
}

fn top(map: &NormalMap) -> Texel {
    Texel { level: map.level_sizes().len() - 1, x: 0, y: 0 }
}

/// Everything finite, weights that sum to 1, unit directions, for every texel of every level.
pub fn assert_sound(lobes: &LobePyramid) {
    for (level, (width, height)) in lobes.map.level_sizes().into_iter().enumerate() {
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let mixture = lobes.mixture(Texel { level, x, y }).expect("fitted");
            let weight: f64 = mixture.lobes.iter().map(|(_, lobe)| lobe.weight).sum();
            let valid = level > 0 || lobes.map.normal(y * width + x).is_some();
            assert!(!valid || (weight - 1.0).abs() < 1e-5, "level {level} ({x}, {y}): weights sum to {weight}");
            for (_, lobe) in &mixture.lobes {
                assert!((lobe.mean_direction.length() - 1.0).abs() < 1e-5, "{lobe:?}");
                assert!((0.0..=vmf::KAPPA_DELTA).contains(&lobe.concentration), "{lobe:?}");
            }
        }
    }
}

/// A map of samples of known lobes, in random order.
fn map_of_lobes(size: usize, lobes: &[(f64, DVec3, f64)]) -> Arc<NormalMap> {
    map_of(size, size, Addressing::Wrap, |x, y| {
        let index = y * size + x;
        let mut pick = f64::from(noise(3 * index));
        let lobe = lobes.iter().find(|lobe| {
            pick -= lobe.0;
            pick < 0.0
        });
        let &(_, mu, kappa) = lobe.unwrap_or(&lobes[0]);
        let u = f64::from(noise(3 * index + 1)).max(1e-9);
        let cosine = 1.0 + (u + (1.0 - u) * (-2.0 * kappa).exp()).ln() / kappa;
        let angle = f64::from(noise(3 * index + 2)) * std::f64::consts::TAU;
        let (e1, e2) = mu.any_orthonormal_pair();
        (cosine * mu + (1.0 - cosine * cosine).sqrt() * (angle.cos() * e1 + angle.sin() * e2)).as_vec3()
    })
}

#[test]
fn lobes_that_made_a_map_are_found_again() {
    let direction = |x: f64, y: f64| DVec3::new(x, y, 1.0).normalize();
    let made =
        [(0.5, direction(0.0, 0.0), 40.0), (0.3, direction(1.2, 0.2), 120.0), (0.2, direction(-0.6, -1.0), 300.0)];
    let map = map_of_lobes(256, &made);
    let lobes = fitted(&map, &unaligned(3));
    let mut found: Vec<_> = lobes.mixture(top(&map)).expect("fitted").lobes.into_iter().map(|(_, lobe)| lobe).collect();
    found.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    for (lobe, (alpha, mu, kappa)) in found.iter().zip(made) {
        assert!((lobe.weight - alpha).abs() < 0.01, "{lobe:?}");
        assert!(lobe.mean_direction.angle_between(mu).to_degrees() < 1.0, "{lobe:?}");
        assert!((lobe.concentration / kappa - 1.0).abs() < 0.05, "{lobe:?}");
    }
}

#[test]
fn em_never_lowers_the_likelihood() {
    let map = procedural::find("bricks").expect("bundled").make(64);
    let footprint = Footprint::new((64, 64), (1, 1), (0, 0));
    let samples = FootprintSamples::new(&map, footprint);
    let (centres, count) = seed::farthest_normals(&map, &footprint, 6);
    let mut lobes = seed::assign(&samples, &centres[..count], 6);
    let mut previous = f64::NEG_INFINITY;
    for iteration in 0..60 {
        let step =
            em::fit(&samples, lobes, Stop { iterations: 1, tolerance: f64::NEG_INFINITY }, KappaRule::Exact, |_| true);
        // f32 densities round the mean by about 1e-6.
        assert!(step.mean_log_likelihood > previous - 2e-6, "{iteration}: {previous} to {}", step.mean_log_likelihood);
        (previous, lobes) = (step.mean_log_likelihood, step.lobes);
    }
}

#[test]
fn the_reported_likelihood_is_that_of_the_stored_lobes_in_f64() {
    let map = Arc::new(procedural::find("pyramid5").expect("bundled").make(64));
    let settings = unaligned(5);
    let lobes = fitted(&map, &settings);
    let reported = smooth::mean_log_likelihood(&map, lobes.level(6).expect("fitted"), (0, 0), &settings);
    let mixture: Mixture = lobes.mixture(top(&map)).expect("fitted");
    let exact = (0..map.len()).map(|i| mixture.density(map.normal(i).expect("valid").as_dvec3()).ln()).sum::<f64>();
    assert!((reported - exact / map.len() as f64).abs() < 1e-4, "{reported} against {exact}");
}

#[test]
fn one_thread_and_many_give_the_same_bits() {
    let map = Arc::new(procedural::find("waves").expect("bundled").make(96));
    for align in [Alignment::None, Alignment::default(), Alignment::Paper { c: 0.1 }, Alignment::Map { c: 1.0 }] {
        let settings = FitSettings { align, lobes: 4, iterations: 20, ..FitSettings::default() };
        let run = |threads| {
            let pool = ndf_inspector::jobs::fit_pool(Some(threads)).expect("threads");
            pool.install(|| fitted(&map, &settings))
        };
        let (one, many) = (run(1), run(5));
        assert_eq!(one.base, many.base);
        assert_eq!(one.coarse, many.coarse, "{align}");
    }
}

#[test]
fn an_aligned_texel_keeps_its_exact_mean_normal() {
    let map = Arc::new(procedural::find("scales").expect("bundled").make(64));
    // The top is no aligned texel: with Gauss-Newton steps its mean is near, not exact.
    let settings = FitSettings { iterations: 20, objective: Objective::Em, ..FitSettings::default() };
    let lobes = fitted(&map, &settings);
    for (level, (width, height)) in map.level_sizes().into_iter().enumerate().skip(1) {
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let stored = lobes.level(level).expect("fitted").texel(x, y);
            let mean: Vec3 = stored.iter().map(|s| Vec3::new(s[1], s[2], s[3])).sum();
            let exact = ndf_inspector::ndf::Ndf::of_texel(&map, Texel { level, x, y }).mean().as_vec3();
            assert!(mean.distance(exact) < 1e-5, "level {level} ({x}, {y}): {mean} against {exact}");
        }
    }
}

#[test]
fn every_alignment_survives_odd_sizes_invalid_texels_and_clamped_edges() {
    for (width, height) in [(1, 1), (1, 9), (37, 1), (7, 5), (10, 24)] {
        for align in [Alignment::None, Alignment::default(), Alignment::Paper { c: 0.5 }, Alignment::Map { c: 1.0 }] {
            let map = map_of(width, height, Addressing::Clamp, |x, y| {
                let i = y * width + x;
                if i % 11 == 3 { Vec3::ZERO } else { Vec3::new(noise(i) - 0.5, noise(i + 999) - 0.5, 0.4) }
            });
            assert_sound(&fitted(&map, &FitSettings { align, lobes: 5, iterations: 20, ..FitSettings::default() }));
        }
    }
}

/// Normals by index that have broken fits: degenerate footprints, the last without anything valid.
pub const HOSTILE: [fn(usize) -> Vec3; 6] = [
    |_| Vec3::new(0.2, 0.1, 1.0),                                 // all equal
    |i| Vec3::new(if i % 2 == 0 { 1.0 } else { -1.0 }, 0.0, 0.0), // two opposite
    |i| Vec3::new([0.5, -0.5, 0.0][i % 3], 0.2, 1.0),             // fewer distinct than lobes
    |i| Vec3::new(noise(i) - 0.5, noise(i + 77) - 0.5, -1.0),     // below the horizon
    |i| if i == 5 { Vec3::X } else { Vec3::Z },                   // one outlier
    |_| Vec3::ZERO,                                               // nothing valid
];

#[test]
fn degenerate_footprints_give_finite_lobes() {
    for (number, normal) in HOSTILE.into_iter().enumerate() {
        let map = map_of(16, 16, Addressing::Wrap, |x, y| normal(y * 16 + x));
        for align in [Alignment::None, Alignment::default(), Alignment::Paper { c: 2.0 }, Alignment::Map { c: 2.0 }] {
            let lobes = fitted(&map, &FitSettings { align, ..FitSettings::default() });
            if number < 5 {
                assert_sound(&lobes);
            } else {
                let flat = lobes.mixture(top(&map)).expect("fitted");
                assert!((flat.lobes[0].1.mean_direction - DVec3::Z).length() < 1e-6, "flat stands in: {flat:?}");
            }
        }
    }
}

#[test]
fn more_lobes_never_explain_a_map_worse() {
    let map = Arc::new(procedural::find("flakes").expect("bundled").make(64));
    let likelihood = |lobes| {
        let settings = unaligned(lobes);
        let lobes = fitted(&map, &settings);
        smooth::mean_log_likelihood(&map, lobes.level(6).expect("fitted"), (0, 0), &settings)
    };
    let all: Vec<f64> = [1, 2, 4, 8, 16].into_iter().map(likelihood).collect();
    assert!(all.windows(2).all(|pair| pair[1] > pair[0] - 1e-3), "{all:?}");
}

#[test]
fn a_cancelled_fit_says_so_and_keeps_nothing_half_done() {
    let map = Arc::new(procedural::find("bricks").expect("bundled").make(128));
    let settings = FitSettings::default();
    let monitor = Monitor::new(expected_visits(&map, &settings));
    let mut levels = 0;
    let result = fit(&map, &settings, &monitor, &mut |event| {
        if matches!(event, FitEvent::Level { .. }) {
            levels += 1;
            monitor.cancel();
        }
    });
    assert!(result.is_err());
    assert_eq!(levels, 1, "no level is reported after the cancel");
}

#[test]
fn alignment_brings_neighbours_lobes_together() {
    let map = Arc::new(procedural::find("waves").expect("bundled").make(64));
    let angle = |align| {
        let lobes = fitted(&map, &FitSettings { align, iterations: 20, ..FitSettings::default() });
        let level = lobes.level(3).expect("fitted");
        let (mut sum, mut total) = (0.0, 0.0);
        for (x, y) in (0..8).flat_map(|y| (0..8).map(move |x| (x, y))) {
            for (a, b) in level.texel(x, y).iter().zip(level.texel((x + 1) % 8, y)) {
                let direction = |s: &[f32; 4]| Vec3::new(s[1], s[2], s[3]);
                if a[0] > 1e-3 && b[0] > 1e-3 {
                    sum += a[0] * direction(a).angle_between(direction(b)).to_degrees();
                    total += a[0];
                }
            }
        }
        sum / total
    };
    let (none, smooth) = (angle(Alignment::None), angle(Alignment::default()));
    assert!(smooth < 0.7 * none, "lobe j and its neighbour's lobe j: {smooth} against {none} degrees");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mixture_of_normals_gives_sound_lobes(
        seeds in prop::collection::vec((any::<u32>(), 0.0_f32..4.0), 16),
        lobes in 1_usize..=8,
    ) {
        let map = map_of(4, 4, Addressing::Wrap, |x, y| {
            let (seed, spread) = seeds[y * 4 + x];
            let unit = |salt: usize| noise(seed as usize % 1_000_003 + salt) * 2.0 - 1.0;
            // Spreads near 0 make nearly equal normals, large ones any direction.
            Vec3::Z + spread * spread * spread * Vec3::new(unit(0), unit(1), unit(2))
        });
        assert_sound(&fitted(&map, &unaligned(lobes)));
    }
}

#[test]
fn the_e_step_as_printed_ends_elsewhere_and_lower() {
    let map = Arc::new(procedural::find("bricks").expect("bundled").make(64));
    let mean = |e_step| {
        let settings = FitSettings { e_step, ..unaligned(5) };
        let lobes = fitted(&map, &settings);
        assert_sound(&lobes);
        smooth::mean_log_likelihood(&map, lobes.level(6).expect("fitted"), (0, 0), &settings)
    };
    let (right, printed) = (mean(EStep::WithAlpha), mean(EStep::AsPrinted));
    assert!(printed < right - 1e-3, "{printed} {right}");
}
