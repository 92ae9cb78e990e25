//! What the window looks like. Few and small; `UPDATE_SNAPSHOTS=1` rewrites those that differ, to be looked at.

use egui_kittest::kittest::Queryable;
use egui_kittest::{SnapshotOptions, image_snapshot_options};
use image::RgbaImage;
use ndf_inspector::app::dock::Preset;
use ndf_inspector::app::level_places::MapLevels;
use ndf_inspector::app::map_shading::MapShading;
use ndf_inspector::app::theme::Theme;
use ndf_inspector::app::view_state::{Layout, MapView, Overlay};
use ndf_inspector::comparison::{Comparison, Difference, DifferenceKind, View};
use ndf_inspector::filter::Method;
use ndf_inspector::gpu::Gpu;
use ndf_inspector::headless::{Headless, ScreenshotSettings};
use ndf_inspector::reference::Region;
use ndf_inspector::scene::{ShapeKind, SphereOrbit};

use super::{Window, fitted, session, settle, unheard, window};

/// Software Vulkan of another version may round a shade differently (1 of 255 is far below `threshold`, which is in
/// perceptual steps) and move an antialiased edge by a pixel here and there.
pub fn compare(picture: &RgbaImage, name: &str) {
    assert_not_flat(picture, name);
    let options = SnapshotOptions::default().threshold(0.8).max_failed_pixels(40).output_path("tests/snapshots");
    image_snapshot_options(picture, name, &options);
}

/// A picture of nothing compares well with a picture of nothing.
fn assert_not_flat(picture: &RgbaImage, name: &str) {
    let mut luma: Vec<u32> = picture.pixels().map(|p| p.0[..3].iter().map(|&c| u32::from(c)).sum()).collect();
    luma.sort_unstable();
    let (dark, bright) = (luma[luma.len() / 50], luma[luma.len() - 1 - luma.len() / 50]);
    assert!(bright > dark + 60, "{name} is flat: {dark} to {bright}");
}

/// The part of the window that carries this name.
fn part(window: &mut Window, label: &str) -> RgbaImage {
    settle(window);
    let rect = window.get_by_label(label).rect();
    let whole = window.render().expect("a picture");
    let [x, y, w, h] = [rect.left(), rect.top(), rect.width(), rect.height()].map(|v| v.round() as u32);
    image::imageops::crop_imm(&whole, x, y, w, h).to_image()
}

#[test]
fn the_surface_by_each_method_and_at_a_wipe() {
    let mut window = window(fitted("plate", 128));
    window.state_mut().inspector.session.surface.camera.distance = 6.0;
    for (method, shape) in
        [(Method::Truth, ShapeKind::Plane), (Method::MIP, ShapeKind::Sphere), (Method::Vmf, ShapeKind::Torus)]
    {
        let session = &mut window.state_mut().inspector.session;
        session.comparison = Comparison::alone(method);
        session.surface.shape.kind = shape;
        let picture = part(&mut window, "Surface view");
        compare(&picture, &format!("surface_{method}"));
    }
    let session = &mut window.state_mut().inspector.session;
    session.comparison = Comparison { wipe: 0.4, ..Comparison::default() };
    session.surface.shape.kind = ShapeKind::Plane;
    compare(&part(&mut window, "Surface view"), "surface_wipe");
}

#[test]
fn the_surface_in_a_grid_and_as_a_signed_difference() {
    let mut window = window(fitted("plate", 64));
    let difference = Difference { kind: DifferenceKind::Signed, range: 0.5 };
    for view in [View::Grid2x2, View::Difference] {
        let session = &mut window.state_mut().inspector.session;
        session.comparison = Comparison { view, difference, left: Method::MIP, ..Comparison::default() };
        compare(&part(&mut window, "Surface view"), &format!("surface_{view}"));
    }
}

#[test]
fn the_sphere_from_above_and_from_the_side() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.session.select("6,0,0".parse().expect("a texel"));
    window.state_mut().inspector.view.sphere_orbit = SphereOrbit::TOP;
    compare(&part(&mut window, "Sphere view"), "sphere_top");
    window.state_mut().inspector.view.sphere_orbit = SphereOrbit::SIDE;
    window.state_mut().inspector.view.sphere_layers.logarithmic = false;
    compare(&part(&mut window, "Sphere view"), "sphere_side");
}

#[test]
fn the_map_zoomed_by_normals_and_by_lobes() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.view.layout = Layout::Map;
    window.state_mut().inspector.session.select("1,11,13".parse().expect("a texel"));
    window.state_mut().inspector.view.map = MapView { center: [0.3, 0.4], zoom: 1.6, ..MapView::default() };
    compare(&part(&mut window, "Map view"), "map_normals");
    window.state_mut().inspector.view.map = MapView { shading: MapShading::Lobes, ..MapView::default() };
    compare(&part(&mut window, "Map view"), "map_lobes");
}

#[test]
fn the_texel_in_numbers_with_the_trace_of_its_fit() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.session.select("4,1,2".parse().expect("a texel"));
    window.state_mut().inspector.view.show_trace = true;
    settle(&mut window);
    let whole = window.render().expect("a picture");
    let sphere = window.get_by_label("Sphere view").rect();
    let (left, top) = (sphere.left() as u32, sphere.bottom() as u32);
    let picture = image::imageops::crop_imm(&whole, left, top, 1280 - left, 768 - top).to_image();
    compare(&picture, "texel_numbers");
}

