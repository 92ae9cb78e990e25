//! Scripts: the window driven by names from a file, without a display.

use crate::cli::{folder, run, sample};

/// The script that the README shows.
fn example() -> String {
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).expect("there");
    let (_, rest) = readme.split_once("```text\n# tour.txt").expect("the README shows a script");
    rest.split_once("```").expect("it ends").0.to_owned()
}

#[test]
fn the_example_of_the_readme_draws_the_same_bytes_twice() {
    let pictures = || {
        let folder = folder();
        sample(&folder, "plate");
        std::fs::write(folder.path().join("tour.txt"), example()).expect("written");
        let options = ["screenshot", "plate.png", "--script", "tour.txt", "--samples", "16", "--size", "1000x640"];
        let output = run(&folder, &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let read = |name: &str| std::fs::read(folder.path().join(name)).expect("a picture");
        [read("three-lobes.png"), read("before.png")]
    };
    let (first, second) = (pictures(), pictures());
    assert!(first == second, "two runs of one script differ");
    assert!(first[0] != first[1], "the undone drag shows nothing");
}

#[test]
fn a_step_that_cannot_be_done_names_its_line_and_the_cause() {
    let folder = folder();
    sample(&folder, "plate");
    let refused = |script: &str, cause: &str| {
        std::fs::write(folder.path().join("bad.txt"), script).expect("written");
        let options = ["screenshot", "plate.png", "--script", "bad.txt", "--samples", "16", "--size", "900x600"];
        let output = run(&folder, &options);
        // A driver may have had its own say before.
        let error = String::from_utf8_lossy(&output.stderr);
        let last = error.lines().last().unwrap_or_default();
        assert!(output.status.code() == Some(1) && last.contains(cause), "{error}");
    };
    refused("wait\ndance", "'bad.txt', line 2: 'dance' is no step");
    refused("\nset Lobez 3", "'bad.txt', line 2: there is no control named 'Lobez'; the nearest is 'Lobes'.");
    refused("set \"Lobes J\" 40", "line 1: 'Lobes J' goes from 1 to 16, and 40 is beyond.");
    refused("picture x.png levles", "line 1: write controls, surface, map, figures, texel or levels");
    refused("do preset-map-only\npicture x.png texel", "line 2: The panel Texel is out of sight");
    refused("do cancel-fit", "line 1: 'cancel-fit' cannot be done now.");
    refused("open nowhere.png", "line 1: 'nowhere.png'");
    refused("expect \"Lobes J\" 3", "line 1: 'Lobes J' is 6, not 3.");
}

#[test]
fn every_kind_of_step_does_what_it_says() {
    let folder = folder();
    sample(&folder, "plate");
    let script = "
        set 'Objective' likelihood
        expect 'Objective' likelihood
        set 'Trace of the fit' on
        set 'Specular Ks' 1.5
        expect 'Specular Ks' 1.5
        double-click 'Specular Ks'
        expect 'Specular Ks' 0.1
        key F4
        scroll 'Map view' 40
        drag 'Map view' 20 10
        do open-bundled-waves
        expect waves
        key Ctrl+P
        type 'reset view'
        key Enter
        set 'Path of an image' plate.png
        click 'Path of an image'
        key Enter
        wait
        expect plate.png
        hover 'Level 2'
        picture levels.png levels
        set 'Truth samples' 16
        save kept.ndfi.json
        wait
    ";
    std::fs::write(folder.path().join("steps.txt"), script).expect("written");
    let options = ["screenshot", "--script", "steps.txt", "--samples", "16", "-o", "end.png"];
    let output = run(&folder, &options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let kept = std::fs::read_to_string(folder.path().join("kept.ndfi.json")).expect("saved");
    assert!(kept.contains(r#""path": "plate.png""#) && kept.contains(r#""objective": "likelihood""#), "{kept}");
    let size = |name: &str| image::image_dimensions(folder.path().join(name)).expect("a picture");
    let ((width, height), whole) = (size("levels.png"), size("end.png"));
    assert!(width < whole.0 && height < whole.1 / 2, "one panel alone: {width} x {height}");
}

#[test]
fn presets_and_themes_are_chosen_by_option_and_by_name() {
    let folder = folder();
    sample(&folder, "plate");
    let script = "
        expect 'Start figures'
        click 'Preset: Map only'
        expect 'Map view'
        do preset-tune
        expect 'Sphere view'
        do reset-layout
        do theme-high-contrast
        do scale-125
        picture tuned.png
    ";
    std::fs::write(folder.path().join("presets.txt"), script).expect("written");
    let shared = ["screenshot", "plate.png", "--samples", "16", "--size", "1000x640"];
    let picture = |options: &[&str]| {
        let output = run(&folder, &[&shared, options, &["-o", "picture.png"]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path().join("picture.png")).expect("a picture")
    };
    let dark = picture(&["--preset", "compare", "--script", "presets.txt"]);
    let light = picture(&["--preset", "compare", "--theme", "light"]);
    assert!(light != dark && light == picture(&["--preset", "compare", "--theme", "light"]));
    let output = run(&folder, &[&shared[..], &["--preset", "nothing", "-o", "picture.png"]].concat());
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && error.contains("inspect, compare, tune or map-only"), "{error}");
}

#[test]
fn a_panel_is_pictured_alone() {
    let folder = folder();
    sample(&folder, "plate");
    let run = |options: &[&str]| {
        let shared = ["screenshot", "plate.png", "--samples", "16", "--size", "1000x640"];
        run(&folder, &[&shared, options].concat())
    };
    let picture = |name: &str| image::open(folder.path().join(name)).expect("a PNG").to_rgba8();
    assert!(
        run(&["-o", "whole.png"]).status.success() && run(&["--panel", "texel", "-o", "panel.png"]).status.success()
    );
    let (whole, panel) = (picture("whole.png"), picture("panel.png"));
    assert!(panel.width() > 200 && panel.width() < 500 && panel.height() > 400, "{:?}", panel.dimensions());
    // It stands at the window's right edge.
    let left = whole.width() - panel.width();
    let is_at = |top: u32| {
        let part = image::imageops::crop_imm(&whole, left, top, panel.width(), panel.height());
        part.to_image() == panel
    };
    assert!((0..=whole.height() - panel.height()).any(is_at));
    let output = run(&["--panel", "figures", "-o", "none.png"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && error.contains("Figures is out of sight"), "{error}");
}
