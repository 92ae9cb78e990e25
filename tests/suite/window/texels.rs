//! What the window says of texels.

use std::sync::Arc;

use egui_kittest::kittest::Queryable;
use ndf_inspector::brdf::{BlinnPhong, Brdf};
use ndf_inspector::filter::VmfFilter;
use ndf_inspector::filter::brdf_error::texel_error;
use ndf_inspector::filter::vmf::{Fold, Rules};

use super::{fitted, settle, window};

#[test]
fn the_texels_error_is_that_of_its_lobes_and_follows_the_material() {
    let mut window = window(fitted("pyramid5", 64));
    for shininess in [64.0, 16.0] {
        window.state_mut().inspector.session.surface.material.shininess = shininess;
        settle(&mut window);
        let session = &window.state().inspector.session;
        let filter = VmfFilter { lobes: Arc::clone(session.lobes()), fold: Fold::default(), rules: Rules::default() };
        let brdf = Brdf::BlinnPhong(BlinnPhong { shininess: f64::from(shininess) });
        let error = texel_error(session.map(), &filter, session.selected(), brdf).expect("above the horizon");
        assert!(window.query_by_label(&format!("Effective BRDF error at s = {shininess}")).is_some());
        let text = format!("{:.2} %", 100.0 * error);
        assert!(window.query_by_label(&text).is_some(), "no {text} at s = {shininess}");
    }
}
