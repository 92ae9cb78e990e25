//! Pictures of every method of one map, and what they are off the truth.

use std::time::Instant;

use glam::Vec3;
use indicatif::ProgressBar;

use super::figures::{Cell, MethodFigures, Reference};
use crate::cli::options::wait_for_fit;
use crate::color::srgb8_from_linear;
use crate::comparison::{Arrangement, Comparison};
use crate::filter::{Method, MethodChoice};
use crate::gpu::map_group::{COLOR_FORMAT, float_format};
use crate::gpu::{FrameBudget, FrameInput, Gpu, PICTURE_FORMAT, SurfaceFrame};
use crate::lit_surface::LitSurface;
use crate::reference::{Picture, flip, normalised_color_error, rmse, standard_error};
use crate::session::Session;

/// Frames whose median time is reported.
const TIMED_FRAMES: usize = 5;

/// What every map is compared by.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The methods; those of lobes name how many.
    pub methods: Vec<MethodChoice>,
    /// Distances from the eye to the surface's centre; empty for the session's.
    pub distances: Vec<f32>,
    /// Exponents of the material; empty for the session's.
    pub exponents: Vec<f32>,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// True where the pictures are wanted too.
    pub keeps_pictures: bool,
}

/// A cell with its pictures: the truth's, then each method's; none where they are not wanted.
#[derive(Debug)]
pub struct Measured {
    /// The figures.
    pub cell: Cell,
    /// The pictures.
    pub pictures: Vec<Shown>,
}

/// A picture as it is displayed.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// sRGB, row by row from the top.
    pub rgb: Vec<u8>,
}

impl Shown {
    fn new(picture: &Picture) -> Self {
        let rgb = picture.rgb.iter().flat_map(|&color| srgb8_from_linear(color)).collect();
        Self { size: picture.size, rgb }
    }
}

/// What is found of one method in one view.
type Found = (MethodFigures, Option<Shown>);

/// One view of a map, and its truth.
struct View {
    surface: LitSurface,
    truth: Picture,
    reference: Reference,
    milliseconds: f64,
}

/// Draws and measures.
pub struct Measurer<'a> {
    gpu: &'a Gpu,
    frame: SurfaceFrame,
    settings: &'a Settings,
}

impl<'a> Measurer<'a> {
    /// Compiles what is drawn with.
    pub fn new(gpu: &'a Gpu, settings: &'a Settings) -> Self {
        let frame = SurfaceFrame::new(&gpu.device, PICTURE_FORMAT);
        Self { gpu, frame, settings }
    }

    /// How many steps a map takes.
    pub fn steps(settings: &Settings) -> u64 {
        let views = settings.distances.len().max(1) * settings.exponents.len().max(1);
        (views * (settings.methods.len() + 1)) as u64
    }

    /// Every cell of the session's map, called `map`.
    ///
    /// # Errors
    /// One sentence that names the method and the cause.
    pub fn measure(&mut self, session: &mut Session, map: &str, bar: &ProgressBar) -> anyhow::Result<Vec<Measured>> {
        let settings = self.settings;
        let mut views = Vec::new();
        for surface in surfaces(settings, session.surface) {
            views.push(self.view(session, surface)?);
            bar.inc(1);
        }
        let mut found: Vec<Vec<Option<Found>>> =
            views.iter().map(|_| settings.methods.iter().map(|_| None).collect()).collect();
        let choices: Vec<MethodChoice> = settings.methods.iter().map(|&choice| named(choice, session)).collect();
        for index in by_lobes(&choices) {
            let choice = choices[index];
            bar.set_message(format!("{map}, {choice}"));
            bar.suspend(|| prepare(session, choice))?;
            for (cell, view) in found.iter_mut().zip(&views) {
                cell[index] = Some(self.figures(session, choice, view)?);
                bar.inc(1);
            }
        }
        let cells = views.into_iter().zip(found).map(|(view, found)| self.cell(map, view, found));
        Ok(cells.collect())
    }

    fn cell(&self, map: &str, view: View, found: Vec<Option<Found>>) -> Measured {
        let (methods, pictures): (Vec<_>, Vec<_>) = found.into_iter().flatten().unzip();
        let pictures = std::iter::once(self.shown(&view.truth)).chain(pictures);
        Measured {
            cell: Cell {
                map: map.to_owned(),
                distance: view.surface.camera.distance,
                exponent: view.surface.material.shininess,
                reference: view.reference,
                methods,
            },
            pictures: pictures.flatten().collect(),
        }
    }

