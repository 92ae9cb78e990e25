//! The material's controls: models, drying, measured files.

use egui_kittest::kittest::Queryable;
use ndf_inspector::brdf::drying::Drying;
use ndf_inspector::brdf::{Brdf, Ggx, Merl, Model};

use super::behaviour::step_until;
use super::{Window, fitted, window};

fn choose(window: &mut Window, model: Model) {
    window.get_by_label("Model").click();
    window.run();
    window.get_by_label(model.kind().label).click();
    window.run();
}

#[test]
fn every_model_is_offered_by_name_and_has_its_own_slider() {
    let mut window = window(fitted("pyramid5", 64));
    for model in Model::ALL.into_iter().rev() {
        choose(&mut window, model);
        assert_eq!(window.state().inspector.session.surface.material.model, model);
        let Some(parameter) = &model.kind().parameter else { continue };
        let value = f64::from(parameter.range[0]) * 1.5;
        window.get_by_label(parameter.label).set_value_accesskit(value);
        window.run();
        let found = *(parameter.field)(&mut window.state_mut().inspector.session.surface.material);
        assert!((f64::from(found) / value - 1.0).abs() < 1e-3, "{}: {found}", parameter.label);
    }
}

#[test]
fn the_drying_time_takes_the_material_along_its_track() {
    let mut window = window(fitted("pyramid5", 64));
    window.get_by_label("Drying").click();
    window.run();
    window.get_by_label("Drying time").set_value_accesskit(1.0);
    window.run();
    let (found, dry) = (window.state().inspector.session.surface.material.moment(), Drying::default().dry);
    assert!((found.exponent / dry.exponent - 1.0).abs() < 1e-3 && found.specular == dry.specular, "{found:?}");
    window.get_by_label("Set wet").click();
    window.run();
    assert_eq!(window.state().inspector.view.drying.track.wet, found);
}

#[test]
fn a_measured_file_becomes_the_material_and_a_bad_one_leaves_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let [good, bad] = ["good.binary", "bad.binary"].map(|name| folder.path().join(name));
    std::fs::write(&good, Merl::of_brdf(Brdf::Ggx(Ggx { alpha: 0.3 }), 0.5).to_bytes()).expect("written");
    std::fs::write(&bad, [0; 40]).expect("written");
    let mut window = window(fitted("pyramid5", 64));
    for path in [good, bad] {
        window.state_mut().inspector.session.open_measured(path);
        step_until(&mut window, "the file", |window| !window.state().inspector.session.is_measuring());
        assert_eq!(window.state().inspector.session.surface.material.model, Model::Measured);
        assert!(window.query_by_label_contains("good.binary: f(theta_h) g(theta_d) leaves 0.0").is_some());
    }
    let told = |window: &Window| window.query_by_label_contains("should begin with the sizes").is_some();
    step_until(&mut window, "the sentence", told);
}
