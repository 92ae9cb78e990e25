//! Laws of alignment: what makes lobe j mean the same thing in neighbouring texels, and what that may not change.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use ndf_inspector::filter::vmf::coherence::{self, Between, Blend, Interpolation};
use ndf_inspector::filter::vmf::em::TexelLobes;
use ndf_inspector::filter::vmf::pull::Pull;
use ndf_inspector::filter::vmf::samples::FootprintSamples;
use ndf_inspector::filter::vmf::scanline::PulledTexel;
use ndf_inspector::filter::vmf::{
    Alignment, FitSettings, LobePyramid, MixtureLevel, Monitor, Objective, between, looks::Looks, smooth,
};
use ndf_inspector::normal_map::pose::Pose;
use ndf_inspector::normal_map::pyramid::Footprint;
use ndf_inspector::normal_map::{Addressing, NormalMap, procedural};
use ndf_inspector::sphere::mixture::EMPTY_WEIGHT;
use ndf_inspector::sphere::vmf::KappaRule;

use crate::fit::{HOSTILE, assert_sound, fitted};
use crate::gpu::maps::{map as map_of, noise, rough};

fn settings(align: Alignment) -> FitSettings {
    FitSettings { align, lobes: 4, iterations: 30, ..FitSettings::default() }
}

fn sample(name: &str, size: usize) -> Arc<NormalMap> {
    Arc::new(procedural::find(name).expect("bundled").make(size))
}

fn texels(level: &MixtureLevel) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (width, height) = (level.width, level.height);
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
}

#[test]
fn an_alignment_is_read_as_it_is_written() {
    for text in ["none", "smooth", "smooth:0.3", "paper:2", "paper:0", "map:1", "map:0.25"] {
        let align: Alignment = text.parse().expect(text);
        assert_eq!(align.to_string(), text);
        let json = serde_json::to_string(&align).expect("serialises");
        assert_eq!(json, format!("\"{text}\""));
        assert_eq!(serde_json::from_str::<Alignment>(&json).expect("reads"), align);
    }
    for text in ["map", "map:-1", "map:x", "paper:101", "smooth:1"] {
        assert!(text.parse::<Alignment>().is_err(), "{text}");
    }
}

/// One level below an aligned one, texel after texel in scanline order, everything written out.
fn scanline(lobes: &LobePyramid, level: usize, pull: Pull, iterations: usize) -> MixtureLevel {
    let coarse = lobes.level(level + 1).expect("fitted");
    let map = &lobes.map;
    let size = map.level_sizes()[level];
    let mut mixtures = MixtureLevel::empty(size, coarse.lobes);
    smooth::blend_down(coarse, &mut mixtures, map.options.addressing);
    for (x, y) in texels(&mixtures.clone()) {
        let mut towards = vec![DVec3::ZERO; coarse.lobes];
        let mut neighbours =
            vec![coarse.texel((2 * x + 1) * coarse.width / (2 * size.0), (2 * y + 1) * coarse.height / (2 * size.1))];
        let mut add = |is_there: bool, x: usize, y: usize| {
            if is_there {
                neighbours.push(mixtures.texel(x, y));
            }
        };
        add(x > 0, x.wrapping_sub(1), y);
        add(x > 0 && y > 0, x.wrapping_sub(1), y.wrapping_sub(1));
        add(y > 0, x, y.wrapping_sub(1));
        add(x + 1 < size.0 && y > 0, x + 1, y.wrapping_sub(1));
        for stored in neighbours {
            for (sum, s) in towards.iter_mut().zip(stored).filter(|(_, s)| s[0] > EMPTY_WEIGHT) {
                *sum += f64::from(s[0]) * Vec3::new(s[1], s[2], s[3]).as_dvec3().normalize();
            }
        }
        let mut fit = TexelLobes::from_stored(mixtures.texel(x, y));
        let samples = FootprintSamples::new(map, Footprint::new((map.width, map.height), size, (x, y)));
        for _ in 0..iterations {
            let kernel = fit.for_e_step(KappaRule::Exact);
            let sums = samples.e_step(&kernel);
            if sums.total == 0.0 {
                fit = TexelLobes::flat(coarse.lobes);
                break;
            }
            fit.m_step(&kernel, &sums);
            for j in (0..coarse.lobes).filter(|&j| fit.alpha[j] > 0.0 && towards[j] != DVec3::ZERO) {
                let kappa = -2.0 * f64::from(kernel.neg_half_kappa[j]);
                let r = fit.resultant[j];
                let mu = match pull {
                    Pull::Paper { c } => (r + c * towards[j]).normalize(),
                    Pull::Map { c } => (kappa * fit.alpha[j] * r + c * towards[j]).normalize(),
                };
                fit.resultant[j] = r.dot(mu).max(1e-9) * mu;
            }
        }
        let start = (y * size.0 + x) * coarse.lobes;
        fit.store(&mut mixtures.stored[start..start + coarse.lobes]);
    }
    mixtures
}

