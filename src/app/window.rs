//! The native window: which adapter draws it, and what is said where none can open.

use std::cell::RefCell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Duration;

use eframe::{CreationContext, Frame, NativeOptions};
use egui::{Context, Pos2, ViewportBuilder};
use egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};

use super::inspector::{Carried, Inspector, Surroundings};
use super::settings::{KeptSettings, WindowSize};
use super::viewport::PaintTarget;
use crate::gpu::context::{self, AdapterChoice, Gpu};
use crate::gpu::frame::FrameBudget;
use crate::jobs::Wake;
use crate::session::Session;

mod device_watch;
mod display;
mod frame_log;
use device_watch::{Caller, DeviceWatch};
use frame_log::FrameLog;

/// So many devices may be lost in one run; after that there is something wrong that another window does not mend.
const MOST_LOSSES: usize = 5;

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
    /// Devices are lost again and again.
    #[error(
        "the graphics device was lost {0} times, so the window gave up; the session is kept, and the next start goes \
         on with it"
    )]
    DeviceLost(usize),
    /// Anything else the windowing system said.
    #[error(
        "no window can be opened: {0}; \
         `cargo run --release -- screenshot -o inspector.png` draws the same window without one"
    )]
    Other(String),
}

/// What outlives a window whose device was lost.
#[derive(Default)]
struct Kept {
    carried: Option<Carried>,
    log: Option<FrameLog>,
    place: Option<Place>,
    losses: usize,
}

/// Where a window stands, in the system's own points, and how large it is.
#[derive(Clone, Copy, Debug)]
struct Place {
    size: WindowSize,
    position: Option<Pos2>,
}

impl Place {
    /// The same, but one that takes the whole screen up keeps the size and place that it had before.
    fn after(self, last: Option<Self>) -> Self {
        let is_maximized = self.size.is_maximized;
        let last = last.filter(|_| is_maximized);
        last.map_or(self, |last| Self { size: WindowSize { is_maximized, ..last.size }, ..last })
    }

    fn of(ctx: &Context) -> Option<Self> {
        let scale = ctx.zoom_factor();
        ctx.input(|input| {
            let viewport = input.viewport();
            Some(Self {
                size: WindowSize {
                    points: (scale * viewport.inner_rect?.size()).into(),
                    is_maximized: viewport.maximized.unwrap_or_default(),
                },
                position: viewport.outer_rect.map(|outer| scale * outer.min),
            })
        })
    }

    fn apply_to(self, viewport: ViewportBuilder) -> ViewportBuilder {
        let WindowSize { points, is_maximized } = self.size;
        let sized = viewport.with_inner_size(points).with_maximized(is_maximized);
        match self.position {
            Some(position) => sized.with_position(position),
            None => sized,
        }
    }
}

/// The window while it is open.
struct Window {
    inspector: Option<Inspector>,
    log: Option<FrameLog>,
    device: DeviceWatch,
    place: Option<Place>,
    kept: Rc<RefCell<Kept>>,
}

impl eframe::App for Window {
    fn logic(&mut self, ctx: &Context, frame: &mut Frame) {
        if let Some(log) = &mut self.log {
            log.begin(frame.info().cpu_usage);
        }
        self.device.rehearse(ctx);
        self.place = Place::of(ctx).map(|now| now.after(self.place)).or(self.place);
        if self.device.is_lost() {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        } else if let Some(inspector) = &mut self.inspector {
            inspector.logic(ctx);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut Frame) {
        if let Some(inspector) = self.inspector.as_mut().filter(|_| !self.device.is_lost()) {
            inspector.ui(ui);
        }
        if let Some(log) = &mut self.log {
            log.end_panels();
        }
    }

    fn on_exit(&mut self) {
        let Some(mut inspector) = self.inspector.take() else { return };
        if let Some(place) = self.place {
            inspector.change_settings(|settings| settings.window = Some(place.size));
        }
        inspector.finish();
        if self.device.is_lost() {
            let mut kept = self.kept.borrow_mut();
            kept.losses += 1;
            kept.place = self.place;
            (kept.carried, kept.log) = (Some(inspector.into_carried()), self.log.take());
        }
    }
}

/// How the window is opened.
#[derive(Clone, Copy, Debug, Default)]
pub struct WindowSettings<'a> {
    /// The file in which every frame leaves a line.
    pub frame_log: Option<&'a Path>,
    /// Gives the device up so long after the window has opened, as a driver that fails would.
    pub lose_device_after: Option<Duration>,
}

