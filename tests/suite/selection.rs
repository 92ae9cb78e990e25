//! The number of lobes that a texel gets by itself.

use std::sync::Arc;

use ndf_inspector::filter::vmf::brdf_error::TrueBrdf;
use ndf_inspector::filter::vmf::em::TexelLobes;
use ndf_inspector::filter::vmf::fit::expected_visits;
use ndf_inspector::filter::vmf::samples::FootprintSamples;
use ndf_inspector::filter::vmf::{
    Alignment, FitSettings, LobeCount, LobePyramid, Monitor, Selection, coherence, unaligned,
};
use ndf_inspector::normal_map::pose::Pose;
use ndf_inspector::normal_map::pyramid::Footprint;
use ndf_inspector::normal_map::{Addressing, NormalMap, procedural};
use ndf_inspector::sphere::mixture::used;

use crate::fit::{HOSTILE, assert_sound, fitted};
use crate::gpu::maps::map as map_of;

fn settings(count: &str, align: Alignment) -> FitSettings {
    let LobeCount { most, selection } = count.parse().expect("a number of lobes");
    FitSettings { lobes: most, selection, align, ..FitSettings::default() }
}

/// Every texel of a level with its normals and its stored lobes.
fn texels<'a>(
    map: &'a NormalMap,
    lobes: &'a LobePyramid,
    level: usize,
) -> impl Iterator<Item = ((usize, usize), FootprintSamples<'a>, &'a [[f32; 4]])> {
    let mixtures = lobes.level(level).expect("fitted");
    let (width, height) = (mixtures.width, mixtures.height);
    (0..width * height).map(move |index| {
        let texel = (index % width, index / width);
        let footprint = Footprint::new((map.width, map.height), (width, height), texel);
        (texel, FootprintSamples::new(map, footprint), mixtures.texel(texel.0, texel.1))
    })
}

fn error(samples: &FootprintSamples<'_>, stored: &[[f32; 4]]) -> f64 {
    TrueBrdf::new(samples).expect("valid normals").error(&TexelLobes::from_stored(stored))
}

#[test]
fn a_texel_gets_the_fewest_lobes_whose_error_is_under_the_target() {
    let map = Arc::new(procedural::find("bricks").expect("bundled").make(64));
    let settings = settings("auto:3", Alignment::None);
    // As they lie while they are fitted: the directions that an error is measured in are not turned with a map.
    let lobes = fitted(&map, &settings).posed(Pose::canonical(&map));
    let (mut chosen, mut fewer_err) = (0, 0);
    for level in 1..lobes.levels() {
        for ((x, y), samples, stored) in texels(&lobes.map, &lobes, level) {
            let count = used(stored);
            assert!(error(&samples, stored) <= 0.03 + 1e-5 || count == settings.lobes, "level {level} ({x}, {y})");
            if level > 1 && count > 1 {
                let fewer = FitSettings { lobes: count - 1, selection: Selection::Fixed, ..settings };
                let monitor = Monitor::new(expected_visits(&map, &fewer));
                let fit = unaligned::fit_texel(&lobes, level, (x, y), &fewer, &monitor);
                chosen += 1;
                fewer_err += usize::from(TrueBrdf::new(&samples).expect("valid").error(&fit.lobes) > 0.03);
            }
        }
    }
    // Growing stops at the first number that will do, so one fewer would not; lobes that EM retires are the exception.
    assert!(chosen > 200 && fewer_err * 100 >= chosen * 98, "{fewer_err} of {chosen}");
}

#[test]
fn a_stricter_target_takes_more_lobes_and_interpolates_as_aligned_storage_does() {
    let map = Arc::new(procedural::find("waves").expect("bundled").make(64));
    let mean = |lobes: &LobePyramid| lobes.level(4).expect("fitted").mean_lobes();
    let [loose, strict] = ["auto:10", "auto:1"].map(|count| fitted(&map, &settings(count, Alignment::default())));
    assert!(mean(&strict) > mean(&loose) + 0.5, "{} {}", mean(&strict), mean(&loose));
    for (count, lobes) in [("auto:10", &loose), ("auto:1", &strict)] {
        assert_sound(lobes);
        // Slots keep their meaning: blended, they err less than half of what slots in any order do.
        let error = |lobes: &LobePyramid| coherence::measure(lobes, 2).expect("fitted").interpolation_error;
        let (aligned, own) = (error(lobes), error(&fitted(&map, &settings(count, Alignment::None))));
        assert!(aligned < 0.5 * own, "{count}: {aligned} {own}");
    }
}

#[test]
fn the_information_criterion_finds_the_five_faces_of_the_pyramids() {
    let map = Arc::new(procedural::find("pyramid5").expect("bundled").make(128));
    let lobes = fitted(&map, &settings("bic", Alignment::None));
    let top = lobes.level(lobes.levels() - 1).expect("fitted");
    assert!((4..=6).contains(&used(top.texel(0, 0))), "{}", used(top.texel(0, 0)));
}

#[test]
fn chosen_numbers_of_lobes_survive_hostile_maps() {
    for normal in HOSTILE {
        let map = map_of(16, 16, Addressing::Wrap, |x, y| normal(y * 16 + x));
        for count in ["auto", "bic"] {
            for align in [Alignment::None, Alignment::default(), Alignment::Map { c: 1.0 }] {
                assert_sound(&fitted(&map, &settings(count, align)));
            }
        }
    }
}

#[test]
fn one_thread_and_many_choose_the_same() {
    let map = Arc::new(procedural::find("flakes").expect("bundled").make(40));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| fitted(&map, &settings("auto", Alignment::default())))
    };
    assert_eq!(run(1).coarse, run(3).coarse);
}