#[test]
fn the_wavefront_gives_bit_for_bit_what_the_scanline_gives() {
    for map in [sample("bricks", 32), rough(37, 22, Addressing::Wrap), rough(9, 40, Addressing::Clamp)] {
        for (align, pull, iterations) in [
            (Alignment::Paper { c: 2.0 }, Pull::Paper { c: 2.0 }, 10),
            (Alignment::Paper { c: 0.1 }, Pull::Paper { c: f64::from(0.1_f32) }, 10),
            (Alignment::Map { c: 1.0 }, Pull::Map { c: 1.0 }, 5),
        ] {
            let lobes = fitted(&map, &settings(align));
            for level in 1..lobes.levels() - 1 {
                let naive = scanline(&lobes, level, pull, iterations);
                assert!(**lobes.level(level).expect("fitted") == naive, "{align}, level {level}");
            }
        }
    }
}

#[test]
fn a_pull_of_nothing_is_plain_em_from_the_coarse_seed() {
    let map = sample("scales", 32);
    for (align, iterations) in [(Alignment::Paper { c: 0.0 }, 10), (Alignment::Map { c: 0.0 }, 5)] {
        let lobes = fitted(&map, &settings(align));
        for level in 1..lobes.levels() - 1 {
            let aligned = lobes.level(level).expect("fitted");
            let mut plain = MixtureLevel::empty((aligned.width, aligned.height), aligned.lobes);
            smooth::blend_down(lobes.level(level + 1).expect("fitted"), &mut plain, Addressing::Wrap);
            for (x, y) in texels(aligned) {
                let footprint = Footprint::new((32, 32), (aligned.width, aligned.height), (x, y));
                let samples = FootprintSamples::new(&map, footprint);
                let mut fit = TexelLobes::from_stored(plain.texel(x, y));
                for _ in 0..iterations {
                    let kernel = fit.for_e_step(KappaRule::Exact);
                    fit.m_step(&kernel, &samples.e_step(&kernel));
                }
                let mut stored = vec![[0.0; 4]; aligned.lobes];
                fit.store(&mut stored);
                assert_eq!(aligned.texel(x, y), stored, "{align}, level {level} ({x}, {y})");
            }
        }
    }
}

#[test]
fn the_penalised_log_likelihood_never_falls() {
    let map = sample("bricks", 64);
    for c in [0.1_f32, 1.0, 10.0, 100.0] {
        let lobes = fitted(&map, &settings(Alignment::Map { c }));
        let pull = Pull::Map { c: f64::from(c) };
        for level in 1..lobes.levels() - 1 {
            let (coarse, fine) = (lobes.level(level + 1).expect("fitted"), lobes.level(level).expect("fitted"));
            let mut seed = (**fine).clone();
            smooth::blend_down(coarse, &mut seed, Addressing::Wrap);
            for (x, y) in texels(fine) {
                let texel = PulledTexel::new(&lobes, coarse, fine, (x, y), pull, &FitSettings::default());
                let mut fit = TexelLobes::from_stored(seed.texel(x, y));
                let values: Vec<f64> = (0..30).map(|_| texel.step(&mut fit).expect("valid normals")).collect();
                for pair in values.windows(2) {
                    // f32 densities round the mean by about 1e-6 of its size, and a lobe that is retired takes at
                    // most its weight of 1e-7 with it.
                    let rounding = 3e-6 * (1.0 + pair[0].abs());
                    assert!(pair[1] > pair[0] - rounding, "c {c}, level {level} ({x}, {y}): {values:?}");
                }
            }
        }
    }
}

