//! A binary of its own because a global allocator that counts would count every other test's allocations too, and
//! there can be one law in it only: tests side by side would count each other's.

use std::alloc::System;
use std::sync::Arc;

use ndf_inspector::filter::vmf::em::{self, Stop, TexelLobes};
use ndf_inspector::filter::vmf::samples::FootprintSamples;
use ndf_inspector::filter::vmf::{FitSettings, LobePyramid, Monitor, seed, smooth, unaligned};
use ndf_inspector::normal_map::NormalMap;
use ndf_inspector::normal_map::procedural;
use ndf_inspector::normal_map::pyramid::Footprint;
use ndf_inspector::sphere::vmf::KappaRule;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations while `work` runs.
fn allocations(work: impl FnOnce()) -> usize {
    let region = Region::new(ALLOCATOR);
    work();
    let change = region.change();
    change.allocations + change.reallocations
}

/// As many iterations as asked for.
fn stop(iterations: usize) -> Stop {
    Stop { iterations, tolerance: f64::NEG_INFINITY }
}

/// Allocations of `iterations` EM iterations over the whole map.
fn of_em(map: &NormalMap, lobes: TexelLobes, iterations: usize) -> usize {
    let samples = FootprintSamples::new(map, Footprint::new((map.width, map.height), (1, 1), (0, 0)));
    allocations(|| {
        let fit = em::fit(&samples, lobes, stop(iterations), KappaRule::Exact, |_| true);
        assert_eq!(fit.iterations, iterations);
    })
}

/// Allocations of an aligned fit of level 1 by so many passes.
fn of_alignment(lobes: &LobePyramid, passes: usize) -> usize {
    let settings = FitSettings { lobes: 3, iterations: passes, ..FitSettings::default() };
    let monitor = Monitor::new(vec![1; lobes.levels()]);
    allocations(|| {
        smooth::fit_level(lobes, 1, 0.15, &settings, &monitor).expect("nobody cancels");
    })
}

fn seeded(map: &NormalMap, slots: usize) -> TexelLobes {
    let footprint = Footprint::new((map.width, map.height), (1, 1), (0, 0));
    let (centres, count) = seed::farthest_normals(map, &footprint, slots);
    seed::assign(&FootprintSamples::new(map, footprint), &centres[..count], slots)
}

/// Levels 1 and 2 of the unaligned fit.
fn two_levels(map: &Arc<NormalMap>) -> LobePyramid {
    let settings = FitSettings { lobes: 3, iterations: 2, ..FitSettings::default() };
    let mut lobes = LobePyramid::unfitted(Arc::clone(map));
    let monitor = Monitor::new(vec![1; lobes.levels()]);
    for level in 1..3 {
        let (mixtures, _) = unaligned::fit_level(&lobes, level, &settings, &monitor).expect("nobody cancels");
        lobes.coarse[level - 1] = Some(Arc::new(mixtures));
    }
    lobes
}

#[test]
fn iterations_allocate_nothing() {
    let sample = procedural::find("plate").expect("a bundled map");
    // One chunk of normals on one thread, and many chunks shared by two.
    let maps = [32, 256].map(|size| Arc::new(sample.make(size)));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    // Every thread is up and has its scratch memory before anything is counted.
    pool.broadcast(|_| of_em(&maps[0], seeded(&maps[0], 6), 1));
    pool.install(|| {
        for map in &maps {
            let lobes = seeded(map, 6);
            // The first run makes each thread's scratch memory; the queues may grow until they are long enough.
            of_em(map, lobes, 50);
            assert_eq!(of_em(map, lobes, 50), 0, "{} x {}", map.width, map.height);
        }
        let lobes = two_levels(&maps[1]);
        of_alignment(&lobes, 20);
        let (few, many) = (of_alignment(&lobes, 2), of_alignment(&lobes, 20));
        assert_eq!(few, many, "passes of the alignment");
    });
}
