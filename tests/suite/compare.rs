//! `compare`: names, schema, exit status, and figures that must be zero.

use serde_json::Value;
use tempfile::TempDir;

use super::cli::{assert_refused, folder, json, run, sample};

/// Runs the command on small pictures, with its figures as JSON.
fn compare(folder: &TempDir, arguments: &[&str]) -> Value {
    let small = ["compare", "--size", "64x40", "--json", "-"];
    json(&run(folder, &[&small[..], arguments].concat()))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn flat(folder: &TempDir) {
    let image = image::RgbImage::from_pixel(16, 16, image::Rgb([140, 120, 250]));
    image.save(folder.path().join("flat.png")).expect("saved");
}

#[test]
fn compare_prints_the_agreed_json() {
    let folder = folder();
    sample(&folder, "scales");
    let report = compare(&folder, &["scales.png", "-J", "2", "--distances", "6"]);
    assert_eq!(report["schema"], 1);
    assert_eq!(report["reference"]["samples_per_pixel"], 1024);
    let standard_error = number(&report["reference"]["standard_error"]);
    assert!(standard_error > 0.0 && standard_error < 0.01, "{standard_error}");
    let methods = report["methods"].as_array().expect("methods");
    let names: Vec<&str> = methods.iter().filter_map(|found| found["method"].as_str()).collect();
    let expected = ["mip", "mip-unnormalised", "toksvig", "lean", "gmm:4", "sh:7", "vmf:2", "vmf:2:unaligned"];
    assert_eq!(names, expected);
    for found in methods {
        for key in ["normalised_color_error", "rmse", "flip", "milliseconds", "bytes_per_texel"] {
            assert!(number(&found[key]) > 0.0, "{key} of {found}");
        }
        assert!(number(&found["flip"]) < 1.0);
    }
    assert_eq!(report["cells"][0]["methods"], report["methods"], "of one cell, the means are its figures");
    assert_eq!(report["cells"][0]["map"], "scales.png");
}

#[test]
fn the_truth_is_nothing_off_itself() {
    let folder = folder();
    sample(&folder, "waves");
    let report = compare(&folder, &["waves.png", "--methods", "truth", "--samples", "64"]);
    for key in ["normalised_color_error", "rmse", "flip"] {
        assert_eq!(number(&report["methods"][0][key]), 0.0, "{key}");
    }
}

#[test]
fn every_method_of_a_flat_map_is_the_truth_as_far_as_its_reflectance_model_goes() {
    let folder = folder();
    flat(&folder);
    let methods = "mip,mip-unnormalised,toksvig,vmf:6,vmf:6:unaligned,lean,gmm:4,sh:7";
    let report = compare(&folder, &["flat.png", "--methods", methods, "--samples", "64", "--exponents", "16"]);
    assert!(number(&report["reference"]["standard_error"]) < 1e-5);
    for found in report["methods"].as_array().expect("methods") {
        let least = match found["method"].as_str().expect("a name") {
            // Gaussians in place of the power of a cosine: of slopes, and of the plane.
            "lean" => 0.02,
            "gmm:4" => 0.03,
            // Exponent 16 has bands beyond 7.
            "sh:7" => 0.06,
            // Half floats on adapters that filter no others: 1e-3 of a normal.
            _ => 2e-3,
        };
        assert!(number(&found["normalised_color_error"]) < least, "{found}");
    }
}

#[test]
fn every_cell_of_a_folder_its_distances_and_exponents_has_its_figures() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("maps")).expect("created");
    std::fs::write(folder.path().join("maps/notes.txt"), "no map").expect("written");
    for name in ["scales", "waves"] {
        let file = format!("maps/{name}.png");
        assert!(run(&folder, &["sample", name, "-o", &file, "--size", "32"]).status.success());
    }
    let more = ["--methods", "toksvig,vmf:2", "--distances", "3,9", "--exponents", "20,80", "--samples", "32"];
    let files = ["--csv", "t.csv", "--sheet", "s.png"];
    let report = compare(&folder, &[&["maps"], &more[..], &files[..]].concat());
    let cells = report["cells"].as_array().expect("cells");
    let is_at = |cell: &Value, map: &str, distance: f64, exponent: f64| {
        cell["map"].as_str().is_some_and(|name| name.ends_with(map))
            && (number(&cell["distance"]), number(&cell["exponent"])) == (distance, exponent)
    };
    assert_eq!(cells.len(), 8);
    for (map, distance) in [("scales.png", 3.0), ("scales.png", 9.0), ("waves.png", 3.0), ("waves.png", 9.0)] {
        assert!([20.0, 80.0].into_iter().all(|s| cells.iter().any(|cell| is_at(cell, map, distance, s))), "{report}");
    }
    let errors = cells.iter().map(|cell| number(&cell["methods"][1]["normalised_color_error"]));
    let mean = errors.sum::<f64>() / 8.0;
    assert!((number(&report["methods"][1]["normalised_color_error"]) - mean).abs() < 1e-12);
    let csv = std::fs::read_to_string(folder.path().join("t.csv")).expect("written");
    assert_eq!(csv.lines().count(), 1 + 8 * 2);
    assert!(csv.starts_with("map,distance,exponent,method,normalised_color_error,rmse,flip,"));
    assert!(csv.lines().all(|line| line.split(',').count() == 14), "{csv}");
    let sheet = image::open(folder.path().join("s.png")).expect("a PNG").to_rgb8();
    assert!(sheet.width() >= 3 * 64 && sheet.height() >= 8 * 40, "{} x {}", sheet.width(), sheet.height());
    let colors: std::collections::HashSet<_> = sheet.pixels().collect();
    assert!(colors.len() > 100, "pictures and letters");
}