/// The map as it looks in a mirror, upside down, and turned to the left.
fn turned(map: &Arc<NormalMap>) -> [(&'static str, Arc<NormalMap>); 3] {
    let [as_it_is, transposed] = [false, true].map(|transposed| Pose { transposed, ..Pose::IDENTITY });
    [
        ("mirrored", Pose { mirrored: true, ..as_it_is }.map(map)),
        ("flipped", Pose { flipped: true, ..as_it_is }.map(map)),
        ("turned", Pose { mirrored: true, ..transposed }.map(map)),
    ]
}

fn log_likelihoods(map: &Arc<NormalMap>, settings: &FitSettings) -> Vec<f64> {
    let lobes = fitted(map, settings);
    let mean = |level: &MixtureLevel| {
        let all = texels(level).map(|texel| smooth::mean_log_likelihood(map, level, texel, settings));
        all.sum::<f64>() / (level.width * level.height) as f64
    };
    lobes.coarse.iter().flatten().map(|level| mean(level)).collect()
}

#[test]
fn a_map_mirrored_flipped_or_turned_has_the_same_likelihood_at_every_level() {
    for sample in procedural::SAMPLES {
        let map = Arc::new(sample.make(64));
        for align in [Alignment::None, Alignment::default()] {
            let settings = FitSettings { align, ..FitSettings::default() };
            let straight = log_likelihoods(&map, &settings);
            for (how, other) in turned(&map) {
                let other = log_likelihoods(&other, &settings);
                for (level, (a, b)) in straight.iter().zip(&other).enumerate() {
                    assert!((a - b).abs() < 1e-3, "{} {how}, {align}, level {}: {a} and {b}", sample.name, level + 1);
                }
            }
        }
    }
}

#[test]
fn lobes_are_mirrored_flipped_and_turned_with_the_map() {
    for map in [rough(24, 24, Addressing::Wrap), rough(37, 22, Addressing::Clamp), rough(1, 9, Addressing::Wrap)] {
        for align in [Alignment::None, Alignment::default()] {
            let settings = settings(align);
            let straight = fitted(&map, &settings);
            for pose in Pose::all() {
                let image = fitted(&pose.map(&map), &settings);
                assert_eq!(image.coarse, straight.posed(pose).coarse, "{pose:?}, {align}");
            }
        }
    }
}

#[test]
fn the_top_level_is_that_of_no_alignment() {
    let map = sample("flakes", 32);
    let top = |align| fitted(&map, &settings(align)).coarse.last().cloned().flatten().expect("fitted");
    let none = top(Alignment::None);
    for align in [Alignment::Smooth { blend: 0.0 }, Alignment::default(), Alignment::Map { c: 1.0 }] {
        assert!(top(align) == none, "{align}");
    }
}

#[test]
fn an_aligned_map_of_one_normal_is_coherent_and_interpolates_without_error() {
    let map = map_of(16, 16, Addressing::Wrap, |_, _| Vec3::new(0.2, 0.1, 1.0));
    let lobes = fitted(&map, &settings(Alignment::default()));
    for level in 1..lobes.levels() {
        let figures = coherence::measure(&lobes, level).expect("fitted");
        assert!(figures.coherence_deg < 1e-3, "level {level}: {figures:?}");
        assert!(figures.interpolation_error < 1e-4, "level {level}: {figures:?}");
        assert_eq!(figures.trilinear_error.is_some(), level + 1 < lobes.levels());
    }
}

#[test]
fn a_small_angle_alone_is_no_success() {
    let map = sample("waves", 128);
    let figures = |align| {
        let lobes = fitted(&map, &FitSettings { align, ..FitSettings::default() });
        coherence::measure(&lobes, 3).expect("fitted")
    };
    let (smooth, paper) = (figures(Alignment::default()), figures(Alignment::Paper { c: 2.0 }));
    assert!(paper.coherence_deg < smooth.coherence_deg, "{paper:?} and {smooth:?}");
    assert!(paper.interpolation_error > 2.0 * smooth.interpolation_error, "{paper:?} and {smooth:?}");
}

#[test]
fn the_figures_are_the_same_on_one_thread_and_on_many() {
    let map = rough(48, 20, Addressing::Clamp);
    let lobes = fitted(&map, &settings(Alignment::default()));
    let run = |threads| {
        let pool = ndf_inspector::jobs::fit_pool(Some(threads)).expect("threads");
        pool.install(|| coherence::measure(&lobes, 2))
    };
    assert_eq!(run(1), run(5));
}

/// Aligned lobes that steps between texels are to refine.
fn refining() -> FitSettings {
    FitSettings { objective: Objective::APPEARANCE, ..FitSettings::default() }
}

#[test]
fn steps_between_texels_never_raise_what_they_lower() {
    for map in [sample("waves", 64), sample("bricks", 64), rough(37, 22, Addressing::Clamp)] {
        let settings = refining();
        let lobes = fitted(&map, &settings);
        let monitor = Monitor::new(vec![1; lobes.levels()]);
        let looks = Looks::new(&map, &monitor).expect("nobody cancels");
        for level in 2..lobes.levels() - 1 {
            let mut mixtures = smooth::pass_over(&lobes, level, 0.15, &settings, &monitor).expect("nobody cancels");
            let mut refine =
                |rounds| between::refine(&map, &looks, level, &mut mixtures, rounds, &monitor).expect("nobody cancels");
            let (start, _) = refine(0);
            let mut energy = start;
            for rounds in [1, 2, 5] {
                let (before, after) = refine(rounds);
                assert_eq!(before, energy, "level {level}: E is that of the lobes");
                assert!(after <= before, "level {level}: {before} to {after}");
                energy = after;
            }
            assert!(energy < start, "level {level}: some round was kept");
        }
    }
}

#[test]
fn steps_between_texels_mend_what_is_interpolated() {
    for name in ["waves", "plate", "flakes"] {
        let map = sample(name, 128);
        let error = |objective| {
            let lobes = fitted(&map, &FitSettings { objective, ..FitSettings::default() });
            let at = |level| Interpolation::new(&map, level, Between::Texels).error(&lobes, Blend::Lobes);
            (2..=5).map(at).sum::<f64>() / 4.0
        };
        let (without, with) = (error(Objective::Appearance { steps: 0 }), error(Objective::APPEARANCE));
        assert!(with < 0.85 * without, "{name}: {without} to {with}");
    }
}

#[test]
fn a_map_mirrored_flipped_or_turned_is_mended_as_much() {
    let map = sample("waves", 64);
    let error = |map: &Arc<NormalMap>| {
        let lobes = fitted(map, &refining());
        let at = |level| Interpolation::new(map, level, Between::Texels).error(&lobes, Blend::Lobes);
        (2..=4).map(at).sum::<f64>() / 3.0
    };
    let straight = error(&map);
    for (how, other) in turned(&map) {
        let other = error(&other);
        // The directions that looks are taken in are not mirrored with the map.
        assert!((other / straight - 1.0).abs() < 0.02, "{how}: {straight} and {other}");
    }
}

#[test]
fn steps_between_texels_survive_hostile_maps() {
    for normal in HOSTILE {
        for addressing in [Addressing::Wrap, Addressing::Clamp] {
            assert_sound(&fitted(&map_of(32, 32, addressing, |x, y| normal(y * 32 + x)), &refining()));
        }
        let down = map_of(16, 16, Addressing::Wrap, |x, y| normal(y * 16 + x) * Vec3::new(1.0, 1.0, -1.0));
        assert_sound(&fitted(&down, &refining()));
    }
    for (width, height) in [(1, 1), (1, 70), (37, 1), (7, 5), (45, 70)] {
        for addressing in [Addressing::Wrap, Addressing::Clamp] {
            let map = map_of(width, height, addressing, |x, y| {
                let i = y * width + x;
                if i % 11 == 3 { Vec3::ZERO } else { Vec3::new(noise(i) - 0.5, noise(i + 999) - 0.5, 0.4) }
            });
            for lobes in [1, 2, 6, 16] {
                assert_sound(&fitted(&map, &FitSettings { lobes, ..refining() }));
            }
        }
    }
}

#[test]
fn steps_between_texels_give_the_same_bits_on_one_thread_and_on_many() {
    let map = rough(90, 52, Addressing::Clamp);
    let run = |threads| {
        let pool = ndf_inspector::jobs::fit_pool(Some(threads)).expect("threads");
        pool.install(|| fitted(&map, &refining()))
    };
    assert_eq!(run(1).coarse, run(3).coarse);
}
