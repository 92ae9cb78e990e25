//! The native window: which adapter draws it, and what is said where none can open.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::{CreationContext, Frame, NativeOptions};
use egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};

use super::inspector::{Inspector, Surroundings, wake_of};
use super::viewport::PaintTarget;
use crate::gpu::context::{self, AdapterChoice, Gpu};
use crate::gpu::frame::FrameBudget;
use crate::jobs::Wake;
use crate::session::Session;

/// Why no window opened, in a sentence that names the way out.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// There is no display to open a window on.
    #[error(
        "no window can be opened, for there is no display ({0}); \
         `cargo run --release -- screenshot -o inspector.png` draws the same window without one"
    )]
    NoDisplay(String),
    /// A library of the windowing system is missing.
    #[error(
        "no window can be opened, for the library {0} is missing (Debian, Ubuntu: apt install {1}); \
         `cargo run --release -- screenshot -o inspector.png` draws the same window without one"
    )]
    NoLibrary(&'static str, &'static str),
    /// Nothing can draw.
    #[error(
        "no window can be opened, for nothing can draw it: {0}; \
         `fit` and `probe` work without a graphics adapter"
    )]
    NoAdapter(String),
    /// The frame log cannot be written.
    #[error("the frame log '{0}' cannot be written: {1}")]
    FrameLog(String, std::io::Error),
    /// Anything else the windowing system said.
    #[error(
        "no window can be opened: {0}; \
         `cargo run --release -- screenshot -o inspector.png` draws the same window without one"
    )]
    Other(String),
}

struct Window {
    inspector: Inspector,
    log: Option<FrameLog>,
}

/// A file with one line per frame: milliseconds since the window opened when the frame began, and milliseconds that
/// the program itself spent on it, drawing by the adapter left out. The gaps between lines are the pace.
struct FrameLog {
    file: BufWriter<File>,
    opened: Instant,
    began: Instant,
}

impl FrameLog {
    fn create(path: &Path) -> Result<Self, WindowError> {
        let file = File::create(path).map_err(|cause| WindowError::FrameLog(path.display().to_string(), cause))?;
        Ok(Self { file: BufWriter::new(file), opened: Instant::now(), began: Instant::now() })
    }

    fn end(&mut self) {
        let milliseconds = |duration: Duration| duration.as_secs_f64() * 1000.0;
        let (at, took) = (milliseconds(self.began - self.opened), milliseconds(self.began.elapsed()));
        let written = writeln!(self.file, "{at:.3} {took:.3}").and_then(|()| self.file.flush());
        if let Err(error) = written {
            log::warn!("a line of the frame log was lost: {error}");
        }
    }
}

impl eframe::App for Window {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut Frame) {
        if let Some(log) = &mut self.log {
            log.began = Instant::now();
        }
        self.inspector.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut Frame) {
        self.inspector.ui(ui);
        if let Some(log) = &mut self.log {
            log.end();
        }
    }

    fn on_exit(&mut self) {
        self.inspector.finish();
    }
}

/// Opens the window on the session that `make` builds, and returns when it is closed. Every frame leaves a line in
/// `frame_log`, where that is given.
pub fn run(make: impl FnOnce(Wake) -> Session, frame_log: Option<&Path>) -> Result<(), WindowError> {
    check_display()?;
    let log = frame_log.map(FrameLog::create).transpose()?;
    let options = NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("NDF Inspector")
            .with_app_id("ndf-inspector")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([900.0, 560.0])
            .with_drag_and_drop(true),
        wgpu_options: egui_wgpu::WgpuConfiguration { wgpu_setup: wgpu_setup(), ..Default::default() },
        dithering: false,
        ..Default::default()
    };
    let create = Box::new(|creation: &CreationContext<'_>| {
        let inspector = inspector(creation, make)?;
        Ok(Box::new(Window { inspector, log }) as Box<dyn eframe::App>)
    });
    eframe::run_native("ndf-inspector", options, create).map_err(|error| explain(&error))
}

type DynError = Box<dyn std::error::Error + Send + Sync>;

fn inspector(creation: &CreationContext<'_>, make: impl FnOnce(Wake) -> Session) -> Result<Inspector, DynError> {
    let state = creation.wgpu_render_state.as_ref().ok_or("the window came without a graphics device")?;
    let gpu = Gpu {
        instance: state.instance.clone(),
        adapter: state.adapter.clone(),
        device: state.device.clone(),
        queue: state.queue.clone(),
        choice: AdapterChoice::of(&state.adapter.get_info()),
    };
    // A processor that draws has little to spare: small steps keep the pointer's moves fluent.
    let truth_batch = if gpu.choice.software { 4 } else { 16 };
    let budget = FrameBudget { truth_batch, ..Default::default() };
    let target = PaintTarget { format: state.target_format, budget, times_passes: true, ..Default::default() };
    let surroundings = Surroundings { gpu, target, live: true };
    let ctx = &creation.egui_ctx;
    let mut inspector = Inspector::new(ctx, make(wake_of(ctx)), surroundings);
    inspector.keep_document();
    Ok(inspector)
}

/// Our own ranking of adapters and our own limits.
pub fn wgpu_setup() -> WgpuSetup {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.native_adapter_selector =
        Some(Arc::new(|adapters, surface| context::select(adapters, surface).map_err(|error| error.to_string())));
    setup.device_descriptor = Arc::new(context::device_descriptor);
    WgpuSetup::CreateNew(setup)
}

/// On Linux and the BSDs: a display must be named, and its keyboard library present, which would panic later.
fn check_display() -> Result<(), WindowError> {
    if !cfg!(all(unix, not(target_os = "macos"))) {
        return Ok(());
    }
    let named = |variable: &str| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    let wayland = named("WAYLAND_DISPLAY") || named("WAYLAND_SOCKET");
    if !wayland && !named("DISPLAY") {
        return Err(WindowError::NoDisplay("neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned()));
    }
    if !library_is_there("libxkbcommon.so.0") {
        return Err(WindowError::NoLibrary("libxkbcommon", "libxkbcommon0"));
    }
    if !wayland && !library_is_there("libxkbcommon-x11.so.0") {
        return Err(WindowError::NoLibrary("libxkbcommon-x11", "libxkbcommon-x11-0"));
    }
    Ok(())
}

/// Looks where the loader looks: `LD_LIBRARY_PATH`, and the system's folders one level down. Says yes when it found
/// no library folder at all, as on systems that keep them elsewhere.
fn library_is_there(file: &str) -> bool {
    let own = std::env::var("LD_LIBRARY_PATH").unwrap_or_default();
    let system = ["/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib"];
    let mut folders: Vec<PathBuf> = own.split(':').filter(|f| !f.is_empty()).map(Into::into).collect();
    folders.extend(system.iter().map(Into::into));
    let below = |folder: &Path| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect()
    };
    let nested: Vec<_> = folders.iter().flat_map(|folder| below(folder)).collect();
    folders.extend(nested);
    let mut present = folders.iter().filter(|folder| folder.is_dir()).peekable();
    present.peek().is_none()
        || present.any(|folder| folder.join(file).exists())
        || !folders.iter().any(|folder| has_libc(folder))
}

fn has_libc(folder: &Path) -> bool {
    folder.join("libc.so.6").exists()
}

fn explain(error: &eframe::Error) -> WindowError {
    let text = error.to_string();
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => WindowError::NoDisplay(text),
        eframe::Error::Wgpu(_) => WindowError::NoAdapter(text),
        eframe::Error::AppCreation(_) => WindowError::Other(text),
    }
}
