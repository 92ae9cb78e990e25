//! Every control comes back by a double click.

use egui_kittest::kittest::Queryable;
use glam::Vec3;
use ndf_inspector::app::ViewState;
use ndf_inspector::brdf::Material;
use ndf_inspector::comparison::{Comparison, View};
use ndf_inspector::lit_surface::LitSurface;

use super::behaviour::double_click;
use super::{Window, fitted, window};

fn reset(window: &mut Window, name: &str) {
    // Clicks that follow each other closely would count on.
    window.run_steps(40);
    let at = window.get_by_label(name).rect().center();
    double_click(window, at);
    window.run_steps(3);
}

#[test]
fn colours_boxes_and_rows_of_buttons_come_back_by_a_double_click() {
    let mut window = window(fitted("pyramid5", 64));
    window.set_size(egui::vec2(1280.0, 1600.0));
    window.run();
    let inspector = &mut window.state_mut().inspector;
    let surface = &mut inspector.session.surface;
    (surface.material.specular_color, surface.material.diffuse_color) = (Vec3::X, Vec3::Y);
    (surface.shape.mirrored, inspector.view.needles.frames) = (true, true);
    surface.lights.as_mut_slice()[0].color = Vec3::Z;
    inspector.session.comparison.view = View::Difference;
    (inspector.view.sphere_layers.points, inspector.view.hides_figures) = (false, true);
    window.run();
    for name in ["Specular colour", "Diffuse colour", "Light colour", "mirrored", "frames", "Points", "Figures"] {
        reset(&mut window, name);
    }
    reset(&mut window, "Seen as: Difference");
    let inspector = &window.state().inspector;
    let (surface, default) = (&inspector.session.surface, LitSurface::default());
    assert_eq!(surface.material, Material::DEFAULT);
    assert_eq!((&surface.lights, surface.shape.mirrored), (&default.lights, false));
    assert_eq!(inspector.session.comparison.view, Comparison::default().view);
    let view = ViewState::default();
    assert_eq!((inspector.view.sphere_layers, inspector.view.needles), (view.sphere_layers, view.needles));
    assert!(!inspector.view.hides_figures);
}
