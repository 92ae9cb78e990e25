//! What each objective's lobes look like when shaded, and what they cost: mean relative L2 error of the effective
//! Blinn-Phong against the truth, J = 6, unaligned, over texels of levels 2 to 7 and directions spread evenly over the
//! hemisphere; then the time of a 512x512 map beside ten iterations of plain EM. Maps are named on the command line;
//! without any, five bundled ones are measured.

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use glam::DVec3;
use ndf_inspector::brdf::{BlinnPhong, Brdf, ConvolutionRule};
use ndf_inspector::filter::brdf_error::RelativeL2;
use ndf_inspector::filter::vmf::fit::{expected_visits, fit};
use ndf_inspector::filter::vmf::{Alignment, FitSettings, LobePyramid, Monitor, Objective, effective_brdf};
use ndf_inspector::ndf::Ndf;
use ndf_inspector::normal_map::pyramid::Texel;
use ndf_inspector::normal_map::{MapOptions, NormalMap, procedural};
use ndf_inspector::session::{MapRequest, opening};
use ndf_inspector::sphere::direction::hemisphere;
use rayon::prelude::*;

const LOBES: usize = 6;
const LEVELS: std::ops::RangeInclusive<usize> = 2..=7;
const TEXELS: usize = 16;
const DIRECTIONS: usize = 512;
const MATERIALS: [f64; 3] = [10.0, 64.0, 400.0];
const PAIRS: usize = 5;

fn settings(objective: Objective) -> FitSettings {
    FitSettings { lobes: LOBES, align: Alignment::None, objective, ..FitSettings::default() }
}

fn fitted(map: &Arc<NormalMap>, settings: &FitSettings) -> LobePyramid {
    let monitor = Monitor::new(expected_visits(map, settings));
    fit(map, settings, &monitor, &mut |_| {}).expect("nobody cancels")
}

fn maps() -> Vec<(String, Arc<NormalMap>)> {
    let files: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let bundled = ["bricks", "waves", "flakes", "plate", "scales"];
    let read = |name: &String| {
        let request = MapRequest::File { path: Path::new(name).to_owned(), options: MapOptions::default() };
        opening::read(&request).expect("a map").map
    };
    let made = |name: &str| Arc::new(procedural::find(name).expect("bundled").make(256));
    let from_files = files.iter().map(|name| (name.clone(), read(name)));
    let count = if files.is_empty() { 5 } else { 3 };
    from_files.chain(bundled[..count].iter().map(|&name| (name.to_owned(), made(name)))).collect()
}

/// Texels at random, the same in every run.
fn texels(map: &NormalMap, level: usize) -> Vec<Texel> {
    let (width, height) = map.level_sizes()[level];
    let mut state = 0x9e37_79b9_u32.wrapping_add(level as u32);
    let mut random = |below: usize| {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as usize % below
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| Texel { level, x, y }));
    if width * height <= TEXELS {
        return all.collect();
    }
    (0..TEXELS).map(|_| Texel { level, x: random(width), y: random(height) }).collect()
}

type Errors = [f64; MATERIALS.len()];

/// Relative L2 errors of one texel.
fn errors(
    truth: &[Vec<f64>],
    lobes: &LobePyramid,
    texel: Texel,
    directions: &[DVec3],
    rule: ConvolutionRule,
) -> Errors {
    let mixture = lobes.mixture(texel).expect("fitted");
    std::array::from_fn(|material| {
        let brdf = Brdf::BlinnPhong(BlinnPhong { shininess: MATERIALS[material] });
        let values = directions.iter().map(|&omega| effective_brdf(&mixture, brdf, omega, rule));
        RelativeL2::of(values.zip(truth[material].iter().copied()))
    })
}

