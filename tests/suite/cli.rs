//! The command line as others script against it.

use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// Runs the program in an empty folder.
pub fn run(folder: &TempDir, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ndf-inspector"))
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .expect("the program starts")
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

/// Writes a bundled map of 64 x 64 texels as `NAME.png`.
pub fn sample(folder: &TempDir, name: &str) {
    let file = format!("{name}.png");
    assert!(run(folder, &["sample", name, "-o", &file, "--size", "64"]).status.success());
}

pub fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON on standard output")
}

/// One line on standard error that names the file, exit status 1, within seconds even where tests share the cores.
pub fn assert_refused(output: &Output, names: &str) {
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert_eq!(error.trim_end().lines().count(), 1, "{error}");
    assert!(error.contains(names) && !error.contains("panicked"), "{error}");
}

#[test]
fn fit_prints_the_agreed_json() {
    let folder = folder();
    let report = json(&run(
        &folder,
        &["fit", "bricks", "-J", "3", "--align", "none", "--texel", "9,0,0", "--texel", "0,5,7", "--json", "-"],
    ));
    assert_eq!(report["schema"], 1);
    assert_eq!(report["map"]["width"], 512);
    assert_eq!(report["map"]["levels"], 10);
    assert_eq!(report["settings"]["lobes"], 3);
    assert_eq!(report["settings"]["align"], "none");
    assert_eq!(report["settings"]["kappa"], "exact");
    assert_eq!(report["levels"].as_array().map(Vec::len), Some(9), "every level that is fitted");
    let top = &report["texels"][0];
    assert_eq!((&top["level"], &top["samples"]), (&Value::from(9), &Value::from(512 * 512)));
    let lobes = top["lobes"].as_array().expect("lobes");
    let alpha: f64 = lobes.iter().filter_map(|lobe| lobe["alpha"].as_f64()).sum();
    assert!(lobes.len() <= 3 && (alpha - 1.0).abs() < 1e-5);
    let base = report["texels"][1]["lobes"].as_array().expect("lobes");
    assert!(base.len() == 1 && (base[0]["alpha"].as_f64().expect("alpha") - 1.0).abs() < 1e-6);
}

#[test]
fn a_sample_opens_as_the_bundled_map_of_that_name() {
    let folder = folder();
    assert!(run(&folder, &["sample", "bricks", "-o", "b.png", "--size", "64"]).status.success());
    assert!(folder.path().join("b.png").exists());
    let listed = run(&folder, &["sample", "--list"]);
    assert!(String::from_utf8_lossy(&listed.stdout).lines().count() >= 6);
    let report = json(&run(&folder, &["fit", "b.png", "-J", "1", "--json", "-"]));
    assert_eq!(report["map"]["width"], 64);
}

#[test]
fn bad_input_gets_one_sentence_that_names_it_and_exit_status_1() {
    let folder = folder();
    let file = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).expect("written");
    file("empty.png", b"");
    file("text.png", b"this is no picture");
    std::fs::create_dir(folder.path().join("folder.png")).expect("made");
    image::GrayImage::from_fn(8, 8, |x, y| image::Luma([(x * y) as u8 + 1]))
        .save(folder.path().join("grey.png"))
        .expect("saved");
    image::RgbImage::new(8, 8).save(folder.path().join("black.png")).expect("saved");
    for name in ["missing.png", "empty.png", "text.png", "folder.png", "grey.png", "black.png"] {
        let start = Instant::now();
        assert_refused(&run(&folder, &["fit", name]), name);
        assert!(start.elapsed() < Duration::from_secs(20), "{name} took {:?}", start.elapsed());
    }
    assert!(String::from_utf8_lossy(&run(&folder, &["fit", "grey.png"]).stderr).contains("--height"));
    assert_refused(&run(&folder, &["fit", "bricks", "--texel", "3,999,0"]), "3,999,0");
    assert_refused(&run(&folder, &["sample", "nothing", "-o", "n.png"]), "nothing");
    assert_refused(&run(&folder, &["render", "--session", "text.png", "-o", "r.png"]), "text.png");
}

