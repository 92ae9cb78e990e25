//! The bridge to the GPU: paint callbacks that record the surface and the sphere into the window's own frame.
//!
//! The passes live in the renderer's callback resources, made on first use. What a frame learns (samples drawn,
//! whether another frame would look better, the pictures that figures are worked out from) goes back through
//! [`SurfaceStatus`], which the next pass of the window reads.

use std::sync::{Arc, Mutex, PoisonError};

use egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};

use crate::comparison::{Arrangement, ShownMethod};
use crate::filter::Method;
use crate::filter::PlainMip;
use crate::filter::vmf::{Fold, LobePyramid};
use crate::gpu::frame::{FrameBudget, FrameInput, SurfaceFrame};
use crate::gpu::pass_timer::PassTimer;
use crate::gpu::passes::sphere::{SphereInput, SphereLayers, SpherePass};
use crate::gpu::snapshots::Snapshots;
use crate::lit_surface::LitSurface;
use crate::scene::SphereOrbit;
use crate::session::Session;
use crate::sphere::Lobe;

use super::texel_report::TexelData;

/// What the pictures of a frame are of. Figures of another subject are stale.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// The surface.
    pub surface: LitSurface,
    /// Which map and which lobes are open.
    revisions: [u64; 2],
    fold: Fold,
    /// Pixels of a method's picture.
    size: [u32; 2],
}

impl Subject {
    /// What the session shows in pictures of `size`.
    pub fn new(session: &Session, size: [u32; 2]) -> Self {
        let fitting = session.fitting();
        let revisions = [session.map_revision(), fitting.revision()];
        Self { surface: session.surface.clone(), revisions, fold: fitting.fold(), size }
    }
}

/// What the surface's last frame came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceReport {
    /// Samples per pixel that the truth has.
    pub truth_samples: u32,
    /// True while another frame would look better, or bring what is on its way back.
    pub wants_more: bool,
    /// Finest levels left out because the adapter cannot hold them.
    pub left_out: usize,
    /// Finest levels whose lobes are left out.
    pub lobes_left_out: usize,
    /// Finest and coarsest level of lobes in use.
    pub lobe_levels: Option<[f32; 2]>,
    /// What the pictures are of.
    pub subject: Option<Subject>,
    /// The pictures that figures are worked out from.
    pub snapshots: Snapshots,
    /// Milliseconds of the methods' passes, where they are timed.
    pub milliseconds: Vec<(Method, f64)>,
}

impl SurfaceReport {
    /// Milliseconds of the method's last pass, where it was timed.
    pub fn milliseconds(&self, method: Method) -> Option<f64> {
        self.milliseconds.iter().find(|(timed, _)| *timed == method).map(|(_, milliseconds)| *milliseconds)
    }

    /// What is left out, in words.
    pub fn left_out_sentence(&self) -> Option<String> {
        match (self.left_out, self.lobes_left_out) {
            (0, 0) => None,
            (0, count) => Some(format!("lobes of the finest {count} levels exceed the memory set aside")),
            (1, _) => Some("the finest level exceeds the adapter and is left out".to_owned()),
            (count, _) => Some(format!("the finest {count} levels exceed the adapter and are left out")),
        }
    }
}

/// A report that the frame writes and the window reads.
#[derive(Clone, Debug, Default)]
pub struct SurfaceStatus(Arc<Mutex<SurfaceReport>>);

impl SurfaceStatus {
    /// The last report.
    pub fn get(&self) -> SurfaceReport {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Writes a report; true if it differs from the last.
    fn set(&self, report: SurfaceReport) -> bool {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let differs = *last != report;
        *last = report;
        differs
    }
}

/// The surface, to be painted into a rectangle.
pub struct SurfacePaint {
    surface: LitSurface,
    mip: Arc<PlainMip>,
    lobes: Arc<LobePyramid>,
    fold: Fold,
    methods: Vec<ShownMethod>,
    arrangement: Arrangement,
    size: [u32; 2],
    budget: FrameBudget,
    /// True where the methods are held against the truth.
    pub against_truth: bool,
    subject: Subject,
    target: PaintTarget,
    context: egui::Context,
}

impl SurfacePaint {
    /// Everything the surface's picture depends on, taken from the session, in this arrangement.
    pub fn new(
        session: &Session,
        arrangement: Arrangement,
        size: [u32; 2],
        target: &PaintTarget,
        context: &egui::Context,
    ) -> Self {
        Self {
            surface: session.surface.clone(),
            mip: Arc::clone(session.mip()),
            lobes: Arc::clone(session.lobes()),
            fold: session.fitting().fold(),
            methods: session.shown_methods(),
            arrangement,
            size,
            budget: FrameBudget { truth_limit: session.truth_samples, ..target.budget },
            against_truth: false,
            subject: Subject::new(session, arrangement.cell_size(size)),
            target: target.clone(),
            context: context.clone(),
        }
    }

