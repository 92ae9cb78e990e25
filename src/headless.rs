//! The window without a window: the same inspector, or whatever else is drawn with its means, run pass by pass and
//! drawn into a texture.
//!
//! Time stands at fixed steps, nothing moves by itself, and figures that differ from run to run are left out, so the
//! picture of a session is the same every time.

pub mod control;
pub mod player;
pub mod script;

use std::time::Duration;

use egui::accesskit::TreeUpdate;
use egui::{Event, RawInput, Rect, ViewportId, vec2};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use crate::app::dock::{Panel, Preset};
use crate::app::inspector::{Inspector, Surroundings, wake_of};
use crate::app::viewport::PaintTarget;
use crate::gpu::Gpu;
use crate::gpu::frame::FrameBudget;
use crate::gpu::readback::{self, ReadbackError};
use crate::jobs::Wake;
use crate::session::Session;

/// How a picture of the window is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenshotSettings {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Pixels per point: 2 draws everything twice as large.
    pub px_per_point: f32,
    /// Waits until the fit, the uploads and the truth are done.
    pub wait: bool,
}

impl Default for ScreenshotSettings {
    fn default() -> Self {
        Self { size: [1280, 800], px_per_point: 1.0, wait: true }
    }
}

/// Why no picture was taken.
#[derive(Debug, thiserror::Error)]
pub enum ScreenshotError {
    /// It could not be read back.
    #[error(transparent)]
    Readback(#[from] ReadbackError),
    /// The panel is not shown.
    #[error("The panel {0} is out of sight: choose a preset that has it.")]
    OutOfSight(&'static str),
}

/// A picture, sRGB, four bytes a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screenshot {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Row by row from the top.
    pub rgba: Vec<u8>,
}

impl Screenshot {
    /// The part within a rectangle in pixels, as much of it as there is.
    #[must_use]
    pub fn within(&self, rect: Rect) -> Self {
        let [width, height] = self.size.map(|side| side as usize);
        let clamped = |value: f32, most: usize| (value.round().max(0.0) as usize).min(most);
        let columns = clamped(rect.left(), width)..clamped(rect.right(), width);
        let rows = clamped(rect.top(), height)..clamped(rect.bottom(), height);
        let row = |y: usize| &self.rgba[4 * (y * width + columns.start)..4 * (y * width + columns.end)];
        Self { size: [columns.len() as u32, rows.len() as u32], rgba: rows.flat_map(row).copied().collect() }
    }
}

/// Passes without waiting: sizes settle in three, textures and callbacks follow.
const LEAST_PASSES: usize = 4;

/// Seconds between two passes.
const TIME_STEP: f64 = 1.0 / 60.0;

/// An inspector without a window.
pub struct Headless<'a> {
    /// The inspector that is shown.
    pub inspector: Inspector,
    canvas: Canvas<'a>,
    wait: bool,
}

/// Something that is laid out and drawn as a window is, into a texture.
pub struct Canvas<'a> {
    ctx: egui::Context,
    renderer: Renderer,
    target: wgpu::Texture,
    gpu: &'a Gpu,
    size: [u32; 2],
    px_per_point: f32,
    passes: usize,
    /// Seconds since the start.
    clock: f64,
    /// Seconds that a pass takes.
    time_step: f64,
    /// What the last pass shows to assistive technology, once that is asked for.
    tree: Option<TreeUpdate>,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl<'a> Headless<'a> {
    /// Shows the session that `make` builds.
    pub fn new(gpu: &'a Gpu, settings: ScreenshotSettings, make: impl FnOnce(Wake) -> Session) -> Self {
        let mut canvas = Canvas::new(gpu, settings.size);
        canvas.px_per_point = settings.px_per_point;
        let budget = FrameBudget { truth_batch: 64, upload_bytes: 256 << 20, ..Default::default() };
        let target = PaintTarget { format: FORMAT, budget, ..Default::default() };
        let surroundings = Surroundings { gpu: gpu.clone(), target, live: false };
        let inspector = Inspector::new(&canvas.ctx, make(wake_of(&canvas.ctx)), surroundings);
        // A cursor that blinks shows when a picture was taken.
        canvas.ctx.all_styles_mut(|style| style.visuals.text_cursor.blink = false);
        Self { inspector, canvas, wait: settings.wait }
    }

    /// Shows what a preset has, where it has it, whatever the session's own layout is.
    pub fn show(&mut self, preset: Preset) {
        self.inspector.take_opened_view();
        self.inspector.view.choose(preset);
    }

    /// Runs passes until nothing moves any more (or, without waiting, until the layout has settled), then reads the
    /// picture.
    pub fn screenshot(&mut self) -> Result<Screenshot, ReadbackError> {
        self.still(|window| {
            loop {
                window.pass(Vec::new())?;
                let settled = !window.wait || window.is_settled();
                if window.canvas.passes >= LEAST_PASSES && settled {
                    window.canvas.forget_glyphs();
                    window.pass(Vec::new())?;
                    return window.canvas.picture();
                }
                window.let_jobs_run();
            }
        })
    }

    /// As [`Self::screenshot`], of one panel where one is named.
    pub fn screenshot_of(&mut self, panel: Option<Panel>) -> Result<Screenshot, ScreenshotError> {
        let whole = self.screenshot()?;
        let Some(panel) = panel else { return Ok(whole) };
        let rect = self.inspector.rect_of(panel).ok_or(ScreenshotError::OutOfSight(panel.title()))?;
        Ok(whole.within(rect * self.canvas.px_per_point))
    }

    /// True when nothing is under way and nothing asks for another pass.
    fn is_settled(&self) -> bool {
        self.inspector.is_settled() && !self.canvas.ctx.has_requested_repaint()
    }

    /// Leaves the cores to the jobs for a while, which need them more than idle passes do.
    fn let_jobs_run(&mut self) {
        let session = &mut self.inspector.session;
        if session.fitting().is_running() || session.is_opening() || session.is_building() {
            session.wait(Duration::from_millis(20));
        }
    }

    /// Runs passes during which time stands still: how many there are depends on the machine, and what they show must
    /// not.
    fn still<T>(&mut self, passes: impl FnOnce(&mut Self) -> T) -> T {
        let step = std::mem::replace(&mut self.canvas.time_step, 0.0);
        let result = passes(self);
        self.canvas.time_step = step;
        result
    }

    /// One pass of the window with these events, drawn.
    pub fn pass(&mut self, events: Vec<Event>) -> Result<(), ReadbackError> {
        let inspector = &mut self.inspector;
        self.canvas.pass(events, |ui| {
            inspector.logic(ui.ctx());
            inspector.ui(ui);
        })
    }
}

