//! Measured reflectance: what the program writes in MERL's format it reads again as the model it was.

use ndf_inspector::brdf::{Brdf, ConvolutionRule, Measured, Merl, Model};
use serde_json::Value;

use super::cli::{assert_refused, folder, json, run, sample};

/// `f(theta_h) g(theta_d)` of a file.
fn measured(name: &str, strength: f32) -> (Brdf, Measured) {
    let model: Brdf = name.parse().expect("a BRDF");
    let bytes = Merl::of_brdf(model, strength).to_bytes();
    (model, Measured::new(name, &Merl::from_bytes(name, &bytes).expect("whole")))
}

#[test]
fn a_model_that_was_written_is_the_one_that_is_read() {
    for name in ["blinn-phong:20", "blinn-phong:400", "torrance-sparrow:0.1", "ggx:0.1", "ggx:0.4"] {
        let (model, read) = measured(name, 0.9);
        let of = read.measurement();
        println!("{name}: residual {:.1e}, exponent {:.1}", of.residual[0], read.exponent());
        assert!(of.residual.iter().all(|&residual| residual < 1e-5), "{name}: {:?}", of.residual);
        let peak = model.zonal(1.0);
        for degrees in [0.0_f64, 1.0, 3.0, 7.3, 20.0, 44.0, 70.0] {
            let u = degrees.to_radians().cos();
            // Bins are as wide as 2 % of the angle; between their middles f is taken as linear. The sharpest model here
            // loses 2.4e-3 of its peak, for the first middle is not the normal.
            let off = (read.zonal(u) - model.zonal(u)).abs();
            assert!(off < 4e-3 * peak, "{name} at {degrees}: {} against {}", read.zonal(u), model.zonal(u));
        }
        let ratio = read.factor(0.2).x / read.factor(1.0).x;
        let exact = ndf_inspector::brdf::fresnel::fresnel(0.9, 0.2) / ndf_inspector::brdf::fresnel::fresnel(0.9, 1.0);
        // g stands for the middles of degrees, the last one half a degree off.
        assert!((ratio / exact - 1.0).abs() < 5e-3, "{name}: {ratio} against {exact}");
    }
}

#[test]
fn measured_multipliers_are_those_of_the_model_that_was_written() {
    for name in ["blinn-phong:20", "torrance-sparrow:0.2", "ggx:0.3"] {
        let (model, read) = measured(name, 0.0);
        let [found, exact] = [Brdf::Measured(read), model].map(|brdf| brdf.multipliers(ConvolutionRule::Exact, 23));
        for (l, (found, exact)) in found.iter().zip(&exact).enumerate() {
            assert!((found - exact).abs() < 2e-3, "{name}, l {l}: {found} against {exact}");
        }
    }
}

#[test]
fn a_measured_lambertian_has_the_strength_of_the_whole() {
    let (_, read) = measured("lambert", 0.0);
    // f is constant over the hemisphere, 1/(2 pi) of it, times 2 pi by pi by 1/pi.
    let value = read.factor(0.7).x * read.zonal(0.3) as f32;
    assert!((value - 1.0).abs() < 1e-4, "{value}");
}

#[test]
fn the_same_contents_are_kept_once() {
    let (one, other) = (measured("ggx:0.2", 0.0).1, measured("ggx:0.2", 0.0).1);
    assert!(one == other && one != measured("ggx:0.3", 0.0).1);
    assert!(one.channels()[0] != one.channels()[1], "channels are told apart");
}

#[test]
fn the_command_line_writes_a_measured_file_and_probes_it_like_its_model() {
    let folder = folder();
    sample(&folder, "scales");
    let written = run(&folder, &["sample", "--brdf", "ggx:0.3", "--fresnel", "0.9", "-o", "ggx.binary"]);
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    let value = |brdf: &str, method: &str| {
        let arguments = ["probe", "scales.png", "--method", method, "--brdf", brdf, "--texel", "3,3,2"];
        let report = json(&run(&folder, &[&arguments[..], &["--omega", "0.1,0,1", "--json", "-"]].concat()));
        assert!(report["brdf"] == brdf, "{report}");
        report["texels"][0]["values"][0].as_f64().expect("a value")
    };
    for method in ["truth", "vmf:6", "sh:12"] {
        let (found, exact) = (value("merl:ggx.binary", method), value("ggx:0.3", method));
        assert!((found / exact - 1.0).abs() < 0.02, "{method}: {found} against {exact}");
    }
}

#[test]
fn a_bad_measured_file_is_refused_with_its_name() {
    let folder = folder();
    let written = run(&folder, &["sample", "--brdf", "lambert", "-o", "whole.binary"]);
    assert!(written.status.success());
    let bytes = std::fs::read(folder.path().join("whole.binary")).expect("written");
    std::fs::write(folder.path().join("short.binary"), &bytes[..bytes.len() / 2]).expect("written");
    std::fs::write(folder.path().join("text.binary"), "no reflectance").expect("written");
    for (name, cause) in [("short", "cut short"), ("text", "sizes 90, 90 and 180"), ("none", "does not exist")] {
        let brdf = format!("merl:{name}.binary");
        let refused = run(&folder, &["render", "plate", "--brdf", &brdf, "-o", "x.png"]);
        assert_refused(&refused, &format!("{name}.binary"));
        assert!(String::from_utf8_lossy(&refused.stderr).contains(cause), "{name}");
    }
    assert!(!folder.path().join("x.png").exists());
}

#[test]
fn a_session_file_names_the_measured_file_beside_it() {
    let folder = folder();
    assert!(run(&folder, &["sample", "--brdf", "ggx:0.3", "-o", "ggx.binary"]).status.success());
    let material = serde_json::json!({"model": Model::Measured});
    let session = serde_json::json!({"measured": "ggx.binary", "surface": {"material": material}});
    std::fs::write(folder.path().join("s.ndfi.json"), session.to_string()).expect("written");
    let arguments = ["compare", "plate", "--session", "s.ndfi.json", "--methods", "mip", "--json", "-"];
    let report: Value = json(&run(&folder, &[&arguments[..], &["--size", "32x24", "--samples", "2"]].concat()));
    let exponent = report["cells"][0]["exponent"].as_f64().expect("an exponent");
    assert!((exponent / 33.1 - 1.0).abs() < 0.05, "{exponent}");
}
