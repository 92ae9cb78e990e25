//! Themes, the interface's scale, and the tour.

use egui_kittest::kittest::Queryable;
use ndf_inspector::app::actions;
use ndf_inspector::app::theme::{self, Theme};
use ndf_inspector::app::tour::STEPS;

use super::{Window, fitted, settle, window};

fn act(window: &mut Window, name: &str) {
    let action = actions::find(name).expect("an action");
    let command = action.command(&window.state().inspector.facts()).expect("it can be done");
    let ctx = window.ctx.clone();
    window.state_mut().inspector.run(command, &ctx);
    window.run_steps(4);
}

#[test]
fn a_theme_dresses_the_window_at_once() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    for (name, theme) in
        [("theme-light", Theme::Light), ("theme-high-contrast", Theme::HighContrast), ("theme-dark", Theme::Dark)]
    {
        act(&mut window, name);
        assert_eq!(theme::of(&window.ctx), theme.palette(), "{name}");
    }
}

#[test]
fn everything_grows_with_the_scale() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let before = window.ctx.pixels_per_point();
    act(&mut window, "scale-150");
    assert!((window.ctx.pixels_per_point() / before - 1.5).abs() < 1e-3);
    act(&mut window, "scale-up");
    assert!((window.ctx.pixels_per_point() / before - 1.625).abs() < 1e-3);
    act(&mut window, "scale-100");
    assert!((window.ctx.pixels_per_point() / before - 1.0).abs() < 1e-3);
}

#[test]
fn the_tour_waits_to_be_asked_for_goes_through_five_steps_and_is_known_then() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    assert!(window.query_by_label("Next step of the tour").is_none(), "nobody asked for it");
    act(&mut window, "tour");
    for (index, step) in STEPS.into_iter().enumerate() {
        assert!(window.query_by_label(step.title).is_some(), "step {index}");
        assert!(!window.state().inspector.settings().knows_tour);
        window.get_by_label("Next step of the tour").click();
        window.run_steps(4);
    }
    assert!(window.query_by_label("Next step of the tour").is_none());
    assert!(window.state().inspector.settings().knows_tour);
}

#[test]
fn a_choice_tells_about_itself() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let told = [
        ("Objective", "Objective: EM"),
        ("Alignment", "Alignment: smooth"),
        ("Lobe count", "Lobe count: J in every texel"),
        ("Kappa from r", "Kappa from r: exact"),
        ("Convolution", "Convolution: s + 1"),
        ("Diffuse rule", "Diffuse rule: cosine"),
        ("Left method", "Truth"),
        ("Right method", "Von Mises-Fisher lobes"),
    ];
    for (choice, title) in told {
        window.get_by_label(&format!("About: {choice}")).click();
        window.run_steps(4);
        assert!(window.query_by_label(title).is_some(), "{choice}: no {title}");
        window.key_press(egui::Key::Escape);
        window.run_steps(4);
        assert!(window.query_by_label(title).is_none(), "{choice} stays");
    }
}
