//! What the window does.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{PointerButton, ViewportId, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use ndf_inspector::brdf::{ConvolutionRule, DiffuseRule};
use ndf_inspector::filter::Method;
use ndf_inspector::filter::vmf::{FitSettings, Fold};
use ndf_inspector::lighting::SkySource;
use ndf_inspector::normal_map::albedo::Albedo;
use ndf_inspector::normal_map::pyramid::Texel;
use ndf_inspector::normal_map::{MapOptions, MapSource, procedural};
use ndf_inspector::session::{MapRequest, Session};

use super::{Window, fitted, session, settle, window};

pub(super) fn step_until(window: &mut Window, what: &str, done: impl Fn(&Window) -> bool) {
    let start = Instant::now();
    while !done(window) {
        assert!(start.elapsed() < Duration::from_secs(30), "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(10));
        window.step();
    }
}

/// Leaves the pointer where it is until a tooltip shows: after half a second, of 0.02 s a step.
fn rest(window: &mut Window) {
    window.run_steps(40);
}

#[test]
fn every_rule_of_the_material_is_offered_by_name() {
    let mut window = window(fitted("pyramid5", 64));
    let mut choose = |control: &str, choice: &str| {
        window.get_by_label(control).click();
        window.run();
        window.get_by_label(choice).click();
        window.run();
        window.state().inspector.session.surface.material
    };
    for rule in ConvolutionRule::ALL.into_iter().rev() {
        assert_eq!(choose("Convolution", rule.label()).convolution, rule);
    }
    for rule in DiffuseRule::ALL.into_iter().rev() {
        assert_eq!(choose("Diffuse rule", rule.label()).diffuse_rule, rule);
    }
}

#[test]
fn every_method_is_offered_by_name_and_drawn_once_it_is_built() {
    let mut window = window(fitted("pyramid5", 64));
    for method in Method::offered() {
        window.get_by_label("Left method").click();
        window.run();
        window.get_by_label(&method.label()).click();
        window.run();
        assert_eq!(window.state().inspector.session.comparison.left, method);
        let channels = |window: &Window| window.state().inspector.session.channels_of(method).is_some();
        let expected = method.rival().is_some_and(|rival| rival.kind.has_channels);
        step_until(&mut window, "the build", |window| channels(window) == expected);
    }
    let session = &window.state().inspector.session;
    assert!(Method::offered().all(|method| session.channels_of(method).is_none()), "kept though not shown");
}

#[test]
fn a_rule_says_what_it_is_and_gives_its_equation() {
    let mut window = window(fitted("pyramid5", 64));
    for (control, choice, equation) in [
        ("Convolution", "s + 1", "s' + 1 = kappa (s + 1) / (kappa + s + 1)"),
        ("Convolution", "moment", "s' = (2m - 1) / (1 - m)"),
        ("Convolution", "paper (eq. 20)", "s' = kappa s / (kappa + s)"),
        ("Convolution", "exact", "(2l + 1) / (4 pi) rho_l A_l(kappa) P_l(u)"),
        ("Diffuse rule", "cosine (Algorithm 2)", "max(mu.w, 0)"),
        ("Diffuse rule", "exact", "rho_l = 1, 2/3, 1/4, 0, -1/24"),
    ] {
        window.get_by_label(control).click();
        window.run();
        window.get_by_label(choice).hover();
        rest(&mut window);
        assert!(window.query_by_label_contains(equation).is_some(), "{control}, {choice}: no {equation}");
        window.get_by_label(choice).click();
        window.run();
    }
}

#[test]
fn the_lobe_table_shows_colours_where_the_map_has_them() {
    let mut plain = window(fitted("v-groove", 64));
    plain.run();
    assert!(plain.query_by_label("Colour of lobe 1").is_none());
    let mut window = window(|wake| {
        let mut map = procedural::find("v-groove").expect("a bundled map").make(64);
        // Four texels to a groove: the first two face right.
        let color = |index: usize| if index % 4 < 2 { [0.8, 0.1, 0.05] } else { [0.05, 0.2, 0.9] };
        map.albedo = Some(Arc::new(Albedo { rgb: (0..map.len()).map(color).collect() }));
        let mut session = Session::with_map(map, wake);
        session.begin(FitSettings { lobes: 2, ..super::SETTINGS });
        while session.fitting().is_running() {
            session.wait(Duration::from_millis(20));
        }
        session
    });
    window.run();
    window.get_by_label("Colour of lobe 1").hover();
    rest(&mut window);
    let first = window.state().inspector.session.lobes().mixture(window.state().inspector.session.selected());
    let faces_right = first.expect("fitted").lobes[0].1.mean_direction.x > 0.0;
    let text = if faces_right { "0.800, 0.100, 0.050" } else { "0.050, 0.200, 0.900" };
    assert!(window.query_by_label_contains(text).is_some(), "no {text}");
    assert!(window.query_by_label("Colour of lobe 2").is_some());
}

#[test]
fn moving_the_lobe_count_shows_a_preview_in_the_next_frame_and_then_the_fit() {
    let mut window = window(fitted("pyramid5", 64));
    window.get_by_label("Lobes J").set_value_accesskit(2.0);
    window.step();
    window.step();
    let fitting = window.state().inspector.session.fitting();
    assert_eq!(fitting.settings().lobes, 2);
    assert!(fitting.is_complete() || fitting.fold() != Fold::default(), "neither a preview nor the fit");
    step_until(&mut window, "the fit", |window| window.state().inspector.session.fitting().is_complete());
    assert_eq!(window.state().inspector.session.lobes().lobes(), 2);
    assert_eq!(window.state().inspector.session.fitting().fold(), Fold::default());
}

#[test]
fn a_path_that_cannot_be_read_says_so_and_keeps_the_map() {
    let mut window = window(fitted("pyramid5", 64));
    window.get_by_label("Path of an image").focus();
    window.step();
    window.get_by_label("Path of an image").type_text("/nowhere/bark.png");
    window.key_press(egui::Key::Enter);
    step_until(&mut window, "the sentence", |window| window.query_by_label("Dismiss message 1").is_some());
    assert!(window.query_by_label_contains("/nowhere/bark.png").is_some(), "the sentence names no file");
    let source = &window.state().inspector.session.map().source;
    assert_eq!(*source, MapSource::Bundled("pyramid5"));
    window.get_by_label("Dismiss message 1").click();
    window.run();
    assert!(window.query_by_label("Dismiss message 1").is_none());
}

#[test]
fn a_greyscale_image_is_offered_as_heights() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bumps.png");
    image::GrayImage::from_fn(16, 16, |x, y| image::Luma([(16 * x + y) as u8])).save(&path).expect("saved");
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.session.open(MapRequest::File { path: path.clone(), options: MapOptions::default() });
    step_until(&mut window, "the offer", |window| window.query_by_label("Open as heights 1").is_some());
    assert_eq!(window.state().inspector.session.map().source, MapSource::Bundled("pyramid5"));
    window.get_by_label("Open as heights 1").click();
    step_until(&mut window, "the map", |window| {
        window.state().inspector.session.map().source == MapSource::File(path.clone())
    });
    assert!(window.query_by_label("Open as heights 1").is_none());
}

