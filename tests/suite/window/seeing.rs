//! Methods beside each other: how they are seen, and what the pointer and the keys do there.

use egui::{Key, PointerButton, Rect, ViewportId, vec2};
use egui_kittest::kittest::Queryable;
use image::RgbaImage;
use ndf_inspector::comparison::{Comparison, DifferenceKind, View};
use ndf_inspector::filter::LevelChoice;
use ndf_inspector::normal_map::pyramid::Texel;

use super::behaviour::{click, press};
use super::{Window, fitted, settle, window};

fn set(window: &mut Window, comparison: Comparison) {
    window.state_mut().inspector.session.comparison = comparison;
    window.run();
}

/// The middle of the surface's picture, clear of names and handles.
fn middle(window: &mut Window) -> RgbaImage {
    let rect = window.get_by_label("Surface view").rect();
    let rect = Rect::from_center_size(rect.center() + vec2(90.0, 20.0), vec2(120.0, 100.0));
    let whole = window.render().expect("a picture");
    image::imageops::crop_imm(&whole, rect.left() as u32, rect.top() as u32, 120, 100).to_image()
}

#[test]
fn the_space_bar_and_the_button_show_the_right_method_of_every_two_while_they_are_held() {
    let mut window = window(fitted("plate", 64));
    set(&mut window, Comparison { wipe: 0.0, ..Comparison::default() });
    settle(&mut window);
    let right = middle(&mut window);
    for view in [View::Wipe, View::Flip, View::Difference] {
        set(&mut window, Comparison { view, wipe: 1.0, ..Comparison::default() });
        settle(&mut window);
        let at_rest = middle(&mut window);
        assert!(at_rest != right, "{view} shows the right method unasked");
        window.key_down(Key::Space);
        window.run();
        assert!(middle(&mut window) == right, "{view} is not flipped by the space bar");
        window.key_up(Key::Space);
        window.run();
        let button = window.get_by_label("Hold to flip").rect().center();
        press(&mut window, button, PointerButton::Primary, true);
        window.run();
        assert!(middle(&mut window) == right, "{view} is not flipped by the button");
        press(&mut window, button, PointerButton::Primary, false);
        window.run();
        assert!(middle(&mut window) == at_rest, "{view} stays flipped");
    }
}

#[test]
fn a_space_that_is_typed_flips_nothing() {
    let mut window = window(fitted("plate", 64));
    set(&mut window, Comparison { wipe: 1.0, ..Comparison::default() });
    settle(&mut window);
    let at_rest = middle(&mut window);
    window.get_by_label("Path of an image").focus();
    window.run();
    window.key_down(Key::Space);
    window.step();
    assert!(middle(&mut window) == at_rest);
}

#[test]
fn the_same_place_in_every_cell_of_a_grid_is_the_same_texel() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.session.surface.level = LevelChoice::Fixed(3.0);
    for (view, side) in [(View::Grid2x2, 2.0), (View::Grid3x3, 3.0)] {
        set(&mut window, Comparison { view, ..Comparison::default() });
        settle(&mut window);
        let picture = window.get_by_label("Surface view").rect();
        let mut picked = Vec::new();
        for cell in 0..(side * side) as usize {
            let at = vec2(0.55 + cell as f32 % side, 0.6 + (cell as f32 / side).floor()) / side;
            window.state_mut().inspector.session.select(Texel { level: 6, x: 0, y: 0 });
            click(&mut window, picture.min + at * picture.size(), PointerButton::Primary);
            picked.push(window.state().inspector.session.selected());
        }
        assert_eq!(picked[0].level, 3, "nothing is picked in {view}");
        assert!(picked.iter().all(|texel| *texel == picked[0]), "{view}: {picked:?}");
    }
}

#[test]
fn a_cell_of_a_grid_is_given_a_method_by_the_list_at_its_head() {
    let mut window = window(fitted("pyramid5", 64));
    set(&mut window, Comparison { view: View::Grid3x3, ..Comparison::default() });
    window.get_by_label("Method of cell 9").click();
    window.run();
    // The seventh cell's list shows this name too; the open list comes last.
    let choice = window.query_all_by_label("GMM N = 4").last().expect("offered");
    choice.click();
    window.run();
    let grid = window.state().inspector.session.comparison.grid;
    assert_eq!(grid[8], grid[5]);
}

#[test]
fn the_difference_has_two_kinds_and_a_range() {
    let mut window = window(fitted("pyramid5", 64));
    window.get_by_label("Seen as: Difference").click();
    window.run();
    window.get_by_label("Difference: signed").click();
    window.run();
    window.get_by_label("Difference range").set_value_accesskit(0.05);
    window.run();
    let comparison = window.state().inspector.session.comparison;
    assert_eq!((comparison.view, comparison.difference.kind), (View::Difference, DifferenceKind::Signed));
    assert!((comparison.difference.range - 0.05).abs() < 1e-3, "{}", comparison.difference.range);
}

#[test]
fn the_dolly_runs_while_it_is_played_and_rests_when_it_is_stopped() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let distance = |window: &Window| window.state().inspector.session.surface.camera.distance;
    let before = distance(&window);
    window.get_by_label("Run the dolly").click();
    for _ in 0..6 {
        window.step();
    }
    let after = distance(&window);
    assert!(after > 1.01 * before, "{after} after {before}");
    window.get_by_label("Stop the dolly").click();
    window.step();
    settle(&mut window);
    let stopped = distance(&window);
    window.step();
    assert_eq!(distance(&window), stopped);
    assert_eq!(window.output().viewport_output[&ViewportId::ROOT].repaint_delay, std::time::Duration::MAX);
}