fn truth(map: &NormalMap, texel: Texel, directions: &[DVec3]) -> Vec<Vec<f64>> {
    let ndf = Ndf::of_texel(map, texel);
    let of = |&shininess: &f64| {
        let brdf = Brdf::BlinnPhong(BlinnPhong { shininess });
        directions.par_iter().map(|&omega| ndf.effective_brdf(brdf, omega)).collect()
    };
    MATERIALS.iter().map(of).collect()
}

fn mean(errors: &[Errors]) -> Errors {
    std::array::from_fn(|material| errors.iter().map(|e| e[material]).sum::<f64>() / errors.len() as f64)
}

fn text(errors: Errors) -> String {
    errors.map(|error| format!("{error:.4}")).join(" ")
}

fn objectives() -> Vec<(&'static str, Objective, ConvolutionRule)> {
    let rule = ConvolutionRule::default();
    vec![
        ("em, eq. 20", Objective::Em, ConvolutionRule::Paper),
        ("em", Objective::Em, rule),
        ("appearance:0", Objective::Appearance { steps: 0 }, rule),
        ("appearance:1", Objective::Appearance { steps: 1 }, rule),
        ("appearance", Objective::APPEARANCE, rule),
        ("appearance:10", Objective::Appearance { steps: 10 }, rule),
        ("likelihood", Objective::Likelihood, rule),
    ]
}

fn print_errors() {
    let directions: Vec<DVec3> = hemisphere(DIRECTIONS).collect();
    let maps = maps();
    let truths: Vec<Vec<(Texel, Vec<Vec<f64>>)>> = maps
        .iter()
        .map(|(_, map)| LEVELS.flat_map(|level| texels(map, level)).map(|t| (t, truth(map, t, &directions))).collect())
        .collect();
    println!("relative L2 error at s = 10, 64, 400; J = {LOBES}");
    for (name, objective, rule) in objectives() {
        let mut all = Vec::new();
        let mut by_level = vec![Vec::new(); LEVELS.end() + 1];
        let mut by_map = Vec::new();
        for ((_, map), truths) in maps.iter().zip(&truths) {
            let lobes = fitted(map, &settings(objective));
            let found: Vec<(usize, Errors)> =
                truths.iter().map(|(t, exact)| (t.level, errors(exact, &lobes, *t, &directions, rule))).collect();
            for &(level, errors) in &found {
                by_level[level].push(errors);
            }
            let found: Vec<Errors> = found.into_iter().map(|(_, errors)| errors).collect();
            by_map.push(mean(&found));
            all.extend(found);
        }
        println!("{name:14} {}", text(mean(&all)));
        if std::env::args().any(|argument| argument == "--detail") {
            LEVELS.for_each(|level| println!("    level {level}    {}", text(mean(&by_level[level]))));
            maps.iter().zip(by_map).for_each(|((map, _), errors)| println!("    {} {map}", text(errors)));
        }
    }
}

fn print_times() {
    let map = Arc::new(procedural::find("bricks").expect("bundled").make(512));
    let plain = FitSettings { iterations: 10, tolerance: f64::NEG_INFINITY, ..settings(Objective::Em) };
    let seconds = |settings: &FitSettings| {
        let start = Instant::now();
        black_box(fitted(&map, settings));
        start.elapsed().as_secs_f64()
    };
    println!("seconds for 512 x 512, J = {LOBES}, and the ratio to ten plain iterations (medians of {PAIRS} pairs)");
    for (name, objective, _) in objectives().into_iter().skip(1) {
        let pairs: Vec<(f64, f64)> = (0..PAIRS).map(|_| (seconds(&settings(objective)), seconds(&plain))).collect();
        let median = |value: &dyn Fn(&(f64, f64)) -> f64| {
            let mut values: Vec<f64> = pairs.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            values[PAIRS / 2]
        };
        println!("{name:14} {:.3} {:.2}", median(&|pair| pair.0), median(&|pair| pair.0 / pair.1));
    }
}

fn main() {
    if !std::env::args().any(|argument| argument == "--times") {
        print_errors();
    }
    print_times();
}