#[test]
fn an_idle_window_asks_for_no_repaint() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    for _ in 0..3 {
        window.step();
        window.render().expect("a picture");
        let delay = window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
        assert_eq!(delay, Duration::MAX, "{:?}", window.ctx.repaint_causes());
    }
}

#[test]
fn a_click_on_a_level_selects_the_texel_under_it() {
    let mut window = window(fitted("pyramid5", 64));
    let level = window.get_by_label("Level 4").rect();
    click(&mut window, level.min + vec2(0.3, 0.8) * level.size(), PointerButton::Primary);
    assert_eq!(window.state().inspector.session.selected(), Texel { level: 4, x: 1, y: 3 });
}

#[test]
fn a_click_on_the_surface_selects_the_texel_shaded_there_and_a_click_beside_it_none() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    window.state_mut().inspector.session.surface.level = ndf_inspector::filter::LevelChoice::Fixed(3.0);
    settle(&mut window);
    let picture = window.get_by_label("Surface view").rect();
    // A little right of and below the middle, clear of the wipe: the first texel of the repeat after the middle one.
    click(&mut window, picture.center() + vec2(20.0, 4.0), PointerButton::Primary);
    assert_eq!(window.state().inspector.session.selected(), Texel { level: 3, x: 0, y: 0 });
    click(&mut window, picture.min + vec2(4.0, 120.0), PointerButton::Primary);
    assert_eq!(window.state().inspector.session.selected(), Texel { level: 3, x: 0, y: 0 });
}

