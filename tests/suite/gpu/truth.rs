//! The sampled truth against its oracle, which knows no samples.

use glam::Vec3;
use ndf_inspector::filter::{Method, Truth};
use ndf_inspector::gpu::{FrameBudget, PICTURE_FORMAT, SurfaceFrame};
use ndf_inspector::normal_map::Addressing;
use ndf_inspector::reference::{self, ExactCoverage, Picture, normalised_color_error, standard_error};

use super::{Scene, gpu, maps, twins};

/// The plane as it is seen from `distance` and `elevation_deg`.
fn plane(distance: f32, elevation_deg: f32) -> Scene {
    let map = maps::with_color(maps::rough(96, 60, Addressing::Wrap), maps::any_color);
    let mut scene = Scene { size: [96, 72], ..Scene::new(map, 1) };
    (scene.surface.camera.distance, scene.surface.camera.elevation_deg) = (distance, elevation_deg);
    scene
}

fn exact(scene: &Scene) -> Picture {
    let map = scene.map().clone();
    let base = (map.width, map.height);
    reference::render(&scene.surface, &ExactCoverage { map }, scene.size, [0.0, 0.0], base)
}

fn sampled(scene: &Scene, samples: u32) -> Picture {
    let map = scene.map().clone();
    let base = (map.width, map.height);
    reference::render(&scene.surface, &Truth { map, samples }, scene.size, [0.0, 0.0], base)
}

fn on_adapter(scene: &Scene, samples: u32) -> Picture {
    on_adapter_by(scene, samples, 64)
}

/// The adapter's truth, `batch` samples a frame.
fn on_adapter_by(scene: &Scene, samples: u32, batch: u32) -> Picture {
    let mut frame = SurfaceFrame::new(&gpu().device, PICTURE_FORMAT);
    frame.budget = FrameBudget { truth_limit: samples, truth_batch: batch, upload_bytes: 1 << 30 };
    frame.complete(gpu(), &scene.input(Method::Truth)).expect("the device works");
    twins::picture(&frame, scene.size, Method::Truth)
}

/// How far a sampled picture is from the oracle's, as a normalised colour error, and what it states itself.
struct Agreement {
    error: f64,
    stated: f64,
    /// The share of the pixels that are within four of their own standard errors.
    within: f64,
}

fn agreement(half: &Picture, whole: &Picture, exact: &Picture) -> Agreement {
    let seen: Vec<usize> = (0..exact.rgb.len()).filter(|&i| exact.covered[i] && whole.covered[i]).collect();
    let is_within = |&&i: &&usize| {
        let own = (whole.rgb[i] - half.rgb[i]).length();
        (whole.rgb[i] - exact.rgb[i]).length() <= 4.0 * own + 1e-6
    };
    Agreement {
        error: normalised_color_error(whole, exact).expect("the plane is seen"),
        stated: standard_error(half, whole).expect("the plane is seen"),
        within: seen.iter().filter(is_within).count() as f64 / seen.len() as f64,
    }
}

/// From near, and from far at a grazing angle, where a pixel's footprint is no parallelogram.
const VIEWS: [(f32, f32); 2] = [(1.2, 50.0), (3.2, 8.0)];

#[test]
fn the_sampled_truth_agrees_with_exact_coverage_within_its_stated_error_which_falls() {
    for (distance, elevation) in VIEWS {
        let scene = plane(distance, elevation);
        let exact = exact(&scene);
        let at = |samples| agreement(&sampled(&scene, samples / 2), &sampled(&scene, samples), &exact);
        let (few, many) = (at(128), at(2048));
        for found in [&few, &many] {
            assert_agrees(found, (distance, elevation));
        }
        assert!(many.error < few.error / 4.0 && many.stated < few.stated / 4.0, "16 times the samples, 4 at least");
    }
}

#[test]
fn the_adapters_truth_agrees_with_exact_coverage_at_4096_samples() {
    for (distance, elevation) in VIEWS {
        let scene = plane(distance, elevation);
        let found = agreement(&on_adapter(&scene, 2048), &on_adapter(&scene, 4096), &exact(&scene));
        assert_agrees(&found, (distance, elevation));
        assert!(found.error < 0.003, "{}", found.error);
    }
}

/// Half again the stated error: its own scatter over a picture of some hundred pixels. By chance alone, 84 % of all
/// pixels would be within four standard errors that one pair of halves gives (Student's t of one degree of freedom).
fn assert_agrees(found: &Agreement, view: (f32, f32)) {
    let Agreement { error, stated, within } = *found;
    println!("{view:?}: off by {error:.6}, stated {stated:.6}, {within:.3} of the pixels within four of their own");
    assert!(error <= 1.5 * stated && error > 0.1 * stated, "{view:?}: off by {error}, stated {stated}");
    assert!(within > 0.84, "{view:?}: {within} of the pixels");
}

/// What 65536 samples of one colour leave of it, drawn 16 at a time: a plain f32 sum loses 1e-4 of it.
#[test]
fn the_mean_of_65536_equal_samples_is_the_sample() {
    let map = maps::map(16, 16, Addressing::Wrap, |_, _| Vec3::new(0.1, 0.2, 1.0));
    let scene = Scene { size: [24, 18], ..Scene::new(map, 1) };
    let picture = |samples, batch| on_adapter_by(&scene, samples, batch);
    let (one, many) = (picture(1, 1), picture(65536, 16));
    for (one, many) in one.rgb.iter().zip(&many.rgb) {
        println!("{one} {many} {}", (one - many).length() / one.length());
        assert!((one - many).length() <= 1e-6 * one.length(), "{many} of samples {one}");
    }
}
