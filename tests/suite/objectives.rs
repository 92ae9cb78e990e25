//! Laws of the objectives that a texel's fit may have.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use ndf_inspector::filter::vmf::bins::BinnedSamples;
use ndf_inspector::filter::vmf::em::TexelLobes;
use ndf_inspector::filter::vmf::phi::{Evaluation, LobeStep, Parameters};
use ndf_inspector::filter::vmf::samples::FootprintSamples;
use ndf_inspector::filter::vmf::shaded::MATERIALS;
use ndf_inspector::filter::vmf::{Alignment, FitSettings, Objective, em, gauss_newton, smooth};
use ndf_inspector::normal_map::procedural;
use ndf_inspector::normal_map::pyramid::Footprint;
use ndf_inspector::normal_map::{Addressing, NormalMap};
use ndf_inspector::sphere::mixture::MAX_LOBES;
use ndf_inspector::sphere::vmf::KappaRule;
use proptest::prelude::*;

use crate::fit::{HOSTILE, assert_sound, fitted};
use crate::gpu::maps::{map as map_of, noise};

const OBJECTIVES: [Objective; 2] = [Objective::Appearance { steps: 3 }, Objective::Likelihood];

fn settings(objective: Objective, lobes: usize) -> FitSettings {
    FitSettings { lobes, objective, align: Alignment::None, ..FitSettings::default() }
}

/// A map and lobes near its normals, though not their fit.
fn rough_lobes() -> (NormalMap, TexelLobes) {
    let map = procedural::find("bricks").expect("bundled").make(32);
    let mut lobes = TexelLobes::empty(4);
    for j in 0..4 {
        let salt = |axis: usize| f64::from(noise(10 * j + axis)) - 0.5;
        lobes.alpha[j] = [0.4, 0.3, 0.2, 0.1][j];
        lobes.resultant[j] = DVec3::new(salt(0), salt(1), 1.0).normalize() * [0.7, 0.9, 0.97, 0.995][j];
    }
    (map, lobes)
}

fn whole(map: &NormalMap) -> Footprint {
    Footprint::new((map.width, map.height), (1, 1), (0, 0))
}

#[test]
fn the_gradient_of_phi_equals_finite_differences() {
    let (map, lobes) = rough_lobes();
    let samples = FootprintSamples::new(&map, whole(&map));
    let here = Evaluation::new(&samples, Parameters::of(&lobes)).expect("valid normals");
    for material in 0..MATERIALS.len() {
        // One material at a time: the weights of a fit would hide an error in the weakest.
        let mut weights = [0.0; MATERIALS.len()];
        weights[material] = here.weights()[material];
        let gradient = gauss_newton::half_gradient(&here, &weights);
        let frames = gauss_newton::frames(&here.at);
        let largest = gradient.iter().flatten().fold(0.0_f64, |largest, g| largest.max(g.abs()));
        for (j, p) in (0..4).flat_map(|j| (0..4).map(move |p| (j, p))) {
            // f32 sums resolve Phi to 1e-7; central differences over 1e-2 resolve its slope to 1e-4.
            let phi = |h: f64| {
                let mut steps = [LobeStep::default(); MAX_LOBES];
                match p {
                    0 => steps[j].log_alpha = h,
                    1 => steps[j].tangent = h * frames[j].0,
                    2 => steps[j].tangent = h * frames[j].1,
                    _ => steps[j].log_kappa = h,
                }
                Evaluation::new(&samples, here.at.moved(&steps)).expect("valid normals").phi(&weights)
            };
            let h = 2e-3;
            let slope = (8.0 * (phi(h) - phi(-h)) - (phi(2.0 * h) - phi(-2.0 * h))) / (12.0 * h);
            let found = 2.0 * gradient[j][p];
            assert!((found - slope).abs() < 2e-3 * largest, "s {}, {j}, {p}: {found}, {slope}", MATERIALS[material]);
        }
    }
}