#[test]
fn dragging_orbits_and_dragging_with_the_right_button_moves_the_light() {
    let mut window = window(fitted("pyramid5", 64));
    let before = window.state().inspector.session.surface.clone();
    let at = window.get_by_label("Surface view").rect().center() + vec2(60.0, 40.0);
    drag(&mut window, at, vec2(50.0, 0.0), PointerButton::Primary);
    let orbited = window.state().inspector.session.surface.clone();
    assert!(orbited.camera != before.camera && orbited.lights == before.lights);
    drag(&mut window, at, vec2(50.0, 0.0), PointerButton::Secondary);
    let lit = window.state().inspector.session.surface.clone();
    assert!(lit.camera == orbited.camera && lit.lights != orbited.lights);
}

#[test]
fn lights_are_added_selected_moved_by_their_handle_and_removed() {
    let mut window = window(fitted("pyramid5", 64));
    let lights = |window: &Window| window.state().inspector.session.surface.lights.as_slice().to_vec();
    window.get_by_label("Add light").click();
    window.run();
    window.get_by_label("Kind of light: Point").click();
    window.run();
    let before = lights(&window);
    assert!(before.len() == 2 && before[0].distance.is_none() && before[1].distance.is_some());
    // Light 1 stands at the upper left of the dome, seen by the camera that starts at azimuth 0.
    let dome = window.get_by_label("Light dome").rect().center();
    let (sin, cos) = before[0].azimuth_deg.to_radians().sin_cos();
    let handle = dome + 22.0 * before[0].elevation_deg.to_radians().cos() * vec2(cos, -sin);
    drag(&mut window, handle, vec2(10.0, 8.0), PointerButton::Primary);
    let moved = lights(&window);
    assert!(window.state().inspector.view.light.selected == 0, "the handle that was dragged is selected");
    assert!(moved[0].azimuth_deg != before[0].azimuth_deg && moved[1] == before[1]);
    window.get_by_label("Light 2").click();
    window.run();
    window.get_by_label("Remove light").click();
    window.run();
    assert_eq!(lights(&window), moved[..1]);
}

#[test]
fn a_sweep_turns_the_selected_light_and_asks_for_frames_only_while_it_plays() {
    let mut window = window(fitted("pyramid5", 64));
    settle(&mut window);
    let azimuth = |window: &Window| window.state().inspector.session.surface.lights.as_slice()[0].azimuth_deg;
    let delay = |window: &Window| window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
    let still = azimuth(&window);
    window.get_by_label("Sweep").click();
    window.run_steps(5);
    assert!(azimuth(&window) != still && delay(&window) == Duration::ZERO);
    window.get_by_label("Sweep").click();
    window.run_steps(3);
    let stopped = azimuth(&window);
    settle(&mut window);
    window.step();
    assert!(azimuth(&window).to_bits() == stopped.to_bits() && delay(&window) == Duration::MAX);
}

#[test]
fn a_sky_is_chosen_by_name_and_a_bad_one_leaves_it() {
    let mut window = window(fitted("pyramid5", 64));
    // The sky's controls stand below the others, and a list opens only where it is seen.
    window.set_size(egui::vec2(1280.0, 1400.0));
    window.run();
    let name = |window: &Window| {
        let environment = window.state().inspector.session.surface.sky.environment.clone();
        environment.map(|environment| environment.source.short_name())
    };
    window.get_by_label("Environment").click();
    window.run();
    window.get_by_label("studio").click();
    window.step();
    step_until(&mut window, "the sky", |window| name(window).is_some());
    assert_eq!(name(&window).as_deref(), Some("studio"));
    window.get_by_label("Sky rotation").set_value_accesskit(30.0);
    window.run();
    assert!((window.state().inspector.session.surface.sky.rotation_deg - 30.0).abs() < 1e-3);
    window.state_mut().inspector.session.open_sky(SkySource::Path("/nowhere/sky.exr".into()));
    step_until(&mut window, "the sentence", |window| window.query_by_label_contains("/nowhere/sky.exr").is_some());
    assert_eq!(name(&window).as_deref(), Some("studio"));
}

