//! Presets, and panels that dock.

use egui::{Key, Modifiers, PointerButton, Rect, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use ndf_inspector::app::dock::{Panel, Preset};
use ndf_inspector::app::view_state::Layout;
use ndf_inspector::session::MapRequest;
use ndf_inspector::session::file::SessionFile;

use super::behaviour::{double_click, drag, step_until};
use super::names::assert_named;
use super::{Window, fitted, settle, window};

/// Something that only this panel has.
fn sign(panel: Panel) -> &'static str {
    match panel {
        Panel::Controls => "Lobes J",
        Panel::Surface => "Surface view",
        Panel::Map => "Map view",
        Panel::Figures => "Start figures",
        Panel::Texel => "Sphere view",
        Panel::Levels => "Level 0",
    }
}

fn in_sight(window: &Window) -> Vec<Panel> {
    Panel::ALL.into_iter().filter(|panel| window.query_by_label(sign(*panel)).is_some()).collect()
}

fn choose(window: &mut Window, preset: &str) {
    window.get_by_label(&format!("Preset: {preset}")).click();
    window.run_steps(4);
}

#[test]
fn a_preset_shows_its_panels_and_every_control_has_a_name_of_its_own_there() {
    use Panel::{Controls, Figures, Levels, Map, Surface, Texel};
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let shown: [(&str, &[Panel]); 4] = [
        ("Map only", &[Map, Levels]),
        ("Compare", &[Surface, Figures]),
        ("Tune", &[Controls, Surface, Map, Texel, Levels]),
        ("Inspect", &[Controls, Surface, Texel, Levels]),
    ];
    for (preset, panels) in shown {
        choose(&mut window, preset);
        assert_eq!(in_sight(&window), panels, "{preset}");
        assert_named(&window, preset, 15);
    }
}

/// Everything that can be read or used, where it is shown and not cut off by what scrolls.
fn texts(window: &Window) -> Vec<(String, Rect)> {
    let nodes = window.root().children_recursive();
    nodes
        .filter_map(|node| {
            let node = node.accesskit_node();
            let text = node.label().or_else(|| node.value())?;
            let bounds = node.bounding_box()?;
            let rect = Rect::from_min_max(
                egui::pos2(bounds.x0 as f32, bounds.y0 as f32),
                egui::pos2(bounds.x1 as f32, bounds.y1 as f32),
            );
            Some((text, rect))
        })
        .collect()
}

#[test]
fn in_every_preset_no_text_leaves_the_window_or_its_panel() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    for (_, preset) in Preset::ALL {
        choose(&mut window, preset);
        let texts = texts(&window);
        assert!(texts.len() > 15, "{preset}: {texts:?}");
        let wide: Vec<_> = texts.iter().filter(|(_, rect)| rect.left() < -0.5 || rect.right() > 1280.5).collect();
        assert!(wide.is_empty(), "{preset}: {wide:?}");
    }
}

#[test]
fn a_tab_is_dragged_to_another_place_which_undo_and_the_reset_take_back() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let place = |window: &Window| window.state().inspector.view.dock.place.clone();
    let before = window.get_by_label("Sphere view").rect();
    let tab = window.get_by_label("Panel: Texel").rect().center();
    let left_edge = window.get_by_label("Surface view").rect().left_center() + vec2(20.0, 0.0);
    drag(&mut window, tab, left_edge - tab, PointerButton::Primary);
    window.run_steps(4);
    let moved = place(&window);
    assert!(moved.is_some() && window.get_by_label("Sphere view").rect().left() < before.left() - 100.0);
    assert_named(&window, "a moved panel", 20);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(4);
    assert_eq!((place(&window), window.get_by_label("Sphere view").rect()), (None, before));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    window.run_steps(4);
    assert_eq!(place(&window), moved);
    let preset = window.get_by_label("Preset: Inspect").rect().center();
    double_click(&mut window, preset);
    window.run_steps(4);
    assert_eq!((place(&window), window.get_by_label("Sphere view").rect()), (None, before));
}

#[test]
fn an_edge_resizes_its_panels_and_a_larger_window_leaves_them_so() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let controls = |window: &Window| window.get_by_label("Surface view").rect().left();
    let edge = egui::pos2(controls(&window) - 0.5, 500.0);
    drag(&mut window, edge, vec2(60.0, 0.0), PointerButton::Primary);
    window.run_steps(4);
    let width = controls(&window);
    assert!((width - edge.x - 60.0).abs() < 3.0, "{width}");
    window.set_size(vec2(1920.0, 1080.0));
    window.run_steps(4);
    assert!((controls(&window) - width).abs() < 1.5, "{} after {width}", controls(&window));
    assert!(window.get_by_label("Surface view").rect().width() > 1200.0);
}

#[test]
fn panels_are_hidden_by_their_cross_and_shown_again_by_the_menu() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    for (panel, action) in [("Controls", "panel-controls"), ("Texel", "panel-texel"), ("Levels", "panel-levels")] {
        let count = in_sight(&window).len();
        window.get_by_label(&format!("Hide {panel}")).click();
        window.run_steps(4);
        assert_eq!(in_sight(&window).len(), count - 1, "{panel}");
        act(&mut window, action);
        assert_eq!(in_sight(&window).len(), count, "{panel}");
    }
}

fn act(window: &mut Window, name: &str) {
    let action = ndf_inspector::app::actions::find(name).expect("an action");
    let command = action.command(&window.state().inspector.facts()).expect("it can be done");
    let ctx = window.ctx.clone();
    window.state_mut().inspector.run(command, &ctx);
    window.run_steps(4);
}

#[test]
fn the_layout_is_kept_in_the_session_and_older_sessions_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    act(&mut window, "preset-tune");
    act(&mut window, "panel-levels");
    let edge = egui::pos2(window.get_by_label("Surface view").rect().left() - 0.5, 500.0);
    drag(&mut window, edge, vec2(40.0, 0.0), PointerButton::Primary);
    window.run_steps(4);
    let dock = window.state().inspector.view.dock.clone();
    assert!(dock.place.is_some() && !dock.sides.levels && dock.preset == Preset::Tune);
    let view = serde_json::to_value(&window.state().inspector.view).expect("serialises");
    let write = |name: &str, view: serde_json::Value| {
        let path = folder.path().join(name);
        SessionFile { view: Some(view), ..SessionFile::default() }.write(&path).expect("written");
        path
    };
    let [tuned, old] = [write("tuned.ndfi.json", view), write("old.ndfi.json", serde_json::json!({"layout": "map"}))];
    let mut open = |path: std::path::PathBuf| {
        act(&mut window, "preset-compare");
        let options = ndf_inspector::normal_map::MapOptions::default();
        window.state_mut().inspector.session.open(MapRequest::File { path, options });
        step_until(&mut window, "the layout", |window| window.state().inspector.view.dock.preset != Preset::Compare);
        window.state().inspector.view.clone()
    };
    assert_eq!(open(tuned).dock, dock);
    let old = open(old);
    assert_eq!((old.layout, old.dock), (Layout::Map, Default::default()));
}