#[test]
fn gauss_newton_never_raises_phi() {
    for (seed, name) in ["bricks", "waves", "flakes", "scales"].into_iter().enumerate() {
        let map = procedural::find(name).expect("bundled").make(32);
        let samples = FootprintSamples::new(&map, whole(&map));
        let (_, mut lobes) = rough_lobes();
        lobes.resultant.rotate_left(seed);
        lobes.resultant[4..].fill(DVec3::ZERO);
        lobes.resultant[..4].iter_mut().filter(|r| r.length() == 0.0).for_each(|r| *r = 0.5 * DVec3::Z);
        let start = Evaluation::new(&samples, Parameters::of(&lobes)).expect("valid normals");
        let weights = start.weights();
        let mut previous = start.phi(&weights);
        for steps in 1..=8 {
            let mut refined = lobes;
            gauss_newton::refine(&samples, &mut refined, steps, &mut || true);
            let phi = Evaluation::new(&samples, Parameters::of(&refined)).expect("valid normals").phi(&weights);
            assert!(phi <= previous + 1e-6 * previous.abs(), "{name}, {steps} steps: {previous} to {phi}");
            assert!((refined.alpha.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            previous = phi;
        }
        assert!(previous < start.phi(&weights), "{name}: some step was kept");
    }
}

#[test]
fn bins_give_the_e_step_that_every_normal_gives() {
    let map = procedural::find("plate").expect("bundled").make(128);
    let footprint = whole(&map);
    let (_, lobes) = rough_lobes();
    let kernel = lobes.for_e_step(KappaRule::Exact);
    let all = em::e_step(&FootprintSamples::new(&map, footprint), &kernel);
    let binned = em::e_step(&BinnedSamples::new(&map, &footprint), &kernel);
    assert!((all.total - binned.total).abs() < 1e-3);
    // Responsibilities are shared by a whole cell, 0.03 across, where lobes of kappa 200 are 0.07 wide.
    assert!((all.log_likelihood - binned.log_likelihood).abs() < 2e-3 * all.total);
    for j in 0..4 {
        assert!((all.weight[j] - binned.weight[j]).abs() < 2e-3 * all.total);
    }
}

#[test]
fn every_objective_survives_hostile_maps() {
    let more: [fn(usize) -> Vec3; 2] = [
        |i| if i % 13 == 3 { Vec3::Z } else { Vec3::ZERO }, // hardly anything valid
        |i| Vec3::new(noise(i), noise(i + 7), noise(i + 3)) * 2.0 - Vec3::ONE, // every direction
    ];
    for (number, normal) in HOSTILE.into_iter().chain(more).enumerate() {
        let map = map_of(64, 64, Addressing::Wrap, |x, y| normal(y * 64 + x));
        for objective in OBJECTIVES {
            let lobes = fitted(&map, &settings(objective, 6));
            assert_sound(&lobes);
            if number == 5 {
                let flat = lobes.level(6).expect("fitted").texel(0, 0)[0];
                assert_eq!(flat, [1.0, 0.0, 0.0, 1.0], "flat stands in");
            }
        }
    }
}

#[test]
fn every_objective_survives_odd_sizes_and_few_or_many_lobes() {
    for (width, height) in [(1, 1), (1, 9), (37, 1), (7, 5), (45, 70)] {
        let map = map_of(width, height, Addressing::Clamp, |x, y| {
            let i = y * width + x;
            if i % 11 == 3 { Vec3::ZERO } else { Vec3::new(noise(i) - 0.5, noise(i + 999) - 0.5, 0.4) }
        });
        for (objective, lobes) in OBJECTIVES.into_iter().flat_map(|objective| [1, 2, 5, 16].map(|j| (objective, j))) {
            assert_sound(&fitted(&map, &settings(objective, lobes)));
        }
    }
}

#[test]
fn one_thread_and_many_give_the_same_bits_whatever_the_objective() {
    let map = Arc::new(procedural::find("waves").expect("bundled").make(300));
    for objective in OBJECTIVES {
        let run = |threads| {
            let pool = ndf_inspector::jobs::fit_pool(Some(threads)).expect("threads");
            pool.install(|| fitted(&map, &FitSettings { iterations: 10, ..settings(objective, 4) }))
        };
        assert_eq!(run(1).coarse, run(3).coarse, "{objective}");
    }
}

#[test]
fn the_likelihood_objective_is_no_worse_than_em_at_the_top() {
    for name in ["bricks", "waves", "flakes", "pyramid5"] {
        let map = Arc::new(procedural::find(name).expect("bundled").make(64));
        let likelihood = |objective| {
            let settings = settings(objective, 4);
            let lobes = fitted(&map, &settings);
            smooth::mean_log_likelihood(&map, lobes.level(6).expect("fitted"), (0, 0), &settings)
        };
        let (em, moved) = (likelihood(Objective::Em), likelihood(Objective::Likelihood));
        assert!(moved > em - 0.01, "{name}: {moved} against {em}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_mixture_of_normals_gives_sound_lobes_whatever_the_objective(
        seeds in prop::collection::vec((any::<u32>(), 0.0_f32..4.0), 16),
        lobes in 1_usize..=8,
    ) {
        let map = map_of(8, 8, Addressing::Wrap, |x, y| {
            let (seed, spread) = seeds[(y % 4) * 4 + x % 4];
            let unit = |salt: usize| noise(seed as usize % 1_000_003 + salt + 17 * (x / 4 + y / 4)) * 2.0 - 1.0;
            // Spreads near 0 make nearly equal normals, large ones any direction.
            Vec3::Z + spread * spread * spread * Vec3::new(unit(0), unit(1), unit(2))
        });
        for objective in OBJECTIVES {
            assert_sound(&fitted(&map, &settings(objective, lobes)));
        }
    }
}