#[test]
fn the_map_by_error_with_its_numbers() {
    let mut window = window(fitted("scales", 64));
    window.state_mut().inspector.view.layout = Layout::Map;
    window.state_mut().inspector.session.select("3,2,5".parse().expect("a texel"));
    window.state_mut().inspector.view.map.shading = MapShading::Error;
    compare(&part(&mut window, "Map view"), "map_errors");
}

#[test]
fn the_texels_effective_brdf_by_truth_and_method() {
    let mut window = window(fitted("pyramid5", 64));
    window.state_mut().inspector.session.select("4,1,2".parse().expect("a texel"));
    window.state_mut().inspector.view.show_brdf = true;
    // The section lies below what a window of this height shows.
    window.set_size(egui::vec2(1280.0, 1280.0));
    settle(&mut window);
    let whole = window.render().expect("a picture");
    let switch = window.get_by_label("Effective BRDF").rect();
    let (left, top) = (switch.left() as u32, switch.top() as u32);
    let picture = image::imageops::crop_imm(&whole, left, top, 1280 - left, 480).to_image();
    compare(&picture, "texel_brdf");
}

#[test]
fn the_whole_window_by_preset_and_theme() {
    let mut window = window(fitted("plate", 64));
    window.state_mut().inspector.session.surface.shape.kind = ShapeKind::Torus;
    for (preset, theme, name) in [
        (Preset::Inspect, Theme::Dark, "window_inspect"),
        (Preset::Tune, Theme::Light, "window_tune_light"),
        (Preset::Compare, Theme::HighContrast, "window_compare_high-contrast"),
    ] {
        let inspector = &mut window.state_mut().inspector;
        inspector.view.choose(preset);
        inspector.change_settings(|settings| settings.theme = theme);
        // What is drawn follows the layout, and the figures what is drawn.
        for _ in 0..2 {
            window.run_steps(3);
            settle(&mut window);
        }
        compare(&window.render().expect("a picture"), name);
    }
}

#[test]
fn what_lies_over_the_window() {
    let mut window = window(fitted("plate", 64));
    // A cursor that blinks shows when a picture was taken.
    window.ctx.all_styles_mut(|style| style.visuals.text_cursor.blink = false);
    window.state_mut().inspector.view.palette.text = "method: t".to_owned();
    for (overlay, name) in
        [(Overlay::Palette, "over_palette"), (Overlay::Keys, "over_keys"), (Overlay::Export, "over_export")]
    {
        window.state_mut().inspector.view.overlay = overlay;
        window.run_steps(4);
        settle(&mut window);
        compare(&window.render().expect("a picture"), name);
    }
}

#[test]
fn every_level_at_once_with_the_histogram_of_a_region() {
    let mut window = window(fitted("bricks", 64));
    let inspector = &mut window.state_mut().inspector;
    inspector.view.choose(Preset::MapOnly);
    inspector.session.select("2,9,6".parse().expect("a texel"));
    inspector.view.map = MapView { levels: MapLevels::EqualSize, shading: MapShading::Length, ..inspector.view.map };
    inspector.view.map_region.chosen = Some(Region { min: [0.2, 0.1], max: [0.7, 0.6] });
    window.run_steps(4);
    settle(&mut window);
    compare(&window.render().expect("a picture"), "window_map_levels");
}

#[test]
fn a_fit_that_is_under_way() {
    // Its progress differs from run to run; what is covered is the rest of the window.
    let mut window = window(|_| {
        let mut session = session("waves", 512, unheard());
        session.begin(super::SETTINGS);
        session
    });
    window.step();
    assert!(window.query_by_label("Cancel fit").is_some());
    let status = window.query_by_label_contains("levels done").expect("the status bar says how far the fit is").rect();
    let bar = window.get_by_label("Cancel fit").rect();
    let levels = window.get_by_label("Level 0").rect();
    let surface = window.get_by_label("Surface view").rect();
    let kept = window.query_by_label_contains("kept ·").expect("the memory of kept fits is said").rect();
    window.mask(kept);
    // Its text grows with the percentage.
    window.mask(status.with_max_x(1280.0));
    window.mask(bar.with_min_x(0.0));
    window.mask(egui::Rect::from_min_max(levels.left_bottom(), surface.right_bottom() + egui::vec2(0.0, 136.0)));
    window.mask(surface);
    window.mask(egui::Rect::from_min_max(egui::pos2(surface.right(), 0.0), egui::pos2(1280.0, 800.0)));
    let whole = window.render().expect("a picture");
    let left = image::imageops::crop_imm(&whole, 0, 0, 300, 800).to_image();
    compare(&left, "fit_under_way");
}

#[test]
fn the_window_without_a_window_is_the_same_twice() {
    let gpu = Gpu::headless().expect("an adapter");
    let take = || {
        let mut headless = Headless::new(&gpu, ScreenshotSettings::default(), fitted("pyramid5", 128));
        headless.screenshot().expect("a picture")
    };
    let (first, second) = (take(), take());
    assert!(first == second, "two pictures of one session differ");
    let picture = RgbaImage::from_raw(first.size[0], first.size[1], first.rgba).expect("as large as it says");
    assert_not_flat(&picture, "the window");
}
