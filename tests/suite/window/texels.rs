//! What the window says of texels: the selected one's error, the map's colours, the worst of them, and how one moves
//! from one to the next.

use std::sync::Arc;

use egui::Key;
use egui_kittest::kittest::Queryable;
use ndf_inspector::app::built_filters::BuiltFilters;
use ndf_inspector::app::error_report::ErrorReport;
use ndf_inspector::app::map_picture::thumbnail;
use ndf_inspector::app::map_shading::MapShading;
use ndf_inspector::app::texel_values::{INVALID, MISSING, TexelValue, TexelValues};
use ndf_inspector::app::view_state::Layout;
use ndf_inspector::brdf::{BlinnPhong, Brdf};
use ndf_inspector::filter::brdf_error::{level_errors, texel_error};
use ndf_inspector::filter::vmf::{Fold, Monitor, Rules};
use ndf_inspector::filter::{Method, VmfFilter};
use ndf_inspector::normal_map::pyramid::Texel;
use ndf_inspector::session::Session;

use super::live_figures::shift_drag;
use super::{Window, fitted, session, settle, unheard, window};

fn blinn_phong(shininess: f64) -> Brdf {
    Brdf::BlinnPhong(BlinnPhong { shininess })
}

fn lobes_of(session: &Session) -> VmfFilter {
    VmfFilter { lobes: Arc::clone(session.lobes()), fold: Fold::default(), rules: Rules::default() }
}

fn texel(text: &str) -> Texel {
    text.parse().expect("a texel")
}

/// Waits until the errors of a method are there.
fn work_out(report: &mut ErrorReport, session: &Session, method: Method) {
    report.update(session, method, true, &unheard());
    while report.is_running() {
        std::thread::sleep(std::time::Duration::from_millis(5));
        report.update(session, method, true, &unheard());
    }
}

#[test]
fn the_texels_error_is_that_of_its_lobes_and_follows_the_material() {
    let mut window = window(fitted("pyramid5", 64));
    for shininess in [64.0, 16.0] {
        window.state_mut().inspector.session.surface.material.shininess = shininess;
        settle(&mut window);
        let session = &window.state().inspector.session;
        let brdf = blinn_phong(f64::from(shininess));
        let error = texel_error(session.map(), &lobes_of(session), session.selected(), brdf);
        assert!(window.query_by_label(&format!("Effective BRDF error at s = {shininess}")).is_some());
        let text = format!("{:.2} %", 100.0 * error.expect("above the horizon"));
        assert!(window.query_by_label(&text).is_some(), "no {text} at s = {shininess}");
    }
}

#[test]
fn the_maps_colour_of_a_texel_is_that_of_its_error() {
    let session = fitted("scales", 32)(unheard());
    let mut report = ErrorReport::new(BuiltFilters::default());
    work_out(&mut report, &session, Method::Vmf);
    let values = TexelValues::new(&session, &report, MapShading::Error);
    let scale = MapShading::Error.scale(&session).expect("a scale");
    for level in 0..session.map().level_sizes().len() {
        let (width, height) = session.map().level_size(level);
        let picture = thumbnail(&values, level, 64);
        assert_eq!(picture.size, [width, height]);
        for (index, pixel) in picture.pixels.iter().enumerate() {
            let texel = Texel { level, x: index % width, y: index / width };
            let error = texel_error(session.map(), &lobes_of(&session), texel, blinn_phong(64.0));
            let [r, g, b] = error.map_or(INVALID, |error| scale.color(100.0 * f64::from(error as f32)));
            assert_eq!(*pixel, egui::Color32::from_rgb(r, g, b), "{texel}: {error:?}");
        }
    }
}

#[test]
fn errors_of_something_else_are_not_shown() {
    let mut session = fitted("scales", 32)(unheard());
    let mut report = ErrorReport::new(BuiltFilters::default());
    work_out(&mut report, &session, Method::Vmf);
    let at = texel("3,1,2");
    let of_lobes = report.error(&session, at).expect("worked out");
    report.update(&session, Method::MIP, true, &unheard());
    assert!(report.error(&session, at).is_none() && report.worst().is_empty());
    work_out(&mut report, &session, Method::MIP);
    let of_mip = report.error(&session, at).expect("worked out");
    assert!(of_mip > of_lobes, "{of_mip} {of_lobes}");
    session.surface.material.shininess = 8.0;
    work_out(&mut report, &session, Method::MIP);
    assert!(report.error(&session, at).expect("worked out") < of_mip, "a blurred map is less wrong");
    session.surface.material.shininess = 64.0;
    report.update(&session, Method::MIP, true, &unheard());
    report.update(&session, Method::MIP, false, &unheard());
    assert!(!report.is_running(), "nobody looks");
}