    /// The truth of one view.
    fn view(&mut self, session: &Session, surface: LitSurface) -> anyhow::Result<View> {
        let samples = session.truth_samples;
        let input = input(session, &surface, Method::Truth, self.settings.size);
        let start = Instant::now();
        self.frame.forget_pictures();
        self.frame.budget = FrameBudget { truth_limit: samples / 2, truth_batch: 64, upload_bytes: 256 << 20 };
        self.frame.complete(self.gpu, &input)?;
        let half = self.picture(Method::Truth)?;
        self.frame.budget.truth_limit = samples;
        self.frame.complete(self.gpu, &input)?;
        let truth = self.picture(Method::Truth)?;
        let standard_error = standard_error(&half, &truth);
        let reference = Reference { samples_per_pixel: samples, standard_error };
        Ok(View { surface, truth, reference, milliseconds: 1000.0 * start.elapsed().as_secs_f64() })
    }

    /// What a method is off the truth in one view.
    fn figures(&mut self, session: &Session, choice: MethodChoice, view: &View) -> anyhow::Result<Found> {
        let (picture, milliseconds) = match choice.method {
            Method::Truth => (view.truth.clone(), view.milliseconds),
            method => {
                let input = input(session, &view.surface, method, self.settings.size);
                self.frame.complete(self.gpu, &input)?;
                let time = self.frame.time_per_frame(self.gpu, &input, TIMED_FRAMES)?;
                (self.picture(method)?, 1000.0 * time.as_secs_f64())
            }
        };
        let figures = MethodFigures {
            method: choice.to_string(),
            normalised_color_error: normalised_color_error(&picture, &view.truth),
            rmse: rmse(&picture, &view.truth),
            flip: flip(&picture, &view.truth),
            milliseconds,
            bytes_per_texel: self.bytes_per_texel(session, choice.method),
        };
        Ok((figures, self.shown(&picture)))
    }

    /// The picture for the sheet, where there is to be one.
    fn shown(&self, picture: &Picture) -> Option<Shown> {
        self.settings.keeps_pictures.then(|| Shown::new(picture))
    }

    fn picture(&self, method: Method) -> anyhow::Result<Picture> {
        let texels = self.frame.linear(&self.gpu.device, &self.gpu.queue, method)?;
        anyhow::ensure!(self.frame.lod_range(method).is_some() && !texels.is_empty(), "{method} was not drawn.");
        Ok(Picture {
            size: self.settings.size,
            rgb: texels.iter().map(|texel| Vec3::from_slice(&texel[..3])).collect(),
            covered: texels.iter().map(|texel| texel[3] > 0.5).collect(),
        })
    }

    /// Four floats for the mean normal, or for each layer of channels or lobes, and the colours beside them.
    fn bytes_per_texel(&self, session: &Session, method: Method) -> u32 {
        let (layers, colors) = match method {
            Method::Truth => (1, 1),
            Method::Rival(_) => (session.channels_of(method).map_or(1, |channels| channels.layers as u32), 1),
            Method::Vmf | Method::VmfUnaligned => [session.fit_settings().lobes as u32; 2].into(),
        };
        let bytes = |format: wgpu::TextureFormat| format.block_copy_size(None).unwrap_or(0);
        let is_colored = session.map().albedo.is_some();
        layers * bytes(float_format(&self.gpu.device)) + if is_colored { colors * bytes(COLOR_FORMAT) } else { 0 }
    }
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

/// `base` from every distance with every exponent.
fn surfaces(settings: &Settings, base: LitSurface) -> Vec<LitSurface> {
    let or = |values: &[f32], value: f32| if values.is_empty() { vec![value] } else { values.to_vec() };
    let mut surfaces = Vec::new();
    for shininess in or(&settings.exponents, base.material.shininess) {
        for distance in or(&settings.distances, base.camera.distance) {
            let mut surface = base;
            (surface.material.shininess, surface.camera.distance) = (shininess, distance);
            surfaces.push(surface);
        }
    }
    surfaces
}

/// The methods' indices, those of one fit side by side, so that each fit is made once.
fn by_lobes(methods: &[MethodChoice]) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..methods.len()).collect();
    indices.sort_by_key(|&index| methods[index].lobes);
    indices
}

/// The choice with the lobe count that it stands for.
fn named(choice: MethodChoice, session: &Session) -> MethodChoice {
    let shown = choice.method.shows_lobes().then_some(session.fit_settings().lobes);
    MethodChoice { lobes: choice.lobes.or(shown), ..choice }
}

/// Fits the lobes, or builds the channels, that a method needs.
fn prepare(session: &mut Session, choice: MethodChoice) -> anyhow::Result<()> {
    if let Some(lobes) = choice.lobes {
        let mut settings = *session.fit_settings();
        settings.lobes = lobes;
        session.begin(settings);
        wait_for_fit(session)?;
    }
    session.comparison = Comparison::alone(choice.method);
    session.wait_for_channels();
    match session.take_messages().into_iter().find(|message| message.is_error) {
        Some(error) => anyhow::bail!(error.text),
        None => Ok(()),
    }
}