    /// The shape that paints it.
    pub fn shape(self, rect: egui::Rect) -> egui::Shape {
        Callback::new_paint_callback(rect, self).into()
    }

    fn input(&self) -> FrameInput<'_> {
        FrameInput {
            surface: &self.surface,
            mip: &self.mip,
            lobes: &self.lobes,
            fold: self.fold,
            methods: self.methods.clone(),
            arrangement: self.arrangement,
            size: self.size,
        }
    }

    fn new_frame(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> SurfaceFrame {
        let mut frame = SurfaceFrame::new(device, self.target.format);
        frame.timer = self.target.times_passes.then(|| PassTimer::new(device, queue)).flatten();
        frame
    }

    fn report(&self, frame: &SurfaceFrame) -> SurfaceReport {
        let times = frame.timer.iter().flat_map(|timer| {
            self.methods.iter().filter_map(move |shown| Some((shown.method, timer.milliseconds(shown.method)?)))
        });
        SurfaceReport {
            truth_samples: frame.truth_samples(),
            wants_more: frame.wants_more() || frame.is_waiting(),
            left_out: frame.left_out(),
            lobes_left_out: frame.lobes_left_out(),
            lobe_levels: frame.lod_range(Method::Vmf),
            subject: Some(self.subject.clone()),
            snapshots: frame.snapshots().clone(),
            milliseconds: times.collect(),
        }
    }
}

/// Where and how callbacks paint.
#[derive(Clone, Debug)]
pub struct PaintTarget {
    /// The format of the window's frame.
    pub format: wgpu::TextureFormat,
    /// How much one frame may do.
    pub budget: FrameBudget,
    /// What the surface's last frame came to.
    pub status: SurfaceStatus,
    /// True where the methods' passes are timed, which differs from run to run.
    pub times_passes: bool,
}

impl Default for PaintTarget {
    fn default() -> Self {
        Self {
            format: wgpu::TextureFormat::Rgba8Unorm,
            budget: FrameBudget::default(),
            status: SurfaceStatus::default(),
            times_passes: false,
        }
    }
}

/// Runs `make` on first use.
fn resource<T: Send + Sync + 'static>(resources: &mut CallbackResources, make: impl FnOnce() -> T) -> &mut T {
    resources.entry::<T>().or_insert_with(make)
}

impl CallbackTrait for SurfacePaint {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let frame = resource(resources, || self.new_frame(device, queue));
        (frame.budget, frame.against_truth) = (self.budget, self.against_truth);
        frame.prepare(device, queue, encoder, &self.input());
        let report = self.report(frame);
        let wants_more = report.wants_more;
        if self.target.status.set(report) || wants_more {
            self.context.request_repaint();
        }
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(frame) = resources.get::<SurfaceFrame>() {
            frame.draw(pass);
        }
    }
}

/// The sphere, to be painted into a rectangle.
pub struct SpherePaint {
    /// The texel's data.
    pub data: Arc<TexelData>,
    /// Grows whenever the data change.
    pub data_revision: u64,
    /// Slot and lobe.
    pub lobes: Vec<(usize, Lobe)>,
    /// How the sphere is turned.
    pub orbit: SphereOrbit,
    /// What is shown.
    pub layers: SphereLayers,
    /// Size in pixels.
    pub size_px: [f32; 2],
    /// Pixels per point.
    pub px_per_point: f32,
    /// The format of the window's frame.
    pub format: wgpu::TextureFormat,
}

impl SpherePaint {
    /// The shape that paints it.
    pub fn shape(self, rect: egui::Rect) -> egui::Shape {
        Callback::new_paint_callback(rect, self).into()
    }
}

impl CallbackTrait for SpherePaint {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let input = SphereInput {
            ndf: &self.data.picture,
            lobes: &self.lobes,
            view_from_tangent: self.orbit.view_from_tangent().as_mat3(),
            layers: self.layers,
            size_px: self.size_px,
            px_per_point: self.px_per_point,
        };
        resource(resources, || SpherePass::new(device, self.format)).prepare(queue, &input, self.data_revision);
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(sphere) = resources.get::<SpherePass>() {
            sphere.draw(pass);
        }
    }
}