/// Opens the window on the session that `make` builds, and returns when it is closed.
///
/// A device that is lost takes its window along, for the toolkit keeps one device to a window: another is opened on the
/// same document, with the fit, the view and the history that there were.
pub fn run(make: impl FnOnce(Wake) -> Session, settings: &WindowSettings<'_>) -> Result<(), WindowError> {
    display::check()?;
    let kept = Rc::new(RefCell::new(Kept::default()));
    kept.borrow_mut().log = settings.frame_log.map(FrameLog::create).transpose()?;
    let caller = Caller::default();
    let session = make(caller.wake());
    let document = Document::New(Box::new(session), KeptSettings::of_user());
    open(&kept, &caller, document, settings.lose_device_after)?;
    loop {
        let carried = kept.borrow_mut().carried.take();
        let losses = kept.borrow().losses;
        let Some(carried) = carried else { return Ok(()) };
        if losses > MOST_LOSSES {
            return Err(WindowError::DeviceLost(losses));
        }
        open(&kept, &caller, Document::Carried(Box::new(carried)), None)?;
    }
}

/// What a window opens on.
enum Document {
    New(Box<Session>, KeptSettings),
    Carried(Box<Carried>),
}

fn open(
    kept: &Rc<RefCell<Kept>>,
    caller: &Caller,
    document: Document,
    lose_after: Option<Duration>,
) -> Result<(), WindowError> {
    let mut viewport = ViewportBuilder::default()
        .with_title("NDF Inspector")
        .with_app_id("ndf-inspector")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([900.0, 560.0])
        .with_drag_and_drop(true);
    let place = match &document {
        Document::New(_, settings) => settings.get().window.map(|size| Place { size, position: None }),
        Document::Carried(_) => kept.borrow_mut().place.take(),
    };
    if let Some(place) = place {
        viewport = place.apply_to(viewport);
    }
    let options = NativeOptions {
        viewport,
        wgpu_options: egui_wgpu::WgpuConfiguration { wgpu_setup: wgpu_setup(), ..Default::default() },
        dithering: false,
        ..Default::default()
    };
    let (kept, caller) = (Rc::clone(kept), caller.clone());
    let create = Box::new(move |creation: &CreationContext<'_>| {
        caller.follow(&creation.egui_ctx);
        let surroundings = surroundings(creation)?;
        let device = DeviceWatch::new(&surroundings.gpu.device, &creation.egui_ctx, lose_after);
        let ctx = &creation.egui_ctx;
        let inspector = match document {
            Document::New(session, settings) => {
                let mut inspector = Inspector::new(ctx, *session, surroundings);
                inspector.keep_document(settings);
                inspector
            }
            Document::Carried(carried) => Inspector::revive(ctx, *carried, surroundings),
        };
        let log = kept.borrow_mut().log.take();
        Ok(Box::new(Window { inspector: Some(inspector), log, device, place, kept }) as Box<dyn eframe::App>)
    });
    eframe::run_native("ndf-inspector", options, create).map_err(|error| explain(&error))
}

type DynError = Box<dyn std::error::Error + Send + Sync>;

fn surroundings(creation: &CreationContext<'_>) -> Result<Surroundings, DynError> {
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
    Ok(Surroundings { gpu, target, live: true })
}

/// Our own ranking of adapters and our own limits.
pub fn wgpu_setup() -> WgpuSetup {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.native_adapter_selector =
        Some(Arc::new(|adapters, surface| context::select(adapters, surface).map_err(|error| error.to_string())));
    setup.device_descriptor = Arc::new(context::device_descriptor);
    WgpuSetup::CreateNew(setup)
}

fn explain(error: &eframe::Error) -> WindowError {
    let text = error.to_string();
    match error {
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => WindowError::NoDisplay(text),
        eframe::Error::Wgpu(_) => WindowError::NoAdapter(text),
        eframe::Error::AppCreation(_) => WindowError::Other(text),
    }
}