#[test]
fn what_is_not_fitted_or_not_valid_is_on_no_scale() {
    let mut unfitted = session("scales", 32, unheard());
    let report = ErrorReport::new(BuiltFilters::default());
    for shading in [MapShading::Lobes, MapShading::Count, MapShading::Kappa, MapShading::Coherence, MapShading::Error] {
        let values = TexelValues::new(&unfitted, &report, shading);
        assert_eq!(values.value(texel("3,0,0")), TexelValue::Missing, "{shading:?}");
        let [r, g, b] = MISSING;
        assert_eq!(values.color(texel("3,0,0")), egui::Color32::from_rgb(r, g, b));
    }
    let mut map = (**unfitted.map()).clone();
    for component in [&mut map.x, &mut map.y, &mut map.z] {
        component[5] = 0.0;
    }
    unfitted = Session::with_map(map, unheard());
    for shading in [MapShading::Normal, MapShading::Slope, MapShading::Length] {
        let values = TexelValues::new(&unfitted, &report, shading);
        assert_eq!(values.value(texel("0,5,0")), TexelValue::Invalid, "{shading:?}");
        assert_ne!(values.value(texel("0,4,0")), TexelValue::Invalid, "{shading:?}");
    }
    let values = TexelValues::new(&unfitted, &report, MapShading::Alpha);
    assert_eq!(values.value(texel("0,4,0")), TexelValue::Missing, "the map has no alpha");
}

#[test]
fn a_channel_is_the_mean_of_what_the_file_stores() {
    let session = session("bricks", 40, unheard());
    let report = ErrorReport::new(BuiltFilters::default());
    let values = TexelValues::new(&session, &report, MapShading::Green);
    let stored = |x: usize, y: usize| session.map().stored.sample(x, y, 1);
    assert_eq!(values.value(texel("0,7,3")), TexelValue::Number(stored(7, 3)));
    let mean = (stored(6, 2) + stored(7, 2) + stored(6, 3) + stored(7, 3)) / 4.0;
    assert_eq!(values.value(texel("1,3,1")), TexelValue::Number(mean));
}

/// A window whose map shows the errors of its lobes.
fn errors_on_the_map() -> Window {
    let mut window = window(fitted("scales", 64));
    window.state_mut().inspector.view.layout = Layout::Map;
    window.state_mut().inspector.view.map.shading = MapShading::Error;
    settle(&mut window);
    window
}

#[test]
fn a_click_on_the_worst_texel_goes_to_the_highest_error_of_all_levels() {
    let mut window = errors_on_the_map();
    window.get_by_label("Worst texel 1").click();
    window.run();
    let inspector = &window.state().inspector;
    let (session, monitor) = (&inspector.session, Monitor::new(vec![0; 7]));
    let of_level = |level| level_errors(session.map(), &lobes_of(session), level, blinn_phong(64.0), &monitor);
    let levels: Vec<Vec<f32>> = (0..7).map(|level| of_level(level).expect("nobody cancels")).collect();
    let highest = levels.iter().flatten().copied().fold(0.0, f32::max);
    let Texel { level, x, y } = session.selected();
    let width = session.map().level_size(level).0;
    assert_eq!(levels[level][y * width + x], highest);
    let middle = |index: usize| (index as f32 + 0.5) / width as f32;
    assert_eq!(inspector.view.map.center, [middle(x), middle(y)]);
}

#[test]
fn pointing_at_a_texel_says_its_error_and_the_strip_offers_the_worst() {
    let mut window = errors_on_the_map();
    window.state_mut().inspector.view.layout = Layout::Surface;
    settle(&mut window);
    let level = window.get_by_label("Level 4").rect();
    window.event(egui::Event::PointerMoved(level.min + egui::vec2(0.3, 0.8) * level.size()));
    window.run();
    let session = &window.state().inspector.session;
    let error = texel_error(session.map(), &lobes_of(session), texel("4,1,3"), blinn_phong(64.0)).expect("an error");
    let scale = MapShading::Error.scale(session).expect("a scale");
    let text = format!("BRDF error {}", scale.written(100.0 * f64::from(error as f32)));
    assert!(window.query_by_label_contains(&text).is_some(), "no {text}");
    let before = window.state().inspector.session.selected();
    window.get_by_label("Worst texels").click();
    window.run();
    window.get_by_label("Worst texel 2").click();
    window.run();
    assert_ne!(window.state().inspector.session.selected(), before);
}