#[test]
fn the_wipe_follows_its_handle_and_a_double_click_brings_it_back() {
    let mut window = window(fitted("pyramid5", 64));
    let handle = window.get_by_label("Wipe handle").rect().center();
    drag(&mut window, handle, vec2(-120.0, 0.0), PointerButton::Primary);
    assert!(window.state().inspector.session.comparison.wipe < 0.4);
    let handle = window.get_by_label("Wipe handle").rect().center();
    double_click(&mut window, handle);
    assert!((window.state().inspector.session.comparison.wipe - 0.5).abs() < 1e-6);
}

#[test]
fn a_double_click_on_a_slider_resets_it() {
    let mut window = window(fitted("pyramid5", 64));
    window.get_by_label("Specular Ks").set_value_accesskit(1.5);
    window.run();
    assert!((window.state().inspector.session.surface.material.specular - 1.5).abs() < 1e-3);
    let value = window.get_by_label("Specular Ks").rect().center();
    double_click(&mut window, value);
    let specular = window.state().inspector.session.surface.material.specular;
    let default = ndf_inspector::brdf::Material::DEFAULT.specular;
    assert!((specular - default).abs() < 1e-6, "{specular}");
}

#[test]
fn a_double_click_on_the_name_of_a_choice_brings_its_default_back() {
    let mut window = window(fitted("pyramid5", 64));
    let rule = |window: &Window| window.state().inspector.session.surface.material.convolution;
    window.state_mut().inspector.session.surface.material.convolution = ConvolutionRule::Paper;
    window.run();
    let combo = window.get_by_label("Convolution").rect();
    double_click(&mut window, egui::pos2(combo.left() - 60.0, combo.center().y));
    assert_eq!(rule(&window), ConvolutionRule::default());
}

#[test]
fn a_running_fit_can_be_cancelled_and_started_again() {
    let mut window = window(|wake| {
        let mut session = session("plate", 512, wake);
        session.begin(super::SETTINGS);
        session
    });
    window.get_by_label("Cancel fit").click();
    window.step();
    window.step();
    assert!(!window.state().inspector.session.fitting().is_running());
    window.get_by_label("Refit fit").click();
    window.step();
    assert!(window.state().inspector.session.fitting().is_running());
}

#[test]
fn a_dropped_file_is_opened() {
    #[derive(Debug)]
    struct Dropped(std::path::PathBuf);
    impl egui::DroppedFile for Dropped {
        fn path(&self) -> &std::path::Path {
            &self.0
        }
        fn bytes(&self) -> Result<Vec<u8>, String> {
            Err("only the path is to be used".to_owned())
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dropped.png");
    let rgb: Vec<u8> = [128, 128, 255].repeat(16);
    ndf_inspector::image_io::write_png_rgb8(&path, 4, 4, &rgb).expect("written");
    let mut window = window(fitted("pyramid5", 64));
    window.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path)));
    window.step();
    step_until(&mut window, "the map", |window| window.state().inspector.session.map().width == 4);
}

pub(super) fn click(window: &mut Window, at: egui::Pos2, button: PointerButton) {
    press(window, at, button, true);
    press(window, at, button, false);
    window.run();
}

pub(super) fn double_click(window: &mut Window, at: egui::Pos2) {
    for _ in 0..2 {
        press(window, at, PointerButton::Primary, true);
        press(window, at, PointerButton::Primary, false);
    }
    window.run();
}

pub(super) fn drag<T>(window: &mut Harness<'static, T>, from: egui::Pos2, by: egui::Vec2, button: PointerButton) {
    press(window, from, button, true);
    for step in 1..=4 {
        window.event(egui::Event::PointerMoved(from + by * (step as f32 / 4.0)));
        window.step();
    }
    press(window, from + by, button, false);
    window.run();
}

/// Moves there and presses or releases.
pub(super) fn press<T>(window: &mut Harness<'static, T>, pos: egui::Pos2, button: PointerButton, pressed: bool) {
    window.event(egui::Event::PointerMoved(pos));
    window.event(egui::Event::PointerButton { pos, button, pressed, modifiers: egui::Modifiers::NONE });
    window.step();
}
