//! What `probe` prints: every method's effective BRDF in one direction.

use serde_json::Value;

use crate::cli::{assert_refused, folder, json, run, sample};

#[test]
fn probe_of_vmf_is_the_formula_on_the_lobes_that_fit_prints() {
    let folder = folder();
    sample(&folder, "scales");
    let fit = json(&run(&folder, &["fit", "scales.png", "-J", "4", "--texel", "3,3,2", "--json", "-"]));
    let probe = json(&run(
        &folder,
        &[
            "probe",
            "scales.png",
            "--method",
            "vmf:4",
            "--brdf",
            "blinn-phong:40",
            "--texel",
            "3,3,2",
            "--omega",
            "0.2,-0.1,1",
            "--json",
            "-",
        ],
    ));
    let omega = glam::DVec3::new(0.2, -0.1, 1.0).normalize();
    let value: f64 = fit["texels"][0]["lobes"]
        .as_array()
        .expect("lobes")
        .iter()
        .map(|lobe| {
            let number = |value: &Value| value.as_f64().expect("a number");
            let kappa = number(&lobe["kappa"]);
            let mu = glam::DVec3::new(number(&lobe["mu"][0]), number(&lobe["mu"][1]), number(&lobe["mu"][2]));
            let exponent = (kappa * 41.0 / (kappa + 41.0) - 1.0).max(0.0);
            number(&lobe["alpha"]) * (exponent + 1.0) / std::f64::consts::TAU * mu.dot(omega).max(0.0).powf(exponent)
        })
        .sum();
    let probed = probe["texels"][0]["values"][0].as_f64().expect("a value");
    assert!((probed / value - 1.0).abs() < 1e-9, "{probed} against {value}");
    assert_eq!(probe["method"], "vmf:4");
}

#[test]
fn every_method_of_a_base_texel_and_of_a_flat_map_is_the_unfiltered_shading() {
    let folder = folder();
    let values = |map: &str, texel: &str, method: &str| -> Vec<f64> {
        let report = json(&run(
            &folder,
            &[
                "probe",
                map,
                "--method",
                method,
                "--brdf",
                "blinn-phong:400",
                "--texel",
                texel,
                "--omega",
                "0,0,1",
                "--omega",
                "0.03,0.02,1",
                "--json",
                "-",
            ],
        ));
        serde_json::from_value(report["texels"][0]["values"].clone()).expect("values")
    };
    image::RgbImage::from_pixel(24, 10, image::Rgb([140, 120, 250]))
        .save(folder.path().join("flat.png"))
        .expect("saved");
    sample(&folder, "waves");
    for (map, texel) in [("waves.png", "0,50,31"), ("flat.png", "2,1,1"), ("flat.png", "4,0,0"), ("flat.png", "0,3,3")]
    {
        let truth = values(map, texel, "truth");
        for method in ["mip", "mip-unnormalised", "toksvig", "vmf:6"] {
            for (value, exact) in values(map, texel, method).iter().zip(&truth) {
                // A stored delta is as sharp as f32 resolves, kappa 1e7: 4e-5 of s = 400 and of the value.
                assert!(
                    (value - exact).abs() < 1e-3 * exact.max(1.0),
                    "{map} {texel} {method}: {value} against {exact}"
                );
            }
        }
    }
}

#[test]
fn every_rival_is_probed_and_drawn_by_the_name_that_the_report_repeats() {
    let folder = folder();
    sample(&folder, "scales");
    for method in ["mip", "mip-unnormalised", "toksvig", "lean", "gmm:4", "gmm:2", "sh:2", "sh:7"] {
        let probe =
            ["probe", "scales.png", "--method", method, "--texel", "3,3,2", "--omega", "0,0.1,1", "--json", "-"];
        let report = json(&run(&folder, &probe));
        assert_eq!(report["method"], method);
        assert!(report["texels"][0]["values"][0].as_f64().is_some_and(f64::is_finite), "{method}");
        let output = run(&folder, &["render", "scales.png", "--method", method, "--size", "48x32", "-o", "r.png"]);
        assert!(output.status.success(), "{method}: {}", String::from_utf8_lossy(&output.stderr));
        let picture = image::open(folder.path().join("r.png")).expect("a picture").to_rgb8();
        assert!(picture.pixels().any(|pixel| pixel[1] > 60), "{method} is dark");
    }
}

#[test]
fn harmonics_beyond_those_that_are_drawn_are_probed_only() {
    let folder = folder();
    sample(&folder, "scales");
    let probe = ["probe", "scales.png", "--method", "sh:22", "--texel", "3,3,2", "--omega", "0,0,1"];
    assert!(run(&folder, &probe).status.success());
    assert_refused(&run(&folder, &["render", "scales.png", "--method", "sh:22", "-o", "r.png"]), "sh:22");
}
