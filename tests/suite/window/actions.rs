//! What is done by keys, menus and the search for actions, and how it is undone.

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable;
use ndf_inspector::app::actions;
use ndf_inspector::app::view_state::{Layout, Overlay};
use ndf_inspector::comparison::View;
use ndf_inspector::filter::Method;
use ndf_inspector::lit_surface::LitSurface;
use ndf_inspector::session::Session;
use ndf_inspector::session::file::SessionFile;

use super::behaviour::{drag, step_until};
use super::{Window, fitted, window};

const UNDO: (Modifiers, Key) = (Modifiers::COMMAND, Key::Z);
const REDO: (Modifiers, Key) = (Modifiers::COMMAND, Key::Y);

/// Presses and waits until all that follows is done.
fn press(window: &mut Window, (modifiers, key): (Modifiers, Key)) {
    window.key_press_modifiers(modifiers, key);
    finish(window);
}

fn finish(window: &mut Window) {
    window.run_steps(3);
    step_until(window, "rest", |window| window.state().inspector.is_settled());
    window.run_steps(2);
}

fn session(window: &Window) -> &Session {
    &window.state().inspector.session
}

fn surface(window: &Window) -> LitSurface {
    session(window).surface.clone()
}

#[test]
fn a_drag_is_one_step_and_undo_and_redo_go_through_all_of_them() {
    let mut window = window(fitted("pyramid5", 64));
    window.run();
    let first = surface(&window);
    let at = window.get_by_label("Surface view").rect().center() + vec2(60.0, 40.0);
    drag(&mut window, at, vec2(50.0, 0.0), PointerButton::Primary);
    let orbited = surface(&window);
    window.get_by_label("Specular Ks").set_value_accesskit(1.5);
    window.run();
    let shiny = surface(&window);
    assert!(first != orbited && orbited != shiny);
    for (keys, expected) in [(UNDO, &orbited), (UNDO, &first), (UNDO, &first), (REDO, &orbited), (REDO, &shiny)] {
        press(&mut window, keys);
        assert_eq!(surface(&window), *expected, "{keys:?}");
    }
}

#[test]
fn the_fit_the_view_and_another_map_are_undone_too() {
    let mut window = window(fitted("pyramid5", 64));
    finish(&mut window);
    let before = window.state().inspector.session.map().source.clone();
    window.get_by_label("Lobes J").set_value_accesskit(2.0);
    finish(&mut window);
    press(&mut window, (Modifiers::NONE, Key::F4));
    let open = actions::find("open-bundled-waves").expect("an action");
    let command = open.command(&window.state().inspector.facts()).expect("it can be done");
    let ctx = window.ctx.clone();
    window.state_mut().inspector.run(command, &ctx);
    step_until(&mut window, "the map", |window| session(window).map().source != before);
    finish(&mut window);
    press(&mut window, UNDO);
    step_until(&mut window, "the map before", |window| session(window).map().source == before);
    assert_eq!(window.state().inspector.view.layout, Layout::Map);
    press(&mut window, UNDO);
    assert_eq!((window.state().inspector.view.layout, session(&window).fit_settings().lobes), (Layout::Surface, 2));
    press(&mut window, UNDO);
    assert_eq!(session(&window).fit_settings().lobes, super::SETTINGS.lobes);
}

#[test]
fn keys_do_what_the_list_says() {
    let mut window = window(fitted("pyramid5", 64));
    finish(&mut window);
    press(&mut window, (Modifiers::NONE, Key::Num4));
    press(&mut window, (Modifiers::COMMAND, Key::Num1));
    press(&mut window, (Modifiers::NONE, Key::D));
    press(&mut window, (Modifiers::NONE, Key::E));
    let comparison = session(&window).comparison;
    assert_eq!((comparison.left, comparison.right), (Method::Truth, Method::MIP));
    assert_eq!((comparison.view, surface(&window).exposure_stops), (View::Difference, 0.5));
    press(&mut window, (Modifiers::SHIFT, Key::E));
    let distance = surface(&window).camera.distance;
    press(&mut window, (Modifiers::NONE, Key::Plus));
    assert!(surface(&window).exposure_stops == 0.0 && surface(&window).camera.distance < distance);
    press(&mut window, (Modifiers::NONE, Key::F));
    assert!((surface(&window).camera.distance - LitSurface::default().camera.distance).abs() < 1e-6);
}

#[test]
fn letters_typed_into_a_field_are_text_and_no_keys() {
    let mut window = window(fitted("pyramid5", 64));
    window.get_by_label("Path of an image").focus();
    window.step();
    press(&mut window, (Modifiers::NONE, Key::D));
    assert_eq!(session(&window).comparison.view, View::Wipe);
}

#[test]
fn the_search_finds_an_action_by_its_words_and_enter_does_it() {
    let mut window = window(fitted("pyramid5", 64));
    finish(&mut window);
    press(&mut window, (Modifiers::COMMAND, Key::P));
    window.get_by_label("Search for an action").type_text("view grid");
    finish(&mut window);
    assert!(window.query_by_label("Do: undo").is_none());
    press(&mut window, (Modifiers::NONE, Key::ArrowDown));
    press(&mut window, (Modifiers::NONE, Key::Enter));
    assert_eq!(
        (session(&window).comparison.view, window.state().inspector.view.overlay),
        (View::Grid3x3, Overlay::None)
    );
    assert!(window.query_by_label("Search for an action").is_none());
}

#[test]
fn the_list_of_keys_names_every_action_and_escape_closes_it() {
    let mut window = window(fitted("pyramid5", 64));
    finish(&mut window);
    press(&mut window, (Modifiers::NONE, Key::Questionmark));
    for action in actions::all() {
        assert!(window.query_all_by_label(&action.label).next().is_some(), "'{}' is missing", action.label);
    }
    press(&mut window, (Modifiers::NONE, Key::Escape));
    assert_eq!(window.state().inspector.view.overlay, Overlay::None);
}

#[test]
fn a_session_saved_and_opened_shows_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("grid.ndfi.json");
    let mut window = window(fitted("pyramid5", 64));
    finish(&mut window);
    press(&mut window, (Modifiers::SHIFT, Key::G));
    press(&mut window, (Modifiers::NONE, Key::F3));
    press(&mut window, (Modifiers::COMMAND, Key::S));
    window.state_mut().inspector.view.session_path = path.display().to_string();
    finish(&mut window);
    window.get_by_label("Save the session").click();
    step_until(&mut window, "the file", |window| session(window).path() == Some(&path));
    let saved = SessionFile::read(&path).expect("a session");
    assert_eq!(saved.comparison, session(&window).comparison);
    press(&mut window, UNDO);
    press(&mut window, UNDO);
    assert_eq!(session(&window).comparison.view, View::Wipe);
    window.state_mut().inspector.session.open(ndf_inspector::session::MapRequest::File {
        path,
        options: ndf_inspector::normal_map::MapOptions::default(),
    });
    step_until(&mut window, "the session", |window| session(window).comparison.view == View::Grid3x3);
    finish(&mut window);
    assert_eq!(window.state().inspector.view.layout, Layout::Split);
}
