//! The window as its user meets it: driven by names, and looked at in pictures.

mod actions;
mod behaviour;
mod docking;
mod doctor;
mod exports;
mod live_figures;
mod looks;
mod materials;
mod names;
pub mod pictures;
mod random;
mod real;
mod resets;
mod scripts;
mod seeing;
mod texels;

use std::sync::Arc;
use std::time::Duration;

use egui_kittest::Harness;
use ndf_inspector::app::inspector::{Inspector, Surroundings, wake_of};
use ndf_inspector::app::viewport::PaintTarget;
use ndf_inspector::app::window::wgpu_setup;
use ndf_inspector::filter::vmf::FitSettings;
use ndf_inspector::gpu::{AdapterChoice, Gpu};
use ndf_inspector::jobs::Wake;
use ndf_inspector::normal_map::procedural;
use ndf_inspector::session::Session;

/// The inspector as the native window runs it, without what differs from run to run.
struct TestWindow {
    inspector: Inspector,
}

impl eframe::App for TestWindow {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.inspector.logic(ctx);
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.inspector.ui(ui);
    }
}

type Window = Harness<'static, TestWindow>;

const SETTINGS: FitSettings = FitSettings { lobes: 3, ..QUICK };
const QUICK: FitSettings = FitSettings {
    lobes: 1,
    selection: ndf_inspector::filter::vmf::Selection::Fixed,
    objective: ndf_inspector::filter::vmf::Objective::Em,
    align: ndf_inspector::filter::vmf::Alignment::Smooth { blend: 0.15 },
    iterations: 12,
    tolerance: 1e-4,
    kappa: ndf_inspector::sphere::vmf::KappaRule::Exact,
    e_step: ndf_inspector::filter::vmf::EStep::WithAlpha,
};

/// A session of a small bundled map.
fn session(name: &str, size: usize, wake: Wake) -> Session {
    let map = procedural::find(name).expect("a bundled map").make(size);
    let mut session = Session::with_map(map, wake);
    session.truth_samples = 16;
    session
}

/// That session with its fit done.
fn fitted(name: &'static str, size: usize) -> impl FnOnce(Wake) -> Session {
    move |wake| {
        let mut session = session(name, size, wake);
        session.begin(SETTINGS);
        while session.fitting().is_running() {
            session.wait(Duration::from_millis(20));
        }
        session
    }
}

/// A window of 1280x800 on the session that `make` builds.
fn window(make: impl FnOnce(Wake) -> Session) -> Window {
    let choice = AdapterChoice {
        name: "test".to_owned(),
        backend: "vulkan",
        software: false,
        reason: "the adapter under test".to_owned(),
    };
    Harness::builder()
        .with_size([1280.0, 800.0])
        .with_step_dt(0.02)
        .with_max_steps(12)
        .wgpu_setup(wgpu_setup())
        .build_eframe(|creation| {
            let ctx = &creation.egui_ctx;
            let state = creation.wgpu_render_state.clone().expect("a device");
            let (instance, adapter, device, queue) = (state.instance, state.adapter, state.device, state.queue);
            let gpu = Gpu { instance, adapter, device, queue, choice };
            let surroundings = Surroundings { gpu, target: PaintTarget::default(), live: false };
            TestWindow { inspector: Inspector::new(ctx, make(wake_of(ctx)), surroundings) }
        })
}

/// Draws and steps until every upload, every sample of the truth and every figure is there.
fn settle(window: &mut Window) {
    // What was changed last is in no picture yet.
    window.run();
    let start = std::time::Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        window.render().expect("a picture");
        window.run();
        if window.state().inspector.is_settled() {
            return;
        }
    }
    panic!("the window does not settle");
}

/// A wake-up call that nobody hears.
fn unheard() -> Wake {
    Arc::new(|| {})
}