#[test]
fn every_model_of_every_width_and_every_material_by_name_has_its_cells() {
    let folder = folder();
    flat(&folder);
    let more = ["--methods", "mip", "--samples", "2", "--exponents", "8,128", "--csv", "t.csv"];
    let models = ["--models", "blinn-phong,torrance-sparrow,ggx", "--brdfs", "torrance-sparrow:0.05,ggx:0.2"];
    let report = compare(&folder, &[&["flat.png"], &more[..], &models[..]].concat());
    let cells = report["cells"].as_array().expect("cells");
    let names: Vec<&str> = cells.iter().filter_map(|cell| cell["brdf"].as_str()).collect();
    assert_eq!(names.len(), 8);
    assert_eq!((names[0], names[1], names[3]), ("blinn-phong:8", "torrance-sparrow:0.25", "blinn-phong:128"));
    assert_eq!(names[6..], ["torrance-sparrow:0.05", "ggx:0.2"]);
    assert!(names[2].starts_with("ggx:0.52") && names[5].starts_with("ggx:0.15"), "{names:?}");
    for (cell, exponent) in cells.iter().zip([8.0, 8.0, 8.0, 128.0, 128.0, 128.0, 200.0]) {
        assert!((number(&cell["exponent"]) / exponent - 1.0).abs() < 1e-4, "{cell}");
    }
    let csv = std::fs::read_to_string(folder.path().join("t.csv")).expect("written");
    assert!(csv.lines().nth(2).is_some_and(|line| line.ends_with(",torrance-sparrow:0.25")), "{csv}");
    let text = run(&folder, &[&["compare", "flat.png", "--size", "32x32"], &more[..6], &models[..2]].concat());
    let text = String::from_utf8_lossy(&text.stdout);
    assert!(text.contains("mean colour error by material") && text.contains("\ntorrance-sparrow:0.25 "), "{text}");
    for wrong in [["--models", "ggx"], ["--brdfs", "ggx:2"]] {
        assert_eq!(run(&folder, &[&["compare", "flat.png"], &wrong[..]].concat()).status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn one_map_is_a_table_without_means() {
    let folder = folder();
    flat(&folder);
    let output = run(&folder, &["compare", "flat.png", "--methods", "mip", "--size", "32x32", "--samples", "2"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success());
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(!error.contains("comparing") && !error.contains("fitting"), "no bar in a pipe: {error}");
    assert!(text.contains("standard error") && text.contains("\nmip ") && !text.contains("mean over"), "{text}");
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_sentence() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("empty")).expect("created");
    assert_refused(&run(&folder, &["compare", "missing.png"]), "missing.png");
    assert_refused(&run(&folder, &["compare", "empty"]), "empty");
    assert_refused(&run(&folder, &["compare", "waves", "--methods", "sh:22"]), "sh:22");
    for wrong in [["--distances", "0"], ["--exponents", "0.5"], ["--methods", "magic"], ["--samples", "1"]] {
        let output = run(&folder, &[&["compare", "waves"], &wrong[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
    }
}
