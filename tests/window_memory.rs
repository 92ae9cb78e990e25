//! Frames that are drawn again and again take no memory for good.
//!
//! A binary of its own because it looks at the memory of the whole process, and one law in it, for tests side by side
//! would count each other's.

use ndf_inspector::filter::vmf::FitSettings;
use ndf_inspector::gpu::Gpu;
use ndf_inspector::headless::{Headless, ScreenshotSettings};
use ndf_inspector::normal_map::procedural;
use ndf_inspector::session::Session;

/// Passes that fill caches and pools.
const FIRST: usize = 20;

/// Passes during which nothing may pile up.
const MORE: usize = 60;

/// Bytes that a pass may add on the mean: a driver that keeps one shader more in each takes a million.
const MOST_PER_PASS: usize = 400 << 10;

fn resident_bytes() -> usize {
    memory_stats::memory_stats().expect("this system tells").physical_mem
}

#[test]
fn a_window_that_is_drawn_again_takes_no_more_memory() {
    let gpu = Gpu::headless().expect("an adapter");
    let settings = ScreenshotSettings { size: [900, 600], ..ScreenshotSettings::default() };
    let mut window = Headless::new(&gpu, settings, |wake| {
        let map = procedural::find("plate").expect("a bundled map").make(64);
        let mut session = Session::with_map(map, wake);
        session.truth_samples = 8;
        session.begin(FitSettings::default());
        session
    });
    window.screenshot().expect("a picture");
    let mut draw = |passes: usize| {
        for _ in 0..passes {
            // The surface moves, so that every pass draws all there is.
            window.inspector.session.surface.camera.azimuth_deg += 1.0;
            window.pass(Vec::new()).expect("the device works");
        }
    };
    draw(FIRST);
    let before = resident_bytes();
    draw(MORE);
    let per_pass = resident_bytes().saturating_sub(before) / MORE;
    println!("{per_pass} bytes a pass");
    assert!(per_pass < MOST_PER_PASS, "{per_pass} bytes a pass");
}
