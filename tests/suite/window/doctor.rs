//! What the import doctor says in the window, and what a click on it does.

use std::time::{Duration, Instant};

use egui_kittest::kittest::Queryable;
use ndf_inspector::image_io::{Samples, write_png_rgb8};
use ndf_inspector::normal_map::{GreenChannel, MapOptions, procedural};
use ndf_inspector::session::MapRequest;

use super::{Window, session, window};

/// Steps until the map at hand is read that way.
fn step_until_read(window: &mut Window, green: GreenChannel) {
    let start = Instant::now();
    while window.state().inspector.session.map().options.green != green || window.state().inspector.session.is_opening()
    {
        assert!(start.elapsed() < Duration::from_secs(30), "waited in vain for {green:?}");
        std::thread::sleep(Duration::from_millis(10));
        window.step();
    }
    window.run_steps(2);
}

#[test]
fn a_click_on_a_doubt_reads_the_map_as_the_doctor_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("waves.png");
    let image = procedural::find("waves").expect("a bundled map").image(64);
    let Samples::U8(samples) = &image.samples else { panic!("8 bits") };
    write_png_rgb8(&path, 64, 64, samples).expect("written");

    let mut window = window(|wake| session("plate", 64, wake));
    let options = MapOptions { green: GreenChannel::Down, ..MapOptions::default() };
    window.state_mut().inspector.session.open(MapRequest::File { path, options });
    step_until_read(&mut window, GreenChannel::Down);
    window.get_by_label("Apply: Green sign").click();
    step_until_read(&mut window, GreenChannel::Up);
    assert!(window.query_by_label("Apply: Green sign").is_none());
    assert!(!window.state().inspector.session.diagnosis().is_doubtful());

    // What is not doubtful is shown on demand, and can be overridden.
    assert!(window.query_by_label("Override: Green sign").is_none());
    window.get_by_label("Import doctor").click();
    window.run_steps(2);
    window.get_by_label("Override: Green sign").click();
    step_until_read(&mut window, GreenChannel::Down);
}
