//! Times the fit of a 512x512 map, J = 6, ten iterations, every texel of every level, beside a plain scalar version of
//! the same loop, and prints the ratio of the two, pair by pair in one run. Both use every core.

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

/// The engine's fit, unaligned.
fn engine(map: &Arc<NormalMap>, align: Alignment) {
    let settings = FitSettings {
        lobes: LOBES,
        objective: Objective::Em,
        align,
        iterations: ITERATIONS,
        tolerance: f64::NEG_INFINITY,
        ..Default::default()
    };
    let monitor = Monitor::new(expected_visits(map, &settings));
    black_box(fit(map, &settings, &monitor, &mut |_| {})).expect("nobody cancels");
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

fn main() {
    let map = Arc::new(procedural::find("waves").expect("bundled").make(512));
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(4))
        .without_plots()
        .configure_from_args();
    criterion.bench_function("engine, unaligned", |bencher| bencher.iter(|| engine(&map, Alignment::None)));
    criterion.bench_function("engine, smooth", |bencher| bencher.iter(|| engine(&map, Alignment::default())));
    criterion.bench_function("plain scalar loop", |bencher| bencher.iter(|| scalar(&map)));
    let ratios = |align: Alignment| {
        let pair = |_| seconds(|| engine(&map, align)) / seconds(|| scalar(&map));
        median((0..PAIRS).map(pair).collect())
    };
    println!("engine, unaligned : plain scalar loop = {:.3} (median of {PAIRS} pairs)", ratios(Alignment::None));
    println!("engine, smooth    : plain scalar loop = {:.3} (median of {PAIRS} pairs)", ratios(Alignment::default()));
    criterion.final_summary();
}
