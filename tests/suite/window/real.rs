//! The real window on a screen of its own: driven by keys and pointer, closed, killed and opened again.

use std::io::{BufRead, BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use egui::Pos2;
use egui_kittest::kittest::Queryable;
use ndf_inspector::normal_map::{MapOptions, NormalMap};
use ndf_inspector::session::Session;
use ndf_inspector::session::file::SessionFile;

use super::{settle, window};

/// Software drawing on shared cores takes its time.
const PATIENCE: Duration = Duration::from_secs(60);

/// A process that ends with the test.
struct Owned(Child);

impl Drop for Owned {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A screen without a monitor.
struct Screen {
    _server: Owned,
    display: String,
    folder: tempfile::TempDir,
}

impl Screen {
    /// A screen as large as the window; `None`, with the reason, where the machine has no means to make one.
    fn start() -> Option<Self> {
        if let Err(error) = Command::new("xdotool").arg("version").output() {
            return skip("xdotool", &error);
        }
        let mut server = Command::new("Xvfb");
        server.args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"]);
        let mut server = match server.stdout(Stdio::piped()).stderr(Stdio::null()).spawn() {
            Ok(server) => Owned(server),
            Err(error) => return skip("Xvfb", &error),
        };
        let mut number = String::new();
        BufReader::new(server.0.stdout.take().expect("piped")).read_line(&mut number).expect("a display");
        let folder = tempfile::tempdir().expect("a folder");
        // The tour is for those who see the window for the first time.
        let config = folder.path().join("config/ndf-inspector");
        std::fs::create_dir_all(&config).expect("a folder");
        std::fs::write(config.join("settings.json"), r#"{"knows_tour": true}"#).expect("written");
        Some(Self { _server: server, display: format!(":{}", number.trim()), folder })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.folder.path()).env("DISPLAY", &self.display).env_remove("WAYLAND_DISPLAY");
        command.env("XDG_CONFIG_HOME", self.path("config")).stderr(Stdio::null());
        command
    }

    /// Opens the window and waits until it takes keys.
    fn open(&self, arguments: &[&str]) -> Owned {
        let program = self.command(env!("CARGO_BIN_EXE_ndf-inspector")).args(arguments).spawn().expect("it starts");
        self.xdotool("search --sync --onlyvisible --name NDF windowfocus");
        Owned(program)
    }

    fn xdotool(&self, arguments: &str) {
        // A window that never comes would be waited for without end.
        let mut command = self.command("timeout");
        let done = command.args(["90", "xdotool"]).args(arguments.split(' ')).stdout(Stdio::null()).status();
        assert!(done.expect("xdotool runs").success(), "xdotool {arguments}");
    }

    /// Presses keys in the window that is there now: one that was killed a moment ago may have had the focus.
    fn keys(&self, keys: &str) {
        self.xdotool("search --sync --onlyvisible --name NDF windowfocus");
        self.xdotool(&format!("sleep 0.3 key {keys}"));
    }

    fn click(&self, at: Pos2) {
        self.xdotool(&format!("mousemove {} {} click 1", at.x, at.y));
    }

    fn drag(&self, from: Pos2, dx: f32) {
        let (x, middle, end, y) = (from.x, from.x + 0.5 * dx, from.x + dx, from.y);
        // Software adapters draw a frame in half a second on a busy machine, and a drag is what several frames see.
        let moves = format!("mousemove {middle} {y} sleep 1 mousemove {end} {y} sleep 1");
        self.xdotool(&format!("mousemove {x} {y} sleep 1 mousedown 1 sleep 1 {moves} mouseup 1"));
    }

    /// What the window keeps for its next start.
    fn kept(&self) -> PathBuf {
        self.path("config/ndf-inspector/last.ndfi.json")
    }

    /// Opens the window and waits until it shows its session, which it then keeps anew.
    fn open_and_wait(&self, arguments: &[&str]) -> Owned {
        let written = || std::fs::metadata(self.kept()).and_then(|metadata| metadata.modified()).ok();
        let (before, start) = (written(), Instant::now());
        let program = self.open(arguments);
        while written() == before {
            assert!(start.elapsed() < PATIENCE, "the session does not come up");
            std::thread::sleep(Duration::from_millis(100));
        }
        program
    }

    /// Waits until what the window keeps is as `is` says.
    fn wait_for(&self, what: &str, is: impl Fn(&SessionFile) -> bool) {
        let kept = self.kept();
        let start = Instant::now();
        while !SessionFile::read(&kept).is_ok_and(|file| is(&file)) {
            let state = std::fs::read_to_string(&kept).unwrap_or_default();
            assert!(start.elapsed() < PATIENCE, "waited in vain for {what}: {state}");
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    fn quit(&self, mut program: Owned) {
        self.keys("ctrl+q");
        let start = Instant::now();
        let status = loop {
            if let Some(status) = program.0.try_wait().expect("it is ours") {
                break status;
            }
            assert!(start.elapsed() < PATIENCE, "the window does not close");
            std::thread::sleep(Duration::from_millis(50));
        };
        assert!(status.success(), "{status}");
    }
}

fn skip<T>(program: &str, error: &std::io::Error) -> Option<T> {
    assert_eq!(error.kind(), ErrorKind::NotFound, "{program}: {error}");
    eprintln!("skipped: there is no {program} here (tests/setup.sh installs it)");
    None
}

/// The middles of controls in a window on the same session: the real one has them at the same places.
fn places<const N: usize>(session: &Path, names: [&str; N]) -> [Pos2; N] {
    let file = SessionFile::read(session).expect("a session");
    let mut window = window(|wake| {
        let map = NormalMap::read(&session.with_file_name("plate.png"), &MapOptions::default()).expect("a map");
        let mut session = Session::with_map(map, wake);
        session.apply(&file);
        session.refit();
        session
    });
    while window.state().inspector.session.fitting().is_running() {
        window.step();
        std::thread::sleep(Duration::from_millis(10));
    }
    settle(&mut window);
    names.map(|name| window.get_by_label(name).rect().center())
}

/// What of a session must be the same again.
fn state(file: &SessionFile) -> String {
    let SessionFile { fit, surface, comparison, selected, view, .. } = file;
    format!("{fit:?} {surface:?} {comparison:?} {selected:?} {view:?}")
}

#[test]
fn the_real_window_is_driven_closed_killed_and_shows_the_same_again() {
    let Some(screen) = Screen::start() else { return };
    let sample = screen.command(env!("CARGO_BIN_EXE_ndf-inspector")).args(SAMPLE).status();
    assert!(sample.expect("it starts").success());
    let start = screen.path("start.ndfi.json");
    std::fs::write(&start, r#"{"map": {"path": "plate.png"}, "truth_samples": 16}"#).expect("written");
    let [lobes, wipe, level] = places(&start, ["Lobes J value", "Wipe handle", "Level 1"]);

    let program = screen.open_and_wait(&["start.ndfi.json"]);
    screen.wait_for("the session", |file| file.truth_samples == Some(16));
    screen.click(lobes);
    screen.xdotool("sleep 1.5 type --delay 100 3");
    screen.xdotool("key Return");
    screen.wait_for("three lobes", |file| file.fit.lobes == 3);
    screen.drag(wipe, -120.0);
    screen.wait_for("the wipe", |file| file.comparison.wipe < 0.4);
    screen.click(level);
    screen.wait_for("level 1", |file| file.selected.is_some_and(|texel| texel.level == 1));
    screen.keys("ctrl+z");
    screen.wait_for("undo", |file| file.selected.is_some_and(|texel| texel.level != 1));
    screen.keys("ctrl+y");
    screen.wait_for("redo", |file| file.selected.is_some_and(|texel| texel.level == 1));
    screen.keys("shift+F4");
    screen.wait_for("the preset", |file| is_preset(file, "tune"));
    screen.keys("shift+F2");
    screen.wait_for("the preset before", |file| is_preset(file, "inspect"));
    screen.keys("ctrl+e sleep 1.5");
    screen.xdotool("type --delay 100 roughness.exr");
    screen.xdotool("key Return");
    wait_for_file(&screen.path("roughness.exr"));
    screen.keys("ctrl+shift+s sleep 1.5 key ctrl+a sleep 0.5");
    screen.xdotool("type --delay 100 saved.ndfi.json");
    screen.xdotool("key Return");
    let saved = screen.path("saved.ndfi.json");
    wait_for_file(&saved);
    screen.quit(program);
    let saved_path = saved;
    let saved = SessionFile::read(&saved_path).expect("a session");
    assert!(saved.fit.lobes == 3 && saved.comparison.wipe < 0.4);

    let killed = screen.open_and_wait(&["saved.ndfi.json"]);
    screen.wait_for("the same state", |file| state(file) == state(&saved));
    screen.keys("e");
    screen.wait_for("a brighter picture", |file| file.surface.exposure_stops == 0.5);
    drop(killed);
    let again = screen.open_and_wait(&[]);
    let is_same = |file: &SessionFile| file.surface.exposure_stops == 0.5 && file.fit == saved.fit;
    screen.wait_for("what it was killed in", is_same);
    screen.keys("shift+e");
    screen.wait_for("the state that was saved", |file| state(file) == state(&saved));
    // It still belongs to the file that it was opened from, and is saved there without a question.
    screen.keys("e");
    screen.wait_for("a brighter picture", |file| file.surface.exposure_stops == 0.5);
    screen.keys("ctrl+s");
    let began = Instant::now();
    while !SessionFile::read(&saved_path).is_ok_and(|file| file.surface.exposure_stops == 0.5) {
        assert!(began.elapsed() < PATIENCE, "the session is not saved where it came from");
        std::thread::sleep(Duration::from_millis(50));
    }
    screen.quit(again);
}

fn is_preset(file: &SessionFile, name: &str) -> bool {
    file.view.as_ref().is_some_and(|view| view["dock"]["preset"] == name)
}

fn wait_for_file(path: &Path) {
    let began = Instant::now();
    while !path.exists() {
        assert!(began.elapsed() < PATIENCE, "{} does not come", path.display());
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_window_whose_device_is_lost_opens_again_on_the_same_document() {
    let Some(screen) = Screen::start() else { return };
    let sample = screen.command(env!("CARGO_BIN_EXE_ndf-inspector")).args(SAMPLE).status();
    assert!(sample.expect("it starts").success());
    std::fs::write(screen.path("start.ndfi.json"), r#"{"map": {"path": "plate.png"}, "truth_samples": 16}"#)
        .expect("written");
    let said = std::fs::File::create(screen.path("said.txt")).expect("a file");
    let mut program = screen.command(env!("CARGO_BIN_EXE_ndf-inspector"));
    let program = program.args(["start.ndfi.json", "--lose-device-after", "8"]).stderr(said).spawn();
    let program = Owned(program.expect("it starts"));
    screen.xdotool("search --sync --onlyvisible --name NDF windowfocus");
    screen.keys("e");
    let began = Instant::now();
    while !std::fs::read_to_string(screen.path("said.txt")).is_ok_and(|said| said.contains("device is lost")) {
        assert!(began.elapsed() < PATIENCE, "the device is not lost");
        std::thread::sleep(Duration::from_millis(100));
    }
    std::thread::sleep(Duration::from_secs(2));
    screen.keys("shift+g");
    screen.wait_for("both changes", |file| {
        file.surface.exposure_stops == 0.5 && file.comparison.view == ndf_inspector::comparison::View::Grid3x3
    });
    screen.quit(program);
}

const SAMPLE: [&str; 6] = ["sample", "plate", "-o", "plate.png", "--size", "64"];
