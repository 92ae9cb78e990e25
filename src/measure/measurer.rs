//! Pictures of every method of one map, and what they are off the truth.

use std::time::{Duration, Instant};

use glam::Vec3;

use super::dolly;
use super::figures::{MethodFigures, Reference};
use super::follower::{Finding, Follower, MeasureError, Shown};
use super::tasks::{self, Task};
use crate::comparison::{Arrangement, Comparison};
use crate::filter::vmf::FitSettings;
use crate::filter::{Method, MethodChoice};
use crate::gpu::map_group::{COLOR_FORMAT, float_format};
use crate::gpu::{FrameBudget, FrameInput, Gpu, PICTURE_FORMAT, SurfaceFrame};
use crate::lit_surface::LitSurface;
use crate::reference::{Picture, flip, normalised_color_error, rmse, standard_error};
use crate::session::Session;

/// What every point is measured by.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureSettings {
    /// The methods; those of lobes may name how many.
    pub methods: Vec<MethodChoice>,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples per pixel of the truth.
    pub truth_samples: u32,
    /// Frames whose median time is reported; 0 for none.
    pub timed_frames: usize,
    /// Frames of the dolly whose temporal change is measured; below 2 for none.
    pub dolly_frames: usize,
    /// True where the pictures are wanted too.
    pub keeps_pictures: bool,
}

/// What is measured: a surface and a fit of the session's map.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The surface.
    pub surface: LitSurface,
    /// How the lobes are fitted; a method may name another count.
    pub fit: FitSettings,
}

/// What is found of one method in one view.
type Found = (MethodFigures, Option<Shown>);

/// One view of a map: its truth, and that of the dolly which begins there.
struct View {
    surface: LitSurface,
    truth: Vec<Picture>,
    reference: Reference,
    milliseconds: f64,
}

/// Samples per pixel that one submission adds to a truth: few enough for a window to draw in between.
const TRUTH_BATCH: u32 = 16;

/// Draws and measures.
pub struct Measurer<'a> {
    gpu: &'a Gpu,
    frame: SurfaceFrame,
    settings: &'a MeasureSettings,
    /// Of the map at hand.
    views: Vec<View>,
}

impl<'a> Measurer<'a> {
    /// Compiles what is drawn with.
    pub fn new(gpu: &'a Gpu, settings: &'a MeasureSettings) -> Self {
        let frame = SurfaceFrame::new(&gpu.device, PICTURE_FORMAT);
        Self { gpu, frame, settings, views: Vec::new() }
    }

    /// Measures every method at every point of the session's map. The session fits and builds what they need, and
    /// keeps the last of it; its surface stays.
    ///
    /// # Errors
    /// One sentence that names the method and the cause, or that nobody wants the rest.
    pub fn measure(
        &mut self,
        session: &mut Session,
        points: &[Point],
        follower: &mut dyn Follower,
    ) -> Result<(), MeasureError> {
        self.views.clear();
        let fitted = session.fitting().is_complete().then(|| *session.fit_settings());
        let mut told = vec![false; points.len()];
        let mut last: Option<(Task, usize, Found)> = None;
        for task in tasks::tasks(&self.settings.methods, points, fitted) {
            follower.begins(task.choice, task.point);
            let view = self.view(session, &points[task.point].surface, follower)?;
            if !std::mem::replace(&mut told[task.point], true) {
                let View { reference, truth, .. } = &self.views[view];
                follower.finds(Finding::Truth {
                    point: task.point,
                    reference: *reference,
                    picture: self.shown(&truth[0]),
                });
            }
            let found = match last.take() {
                // Nothing that this method reads has changed.
                Some((before, seen, found)) if (before.method, before.fit, seen) == (task.method, task.fit, view) => {
                    found
                }
                _ => {
                    prepare(session, &task, follower)?;
                    self.figures(session, task.choice, view, follower)?
                }
            };
            let (figures, picture) = found.clone();
            follower.finds(Finding::Method { point: task.point, method: task.method, figures, picture });
            last = Some((task, view, found));
        }
        Ok(())
    }

    /// The index of the view of this surface, drawn when it is first asked for.
    fn view(
        &mut self,
        session: &Session,
        surface: &LitSurface,
        follower: &dyn Follower,
    ) -> Result<usize, MeasureError> {
        if let Some(index) = self.views.iter().position(|view| view.surface == *surface) {
            return Ok(index);
        }
        let samples = self.settings.truth_samples;
        let start = Instant::now();
        let half = self.truth(session, surface, samples / 2, follower)?;
        self.frame.budget.truth_limit = samples;
        let first = self.drawn(session, surface, Method::Truth)?;
        let milliseconds = 1000.0 * start.elapsed().as_secs_f64();
        let standard_error = standard_error(&half, &first);
        let mut truth = vec![first];
        for surface in self.dolly(surface) {
            truth.push(self.truth(session, &surface, samples, follower)?);
        }
        let temporal_change = dolly::mean_change(&truth, &truth);
        let reference = Reference { samples_per_pixel: samples, standard_error, temporal_change };
        self.views.push(View { surface: surface.clone(), truth, reference, milliseconds });
        Ok(self.views.len() - 1)
    }

    /// The truth with so many samples, from the first on.
    fn truth(
        &mut self,
        session: &Session,
        surface: &LitSurface,
        samples: u32,
        follower: &dyn Follower,
    ) -> Result<Picture, MeasureError> {
        if follower.is_cancelled() {
            return Err(MeasureError::Cancelled);
        }
        self.frame.forget_pictures();
        self.frame.budget = FrameBudget { truth_limit: samples, truth_batch: TRUTH_BATCH, upload_bytes: 256 << 20 };
        self.drawn(session, surface, Method::Truth)
    }