impl<'a> Canvas<'a> {
    /// An empty canvas of `size` pixels.
    pub fn new(gpu: &'a Gpu, size: [u32; 2]) -> Self {
        let renderer = Renderer::new(&gpu.device, FORMAT, RendererOptions::PREDICTABLE);
        let target = readback::target(&gpu.device, "window", size, FORMAT);
        Self {
            ctx: egui::Context::default(),
            renderer,
            target,
            gpu,
            size,
            px_per_point: 1.0,
            passes: 0,
            clock: 0.0,
            time_step: TIME_STEP,
            tree: None,
        }
    }

    /// Has the next pass begin the atlas of glyphs anew: it then holds what that pass shows, in its order. Where a glyph
    /// stands in it moves a pixel of text by a rounding, and what was shown on the way, the progress of a fit for one,
    /// differs from run to run.
    pub fn forget_glyphs(&self) {
        self.ctx.set_font_providers(Vec::new());
    }

    /// Lays out what `show` shows, with these events, and draws it.
    pub fn pass(&mut self, events: Vec<Event>, show: impl FnMut(&mut egui::Ui)) -> Result<(), ReadbackError> {
        let input = self.input(events);
        self.passes += 1;
        self.clock += self.time_step;
        let mut output = self.ctx.clone().run_ui(input, show);
        self.tree = output.platform_output.accesskit_update.take();
        self.draw(output)
    }

    /// What was drawn last.
    pub fn picture(&self) -> Result<Screenshot, ReadbackError> {
        let rgba = readback::read_bytes(&self.gpu.device, &self.gpu.queue, &self.target)?;
        Ok(Screenshot { size: self.size, rgba })
    }

    fn input(&self, events: Vec<Event>) -> RawInput {
        // The toolkit takes sizes in points of the interface, which its own scale makes larger.
        let px_per_point = self.px_per_point * self.ctx.zoom_factor();
        let [width, height] = self.size.map(|pixels| pixels as f32 / px_per_point);
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(egui::Pos2::ZERO, vec2(width, height))),
            max_texture_side: Some(self.gpu.device.limits().max_texture_dimension_2d as usize),
            time: Some(self.clock),
            predicted_dt: TIME_STEP as f32,
            events,
            focused: true,
            ..Default::default()
        };
        input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(self.px_per_point);
        input
    }

    fn draw(&mut self, mut output: egui::FullOutput) -> Result<(), ReadbackError> {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        for (id, deltas) in output.textures_delta.set.drain() {
            for delta in deltas {
                self.renderer.update_texture(device, queue, id, &delta);
            }
        }
        let primitives = self.ctx.tessellate(output.shapes, output.pixels_per_point);
        let screen = ScreenDescriptor { size_in_pixels: self.size, pixels_per_point: output.pixels_per_point };
        let label = wgpu::CommandEncoderDescriptor { label: Some("window") };
        let mut encoder = device.create_command_encoder(&label);
        let more = self.renderer.update_buffers(device, queue, &mut encoder, &primitives, &screen);
        let view = self.target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("window"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        self.renderer.render(&mut pass, &primitives, &screen);
        drop(pass);
        queue.submit(more.into_iter().chain([encoder.finish()]));
        output.textures_delta.free.drain().for_each(|id| self.renderer.free_texture(&id));
        let waited = device.poll(wgpu::PollType::wait_indefinitely());
        waited.map(drop).map_err(|error| ReadbackError::Device(error.to_string()))
    }
}
