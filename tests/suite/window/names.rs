//! The names of controls, and that each has its place.

use std::collections::BTreeMap;

use egui::Rect;
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};
use ndf_inspector::app::map_shading::MapShading;
use ndf_inspector::app::view_state::{Layout, Overlay};
use ndf_inspector::comparison::View;

use super::{Window, fitted, settle, window};

/// Every control with the name that it carries.
fn controls(window: &Window) -> impl Iterator<Item = (String, Node<'_>)> {
    let inputs = window.root().children_recursive();
    let inputs = inputs.filter(|node| egui::accessibility::is_input(node.accesskit_node().role()));
    inputs.map(|node| (node.accesskit_node().label().unwrap_or_default(), node))
}

#[test]
fn every_control_has_a_name_of_its_own() {
    let mut window = window(fitted("pyramid5", 64));
    let view = &mut window.state_mut().inspector.view;
    (view.show_brdf, view.map.shading) = (true, MapShading::Error);
    settle(&mut window);
    let views = View::ALL.map(|(view, _)| (Layout::Surface, view, Overlay::None));
    let layouts = Layout::ALL.map(|(layout, _)| (layout, View::Wipe, Overlay::None));
    let overlays = [Overlay::Palette, Overlay::Keys, Overlay::SaveSession, Overlay::Log];
    let overlays = overlays.map(|overlay| (Layout::Surface, View::Wipe, overlay));
    for (layout, shown, overlay) in views.into_iter().chain(layouts).chain(overlays) {
        window.state_mut().inspector.session.comparison.view = shown;
        let view = &mut window.state_mut().inspector.view;
        (view.layout, view.overlay, view.show_trace) = (layout, overlay, true);
        window.run_steps(4);
        assert_named(&window, &format!("{layout:?}, {shown}, {overlay:?}"), 30);
        if overlay == Overlay::None {
            assert_apart(&window, &format!("{layout:?}, {shown}"));
        }
    }
}

/// Asserts that no two controls overlap, save where one lies on the other as on a picture.
#[track_caller]
fn assert_apart(window: &Window, state: &str) {
    let placed = controls(window).filter(|(_, node)| node.accesskit_node().bounding_box().is_some());
    let controls: Vec<(String, Rect)> = placed.map(|(name, node)| (name, node.rect().shrink(0.5))).collect();
    let crossing = |a: Rect, b: Rect| a.intersects(b) && !a.contains_rect(b) && !b.contains_rect(a);
    assert!(controls.len() > 20, "only {} controls have a place", controls.len());
    for (index, (name, rect)) in controls.iter().enumerate() {
        for (other, place) in &controls[..index] {
            assert!(!crossing(*rect, *place), "{state}: '{name}' at {rect} lies across '{other}' at {place}");
        }
    }
}

#[test]
fn every_entry_of_the_menus_has_a_name_of_its_own() {
    let mut window = window(fitted("pyramid5", 64));
    for menu in ["File", "Edit", "View", "Help"] {
        window.get_by_label(menu).click();
        window.run_steps(4);
        assert_named(&window, menu, 30);
        window.key_press(egui::Key::Escape);
        window.run_steps(2);
    }
}

#[track_caller]
pub(super) fn assert_named(window: &Window, state: &str, least: usize) {
    let mut names = BTreeMap::<String, usize>::new();
    controls(window).for_each(|(name, _)| *names.entry(name).or_default() += 1);
    assert!(names.len() > least, "only {} controls: {names:?}", names.len());
    let wrong: Vec<_> = names.iter().filter(|(name, count)| name.trim().is_empty() || **count > 1).collect();
    assert!(wrong.is_empty(), "unnamed or doubled in {state}: {wrong:?}");
}