    /// What a method is off the truth in one view.
    fn figures(
        &mut self,
        session: &Session,
        choice: MethodChoice,
        view: usize,
        follower: &dyn Follower,
    ) -> Result<Found, MeasureError> {
        let surface = self.views[view].surface.clone();
        let mut frames = Vec::new();
        let mut milliseconds = None;
        if choice.method != Method::Truth {
            frames.push(self.drawn(session, &surface, choice.method)?);
            milliseconds = self.time(session, &surface, choice.method)?;
            for surface in self.dolly(&surface) {
                if follower.is_cancelled() {
                    return Err(MeasureError::Cancelled);
                }
                frames.push(self.drawn(session, &surface, choice.method)?);
            }
        }
        let View { truth, milliseconds: truth_milliseconds, .. } = &self.views[view];
        let frames = if choice.method == Method::Truth { truth } else { &frames };
        let figures = MethodFigures {
            method: choice.to_string(),
            normalised_color_error: normalised_color_error(&frames[0], &truth[0]),
            rmse: rmse(&frames[0], &truth[0]),
            flip: flip(&frames[0], &truth[0]),
            milliseconds: milliseconds.or((choice.method == Method::Truth).then_some(*truth_milliseconds)),
            bytes_per_texel: bytes_per_texel(&self.gpu.device, session, choice.method),
            temporal_change: dolly::mean_change(frames, truth),
        };
        let shown = self.shown(&frames[0]);
        Ok((figures, shown))
    }

    /// The surface in every frame of the dolly after the first.
    fn dolly(&self, surface: &LitSurface) -> Vec<LitSurface> {
        let distances = dolly::distances(surface.camera.distance, self.settings.dolly_frames).skip(1);
        let at = |distance| {
            let mut surface = surface.clone();
            surface.camera.distance = distance;
            surface
        };
        distances.map(at).collect()
    }

    /// Milliseconds of a frame of the method alone, where that is wanted.
    fn time(&mut self, session: &Session, surface: &LitSurface, method: Method) -> Result<Option<f64>, MeasureError> {
        if self.settings.timed_frames == 0 {
            return Ok(None);
        }
        let input = input(session, surface, method, self.settings.size);
        let time = self.frame.time_per_frame(self.gpu, &input, self.settings.timed_frames)?;
        Ok(Some(1000.0 * time.as_secs_f64()))
    }

    /// The picture for the eye, where it is wanted.
    fn shown(&self, picture: &Picture) -> Option<Shown> {
        self.settings.keeps_pictures.then(|| Shown::new(picture))
    }

    /// The finished picture of a method.
    fn drawn(&mut self, session: &Session, surface: &LitSurface, method: Method) -> Result<Picture, MeasureError> {
        let size = self.settings.size;
        self.frame.complete(self.gpu, &input(session, surface, method, size))?;
        let texels = self.frame.linear(&self.gpu.device, &self.gpu.queue, method)?;
        if self.frame.lod_range(method).is_none() || texels.is_empty() {
            return Err(MeasureError::NotDrawn(method.to_string()));
        }
        Ok(Picture {
            size,
            rgb: texels.iter().map(|texel| Vec3::from_slice(&texel[..3])).collect(),
            covered: texels.iter().map(|texel| texel[3] > 0.5).collect(),
        })
    }
}

/// What a texel above the base level takes in the textures that a method reads, bytes: four floats for the mean normal,
/// or for each layer of channels or lobes, and the colours beside them.
pub fn bytes_per_texel(device: &wgpu::Device, session: &Session, method: Method) -> u32 {
    let (layers, colors) = match method {
        Method::Truth => (1, 1),
        Method::Rival(_) => (session.channels_of(method).map_or(1, |channels| channels.layers as u32), 1),
        Method::Vmf | Method::VmfUnaligned => [session.fit_settings().lobes as u32; 2].into(),
    };
    let bytes = |format: wgpu::TextureFormat| format.block_copy_size(None).unwrap_or(0);
    let is_colored = session.map().albedo.is_some();
    layers * bytes(float_format(device)) + if is_colored { colors * bytes(COLOR_FORMAT) } else { 0 }
}

/// The method alone, over the whole picture.
fn input<'a>(session: &'a Session, surface: &'a LitSurface, method: Method, size: [u32; 2]) -> FrameInput<'a> {
    FrameInput {
        surface,
        mip: session.mip(),
        lobes: session.lobes(),
        fold: session.fitting().fold(),
        methods: vec![session.shown_method(method)],
        arrangement: Arrangement::Grid { side: 1 },
        size,
    }
}

/// Fits the lobes, or builds the channels, that a task needs; waits.
fn prepare(session: &mut Session, task: &Task, follower: &mut dyn Follower) -> Result<(), MeasureError> {
    if let Some(fit) = task.fit {
        session.begin(fit);
        let waited = session.wait_for_fit(&mut |session| {
            follower.waits(session);
            if follower.is_cancelled() {
                session.cancel_fit();
            }
        });
        if follower.is_cancelled() {
            return Err(MeasureError::Cancelled);
        }
        waited.map_err(|message| MeasureError::Session(message.text))?;
    }
    session.comparison = Comparison::alone(task.choice.method);
    session.poll();
    while session.is_building() {
        follower.waits(session);
        if follower.is_cancelled() {
            return Err(MeasureError::Cancelled);
        }
        session.wait(Duration::from_millis(50));
    }
    match session.take_messages().into_iter().find(|message| message.is_error) {
        Some(error) => Err(MeasureError::Session(error.text)),
        None => Ok(()),
    }
}