#[test]
fn wrong_usage_ends_with_exit_status_2() {
    let folder = folder();
    let wrong: [&[&str]; 6] = [
        &["fit"],
        &["fit", "bricks", "-J", "17"],
        &["fit", "bricks", "--align", "sideways"],
        &["probe", "bricks", "--method", "magic", "--texel", "1,0,0", "--omega", "0,0,1"],
        &["fit", "bricks", "--texel", "1,2"],
        &["probe", "bricks", "--method", "sh:23", "--texel", "1,0,0", "--omega", "0,0,1"],
    ];
    for arguments in wrong {
        assert_eq!(run(&folder, arguments).status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn an_unwritable_target_leaves_the_old_file_whole() {
    let folder = folder();
    let target = folder.path().join("taken.json");
    std::fs::create_dir(&target).expect("made");
    let output = run(&folder, &["fit", "v-groove", "-J", "1", "--json", "taken.json"]);
    assert_refused(&output, "taken.json");
    assert!(Path::new(&target).is_dir());
}

#[test]
fn render_gives_the_same_bytes_twice_and_a_picture_that_is_not_flat() {
    let folder = folder();
    sample(&folder, "waves");
    for name in ["a.png", "b.png"] {
        let arguments = [
            "render",
            "waves.png",
            "--size",
            "96x64",
            "--samples",
            "64",
            "--left",
            "truth",
            "--right",
            "vmf:2",
            "-o",
            name,
        ];
        let output = run(&folder, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("written");
    assert_eq!(bytes("a.png"), bytes("b.png"));
    let picture = image::open(folder.path().join("a.png")).expect("a picture").to_rgb8();
    let (least, most) = picture.pixels().fold((255, 0), |(l, m), p| (p[1].min(l), p[1].max(m)));
    assert!(most > 120 && least < 60, "green runs from {least} to {most}");
}

#[test]
fn a_grid_shows_the_methods_that_it_is_given() {
    let folder = folder();
    let render = |name: &str, more: &[&str]| {
        let arguments = [&["render", "v-groove", "--size", "64x48", "--samples", "16", "-o", name], more].concat();
        let output = run(&folder, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        image::open(folder.path().join(name)).expect("a picture").to_rgb8()
    };
    let grid = render("grid.png", &["--methods", "mip,toksvig,truth,vmf:1"]);
    assert_eq!(grid, render("same.png", &["--view", "grid-2x2", "--methods", "mip,toksvig,truth,vmf:1"]));
    let other = render("other.png", &["--methods", "mip,toksvig,truth,mip"]);
    let differ = |right: bool, low: bool| {
        let inside = |x, y| (x >= 32) == right && (y >= 24) == low;
        grid.enumerate_pixels().any(|(x, y, pixel)| inside(x, y) && other.get_pixel(x, y) != pixel)
    };
    assert!(differ(true, true) && !differ(false, false) && !differ(true, false) && !differ(false, true));
    assert_refused(&run(&folder, &["render", "v-groove", "--methods", &["mip"; 10].join(","), "-o", "n.png"]), "10");
}

#[test]
fn a_session_file_is_obeyed_and_flags_go_over_it() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("maps")).expect("made");
    assert!(run(&folder, &["sample", "v-groove", "-o", "maps/groove.png", "--size", "32"]).status.success());
    let session =
        r#"{"map": {"path": "groove.png"}, "fit": {"lobes": 2}, "surface": {"shape": {"kind": "torus"}}, "later": 1}"#;
    std::fs::write(folder.path().join("maps/s.ndfi.json"), session).expect("written");
    let render = |name: &str, more: &[&str]| {
        let mut arguments =
            vec!["render", "--session", "maps/s.ndfi.json", "--size", "64x48", "--samples", "16", "-o", name];
        arguments.extend(more);
        let output = run(&folder, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path().join(name)).expect("written")
    };
    assert_eq!(render("a.png", &[]), render("b.png", &["--shape", "torus"]));
    assert_ne!(render("a.png", &[]), render("c.png", &["--shape", "sphere"]));
}

#[test]
fn a_file_of_lobes_stands_for_the_map_it_was_fitted_to() {
    let folder = folder();
    sample(&folder, "bricks");
    let fit =
        ["fit", "bricks.png", "-J", "3", "--align", "paper:0.5", "--exr", "a.exr", "--texel", "4,1,2", "--json", "-"];
    let fitted = json(&run(&folder, &fit));
    let again = json(&run(&folder, &["fit", "a.exr", "--texel", "4,1,2", "--json", "-"]));
    assert_eq!(again["texels"], fitted["texels"]);
    assert_eq!(again["settings"]["align"], "paper:0.5");
    let level = |report: &Value| report["levels"][3]["mean_log_likelihood"].clone();
    assert_eq!(level(&again), level(&fitted));
    let exported = run(&folder, &["export", "a.exr", "lobes", "-o", "b.exr"]);
    assert!(exported.status.success(), "{}", String::from_utf8_lossy(&exported.stderr));
    let probe = |map| {
        run(&folder, &["probe", map, "--method", "vmf:3", "--texel", "4,1,2", "--omega", "0,0.1,1", "--json", "-"])
    };
    assert_eq!(json(&probe("b.exr")), json(&probe("a.exr")));
    assert_refused(&run(&folder, &["fit", "a.exr", "--exr", "no/such/c.exr"]), "no/such/c.exr");
    assert_refused(&run(&folder, &["fit", "bricks.png", "--color", "gone.png"]), "gone.png");
}

#[test]
fn fit_prints_the_lobes_colours() {
    let folder = folder();
    sample(&folder, "scales");
    let arguments = ["fit", "scales.png", "-J", "2", "--color", "scales.png", "--texel", "3,1,1", "--json", "-"];
    let report = json(&run(&folder, &arguments));
    for lobe in report["texels"][0]["lobes"].as_array().expect("lobes") {
        assert_eq!(lobe["color"].as_array().map(Vec::len), Some(3), "{lobe}");
    }
    let plain = json(&run(&folder, &["fit", "scales.png", "-J", "2", "--texel", "3,1,1", "--json", "-"]));
    assert!(plain["texels"][0]["lobes"][0].get("color").is_none());
}

/// A Radiance HDR or OpenEXR file of grey texels, brighter to the right, the last of which is `last`.
fn write_sky(folder: &TempDir, name: &str, (width, height): (u32, u32), last: f32) {
    let value = |x, y| if (x + 1, y + 1) == (width, height) { last } else { 0.2 + x as f32 / width as f32 };
    let path = folder.path().join(name);
    if name.ends_with(".exr") {
        let grey = |x, y| <(f32, f32, f32)>::from([value(x as u32, y as u32); 3]);
        exr::prelude::write_rgb_file(path, width as usize, height as usize, grey).expect("written");
    } else {
        image::Rgb32FImage::from_fn(width, height, |x, y| image::Rgb([value(x, y); 3])).save(path).expect("saved");
    }
}

#[test]
fn a_sky_lights_the_picture_and_a_bad_one_is_refused_in_a_sentence() {
    let folder = folder();
    let render = |sky: &str, more: &[&str]| {
        let mut arguments = vec!["render", "v-groove", "--method", "mip", "--size", "64x48", "-o", "out.png"];
        arguments.extend(["--no-lights", "--sky", sky]);
        arguments.extend(more);
        run(&folder, &arguments)
    };
    write_sky(&folder, "grey.hdr", (32, 16), 3.0);
    let written = |sky, more: &[&str]| {
        let output = render(sky, more);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path().join("out.png")).expect("written")
    };
    let picture = written("grey.hdr", &[]);
    assert_ne!(picture, written("grey.hdr", &["--sky-rotation", "-120"]));
    assert_ne!(picture, written("overcast", &[]));
    write_sky(&folder, "square.hdr", (16, 16), 1.0);
    write_sky(&folder, "nan.exr", (16, 8), f32::NAN);
    write_sky(&folder, "endless.exr", (16, 8), f32::INFINITY);
    image::RgbImage::new(16, 8).save(folder.path().join("codes.png")).expect("saved");
    image::Rgb32FImage::new(16, 8).save(folder.path().join("night.hdr")).expect("saved");
    std::fs::write(folder.path().join("cut.hdr"), b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n\x02")
        .expect("written");
    for (sky, cause) in [
        ("square.hdr", "a sky is twice as wide as high"),
        ("nan.exr", "no number, at texel (15, 7)"),
        ("endless.exr", "no number, at texel (15, 7)"),
        ("codes.png", "read from Radiance HDR or"),
        ("night.hdr", "black everywhere"),
        ("cut.hdr", "cut.hdr"),
        ("gone.exr", "does not exist"),
    ] {
        assert_refused(&render(sky, &[]), sky);
        let error = render(sky, &[]).stderr;
        assert!(String::from_utf8_lossy(&error).contains(cause), "{sky}: {}", String::from_utf8_lossy(&error));
    }
}

#[test]
fn lights_of_the_command_line_take_the_place_of_the_sessions() {
    let folder = folder();
    let session = r#"{"map": {"bundled": "v-groove"}, "surface": {"light": {"azimuth_deg": 20.0}}}"#;
    std::fs::write(folder.path().join("s.json"), session).expect("written");
    let render = |more: &[&str]| {
        let mut arguments =
            vec!["render", "--session", "s.json", "--method", "mip", "--size", "64x48", "-o", "out.png"];
        arguments.extend(more);
        let output = run(&folder, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path().join("out.png")).expect("written")
    };
    assert_eq!(render(&[]), render(&["--light", "azimuth=20"]));
    assert_ne!(render(&[]), render(&["--light", "azimuth=20", "--light", "azimuth=-90,distance=2"]));
    let nine = ["--light", "azimuth=1"].repeat(9);
    let refused = run(&folder, &[&["render", "v-groove", "-o", "out.png"][..], &nine].concat());
    assert_refused(&refused, "9 lights are more than the 8");
    assert_eq!(run(&folder, &["render", "v-groove", "-o", "out.png", "--light", "bright"]).status.code(), Some(2));
}