#[test]
fn arrow_keys_move_the_selection_and_page_keys_the_level_unless_something_is_typed() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.session.select(texel("3,2,5"));
    let mut pressed = |key: Key| {
        window.key_press(key);
        window.run();
        window.state().inspector.session.selected().to_string()
    };
    assert_eq!(pressed(Key::ArrowRight), "3,3,5");
    assert_eq!(pressed(Key::ArrowUp), "3,3,4");
    assert_eq!(pressed(Key::PageUp), "4,1,2");
    assert_eq!(pressed(Key::PageDown), "3,3,5");
    assert_eq!(pressed(Key::ArrowDown), "3,3,6");
    assert_eq!(pressed(Key::ArrowLeft), "3,2,6");
    window.get_by_label("Path of an image").focus();
    window.run();
    window.key_press(Key::ArrowLeft);
    window.run();
    assert_eq!(window.state().inspector.session.selected().to_string(), "3,2,6");
}

#[test]
fn the_texels_brdf_is_told_for_the_truth_the_judged_and_the_compared_methods() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.view.show_brdf = true;
    settle(&mut window);
    assert!(window.query_by_label("Hemisphere of Truth").is_some());
    assert!(window.query_by_label("Hemisphere of vmf lobes").is_some());
    window.get_by_label("Effective BRDF of").click();
    window.run();
    window.get_by_label("Toksvig").click();
    settle(&mut window);
    assert!(window.query_by_label("Hemisphere of Toksvig").is_some());
    let session = &window.state().inspector.session;
    let error = texel_error(session.map(), &lobes_of(session), session.selected(), blinn_phong(64.0));
    let text = format!("{:.2} %", 100.0 * error.expect("above the horizon"));
    // Below the lobes and in the section's row of vmf, which stays beside the judged method.
    assert_eq!(window.query_all_by_label(&text).count(), 2, "{text}");
}

#[test]
fn the_histogram_counts_the_region_that_is_drawn_on_the_map() {
    let mut window = window(fitted("bricks", 64));
    window.state_mut().inspector.session.select(texel("1,3,3"));
    let view = &mut window.state_mut().inspector.view;
    (view.layout, view.map.shading) = (Layout::Map, MapShading::Length);
    window.run_steps(4);
    assert!(window.query_by_label("Length of level 1").is_some());
    // The square map fills the view, less a margin, in its middle.
    let rect = window.get_by_label("Map view").rect();
    let map = egui::Rect::from_center_size(rect.center(), egui::Vec2::splat(rect.size().min_elem() - 24.0));
    let at = |x: f32, y: f32| map.min + egui::vec2(x, y) * map.size();
    let shown = window.state().inspector.view.map;
    shift_drag(&mut window, at(0.8, 0.5), at(0.3, 0.1));
    assert_eq!(window.state().inspector.view.map, shown, "drawing a region moves the map");
    let region = window.state().inspector.view.map_region.chosen.expect("a region is drawn");
    let off = [region.min[0] - 0.3, region.min[1] - 0.1, region.max[0] - 0.8, region.max[1] - 0.5];
    assert!(off.iter().all(|off| off.abs() < 0.01), "{region:?}");
    assert!(window.query_by_label("Length of a region of level 1").is_some());

    let level = &window.state().inspector.session.mip().levels[1];
    let touched = |index: &usize| {
        let touches = |at: usize, axis: usize| {
            let (low, high) = (at as f32 / 32.0, (at + 1) as f32 / 32.0);
            high > region.min[axis] && low < region.max[axis]
        };
        touches(index % 32, 0) && touches(index / 32, 1)
    };
    let lowest = (0..level.len()).filter(touched).map(|index| level[index].length()).fold(f32::MAX, f32::min);
    assert!(window.query_by_label_contains(&format!("lowest {lowest:.3}")).is_some(), "no {lowest:.3}");
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert!(window.query_by_label("Length of level 1").is_some(), "Esc brings the level back");
}
