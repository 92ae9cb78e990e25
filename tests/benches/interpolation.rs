//! Prints what every alignment is worth: the error half way between texel centres at s = 64, J = 6, as a multiple of
//! what shading the texels around without alignment errs, and the curve over C. Maps: those named on the command line,
//! else the bundled ones. `cargo bench --bench interpolation -- [--curve]
//! [--objective=NAME] [MAP…]`

use std::path::Path;
use std::sync::Arc;

use ndf_inspector::filter::vmf::coherence::{Between, Blend, Interpolation};
use ndf_inspector::filter::vmf::fit::{expected_visits, fit};
use ndf_inspector::filter::vmf::objective::Objective;
use ndf_inspector::filter::vmf::{Alignment, FitSettings, LobePyramid, Monitor};
use ndf_inspector::normal_map::{MapOptions, NormalMap, procedural};
use ndf_inspector::session::{MapRequest, opening};

const SIZE: usize = 256;
const LEVELS: std::ops::RangeInclusive<usize> = 2..=6;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let curve = arguments.iter().any(|argument| argument == "--curve");
    let objective = arguments.iter().find_map(|argument| argument.strip_prefix("--objective=")?.parse().ok());
    let objective = objective.unwrap_or_default();
    let named: Vec<&String> = arguments.iter().filter(|argument| !argument.starts_with("--")).collect();
    let maps: Vec<(String, Arc<NormalMap>)> = if named.is_empty() {
        ["bricks", "waves", "scales", "flakes", "plate", "pyramid5"].map(|name| (name.to_owned(), bundled(name))).into()
    } else {
        named.into_iter().map(|name| (short(name), read(name))).collect()
    };
    let forms: Vec<Alignment> = if curve {
        let strengths = [0.0, 0.03, 0.1, 0.3, 1.0, 2.0, 4.0, 8.0];
        let paper = strengths.map(|c| Alignment::Paper { c });
        paper.into_iter().chain(strengths.map(|c| Alignment::Map { c })).collect()
    } else {
        ["smooth", "map:1", "paper:2", "none"].iter().filter_map(|text| text.parse().ok()).collect()
    };
    for between in [Between::Texels, Between::Levels] {
        print_table(&maps, &forms, objective, between);
    }
}

fn print_table(maps: &[(String, Arc<NormalMap>)], forms: &[Alignment], objective: Objective, between: Between) {
    println!("\n{between:?}: error of unaligned shading, then each form's error and its multiple of that");
    print!("{:<12} {:>9}", "map", "unaligned");
    for form in forms {
        print!(" {:>16}", form.to_string());
    }
    println!();
    let mut sums = vec![0.0; forms.len() + 1];
    for (name, map) in maps {
        let points: Vec<Interpolation> = LEVELS.map(|level| Interpolation::new(map, level, between)).collect();
        let error = |lobes: &LobePyramid, blend| {
            points.iter().map(|points| points.error(lobes, blend)).sum::<f64>() / points.len() as f64
        };
        let unaligned = error(&fitted(map, Alignment::None, objective), Blend::Brdfs);
        sums[0] += unaligned;
        print!("{name:<12} {unaligned:>9.4}");
        for (form, sum) in forms.iter().zip(&mut sums[1..]) {
            let value = error(&fitted(map, *form, objective), Blend::Lobes);
            *sum += value;
            print!(" {value:>8.4} {:>6.2}x", value / unaligned);
        }
        println!();
    }
    let count = maps.len() as f64;
    print!("{:<12} {:>9.4}", "mean", sums[0] / count);
    for sum in &sums[1..] {
        print!(" {:>8.4} {:>6.2}x", sum / count, sum / sums[0]);
    }
    println!();
}

fn fitted(map: &Arc<NormalMap>, align: Alignment, objective: Objective) -> LobePyramid {
    let settings = FitSettings { align, objective, lobes: 6, ..FitSettings::default() };
    let monitor = Monitor::new(expected_visits(map, &settings));
    fit(map, &settings, &monitor, &mut |_| {}).expect("nobody cancels")
}

fn bundled(name: &str) -> Arc<NormalMap> {
    Arc::new(procedural::find(name).expect("bundled").make(SIZE))
}

fn read(path: &str) -> Arc<NormalMap> {
    let request = MapRequest::File { path: path.into(), options: MapOptions::default() };
    opening::read(&request).expect("readable").map
}

fn short(path: &str) -> String {
    Path::new(path).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}
