//! Exports from the window: every kind, by keys and names, to files that are there.

use std::time::{Duration, Instant};

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::{Window, fitted, settle, window};

/// Exports one kind to a path; waits until it is written.
fn export(window: &mut Window, kind: &str, path: &std::path::Path) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::E);
    window.run_steps(3);
    window.get_by_label(&format!("Export: {kind}")).click();
    // What is chosen has a path suggested first.
    window.run_steps(2);
    window.state_mut().inspector.view.export.typed_path = path.display().to_string();
    window.run_steps(3);
    window.get_by_label("Write the export").click();
    window.run_steps(2);
    let start = Instant::now();
    while !window.state().inspector.is_settled() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain for {kind}");
        std::thread::sleep(Duration::from_millis(10));
        window.step();
    }
}

#[test]
fn every_kind_of_export_is_written_from_the_window() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = window(fitted("pyramid5", 32));
    settle(&mut window);
    let kinds = [
        ("Roughness", "r.png", "r.level.05.png"),
        ("Slopes", "s.exr", "s.exr"),
        ("Lobes", "l.exr", "l.exr"),
        ("Shader", "s.wgsl", "s.wgsl"),
        ("Picture", "p.png", "p.png"),
    ];
    for (kind, name, written) in kinds {
        export(&mut window, kind, &folder.path().join(name));
        assert!(folder.path().join(written).exists(), "{kind}");
    }
    let picture = image::open(folder.path().join("p.png")).expect("a picture");
    assert_eq!((picture.width(), picture.height()), (1600, 1000));
}
