//! Times the fit, every texel of every level, J = 6:
//!
//! - the plain work (512 x 512, objective `em`, unaligned, ten iterations) beside a plain scalar version of the same
//!   loop, pair by pair in one run;
//! - what a user waits for (objective `appearance`, aligned `smooth`) beside the plain work;
//! - the aligned fit from 256 x 256 to 4096 x 4096: time, time per pixel and level, memory.
//!
//! All use every core.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use criterion::Criterion;
use glam::{DVec3, Vec3};
use ndf_inspector::filter::vmf::fit::{expected_visits, fit};
use ndf_inspector::filter::vmf::{Alignment, FitSettings, Monitor, Objective, seed};
use ndf_inspector::normal_map::pyramid::Footprint;
use ndf_inspector::normal_map::{NormalMap, procedural};
use ndf_inspector::sphere::vmf::{self, KAPPA_MAX};
use rayon::prelude::*;

const LOBES: usize = 6;
const ITERATIONS: usize = 10;
const PAIRS: usize = 7;

/// The plain work: ten iterations from the usual seeds, whatever they gain.
fn plain() -> FitSettings {
    FitSettings {
        lobes: LOBES,
        objective: Objective::Em,
        align: Alignment::None,
        iterations: ITERATIONS,
        tolerance: f64::NEG_INFINITY,
        ..FitSettings::default()
    }
}

/// An aligned fit as a user asks for it.
fn aligned(objective: Objective) -> FitSettings {
    FitSettings { lobes: LOBES, objective, align: Alignment::default(), ..FitSettings::default() }
}

/// Fits; returns the most memory in use, in bytes, as far as it is known.
fn engine(map: &Arc<NormalMap>, settings: &FitSettings) -> usize {
    let monitor = Monitor::new(expected_visits(map, settings));
    let mut most = 0;
    let mut look = |_| most = most.max(memory_stats::memory_stats().map_or(0, |memory| memory.physical_mem));
    black_box(fit(map, settings, &monitor, &mut look)).expect("nobody cancels");
    most
}

/// The same work as one would write it down: one normal after the other, the library's exponential.
fn scalar(map: &NormalMap) {
    for &(width, height) in &map.level_sizes()[1..] {
        (0..width * height).into_par_iter().for_each(|index| {
            let footprint = Footprint::new((map.width, map.height), (width, height), (index % width, index / width));
            let normals: Vec<Vec3> = footprint.texels().filter_map(|(x, y, _)| map.normal(y * map.width + x)).collect();
            let (centres, count) = seed::farthest_normals(map, &footprint, LOBES);
            black_box(scalar_em(&normals, &centres[..count]));
        });
    }
}

fn scalar_em(normals: &[Vec3], centres: &[Vec3]) -> Vec<(f32, Vec3, f32)> {
    let mut lobes: Vec<(f32, Vec3, f32)> = centres.iter().map(|&mu| (1.0 / centres.len() as f32, mu, 20.0)).collect();
    for _ in 0..ITERATIONS {
        let mut sums = vec![(0.0_f64, DVec3::ZERO); lobes.len()];
        let scale: Vec<f32> =
            lobes.iter().map(|&(alpha, _, kappa)| alpha.ln() + vmf::log_peak(f64::from(kappa)) as f32).collect();
        for &normal in normals {
            let log_density = |j: usize| scale[j] - 0.5 * lobes[j].2 * normal.distance_squared(lobes[j].1);
            let max = (0..lobes.len()).map(log_density).fold(f32::NEG_INFINITY, f32::max);
            let density: Vec<f32> = (0..lobes.len()).map(|j| (log_density(j) - max).exp()).collect();
            let total: f32 = density.iter().sum();
            for (sum, value) in sums.iter_mut().zip(&density) {
                let share = f64::from(value / total);
                sum.0 += share;
                sum.1 += share * normal.as_dvec3();
            }
        }
        for (lobe, (weight, sum)) in lobes.iter_mut().zip(sums).filter(|(_, sum)| sum.0 > 1e-9) {
            let resultant = sum / weight;
            let kappa = vmf::concentration(1.0 - resultant.length()).min(KAPPA_MAX);
            *lobe = ((weight / normals.len() as f64) as f32, resultant.normalize_or_zero().as_vec3(), kappa as f32);
        }
    }
    lobes
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn waves(size: usize) -> Arc<NormalMap> {
    Arc::new(procedural::find("waves").expect("bundled").make(size))
}

/// Prints the ratio of two works, pair by pair.
fn compare(names: [&str; 2], first: impl Fn(), second: impl Fn()) {
    let pairs = (0..PAIRS).map(|_| seconds(&first) / seconds(&second)).collect();
    println!("{} : {} = {:.3} (median of {PAIRS} pairs)", names[0], names[1], median(pairs));
}

/// Prints how the aligned fit grows with the map.
fn print_growth(objective: Objective) {
    println!("{objective}, smooth       seconds   ns per pixel and level   MiB");
    for size in [256, 512, 1024, 2048, 4096] {
        let map = waves(size);
        let mut memory = 0;
        let seconds = seconds(|| memory = engine(&map, &aligned(objective)));
        let work = (map.len() * map.level_sizes().len()) as f64;
        println!("{size:5} x {size:<5} {seconds:13.3} {:24.1} {:5}", seconds / work * 1e9, memory >> 20);
    }
}

fn main() {
    let map = waves(512);
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(4))
        .without_plots()
        .configure_from_args();
    let plain_work = || {
        black_box(engine(&map, &plain()));
    };
    let scalar_work = || scalar(&map);
    let usual_work = || {
        black_box(engine(&map, &aligned(Objective::APPEARANCE)));
    };
    criterion.bench_function("plain work", |bencher| bencher.iter(plain_work));
    criterion.bench_function("plain scalar loop", |bencher| bencher.iter(scalar_work));
    criterion.bench_function("appearance, smooth", |bencher| bencher.iter(usual_work));
    compare(["plain work", "plain scalar loop"], plain_work, scalar_work);
    compare(["appearance, smooth", "plain work"], usual_work, plain_work);
    print_growth(Objective::Em);
    criterion.final_summary();
}
